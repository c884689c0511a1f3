"""Efforts as a linear function of inertial parameters: all ten a link, and the fewest that tell."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from dynamic_legs import BODY, SLIDE, SPECS, THIGH, YAW, leg_programs, spec_of, value, values, written
from hypothesis import Phase, given, settings

from cases.to_spec import LEG_CASES, case, from_tree
from mechanisms.random_bodies import specs_with_bodies
from oracles.dynamic_peer import Bodies
from oracles.measure import difference

ACCURACY = 1e-11
NAMES = ("inverse_dynamics", "regressor", "base_parameters")


def standard(text, leg, **parameters):
    """Ten numbers a link in the frame after its row: m, m c, then the tensor about the origin."""
    found = []
    for body in Bodies(text, parameters).links(leg):
        c = np.array(body.lever)
        J = np.array(body.inertia) + body.mass * (c @ c * np.eye(3) - np.outer(c, c))
        found += [body.mass, *(body.mass * c), J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]]
    return np.array(found)


def states(program, seed=0, rows=1):
    count = program.signature.inputs[0].size
    return np.random.default_rng(seed).uniform(-2, 2, (rows, 3, count))


def assert_linear(text, leg, found):
    for q, qd, qdd in states(found["regressor"], rows=3):
        tau = value(found["inverse_dynamics"], q, qd, qdd)
        assert difference(value(found["regressor"], q, qd, qdd) @ standard(text, leg), tau) <= ACCURACY
        Y, p = values(found["base_parameters"], q, qd, qdd)
        assert difference(Y @ p, tau) <= ACCURACY


def assert_minimal(found, *more):
    """As many base parameters as the regressor has independent columns, and they are independent."""
    count = found["regressor"].signature.inputs[0].size
    motions = states(found["regressor"], seed=1, rows=8 * count)
    whole = np.vstack([value(found["regressor"], *motion, *more) for motion in motions])
    base = np.vstack([values(found["base_parameters"], *motion, *more)[0] for motion in motions])
    assert rank(whole) == base.shape[1] == rank(base)


def rank(matrix):
    """Of the columns scaled alike; rounding does not count as a column."""
    scales = np.linalg.norm(matrix, axis=0)
    felt = scales > 1e-10 * np.max(scales)
    sizes = np.linalg.svd(matrix[:, felt] / scales[felt], compute_uv=False)
    return int(np.sum(sizes > 1e-9 * sizes[0]))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [name for name in LEG_CASES if name != "csiro_bullet_ar_leg_dh"])
def test_published_legs(tmp_path, name):
    conversion = from_tree(case(name))
    found = leg_programs(written(tmp_path, conversion.text), names=NAMES)
    assert_linear(conversion.text, conversion.feet[0], found)
    assert_minimal(found)


@pytest.mark.parametrize(
    ("name", "count"),
    [("mero_leg", 15), ("ambler_rrp", 5), ("ambler_rpp", 5)],
)
def test_counts(name, count):
    """A vertical first axis hides the mass moments that gravity does not feel; slides have masses only."""
    found = leg_programs(SPECS / f"{name}.toml", names=NAMES)
    assert found["base_parameters"].signature.outputs[1].shape == (count,)
    assert_minimal(found)


def test_mirror_images(tmp_path):
    """Parameters in the mirrored joint frames."""
    text = spec_of(f"{YAW}, {BODY}", f"{THIGH}, {BODY}", f"{SLIDE}, {BODY}") + '[[legs]]\nname = "image"\nmirror_of = "leg"\n'
    assert_linear(text, "image", leg_programs(written(tmp_path, text), 1, NAMES))


def test_runtime_parameters(tmp_path):
    """Lengths and masses in `param`: the values follow, the choice holds for all."""
    table = "[parameters]\nload = { value = 0.8, runtime = true }\nreach = { value = 0.25, runtime = true }\n"
    thigh, shank = THIGH.replace("0.3", '"reach"'), THIGH.replace("thigh", "shank")
    loaded = BODY.replace("1.1", '"load"')
    rows = [f"{YAW}, {BODY}", f"{thigh}, {BODY}", f"{shank}, {loaded}"]
    text = spec_of(*rows, parameters=table)
    found = leg_programs(written(tmp_path, text), names=NAMES)
    numbers = np.array([1.7, 0.4])
    for q, qd, qdd in states(found["regressor"], rows=3):
        tau = value(found["inverse_dynamics"], q, qd, qdd, np.zeros(3), numbers)
        parameters = standard(text, "leg", load=1.7, reach=0.4)
        assert difference(value(found["regressor"], q, qd, qdd, numbers) @ parameters, tau) <= ACCURACY
        Y, p = values(found["base_parameters"], q, qd, qdd, numbers)
        assert difference(Y @ p, tau) <= ACCURACY
    assert_minimal(found, numbers)


def assert_random(text):
    for index, leg in enumerate(Bodies(text, {}).walker.legs):
        with TemporaryDirectory() as folder:
            found = leg_programs(written(Path(folder), text), index, NAMES)
        assert_linear(text, leg.name, found)
        assert_minimal(found)


@settings(derandomize=True, deadline=None, phases=[Phase.generate], max_examples=5)
@given(specs_with_bodies(most_joints=3))
def test_random_legs(text):
    assert_random(text)


@pytest.mark.nightly
@settings(derandomize=True, deadline=None, phases=[Phase.generate], max_examples=60)
@given(specs_with_bodies(most_joints=6))
def test_many_random_legs(text):
    assert_random(text)

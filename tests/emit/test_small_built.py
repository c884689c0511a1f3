"""Where size counts: the bits of fast code from less of it, and builds without closest points and damping."""

import ctypes
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from walkgen import pipeline
from walkgen.emit.c_files import c_sources

SPECS = Path(__file__).parents[2] / "specs"
NAMES = (
    *("foot_position", "foot_position_jacobian", "foot_hessian", "foot_bias_acceleration", "inverse_branch", "inverse"),
    *("inverse_dynamics", "mass_matrix", "inverse_velocity_acceleration", "inverse_velocity", "inverse_distance"),
)
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wdouble-promotion", "-Werror", "-std=c99", "-ffp-contract=off")
LEFT_OUT = ("-DWALKGEN_NO_CLOSEST", "-DWALKGEN_NO_DAMPING")
OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
PRECISIONS = pytest.mark.parametrize("tag", ["", "_f32"])
ROWS = 300


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """The C of some functions of a leg, compiled with some flags, once."""
    known: dict[tuple[str, ...], ctypes.CDLL] = {}
    folders: dict[str, Path] = {}

    def built(robot, *flags):
        if robot not in folders:
            code = pipeline.generate(SPECS / f"{robot}.toml", pipeline.BuildOptions(float32=True))
            folders[robot] = tmp_path_factory.mktemp(robot)
            for artifact in c_sources(replace(code, functions=tuple(body for body in code.functions if body.signature.name in NAMES))):
                (folders[robot] / artifact.path).write_text(artifact.text, encoding="utf-8")
        if (robot, *flags) not in known:
            product = folders[robot] / f"{len(known)}.so"
            command = ["gcc", *STRICT, *flags, "-shared", "-fPIC", f"{robot}.c", f"{robot}_f32.c", "-o", str(product), "-lm"]
            answer = subprocess.run(command, cwd=folders[robot], capture_output=True, text=True, check=False)
            assert answer.returncode == 0, answer.stderr
            known[robot, *flags] = ctypes.CDLL(str(product))
        return known[robot, *flags]

    return built


def answers(library, function, given, outputs, statuses=0):
    """Outputs of every row by `_batch`, then the statuses."""
    real = given[0].dtype
    found = [np.full((len(given[0]), size), 7, real) for size in outputs]
    found += [np.full((len(given[0]), statuses), -1, np.int32)] if statuses else []
    call = library[function + "_batch"]
    call(ctypes.c_size_t(len(given[0])), *(ctypes.c_void_p(each.ctypes.data) for each in (*given, *found)))
    return found


def assert_same_bits(found, expected):
    for ours, theirs in zip(found, expected, strict=True):
        assert np.array_equal(ours, theirs, equal_nan=True)
        numbers = ~np.isnan(ours)
        assert np.array_equal(np.signbit(ours[numbers]), np.signbit(theirs[numbers]))


def inputs(tag, *sizes, seed=4):
    random = np.random.default_rng(seed)
    return [np.ascontiguousarray(random.uniform(-3, 3, (ROWS, size)), np.float32 if tag else np.float64) for size in sizes]


@PRECISIONS
@pytest.mark.parametrize(("robot", "leg"), [("mero_leg", "leg"), ("phantomx_leg", "right_front")])
def test_the_bits_are_those_of_fast_code(build, robot, leg, tag):
    fast, small = build(robot, "-O2", "-DWALKGEN_PLAIN"), build(robot, "-Os")
    leg = {"mero_leg": "leg", "phantomx_leg": "rf"}.get(robot, "leg")
    start = next(
        f"{robot}{tag}_{name}" for name in (leg, "leg", "right_front", "rf") if hasattr(fast, f"{robot}{tag}_{name}_foot_position")
    )
    cases = {
        "foot_position": ((3,), (3,)),
        "foot_position_jacobian": ((3,), (3, 9)),
        "foot_hessian": ((3,), (27,)),
        "foot_bias_acceleration": ((3, 3), (6,)),
        "mass_matrix": ((3,), (9,)),
        "inverse_dynamics": ((3, 3, 3, 3), (3,)),
    }
    met = 0
    for name, (sizes, outputs) in cases.items():
        if hasattr(fast, f"{start}_{name}_batch"):
            given = inputs(tag, *sizes)
            assert_same_bits(*(answers(library, f"{start}_{name}", given, outputs) for library in (small, fast)))
            met += 1
    assert met > 3
    p = targets(tag)
    assert_same_bits(*(answers(library, f"{start}_inverse", [p], (12,), 4) for library in (small, fast)))
    branches = np.arange(len(p), dtype=np.int32) % 6 - 1
    assert_same_bits(*(answers(library, f"{start}_inverse_branch", [p, branches], (3,), 1) for library in (small, fast)))


def targets(tag):
    """In and out of reach, on the axis, and no numbers."""
    (p,) = inputs(tag, 3, seed=6)
    p *= 0.25
    p[:4] = [[0, 0, 0.3], [0, 0, 0.12], [np.nan, 0, 0], [0.75, 0, 0.12]]
    return p


@PRECISIONS
def test_without_closest_points_their_rows_are_nan(build, tag):
    whole, less = build("mero_leg", "-Os"), build("mero_leg", "-Os", *LEFT_OUT)
    p = targets(tag)
    (q, status), (found, told) = (answers(each, f"mero_leg{tag}_leg_inverse", [p], (12,), 4) for each in (whole, less))
    assert {OK, UNREACHABLE, BAD_INPUT, SINGULAR} <= set(status.ravel())
    assert np.array_equal(told, status)
    missed = np.repeat(status == UNREACHABLE, 3, axis=1)
    assert np.isfinite(q[missed]).all()
    assert np.isnan(found[missed]).all()
    assert np.array_equal(found[~missed], q[~missed], equal_nan=True)
    for branch in range(4):
        one, code = answers(less, f"mero_leg{tag}_leg_inverse_branch", [p, np.full(ROWS, branch, np.int32)], (3,), 1)
        assert np.array_equal(code[:, 0], status[:, branch])
        assert np.array_equal(np.isnan(one).all(axis=1), np.isin(code[:, 0], (UNREACHABLE, BAD_INPUT)))


@PRECISIONS
@pytest.mark.parametrize(("name", "given", "found"), [("inverse_velocity", 2, 1), ("inverse_velocity_acceleration", 3, 2)])
def test_without_damping_singular_rates_are_nan(build, tag, name, given, found):
    whole, less = build("mero_leg", "-Os"), build("mero_leg", "-Os", *LEFT_OUT)
    motion = inputs(tag, *[3] * given, seed=8)
    motion[0][:3] = [[0.3, 0.5, 0], [0.1, np.pi / 2, 0], [np.nan, 0.5, -1]]
    function = f"mero_leg{tag}_leg_{name}"
    (*rates, status), (*left, told) = (answers(each, function, motion, (3,) * found, 1) for each in (whole, less))
    assert {OK, BAD_INPUT, SINGULAR} <= set(status.ravel())
    assert set(told.ravel()) == {OK, SINGULAR}
    answered = told[:, 0] == OK
    assert (status[answered] == OK).all()
    assert np.mean(answered) > 0.9 * np.mean(status == OK)
    for ours, theirs in zip(left, rates, strict=True):
        assert np.array_equal(ours[answered], theirs[answered])
        assert np.isnan(ours[~answered]).all()

"""The inverse of generated legs against solution sets that a quartic and two multistarts found: all solutions, and distances outside."""

import numpy as np
import pytest

from cases.to_spec import case, from_dh, from_tree
from oracles.measure import difference
from oracles.screws import screws
from oracles.walker import read

CASES = ("phantomx_rf_leg", "puma560_first3", "scara_cobra600_rrp", "solo12_fl_leg")
"""Three yaw-pitch-pitch legs and a general RRP."""
FUNCTIONS = ("inverse", "inverse_branch", "inverse_near", "inverse_distance")
OK, UNREACHABLE = 0, 1


@pytest.fixture(scope="module", params=["tree", "dh"])
def route(request):
    return {"tree": from_tree, "dh": lambda data, functions: from_dh(data, None, functions)}[request.param]


@pytest.fixture(scope="module", params=["c", "numpy"])
def backend(request):
    return request.param


@pytest.fixture(scope="module", params=CASES)
def leg(request, route, backend, built):
    data = case(request.param)
    conversion = route(data, FUNCTIONS)
    robot = built(conversion.text)
    loaded = robot.c if backend == "c" else robot.numpy
    return data["ik"], loaded.legs[conversion.feet[0]], screws(read(conversion.text).legs[0])


@pytest.mark.sampled(6)
def test_every_solution_is_found(leg):
    ik, generated, path = leg
    rows, states = generated.inverse([sample["p"] for sample in ik["reachable"]])
    for sample, q, status in zip(ik["reachable"], rows, states, strict=True):
        found = q[status == OK]
        assert len(found) == sample["n_solutions"]
        assert np.all((found > -np.pi) & (found <= np.pi) | ~path.turning)
        for solution in sample["solutions"]:
            assert np.min(path.apart(found, solution["q"])) <= 1e-13 + 1e-14 / solution["sigma_min"]
        assert difference(path.foot(found), np.broadcast_to(sample["p"], found.shape)) <= 1e-13


@pytest.mark.sampled(8)
def test_branches_keep_their_slots(leg):
    """One branch alone gives what all four give, status and closest point included."""
    ik, generated, _ = leg
    p = [sample["p"] for sample in (*ik["reachable"][:10], *ik["unreachable"][:5])]
    q, status = generated.inverse(p)
    for slot in range(len(generated.branch_names)):
        alone, code = generated.inverse_branch(p, slot)
        assert np.array_equal(code, status[:, slot])
        assert difference(alone, q[:, slot]) <= 1e-13


def test_a_solution_is_near_itself(leg):
    """Seeded with a published solution, that very branch comes back, some turns away too."""
    ik, generated, path = leg
    samples = [(sample["p"], solution) for sample in ik["reachable"][::5] for solution in sample["solutions"]]
    p, wanted = np.array([p for p, _ in samples]), np.array([solution["q"] for _, solution in samples])
    turns = np.resize([0, -3, 2, 1], len(p))[:, None]
    q, status = generated.inverse_near(p, wanted + np.where(path.turning, 2 * np.pi * turns, 0.0))
    assert np.all(status == OK)
    assert np.all(path.apart(q, wanted) <= 1e-13 + 1e-14 / np.array([solution["sigma_min"] for _, solution in samples]))


def test_unreachable_targets_give_the_closest_foot(leg):
    ik, generated, path = leg
    p = np.array([sample["p"] for sample in ik["unreachable"]])
    q, status = generated.inverse(p)
    assert np.all(status == UNREACHABLE)
    distances = np.linalg.norm(path.foot(q) - p[:, None], axis=-1)
    assert difference(np.min(distances, axis=1), [sample["min_distance"] for sample in ik["unreachable"]]) <= 1e-9
    assert difference(generated.inverse_distance(p), distances) <= 1e-13

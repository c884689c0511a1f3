"""The closed-form inverse against solution sets that a quartic and two multistarts found: all solutions, and distances outside."""

import numpy as np
import pytest

from cases.to_spec import case, from_dh, from_tree
from oracles.measure import difference
from oracles.walker import read

LEGS = ("phantomx_rf_leg", "puma560_first3", "solo12_fl_leg")
"""The cases whose legs are yaw-pitch-pitch."""
OK, UNREACHABLE = 0, 1


@pytest.fixture(scope="module", params=["tree", "dh"])
def route(request):
    return {"tree": from_tree, "dh": from_dh}[request.param]


@pytest.fixture(scope="module", params=["c", "numpy"])
def backend(request):
    return request.param


@pytest.fixture(scope="module", params=LEGS)
def leg(request, route, backend, built):
    data = case(request.param)
    conversion = route(data)
    robot = built(conversion.text)
    loaded = robot.c if backend == "c" else robot.numpy
    return data["ik"], loaded.legs[conversion.feet[0]], read(conversion.text).legs[0]


def turned(q, reference) -> float:
    """Greatest difference of angles modulo full turns."""
    return float(np.max(np.abs(np.angle(np.exp(1j * (np.asarray(q) - reference))))))


def test_every_solution_is_found(leg):
    ik, generated, walker = leg
    for sample in ik["reachable"]:
        q, status = generated.inverse(sample["p"])
        found = q[status == OK]
        assert len(found) == sample["n_solutions"]
        assert np.all((found > -np.pi) & (found <= np.pi))
        for solution in sample["solutions"]:
            assert min(turned(row, solution["q"]) for row in found) <= 1e-13 + 1e-14 / solution["sigma_min"]
        for row in found:
            assert difference(walker.position(row), sample["p"]) <= 1e-13


def test_branches_keep_their_slots(leg):
    """One branch alone gives what all four give, status and closest point included."""
    ik, generated, _ = leg
    for sample in (*ik["reachable"][:10], *ik["unreachable"][:5]):
        q, status = generated.inverse(sample["p"])
        for slot in range(len(generated.branch_names)):
            alone, code = generated.inverse_branch(sample["p"], slot)
            assert code == status[slot]
            assert difference(alone, q[slot]) <= 1e-13


def test_unreachable_targets_give_the_closest_foot(leg):
    ik, generated, walker = leg
    for sample in ik["unreachable"]:
        q, status = generated.inverse(sample["p"])
        assert np.all(status == UNREACHABLE)
        distances = [np.linalg.norm(walker.position(row) - sample["p"]) for row in q]
        assert abs(min(distances) - sample["min_distance"]) <= 1e-9

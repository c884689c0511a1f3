"""The general inverse against the solution sets of published legs, special ones among them forced through it."""

import numpy as np
import pytest

from cases.to_spec import case, from_dh, from_tree
from oracles.screws import screws
from oracles.walker import read
from walkgen.runtime.solves.inverse_general import inverse_general

CASES = {"phantomx_rf_leg": 8, "puma560_first3": 8, "solo12_fl_leg": 8, "scara_cobra600_rrp": 9}
OK, UNREACHABLE = 0, 1


@pytest.fixture(scope="module", params=CASES)
def leg(request):
    data = case(request.param)
    walkers = [read(route(data).text).legs[0] for route in (from_tree, from_dh)]
    return data["ik"], walkers, CASES[request.param]


def test_every_solution_is_found(leg):
    ik, walkers, sequence = leg
    turning = np.array([True, True, sequence == 8])
    for walker in walkers:
        p = np.array([sample["p"] for sample in ik["reachable"]])
        rows, status = inverse_general(screws(walker).numbers, p, sequence)
        for sample, row, state in zip(ik["reachable"], rows, status, strict=True):
            found = row[state == OK]
            assert len(found) == sample["n_solutions"]
            for solution in sample["solutions"]:
                gap = found - solution["q"]
                gap = np.where(turning, np.abs(np.angle(np.exp(1j * gap))), np.abs(gap))
                assert np.min(np.max(gap, axis=1)) <= 1e-13 + 1e-14 / solution["sigma_min"]
            assert max(np.linalg.norm(walker.position(q) - sample["p"]) for q in found) <= 1e-12


def test_unreachable_targets_give_the_closest_foot(leg):
    ik, walkers, sequence = leg
    for walker in walkers:
        p = np.array([sample["p"] for sample in ik["unreachable"]])
        rows, status = inverse_general(screws(walker).numbers, p, sequence)
        assert np.all(status == UNREACHABLE)
        for sample, row in zip(ik["unreachable"], rows, strict=True):
            distance = min(np.linalg.norm(walker.position(q) - sample["p"]) for q in row)
            assert abs(distance - sample["min_distance"]) <= 1e-9

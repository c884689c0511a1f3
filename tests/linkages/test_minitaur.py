"""The Minitaur's five-bar beside the closures, rates, masses and inverses that Pinocchio and MuJoCo computed for its published model."""

import json
from pathlib import Path

import numpy as np
import pytest

from linkages.branches import check_branches

CASE = json.loads((Path(__file__).parents[1] / "cases" / "minitaur_five_bar.json").read_text(encoding="utf-8"))
SAMPLES = CASE["samples"]


FUNCTIONS = (
    *("foot_position", "foot_jacobian", "foot_spatial_jacobian", "foot_bias_acceleration", "inverse", "inverse_branch"),
    *("mass_matrix", "bias", "gravity_torque", "inverse_dynamics"),
)


@pytest.fixture(scope="module")
def robot(shipped):
    return shipped("minitaur", FUNCTIONS)


@pytest.fixture(scope="module")
def leg(robot):
    return robot.c.legs["front_left"]


@pytest.fixture(scope="module")
def other(built, robot):
    text = robot.spec.read_text(encoding="utf-8")
    return built(text.replace('p = "right"', 'p = "left"')).c.legs["front_left"]


def chosen(leg, other, sample):
    """The leg assembled as the sample is."""
    q, p = np.array(sample["q_independent"]), np.array(sample["p"])
    return min((leg, other), key=lambda side: np.abs(side.foot_position(q) - p).max())


def test_closure_slopes_masses_and_forces(leg, other):
    modes = set()
    for sample in SAMPLES:
        side = chosen(leg, other, sample)
        modes.add(side is leg)
        q, qd, qdd = (np.array(sample[f"{key}_independent"]) for key in ("q", "qd", "qdd"))
        assert side.foot_position(q) == pytest.approx(sample["p"], abs=1e-11)
        jacobian = np.array(sample["J_reduced"])
        assert side.foot_jacobian(q) == pytest.approx(jacobian[:3], abs=1e-11)
        assert side.foot_spatial_jacobian(q) == pytest.approx(jacobian, abs=1e-10)
        scale = max(np.abs(sample["Jdot_qd_reduced"]).max(), 1)
        assert side.foot_bias_acceleration(q, qd) == pytest.approx(sample["Jdot_qd_reduced"], abs=1e-11 * scale)
        assert side.mass_matrix(q) == pytest.approx(np.array(sample["M_reduced"]), rel=1e-11)
        for name, found in (("nle_reduced", side.bias(q, qd)), ("g_reduced", side.gravity_torque(q))):
            assert found == pytest.approx(sample[name], abs=1e-11 * max(np.abs(sample[name]).max(), 1))
        assert side.inverse_dynamics(q, qd, qdd) == pytest.approx(sample["tau_independent"], abs=1e-10)
    assert modes == {True, False}


def test_all_motor_angles_of_a_foot(leg):
    for case in CASE["ik"]:
        found, status = leg.inverse(case["p"])
        wanted = [np.array(solution["q_independent"]) for solution in case["solutions"]]
        kept = found[(status == 0) | (status == 5)]
        assert len(kept) == case["n_solutions"]
        for row in wanted:
            assert min(np.abs(np.angle(np.exp(1j * (row - other)))).max() for other in kept) < 1e-11


def test_one_branch_is_its_row_of_all(robot):
    check_branches(robot)

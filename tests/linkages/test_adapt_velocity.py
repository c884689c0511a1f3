"""Rates of robots whose connecting chains carry legs with linkages, beside the weighted pseudo-inverse of their Jacobians."""

from pathlib import Path

import numpy as np
import pytest

from walkgen.errors import UnsupportedMechanism

SPEC = (Path(__file__).parents[2] / "specs" / "hydraulic_leg.toml").read_text(encoding="utf-8")
OK, BAD_INPUT = 0, 2
CHAIN = """
[generate]
functions = ["adapt_velocity", "foot_jacobians"]
targets = ["c", "casadi", "numpy"]
[chain_designs.waist]
dh = "classic"
joints = [
  { name = "yaw", type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0, limits = [-0.5, 0.5] },
  { name = "slide", type = "prismatic", a = 0.0, alpha_deg = 90, d = 0.2, theta_deg = 90, limits = [-0.1, 0.1] },
  { name = "roll", type = "revolute", a = 0.0, alpha_deg = 20, d = 0.25 },
]
[[leg_designs.hydraulic.joints]]
"""
REAR = """
[[platforms]]
name = "rear"
parent = "body"
chain = "waist"
root = { xyz = [-0.30, 0.0, 0.0], rpy_deg = [0, 0, 170] }
end = { xyz = [0.1, 0.02, 0.0], rpy_deg = [10, 0, 0] }
[[legs]]
name = "rear_left"
design = "hydraulic"
platform = "rear"
mount = { xyz = [0.3, 0.2, 0.0], rpy_deg = [0, 0, 20] }
[[legs]]
name = "rear_right"
mirror_of = "rear_left"
"""
ROBOT = SPEC.replace("[[leg_designs.hydraulic.joints]]", CHAIN, 1).replace("limits_deg = [-45, 45]", "", 1) + REAR
Q = np.array([0.2, 0.03, -0.4, 0.3, 0.28, 0.30, -0.5, 0.31, 0.33, 0.7, 0.27, 0.29])
HALF = np.array([0.5, 0.1, np.pi, *[np.pi, 0.1, 0.1] * 3])
"""Of every joint's limits, half a turn where there are none."""


@pytest.fixture(scope="module", params=["c", "numpy"])
def robot(request, built):
    return getattr(built(ROBOT), request.param)


def test_rates_are_the_nearest_that_move_the_feet_so(robot):
    random = np.random.default_rng(3)
    assert len(Q) == len(robot.joint_names)
    xd, qd0 = random.normal(size=(3, 3)), random.normal(size=12)
    J = robot.foot_jacobians(Q).reshape(9, 12)
    assert np.linalg.matrix_rank(J) == 9
    spread = HALF[:, None] ** 2 * J.T
    for wanted, arguments in ((qd0, (qd0,)), (np.zeros(12), ())):
        qd, status = robot.adapt_velocity(Q, xd, *arguments)
        assert status == OK
        assert qd == pytest.approx(wanted + spread @ np.linalg.solve(J @ spread, xd.ravel() - J @ wanted), abs=1e-10)


def test_where_it_does_not_assemble_is_bad_input(robot):
    far = Q.copy()
    far[4] = 9.0
    qd, status = robot.adapt_velocity(far, np.zeros((3, 3)))
    assert status == BAD_INPUT
    assert np.isnan(qd).all()


def test_its_absence_is_explained(built):
    with pytest.raises(UnsupportedMechanism, match="exactly three q"):
        built(ROBOT).c.adapt(np.zeros((3, 3)))
    with pytest.raises(UnsupportedMechanism):
        built(ROBOT).c.casadi("adapt_velocity")

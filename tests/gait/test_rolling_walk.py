"""A biped whose feet stand flat and roll over their toes: soles on the ground without slipping, joints that move smoothly."""

from pathlib import Path

import numpy as np
import pytest

from walkgen.gait.pattern import Gait
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.trajectory import Trajectory

SPEC = Path(__file__).parents[2] / "specs" / "anthropomorphic_biped.toml"
TEXT = SPEC.read_text(encoding="utf-8")
PERIOD, DUTY, STRIDE = 1.2, 0.6, 0.7
FUNCTIONS = (
    *("foot_position", "foot_jacobian", "foot_bias_acceleration", "foot_positions", "foot_jacobians"),
    *("link_angles", "joint_angles", "flat_motion", "hip_position", "toe_rolling"),
)
STANCE = ((0.0, 0.10, -0.82), (0.0, -0.10, -0.82))


@pytest.fixture
def walk(built):
    """Two cycles, and the robot."""
    wanted = ", ".join(f'"{name}"' for name in FUNCTIONS)
    robot = built(f"{TEXT}\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy']\n").c
    gait = Gait(("left", "right"), (DUTY, DUTY), (0.0, 0.5), PERIOD, STRIDE)
    return simulate(robot, Trajectory(gait, STANCE, 0.06), options=Options(cycles=2, rate=500.0)), robot


def test_joints_are_smooth_and_reached(walk):
    found, _ = walk
    assert (found.statuses == 0).all()
    assert {fault.kind for fault in found.faults} == {"mass"}  # its dynamics are not built
    step = found.times[1] - found.times[0]
    for value, rate in ((found.q, found.qd), (found.qd, found.qdd)):
        assert np.isfinite(value).all()
        slopes = (value[2:] - value[:-2]) / (2 * step)
        assert np.abs(slopes - rate[1:-1]).max() < 0.02 * np.abs(rate).max()


def test_soles_are_on_the_ground_and_do_not_slip(walk):
    found, robot = walk
    assert np.abs(found.feet[..., 2][found.stance]).max() < 1e-12
    assert found.feet[..., 2].min() > -1e-12
    speed = STRIDE / PERIOD
    for number, leg in enumerate(robot.legs.values()):
        stands = found.stance[:, number]
        q, qd = found.q[:, leg.slice], found.qd[:, leg.slice]
        moved = np.einsum("tij,tj->ti", leg.foot_jacobian(q), qd)
        assert np.abs(moved[stands] + [speed, 0.0, 0.0]).max() < 1e-9


def test_feet_stand_flat_then_roll_over_their_toes(walk):
    found, robot = walk
    leg = robot.legs["left"]
    angle = leg.link_angles(found.q[:, leg.slice])[:, 2]
    u = (found.times / PERIOD) % 1.0
    flat = u < 0.5 * DUTY - 1e-9
    assert np.abs(angle[flat] + np.pi / 2).max() < 1e-12
    rolling = (u > 0.55 * DUTY) & (u < DUTY)
    assert (angle[rolling] < -np.pi / 2).all()
    assert np.degrees(angle.min()) < -110
    point = found.feet[:, 0, 0]
    ahead = np.diff(point)[rolling[1:] & rolling[:-1] & (np.diff(u) > 0)]
    assert (ahead >= -1e-12).all()
    assert ahead.sum() > 0.05  # the contact point goes forward as the toe rolls

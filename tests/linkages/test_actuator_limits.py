"""Forces at the feet of a robot whose legs are linkages, such that no actuator has to give more than it can."""

from pathlib import Path

import numpy as np
import pytest

SPEC = (Path(__file__).parents[2] / "specs" / "minitaur.toml").read_text(encoding="utf-8")
FUNCTIONS = ("foot_positions", "foot_jacobians", "foot_torque", "contact_forces", "contact_forces_limited")
WANTED = f"generate = {{ functions = {list(FUNCTIONS)}, targets = ['numpy'] }}\n\n[robot]"
LOAD = np.array([0.0, 0.0, -60.0, -1.2, 1.8, 0.0])  # 60 N at x 0.03, y 0.02


def leg(corner):
    """One more, on another corner of the body."""
    x, y = 0.21 * corner[0], 0.06 * corner[1]
    name = f"{'front' if x > 0 else 'rear'}_{'left' if y > 0 else 'right'}"
    mount = f"xyz = [{x}, {y}, 0.0], rpy = [1.57, 0, 0]"
    return f'[[legs]]\nname = "{name}"\ndesign = "five_bar"\nplatform = "body"\nmount = {{ {mount} }}\n'


@pytest.mark.nightly
def test_actuators_within_their_limits(built):
    robot = built(SPEC.replace("[robot]", WANTED, 1) + "".join(map(leg, ((-1, 1), (1, -1), (-1, -1))))).numpy
    q = np.random.default_rng(2).uniform(-0.2, 0.2, len(robot.joint_names)) + 1.0
    points, jacobians = robot.foot_positions(q), robot.foot_jacobians(q)
    rows = -np.moveaxis(jacobians, -1, 0)  # what the drives give to hold the ground's forces: -J' f
    given = {"points": points, "normals": np.tile([0.0, 0.0, 1.0], (4, 1)), "mu": np.full(4, 0.8), "wrench": LOAD}
    free, status, *_ = robot.contact_forces(**given)
    assert status == 0
    efforts = np.einsum("rki,ki->r", rows, free)
    by_leg = np.concatenate([leg.foot_torque(q[leg.slice], -force) for leg, force in zip(robot.legs.values(), free, strict=True)])
    assert np.abs(efforts - by_leg).max() <= 1e-12
    most = 0.9 * np.abs(efforts).max()
    held, status, *_ = robot.contact_forces(**given, torque_rows=np.concatenate([rows, -rows]), torque_limits=np.full(2 * len(q), most))
    assert status == 0
    assert np.abs(held.sum(0) + LOAD[:3]).max() <= 1e-8
    assert np.abs(np.cross(points, held).sum(0) + LOAD[3:]).max() <= 1e-8
    limited = np.abs(np.einsum("rki,ki->r", rows, held))
    assert limited.max() <= most * (1 + 1e-8)
    assert limited.max() >= most * (1 - 1e-6)  # the limit is felt
    assert np.sum(held**2) > np.sum(free**2)

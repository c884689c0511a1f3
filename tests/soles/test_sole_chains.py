"""A robot of two platforms with a leg on a curved sole on each: what the joints between them carry, beside free bodies."""

import numpy as np
import pytest
from rolling_robots import LEG, robot_of

from oracles.walker import read

FUNCTIONS = ("chain_reactions", "foot_positions", "joint_angles", "platform_poses", "contact_points", "sole_points")
CHAIN = """
[[chain_designs.waist.joints]]
name = "yaw"
type = "revolute"
xyz = [-0.3, 0.0, 0.05]
axis = [0, 0, 1]

[[chain_designs.waist.joints]]
name = "pitch"
type = "revolute"
xyz = [-0.1, 0.02, 0.0]
axis = [0, 1, 0]

[[platforms]]
name = "tail"
parent = "pelvis"
chain = "waist"
end = { xyz = [-0.3, 0.0, -0.05] }
mass = 20.0
com = [0.0, 0.0, 0.0]
inertia = [1.0, 0.8, 0.5, 0.0, 0.0, 0.0]
"""
BEHIND = """
[[legs]]
name = "behind"
design = "leg"
platform = "tail"
mount = { xyz = [0.05, 0.1, -0.02], rpy_deg = [90, 0, 0] }
"""
FEET = {"flat": -np.pi / 2, "toe": -2.0, "heel": -1.3}
TOE, HEEL = ((0.03, 0.12), (0.06, 0.09)), ((0.04, -0.06), (0.05, 0.05))
"""Centre and semi-axes of the curves' ellipses, along the foot's x and y."""


def two_platforms():
    wanted = ", ".join(f'"{name}"' for name in FUNCTIONS)
    text = LEG.replace('name = "anthropomorphic_leg"', 'name = "pulled"')
    return f"{text}{CHAIN}{BEHIND}\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy', 'casadi']\n"


def touching(pose):
    """Where a sole touches the level ground under its foot frame's pose: the ellipses' supporting points, below the ankle where flat."""
    down = pose[:3, :3].T @ [0.0, 0.0, -1.0]
    if abs(down[1]) < 1e-9:
        return (pose @ [0.09, 0.0, 0.0, 1.0])[:3]
    centre, axes = map(np.array, TOE if down[1] > 0 else HEEL)
    away = axes**2 * down[:2]
    return (pose @ [*(centre + away / np.sqrt(away @ down[:2])), 0.0, 1.0])[:3]


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_what_lies_beyond_a_joint_is_in_equilibrium(built, backend):
    text = two_platforms()
    made, walker, random = built(text), read(text), np.random.default_rng(7)
    robot = robot_of(made, backend)
    for foot in FEET.values():
        q = np.zeros(8)
        q[walker.slice("tail")] = random.uniform(-0.5, 0.5, 2)
        for leg in robot.legs.values():
            q[leg.slice] = leg.joint_angles([-1.2, -2.2, foot])
        forces, loads = random.normal(size=(2, 3)), random.normal(size=(2, 6))
        call = robot.chain_reactions if backend != "casadi" else lambda *given: np.array(robot.casadi("chain_reactions")(*given))
        found = call(q, forces, loads)
        tail, behind = walker.platform_pose("tail", q), walker.legs[1]
        point = touching(behind.pose(q[walker.slice("behind")]))
        place = tail[:3, :3] @ point + tail[:3, 3]
        assert robot.foot_positions(q)[1] == pytest.approx(place, abs=1e-12)
        chain = walker.chains["tail"]
        stands = [frame[:3, 3] for frame in chain.frames(q[walker.slice(chain.name)])[1:3]]
        for row, stand in zip(found, stands, strict=True):
            assert row[:3] == pytest.approx(forces[1] + loads[1, :3], abs=1e-13)
            moment = np.cross(place - stand, forces[1]) + loads[1, 3:] - np.cross(stand, loads[1, :3])
            assert row[3:] == pytest.approx(moment, abs=1e-12)

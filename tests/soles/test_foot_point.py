"""A curved sole as a foot: its point is the lowest one, its slopes are those of no slip, its forces those of the dynamics."""

import numpy as np
import pytest
from rolling_robots import CURVES, LEG, called, leg_text, random_states

from walkgen.selftest import run

FUNCTIONS = ("foot_position", "foot_jacobian", "foot_velocity", "foot_acceleration", "inverse_dynamics", "toe_motion", "toe_rolling")
MORE = (
    *("contact_line", "sole_points", "sole_normal", "joint_angles", "link_angles", "stance_forces_load", "flat_motion"),
    *("foot_rotation", "foot_pose", "joint_frames"),
)
WHOLE = ("foot_positions", "foot_jacobians", "contact_points", "contact_normals", "floating_inverse_dynamics")
YAW = """[[leg_designs.leg.joints]]
name = "yaw"
type = "revolute"
a = 0.0
alpha_deg = 90
d = 0.0

[[leg_designs.leg.joints]]
name = "hip\""""
PAIR = """
[[legs]]
name = "right"
mirror_of = "leg"
"""


def two_legs():
    """A yaw joint before the hip, a shifted and turned foot frame, and the mirrored leg."""
    text = LEG.replace('[[leg_designs.leg.joints]]\nname = "hip"', YAW, 1).replace(
        "mount = { rpy_deg = [90, 0, 0] }", "mount = { xyz = [0.0, 0.1, 0.0] }"
    )
    text = text.replace("foot = { xyz = [0.0, 0.0, 0.0] }", "foot = { xyz = [0.01, 0.02, 0.0], rpy_deg = [0, 0, 10] }")
    wanted = ", ".join(f'"{name}"' for name in (*FUNCTIONS, *MORE, *WHOLE))
    return (
        text.replace('name = "anthropomorphic_leg"', 'name = "pair"')
        + PAIR
        + f"\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy']\n"
    )


@pytest.fixture
def single(built):
    return built(leg_text(functions=FUNCTIONS + MORE, name="standing"))


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_of_rolling_states(single, backend):
    """It is where the theory has it; the joints move it back as fast as the hip goes on; torques are those of the forces."""
    hip, thigh, edge, _, _ = random_states(single, (0.0, np.radians(75)), 30, 21)
    leg = single.c.legs["leg"]
    _, angles, point, ankle, _, status = leg.toe_motion(hip, thigh, edge)
    hip, angles, point, ankle = (part[status == 0] for part in (hip, angles, point, ankle))
    q, qd, qdd = (leg.joint_angles(np.ascontiguousarray(angles[:, order])) for order in range(3))
    for row in range(len(hip) if backend != "casadi" else 5):
        (place,), (jacobian,) = (called(single, backend, name, q[row]) for name in ("foot_position", "foot_jacobian"))
        assert place[[0, 2]] == pytest.approx(point[row] - hip[row, 0], abs=1e-13)
        assert (jacobian @ qd[row])[[0, 2]] == pytest.approx(-hip[row, 1], abs=1e-12)
        held = hip[row].copy()
        held[1:] = 0.0
        found = leg.stance_forces_load(held, angles[row], (-30.0, -500.0), point[row, 0] - ankle[row, 0, 0], 0.6)
        ground = np.array([found[4][0], 0.0, found[4][1]])
        (torque,) = called(single, backend, "inverse_dynamics", q[row], qd[row], qdd[row], ground)
        assert torque == pytest.approx(found[0], rel=1e-11, abs=1e-10)


def outline():
    """Points of the sole in its foot frame, dense."""
    toe, heel, flat = np.linspace(0, np.radians(75), 4001), np.linspace(0, np.radians(60), 4001), np.linspace(-0.06, 0.12, 101)
    front = np.stack([0.09 - 0.06 * (1 - np.cos(toe)), 0.12 + 0.09 * np.sin(toe)], -1)
    rear = np.stack([0.09 - 0.05 * (1 - np.cos(heel)), -0.06 - 0.05 * np.sin(heel)], -1)
    return np.concatenate([front, rear, np.stack([np.full(101, 0.09), flat], -1)])


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_it_is_the_lowest_point_of_the_sole(built, backend):
    """Of a leg that yaws, with a foot frame of its own, and of its mirror image, for any joint values."""
    made = built(two_legs())
    robot = made.c if backend == "c" else made.numpy
    random = np.random.default_rng(5)
    q = random.uniform([-0.8, -2.6, -1.5, -0.6], [0.8, -0.4, 0.0, 2.0], (200, 4))
    points = outline()
    for leg, side in zip(robot.legs.values(), (1.0, -1.0), strict=True):
        place = leg.foot_position(q)
        pose = leg.foot_pose(q)
        rotation = leg.foot_rotation(q)
        # the foot frame's origin, from the frame of the ankle
        ankle = leg.joint_frames(q)[:, -1]
        shift = np.array([0.01, side * 0.02, 0.0])
        origin = ankle[:, :3, 3] + np.einsum("nij,j->ni", ankle[:, :3, :3], shift)
        local = np.column_stack([points[:, 0], side * points[:, 1], np.zeros(len(points))])
        world = origin[:, None] + np.einsum("nij,mj->nmi", rotation, local)
        lowest = world[:, :, 2].min(axis=1)
        assert (place[:, 2] <= lowest + 1e-12).all()
        assert np.abs(place[:, 2] - lowest).max() < 1e-7
        assert np.linalg.norm(world - place[:, None], axis=2).min(axis=1).max() < 1e-4
        assert np.abs(pose[:, :3, 3] - place).max() == 0.0
        line = leg.contact_line(q)
        assert np.abs(line.mean(axis=1) - place).max() < 1e-15
        assert np.abs(line[:, 0] - line[:, 1] - 0.1 * rotation[:, :, 2]).max() < 1e-15
    mine, theirs = (leg.foot_position(q) for leg in robot.legs.values())
    assert np.abs(mine * [1, -1, 1] - theirs).max() < 1e-13
    whole = np.concatenate([q, q], axis=1)
    assert np.abs(robot.foot_positions(whole) - np.stack([mine, theirs], 1)).max() < 1e-13
    angles = [leg.link_angles(q) for leg in robot.legs.values()]
    assert np.abs(angles[0] - angles[1]).max() < 1e-14
    assert np.abs(np.abs(angles[0][:, 0] + np.pi / 2) - np.abs(q[:, 1] + np.pi / 2)).max() < 1e-12


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_it_stands_on_its_flat_part_or_on_a_line(single, backend):
    """Once round the flat part where that lies on the ground, else twice the line where the sole is lowest; the normal is up."""
    leg = single.c.legs["leg"]
    for foot in (-np.pi / 2, -np.pi / 2 - 1e-10, -2.0, -1.3):
        q = leg.joint_angles([-1.2, -2.2, foot])
        (points,), (normal,) = (called(single, backend, name, q) for name in ("sole_points", "sole_normal"))
        line, ankle = leg.contact_line(q), leg.joint_frames(q)[-1, :3, 3]
        flat = [ankle + np.array([y, z, -0.09]) for y, z in ((0.12, -0.05), (-0.06, -0.05), (-0.06, 0.05), (0.12, 0.05))]
        wanted = flat if abs(foot + np.pi / 2) < 1e-9 else line[[0, 0, 1, 1]]
        assert np.abs(points - wanted).max() < 1e-10
        assert np.abs(normal - [0.0, 0.0, 1.0]).max() < 1e-15


def test_both_feet_of_a_robot(built):
    robot = built(two_legs()).c
    q = np.random.default_rng(6).uniform([-0.8, -2.6, -1.5, -0.6] * 2, [0.8, -0.4, 0.0, 2.0] * 2, (50, 8))
    legs = robot.legs.values()
    assert np.abs(robot.contact_points(q) - np.concatenate([leg.sole_points(q[:, leg.slice]) for leg in legs], axis=1)).max() < 1e-14
    assert np.abs(robot.contact_normals(q) - [0.0, 0.0, 1.0]).max() < 1e-14


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_without_a_width_it_stands_on_two_points_of_its_plane(built, backend):
    made = built(leg_text(functions=("sole_points", "foot_position", "joint_angles"), name="thin").replace("width = 0.10\n", ""))
    leg = (made.c if backend == "c" else made.numpy).legs["leg"]
    flat, rolling = (leg.joint_angles([-1.2, -2.2, foot]) for foot in (-np.pi / 2, -2.0))
    assert leg.sole_points(flat) - leg.foot_position(flat) == pytest.approx(np.array([[0.12, 0.0, 0.0], [-0.06, 0.0, 0.0]]), abs=1e-14)
    assert np.abs(leg.sole_points(rolling) - leg.foot_position(rolling)).max() == 0.0


def test_nan_passes_through(single):
    leg = single.c.legs["leg"]
    assert np.isnan(leg.foot_position([np.nan, -0.5, 0.5])).any()
    assert np.isnan(leg.sole_points([np.nan, -0.5, 0.5])).any(axis=1).all()
    assert np.isnan(single.numpy.legs["leg"].foot_position([np.nan, -0.5, 0.5])).any()


def test_flat_feet_stand_below_the_ankle(single):
    leg = single.c.legs["leg"]
    q = leg.joint_angles([-1.2, -2.2, -np.pi / 2])
    ankle = leg.joint_frames(q)[-1, :3, 3]
    assert leg.foot_position(q) == pytest.approx(ankle - [0.0, 0.0, 0.09], abs=1e-14)


@pytest.mark.nightly
def test_self_test(built, capfd):
    made = built(two_legs())
    assert run(made.folder) == 0
    assert ", 0 failed" in capfd.readouterr().out


@pytest.mark.nightly
@pytest.mark.parametrize("curve", ["spline", "late"])
def test_self_test_of_other_toes(built, curve):
    made = built(leg_text(CURVES[curve], FUNCTIONS[:4], "toed"))
    assert run(made.folder) == 0

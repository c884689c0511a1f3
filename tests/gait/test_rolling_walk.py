"""A biped whose feet stand flat and roll over their toes: soles on the ground without slipping, smooth joints, a load that is carried."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from walkgen.gait.ground import Relief, Slope
from walkgen.gait.leaning import leaned
from walkgen.gait.pattern import Gait
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.sole_outline import section
from walkgen.gait.standing import crowd
from walkgen.gait.trajectory import Trajectory

SPEC = Path(__file__).parents[2] / "specs" / "anthropomorphic_biped.toml"
TEXT = SPEC.read_text(encoding="utf-8")
PERIOD, DUTY, STRIDE, HEEL_OFF = 2.6, 0.75, 0.64, 0.8
REAR, FRONT, WIDTH = -0.08, 0.14, 0.14
FUNCTIONS = (
    *("foot_position", "foot_jacobian", "foot_spatial_jacobian", "foot_bias_acceleration", "foot_positions", "foot_jacobians"),
    *("link_angles", "joint_angles", "flat_motion", "hip_position", "toe_rolling", "joint_frames"),
    *("contact_points", "sole_points", "com", "demanded_wrench", "floating_inverse_dynamics", "floating_mass_matrix"),
    *("contact_forces", "stability_margins"),
)
STANCE = ((0.012, 0.05, -0.82), (0.012, -0.05, -0.82))
GAIT = Gait(("left", "right"), (DUTY, DUTY), (0.0, 0.5), PERIOD, STRIDE)
AHEAD = Trajectory(GAIT, STANCE, 0.06, HEEL_OFF)


def biped_text(text=TEXT):
    wanted = ", ".join(f'"{name}"' for name in FUNCTIONS)
    return f"{text}\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy']\n"


@pytest.fixture(scope="module")
def biped(built):
    return built(biped_text()).c


@pytest.fixture(scope="module")
def walk(biped):
    """Two cycles, and the robot."""
    return simulate(biped, AHEAD, options=Options(cycles=2, rate=500.0)), biped


def test_joints_are_smooth_and_reached(walk):
    found, _ = walk
    assert (found.statuses == 0).all()
    assert found.feasible, found.faults
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
    flat = u < HEEL_OFF * DUTY - 1e-9
    assert np.abs(angle[flat] + np.pi / 2).max() < 1e-12
    rolling = (u > (HEEL_OFF + 0.02) * DUTY) & (u < DUTY)
    assert (angle[rolling] < -np.pi / 2).all()
    assert np.degrees(angle.min()) < -110
    point = found.feet[:, 0, 0]
    ahead = np.diff(point)[rolling[1:] & rolling[:-1] & (np.diff(u) > 0)]
    assert (ahead >= -1e-12).all()
    assert ahead.sum() > 0.05  # the contact point goes forward as the toe rolls


def region(found, robot, row):
    """Corners of what supports at an instant, out of the spec's numbers and where the soles touch."""
    corners = []
    for number, leg in enumerate(robot.legs.values()):
        if found.stance[row, number]:
            x, y, _ = found.feet[row, number]
            flat = abs(leg.link_angles(found.q[row, leg.slice])[2] + np.pi / 2) < 1e-9
            corners += [[x + along, y + side * WIDTH / 2] for along in ((REAR, FRONT) if flat else (0.0,)) for side in (1, -1)]
    return np.array(corners)


def inside(corners, point):
    """Of the hull; negative outside, where only the line of the nearest edge counts."""
    edges = ConvexHull(corners).equations
    return -(edges[:, :2] @ point + edges[:, 2]).max()


def test_margins_are_those_of_soles(walk):
    """The centre of mass, and the zero moment point, in a hull by qhull of flat parts and contact lines."""
    found, robot = walk
    assert found.least_margin > 0.015
    assert found.least_dynamic_margin > 0.01
    v, a = velocities(found)
    load = robot.demanded_wrench(found.base_pose, found.q, v, a)
    for row in range(0, len(found.times), 7):
        corners = region(found, robot, row)
        assert found.margins.static[row] == pytest.approx(inside(corners, found.com[row, :2]), abs=1e-9)
        (_, _, fz), (mx, my, _) = load[row].reshape(2, 3)
        assert found.margins.dynamic[row] == pytest.approx(inside(corners, np.array([-my / fz, mx / fz])), abs=1e-9)


def velocities(found):
    """v and a of the robot: the platform keeps its velocity and does not turn."""
    base = np.zeros((len(found.times), 6))
    base[:, 0] = STRIDE / PERIOD
    return np.concatenate([base, found.qd], axis=1), np.concatenate([0.0 * base, found.qdd], axis=1)


def test_joints_take_the_power_that_moves_the_robot(walk):
    """The ground does no work on soles that roll: what all joints give is the rate of the robot's energy, by differences."""
    found, robot = walk
    v, _ = velocities(found)
    mass = robot.floating_mass_matrix(found.base_pose, found.q)
    energy = 0.5 * np.einsum("ti,tij,tj->t", v, mass, v) + mass[0, 0, 0] * 9.80665 * found.com[:, 2]
    rate = (energy[2:] - energy[:-2]) / (found.times[2:] - found.times[:-2])
    power = found.power.total.sum(axis=1)[1:-1]
    still = np.ones(len(power), bool)
    changes = np.flatnonzero((np.diff(found.stance.astype(int), axis=0) != 0).any(axis=1))
    for change in changes:
        still[max(change - 2, 0) : change + 3] = False  # jerks of lifts and placings
    assert np.abs(power - rate)[still].max() < 2e-3 * np.abs(power).max()
    assert np.abs(found.power.torque).max() < 250.0


def test_from_rest_to_rest(biped):
    """The foot that goes first is lifted flat, as the load is not ahead of its toe in time; in the middle of the walk all roll."""
    found = simulate(biped, AHEAD, options=Options(cycles=4, rate=100.0, from_rest=True))
    assert found.feasible, found.faults
    assert found.least_margin > 0.015
    for row in (0, -1):
        assert np.abs(found.qd[row]).max() < 1e-12
        assert found.stance[row].all()
    step = found.times[1] - found.times[0]
    slopes = (found.q[2:] - found.q[:-2]) / (2 * step)
    assert np.abs(slopes - found.qd[1:-1]).max() < 0.02 * np.abs(found.qd).max()
    turned = []
    for number, leg in enumerate(biped.legs.values()):
        angle = leg.link_angles(found.q[:, leg.slice])[:, 2]
        ends = np.flatnonzero(np.diff(found.stance[:, number].astype(int)) == -1)
        turned += zip(ends, angle[ends] + np.pi / 2, strict=True)
    angles = np.array([angle for _, angle in sorted(turned)])
    assert abs(angles[0]) < 1e-12
    assert ((np.abs(angles) < 1e-12) | (angles < -0.9)).all()
    assert (angles < -0.9).sum() >= 5


@pytest.mark.parametrize(("degrees", "heading"), [(10.0, 0.0), (3.0, 0.2), (0.0, 0.7), (-5.0, 0.0), (5.0, np.pi)])
def test_a_slope_is_walked_like_level_ground(biped, degrees, heading):
    """Feet further down keep the load over them; any heading; soles flat on the plane or rolling on it."""
    ground, options = Slope(np.radians(degrees)), Options(cycles=1, rate=50.0, heading=heading)
    found = simulate(biped, leaned(biped, AHEAD, ground, options), ground, options)
    assert found.feasible, found.faults
    assert found.slip < 1e-12
    normal = np.array([-np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))])
    assert np.abs(found.feet[found.stance] @ normal).max() < 1e-12
    assert np.abs((found.standing.points @ normal)[found.standing.support]).max() < 1e-12
    level = simulate(biped, AHEAD, options=options)
    shares = [float(np.mean(load_ahead(walk)[:-1])) for walk in (found, level)]
    assert shares[0] == pytest.approx(shares[1], abs=2e-5)


def load_ahead(walk):
    """By how much the vertical through the centre of mass meets the ground's plane ahead of the feet's places in the walk [t] (m)."""
    rotation, origin = walk.base_pose[:, :3, :3], walk.base_pose[:, :3, 3]
    com, up = np.einsum("tij,ti->tj", rotation, walk.com - origin), rotation[:, 2]
    x, _, z = np.mean(walk.trajectory.stance, axis=0)
    return com[:, 0] - x - (com[:, 2] - z) * up[:, 0] / up[:, 2]


def test_level_ground_moves_no_stance(biped):
    assert leaned(biped, AHEAD, Slope(), Options()) is AHEAD


@pytest.mark.parametrize(
    ("options", "ground", "says"),
    [
        (Options(), Relief(lambda x, _: 0.02 * np.sin(3 * x)), "off one by 0"),
        (Options(body="waved", margin=0.01), Slope(), "planes of their own"),
    ],
)
def test_what_soles_cannot_roll_on_is_refused(biped, options, ground, says):
    with pytest.raises(ValueError, match=says):
        simulate(biped, AHEAD, ground, options)


@pytest.mark.nightly
def test_a_leg_that_looks_back_is_refused(built):
    turned = TEXT.replace("0.09, 0.0], rpy_deg = [90, 0, 0]", "0.09, 0.0], rpy_deg = [90, 0, 180]")
    assert turned != TEXT
    robot = built(biped_text(turned)).numpy
    with pytest.raises(ValueError, match="does not roll forward"):
        simulate(robot, AHEAD)


def test_a_foothold_beside_the_leg_is_out_of_reach(biped):
    stance = ((0.012, 0.06, -0.82), STANCE[1])
    found = simulate(biped, Trajectory(GAIT, stance, 0.06, HEEL_OFF), options=Options(cycles=1, rate=50.0))
    (fault,) = (fault for fault in found.faults if fault.kind == "reach")
    assert (fault.subject, fault.amount) == ("left", pytest.approx(0.01))


def test_outline_of_a_sole(biped):
    """From heel to toe: on the ellipses of the spec, and along the flat part."""
    x, y = section(biped.legs["left"]).T
    toe, heel = y > FRONT + 1e-6, y < REAR - 1e-6
    assert np.abs(((y[toe] - FRONT) / 0.06) ** 2 + ((x[toe] - 0.03) / 0.06) ** 2 - 1).max() < 1e-9
    assert np.abs(((y[heel] - REAR) / 0.04) ** 2 + ((x[heel] - 0.04) / 0.05) ** 2 - 1).max() < 1e-9
    assert (np.diff(y) > 0).all()
    assert y.min() == pytest.approx(REAR - 0.04 * np.sin(np.radians(60)), abs=2e-3)


def test_corners_that_support_at_once(biped):
    """What counts is how many there are at an instant, not how many there are in all."""
    legs = {
        str(number): SimpleNamespace(functions={"sole_points"}, joints=(), sole_points=lambda _: np.zeros((4, 3))) for number in range(6)
    }
    robot, times = SimpleNamespace(legs=legs, contact_points=None), np.array([0.0, 0.5])
    tripod = np.array([[True, False] * 3, [False, True] * 3])
    assert crowd(robot, tripod, times) == ""
    both = np.array([[True, False] * 3, [True] * 5 + [False]])
    assert crowd(robot, both, times) == "5 feet stand on 20 corners at t = 0.5 s; contact forces have room for 16"
    assert crowd(SimpleNamespace(legs=legs), both, times) == ""  # built without corners all feet are points
    assert crowd(biped, np.ones((2, 2), bool), times) == ""

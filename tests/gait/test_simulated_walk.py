"""Simulated walks: feet that stay where they stand, motions without jumps, chains that adapt, energy that is conserved."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from walkgen.gait.chains import best_poses
from walkgen.gait.course import Pace, course
from walkgen.gait.ground import Described, Grid, Relief, Slope
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.spline import Spline
from walkgen.gait.stance_margins import margins
from walkgen.gait.standing import Standing
from walkgen.gait.trajectory import Trajectory
from walkgen.signature import STATUSES
from walkgen.walking import walked
from walkgen.walking_request import Wanted

SLOPE = Slope(np.radians(8))
HILLS = Relief(lambda x, y: 0.02 * np.sin(3 * x) + 0.05 * x * y)
WALKS = {
    "steady": (Slope(), Options()),
    "rest": (Slope(), Options(from_rest=True)),
    "slope": (SLOPE, Options(from_rest=True)),
    "hills": (HILLS, Options(heading=0.4)),
    "adapted": (HILLS, Options(adapt=True, from_rest=True)),
    "waved": (Slope(), Options(body="waved", margin=0.04)),
    "swinging": (SLOPE, Options(body="swinging", margin=0.02)),
}


@pytest.fixture(scope="module")
def robot(duo):
    return walked(duo, Wanted(cycles=1, rate=10.0)).robot


@pytest.fixture(scope="module")
def trajectory(robot):
    return Trajectory.of(robot.gaits["crawl"])


@pytest.fixture(scope="module", params=WALKS)
def case(request, robot, trajectory):
    ground, options = WALKS[request.param]
    return robot, ground, options, simulate(robot, trajectory, ground, options)


def test_a_walk_of_twenty_cycles_does_not_slip(robot, trajectory):
    walk = simulate(robot, trajectory, HILLS, Options(cycles=20, adapt=True))
    assert walk.slip < 1e-9
    for foot in range(4):
        held = walk.feet[walk.stance[:, foot], foot]
        holds = walk.holds.point[walk.holds.leg == foot]
        nearest = np.linalg.norm(held[:, None] - holds, axis=-1).min(axis=1)
        assert nearest.max() < 1e-9


def test_feet_stand_on_the_ground_and_rise_in_between(case):
    _, ground, _, walk = case
    x, y, z = np.moveaxis(walk.feet, -1, 0)
    above = z - ground.height(x, y)
    assert np.abs(above[walk.stance]).max() < 1e-9
    assert above[~walk.stance].max() > 0.045
    assert above.min() > -1e-9


def test_rates_are_derivatives(case):
    """Against differences of a finer walk: second order, so a quarter of the error at half the step."""
    robot, ground, options, _ = case
    errors = []
    for rate in (400.0, 800.0):
        fine = simulate(robot, Trajectory.of(robot.gaits["crawl"]), ground, Options(**{**vars(options), "rate": rate, "cycles": 1}))
        step = fine.times[1] - fine.times[0]
        qd = np.abs((fine.q[2:] - fine.q[:-2]) / (2 * step) - fine.qd[1:-1]).max()
        qdd = np.abs((fine.qd[2:] - fine.qd[:-2]) / (2 * step) - fine.qdd[1:-1]).max()
        errors.append((qd, qdd))
    (qd, qdd), (finer, jerky) = errors
    assert finer < 0.3 * qd
    assert jerky < 0.6 * qdd  # the jerk jumps at touch-down
    assert finer < 1e-3 * np.abs(fine.qd).max()
    assert jerky < 2e-2 * np.abs(fine.qdd).max()


def test_touch_down_is_without_a_jump(case):
    """From instant to instant joints go no further than their rates, and rates no further than their accelerations, let them."""
    robot, ground, options, _ = case
    walk = simulate(robot, Trajectory.of(robot.gaits["crawl"]), ground, Options(**{**vars(options), "cycles": 1, "rate": 1000.0}))
    step = walk.times[1] - walk.times[0]
    assert np.abs(np.diff(walk.q, axis=0)).max() < 1.1 * np.abs(walk.qd).max() * step
    assert np.abs(np.diff(walk.qd, axis=0)).max() < 1.1 * np.abs(walk.qdd).max() * step


def test_platform_keeps_its_pace_along_a_slope(robot, trajectory):
    walk = simulate(robot, trajectory, SLOPE, Options(cycles=2))
    way = walk.base_pose[-1, :3, 3] - walk.base_pose[0, :3, 3]
    assert np.linalg.norm(way) == pytest.approx(2 * trajectory.gait.stride, abs=1e-12)
    assert np.arctan2(way[2], way[0]) == pytest.approx(SLOPE.angle, abs=1e-12)
    expected = Rotation.from_euler("y", -SLOPE.angle).as_matrix()
    np.testing.assert_allclose(walk.base_pose[:, :3, :3], np.broadcast_to(expected, (len(walk.times), 3, 3)), atol=1e-12)


def test_chains_begin_and_end_at_rest(robot, trajectory):
    walk = simulate(robot, trajectory, HILLS, Options(from_rest=True, adapt=True))
    assert np.abs(walk.qd[[0, -1]]).max() < 1e-9
    assert np.abs(walk.qd).max() > 0.1


@pytest.mark.parametrize("flat", [False, True])
def test_splines_are_scipys(flat):
    from scipy.interpolate import CubicSpline

    values, x = np.random.default_rng(1).uniform(-1, 1, (9, 3)), np.linspace(0.5, 4.5, 77)
    peer = CubicSpline(0.5 + 0.5 * np.arange(9), values, bc_type="clamped" if flat else "natural")
    for order, mine in enumerate(Spline(0.5, 0.5, values, flat).at(x)):
        np.testing.assert_allclose(mine, peer(x, order), atol=1e-12)
    for few in (values[:2], values[:3]):
        peer = CubicSpline(0.5 + 0.5 * np.arange(len(few)), few, bc_type="clamped" if flat else "natural")
        inside = np.linspace(0.5, 0.5 * len(few), 9)
        np.testing.assert_allclose(Spline(0.5, 0.5, few, flat).at(inside)[0], peer(inside), atol=1e-12)


def test_from_rest_begins_and_ends_at_rest(robot, trajectory):
    walk = simulate(robot, trajectory, Slope(), Options(from_rest=True))
    for rates in (walk.qd, walk.qdd):
        assert np.abs(rates[[0, -1]]).max() < 1e-9
    assert walk.base_pose[-1, 0, 3] == pytest.approx(2 * trajectory.gait.stride, abs=1e-12)


def test_adapted_chains_bend_to_the_ground(robot, trajectory):
    rigid, bent = (simulate(robot, trajectory, Slope(), Options(adapt=adapt)) for adapt in (False, True))
    chains = [joint for chain in robot.chains.values() for joint in range(chain.slice.start, chain.slice.stop)]
    assert not rigid.q[:, chains].any()
    assert np.abs(bent.q[:, chains]).max() > 0.01
    knots = np.linspace(0.0, 6.0, 49)
    rows = np.searchsorted(bent.times, knots - 1e-9)
    feet = bent.targets[rows].copy()
    feet[..., 2] = 0.0
    local = np.einsum("tji,tkj->tki", bent.base_pose[rows, :3, :3], feet - bent.base_pose[rows, None, :3, 3])
    best, status, _ = robot.adapt(local, np.zeros((2, 3)), bent.q[0])
    np.testing.assert_allclose(bent.q[rows][:, chains], best[:, chains], atol=2e-3)
    assert not status.any()


@pytest.mark.parametrize("name", ["waved", "swinging"])
def test_power_is_what_energy_changes_by(robot, trajectory, name):
    """Feet at rest do no work: the drives' work without friction is the change of kinetic and potential energy."""
    walk = simulate(robot, trajectory, *WALKS[name])
    power = (walk.power.weight + walk.power.inertia).sum(axis=1)
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(walk.times))])
    energy = _energy(robot, walk)
    assert walk.energy["weight"] + walk.energy["inertia"] == pytest.approx(gained[-1], abs=1e-9)
    assert np.abs(gained - (energy - energy[0])).max() < 2e-3 * np.ptp(energy) + 2e-3


def _energy(robot, walk):
    """Potential of the centre of mass, kinetic by the work of the inertia on a rigid tree: v . momentum of the torques at rest."""
    mass = -robot.demanded_wrench(np.eye(4), walk.q[0], np.zeros(6 + walk.q.shape[1]), np.zeros(6 + walk.q.shape[1]))[2] / 9.80665
    v = _base_rates(walk)
    still = np.zeros_like(v)
    moved = robot.floating_inverse_dynamics(walk.base_pose, walk.q, still, v) - robot.floating_inverse_dynamics(
        walk.base_pose, walk.q, still, still
    )
    return mass * 9.80665 * walk.com[:, 2] + 0.5 * (moved * v).sum(axis=1)


def _base_rates(walk):
    """Of the base in its own axes, by differences of its poses."""
    R, p = walk.base_pose[:, :3, :3], walk.base_pose[:, :3, 3]
    linear = np.einsum("tji,tj->ti", R, np.gradient(p, walk.times, axis=0, edge_order=2))
    spin = np.einsum("tji,tjk->tik", R, np.gradient(R, walk.times, axis=0, edge_order=2))
    turning = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=-1)
    return np.concatenate([linear, turning, walk.qd], axis=1)


def test_friction_takes_power_and_never_gives(robot, trajectory):
    walk = simulate(robot, trajectory, Slope(), Options(body="waved", margin=0.04))
    viscous = 0.2 * walk.qd[:, [robot.joint_names.index(f"{leg}_yaw") for leg in robot.legs]] ** 2
    np.testing.assert_allclose(walk.power.friction.sum(axis=1), viscous.sum(axis=1), atol=1e-9)


def test_margins_are_distances_to_the_hull(robot):
    rng = np.random.default_rng(4)
    feet, com = rng.uniform(-1, 1, (200, 4, 3)), rng.uniform(-0.6, 0.6, (200, 3))
    support = rng.random((200, 4)) < 0.8
    standing = Standing(feet, np.broadcast_to([0.0, 0.0, 1.0], feet.shape), np.arange(4), support)
    weight = np.broadcast_to([0.0, 0.0, -2.0], com.shape)
    load = np.concatenate([weight, np.cross(com, weight)], axis=1)
    both = margins(robot, standing, com, load, np.array([1.0, 0.0, 0.0]))
    found = both.static
    np.testing.assert_allclose(both.dynamic, found, atol=1e-12)  # nothing moves
    assert (found[~support.any(axis=1)] == -np.inf).all()
    for row in np.flatnonzero(support.sum(axis=1) > 2):
        hull = ConvexHull(feet[row, support[row], :2])
        assert found[row] <= (inside := float((-hull.equations @ [*com[row, :2], 1.0]).min())) + 1e-9
        assert inside < 0 or found[row] == pytest.approx(inside, abs=1e-9)


def test_the_specs_own_ground(robot, trajectory):
    ground = Described(robot.terrain)
    walk = simulate(robot, trajectory, ground, Options(cycles=8))
    assert walk.slip < 1e-12
    x, y, z = walk.holds.point.T
    assert np.abs(z - 0.02 * np.sin(2 * x))[x < 0.6].max() < 1e-12
    assert np.abs(z - 0.02 * np.sin(2 * x))[x > 0.6].max() > 1e-3  # on the height map
    np.testing.assert_array_equal(ground.friction(x, y), np.where(x <= 0.6, 0.55, np.nan))
    far = simulate(robot, trajectory, ground, Options(cycles=14, rate=20.0))
    lost = [fault for fault in far.faults if fault.kind == "ground"]
    assert {fault.subject for fault in lost} == {"front_left", "front_right"}
    assert min(fault.at for fault in lost) == pytest.approx(24.0, abs=1.5)


def test_faults_name_who_when_and_how_much(robot, trajectory):
    walk = simulate(robot, trajectory, Slope(), Options(max_speed=(1.0,) * 14, margin=0.02))
    kinds = {fault.kind for fault in walk.faults}
    assert kinds == {"speed", "margin", "carry"}
    speed = next(fault for fault in walk.faults if fault.kind == "speed")
    column = np.abs(walk.qd[:, walk.joints.index(speed.subject)])
    assert speed.amount == pytest.approx(column.max() - 1.0)
    assert walk.times[column.argmax()] == pytest.approx(speed.at)
    assert f"{speed.amount:.4g} rad/s" in str(speed)
    steep = simulate(robot, trajectory, Relief(lambda x, y: np.where(x > 0.15, 0.5, 0.0) + 0 * y), Options())
    assert {"reach", "through"} <= {fault.kind for fault in steep.faults}


def test_chains_stay_where_a_foot_has_no_ground(robot, trajectory):
    ground = Relief(lambda x, y: np.where(x < 0.3, 0.02 * np.sin(3 * x), np.nan) + 0 * y)
    walk = simulate(robot, trajectory, ground, Options(cycles=5, rate=20.0, adapt=True))
    chains = [joint for chain in robot.chains.values() for joint in range(chain.slice.start, chain.slice.stop)]
    assert {"ground"} <= {fault.kind for fault in walk.faults} <= {"ground", "carry", "margin"}
    assert np.isfinite(walk.q[:, chains]).all()
    assert np.isfinite(walk.q[:, robot.legs["rear_left"].slice]).all()
    level = simulate(robot, trajectory, Relief(lambda x, y: 0.02 * np.sin(3 * x) + 0 * y), Options(cycles=5, rate=20.0, adapt=True))
    rows = np.isfinite(walk.q).all(axis=1) & (walk.times < 1.5)
    assert rows.sum() > 25
    np.testing.assert_allclose(walk.q[rows], level.q[rows], atol=1e-3)
    nowhere = Relief(lambda x, y: np.where(abs(x) > 0.1, np.nan, 0.0) + 0 * y)
    assert np.isfinite(simulate(robot, trajectory, nowhere, Options(rate=20.0, adapt=True)).q[:, chains]).all()


def test_a_knot_without_a_pose_is_tried_again_from_beside():
    """Of a robot whose search only succeeds from nearby: knots 3 and 4 fail from the first pose, and succeed from their neighbours'."""
    aims = np.array([0.0, 0.1, 0.2, 1.0, 1.1, 0.3])

    def adapt(targets, _, start=None):
        aim = np.asarray(targets)[..., 0, 0]
        far = np.zeros_like(aim) if start is None else np.abs(aim - np.asarray(start)[..., 0])
        return aim[..., None], np.where(far > 0.85, STATUSES.index("NO_CONVERGENCE"), 0), aim

    q, status = best_poses(SimpleNamespace(adapt=adapt, platforms=("one",)), aims[:, None, None] * np.ones((1, 4, 3)))
    np.testing.assert_array_equal(q[:, 0], aims)
    assert not status.any()


def test_friction_decides_whether_a_slope_can_be_walked(robot, trajectory):
    """tan(12 degrees) = 0.2126: with half of it feet slip always, with 0.35 there is enough for the accelerations too."""
    slope, waved = Slope(np.radians(12)), {"body": "waved", "margin": 0.04, "rate": 50.0}
    smooth, rough = (simulate(robot, trajectory, slope, Options(mu=mu, **waved)) for mu in (0.1, 0.35))
    fault = next(fault for fault in smooth.faults if fault.kind == "carry")
    assert fault.share == 1.0
    assert smooth.power.overcome.all()
    assert rough.feasible
    assert not rough.power.overcome.any()
    hills = simulate(robot, trajectory, Described(robot.terrain), Options(**waved))
    assert hills.feasible
    assert np.isfinite(hills.power.total).all()


def test_a_grids_normals_are_those_of_its_heights():
    rng = np.random.default_rng(6)
    grid = Grid(rng.uniform(-0.1, 0.1, (6, 8)), 0.2, (-0.5, 0.3))
    x, y = rng.uniform(-0.45, 0.85, 50), rng.uniform(0.35, 1.25, 50)
    fine = Relief(grid.height)
    np.testing.assert_allclose(grid.normal(x, y), fine.normal(x, y), atol=1e-6)
    rows, columns = np.meshgrid(np.arange(6), np.arange(8), indexing="ij")
    np.testing.assert_allclose(grid.height(-0.5 + 0.2 * columns, 0.3 + 0.2 * rows), grid.heights, atol=1e-15)
    assert np.isnan(grid.height(np.array([-0.51, 0.91, 0.0, 0.0]), np.array([0.5, 0.5, 0.29, 1.31]))).all()


@pytest.mark.parametrize(("cycles", "rate"), [(0, 100.0), (1, 0.0), (1, float("nan"))])
def test_no_walk_without_instants(robot, trajectory, cycles, rate):
    with pytest.raises(ValueError, match="are needed"):
        simulate(robot, trajectory, Slope(), Options(cycles=cycles, rate=rate))


@pytest.mark.parametrize("heading", [0.0, 0.4, 2.0])
def test_the_platform_is_parallel_to_a_slope_that_it_crosses(heading):
    """At any heading, its x in the vertical plane of the course."""
    angle, stance = 0.2, np.array([[0.3, 0.2, -0.5], [0.3, -0.2, -0.5], [-0.3, 0.1, -0.5]])
    motion = course(Slope(angle), stance, 0.3, 0.6, heading).at(Pace(0.1, 6.0).at(np.linspace(0.0, 6.0, 5)))
    assert np.abs(motion.rotation[:, :, 2] - [-np.sin(angle), 0.0, np.cos(angle)]).max() < 1e-12
    assert np.abs(motion.rotation[:, :, 0] @ [-np.sin(heading), np.cos(heading), 0.0]).max() < 1e-12

"""Feet: planted in the world, smooth over lift-off and touch-down, as high as asked, derivatives by differences."""

import numpy as np
import pytest
from gaits import random_trajectory

from walkgen.gait.pattern import Event
from walkgen.gait.schedule import Schedule
from walkgen.gait.standard import tripod
from walkgen.gait.trajectory import Trajectory, platform_pose

SEEDS = range(25)


def _twist(seed):
    return np.random.default_rng(2000 + seed).uniform([-0.5, -0.5, -1.5], [0.5, 0.5, 1.5]) * [1, 1, seed % 3 > 0]


def _moments(trajectory, margin=1e-4):
    """Times in five periods, not next to an event."""
    gait = trajectory.gait
    times = np.random.default_rng(5).uniform(-1, 4, 60) * gait.period
    u, factors = gait.leg_phase(times), np.array(gait.duty_factor)
    clear = np.minimum(np.minimum(u, 1 - u), abs(u - factors)).min(axis=-1) > margin
    return times[clear]


@pytest.mark.parametrize("seed", SEEDS)
def test_supporting_feet_stand_still_in_the_world(seed):
    trajectory, twist = random_trajectory(seed), _twist(seed)
    gait = trajectory.gait
    for leg, (factor, phase) in enumerate(zip(gait.duty_factor, gait.phase, strict=True)):
        times = (phase + np.linspace(0, factor, 12) * (1 - 1e-9)) * gait.period
        position, velocity, acceleration = (part[:, leg] for part in trajectory.world(times, twist))
        assert (gait.states(times)[:, leg] == 0).all()
        np.testing.assert_allclose(position, position[:1] + np.zeros((12, 1)), rtol=0, atol=1e-12)
        np.testing.assert_allclose(velocity, 0, atol=1e-12)
        np.testing.assert_allclose(acceleration, 0, atol=1e-12)
        middle = trajectory.platform((phase + factor / 2) * gait.period, twist).position[leg]
        np.testing.assert_allclose(middle, trajectory.stance[leg], rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("frame", ["platform", "world"])
def test_continuous_up_to_the_acceleration(seed, frame):
    """At events the limits from both sides agree; the jump over a step h is of the order of what the third derivative makes of h."""
    trajectory, twist = random_trajectory(seed), _twist(seed)
    gait = trajectory.gait
    motion = getattr(trajectory, frame)
    for event in gait.events:
        leg, time, h = gait.legs.index(event.leg), (event.at + 1) * gait.period, 1e-7 * gait.period
        before, after = motion(time - h, twist), motion(time + h, twist)
        air = (1 - gait.duty_factor[leg]) * gait.period
        size = 3 + np.abs(twist).max() * gait.period
        for order in range(3):
            bound = 1200 * size * h / air ** (order + 1) * (1 + np.abs(twist[2]) * air) ** 3 + 1e-9
            np.testing.assert_allclose(before[order][leg], after[order][leg], rtol=0, atol=bound)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("frame", ["platform", "world"])
def test_velocities_and_accelerations_are_derivatives(seed, frame):
    trajectory, twist = random_trajectory(seed), _twist(seed)
    gait = trajectory.gait
    motion = getattr(trajectory, frame)
    times = _moments(trajectory)
    h = 2e-5 * gait.period
    for order in (0, 1):
        slope = (motion(times + h, twist)[order] - motion(times - h, twist)[order]) / (2 * h)
        exact = motion(times, twist)[order + 1]
        air = (1 - np.array(gait.duty_factor).max()) * gait.period
        np.testing.assert_allclose(slope, exact, rtol=1e-6, atol=400 * (3 + gait.period) * h**2 / air ** (order + 3) + 1e-8)


@pytest.mark.parametrize("seed", SEEDS)
def test_feet_rise_as_high_as_asked(seed):
    trajectory = random_trajectory(seed)
    gait = trajectory.gait
    rng = np.random.default_rng(seed)
    start, end = rng.uniform(-1, 1, (2, len(gait.legs), 3))
    for leg, (factor, phase) in enumerate(zip(gait.duty_factor, gait.phase, strict=True)):
        middle = (phase + (1 + factor) / 2) * gait.period
        z = trajectory.between(middle, start, end).position[leg, 2]
        assert z == pytest.approx(max(start[leg, 2], end[leg, 2]) + trajectory.lift, abs=1e-12)
        level = trajectory.platform(middle, _twist(seed)).position[leg, 2]
        assert level == pytest.approx(trajectory.stance[leg][2] + trajectory.lift, abs=1e-12)
        times = (phase + np.linspace(0, 1, 200)) * gait.period
        heights = trajectory.platform(times, _twist(seed)).position[:, leg, 2] - trajectory.stance[leg][2]
        assert heights.min() > -1e-12
        assert heights.max() <= trajectory.lift + 1e-12


@pytest.mark.parametrize("seed", SEEDS)
def test_steady_walking_is_walking_between_its_own_footholds(seed):
    trajectory, twist = random_trajectory(seed), _twist(seed)
    gait = trajectory.gait
    rng = np.random.default_rng(seed)
    for leg, (factor, phase) in enumerate(zip(gait.duty_factor, gait.phase, strict=True)):
        stood = [platform_pose((phase + factor / 2 + cycle) * gait.period, twist) @ [*trajectory.stance[leg], 1] for cycle in (0, 1)]
        time = (phase + rng.uniform(factor, 1)) * gait.period
        feet = [np.tile(foothold[:3], (len(gait.legs), 1)) for foothold in stood]
        for mine, theirs in zip(trajectory.world(time, twist), trajectory.between(time, *feet), strict=True):
            np.testing.assert_allclose(mine[leg], theirs[leg], rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("seed", range(10))
def test_a_schedules_feet_are_those_of_its_gait(seed):
    trajectory = random_trajectory(seed)
    gait = trajectory.gait
    events = tuple(Event((cycle + event.at) * gait.period, event.leg, event.does) for cycle in range(4) for event in gait.events)
    lifted = tuple(leg for leg, state in zip(gait.legs, gait.states(events[0].at - 1e-9), strict=True) if state)
    schedule = Schedule(gait.legs, events, lifted)
    rng = np.random.default_rng(seed)
    times = rng.uniform(1, 3, 40) * gait.period
    start, end = rng.uniform(-1, 1, (2, 40, len(gait.legs), 3))
    mine, theirs = schedule.feet(times, start, end, trajectory.lift), trajectory.between(times, start, end)
    for ours, other in zip(mine, theirs, strict=True):
        np.testing.assert_allclose(ours, other, rtol=1e-9, atol=1e-10 * (1 + np.abs(other).max()))
    late = schedule.feet(9 * gait.period, start[0], end[0], 0.1)
    assert np.isnan(late.position[schedule.states(9 * gait.period) == 1]).all()
    np.testing.assert_array_equal(late.position[schedule.states(9 * gait.period) == 0], start[0][schedule.states(9 * gait.period) == 0])


def test_the_platform_turns_and_travels_as_its_twist_says():
    """Against the matrix exponential of the twist."""
    from scipy.linalg import expm

    for seed in range(9):
        vx, vy, rate = twist = _twist(seed)
        for time in (-1.3, 0.0, 0.4, 7.0):
            generator = np.array([[0, -rate, 0, vx], [rate, 0, 0, vy], [0, 0, 0, 0], [0, 0, 0, 0]])
            np.testing.assert_allclose(platform_pose(time, twist), expm(generator * time), atol=1e-12)


def test_support_of_a_straight_walk_is_that_of_the_theory():
    """x = x0 + R/2 - R u/beta, and the default twist is the gait's speed."""
    gait = tripod(("a", "b", "c"), ("d", "e", "f"), 0.6, period=1.5, stride=0.3)
    trajectory = Trajectory(gait, ((0.4, 0.3, -0.3),) * 6, 0.05)
    times = np.linspace(0, 3, 31)
    u, x = gait.leg_phase(times), trajectory.platform(times).position[..., 0]
    down = u < 0.6
    np.testing.assert_allclose(x[down], (0.4 + 0.18 / 2 - 0.18 * u / 0.6)[down], rtol=0, atol=1e-14)


def test_broadcasts_over_times_and_twists():
    trajectory = random_trajectory(3)
    k = len(trajectory.gait.legs)
    times, twists = np.linspace(0, 1, 4), np.random.default_rng(0).uniform(-1, 1, (5, 1, 3))
    for frame in (trajectory.platform, trajectory.world):
        for order, part in enumerate(frame(times, twists)):
            assert part.shape == (5, 4, k, 3)
            np.testing.assert_allclose(part[2, 1], frame(times[1], twists[2, 0])[order], atol=1e-14)
    with pytest.raises(ValueError, match="stance has shape"):
        Trajectory(trajectory.gait, ((0.0, 0.0, 0.0),) * (k + 1), 0.1)

"""Settling in C: the tripod in a bowl, inclines, the path, the reference, feet that lift off, bad input."""

import numpy as np
import pytest

from oracles.bowl import LIMITS, NORMAL_FORCES, WEIGHT, bowl, limit, stance, tilt, tilted
from walkgen.runtime.solves.settle import Robot, settled
from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, SINGULAR


def incline(angle, mu, centre_of_mass=(0.0, 0.0, 0.2)) -> Robot:
    normal = np.array([np.sin(angle), 0.0, np.cos(angle)])
    azimuth = 2 * np.pi * np.arange(3) / 3
    feet = np.stack([0.3 * np.cos(azimuth), 0.3 * np.sin(azimuth), np.zeros(3)], axis=1)

    def ground(points):
        return np.stack([points @ normal, *(np.full(points.shape[:-1], value) for value in (*normal, mu))], axis=-1)

    return Robot(feet, np.array(centre_of_mass), WEIGHT, np.zeros(6), ground)


@pytest.mark.parametrize("mu", LIMITS)
def test_the_oracle_is_where_balance_has_it(mu):
    angle, N = limit(mu)
    assert angle == pytest.approx(LIMITS[mu], abs=1e-10)
    if mu == 0.2:
        np.testing.assert_allclose(N, NORMAL_FORCES, rtol=0, atol=1e-7)


@pytest.mark.parametrize("mu", LIMITS)
def test_at_the_limit_the_slip_needs_just_that_friction(stances, mu):
    """On curved ground less would do, were normal forces free: the least friction is below."""
    found, N, *_, status = stances.slip(*stance(LIMITS[mu]))
    assert status == OK
    assert found == pytest.approx(mu, rel=1e-10)
    if mu == 0.2:
        np.testing.assert_allclose(N, NORMAL_FORCES, rtol=0, atol=1e-7)
    assert stances.needed(*stance(LIMITS[mu]))[0] < mu * (1 - 1e-4)


@pytest.mark.parametrize("mu", LIMITS)
@pytest.mark.parametrize("step", [0.03, 0.005])
def test_a_tripod_stops_in_a_bowl_at_its_limit(stances, mu, step):
    path, N, status, pose = stances.settle(bowl(mu), tilted(1.15 * LIMITS[mu]), step, 500)
    assert status == OK
    assert abs(tilt(pose) - LIMITS[mu]) <= 2e-6
    if mu == 0.2:
        np.testing.assert_allclose(N, NORMAL_FORCES, rtol=0, atol=1e-2)
    tilts = np.array([tilt(item) for item in path])
    assert np.all(np.diff(tilts) < 0.0)
    np.testing.assert_array_equal(path[-1], pose)
    for item in path:
        np.testing.assert_allclose(item[:3, :3] @ item[:3, :3].T, np.eye(3), rtol=0, atol=1e-13)
        points = bowl(mu).feet @ item[:3, :3].T + item[:3, 3]
        np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=0, atol=1e-12)


def test_it_stays_where_it_stands(stances):
    start = tilted(0.95 * LIMITS[0.2])
    path, _, status, pose = stances.settle(bowl(0.2), start, 0.01, 100)
    assert status == OK
    assert len(path) == 1
    np.testing.assert_allclose(pose, start, rtol=0, atol=1e-13)


def test_the_path_does_not_depend_on_the_step(stances):
    """From a start without symmetry, with a constant wrench that turns it about the vertical."""
    robot = bowl(0.05, (0.0, 15.0, 0.0, 0.0, 0.0, 6.0))
    ends = [stances.settle(robot, tilted(0.3), step, 1000) for step in (0.02, 0.005)]
    assert [end[2] for end in ends] == [OK, OK]
    np.testing.assert_allclose(ends[0][3], ends[1][3], rtol=0, atol=2e-4)
    assert len(ends[1][0]) > 20


def test_the_reference_agrees(stances):
    robot, start = bowl(0.2), tilted(0.36)
    path, N, status, _ = stances.settle(robot, start, 0.02, 200)
    expected = settled(robot, start, 0.02, 200)
    assert status == expected.status == OK
    assert tilt(path[-1]) == pytest.approx(tilt(expected.path[-1]), abs=2e-6)
    np.testing.assert_allclose(N, expected.normal_forces, rtol=0, atol=1e-2)


def test_inclines(stances):
    """Slopes steeper than the friction have no end; gentler ones hold."""
    angle = 0.2
    start = np.eye(4)
    start[:3, :3] = [[np.cos(angle), 0.0, np.sin(angle)], [0.0, 1.0, 0.0], [-np.sin(angle), 0.0, np.cos(angle)]]
    path, _, status, pose = stances.settle(incline(angle, 0.9 * np.tan(angle)), start, 0.02, 50)
    assert status == NO_CONVERGENCE
    assert len(path) == 51
    np.testing.assert_allclose(pose[:3, 3], [np.cos(angle), 0.0, -np.sin(angle)], rtol=0, atol=1e-9)
    _, _, status, pose = stances.settle(incline(angle, 1.1 * np.tan(angle)), start, 0.02, 50)
    assert status == OK
    np.testing.assert_allclose(pose, start, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("robot", "start", "step", "expected"),
    [
        (bowl(0.2), tilted(0.9), 0.01, INFEASIBLE),  # foot 0 would have to pull
        (incline(0.0, 0.5, (0.4, 0.0, 0.2)), np.eye(4), 0.01, INFEASIBLE),
        (bowl(-0.1), tilted(0.3), 0.01, BAD_INPUT),
        (bowl(0.2), np.full((4, 4), np.nan), 0.01, BAD_INPUT),
        (bowl(0.2), tilted(0.3), 0.0, BAD_INPUT),
        (bowl(0.2), tilted(0.3), np.nan, BAD_INPUT),
        (bowl(np.nan), tilted(0.3), 0.01, BAD_INPUT),
    ],
)
def test_statuses(stances, robot, start, step, expected):
    _, N, status, pose = stances.settle(robot, start, step, 20)
    assert status == expected == settled(robot, start, step, 20).status
    assert np.isnan(pose).all() == np.isnan(N).all() == (expected == BAD_INPUT)


def test_feet_on_a_line(stances):
    robot = incline(0.0, 0.5)
    line = Robot(robot.feet * [1.0, 0.0, 0.0], robot.centre_of_mass, robot.weight, robot.wrench, robot.ground)
    assert stances.settle(line, np.eye(4), 0.01, 20)[2] == SINGULAR == settled(line, np.eye(4), 0.01, 20).status


def test_single_precision(stances):
    *_, status, pose = stances.settle(bowl(0.2), tilted(0.38), 0.02, 100, dtype=np.float32)
    assert status == OK
    assert abs(tilt(pose) - LIMITS[0.2]) <= 5e-3

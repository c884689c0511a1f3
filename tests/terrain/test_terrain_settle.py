"""Settling as users call it: the theory's tripod in a bowl, balance where it ends, moving masses, every status, what has no `settle`."""

import numpy as np
import pytest

from oracles.bowl import LIMITS, NORMAL_FORCES, WEIGHT, tilt, tilted
from terrain.grounds import explicit
from terrain.tripods import BOWL, HEAVY, friction, tripod
from walkgen.errors import UnsupportedMechanism
from walkgen.model.assemble import assemble
from walkgen.runtime.solves.settle import Robot, settled
from walkgen.spec.read import read
from walkgen.symbolic.derive import derive

OK, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE = 0, 2, 3, 4, 5
BACKENDS = ("c", "numpy")
HOLLOW = explicit("0.3*x**2 + 0.2*y**2", 'mu = "rough"')
ASTRIDE = np.array([-0.5, 0.0, 0.5, 0.2])
"""Joint values of four legs, the first three around the middle."""


@pytest.fixture(scope="module")
def bowl(built):
    return built(tripod())


@pytest.fixture(scope="module")
def four(built):
    return built(tripod(f'[[terrain]]\nname = "hollow"\n{HOLLOW}', 4, HEAVY, '["c", "numpy"]'))


def feet_of(robot, pose, q):
    return robot.foot_positions(q) @ pose[:3, :3].T + pose[:3, 3]


def load_of(at, weight, wrench):
    return np.concatenate([weight, np.cross(at, weight)]) + wrench


def test_a_tripod_stops_in_a_bowl_at_its_limit(bowl):
    """Both coefficients of friction in one batch."""
    mu, limits = np.array(list(LIMITS))[:, None], np.array(list(LIMITS.values()))
    start = np.array([tilted(1.15 * limit) for limit in limits])
    pose, status, N, path, steps = bowl.c.settle(start, np.zeros(3), step=0.005, param=mu)
    assert np.all(status == OK)
    for row, limit in enumerate(limits):
        assert abs(tilt(pose[row]) - limit) <= 2e-6
        assert np.all(np.diff([tilt(item) for item in path[row, : steps[row] + 1]]) < 0.0)
        np.testing.assert_array_equal(path[row, steps[row] :], np.broadcast_to(pose[row], (max(steps) - steps[row] + 1, 4, 4)))
    np.testing.assert_allclose(N[0], NORMAL_FORCES, rtol=0, atol=1e-2)
    assert path.shape == (2, max(steps) + 1, 4, 4)
    np.testing.assert_allclose(path[:, 0], start, rtol=0, atol=1e-12)


def test_targets_agree(bowl):
    """From a start without symmetry, pushed and turned, with less friction than stands in the spec."""
    given = (tilted(0.3), [0.1, -0.2, 0.05], [0, 1, 2], [0.0, 15.0, 0.0, 0.0, 0.0, 6.0], 0.03, 100)
    (pose, status, N, path, steps), found = (getattr(bowl, backend).settle(*given, param=[0.1]) for backend in BACKENDS)
    assert status == found[1] == OK
    assert steps == found[4] == len(path) - 1 >= 3
    np.testing.assert_allclose(found[0], pose, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found[3], path, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found[2], N, rtol=1e-5)


def test_where_it_ends_it_balances(bowl):
    """By forces found here from balance alone, on the way's last pose and not on its first."""
    robot, q, wrench = bowl.c, np.array([0.1, -0.2, 0.05]), np.array([0.0, 15.0, 0.0, 0.0, 0.0, 6.0])
    pose, status, N, path, _ = robot.settle(tilted(0.3), q, wrench=wrench, step=0.005, param=[0.1])
    assert status == OK
    for item in path:
        np.testing.assert_allclose(np.linalg.norm(feet_of(robot, item, q), axis=1), 1.0, rtol=0, atol=1e-12)
        np.testing.assert_allclose(item[:3, :3] @ item[:3, :3].T, np.eye(3), rtol=0, atol=1e-12)
    points = feet_of(robot, pose, q)
    load = load_of(robot.com(pose, q), WEIGHT, wrench)
    T, lacking = friction(points, -points, N, load)
    assert lacking <= 1e-9
    use = T / (0.1 * N)
    assert np.all(use <= 1.0 + 2e-5)
    assert robot.friction_share(points, -points, 0.1, load)[0] <= 1.0
    before = feet_of(robot, path[0], q)
    assert robot.friction_share(before, -before, 0.1, load_of(robot.com(path[0], q), WEIGHT, wrench))[0] > 1.0


def test_masses_that_move_and_chosen_feet(four):
    """The same robot made by hand: its feet, its centre of mass, its weight, its ground."""

    def ground(points):
        x, y, z = points.T
        across = np.stack([-0.6 * x, -0.4 * y, np.ones_like(x)], axis=-1)
        n = across / np.linalg.norm(across, axis=-1, keepdims=True)
        return np.column_stack([n[:, 2] * (z - 0.3 * x**2 - 0.2 * y**2), n, np.full(len(points), 0.15)])

    start = np.eye(4)
    start[:3, 3] = [0.55, -0.3, 0.2]
    weight, robot = np.array([0.0, 0.0, -9.81 * 76.0]), four.c
    by_hand = Robot(robot.foot_positions(ASTRIDE)[:3], robot.com(np.eye(4), ASTRIDE), weight, np.zeros(6), ground)
    expected = settled(by_hand, start, 0.05, 60)
    pose, status, N, path, steps = robot.settle(start, ASTRIDE, [0, 1, 2], step=0.05, most_steps=60, param=[0.15])
    assert status == expected.status == OK
    assert steps + 1 == len(path) == len(expected.path) > 5
    np.testing.assert_allclose(path, expected.path, rtol=0, atol=1e-8)
    np.testing.assert_allclose(N, expected.normal_forces, rtol=1e-5)
    points = feet_of(robot, pose, ASTRIDE)[:3]
    normals = robot.terrain.normal(points)
    assert robot.friction_share(points, normals, 0.15, load_of(robot.com(pose, ASTRIDE), weight, np.zeros(6)))[0] <= 1.0 + 1e-5


def test_a_robot_of_four_legs_is_told_which(four):
    with pytest.raises(TypeError, match="misses feet"):
        four.c.settle(np.eye(4), ASTRIDE)


@pytest.mark.parametrize("backend", BACKENDS)
def test_statuses(bowl, backend):
    """One batch in which each row is wrong in its own way, but for the first, which stays, and the last, which has too few steps."""
    start = np.array([tilted(0.3)] * 11)
    q, feet, step, mu = np.zeros((11, 3)), np.array([[0, 1, 2]] * 11), np.full(11, 0.02), np.full((11, 1), 0.2)
    most, expected = np.full(11, 2), np.full(11, BAD_INPUT)
    start[1] = tilted(0.9)
    feet[2] = [0, 1, 1]
    start[3, :3, 3] += [5.0, 0.0, 0.0]
    feet[4, 2], feet[5, 0] = 3, -1
    step[6], mu[7], q[8, 1], most[9] = 0.0, -0.1, np.nan, -1
    mu[10] = 0.01
    expected[[0, 1, 2, 10]] = OK, INFEASIBLE, SINGULAR, NO_CONVERGENCE
    pose, status, N, path, steps = getattr(bowl, backend).settle(start, q, feet, np.zeros(6), step, most, param=mu)
    np.testing.assert_array_equal(status, expected)
    none = (expected == BAD_INPUT) | (expected == SINGULAR)
    np.testing.assert_array_equal(np.isnan(pose).all(axis=(-1, -2)), none)
    np.testing.assert_array_equal(np.isnan(N).all(axis=-1), none)
    np.testing.assert_array_equal(steps, [0] * 10 + [2])
    assert path.shape == (11, 3, 4, 4)


def test_paths_have_an_end(bowl):
    with pytest.raises(ValueError, match="go on from the last pose"):
        bowl.c.settle(tilted(0.3), np.zeros(3), most_steps=5000)


def test_casadi_has_none(bowl):
    with pytest.raises(UnsupportedMechanism, match="no CasADi form"):
        bowl.c.casadi("settle")


@pytest.mark.parametrize(("ground", "legs", "there"), [(BOWL, 3, True), ("", 3, False), (BOWL, 2, False)])
def test_what_it_takes(tmp_path, ground, legs, there):
    (tmp_path / "spec.toml").write_text(tripod(ground, legs))
    names = [derivation.signature.name for derivation in derive(assemble(read(tmp_path / "spec.toml"), tmp_path), ("settle",))]
    assert names == ["settle"] * there

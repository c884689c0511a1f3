"""The inverse of chains from a seed and within limits, C and NumPy, against poses the arm made, a matrix walk, grids and scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from serial_library import (
    FREE,
    Reaching,
    denavit_hartenberg,
    poses,
    random_arm,
    random_limits,
    random_values,
    sequence_of,
    short_way,
)

from walkgen.runtime.solves.reach import inverse_pose, inverse_reach
from walkgen.runtime.solves.within import closest_within

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE, DUPLICATE = range(7)
HALF = np.pi / 2
PUMA = denavit_hartenberg(
    [(0, HALF, 0, 0), (0.4318, 0, 0, 0), (0.0203, -HALF, 0.15005, 0), (0, HALF, 0.4318, 0), (0, -HALF, 0, 0), (0, 0, 0.1, 0)]
)


class NumPy:
    """The references under the names of the C library's methods."""

    inverse_reach, inverse_pose, closest_within = staticmethod(inverse_reach), staticmethod(inverse_pose), staticmethod(closest_within)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    return Reaching(tmp_path_factory.mktemp("reach"))


@pytest.fixture(params=["c", "numpy"])
def solver(request, compiled):
    return compiled if request.param == "c" else NumPy


def solve(solver, posed, geometry, T, seed, limits, kinds, **more):
    if posed:
        return solver.inverse_pose(geometry, T, seed, limits, sequence_of(kinds), **more)
    return solver.inverse_reach(geometry[:-9], T[..., :3, 3], seed, limits, sequence_of(kinds), **more)


def missing(posed, geometry, kinds, q, T):
    """How far the foot is from its position [...], and the entries of its rotation from theirs."""
    gap = poses(geometry, kinds, q) - T
    return np.linalg.norm(gap[..., :3, 3], axis=-1), np.max(np.abs(gap[..., :3, :3]), axis=(-2, -1)) * posed


def cost(posed, geometry, kinds, q, T):
    """What the closest pose minimises [...]: the squared distance, and the squared angle times a quarter of the reach."""
    foot = poses(geometry, kinds, q)
    turn = Rotation.from_matrix((foot[..., :3, :3] @ np.swapaxes(T[..., :3, :3], -1, -2)).reshape(-1, 3, 3)).magnitude()
    return missing(False, geometry, kinds, q, T)[0] ** 2 + posed * (0.25 * arm_reach(geometry, kinds) * turn) ** 2


def arm_reach(geometry, kinds):
    """The levers' sum of an arm that turns only: from axis to axis, points slid along their axes towards the foot."""
    beyond, total = geometry[6 * len(kinds) : 6 * len(kinds) + 3], 0.0
    for axis, point in reversed(geometry[: 6 * len(kinds)].reshape(-1, 2, 3)):
        near = point + axis * (axis @ (beyond - point))
        total, beyond = total + np.linalg.norm(beyond - near), near
    return total


def reach_of(geometry, kinds, T):
    """At least what 1e-12 refers to, for arms of metres."""
    points = geometry[: 6 * len(kinds)].reshape(-1, 6)[:, 3:]
    return 1.0 + np.sum(np.linalg.norm(np.diff(points, axis=0), axis=-1)) + np.linalg.norm(T[..., :3, 3], axis=-1)


def assert_reaches(posed, geometry, kinds, q, T, status):
    foot, rotation = missing(posed, geometry, kinds, q, T)
    there = np.isin(status, (OK, SINGULAR))
    assert there.all(), (kinds, np.bincount(status))
    assert (foot <= 1e-12 * reach_of(geometry, kinds, T)).all()
    assert (rotation <= 2e-12).all()


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
@pytest.mark.parametrize("special", [True, False], ids=["right", "random"])
@pytest.mark.parametrize("n", [4, 5, 6, 7])
def test_a_seed_near_a_pose_finds_it(solver, n, special, posed):
    rng = np.random.default_rng(n)
    for _ in range(4):
        kinds, geometry = random_arm(rng, n, special=special)
        made = random_values(rng, kinds, 25)
        T = poses(geometry, kinds, made)
        q, status = solve(solver, posed, geometry, T, made + rng.uniform(-0.3, 0.3, made.shape), FREE * np.ones((n, 1)), kinds)
        assert_reaches(posed, geometry, kinds, q, T, status)


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
@pytest.mark.parametrize("n", [4, 5, 6, 7])
def test_c_and_numpy_agree_near_a_solution(compiled, n, posed):
    rng = np.random.default_rng(10 + n)
    for _ in range(4):
        kinds, geometry = random_arm(rng, n)
        made = random_values(rng, kinds, 25)
        T, seed = poses(geometry, kinds, made), made + rng.uniform(-0.1, 0.1, made.shape)
        q, status = solve(compiled, posed, geometry, T, seed, FREE * np.ones((n, 1)), kinds)
        reference, states = solve(NumPy, posed, geometry, T, seed, FREE * np.ones((n, 1)), kinds)
        np.testing.assert_array_equal(status, states)
        np.testing.assert_allclose(short_way(kinds, q - reference)[status == OK], 0.0, atol=1e-9)


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
@pytest.mark.parametrize("n", [3, 4, 6, 7])
def test_seeds_anywhere(compiled, n, posed):
    rng = np.random.default_rng(20 + n)
    for special in (False, True) * 5:
        kinds, geometry = random_arm(rng, n, special=special)
        made = random_values(rng, kinds, 40)
        T = poses(geometry, kinds, made)
        q, status = solve(compiled, posed, geometry, T, random_values(rng, kinds, 40), FREE * np.ones((n, 1)), kinds)
        assert_reaches(posed, geometry, kinds, q, T, status)
        assert (np.abs(q[:, [kind == "R" for kind in kinds]]) <= np.pi).all()


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
def test_numpy_from_seeds_anywhere_has_the_same_answers(compiled, posed):
    rng = np.random.default_rng(30)
    for n in (2, 3, 5, 6):
        kinds, geometry = random_arm(rng, n)
        T = poses(geometry, kinds, random_values(rng, kinds, 12))
        T[6:, :3, 3] += rng.normal(size=(6, 3)) * 2.0
        seed = random_values(rng, kinds, 12)
        q, status = solve(compiled, posed, geometry, T, seed, FREE * np.ones((n, 1)), kinds)
        reference, states = solve(NumPy, posed, geometry, T, seed, FREE * np.ones((n, 1)), kinds)
        np.testing.assert_array_equal(status, states)
        feet = [missing(posed, geometry, kinds, values, T)[0] for values in (q, reference)]
        np.testing.assert_allclose(*feet, atol=1e-9)


def test_the_nearest_of_all_poses_of_a_wrist_partitioned_arm(solver, compiled):
    """Unless one lies within half a radian in every joint; the others are found from seeds all over."""
    rng = np.random.default_rng(40)
    count, limits = 30, FREE * np.ones((6, 1))
    T, seed = poses(PUMA, "RRRRRR", rng.uniform(-np.pi, np.pi, (count, 6))), rng.uniform(-np.pi, np.pi, (count, 6))
    q, status = solver.inverse_pose(PUMA, T, seed, limits, 64)
    assert_reaches(True, PUMA, "RRRRRR", q, T, status)
    others, states = compiled.inverse_pose(PUMA, np.repeat(T, 60, axis=0), rng.uniform(-np.pi, np.pi, (60 * count, 6)), limits, 64)
    assert np.isin(states, (OK, SINGULAR)).all()
    away = np.sum(short_way("RRRRRR", others.reshape(count, 60, 6) - seed[:, None]) ** 2, axis=-1)
    gap = short_way("RRRRRR", q - seed)
    assert ((np.max(np.abs(gap), axis=-1) <= 0.5) | (np.sum(gap * gap, axis=-1) <= np.min(away, axis=-1) + 1e-9)).all()
    kinds_of_pose = [len({tuple(np.round(row, 6)) for row in some}) for some in np.cos(others.reshape(count, 60, 6))]
    assert max(kinds_of_pose) >= 4


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
@pytest.mark.parametrize("n", [4, 6, 7])
def test_a_solution_within_limits_is_found(solver, n, posed):
    rng = np.random.default_rng(50 + n)
    for special in (False, True):
        kinds, geometry = random_arm(rng, n, special=special)
        limits = random_limits(rng, kinds, 20)
        made, seed = (limits[..., 0] + rng.random((20, n)) * (limits[..., 1] - limits[..., 0]) for _ in range(2))
        T = poses(geometry, kinds, made)
        q, status = solve(solver, posed, geometry, T, seed, limits, kinds)
        assert_reaches(posed, geometry, kinds, q, T, status)
        assert ((q >= limits[..., 0] - 1e-12) & (q <= limits[..., 1] + 1e-12)).all()


def test_a_solution_outside_the_limits_is_better_than_none(solver):
    limits = np.array([[0.5, 0.6]] * 6)
    q, status = solver.inverse_pose(PUMA, poses(PUMA, "RRRRRR", [2.0, 0.3, 0.4, 0.5, 0.6, 0.7]), np.full(6, 0.55), limits, 64)
    assert status == OK
    assert (np.abs(q - 0.55) > 0.05).any()


def test_angles_turn_to_where_limits_want_them(solver):
    made = np.array([0.4, 0.5, -0.6, 0.7, 0.8, -0.9])
    T, turn = poses(PUMA, "RRRRRR", made), 2 * np.pi
    limits = np.array([[turn, 2 * turn], [-np.inf, -5.0], [5.0, np.inf], [-20.0, -turn], [-3.0, 3.0], [turn - 1.0, turn]])
    q, status = solver.inverse_pose(PUMA, T, made + 0.1, limits, 64)
    assert status == OK
    np.testing.assert_allclose(q, made + turn * np.array([1, -1, 1, -2, 0, 1]), atol=1e-10)


def test_stretched_arms_are_singular(solver):
    three = denavit_hartenberg([(0.0, HALF, 0.2, 0.0), (0.5, 0.0, 0.0, 0.0), (0.4, 0.0, 0.0, 0.0)])
    q, status = solver.inverse_reach(three[:-9], [0.9, 0.0, 0.2], [0.01, 0.0, 0.0], FREE * np.ones((3, 1)), 8)
    assert status == SINGULAR
    np.testing.assert_allclose(poses(three, "RRR", q)[:3, 3], [0.9, 0.0, 0.2], atol=1e-12)
    wrist = np.array([0.3, 0.4, 0.5, 0.6, 0.0, 0.7])
    q, status = solver.inverse_pose(PUMA, poses(PUMA, "RRRRRR", wrist), wrist + 0.05, FREE * np.ones((6, 1)), 64)
    assert status == SINGULAR


def test_a_wrist_alone_has_no_reach_but_roundings(solver):
    """Three axes that meet in the foot, away from the origin: its position is what it is, to the roundings of its coordinates."""
    base = poses(PUMA, "RRRRRR", [0.3, -0.4, 0.5, 0.6, 0.7, 0.8])
    wrist = denavit_hartenberg([(0.0, HALF, 0.0, 0.1), (0.0, -HALF, 0.0, 0.2), (0.0, 0.0, 0.0, 0.3)], base)
    wrist[3:6] += [1e-16, -1e-16, 1e-16]
    made = np.random.default_rng(45).uniform(-1.5, 1.5, (20, 3))
    T = poses(wrist, "RRR", made)
    q, status = solver.inverse_pose(wrist, T, made + 0.2, FREE * np.ones((3, 1)), 8)
    assert np.isin(status, (OK, SINGULAR)).all()
    np.testing.assert_allclose(poses(wrist, "RRR", q), T, atol=1e-11)
    q, status = solver.inverse_reach(wrist[:-9], T[0, :3, 3], made[0], FREE * np.ones((3, 1)), 8)
    assert status == SINGULAR


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
def test_out_of_reach_the_arm_rests_where_no_joint_brings_it_nearer(solver, posed):
    rng = np.random.default_rng(60)
    for n in (1, 2, 3, 4, 6):
        kinds, geometry = random_arm(rng, n, slides=0.0)
        T = poses(geometry, kinds, random_values(rng, kinds, 8))
        T[:, :3, 3] += 8.0 * rng.normal(size=(8, 3))
        q, status = solve(solver, posed, geometry, T, random_values(rng, kinds, 8), FREE * np.ones((n, 1)), kinds)
        assert (status == UNREACHABLE).all()
        best = cost(posed, geometry, kinds, q, T)
        for step in 1e-3 * np.vstack([np.eye(n), -np.eye(n), rng.normal(size=(20, n))]):
            assert (cost(posed, geometry, kinds, q + step, T) > best - 1e-9).all()


def test_the_closest_pose_weighs_turns_by_a_quarter_of_the_reach(solver):
    """One joint that turns the foot about an axis through it, and one that slides it: distance and angle do not touch each other."""
    geometry = np.array([0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, *np.eye(3).ravel()], float)
    T = np.array([[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 0.3], [0.0, 0.0, 0.0, 1.0]])
    q, status = solver.inverse_pose(geometry, T, [0.2, 0.1], FREE * np.ones((2, 1)), 5)
    assert status == UNREACHABLE
    np.testing.assert_allclose(q, [HALF, 1.0], atol=1e-9)


def test_a_target_that_is_only_approached_at_infinity_does_not_converge(solver):
    """Slides both ways along x and a turn about an oblique axis between them: (0, 0.3, 0) asks for no turn at all and endless slides."""
    half = np.sqrt(0.5)
    geometry = np.array([1, 0, 0, 0, 0, 0, half, 0, half, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0])
    q, status = solver.inverse_reach(geometry, [0.0, 0.3, 0.0], [0.1, 0.2, 0.3], FREE * np.ones((3, 1)), 13)
    assert status == NO_CONVERGENCE
    assert np.abs(q[0]) > 1e3

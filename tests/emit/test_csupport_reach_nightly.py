"""Many arms, many poses: how often the inverse of chains from a seed finds what the arm made, and what it calls out of reach."""

import numpy as np
import pytest
from serial_library import FREE, Reaching, denavit_hartenberg, poses, random_arm, random_limits, random_values, sequence_of

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE = range(5)
HALF = np.pi / 2
PUBLISHED = {
    "PUMA 560": [(0, HALF, 0, 0), (0.4318, 0, 0, 0), (0.0203, -HALF, 0.15005, 0), (0, HALF, 0.4318, 0), (0, -HALF, 0, 0), (0, 0, 0.1, 0)],
    "UR5": [
        *((0, HALF, 0.089159, 0), (-0.425, 0, 0, 0), (-0.39225, 0, 0, 0)),
        *((0, HALF, 0.10915, 0), (0, -HALF, 0.09465, 0), (0, 0, 0.0823, 0)),
    ],
    "LBR iiwa 7": [
        *((0, -HALF, 0.34, 0), (0, HALF, 0, 0), (0, HALF, 0.4, 0), (0, -HALF, 0, 0)),
        *((0, -HALF, 0.4, 0), (0, HALF, 0, 0), (0, 0, 0.126, 0)),
    ],
    "one-two-three offsets": [
        (0.1, 1.0, 0.2, 0),
        (0.3, -0.7, 0.1, 0),
        (0.2, 0.9, -0.3, 0),
        (0.15, 1.3, 0.25, 0),
        (0.1, -1.1, 0.1, 0),
        (0, 0, 0.2, 0),
    ],
}
pytestmark = pytest.mark.nightly


@pytest.fixture(scope="module")
def solver(tmp_path_factory):
    return Reaching(tmp_path_factory.mktemp("reach"))


def failures(solver, geometry, kinds, made, seed, posed=True, limits=FREE):
    """How many poses that the arm made are not reached; those that are said to be, are."""
    T, bounds = poses(geometry, kinds, made), np.broadcast_to(limits, (len(made), len(kinds), 2))
    if posed:
        q, status = solver.inverse_pose(geometry, T, seed, bounds, sequence_of(kinds))
    else:
        q, status = solver.inverse_reach(geometry[:-9], T[:, :3, 3], seed, bounds, sequence_of(kinds))
    there = np.isin(status, (OK, SINGULAR))
    gap = np.abs(poses(geometry, kinds, q) - T)
    assert np.max((gap if posed else gap[:, :3, 3])[there]) <= 1e-11
    assert not (status == BAD_INPUT).any()
    return len(made) - int(there.sum()), q


@pytest.mark.parametrize("special", [False, True], ids=["random", "right"])
@pytest.mark.parametrize("n", [4, 5, 6, 7])
def test_all_poses_are_found_from_seeds_near_them(solver, n, special):
    rng = np.random.default_rng(n)
    for _ in range(100):
        kinds, geometry = random_arm(rng, n, special=special)
        made = random_values(rng, kinds, 200)
        for posed in (True, False):
            assert failures(solver, geometry, kinds, made, made + rng.uniform(-0.3, 0.3, made.shape), posed)[0] == 0, kinds


@pytest.mark.parametrize("special", [False, True], ids=["random", "right"])
@pytest.mark.parametrize("n", [3, 4, 5, 6, 7, 9])
def test_nearly_all_poses_are_found_from_seeds_anywhere(solver, n, special):
    """Of 20 000 a few may fail, near singular poses of arms with right angles."""
    rng, failed = np.random.default_rng(100 + n), 0
    for _ in range(100):
        kinds, geometry = random_arm(rng, n, special=special)
        made, seed = random_values(rng, kinds, 100), random_values(rng, kinds, 100)
        failed += failures(solver, geometry, kinds, made, seed)[0] + failures(solver, geometry, kinds, made, seed, posed=False)[0]
    assert failed <= (10 if special else 1)


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_arms(solver, name):
    rng, geometry = np.random.default_rng(0), denavit_hartenberg(PUBLISHED[name])
    kinds = "R" * len(PUBLISHED[name])
    made = random_values(rng, kinds, 10000)
    for seed in (random_values(rng, kinds, 10000), np.zeros_like(made), made + rng.uniform(-0.3, 0.3, made.shape)):
        assert failures(solver, geometry, kinds, made, seed)[0] == 0


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
@pytest.mark.parametrize("n", [4, 6, 7])
def test_solutions_within_limits(solver, n, posed):
    rng, outside = np.random.default_rng(200 + n), 0
    for special in (False, True) * 20:
        kinds, geometry = random_arm(rng, n, special=special)
        limits = random_limits(rng, kinds, 100)
        made, seed = (limits[..., 0] + rng.random((100, n)) * (limits[..., 1] - limits[..., 0]) for _ in range(2))
        failed, q = failures(solver, geometry, kinds, made, seed, posed, limits)
        assert failed == 0
        outside += np.sum(((q < limits[..., 0] - 1e-12) | (q > limits[..., 1] + 1e-12)).any(axis=-1))
    assert outside <= 4


@pytest.mark.parametrize("posed", [True, False], ids=["pose", "position"])
def test_arms_that_turn_always_come_to_rest(solver, posed):
    rng = np.random.default_rng(300)
    for n in (1, 2, 3, 4, 5, 6, 7):
        for special in (False, True) * 10:
            kinds, geometry = random_arm(rng, n, slides=0.0, special=special)
            T = poses(geometry, kinds, random_values(rng, kinds, 50))
            T[:, :3, 3] += rng.normal(size=(50, 3)) * rng.choice([0.3, 3.0, 300.0])
            seed, limits = random_values(rng, kinds, 50), FREE * np.ones((n, 1))
            if posed:
                _, status = solver.inverse_pose(geometry, T, seed, limits, sequence_of(kinds))
            else:
                _, status = solver.inverse_reach(geometry[:-9], T[:, :3, 3], seed, limits, sequence_of(kinds))
            assert np.isin(status, (OK, SINGULAR, UNREACHABLE)).all(), (kinds, np.bincount(status))

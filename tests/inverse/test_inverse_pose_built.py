"""Arms of four to seven joints and routes through a modular robot, as users call them: positions and poses near a seed, within limits."""

import itertools

import numpy as np
import pytest
from arms import ARMS, FEW, PATHS, WALKER, spec
from scipy.optimize import least_squares

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE = range(5)


def some(names):
    return [name if name in FEW else pytest.param(name, marks=pytest.mark.nightly) for name in names]


@pytest.fixture(params=some(PATHS))
def path(request):
    return request.param


@pytest.fixture(params=["c", "numpy"])
def robot(request, built, path):
    return getattr(built(spec(path)), request.param)


def call(robot, path, name, *inputs):
    return robot.functions[f"arms_{path}_{name}"](*inputs)


def limits(robot, path):
    """[n], [n]"""
    if path in robot.legs:
        return robot.legs[path].limits.T
    return robot.limits[robot.routes[path.removeprefix("root_to_")].indices].T


def within(robot, path, count, seed):
    """Poses of all the range, or of the middle of it."""
    low, high = limits(robot, path)
    most = np.where(PATHS[path].turning, np.pi, 0.3)
    return np.random.default_rng(seed).uniform(np.maximum(low, -most), np.minimum(high, most), (count, len(low)))


def many(robot, count):
    return count if robot.backend == "c" else max(count // 10, 2)


def misses(path, q, T):
    """Metres and radians that the foot's frame is off."""
    found = PATHS[path].pose(q)
    shift = np.linalg.norm(found[..., :3, 3] - T[..., :3, 3], axis=-1)
    chord = np.linalg.norm(found[..., :3, :3] - T[..., :3, :3], axis=(-2, -1)) / np.sqrt(8.0)
    return shift, 2 * np.arcsin(np.minimum(chord, 1.0))


def test_the_oracle_is_the_walker(robot, path):
    """The screws give the walker's poses; so does what was generated."""
    q = within(robot, path, 3, 0)
    T = call(robot, path, "foot_pose", q)
    assert np.allclose(PATHS[path].pose(q), T, rtol=0, atol=1e-13)
    if path in ARMS:
        assert np.allclose([WALKER.leg(path).pose(row) for row in q], T, rtol=0, atol=1e-13)


# ---- positions -------------------------------------------------------------------------------------------------------------------


def test_positions_are_reached_within_the_limits(robot, path):
    count = many(robot, 200)
    p, seed = PATHS[path].foot(within(robot, path, count, 1)), within(robot, path, count, 2)
    q, status = call(robot, path, "inverse_near", p, seed)
    assert np.all(np.isin(status, (OK, SINGULAR)))
    assert np.all(np.linalg.norm(PATHS[path].foot(q) - p, axis=1) <= 1e-12 * PATHS[path].reach)
    assert np.all(call(robot, path, "within_limits", q))


def test_a_near_seed_stays_near(robot, path):
    count = many(robot, 100)
    truth = within(robot, path, count, 3) * 0.9
    step = np.random.default_rng(4).uniform(-0.02, 0.02, truth.shape)
    q, status = call(robot, path, "inverse_near", PATHS[path].foot(truth), truth + step)
    weakest = np.linalg.svd(PATHS[path].jacobian(truth), compute_uv=False)[:, -1]
    clear = weakest > 0.1
    assert clear.any()
    assert np.all(status[clear] == OK)
    assert np.all(PATHS[path].apart(q, truth + step)[clear] <= 0.5)


@pytest.mark.sampled(5)
def test_a_path_is_followed_without_jumps(robot, path):
    n = PATHS[path].n
    time = np.linspace(0.0, 1.0, many(robot, 200))[:, None]
    swing = 0.3 * np.sin(np.pi * time * np.arange(1, n + 1)) * np.where(PATHS[path].turning, 1.0, 0.3)
    starts = [start * 0.5 + swing for start in within(robot, path, 30, 5)]
    way = max(starts, key=lambda q: np.linalg.svd(PATHS[path].jacobian(q), compute_uv=False)[:, -1].min())
    steps, seed = [], way[0]
    for p in PATHS[path].foot(way):
        q, status = call(robot, path, "inverse_near", p, seed)
        assert status == OK
        steps.append(PATHS[path].apart(q, seed))
        seed = q
    assert max(steps) <= 4 * np.max(np.abs(np.diff(way, axis=0))) + 1e-9


@pytest.mark.sampled(5)
def test_targets_out_of_reach_are_said_so_and_come_closest(robot, path):
    """Against the best of many descents; where a joint slides, it goes beyond its limits for a target that needs that."""
    screw = PATHS[path]
    directions = np.random.default_rng(6).normal(size=(many(robot, 15), 3))
    p = directions / np.linalg.norm(directions, axis=1, keepdims=True) * screw.reach * 3
    q, status = call(robot, path, "inverse_near", p, within(robot, path, len(p), 7))
    gap = np.linalg.norm(screw.foot(q) - p, axis=1)
    assert np.all(gap[status == OK] <= 1e-12 * screw.reach * 4)
    assert not np.any(call(robot, path, "within_limits", q[status == OK]))
    assert np.all(np.isin(status, (UNREACHABLE, NO_CONVERGENCE)) | (status == OK))
    assert not screw.turning.all() or np.all(status == UNREACHABLE)
    if screw.turning.all() and robot.backend == "c":
        starts = screw.random(np.random.default_rng(8), 400)
        for target, distance in list(zip(p, gap, strict=True))[:2]:
            best = starts[np.argsort(np.linalg.norm(screw.foot(starts) - target, axis=1))[:2]]
            assert distance <= min(descended(screw, target, start) for start in best) + 1e-9


def descended(screw, target, start):
    done = least_squares(
        lambda q: np.append(screw.foot(q) - target, np.zeros(screw.n)),
        start,
        lambda q: np.vstack([screw.jacobian(q), np.zeros((screw.n, screw.n))]),
        method="lm",
    )
    return np.sqrt(2 * done.cost)


@pytest.mark.sampled(5)
def test_c_and_numpy_agree(built, path):
    robots = built(spec(path)).c, built(spec(path)).numpy
    rng = np.random.default_rng(18)
    p = np.concatenate([PATHS[path].foot(within(robots[0], path, 4, 19)), rng.normal(size=(2, 3)) * 3])
    seed = within(robots[0], path, len(p), 20)
    (q, status), (other, state) = (call(robot, path, "inverse_near", p, seed) for robot in robots)
    assert np.array_equal(status, state)
    assert np.all(np.abs(np.linalg.norm(PATHS[path].foot(q) - p, axis=1) - np.linalg.norm(PATHS[path].foot(other) - p, axis=1)) <= 1e-9)
    T = PATHS[path].pose(within(robots[0], path, 4, 21))
    (q, status), (other, state) = (call(robot, path, "inverse_pose", T, seed[:4]) for robot in robots)
    assert np.array_equal(status, state)


# ---- poses -----------------------------------------------------------------------------------------------------------------------


def test_poses_are_reached(robot, path):
    """From seeds anywhere; within the limits, which the pose behind the target is, but for a rare one."""
    count = many(robot, 200)
    T = PATHS[path].pose(within(robot, path, count, 9))
    q, status = call(robot, path, "inverse_pose", T, within(robot, path, count, 10))
    assert np.all(np.isin(status, (OK, SINGULAR)))
    shift, angle = misses(path, q, T)
    assert np.all(shift <= 1e-12 * PATHS[path].reach)
    assert np.all(angle <= 1e-12)
    assert np.mean(call(robot, path, "within_limits", q)) >= 0.99


def test_a_pose_near_its_seed_comes_back(robot, path):
    """Up to six joints a pose leaves no choice nearby: the very joint values come back."""
    count = many(robot, 100)
    truth = within(robot, path, count, 11) * 0.9
    seed = truth + np.random.default_rng(12).uniform(-0.03, 0.03, truth.shape)
    T = PATHS[path].pose(truth)
    q, status = call(robot, path, "inverse_pose", T, seed)
    weakest = np.linalg.svd(PATHS[path].pose_jacobian(truth), compute_uv=False)[:, -1]
    clear = weakest > 0.05
    assert clear.any()
    assert np.all(status[clear] == OK)
    if PATHS[path].n <= 6:
        assert np.all(PATHS[path].apart(q, truth)[clear] <= 1e-11 / weakest[clear])


def test_poses_out_of_reach_are_said_so(robot, path):
    screw = PATHS[path]
    truth = within(robot, path, many(robot, 15), 13)
    T = screw.pose(truth)
    T[:, :3, 3] *= 1.0 + 40.0 * screw.reach / np.linalg.norm(T[:, :3, 3], axis=1, keepdims=True)
    q, status = call(robot, path, "inverse_pose", T, truth)
    assert np.all(np.isin(status, (UNREACHABLE, NO_CONVERGENCE)) | (status == OK))
    assert np.all(np.isfinite(q))
    assert not np.any(call(robot, path, "within_limits", q[status == OK]))
    assert not (screw.turning.all() and np.any(status == OK))
    assert np.all(misses(path, q, T)[0][status == OK] <= 1e-12 * 50 * screw.reach)


# ---- inputs ----------------------------------------------------------------------------------------------------------------------


def test_what_is_no_number_is_bad_input(robot, path):
    """One of an input's values at a time."""
    fine = within(robot, path, 1, 14)[0]
    p, T = PATHS[path].foot(fine), PATHS[path].pose(fine)
    with np.errstate(all="ignore"):
        answers = [
            call(robot, path, "inverse_near", p, spoilt(fine)),
            call(robot, path, "inverse_near", spoilt(p), fine),
            call(robot, path, "inverse_pose", spoilt(T.ravel()).reshape(-1, 4, 4), fine),
            call(robot, path, "inverse_pose", T, spoilt(fine)),
        ]
    for q, status in answers:
        assert np.all(status == BAD_INPUT)
        assert np.all(np.isnan(q))


def spoilt(values):
    """Rows with one value replaced by what is no finite number."""
    rows = [np.where(np.arange(len(values)) == place, wrong, values) for place in range(len(values)) for wrong in (np.nan, np.inf, -np.inf)]
    return np.array(rows)


def test_what_is_no_rigid_transform_is_bad_input(robot, path):
    fine = within(robot, path, 1, 15)[0]
    T = PATHS[path].pose(fine)
    mirrored, stretched, sheared = T.copy(), T.copy(), T.copy()
    mirrored[:3, 0] *= -1
    stretched[:3, :3] *= 1.01
    sheared[3, 0] = 0.1
    for wrong in (mirrored, stretched, sheared):
        q, status = call(robot, path, "inverse_pose", wrong, fine)
        assert status == BAD_INPUT
        assert np.all(np.isnan(q))


@pytest.mark.sampled(5)
def test_every_target_has_an_answer(robot, path):
    values = (0.0, -0.0, 5e-324, 1e-160, 1e20, 1e160, -1e308)
    p = np.array(list(itertools.product(values, repeat=3)))[:: 5 if robot.backend == "c" else 120]
    with np.errstate(all="ignore"):
        q, status = call(robot, path, "inverse_near", p, within(robot, path, 1, 16)[0])
    assert np.array_equal(np.isnan(q).any(axis=1), status == BAD_INPUT)
    assert np.all(status[np.abs(p).max(axis=1) < 1] != BAD_INPUT)


# ---- closest within the limits -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", some(["four_limited", "four_mixed", "seven"]), indirect=True)
def test_admissible(robot, path):
    p = PATHS[path].foot(within(robot, path, many(robot, 40), 17))
    q, status = robot.legs[path].inverse_admissible(p)
    assert np.all(np.isin(status, (OK, SINGULAR)))
    assert np.all(robot.legs[path].within_limits(q))
    assert np.all(np.linalg.norm(PATHS[path].foot(q) - p, axis=1) <= 1e-12 * PATHS[path].reach)
    q, status = robot.legs[path].inverse_admissible(p * 20)
    assert np.all(np.isin(status, (UNREACHABLE, NO_CONVERGENCE)))
    assert np.all(robot.legs[path].within_limits(q))

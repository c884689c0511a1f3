"""Adaption in C: its NumPy reference's answers, minima within limits that no neighbour beats, closest stands, any input."""

from dataclasses import replace

import numpy as np
import pytest
from adapt_library import Adapting
from scipy.optimize import minimize

from oracles import theory
from oracles.trees import Ground, chapter_module, random_ground, random_robot, unit
from walkgen.runtime.solves.adapt import adapt
from walkgen.runtime.solves.adapt_velocity import adapt_velocity

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE = range(5)
MODULE = chapter_module()
POSTURE = np.array([*theory.O8_C, *theory.O8_Q3, *theory.O8_Q4])
TARGETS = np.array([[-0.80, 0.55, -0.33], [-0.75, -0.52, -0.24]])
NORMALS = np.tile(unit([0.1, 0.05, 1.0]), (2, 1))
WEIGHTS = np.array([1.0, 4.0, 20.0, 0.30])
NOWHERE = np.full(9, np.nan)


@pytest.fixture(scope="module")
def routines(tmp_path_factory):
    return Adapting(tmp_path_factory.mktemp("adapt"))


def on(ground: Ground, start) -> tuple:
    return *ground.robot.data, ground.targets, ground.normals, start, ground.weights, *ground.robot.counts


def test_the_example(routines):
    q, status, cost = routines.adapt(*on(Ground(MODULE, TARGETS, NORMALS, WEIGHTS), NOWHERE))
    assert status == OK
    assert abs(cost - 1.169086782046906) <= 1e-14
    np.testing.assert_allclose(q[:3], [-0.0348539, -0.0356307, 0.0306370], rtol=0, atol=1e-7)


@pytest.mark.parametrize("serial", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_c_is_numpy(routines, seed, serial):
    ground, start = random_ground(seed, serial)
    start[seed] = np.nan
    ours, reference = routines.adapt(*on(ground, start)), adapt(*on(ground, start))
    assert ours[1] == reference[1] == OK
    np.testing.assert_allclose(ours[0], reference[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(ours[2], reference[2], rtol=1e-12, atol=1e-12)


def test_no_normals_and_locked_chains_as_in_numpy(routines):
    targets = TARGETS + np.array([[[0.0, 0.0, 0.0]], [[0.0, 0.0, 0.05]]])
    for robot in (MODULE, MODULE.limited([0, 1], 0.1, 0.1), MODULE.limited([2, 5], -np.inf, np.inf)):
        given = (*robot.data, targets, np.zeros((2, 3)), NOWHERE, WEIGHTS, *robot.counts)
        ours, reference = routines.adapt(*given), adapt(*given)
        assert (ours[1] == OK).all()
        np.testing.assert_array_equal(ours[1], reference[1])
        np.testing.assert_allclose(ours[0], reference[0], rtol=0, atol=1e-9)
        np.testing.assert_allclose(ours[2], reference[2], rtol=1e-12, atol=1e-12)


def test_out_of_reach_as_in_numpy(routines):
    given = on(Ground(MODULE, TARGETS - np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]), NORMALS, WEIGHTS), NOWHERE)
    ours, reference = routines.adapt(*given), adapt(*given)
    assert ours[1] == reference[1] == UNREACHABLE
    np.testing.assert_allclose(ours[0], reference[0], rtol=0, atol=1e-6)
    np.testing.assert_allclose(ours[2], reference[2], rtol=1e-5)


@pytest.mark.parametrize("count", [9, pytest.param(24, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("one_sided", [False, True])
def test_random_robots_stand_where_no_neighbour_is_better(routines, one_sided, count):
    """On targets, within limits (chains that start at one often end there), Phi stationary by its gradient from complex steps."""
    bound = 0
    for seed in range(count):
        ground, start = random_ground(seed, bool(seed % 2), modules=2 + seed % 3)
        chains, half = ground.robot.chains, ground.robot.half[ground.robot.chains]
        if one_sided:
            ground = replace(ground, robot=ground.robot.limited(chains, start[chains], np.inf))
        robot, (lower, upper) = ground.robot, ground.robot.limits[chains].T
        q, status, cost = routines.adapt(*on(ground, start))
        assert status in (OK, NO_CONVERGENCE)
        assert np.max(np.abs(robot.foot_positions(q) - ground.targets)) <= 1e-12
        assert ((lower <= q[chains]) & (q[chains] <= upper)).all()
        assert abs(ground.phi(q) - cost) <= 1e-12 * max(1.0, cost)
        assert cost <= ground.phi(start) + 1e-12
        bound += np.isin(q[chains], [lower, upper]).any()
        if status == OK:
            assert np.max(np.abs(ground.pushed(q))) <= 1e-8
            assert lowest_beside(ground, q, 0.02 * half) >= cost - 1e-12 * max(1.0, cost)
        else:  # it was led into a leg's singular pose
            assert robot.least_singular_value(q) <= 0.01
    assert (bound > 5 / 8 * count) == one_sided


def lowest_beside(ground: Ground, q, radius) -> float:
    """Phi of five stands nearby, at random, within limits."""
    rng, (lower, upper) = np.random.default_rng(9), ground.robot.limits[ground.robot.chains].T
    c = q[ground.robot.chains] + radius * rng.uniform(-1.0, 1.0, (5, len(radius)))
    stands = [ground.followed(row, q) for row in np.clip(c, lower, upper)]
    return min((float(ground.phi(stand)) for stand in stands if stand is not None), default=np.inf)


@pytest.mark.parametrize("count", [10, pytest.param(30, marks=pytest.mark.nightly)])
def test_nearly_all_random_robots_converge(routines, count):
    grounds = [random_ground(seed, bool(seed % 2), modules=2 + seed % 3) for seed in range(100, 100 + count)]
    states = [int(routines.adapt(*on(ground, start))[1]) for ground, start in grounds]
    assert states.count(OK) >= 9 / 10 * count
    assert set(states) <= {OK, NO_CONVERGENCE}


@pytest.mark.parametrize("shift", [(-1.0, 0.0, 0.0), (0.0, 0.3, -0.9), (0.6, 0.6, -0.6)])
def test_out_of_reach_comes_as_close_as_limits_allow(routines, shift):
    """Against SciPy's least squares of the feet's gaps over chain joints in their limits and free legs."""
    targets = TARGETS + np.array([shift, (0.0, 0.0, 0.0)])
    q, status, cost = routines.adapt(*on(Ground(MODULE, targets, NORMALS, WEIGHTS), NOWHERE))
    assert status == UNREACHABLE
    assert np.isfinite(cost)
    bounds = np.where(np.arange(9)[:, None] < 3, MODULE.limits, [-np.inf, np.inf])
    assert ((bounds[:, 0] <= q) & (q <= bounds[:, 1])).all()

    def missed(x):
        gap = (MODULE.foot_positions(x) - targets).ravel()
        return gap @ gap, 2.0 * gap @ MODULE.jacobian(x)

    rng = np.random.default_rng(3)
    starts = [q, *(q + rng.uniform(-0.3, 0.3, (3, 9)))]
    least = min(minimize(missed, start, jac=True, method="L-BFGS-B", bounds=bounds).fun for start in starts)
    assert 0.01 < missed(q)[0] <= least * (1.0 + 1e-6)


def test_reachable_targets_are_found_from_poses_that_miss_them(routines):
    """Targets of a posture with the chain far from the middle, where the legs do not reach them."""
    rng = np.random.default_rng(5)
    q = np.tile(MODULE.middle, (50, 1)) + MODULE.half * rng.uniform(-0.9, 0.9, (50, 9))
    targets = np.array([MODULE.foot_positions(row) for row in q])
    found, status, _ = routines.adapt(*MODULE.data, targets, NORMALS, NOWHERE, WEIGHTS, *MODULE.counts)
    assert (status != UNREACHABLE).all()
    assert max(np.max(np.abs(MODULE.foot_positions(row) - aim)) for row, aim in zip(found, targets, strict=True)) <= 1e-12


def test_single_precision(routines):
    for seed in range(12):
        ground, start = random_ground(seed, bool(seed % 2))
        exact, single = routines.adapt(*on(ground, start)), routines.adapt(*on(ground, start), dtype=np.float32)
        assert single[0].dtype == single[2].dtype == np.float32
        if exact[1] == OK:
            assert single[1] == OK
            assert np.max(np.abs(ground.robot.foot_positions(single[0].astype(float)) - ground.targets)) <= 1e-5
            assert abs(single[2] - exact[2]) <= 1e-4 * max(1.0, exact[2])


SPECIAL = (0.0, -0.0, 5e-324, 1e-200, 1e-9, 0.3, -0.5, 1.0, 10.0, 1e9, 1e160, -1e160, 1.7e308, np.inf, -np.inf, np.nan)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_any_input_has_an_answer(routines, dtype):
    """Numbers with every status but BAD_INPUT, none with that one; what is no number in targets, normals and weights is bad."""
    rng = np.random.default_rng(6)
    inputs = [np.tile(item, (200, *(1,) * item.ndim)) for item in (TARGETS, NORMALS, MODULE.middle, WEIGHTS)]
    for row in range(200):
        chosen = inputs[row % 4][row]
        chosen.flat[rng.integers(chosen.size, size=2)] = rng.choice(SPECIAL, 2)
    with np.errstate(over="ignore"):
        inputs = [item.astype(dtype) for item in inputs]
    q, status, cost = routines.adapt(*MODULE.data, *inputs, *MODULE.counts, dtype=dtype)
    bad = status == BAD_INPUT
    assert np.isnan(q[bad]).all()
    assert np.isnan(cost[bad]).all()
    assert np.isfinite(q[~bad]).all()
    assert np.isfinite(cost[~bad]).all()
    targets, normals, _, weights = (np.isfinite(item).reshape(200, -1).all(axis=-1) for item in inputs)
    assert bad[~(targets & normals & weights)].all()
    assert set(status.tolist()) <= {OK, UNREACHABLE, BAD_INPUT, NO_CONVERGENCE}
    assert not bad[2::4].all()


@pytest.mark.parametrize("seed", range(8))
def test_rates_as_in_numpy(routines, seed):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 2 + seed % 3, bool(seed % 2), seed % 4 < 2).limited([1], 0.1, 0.1 + (seed % 2))
    nq, feet, _ = robot.counts
    q, xd, qd0 = rng.normal(size=(40, nq)), rng.normal(size=(40, feet, 3)), rng.normal(size=(40, nq))
    epsilon, most = np.logspace(-6.0, 0.0, 40), np.logspace(-3.0, -1.0, 40)
    given = (*robot.data, q, xd, qd0, epsilon, most, *robot.counts)
    ours, reference = routines.adapt_velocity(*given), adapt_velocity(*given)
    np.testing.assert_array_equal(ours[1], reference[1])
    assert set(ours[1].tolist()) == {OK, SINGULAR}
    size = np.max(np.abs(reference[0]), axis=-1, keepdims=True)
    least = np.array([robot.least_singular_value(row) for row in q])[:, None]
    assert np.max(np.abs(ours[0] - reference[0]) * np.maximum(least, 1e-3) / size) <= 1e-12


def test_rates_in_single_precision(routines):
    given = (*MODULE.data, POSTURE, theory.O8_XD.reshape(2, 3), theory.O8_QD0, 1e-3, 0.02, *MODULE.counts)
    qd, status = routines.adapt_velocity(*given, dtype=np.float32)
    assert status == OK
    np.testing.assert_allclose(qd, theory.O8_QD, rtol=0, atol=1e-6)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_any_rates_have_an_answer(routines, dtype):
    """And the statuses of NumPy."""
    rng = np.random.default_rng(7)
    inputs = [np.tile(item, (400, *(1,) * item.ndim)) for item in (POSTURE, theory.O8_XD.reshape(2, 3), theory.O8_QD0)]
    bounds = np.tile([1e-3, 0.02], (400, 1))
    for row in range(400):
        chosen = (*inputs, bounds)[row % 4][row]
        chosen.flat[rng.integers(chosen.size, size=2)] = rng.choice(SPECIAL, 2)
    given = (*MODULE.data, *inputs, *bounds.T, *MODULE.counts)
    with np.errstate(over="ignore"):
        qd, status = routines.adapt_velocity(*given, dtype=dtype)
    bad = status == BAD_INPUT
    assert np.isnan(qd[bad]).all()
    assert np.isfinite(qd[~bad]).all()
    assert {OK, BAD_INPUT} <= set(status.tolist()) <= {OK, BAD_INPUT, SINGULAR}
    if dtype == np.float64:
        np.testing.assert_array_equal(status, adapt_velocity(*given)[1])

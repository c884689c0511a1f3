"""Adaption's rates in NumPy: oracle O8, feet as asked, the nearest rates of dense equations, damped legs, every status."""

import numpy as np
import pytest

from oracles import theory
from oracles.trees import Robot, chapter_module, random_robot
from walkgen.runtime.solves.adapt_velocity import adapt_velocity

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
EPSILON, LAMBDA = 1e-3, 0.02
MODULE = chapter_module()
POSTURE = np.array([*theory.O8_C, *theory.O8_Q3, *theory.O8_Q4])
XD = theory.O8_XD.reshape(2, 3)


def resolve(robot=MODULE, q=POSTURE, xd=XD, qd0=theory.O8_QD0, epsilon=EPSILON, lambda_max=LAMBDA):
    return adapt_velocity(*robot.data, q, xd, qd0, epsilon, lambda_max, *robot.counts)


def moving(seed: int) -> tuple[Robot, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 2 + seed % 3, bool(seed % 2), seed % 4 < 2)
    q = robot.middle + robot.half * rng.uniform(-0.5, 0.5, len(robot.joints))
    return robot, q, rng.normal(size=(len(robot.feet), 3)), rng.normal(size=len(q))


def nearest(robot: Robot, q, xd, qd0, moved) -> np.ndarray:
    """Dense: the qd with J qd = xd and least sum of ((qd - qd0) / half)^2, of joints that may move; by LAPACK's complete factorisation."""
    half = np.where(np.isfinite(robot.half), robot.half, [1.0 if joint.slides else np.pi for joint in robot.joints])[moved]
    J = robot.jacobian(q)[:, moved]
    qd = np.zeros(len(q))
    qd[moved] = qd0[moved] + half * np.linalg.lstsq(J * half, xd.ravel() - J @ qd0[moved], rcond=None)[0]
    return qd


def test_o8_resolution():
    qd, status = resolve()
    assert status == OK
    np.testing.assert_allclose(qd, theory.O8_QD, rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_feet_move_as_asked_and_no_rates_are_nearer(seed):
    robot, q, xd, qd0 = moving(seed)
    qd, status = resolve(robot, q, xd, qd0, epsilon=1e-9)
    J = robot.jacobian(q)
    least = robot.least_singular_value(q)
    assert status == OK
    assert np.max(np.abs(J @ qd - xd.ravel())) <= 1e-13 * np.max(np.abs(qd))
    expected = nearest(robot, q, xd, qd0, np.ones(len(q), bool))
    assert np.max(np.abs(qd - expected)) <= 1e-12 * np.max(np.abs(qd)) / least


def test_joints_without_range_stand_still_and_others_without_limits_count():
    robot = MODULE.limited([1], 0.2, 0.2).limited([0, 5], -np.inf, np.inf).limited([8], -np.inf, 0.0)
    qd, status = resolve(robot)
    moved = np.arange(9) != 1
    assert status == OK
    assert qd[1] == 0.0
    np.testing.assert_allclose(qd, nearest(robot, POSTURE, XD, theory.O8_QD0, moved), rtol=0, atol=1e-13)


def test_feet_at_rest_and_no_wish_is_rest():
    qd, status = resolve(xd=np.zeros((2, 3)), qd0=np.zeros(9))
    assert status == OK
    assert not qd.any()


@pytest.mark.parametrize("bend", [0.0, 1e-12, 1e-6, 1e-4])
def test_a_stretched_leg_is_damped_and_slow(bend):
    """Its foot is slower than asked, no rate exceeds what damping allows; the other foot moves as asked."""
    q = POSTURE.copy()
    q[5] = bend
    qd, status = resolve(q=q, xd=np.ones((2, 3)))
    J = MODULE.jacobian(q)
    speed = (J @ qd).reshape(2, 3)
    assert status == SINGULAR
    np.testing.assert_allclose(speed[1], 1.0, rtol=0, atol=1e-12)
    asked = np.ones(3) - J[:3, :3] @ qd[:3]
    assert np.linalg.norm(qd[3:6]) <= np.linalg.norm(asked) * max(1.0 / (2.0 * LAMBDA), 1.0 / smallest_but_one(J[:3, 3:6]))
    assert np.linalg.norm(speed[0] - 1.0) <= np.linalg.norm(asked)


def smallest_but_one(J) -> float:
    return float(np.linalg.svd(J)[1][1])


def test_rates_grow_no_more_towards_the_singular_pose():
    q = np.tile(POSTURE, (60, 1))
    q[:, 5] = -np.logspace(0.0, -14.0, 60)
    qd, status = resolve(q=q)
    assert set(status.tolist()) == {OK, SINGULAR}
    assert (np.diff(status) >= 0).all()
    assert np.max(np.abs(qd)) <= 1.0 / (2.0 * LAMBDA)


PLACES = {"geometry": 0, "limits": 2, "q": 3, "xd": 4, "qd0": 5, "epsilon": 6, "lambda_max": 7}


@pytest.mark.parametrize("name", PLACES)
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_no_number_is_bad_input(name, value):
    inputs = [*MODULE.data, POSTURE, XD, theory.O8_QD0, np.array(EPSILON), np.array(LAMBDA)]
    inputs[PLACES[name]] = inputs[PLACES[name]].copy()
    inputs[PLACES[name]].flat[0] = value
    qd, status = adapt_velocity(*inputs, *MODULE.counts)
    assert status == BAD_INPUT
    assert np.isnan(qd).all()


@pytest.mark.parametrize("size", [1e-300, 1e-20, 1e20, 1e300])
def test_speeds_of_any_size(size):
    qd, status = resolve(xd=XD * size, qd0=theory.O8_QD0 * size)
    assert status == OK
    np.testing.assert_allclose(qd / size, theory.O8_QD, rtol=0, atol=1e-12)


def test_leading_dimensions_broadcast():
    q = POSTURE + np.array([0.0, 0.1])[:, None, None]
    qd, status = resolve(q=q, epsilon=np.array([1e-3, 1e-4, 1e-5]))
    assert qd.shape == (2, 3, 9)
    assert status.shape == (2, 3)
    np.testing.assert_array_equal(qd[1, 2], resolve(q=q[1, 0])[0])

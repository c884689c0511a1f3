"""Joint rates and accelerations, compiled and in NumPy, against the cross-product Jacobian and NumPy's singular values."""

import numpy as np
import pytest
from legs import EPSILON, LAMBDA, LEGS

OK, BAD_INPUT, SINGULAR = 0, 2, 3


@pytest.fixture(params=["c", "numpy"])
def either(request, specimen):
    return lambda name: specimen(name, request.param)


def motions(count):
    """Random q, qd and v: [n, 3] each."""
    generator = np.random.default_rng(31)
    return generator.uniform(-np.pi, np.pi, (count, 3)), *generator.normal(size=(2, count, 3))


def singular_poses(leg):
    """Stretched, folded and upright ones, exactly and by 1e-12 to 1e-2 rad: [n, 3]."""
    anatomy = leg.anatomy
    a1, thigh, shank, w = anatomy.lengths
    hip = np.hypot(a1, w)
    far, near = anatomy.point(hip + 9 * (thigh + shank), 5 * shank), anatomy.point(np.hypot(a1 + 1e-3 * abs(thigh - shank), w), 0.0)
    above = anatomy.point(abs(w), np.array([-0.7, 0.3, 3.0]) * (thigh + shank))
    exact = leg.generated.inverse(np.concatenate([far[None], near[None], above]))[0].reshape(-1, 3)
    beside = np.random.default_rng(6).normal(size=(12, 1, 3)) * 10.0 ** np.linspace(-12, -2, 12)[:, None, None]
    return np.concatenate([exact, (exact + beside).reshape(-1, 3)])


def damped(J, v):
    """Rates [n,3], statuses [n] and the damping lambda [n], by singular values."""
    u, s, vt = np.linalg.svd(J)
    least = s[:, -1]
    damping = np.where(least < EPSILON, np.sqrt(np.maximum(1 - (least / EPSILON) ** 2, 0)) * LAMBDA, 0.0)
    gains = s / (s**2 + damping[:, None] ** 2)
    rates = np.einsum("nki,nk,njk,nj->ni", vt, gains, u, v)
    return rates, np.where(least < EPSILON, SINGULAR, OK), damping


def relative(found, expected):
    return np.linalg.norm(found - expected, axis=-1) / np.linalg.norm(expected, axis=-1)


@pytest.mark.parametrize("name", LEGS)
def test_velocities_come_back(either, name):
    """v = J qd, wherever the leg is not near a singular pose; OK there and only there."""
    leg = either(name)
    q, _, v = motions(3000)
    J = leg.anatomy.jacobian(q)
    least = np.linalg.svd(J, compute_uv=False)[:, -1]
    qd, status = leg.generated.inverse_velocity(q, v)
    assert np.array_equal(status, np.where(least < EPSILON, SINGULAR, OK))
    fine = status == OK
    assert np.count_nonzero(fine) > 100
    assert np.all(relative(np.einsum("nij,nj->ni", J, qd), v)[fine] <= 1e-10)


@pytest.mark.parametrize("name", LEGS)
def test_rates_are_damped_near_singular_poses(either, name):
    leg = either(name)
    q = np.concatenate([singular_poses(leg), motions(2000)[0]])
    v = np.random.default_rng(7).normal(size=q.shape)
    expected, statuses, damping = damped(leg.anatomy.jacobian(q), v)
    assert np.count_nonzero(statuses == SINGULAR) > 100
    qd, status = leg.generated.inverse_velocity(q, v)
    assert np.array_equal(status, statuses)
    assert np.all(relative(qd, expected) <= 1e-10)
    bounded = np.linalg.norm(qd, axis=1) * 2 * damping <= np.linalg.norm(v, axis=1) * (1 + 1e-12)
    assert np.all(bounded)


@pytest.mark.parametrize("name", LEGS)
def test_accelerations_come_back(either, name):
    """a = J qdd + Jdot qd, with Jdot qd from complex steps."""
    leg = either(name)
    q, qd, a = motions(40)
    q = np.concatenate([q[:-8], singular_poses(leg)[:8]])
    bias = np.array([leg.anatomy.limb.bias_acceleration(*row)[:3] for row in zip(q, qd, strict=True)])
    expected, statuses, damping = damped(leg.anatomy.jacobian(q), a - bias)
    qdd, status = leg.generated.inverse_acceleration(q, qd, a)
    assert np.array_equal(status, statuses)
    assert np.all(relative(qdd, expected) <= 1e-10)
    assert np.all(np.linalg.norm(qdd, axis=1) * 2 * damping <= np.linalg.norm(a - bias, axis=1) * (1 + 1e-10))


@pytest.mark.parametrize("name", LEGS)
def test_both_at_once(either, name):
    """As one after the other, at any pose: regular, damped, and at the border between, where either way decides alike."""
    leg = either(name)
    q, v, a = motions(3000)
    near = np.linalg.svd(leg.anatomy.jacobian(q), compute_uv=False)[:, -1]
    border = q[np.argsort(np.abs(near - EPSILON))[:100]]
    q = np.concatenate([q[:500], border, singular_poses(leg)])
    v, a = np.resize(v, q.shape), np.resize(a, q.shape)
    qd, qdd, status = leg.generated.inverse_velocity_acceleration(q, v, a)
    first, one = leg.generated.inverse_velocity(q, v)
    second, other = leg.generated.inverse_acceleration(q, qd, a)
    assert {OK, SINGULAR} == set(status)
    assert np.array_equal(status, one)
    assert np.array_equal(status, other)
    assert np.all(relative(qd, first) <= 1e-11)
    assert np.all(relative(qdd, second) <= 1e-10)


@pytest.mark.parametrize("name", ["general", "roll", "axes"])
def test_what_is_not_finite_is_bad_input(either, name):
    leg = either(name)
    fine = np.array([0.3, -0.7, 0.9, 0.5, -0.2, 0.4, 1.0, -2.0, 0.1])
    rows = np.array([np.where(np.arange(9) == place, value, fine) for place in range(9) for value in (np.nan, np.inf, -np.inf)])
    with np.errstate(all="ignore"):
        qd, status = leg.generated.inverse_velocity(rows[:18, :3], rows[:18, 3:6])
        qdd, code = leg.generated.inverse_acceleration(rows[:, :3], rows[:, 3:6], rows[:, 6:])
    assert np.all(status == BAD_INPUT)
    assert np.all(code == BAD_INPUT)
    assert np.all(np.isnan(qd))
    assert np.all(np.isnan(qdd))


@pytest.mark.parametrize("name", ["general", "equal", "roll"])
def test_extremes_are_never_numberless_and_well(either, name):
    """Any size of velocity: numbers with OK or SINGULAR, none with BAD_INPUT."""
    leg = either(name)
    q = np.concatenate([singular_poses(leg)[:20], motions(20)[0]])
    for size in (0.0, 5e-324, 1e-200, 1e200, 1e308):
        with np.errstate(all="ignore"):
            qd, status = leg.generated.inverse_velocity(q, np.array([1.0, -0.5, 0.25]) * size)
        assert np.array_equal(np.any(np.isnan(qd), axis=1), status == BAD_INPUT)
        assert np.all(np.isfinite(qd[status != BAD_INPUT]))
        assert size >= 1e308 or np.all(status != BAD_INPUT)
        with np.errstate(all="ignore"):
            *both, status = leg.generated.inverse_velocity_acceleration(q, np.array([1.0, -0.5, 0.25]) * size, np.array([0.5, 1.0, 2.0]))
        assert np.array_equal(np.any(np.isnan(both), axis=(0, 2)), status == BAD_INPUT)
        assert np.array_equal(np.all(np.isnan(both), axis=(0, 2)), status == BAD_INPUT)
        assert size > 1.0 or np.all(status != BAD_INPUT)

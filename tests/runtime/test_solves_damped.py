"""The damped inverse against its defining equation in 40 digits, its bound, and the leg's singular poses."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from walkgen.runtime.solves.damped import damped_inverse_3

OK, BAD_INPUT, SINGULAR = 0, 2, 3
EPSILON, LAMBDA = 0.05, 0.1


def exact(J, v, epsilon, lambda_max):
    """J^T (J J^T + lambda^2 1)^-1 v, its least singular value and lambda, in 40 digits."""
    with mpmath.workdps(40):
        matrix, speed = mpmath.matrix(J.tolist()), mpmath.matrix(v.tolist())
        least = min(mpmath.svd_r(matrix, compute_uv=False))
        square = (1 - (least / epsilon) ** 2) * mpmath.mpf(lambda_max) ** 2 if least < epsilon else mpmath.mpf(0)
        qd = matrix.T * mpmath.lu_solve(matrix * matrix.T + square * mpmath.eye(3), speed)
        return np.array([float(x) for x in qd]), float(least), float(mpmath.sqrt(square))


def with_singular_values(seed, values):
    rng = np.random.default_rng(seed)
    U, V = (np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(2))
    return U @ np.diag(values) @ V.T, rng.normal(size=3)


@given(st.integers(0, 10**6), st.floats(0.1, 3.0), st.floats(0.1, 3.0), st.floats(-17.0, 0.5))
@settings(max_examples=200, deadline=None)
def test_the_defining_equation(seed, first, second, exponent):
    J, v = with_singular_values(seed, [first, second, 10.0**exponent])
    expected, least, damping = exact(J, v, EPSILON, LAMBDA)
    qd, status = damped_inverse_3(J, v, EPSILON, LAMBDA)
    assert np.linalg.norm(qd - expected) <= 1e-12 * np.linalg.norm(v) / max(least, damping)
    assert status == (OK if least >= EPSILON else SINGULAR)


@given(st.integers(0, 10**6), st.floats(-17.0, -1.31))
@settings(max_examples=100, deadline=None)
def test_the_bound(seed, exponent):
    J, v = with_singular_values(seed, [1.0, 0.4, 10.0**exponent])
    _, _, damping = exact(J, v, EPSILON, LAMBDA)
    qd, status = damped_inverse_3(J, v, EPSILON, LAMBDA)
    assert status == SINGULAR
    assert np.linalg.norm(qd) <= np.linalg.norm(v) / (2 * damping) * (1 + 1e-12)


def test_it_is_continuous_where_damping_begins():
    v = np.array([0.2, -0.1, 0.3])
    rates = [damped_inverse_3(np.diag([1.0, 0.7, EPSILON + gap]), v, EPSILON, LAMBDA)[0] for gap in (-1e-9, 1e-9)]
    assert rates[0] == pytest.approx(rates[1], abs=1e-5)


def leg_jacobian(t, phi, gamma):
    """The chapter's leg: a2 = 0.35, a3 = 0.40."""
    rho, h = 0.35 * np.cos(phi) + 0.4 * np.cos(phi + gamma), 0.35 * np.sin(phi) + 0.4 * np.sin(phi + gamma)
    x3, h3 = 0.4 * np.cos(phi + gamma), 0.4 * np.sin(phi + gamma)
    c, s = np.cos(t), np.sin(t)
    return np.array([[-rho * s, -h * c, -h3 * c], [rho * c, -h * s, -h3 * s], [0.0, rho, x3]])


def test_the_chapters_regular_pose():
    qd, status = damped_inverse_3(leg_jacobian(0.3, 0.5, -1.2), [0.0740901962010375, 0.2796202822395892, 0.030228580967029038], 0.02, 0.1)
    assert status == OK
    assert qd == pytest.approx([0.4, -0.3, 0.7], abs=1e-14)


SINGULAR_POSES = [(0.3, 0.5, 0.0), (0.3, 0.5, np.pi), (0.3, 1.9707963267948965, -0.7477050038008255)]


@pytest.mark.parametrize("pose", SINGULAR_POSES)
def test_the_chapters_singular_poses(pose):
    v = np.array([0.1, -0.3, 0.2])
    J = leg_jacobian(*pose)
    qd, status = damped_inverse_3(J, v, 0.02, 0.1)
    expected, least, _ = exact(J, v, 0.02, 0.1)
    assert least < 1e-15
    assert status == SINGULAR
    assert qd == pytest.approx(expected, abs=1e-13)


@given(st.integers(0, 10**6), st.integers(-900, 900), st.integers(-100, 100))
@settings(max_examples=60, deadline=None)
def test_size_does_not_matter(seed, exponent, speed):
    J, v = with_singular_values(seed, [1.0, 0.5, 0.01])
    plain, _ = damped_inverse_3(J, v, EPSILON, LAMBDA)
    big, status = damped_inverse_3(np.ldexp(J, exponent), np.ldexp(v, speed), np.ldexp(EPSILON, exponent), np.ldexp(LAMBDA, exponent))
    assert status == SINGULAR
    assert np.array_equal(big, np.ldexp(plain, speed - exponent))


BAD = [
    ("J", np.nan),
    ("J", np.inf),
    ("v", np.nan),
    ("v", -np.inf),
    ("epsilon", np.nan),
    ("epsilon", -1.0),
    ("lambda_max", np.inf),
    ("lambda_max", -0.1),
]


@pytest.mark.parametrize(("name", "value"), BAD)
def test_bad_input(name, value):
    arguments = {"J": np.eye(3), "v": np.ones(3), "epsilon": np.array(EPSILON), "lambda_max": np.array(LAMBDA)}
    arguments[name] = arguments[name].copy()
    arguments[name].flat[0] = value
    qd, status = damped_inverse_3(**arguments)
    assert status == BAD_INPUT
    assert np.isnan(qd).all()


def test_rates_beyond_the_range_of_numbers_are_bad_input():
    qd, status = damped_inverse_3(np.eye(3) * 1e-200, np.full(3, 1e200), 0.0, 0.0)
    assert status == BAD_INPUT
    assert np.isnan(qd).all()


@pytest.mark.parametrize(("epsilon", "lambda_max"), [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)])
def test_no_motion_at_all_is_singular(epsilon, lambda_max):
    qd, status = damped_inverse_3(np.zeros((3, 3)), np.ones(3), epsilon, lambda_max)
    assert status == SINGULAR
    assert np.array_equal(qd, np.zeros(3))


def test_rows_broadcast():
    J, v = with_singular_values(3, [1.0, 0.5, 0.2])
    qd, status = damped_inverse_3(np.broadcast_to(J, (2, 1, 3, 3)), np.broadcast_to(v, (5, 3)), EPSILON, LAMBDA)
    assert qd.shape == (2, 5, 3)
    assert np.array_equal(status, np.zeros((2, 5)))
    assert np.allclose(qd @ J.T, v, rtol=0, atol=1e-14)

"""The damped inverse of any number of joints: its defining equation, bound, least norm, closest velocity, continuity, shapes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from walkgen.runtime.solves.damped import damped_inverse_3
from walkgen.runtime.solves.damped_general import damped_inverse

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
EPSILON, LAMBDA = 0.05, 0.1
JOINTS = (1, 2, 3, 4, 6, 9, 16)


def with_least_value(seed, n, least):
    rng = np.random.default_rng(seed)
    U, s, Vt = np.linalg.svd(rng.normal(size=(3, n)), full_matrices=False)
    s[:-1] = np.maximum(s[:-1], least)
    s[-1] = least
    return U @ np.diag(s) @ Vt, rng.normal(size=3)


def solve(J, v, epsilon=EPSILON, lambda_max=LAMBDA):
    return damped_inverse(J, v, J.shape[-1], epsilon, lambda_max)


@given(st.integers(0, 10**6), st.sampled_from(JOINTS), st.floats(EPSILON * (1 + 1e-12), 3.0))
@settings(max_examples=200, deadline=None)
def test_far_from_singularities_it_is_least_squares(seed, n, least):
    """Of LAPACK's complete orthogonal factorisation, which gives the closest velocity and the least rates."""
    J, v = with_least_value(seed, n, least)
    qd, status = solve(J, v)
    expected = np.linalg.lstsq(J, v, rcond=None)[0]
    assert np.linalg.norm(qd - expected) <= 1e-12 * np.linalg.norm(v) / least
    assert status == (OK if n > 2 else UNREACHABLE)


@given(st.integers(0, 10**6), st.sampled_from(JOINTS), st.floats(-12.0, -1.31))
@settings(max_examples=200, deadline=None)
def test_near_singularities_both_defining_equations_hold(seed, n, exponent):
    J, v = with_least_value(seed, n, 10.0**exponent)
    qd, status = solve(J, v)
    square = (1 - (10.0**exponent / EPSILON) ** 2) * LAMBDA**2
    assert status == SINGULAR
    size = (np.linalg.norm(J) ** 2 + square) * np.linalg.norm(v) / np.sqrt(square)
    assert np.linalg.norm((J.T @ J + square * np.eye(n)) @ qd - J.T @ v) <= 1e-14 * size
    assert np.linalg.norm(qd - J.T @ np.linalg.solve(J @ J.T + square * np.eye(3), v)) <= 1e-10 * np.linalg.norm(v) / square
    assert np.linalg.norm(qd) <= np.linalg.norm(v) / (2 * np.sqrt(square)) * (1 + 1e-12)


@pytest.mark.parametrize("n", JOINTS)
def test_an_attained_velocity_is_ok(n):
    J, _ = with_least_value(4, n, 0.3)
    rates = np.linspace(-1.0, 2.0, n)
    qd, status = solve(J, J @ rates)
    assert status == OK
    assert J @ qd == pytest.approx(J @ rates, abs=1e-14)
    assert np.linalg.norm(qd) <= np.linalg.norm(rates) * (1 + 1e-15)


@pytest.mark.parametrize(("part", "status"), [(0.5e-9, OK), (2e-9, UNREACHABLE)])
def test_attained_to_a_billionth(part, status):
    """Two joints that move the foot in x and y."""
    v = np.array([1.0, 0.0, part])
    assert solve(np.eye(3, 2), v)[1] == status


@pytest.mark.parametrize("n", JOINTS)
def test_rest_is_always_attained(n):
    qd, status = solve(with_least_value(5, n, 0.3)[0], np.zeros(3))
    assert status == OK
    assert np.array_equal(qd, np.zeros(n))


@pytest.mark.parametrize("n", JOINTS)
def test_it_is_continuous_where_damping_begins(n):
    found = [solve(*with_least_value(6, n, EPSILON + gap)) for gap in (-1e-12, 1e-12)]
    assert [status for _, status in found] == [SINGULAR, OK if n > 2 else UNREACHABLE]
    assert found[0][0] == pytest.approx(found[1][0], abs=1e-6)


@given(st.integers(0, 10**6), st.sampled_from(JOINTS), st.integers(-900, 900), st.integers(-100, 100))
@settings(max_examples=60, deadline=None)
def test_size_does_not_matter(seed, n, exponent, speed):
    J, v = with_least_value(seed, n, 0.01)
    plain, _ = solve(J, v)
    big, status = solve(np.ldexp(J, exponent), np.ldexp(v, speed), np.ldexp(EPSILON, exponent), np.ldexp(LAMBDA, exponent))
    assert status == SINGULAR
    assert np.array_equal(big, np.ldexp(plain, speed - exponent))


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize("name", ["J", "v", "epsilon", "lambda_max"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_bad_input(n, name, value):
    arguments = {"J": np.eye(3, n), "v": np.ones(3), "epsilon": np.array(EPSILON), "lambda_max": np.array(LAMBDA)}
    arguments[name].flat[-1] = value
    qd, status = damped_inverse(n=n, **arguments)
    assert status == BAD_INPUT
    assert np.isnan(qd).all()


def test_seventeen_joints_are_bad_input():
    qd, status = solve(np.ones((3, 17)), np.ones(3))
    assert status == BAD_INPUT
    assert np.isnan(qd).all()


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize(("epsilon", "lambda_max"), [(0.0, 0.0), (0.1, 0.0), (0.1, 0.1)])
def test_no_motion_at_all_is_singular(n, epsilon, lambda_max):
    qd, status = solve(np.zeros((3, n)), np.ones(3), epsilon, lambda_max)
    assert status == SINGULAR
    assert np.array_equal(qd, np.zeros(n))


def test_three_joints_have_a_name_of_their_own():
    J, v = with_least_value(7, 3, 0.01)
    found, general = damped_inverse_3(J, v, EPSILON, LAMBDA), solve(J, v)
    assert found[1] == general[1]
    assert np.array_equal(found[0], general[0])


@pytest.mark.parametrize("n", JOINTS)
def test_rows_broadcast(n):
    J, v = with_least_value(3, n, 0.2)
    qd, status = solve(np.broadcast_to(J, (2, 1, 3, n)), np.broadcast_to(v, (5, 3)))
    assert qd.shape == (2, 5, n)
    assert status.shape == (2, 5)
    assert np.allclose(qd, solve(J, v)[0], rtol=0, atol=1e-14)

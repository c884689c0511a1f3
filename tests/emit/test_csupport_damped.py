"""The damped inverse in C against its NumPy reference and against 40 digits, in double and float."""

import mpmath
import numpy as np
import pytest
from csupport_library import SOURCE, STRICT, Library, compile_c

from walkgen.runtime.solves.damped import damped_inverse_3

OK, BAD_INPUT, SINGULAR = 0, 2, 3
EPSILON, LAMBDA = 0.05, 0.1


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return Library(compile_c(tmp_path_factory.mktemp("csupport"), SOURCE, "csupport.so", "-std=c99", "-O2", "-shared", "-fPIC", *STRICT))


def random_rows(seed, rows, least):
    """Jacobians whose least singular value spreads over `least` decades below 1, and velocities."""
    rng = np.random.default_rng(seed)
    U, s, Vt = np.linalg.svd(rng.normal(size=(rows, 3, 3)))
    s[:, 2] *= 10.0 ** rng.uniform(-least, 0.0, rows)
    repeated = rng.random(rows) < 0.2
    s[repeated, 1] = s[repeated, 0]
    return np.einsum("nij,nj,njk->nik", U, s, Vt), rng.normal(size=(rows, 3))


def bounds(rows, epsilon=EPSILON, lambda_max=LAMBDA):
    return np.tile([epsilon, lambda_max], (rows, 1))


def relative_error(J, v, found, expected, epsilon=EPSILON, lambda_max=LAMBDA):
    """Errors over the largest rate that such a Jacobian and velocity can give."""
    least = np.linalg.svd(J, compute_uv=False)[:, 2]
    damping = lambda_max * np.sqrt(np.maximum(1 - (least / epsilon) ** 2, 0.0))
    return np.linalg.norm(found - expected, axis=-1) * np.maximum(least, damping) / np.linalg.norm(v, axis=-1)


@pytest.mark.parametrize("decades", [0.5, 3.0, 18.0])
def test_c_and_numpy_agree(library, decades):
    J, v = random_rows(7, 20000, decades)
    qd, status = library.damped(J, v, bounds(20000))
    expected, states = damped_inverse_3(J, v, EPSILON, LAMBDA)
    assert np.array_equal(status, states)
    assert {OK, SINGULAR} <= set(status) or decades < 1
    assert relative_error(J, v, qd, expected).max() <= 1e-12


def test_c_against_40_digits(library):
    J, v = random_rows(8, 150, 6.0)
    qd, status = library.damped(J, v, bounds(150))
    with mpmath.workdps(40):
        for matrix, speed, rates, state in zip(J, v, qd, status, strict=True):
            A, b = mpmath.matrix(matrix.tolist()), mpmath.matrix(speed.tolist())
            least = min(mpmath.svd_r(A, compute_uv=False))
            square = (1 - (least / EPSILON) ** 2) * mpmath.mpf(LAMBDA) ** 2 if least < EPSILON else mpmath.mpf(0)
            exact = np.array([float(x) for x in A.T * mpmath.lu_solve(A * A.T + square * mpmath.eye(3), b)])
            assert state == (SINGULAR if least < EPSILON else OK)
            assert relative_error(matrix[None], speed[None], rates[None], exact[None])[0] <= 1e-14


def test_the_fast_path_is_as_good_as_elimination(library):
    """Ill-conditioned, yet above epsilon: backward error of a few roundings."""
    J, v = random_rows(9, 5000, 5.0)
    qd, status = library.damped(J, v, bounds(5000, epsilon=1e-12))
    residual = np.linalg.norm(np.einsum("nij,nj->ni", J, qd) - v, axis=-1)
    size = np.linalg.norm(J, axis=(1, 2)) * np.linalg.norm(qd, axis=-1) + np.linalg.norm(v, axis=-1)
    assert np.all(status == OK)
    assert (residual / size).max() <= 1e-15


@pytest.mark.parametrize("exponent", [-1000, -250, 250, 1000])
def test_any_size(library, exponent):
    J, v = random_rows(10, 300, 3.0)
    qd, status = library.damped(J, v, bounds(300))
    scaled, states = library.damped(np.ldexp(J, exponent), v, np.ldexp(bounds(300), exponent))
    assert np.array_equal(status, states)
    assert relative_error(J, v, np.ldexp(scaled, exponent), qd).max() <= 1e-13


def test_float(library):
    J, v = (array.astype(np.float32) for array in random_rows(13, 20000, 8.0))
    qd, status = library.damped(J, v, bounds(20000), dtype=np.float32)
    expected, states = damped_inverse_3(J.astype(float), v.astype(float), np.float32(EPSILON), np.float32(LAMBDA))
    values = np.linalg.svd(J.astype(float), compute_uv=False)
    clear = np.abs(values[:, 2] - EPSILON) > 1e-6
    assert np.array_equal(status[clear], states[clear])
    condition = values[:, 0] / np.maximum(values[:, 2], EPSILON)
    error = relative_error(J.astype(float), v.astype(float), qd.astype(float), expected)
    assert (error / condition)[clear].max() <= 4 * np.finfo(np.float32).eps


BAD = [
    (0, 0, np.nan),
    (0, 8, np.inf),
    (1, 0, np.nan),
    (1, 2, -np.inf),
    (2, 0, np.nan),
    (2, 0, -1e-3),
    (2, 0, np.inf),
    (2, 1, np.nan),
    (2, 1, -1.0),
]


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize(("argument", "element", "value"), BAD)
def test_bad_input(library, argument, element, value, dtype):
    arguments = [np.eye(3).reshape(1, 9) * 2, np.ones((1, 3)), bounds(1)]
    arguments[argument][0, element] = value
    qd, status = library.damped(*arguments, dtype=dtype)
    assert status[0] == BAD_INPUT
    assert np.isnan(qd).all()


SPECIAL = [0.0, -1.0, 1e-320, 1e-160, 1e160, -1.7e308]


@pytest.mark.parametrize("limits", [(0.0, 0.0), (0.0, 0.1), (0.05, 0.0), (0.05, 0.1), (1e308, 1e308), (1e-310, 1e300)])
def test_never_a_number_that_is_none_with_ok(library, limits):
    rng = np.random.default_rng(14)
    J, v = rng.choice(SPECIAL, (4000, 3, 3)), rng.choice(SPECIAL, (4000, 3))
    qd, status = library.damped(J, v, bounds(4000, *limits))
    fine = np.isfinite(qd).all(axis=-1)
    assert np.array_equal(fine, status != BAD_INPUT)
    assert np.isnan(qd[~fine]).all()
    assert set(status) <= {OK, SINGULAR, BAD_INPUT}

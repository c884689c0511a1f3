"""The damped inverse of 1 to 16 joints in C: against its NumPy reference, against 40 digits, in float, and on every odd number."""

import subprocess

import mpmath
import numpy as np
import pytest
from csupport_library import STRICT, compile_c
from damped_library import SOURCE, Damped

from walkgen.runtime.solves.damped_general import damped_inverse

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
EPSILON, LAMBDA = 0.05, 0.1
BOUNDS = (EPSILON, LAMBDA)
JOINTS = (1, 2, 3, 4, 5, 6, 7, 9, 16)


@pytest.fixture(scope="module")
def damped(tmp_path_factory):
    return Damped(tmp_path_factory.mktemp("damped"))


def random_rows(seed, rows, n, least, attained=0.5):
    """Jacobians whose least singular value spreads over `least` decades below 1, and velocities, a share of them the foot's."""
    rng = np.random.default_rng(seed)
    U, s, Vt = np.linalg.svd(rng.normal(size=(rows, 3, n)), full_matrices=False)
    s[:, -1] = rng.uniform(0.3, 1.0, rows) * 10.0 ** rng.uniform(-least, 0.0, rows)
    if n > 1:
        repeated = rng.random(rows) < 0.2
        s[repeated, 0] = s[repeated, 1]
    v = rng.normal(size=(rows, 3))
    inside = np.einsum("rik,rjk,rj->ri", U, U, v)
    return np.einsum("rij,rj,rjk->rik", U, s, Vt), np.where(rng.random((rows, 1)) < attained, inside, v)


def sizes(J):
    """The least singular value and the greatest."""
    s = np.linalg.svd(J, compute_uv=False)
    return s[:, -1], s[:, 0]


def relative_error(J, v, found, expected):
    """Errors over the largest rate that such a Jacobian and velocity can give."""
    least, _ = sizes(J)
    damping = LAMBDA * np.sqrt(np.maximum(1 - (least / EPSILON) ** 2, 0.0))
    return np.linalg.norm(found - expected, axis=-1) * np.maximum(least, damping) / np.linalg.norm(v, axis=-1)


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize("decades", [0.5, 3.0, 18.0])
def test_c_and_numpy_agree(damped, n, decades):
    J, v = random_rows(n, 4000, n, decades)
    qd, status = damped(J, v, BOUNDS)
    expected, states = damped_inverse(J, v, n, *BOUNDS)
    assert np.array_equal(status, states)
    assert {OK, UNREACHABLE} <= set(status) or n > 2
    assert SINGULAR in status or decades < 1
    assert relative_error(J, v, qd, expected).max() <= 1e-13


@pytest.mark.parametrize("n", JOINTS)
def test_c_against_40_digits(damped, n):
    J, v = random_rows(100 + n, 60, n, 6.0)
    qd, status = damped(J, v, BOUNDS)
    with mpmath.workdps(40):
        for matrix, speed, rates, state in zip(J, v, qd, status, strict=True):
            A, b = mpmath.matrix(matrix.tolist()), mpmath.matrix(speed.tolist())
            least = min(mpmath.svd_r(A, compute_uv=False))
            square = (1 - (least / EPSILON) ** 2) * mpmath.mpf(LAMBDA) ** 2 if least < EPSILON else mpmath.mpf(0)
            exact = _solution(A, b, square)
            missed = mpmath.norm(A * exact - b) > mpmath.mpf("1e-9") * mpmath.norm(b)
            assert state == (SINGULAR if square else UNREACHABLE if missed else OK)
            exact = np.array([float(x) for x in exact])
            assert relative_error(matrix[None], speed[None], rates[None], exact[None])[0] <= 1e-14


def _solution(A, b, square):
    if A.rows <= A.cols:
        return A.T * mpmath.lu_solve(A * A.T + square * mpmath.eye(A.rows), b)
    return mpmath.lu_solve(A.T * A + square * mpmath.eye(A.cols), A.T * b)


@pytest.mark.parametrize("n", [4, 7, 16])
def test_the_fast_path_of_redundant_legs_loses_nothing(damped, n):
    """Ill-conditioned, yet above epsilon: J qd = v to a few roundings, and nothing of qd moves no foot."""
    J, v = random_rows(9 + n, 3000, n, 5.0)
    qd, status = damped(J, v, (1e-12, LAMBDA))
    least, largest = sizes(J)
    residual = np.linalg.norm(np.einsum("rij,rj->ri", J, qd) - v, axis=-1)
    size = largest * np.linalg.norm(qd, axis=-1) + np.linalg.norm(v, axis=-1)
    free = np.linalg.svd(J)[2][:, 3:]
    idle = np.linalg.norm(np.einsum("rij,rj->ri", free, qd), axis=-1) / np.linalg.norm(qd, axis=-1)
    assert np.all(status == OK)
    assert (residual / size).max() <= 1e-14
    assert (idle * least / largest).max() <= 1e-14


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize("exponent", [-1000, -250, 250, 1000])
def test_any_size(damped, n, exponent):
    J, v = random_rows(10, 200, n, 3.0)
    qd, status = damped(J, v, BOUNDS)
    scaled, states = damped(np.ldexp(J, exponent), v, np.ldexp(BOUNDS, exponent))
    assert np.array_equal(status, states)
    assert relative_error(J, v, np.ldexp(scaled, exponent), qd).max() <= 1e-13


@pytest.mark.parametrize("n", JOINTS)
def test_float(damped, n):
    J, v = (array.astype(np.float32) for array in random_rows(13, 4000, n, 8.0))
    qd, status = damped(J, v, BOUNDS, dtype=np.float32)
    wide = np.float32(EPSILON).astype(float), np.float32(LAMBDA).astype(float)
    expected, states = damped_inverse(J.astype(float), v.astype(float), n, *wide)
    least, largest = sizes(J.astype(float))
    rest = np.linalg.norm(v - np.einsum("rij,rj->ri", J, expected), axis=-1) / np.linalg.norm(v, axis=-1)
    states[(states == UNREACHABLE) & (rest < 1e-4)] = OK
    clear = (np.abs(least - EPSILON) > 1e-6) & ((rest < 1e-5) | (rest > 2e-4) | (least < EPSILON))
    assert np.count_nonzero(clear) > 3900
    assert np.array_equal(status[clear], states[clear])
    error = relative_error(J.astype(float), v.astype(float), qd.astype(float), expected)
    assert (error * np.maximum(least, EPSILON) / largest)[clear].max() <= 4 * np.finfo(np.float32).eps


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize(("argument", "element"), [(0, 0), (0, -1), (1, 0), (1, 2), (2, 0), (2, 1)])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_bad_input(damped, n, argument, element, value, dtype):
    arguments = [np.eye(3, n)[None] * 2, np.ones((1, 3)), np.array([BOUNDS])]
    arguments[argument].reshape(-1)[element] = value
    qd, status = damped(*arguments, dtype=dtype)
    assert status[0] == BAD_INPUT
    assert np.isnan(qd).all()


@pytest.mark.parametrize("bounds", [(-1e-3, 0.1), (0.1, -1e-3)])
def test_negative_bounds_are_bad_input(damped, bounds):
    qd, status = damped(np.eye(3, 5)[None], np.ones((1, 3)), bounds)
    assert status[0] == BAD_INPUT
    assert np.isnan(qd).all()


def test_seventeen_joints_are_bad_input(damped):
    qd, status = damped(np.ones((1, 3, 17)), np.ones((1, 3)), BOUNDS)
    assert status[0] == BAD_INPUT
    assert np.isnan(qd).all()


SPECIAL = [0.0, -1.0, 1e-320, 1e-160, 1e160, -1.7e308]


@pytest.mark.parametrize("n", JOINTS)
@pytest.mark.parametrize("limits", [(0.0, 0.0), (0.0, 0.1), (0.05, 0.0), (0.05, 0.1), (1e308, 1e308), (1e-310, 1e300)])
def test_never_a_number_that_is_none_with_ok(damped, n, limits):
    rng = np.random.default_rng(14)
    J, v = rng.choice(SPECIAL, (2000, 3, n)), rng.choice(SPECIAL, (2000, 3))
    qd, status = damped(J, v, limits)
    fine = np.isfinite(qd).all(axis=-1)
    assert np.array_equal(fine, status != BAD_INPUT)
    assert np.isnan(qd[~fine]).all()
    assert set(status) <= {OK, UNREACHABLE, BAD_INPUT, SINGULAR}


DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.0, 1.0, -1.0, 0.35, -0.4, 3.0, -0.0, 5e-324, 1e-160, 1e-9, 1e20, -1e160, 1.7e308, NAN, INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
int main(void) {
    uint32_t seed = 1u;
    int bad = 0;
    for (int run = 0; run < 30000; ++run) {
        const int n = 1 + run % 16;
        double number[53], qd[16];
        float single[53], qd_single[16];
        int32_t status;
        for (int i = 0; i < 53; ++i) {
            seed = seed * 1664525u + 1013904223u;
            number[i] = VALUES[(seed >> 16) % (run % 3 ? 6 : COUNT)];
            single[i] = number[i] > 3e38 || number[i] < -3e38 ? INFINITY : (float)number[i];
        }
        rates_rows(1, n, number, number + 48, number + 51, qd, &status);
        for (int i = 0; i < n; ++i) bad += (status == WALKGEN_BAD_INPUT) == !!isfinite(qd[i]);
        rates_rows_f32(1, n, single, single + 48, single + 51, qd_single, &status);
        for (int i = 0; i < n; ++i) bad += (status == WALKGEN_BAD_INPUT) == !!isfinite(qd_single[i]);
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, SOURCE + DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"


@pytest.mark.parametrize("level", ["-O0", pytest.param("-O3", marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, level, standard, compiler):
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, level, "-c", *STRICT, compiler=compiler).exists()

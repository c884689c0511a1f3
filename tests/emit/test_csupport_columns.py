"""Second derivatives and Jdot qd by loops over a Jacobian's columns: in C and in NumPy against differences of a path in 50 digits."""

import mpmath
import numpy as np
import pytest
from general_library import build, call, source

from walkgen.runtime.solves.columns import rest_acceleration, second_derivatives

LOOPS = """
void columns@(int n, const REAL *J, const REAL *axes, const REAL *qd, const REAL *a, REAL *H, REAL *rest);
void columns@(int n, const REAL *J, const REAL *axes, const REAL *qd, const REAL *a, REAL *H, REAL *rest) {
    wg_second_derivatives@(J, axes, n, H);
    wg_rest_acceleration@(J, axes, qd, a, n, rest);
}
"""
MANY_DIGITS = mpmath.mp.clone()
MANY_DIGITS.dps = 50
STEP = MANY_DIGITS.mpf(10) ** -15


class Path:
    """Joints that turn or slide about their z axes, each after a constant pose."""

    def __init__(self, kinds, seed):
        rng = np.random.default_rng(seed)
        self.kinds = kinds
        self.constants = [(self._turned(rng.uniform(-3, 3, 3)), MANY_DIGITS.matrix(rng.normal(size=3).tolist())) for _ in (*kinds, "foot")]

    def _turned(self, angles):
        x, y, z = (self._about(axis, angle) for axis, angle in enumerate(angles))
        return z * y * x

    def _about(self, axis, angle):
        cosine, sine = MANY_DIGITS.cos(angle), MANY_DIGITS.sin(angle)
        R = MANY_DIGITS.eye(3)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        R[first, first] = R[second, second] = cosine
        R[second, first], R[first, second] = sine, -sine
        return R

    def walked(self, q):
        """The foot, and each joint's axis."""
        R, p, axes = MANY_DIGITS.eye(3), MANY_DIGITS.matrix(3, 1), []
        for (turn, shift), kind, value in zip(self.constants, (*self.kinds, ""), (*q, 0), strict=True):
            p, R = p + R * shift, R * turn
            axes.append(R[:, 2])
            p = p + R[:, 2] * value if kind == "slides" else p
            R = R * self._about(2, value) if kind == "turns" else R
        return p, axes[:-1]

    def foot(self, q, *moves):
        moved = list(map(MANY_DIGITS.mpf, q))
        for joint, step in moves:
            moved[joint] += step
        return self.walked(moved)[0]

    def columns(self, q):
        """J and axes [3, n] in doubles."""
        n, axes = len(q), self.walked(list(map(MANY_DIGITS.mpf, q)))[1]
        J = [(self.foot(q, (i, STEP)) - self.foot(q, (i, -STEP))) / (2 * STEP) for i in range(n)]
        turning = [axis if kind == "turns" else 0 * axis for axis, kind in zip(axes, self.kinds, strict=True)]
        return (np.array([[float(column[row]) for column in each] for row in range(3)]) for each in (J, turning))

    def second(self, q):
        """H [3, n, n] by differences."""
        n, H = len(q), np.empty((3, len(q), len(q)))
        for i in range(n):
            for j in range(n):
                ends = [a * b * self.foot(q, (i, a * STEP), (j, b * STEP)) for a in (1, -1) for b in (1, -1)]
                H[:, i, j] = [float(sum((end[row] for end in ends), start=MANY_DIGITS.zero) / (4 * STEP**2)) for row in range(3)]
        return H

    def bias(self, q, qd):
        """Jdot qd [3]: the foot's acceleration at constant rates."""
        ahead, here, back = (self.foot(q, *((i, side * STEP * rate) for i, rate in enumerate(qd))) for side in (1, 0, -1))
        return np.array([float((ahead[row] - 2 * here[row] + back[row]) / STEP**2) for row in range(3)])


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return build(tmp_path_factory.mktemp("columns"), source(LOOPS, "walkgen_columns.h"))


@pytest.mark.parametrize("kinds", [("turns",) * 4, ("turns", "slides", "turns", "turns", "slides"), ("slides",), ("turns",)])
def test_loops_and_reference_are_derivatives_of_the_path(library, kinds):
    rng, path, n = np.random.default_rng(len(kinds)), Path(kinds, 3), len(kinds)
    q, qd, a = rng.uniform(-2, 2, n), rng.normal(size=n), rng.normal(size=3)
    J, axes = path.columns(q)
    expected = path.second(q), a - path.bias(q, qd)
    for dtype, accuracy in ((np.float64, 1e-13), (np.float32, 1e-5)):
        H, rest = np.full((3, n, n), 7.0, dtype), np.full(3, 7.0, dtype)
        call(library, "columns", dtype, n, *(np.ascontiguousarray(each, dtype) for each in (J, axes, qd, a)), H, rest)
        for found, wanted in zip((H, rest), expected, strict=True):
            np.testing.assert_allclose(found, wanted, rtol=accuracy, atol=10 * accuracy)
    np.testing.assert_allclose(second_derivatives(J, axes, n), expected[0], rtol=1e-13, atol=1e-12)
    np.testing.assert_allclose(rest_acceleration(J, axes, qd, a, n), expected[1], rtol=1e-13, atol=1e-12)


def test_rows_of_the_reference_are_alone():
    rng = np.random.default_rng(4)
    J, axes, qd, a = rng.normal(size=(2, 5, 3, 9)), rng.normal(size=(2, 5, 3, 9)), rng.normal(size=(2, 5, 9)), rng.normal(size=(2, 5, 3))
    assert second_derivatives(J, axes, 9).shape == (2, 5, 3, 9, 9)
    np.testing.assert_array_equal(second_derivatives(J, axes, 9)[1, 2], second_derivatives(J[1, 2], axes[1, 2], 9))
    np.testing.assert_allclose(rest_acceleration(J, axes, qd, a, 9)[1, 2], rest_acceleration(J[1, 2], axes[1, 2], qd[1, 2], a[1, 2], 9))

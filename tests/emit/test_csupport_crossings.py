"""Roots on two sides along a drive: where a circle meets a parabola, in C and by the reference, beside the roots of a quartic."""

import numpy as np
import pytest
from general_library import build, call, source

from walkgen.runtime.solves.crossings import JOINTS, ROOTS, crossings

OK, UNREACHABLE, BAD_INPUT = 0, 1, 2
TURN = np.array([0.1 - np.pi, 0.1 + np.pi])
HARNESS = """
/* x - p0 = (y - p1)^2 on the unit circle, from p1 on and up to p1; the joint values are the drive in a turn, side and p0 */
static void parabola@(const REAL point[5], REAL profile[9], const void *data) {
    const REAL t = point[0], side = point[1], x = COS(t), y = SIN(t), margin = x - point[2], root = SQRT(margin);
    (void)data;
    profile[0] = side * root - (y - point[3]); profile[1] = margin;
    profile[2] = -side * y / (2 * root) - x; profile[3] = -y;
    profile[4] = 1; profile[5] = 0;
    profile[6] = ATAN2(y, x); profile[7] = side; profile[8] = point[2];
}
void parabola_rows@(int rows, const REAL *bounds, const REAL *p, REAL *q, int32_t *status);
void parabola_rows@(int rows, const REAL *bounds, const REAL *p, REAL *q, int32_t *status) {
    for (int i = 0; i < rows; ++i) {
        REAL best[3];
        int32_t found;
        wg_crossings@(bounds, p + 3 * i, parabola@, NULL, 2, 1, q + 48 * i, status + 16 * i, best, &found);
    }
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    text = source(HARNESS, "walkgen_crossings.h")
    for function in ("ATAN2", "COS", "SIN", "SQRT"):
        text = text.replace(f"{function}(", f"{function.lower()}(")
    return build(tmp_path_factory.mktemp("crossings"), text, "-Wno-float-conversion", "-Wno-double-promotion", "-Wno-conversion")


def parabola(point):
    """The same in NumPy."""
    t, side, *p = np.moveaxis(point, -1, 0)
    x, y = np.cos(t), np.sin(t)
    root = np.sqrt(x - p[0])
    rest = (np.ones_like(t), np.zeros_like(t), np.arctan2(y, x), side, p[0])
    return np.stack([side * root - (y - p[1]), x - p[0], -side * y / (2 * root) - x, -y, *rest], -1)


def targets(count, seed=0):
    return np.c_[np.random.default_rng(seed).uniform([-1.2, -1.2], [1.0, 1.2], (count, 2)), np.zeros(count)]


def in_c(library, p, dtype=np.float64):
    p = np.ascontiguousarray(p, dtype)
    q, status = np.zeros((len(p), ROOTS, JOINTS), dtype), np.zeros((len(p), ROOTS), np.int32)
    call(library, "parabola_rows", dtype, len(p), TURN.astype(dtype), p, q, status)
    return q, status


def meeting(p):
    """Angles at which circle and parabola meet, in order, and how far apart or from the real line the roots are at least."""
    square = np.polynomial.Polynomial([p[1] ** 2 + p[0], -2 * p[1], 1])
    roots = (square**2 + np.polynomial.Polynomial([-1, 0, 1])).roots()
    y = roots[np.abs(roots.imag) < 1e-9].real
    pairs = np.abs(roots[:, None] - roots)[~np.eye(len(roots), dtype=bool)]
    return np.sort(np.arctan2(y, square(y))), pairs.min()


def test_all_roots(library):
    p = targets(6000)
    q, status = in_c(library, p)
    counts = np.zeros(5, int)
    for own, rows, states in zip(p, q, status, strict=True):
        wanted, apart = meeting(own)
        if apart < 1e-6:
            continue
        assert rows[states == OK, 0] == pytest.approx(wanted, abs=1e-14 / apart + 1e-12)
        counts[len(wanted)] += 1
    assert (counts[[0, 2, 4]] > 40).all()
    assert np.array_equal(np.where((status == OK)[..., None], 0, q - q[:, :1]), np.zeros_like(q))


def test_two_roots_become_one(library):
    """The circle touches the parabola from inside; a little beyond they do not meet."""
    p = np.array([[-1 + away, 0.0, 0.0] for away in (0.0, 1e-14, -1e-14)] + [[-1 - 1e-9, 0.0, 0.0]])
    assert (in_c(library, p)[1][:3] != BAD_INPUT).all()
    for aim in (1e-4, 1e-5, 1e-6, 1e-7):
        line = np.array([[1 - aim**2, 0.0, 0.0]])
        wanted, _ = meeting(line[0])
        q, status = in_c(library, line)
        assert q[status == OK][:, 0] == pytest.approx(wanted, rel=1e-3)
        assert len(wanted) == 2


def test_the_reference_agrees(library):
    p = targets(20, 1)
    (q, status), (own, states, best, found) = in_c(library, p), crossings(TURN, p, (parabola,), 2, 1)
    assert np.array_equal(states, status)
    assert own == pytest.approx(q, abs=1e-9)
    assert np.array_equal(best, own[:, 0])
    assert np.array_equal(found, states[:, 0])


def test_what_is_no_number(library):
    nowhere = np.array([[np.nan, 0, 0], [0, np.inf, 0]])
    for q, status in (in_c(library, nowhere), crossings(TURN, nowhere, (parabola,), 2, 1)[:2]):
        assert (status == BAD_INPUT).all()
        assert np.isnan(q).all()
    q, status, _, found = crossings(TURN, [0, 0, 0], (lambda point: np.full((len(point), 9), np.nan),), 2, 1)
    assert (q == 0).all()
    assert (status == UNREACHABLE).all()
    assert found == UNREACHABLE


def test_single_precision(library):
    p = targets(300, 2)
    q, status = in_c(library, p, np.float32)
    seen = 0
    for own, rows, states in zip(p.astype(np.float32).astype(float), q, status, strict=True):
        wanted, apart = meeting(own)
        if apart > 0.05:
            assert rows[states == OK, 0] == pytest.approx(wanted, abs=1e-4)
            seen += len(wanted)
    assert seen > 200

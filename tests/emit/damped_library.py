"""The damped inverse of any number of joints, compiled in double and float, called on NumPy arrays of rows."""

import ctypes

import numpy as np
from general_library import build, call, source

LOOPS = """
void rates_rows@(int rows, int n, const REAL *J, const REAL *v, const REAL *bounds, REAL *qd, int32_t *status);
void rates_rows@(int rows, int n, const REAL *J, const REAL *v, const REAL *bounds, REAL *qd, int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_damped_inverse@(J + 3 * n * i, v + 3 * i, n, bounds[2 * i], bounds[2 * i + 1], qd + n * i, status + i);
}
"""
SOURCE = source(LOOPS, "walkgen_damped_general.h")


class Damped:
    """`wg_damped_inverse` on rows; bounds are (epsilon, lambda_max), one pair or one a row."""

    def __init__(self, folder) -> None:
        self._library: ctypes.CDLL = build(folder, SOURCE)

    def __call__(self, J, v, bounds, dtype=np.float64):
        rows, n = len(J), J.shape[-1]
        qd, status = np.full((rows, n), 7.0, dtype), np.full(rows, -1, np.int32)
        arrays = [np.array(item, dtype, order="C") for item in (J, v, np.broadcast_to(bounds, (rows, 2)))]
        call(self._library, "rates_rows", dtype, rows, n, *arrays, qd, status)
        return qd, status

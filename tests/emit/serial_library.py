"""The routines of serial chains and rows, compiled in double and float, called on NumPy arrays of rows."""

import numpy as np
from general_library import build, call, source

ROWS = """
void nearest_rows@(int rows, int sequence, int slots, int n, const REAL *q, const int32_t *states, const REAL *seed, REAL *out,
                   int32_t *status);
void nearest_rows@(int rows, int sequence, int slots, int n, const REAL *q, const int32_t *states, const REAL *seed, REAL *out,
                   int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_nearest_row@(q + slots * n * i, states + slots * i, seed + n * i, sequence, slots, out + n * i, status + i);
}
void admissible_rows@(int rows, int sequence, int slots, int n, const REAL *q, const int32_t *states, const REAL *limits, REAL *out,
                      int32_t *status);
void admissible_rows@(int rows, int sequence, int slots, int n, const REAL *q, const int32_t *states, const REAL *limits, REAL *out,
                      int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_admissible_row@(q + slots * n * i, states + slots * i, limits + 2 * n * i, sequence, slots, out + n * i, status + i);
}
"""


class Serial:
    """The compiled routines; arguments with and without a leading axis of rows."""

    def __init__(self, folder) -> None:
        self._library = build(folder, source(ROWS, "walkgen_rows.h"))

    def nearest_row(self, rows, states, seed, sequence, slots, dtype=np.float64):
        return self._choose("nearest_rows", rows, states, seed, (), sequence, slots, dtype)

    def admissible_row(self, rows, states, limits, sequence, slots, dtype=np.float64):
        return self._choose("admissible_rows", rows, states, limits, (2,), sequence, slots, dtype)

    def _choose(self, name, rows, states, other, tail, sequence, slots, dtype):
        count, _, n = np.shape(rows)
        q, status = np.full((count, n), 7.0, dtype), np.full(count, -1, np.int32)
        more = own(np.broadcast_to(other, (count, n, *tail)), dtype)
        call(self._library, name, dtype, count, sequence, slots, n, own(rows, dtype), own(states, np.int32), more, q, status)
        return q, status


def own(values, dtype):
    return np.array(values, dtype=dtype, order="C")

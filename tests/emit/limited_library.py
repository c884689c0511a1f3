"""The contact forces with limits in C, called on NumPy arrays of stances."""

import numpy as np
from contact_library import Stances
from general_library import build, call, source

from walkgen.runtime.solves.contact import Contact

LOOPS = """
void limited_rows@(int rows, int k, int facets, int limits, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench,
                   const REAL *weight, const REAL *n_max, const REAL *torque_rows, const REAL *torque_limits, REAL *f, int32_t *status,
                   int32_t *state, REAL *certificate, REAL *violation, REAL *multipliers);
void limited_rows@(int rows, int k, int facets, int limits, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench,
                   const REAL *weight, const REAL *n_max, const REAL *torque_rows, const REAL *torque_limits, REAL *f, int32_t *status,
                   int32_t *state, REAL *certificate, REAL *violation, REAL *multipliers) {
    const walkgen_contact_work@ cold = {0, {0}};
    for (int i = 0; i < rows; ++i) {
        walkgen_contact_work@ work = cold;
        wg_contact_limited@(k, points + 3 * k * i, normals + 3 * k * i, mu + k * i, wrench + 6 * i, weight + k * i,
                            n_max + k * i, facets, limits, torque_rows + 3 * k * limits * i, torque_limits + limits * i, &work,
                            f + 3 * k * i, status + i, state + k * i, certificate + 6 * i, violation + i, multipliers + limits * i);
    }
}
"""
SOURCE = source(LOOPS, "walkgen_contact_limited.h")


class Limited:
    """The routine in C; torque_rows [rows,t,k,3], torque_limits [rows,t]."""

    def __init__(self, folder, *flags) -> None:
        self._library = build(folder, SOURCE, *flags)

    def __call__(self, stances: Stances, torque_rows, torque_limits, facets=0, dtype=np.float64) -> Contact:
        (rows, k), limits = stances.mu.shape, torque_limits.shape[-1]
        f, state = np.full((rows, k, 3), 7.0, dtype), np.full((rows, k), -1, np.int32)
        status, certificate = np.full(rows, -1, np.int32), np.full((rows, 6), 7.0, dtype)
        violation, multipliers = np.full(rows, 7.0, dtype), np.full((rows, limits), 7.0, dtype)
        with np.errstate(over="ignore"):
            inputs = [np.array(value, dtype, order="C") for value in (*vars(stances).values(), torque_rows, torque_limits)]
        outputs = (f, status, state, certificate, violation, multipliers)
        call(self._library, "limited_rows", dtype, rows, k, facets, limits, *inputs, *outputs)
        return Contact(*outputs)

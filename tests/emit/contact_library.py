"""The contact forces in C, compiled in double and float, called on NumPy arrays of stances."""

from dataclasses import dataclass

import numpy as np
from general_library import build, call, source

from walkgen.runtime.solves.contact import Contact

LOOPS = """
void least_squares_rows@(int rows, int k, int facets, int warm, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench,
                         const REAL *weight, const REAL *n_max, REAL *f, int32_t *status, int32_t *state, REAL *certificate,
                         REAL *violation);
void least_squares_rows@(int rows, int k, int facets, int warm, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench,
                         const REAL *weight, const REAL *n_max, REAL *f, int32_t *status, int32_t *state, REAL *certificate,
                         REAL *violation) {
    const walkgen_contact_work@ cold = {0, {0}};
    walkgen_contact_work@ work = cold;
    for (int i = 0; i < rows; ++i) {
        if (!warm) work = cold;
        wg_contact_least_squares@(k, points + 3 * k * i, normals + 3 * k * i, mu + k * i, wrench + 6 * i, weight + k * i, n_max + k * i,
                                  facets, &work, f + 3 * k * i, status + i, state + k * i, certificate + 6 * i, violation + i);
    }
}
"""
HEADERS = ("walkgen_contact.h",)
SOURCE = source(LOOPS, *HEADERS)


@dataclass(frozen=True)
class Stances:
    """Rows of stances of k feet: points, normals [rows,k,3], mu, weight, n_max [rows,k], wrench [rows,6]."""

    points: np.ndarray
    normals: np.ndarray
    mu: np.ndarray
    wrench: np.ndarray
    weight: np.ndarray
    n_max: np.ndarray

    @classmethod
    def of(cls, points, normals, mu, wrench, weight=1.0, n_max=np.inf):
        points, wrench = np.asarray(points, float), np.asarray(wrench, float)
        rows, k = np.broadcast_shapes(points.shape[:-2], wrench.shape[:-1]) or (1,), points.shape[-2]
        each = [np.broadcast_to(np.asarray(value, float), (*rows, k)) for value in (mu, weight, n_max)]
        vectors = [np.broadcast_to(np.asarray(value, float), (*rows, k, 3)) for value in (points, normals)]
        return cls(*vectors, each[0], np.broadcast_to(wrench, (*rows, 6)), *each[1:])

    def __getitem__(self, rows):
        return Stances(*(value[rows] for value in vars(self).values()))

    def changed(self, **values):
        return Stances(**(vars(self) | values))


class Forces:
    """The routine in C."""

    def __init__(self, folder) -> None:
        self._library = build(folder, SOURCE)

    def __call__(self, stances: Stances, facets=0, dtype=np.float64, warm=False) -> Contact:
        rows, k = stances.mu.shape
        f, state = np.full((rows, k, 3), 7.0, dtype), np.full((rows, k), -1, np.int32)
        status, certificate, violation = np.full(rows, -1, np.int32), np.full((rows, 6), 7.0, dtype), np.full(rows, 7.0, dtype)
        with np.errstate(over="ignore"):
            inputs = [np.array(value, dtype, order="C") for value in vars(stances).values()]
        call(self._library, "least_squares_rows", dtype, rows, k, facets, int(warm), *inputs, f, status, state, certificate, violation)
        return Contact(f, status, state, certificate, violation, np.zeros((rows, 0)))

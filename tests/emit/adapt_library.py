"""The routines that adapt a modular robot, compiled in double and float, called on the tree data of one robot and rows of inputs."""

import numpy as np
from general_library import build, call, source

LOOPS = """
void adapt_rows@(int rows, int nq, int feet, int platforms, const REAL *geometry, const int32_t *topology, const REAL *limits,
                 const REAL *targets, const REAL *normal, const REAL *start, const REAL *weights, REAL *q, int32_t *status, REAL *cost);
void adapt_rows@(int rows, int nq, int feet, int platforms, const REAL *geometry, const int32_t *topology, const REAL *limits,
                 const REAL *targets, const REAL *normal, const REAL *start, const REAL *weights, REAL *q, int32_t *status, REAL *cost) {
    for (int i = 0; i < rows; ++i)
        wg_adapt@(geometry, topology, limits, targets + 3 * feet * i, normal + 3 * platforms * i, start + nq * i, weights + 4 * i, nq, feet,
                  platforms, NULL, NULL, q + nq * i, status + i, cost + i);
}
void velocity_rows@(int rows, int nq, int feet, int platforms, const REAL *geometry, const int32_t *topology, const REAL *limits,
                    const REAL *q, const REAL *xd, const REAL *qd0, const REAL *bounds, REAL *qd, int32_t *status);
void velocity_rows@(int rows, int nq, int feet, int platforms, const REAL *geometry, const int32_t *topology, const REAL *limits,
                    const REAL *q, const REAL *xd, const REAL *qd0, const REAL *bounds, REAL *qd, int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_adapt_velocity@(geometry, topology, limits, q + nq * i, xd + 3 * feet * i, qd0 + nq * i, bounds[2 * i], bounds[2 * i + 1], nq,
                           feet, platforms, qd + nq * i, status + i);
}
"""
HEADERS = ("walkgen_adapt.h", "walkgen_adapt_velocity.h")
SOURCE = source(LOOPS, *HEADERS)


class Adapting:
    """wg_adapt and wg_adapt_velocity with the arguments of their NumPy references; a robot's numbers are those of every row."""

    def __init__(self, folder) -> None:
        self._library = build(folder, SOURCE)

    def adapt(self, geometry, topology, limits, targets, normal, start, weights, nq, feet, platforms, dtype=np.float64):
        shape, rows = _rows((targets, normal, start, weights), (2, 2, 1, 1), dtype)
        count = int(np.prod(shape))
        q, status, cost = np.full((count, nq), 7.0, dtype), np.full(count, -1, np.int32), np.full(count, 7.0, dtype)
        fixed = _own(geometry, dtype), _own(topology, np.int32), _own(limits, dtype)
        call(self._library, "adapt_rows", dtype, count, nq, feet, platforms, *fixed, *rows, q, status, cost)
        return q.reshape(*shape, nq), status.reshape(shape), cost.reshape(shape)

    def adapt_velocity(self, geometry, topology, limits, q, xd, qd0, epsilon, lambda_max, nq, feet, platforms, dtype=np.float64):
        bounds = np.stack(np.broadcast_arrays(epsilon, lambda_max), axis=-1)
        shape, rows = _rows((q, xd, qd0, bounds), (1, 2, 1, 1), dtype)
        count = int(np.prod(shape))
        qd, status = np.full((count, nq), 7.0, dtype), np.full(count, -1, np.int32)
        fixed = _own(geometry, dtype), _own(topology, np.int32), _own(limits, dtype)
        call(self._library, "velocity_rows", dtype, count, nq, feet, platforms, *fixed, *rows, qd, status)
        return qd.reshape(*shape, nq), status.reshape(shape)


def _rows(arrays, ranks, dtype):
    arrays = [np.asarray(array, dtype) for array in arrays]
    shape = np.broadcast_shapes(*(array.shape[: array.ndim - rank] for array, rank in zip(arrays, ranks, strict=True)))
    wide = [np.broadcast_to(array, (*shape, *array.shape[array.ndim - rank :])) for array, rank in zip(arrays, ranks, strict=True)]
    return shape, [_own(array, dtype) for array in wide]


def _own(values, dtype):
    return np.array(values, dtype=dtype, order="C")

"""The routines of serial chains and rows, compiled in double and float, called on NumPy arrays of rows."""

import itertools

import numpy as np
from general_library import build, call, source

FREE = np.array([-np.inf, np.inf])

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

REACH = """
void reach_rows@(int rows, int n, int sequence, const REAL *geometry, const REAL *p, const REAL *seed, const REAL *limits, REAL *q,
                 int32_t *status);
void reach_rows@(int rows, int n, int sequence, const REAL *geometry, const REAL *p, const REAL *seed, const REAL *limits, REAL *q,
                 int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_inverse_reach@(geometry + (6 * n + 3) * i, p + 3 * i, seed + n * i, limits + 2 * n * i, sequence, q + n * i, status + i);
}
void pose_rows@(int rows, int n, int sequence, const REAL *geometry, const REAL *T, const REAL *seed, const REAL *limits, REAL *q,
                int32_t *status);
void pose_rows@(int rows, int n, int sequence, const REAL *geometry, const REAL *T, const REAL *seed, const REAL *limits, REAL *q,
                int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_inverse_pose@(geometry + (6 * n + 12) * i, T + 16 * i, seed + n * i, limits + 2 * n * i, sequence, q + n * i, status + i);
}
void within_rows@(int rows, int n, int sequence, const REAL *geometry, const REAL *p, const REAL *limits, REAL *q, int32_t *status);
void within_rows@(int rows, int n, int sequence, const REAL *geometry, const REAL *p, const REAL *limits, REAL *q, int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_closest_within@(geometry + (6 * n + 3) * i, p + 3 * i, limits + 2 * n * i, sequence, q + n * i, status + i);
}
"""
REACH_SOURCE = source(REACH, "walkgen_reach.h", "walkgen_within.h")


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


class Reaching:
    """The inverse of chains in C; arguments as of `walkgen.runtime.solves.reach` and `within`, with one leading axis of rows or none."""

    def __init__(self, folder) -> None:
        self._library = build(folder, REACH_SOURCE, "-O1")

    def inverse_reach(self, geometry, p, seed, limits, sequence, dtype=np.float64):
        return self._near("reach_rows", (geometry, p, seed, limits), (1, 1, 1, 2), sequence, dtype)

    def inverse_pose(self, geometry, T, seed, limits, sequence, dtype=np.float64):
        return self._near("pose_rows", (geometry, T, seed, limits), (1, 2, 1, 2), sequence, dtype)

    def closest_within(self, geometry, p, limits, sequence, q, status, dtype=np.float64):
        shape, (numbers, targets, bounds, values) = rows_of((geometry, p, limits, q), (1, 1, 2, 1), dtype)
        states = own(np.broadcast_to(status, len(values)), np.int32)
        call(self._library, "within_rows", dtype, len(values), values.shape[1], sequence, numbers, targets, bounds, values, states)
        return values.reshape(*shape, -1), states.reshape(shape)

    def _near(self, name, inputs, ranks, sequence, dtype):
        shape, rows = rows_of(inputs, ranks, dtype)
        count, n = rows[2].shape
        q, status = np.full((count, n), 7.0, dtype), np.full(count, -1, np.int32)
        call(self._library, name, dtype, count, n, sequence, *rows, q, status)
        return q.reshape(*shape, n), status.reshape(shape)


def rows_of(inputs, ranks, dtype):
    """The common leading shape, () or (rows,), and the inputs with one leading axis."""
    arrays = [np.asarray(item) for item in inputs]
    tails = [item.shape[item.ndim - rank :] for item, rank in zip(arrays, ranks, strict=True)]
    shape = np.broadcast_shapes(*(item.shape[: item.ndim - rank] for item, rank in zip(arrays, ranks, strict=True)))
    return shape, [own(np.broadcast_to(item, (*shape, *tail)).reshape(-1, *tail), dtype) for item, tail in zip(arrays, tails, strict=True)]


def sequence_of(kinds):
    return int("1" + "".join("01"[kind == "P"] for kind in kinds), 2)


def poses(geometry, kinds, q):
    """[..., 4, 4]: a product of 4x4 screws, whose rotations come from the matrix exponential's closed form, then the foot at q = 0."""
    n, q = len(kinds), np.asarray(q)
    T = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
    for joint, kind in enumerate(kinds):
        axis, point = geometry[6 * joint : 6 * joint + 3], geometry[6 * joint + 3 : 6 * joint + 6]
        screw = np.zeros((4, 4))
        if kind == "P":
            screw[:3, 3] = axis
            T = T @ (np.eye(4) + q[..., joint, None, None] * screw)
        else:
            screw[:3, :3] = -np.cross(np.eye(3), axis).T
            screw[:3, 3] = -screw[:3, :3] @ point
            c, s = np.cos(q[..., joint, None, None]), np.sin(q[..., joint, None, None])
            T = T @ (np.eye(4) + s * screw + (1 - c) * (screw @ screw))
    home = np.eye(4)
    home[:3, 3] = geometry[6 * n : 6 * n + 3]
    if len(geometry) > 6 * n + 3:
        home[:3, :3] = geometry[6 * n + 3 :].reshape(3, 3)
    return T @ home


def denavit_hartenberg(rows, base=None):
    """Geometry [6 n + 12] of joints a, alpha, d, theta at q = 0, all but the kind of the joint."""
    T, numbers = np.eye(4) if base is None else base, []
    for a, alpha, d, theta in rows:
        numbers += [*T[:3, 2], *T[:3, 3]]
        c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
        T = T @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0.0, sa, ca, d], [0.0, 0.0, 0.0, 1.0]])
    return np.array([*numbers, *T[:3, 3], *T[:3, :3].ravel()])


def random_arm(rng, n, slides=0.25, special=False):
    """Kinds and geometry: offsets and twists anywhere, or as builders choose them: right angles and no offsets among them."""
    kinds = "".join("P" if rng.random() < slides else "R" for _ in range(n))
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    base = np.eye(4)
    base[:3, :3], base[:3, 3] = rotation * np.linalg.det(rotation), rng.normal(size=3)
    rows = [
        (rng.choice([0.0, 0.3, 0.5]), rng.choice([0.0, np.pi / 2, -np.pi / 2, np.pi / 2]), rng.choice([0.0, 0.2, -0.1]), rng.uniform(-3, 3))
        if special
        else (rng.uniform(0.0, 0.5), rng.uniform(-np.pi, np.pi), rng.uniform(-0.3, 0.3), rng.uniform(-3, 3))
        for _ in kinds
    ]
    return kinds, denavit_hartenberg(rows, base)


def random_values(rng, kinds, count):
    """Joint values [count, n]: angles anywhere, lengths within half a metre."""
    turning = np.array([kind == "R" for kind in kinds])
    return np.where(turning, rng.uniform(-np.pi, np.pi, (count, len(kinds))), rng.uniform(-0.5, 0.5, (count, len(kinds))))


def random_limits(rng, kinds, count):
    """Boxes [count, n, 2] 0.3 to 3 wide about angles, 0.1 to 0.6 about lengths."""
    turning, shape = np.array([kind == "R" for kind in kinds]), (count, len(kinds))
    low = np.where(turning, rng.uniform(-3.0, 1.0, shape), rng.uniform(-0.4, 0.0, shape))
    return np.stack([low, low + np.where(turning, rng.uniform(0.3, 3.0, shape), rng.uniform(0.1, 0.6, shape))], axis=-1)


def short_way(kinds, gap):
    """Differences of joint values, those of angles modulo full turns."""
    return np.where([kind == "P" for kind in kinds], gap, gap - 2 * np.pi * np.round(gap / (2 * np.pi)))


def grid(limits, along):
    """Points [along^n, n] over a box [n, 2]."""
    return np.array(list(itertools.product(*(np.linspace(low, high, along) for low, high in limits))))


def own(values, dtype):
    return np.array(values, dtype=dtype, order="C")

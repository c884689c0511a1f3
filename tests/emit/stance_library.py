"""The routines of stances, compiled in double and float, called on one stance of NumPy arrays."""

import ctypes

import numpy as np
from general_library import build

HEADERS = (
    "walkgen_stance.h",
    "walkgen_contact_vertical.h",
    "walkgen_friction_needed.h",
    "walkgen_friction_margins.h",
    "walkgen_slip.h",
    "walkgen_settle.h",
)
_CALLS = """
void grasp@(int k, const REAL *points, REAL *G, REAL *singular_values, REAL *lost, REAL *condition, int32_t *rank, int32_t *status);
void grasp@(int k, const REAL *points, REAL *G, REAL *singular_values, REAL *lost, REAL *condition, int32_t *rank, int32_t *status) {
    wg_grasp@(k, points, G, singular_values, lost, condition, rank, status);
}
void vertical@(int k, const REAL *points, const REAL *normals, const REAL *wrench, REAL *f, int32_t *status, int32_t *state,
               REAL *violation);
void vertical@(int k, const REAL *points, const REAL *normals, const REAL *wrench, REAL *f, int32_t *status, int32_t *state,
               REAL *violation) {
    wg_contact_vertical@(k, points, normals, wrench, f, status, state, violation);
}
void needed@(int k, const REAL *points, const REAL *normals, const REAL *wrench, REAL *mu, REAL *f, REAL *twist, int32_t *status);
void needed@(int k, const REAL *points, const REAL *normals, const REAL *wrench, REAL *mu, REAL *f, REAL *twist, int32_t *status) {
    wg_friction_needed@(k, points, normals, wrench, mu, f, twist, status);
}
void margin@(int k, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench, const REAL *direction, REAL *reach,
             REAL *lift, int32_t *status);
void margin@(int k, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench, const REAL *direction, REAL *reach,
             REAL *lift, int32_t *status) {
    wg_load_margin@(k, points, normals, mu, wrench, direction, reach, lift, status);
}
void slip@(int k, const REAL *points, const REAL *normals, const REAL *wrench, REAL *N, REAL *f, REAL *twist, REAL *mu, REAL *axis,
           REAL *pitch, int32_t *status);
void slip@(int k, const REAL *points, const REAL *normals, const REAL *wrench, REAL *N, REAL *f, REAL *twist, REAL *mu, REAL *axis,
           REAL *pitch, int32_t *status) {
    wg_slip@(k, points, normals, wrench, N, f, twist, mu, axis, pitch, status);
}
void settle@(int most_steps, const REAL *feet, const REAL *com, const REAL *weight, const REAL *wrench, const REAL *start,
             void (*ground)(const REAL *, REAL *, const void *), const REAL *step, REAL *pose, REAL *N, REAL *path, int32_t *steps,
             int32_t *status);
void settle@(int most_steps, const REAL *feet, const REAL *com, const REAL *weight, const REAL *wrench, const REAL *start,
             void (*ground)(const REAL *, REAL *, const void *), const REAL *step, REAL *pose, REAL *N, REAL *path, int32_t *steps,
             int32_t *status) {
    const int32_t all[3] = {0, 1, 2};
    wg_settle@(3, feet, all, com, weight, wrench, start, ground, NULL, *step, most_steps, most_steps + 1, pose, N, path, steps, status);
}
void admissible@(int k, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench, int foot, int count,
                 const REAL *candidates, const REAL *candidate_normals, REAL *share, int32_t *status);
void admissible@(int k, const REAL *points, const REAL *normals, const REAL *mu, const REAL *wrench, int foot, int count,
                 const REAL *candidates, const REAL *candidate_normals, REAL *share, int32_t *status) {
    for (int i = 0; i < count; ++i)
        wg_foot_admissible@(k, points, normals, mu, wrench, foot, candidates + 3 * i, candidate_normals + 3 * i, share + i, status + i);
}
"""


def stance_source() -> str:
    """The calls in both precisions, every header twice, as a robot with two routines includes it."""
    includes = "".join(f'#include "{header}"\n' for header in (*HEADERS, *HEADERS))
    headers = "".join(f'#include "walkgen_real_{tag}.h"\n{includes}' for tag in ("f64", "f32"))
    return headers + _CALLS.replace("@", "").replace("REAL", "double") + _CALLS.replace("@", "_f32").replace("REAL", "float")


class Stances:
    """The routines with the arguments of their NumPy references, one stance a call; outputs begin as 7 and -1."""

    def __init__(self, folder) -> None:
        self._library = build(folder, stance_source(), "-O1")

    def grasp(self, points, dtype=np.float64):
        k = len(points)
        G, singular, lost, condition = reals(dtype, (6, 3 * k), (6,), (3, 6), (1,))
        rank, status = integers((1,), (1,))
        self._call("grasp", dtype, k, own(points, dtype), G, singular, lost, condition, rank, status)
        return G, singular, lost, condition[0], rank[0], status[0]

    def vertical(self, points, normals, wrench, dtype=np.float64):
        k = len(points)
        f, violation = reals(dtype, (k, 3), (1,))
        status, state = integers((1,), (k,))
        self._call("vertical", dtype, k, *(own(item, dtype) for item in (points, normals, wrench)), f, status, state, violation)
        return f, status[0], state, violation[0]

    def needed(self, points, normals, wrench, dtype=np.float64):
        k = len(points)
        mu, f, twist = reals(dtype, (1,), (k, 3), (6,))
        (status,) = integers((1,))
        self._call("needed", dtype, k, *(own(item, dtype) for item in (points, normals, wrench)), mu, f, twist, status)
        return mu[0], f, twist, status[0]

    def margin(self, points, normals, mu, wrench, direction, dtype=np.float64):
        reach, lift = reals(dtype, (1,), (1,))
        (status,) = integers((1,))
        given = (own(item, dtype) for item in (points, normals, mu, wrench, direction))
        self._call("margin", dtype, len(points), *given, reach, lift, status)
        return reach[0], lift[0], status[0]

    def admissible(self, points, normals, mu, wrench, foot, candidates, candidate_normals, dtype=np.float64):
        count = len(candidates)
        (share,) = reals(dtype, (count,))
        (status,) = integers((count,))
        given = (own(item, dtype) for item in (points, normals, mu, wrench))
        aims = (own(item, dtype) for item in (candidates, candidate_normals))
        self._call("admissible", dtype, len(points), *given, foot, count, *aims, share, status)
        return share, status

    def slip(self, points, normals, wrench, dtype=np.float64):
        """mu, N, f, twist as the reference has them, axis, pitch, status."""
        N, f, twist, mu, axis, pitch = reals(dtype, (3,), (3, 3), (6,), (1,), (6,), (1,))
        (status,) = integers((1,))
        given = (own(item, dtype) for item in (points, normals, wrench))
        self._call("slip", dtype, len(points), *given, N, f, twist, mu, axis, pitch, status)
        return mu[0], N, f, twist, axis, pitch[0], status[0]

    def settle(self, robot, start, step, most_steps, dtype=np.float64):
        """path, normal forces and status as the reference has them, and the pose."""
        pose, N, path = reals(dtype, (4, 4), (3,), (most_steps + 1, 4, 4))
        steps, status = integers((1,), (1,))
        real = ctypes.c_float if dtype == np.float32 else ctypes.c_double
        pointer = ctypes.POINTER(real)

        def ground(point, surface, _data):
            for i, value in enumerate(robot.ground(np.array(point[:3], float))):
                surface[i] = value

        callback = ctypes.CFUNCTYPE(None, pointer, pointer, ctypes.c_void_p)(ground)
        given = [own(item, dtype) for item in (robot.feet, robot.centre_of_mass, robot.weight, robot.wrench, start)]
        function = getattr(self._library, "settle" + ("_f32" if dtype == np.float32 else ""))
        function.restype = None
        pointers = [item.ctypes.data_as(ctypes.c_void_p) for item in (*given, own([step], dtype), pose, N, path, steps, status)]
        function(ctypes.c_int(most_steps), *pointers[:5], callback, *pointers[5:])
        return path[: steps[0] + 1], N, status[0], pose

    def _call(self, name, dtype, *arguments) -> None:
        function = getattr(self._library, name + ("_f32" if dtype == np.float32 else ""))
        function.restype = None
        function(*(ctypes.c_int(item) if isinstance(item, int) else item.ctypes.data_as(ctypes.c_void_p) for item in arguments))


def reals(dtype, *shapes):
    return [np.full(shape, 7.0, dtype) for shape in shapes]


def integers(*shapes):
    return [np.full(shape, -1, np.int32) for shape in shapes]


def own(values, dtype):
    with np.errstate(over="ignore"):
        return np.array(values, dtype=dtype, order="C")

"""The routines of static stability, compiled in double and float, with the arguments of their NumPy references, one stance a call."""

import numpy as np
from general_library import build, call, source
from stance_library import integers, own, reals

from walkgen.runtime.solves.stability import Gradients, Margins

HEADERS = ("walkgen_support.h", "walkgen_shadow.h", "walkgen_shadow_margin.h", "walkgen_feasible.h", "walkgen_stability.h")
_CALLS = """
void margins@(int k, const REAL *points, const REAL *com, const REAL *direction, const REAL *mu, const REAL *normals, const REAL *gravity,
              const REAL *mass, const REAL *own, REAL *stable, REAL *longitudinal, REAL *energy, REAL *height, REAL *friction,
              int32_t *polygon, int32_t *vertices, int32_t *edge, REAL *heights, int32_t *status);
void margins@(int k, const REAL *points, const REAL *com, const REAL *direction, const REAL *mu, const REAL *normals, const REAL *gravity,
              const REAL *mass, const REAL *own, REAL *stable, REAL *longitudinal, REAL *energy, REAL *height, REAL *friction,
              int32_t *polygon, int32_t *vertices, int32_t *edge, REAL *heights, int32_t *status) {
    wg_stability_margins@(k, points, com, direction, mu, normals, gravity, *mass, own, stable, longitudinal, energy, height, friction,
                          polygon, vertices, edge, heights, status);
}
void gradients@(int k, const REAL *points, const REAL *com, const REAL *direction, const REAL *mu, const REAL *normals,
                const REAL *gravity, const REAL *mass, const REAL *own, REAL *stable, REAL *longitudinal, REAL *energy, REAL *height,
                REAL *friction, int32_t *status);
void gradients@(int k, const REAL *points, const REAL *com, const REAL *direction, const REAL *mu, const REAL *normals,
                const REAL *gravity, const REAL *mass, const REAL *own, REAL *stable, REAL *longitudinal, REAL *energy, REAL *height,
                REAL *friction, int32_t *status) {
    wg_stability_margins_d_com@(k, points, com, direction, mu, normals, gravity, *mass, own, stable, longitudinal, energy, height,
                                friction, status);
}
void region@(int k, const REAL *points, const REAL *mu, const REAL *normals, const REAL *gravity, const REAL *tolerance, REAL *polygon,
             int32_t *vertices, REAL *error, int32_t *status);
void region@(int k, const REAL *points, const REAL *mu, const REAL *normals, const REAL *gravity, const REAL *tolerance, REAL *polygon,
             int32_t *vertices, REAL *error, int32_t *status) {
    const REAL own[4] = {0, 0, 0, 0};
    wg_feasible_region@(k, points, mu, normals, gravity, own, *tolerance, polygon, vertices, error, status);
}
void disturbance@(int k, const REAL *points, const REAL *com, const REAL *mu, const REAL *point, const REAL *normals, const REAL *gravity,
                  const REAL *mass, REAL *force, REAL *direction, int32_t *status);
void disturbance@(int k, const REAL *points, const REAL *com, const REAL *mu, const REAL *point, const REAL *normals, const REAL *gravity,
                  const REAL *mass, REAL *force, REAL *direction, int32_t *status) {
    const REAL own[4] = {0, 0, 0, 0};
    wg_disturbance_margin@(k, points, com, mu, point, normals, gravity, *mass, own, force, direction, status);
}
"""


def stability_source() -> str:
    """The calls in both precisions."""
    return source(_CALLS, *HEADERS)


class Stability:
    """The routines; outputs begin as 7 and -1."""

    def __init__(self, folder) -> None:
        self._library = build(folder, stability_source(), "-O1")

    def margins(self, points, com, direction, mu=np.inf, normals=0.0, gravity=(0.0, 0.0, -9.81), mass=60.0, dtype=np.float64):
        k = len(points)
        static, longitudinal, energy, height, friction, heights = reals(dtype, (1,), (2,), (1,), (1,), (1,), (k,))
        polygon, vertices, edge, status = integers((k,), (1,), (2,), (1,))
        given = self._given(points, com, direction, mu, normals, gravity, mass, dtype)
        found = static, longitudinal, energy, height, friction, polygon, vertices, edge, heights, status
        call(self._library, "margins", dtype, k, *given, *found)
        return Margins(*(item[0] if item.shape == (1,) and item is not heights and item is not polygon else item for item in found))

    def gradients(self, points, com, direction, mu=np.inf, normals=0.0, gravity=(0.0, 0.0, -9.81), mass=60.0, dtype=np.float64):
        static, longitudinal, energy, height, friction = reals(dtype, (3,), (2, 3), (3,), (3,), (3,))
        (status,) = integers((1,))
        given = self._given(points, com, direction, mu, normals, gravity, mass, dtype)
        call(self._library, "gradients", dtype, len(points), *given, static, longitudinal, energy, height, friction, status)
        return Gradients(static, longitudinal, energy, height, friction, status[0])

    def region(self, points, mu, normals=0.0, gravity=(0.0, 0.0, -9.81), tolerance=1e-4, dtype=np.float64):
        """Corners [n,3], error, status."""
        polygon, error = reals(dtype, (64, 3), (1,))
        vertices, status = integers((1,), (1,))
        k = len(points)
        given = [own(points, dtype), _each(mu, (k,), dtype), _each(normals, (k, 3), dtype), own(gravity, dtype), own([tolerance], dtype)]
        call(self._library, "region", dtype, k, *given, polygon, vertices, error, status)
        return polygon[: vertices[0]], error[0], status[0]

    def disturbance(self, points, com, mu, point, normals=0.0, gravity=(0.0, 0.0, -9.81), mass=60.0, dtype=np.float64):
        force, direction = reals(dtype, (1,), (3,))
        (status,) = integers((1,))
        k = len(points)
        stance = [own(points, dtype), own(com, dtype), _each(mu, (k,), dtype), own(point, dtype), _each(normals, (k, 3), dtype)]
        call(self._library, "disturbance", dtype, k, *stance, own(gravity, dtype), own([mass], dtype), force, direction, status)
        return force[0], direction, status[0]

    def _given(self, points, com, direction, mu, normals, gravity, mass, dtype):
        k = len(points)
        stance = [own(points, dtype), own(com, dtype), own(direction, dtype), _each(mu, (k,), dtype), _each(normals, (k, 3), dtype)]
        return [*stance, own(gravity, dtype), own([mass], dtype), np.zeros(4, dtype)]


def _each(values, shape, dtype):
    return own(np.broadcast_to(np.asarray(values, float), shape), dtype)

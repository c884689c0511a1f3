"""Three feet without friction, their normal forces from balance: the reference of walkgen_contact_vertical.h."""

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.stance import BAD_INPUT, FREE, INFEASIBLE, OK, SINGULAR, STICK, Integers, Reals, are_feet, are_unit, stance_of

_ROUNDING = 64 * np.finfo(float).eps


def contact_vertical(points: ArrayLike, normals: ArrayLike, wrench: ArrayLike) -> tuple[Reals, Integers, Integers, Reals]:
    """Forces along the normals of three feet that balance the load, or leave the least of it.

    Args:
        points: the feet [..., 3, 3], m.
        normals: the ground's at the feet, unit vectors towards the robot [..., 3, 3].
        wrench: the load on the robot [..., 6]: force, N, and moment about the frame's origin, Nm.

    Returns:
        f [..., 3, 3], N; status [...]; state [..., 3], 2 for a foot without force, else 0; violation [...], the load that is not balanced,
        N, moments over the feet's root mean square distance from their centre. Status INFEASIBLE with NaN f where a foot would have to
        pull (violation: the largest pull), SINGULAR with NaN where the feet determine no forces, BAD_INPUT with NaN.
    """
    feet, directions, load = (np.asarray(item, float) for item in (points, normals, wrench))
    shape = np.broadcast_shapes(feet.shape[:-2], directions.shape[:-2], load.shape[:-1])
    k = feet.shape[-2]
    given = [np.broadcast_to(item, (*shape, *item.shape[item.ndim - rank :])) for item, rank in ((feet, 2), (directions, 2), (load, 1))]
    rows = [_row(*(item[index] for item in given)) for index in np.ndindex(shape)]
    f, violation = (np.array([row[i] for row in rows]) for i in (0, 3))
    status, state = (np.array([row[i] for row in rows], np.int32) for i in (1, 2))
    return f.reshape(*shape, k, 3), status.reshape(shape), state.reshape(*shape, k), violation.reshape(shape)


def _row(points: Reals, normals: Reals, wrench: Reals) -> tuple[Reals, int, Reals, float]:
    k = len(points)
    nothing = np.full((k, 3), np.nan), np.full(k, FREE)
    if k != 3 or not are_feet(points, normals, wrench) or not are_unit(normals):
        return nothing[0], BAD_INPUT, nothing[1], np.nan
    stance = stance_of(points, wrench)
    columns = np.stack([stance.grasp[:, 3 * i : 3 * i + 3] @ normals[i] for i in range(3)], axis=1)
    if not np.isfinite(stance.blur) or np.linalg.matrix_rank(columns, tol=stance.blur) < 3:
        return nothing[0], SINGULAR, nothing[1], np.nan
    N = np.linalg.lstsq(columns, -stance.load, rcond=None)[0]
    if N.min() < -_ROUNDING:
        return nothing[0], INFEASIBLE, nothing[1], -float(N.min()) * stance.force
    left = float(np.linalg.norm(columns @ N + stance.load)) * stance.force
    return stance.force * np.maximum(N, 0.0)[:, None] * normals, OK, np.where(N > 0.0, STICK, FREE), left

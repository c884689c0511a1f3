"""Feet on the ground and the load they carry: the reference of walkgen_stance.h, and what the other solves of stances share."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]

OK, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE = (
    STATUSES.index(name) for name in ("OK", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE", "INFEASIBLE")
)
STICK, SLIDE, FREE = range(3)
MOST_FEET = 16
_UNIT = 1e-9
_BLUR = 64 * np.finfo(float).eps


@dataclass(frozen=True)
class Stance:
    """Feet about their centre in units of their root mean square distance from it, and a load in those units.

    Attributes:
        centre: of the feet [3], m.
        length: the unit of length, m; 1 where the feet coincide.
        blur: how much of that may be rounding; infinite where the feet coincide.
        grasp: the grasp map about the centre [6, 3k].
        force: the unit of force, N: the load's length, moments over `length`.
        load: about the centre in these units [6].
    """

    centre: Reals
    length: float
    blur: float
    grasp: Reals
    force: float
    load: Reals


def cross_matrix(p: Reals) -> Reals:
    """[p]x [..., 3, 3] of vectors [..., 3]."""
    columns = [np.cross(p, axis) for axis in np.eye(3)]
    return np.stack(columns, axis=-1)


def grasp_map(points: ArrayLike) -> Reals:
    """G [..., 6, 3k] of feet [..., k, 3]: sum of (f_i, p_i x f_i) = G f."""
    feet = np.asarray(points, float)
    blocks = np.concatenate([np.broadcast_to(np.eye(3), (*feet.shape, 3)), cross_matrix(feet)], axis=-2)
    return np.swapaxes(blocks, -3, -2).reshape(*feet.shape[:-2], 6, 3 * feet.shape[-2])


def are_feet(points: Reals, *numbers: Reals) -> bool:
    """Whether there are 1 to 16 points and all numbers are finite."""
    return 1 <= len(points) <= MOST_FEET and all(bool(np.isfinite(item).all()) for item in (points, *numbers))


def are_unit(normals: Reals) -> bool:
    """Whether all are unit vectors."""
    with np.errstate(over="ignore", invalid="ignore"):
        return bool((np.abs(np.sum(normals**2, axis=-1) - 1.0) <= 2 * _UNIT).all())


def stance_of(points: Reals, wrench: Reals) -> Stance:
    """The feet [k, 3] and the load on the robot [6] (force, moment about the frame's origin) about the feet's centre."""
    centre = points.mean(axis=0)
    offsets = points - centre
    length = float(np.sqrt(np.mean(np.sum(offsets**2, axis=1))))
    share = length / max(float(np.abs(points).max()), np.finfo(float).tiny)
    apart = share > _BLUR
    length = length if apart else 1.0
    load = np.concatenate([wrench[:3], (wrench[3:] - np.cross(centre, wrench[:3])) / length])
    force = float(np.linalg.norm(load)) or 1.0
    blur = _BLUR * max(1.0, 1.0 / share) if apart else np.inf
    return Stance(centre, length, blur, grasp_map(offsets / length if apart else 0.0 * offsets), force, load / force)


def grasp(points: ArrayLike) -> tuple[Reals, Reals, Reals, Reals, Integers, Integers]:
    """The grasp map, how well it is conditioned, and what loads it cannot carry.

    Singular values are those of forces and of moments about the feet's centre over the feet's root mean square distance from it, so that
    neither the frame nor the unit of length counts.

    Args:
        points: the feet [..., k, 3], m.

    Returns:
        G [..., 6, k, 3]; its singular values [..., 6]; the load components that cannot be carried, lost [..., 3, 6], rows of zeros where
        there are fewer (a wrench about the frame's origin can be carried only if lost . wrench = 0); condition [...], infinite where
        something is lost; rank [...]; status [...]: OK, SINGULAR where something is lost, or BAD_INPUT with NaN.
    """
    feet = np.asarray(points, float)
    rows = [_grasp(item) for item in feet.reshape(-1, *feet.shape[-2:])]
    shape = feet.shape[:-2]
    singular, lost, condition = (np.array([row[i] for row in rows]) for i in range(3))
    rank, status = (np.array([row[i] for row in rows], np.int32).reshape(shape) for i in (3, 4))
    G = np.where(status[..., None, None] == BAD_INPUT, np.nan, grasp_map(np.where(np.isfinite(feet), feet, 0.0)))
    G = G.reshape(*shape, 6, feet.shape[-2], 3)
    return G, singular.reshape(*shape, 6), lost.reshape(*shape, 3, 6), condition.reshape(shape), rank, status


def _grasp(points: Reals) -> tuple[Reals, Reals, float, int, int]:
    if not are_feet(points):
        return np.full(6, np.nan), np.full((3, 6), np.nan), np.nan, 0, BAD_INPUT
    stance = stance_of(points, np.zeros(6))
    U, singular, _ = np.linalg.svd(stance.grasp)
    singular = np.concatenate([singular, np.zeros(6 - len(singular))])
    kept = singular > np.sqrt(len(points)) * stance.blur
    if not np.isfinite(stance.blur):
        kept = np.arange(6) < 3
    rank = int(np.count_nonzero(kept))
    lost = np.zeros((3, 6))
    axes = U[3:, rank:].T
    lost[: 6 - rank] = np.concatenate([np.cross(stance.centre, axes), axes], axis=1)
    singular = np.where(kept, singular, 0.0)
    condition = singular[0] / singular[5] if rank == 6 else np.inf
    return singular, lost, condition, rank, OK if rank == 6 else SINGULAR

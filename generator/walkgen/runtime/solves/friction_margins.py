"""How far a stance is from slipping and lifting off, and where a foot may stand: the reference of walkgen_friction_margins.h."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.friction_needed import Carrying, Problem, needed, problem_of, reach, stances
from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, Integers, Reals, are_feet, are_unit

_ROUGHEST = 1e9
_FAR = 1e6
_NONE = 1e-11


def friction_share(points: ArrayLike, normals: ArrayLike, mu: ArrayLike, wrench: ArrayLike) -> tuple[Reals, Integers]:
    """The share of the friction that is needed: the least factor on all mu with which the feet carry the load; above 1 they slip.

    Args:
        points: the feet [..., k, 3], m.
        normals: the ground's at the feet, unit vectors towards the robot [..., k, 3].
        mu: coefficients of friction [..., k].
        wrench: the load on the robot [..., 6]: force, N, and moment about the frame's origin, Nm.

    Returns:
        share [...] and status [...]: infinite and INFEASIBLE where no factor helps, NaN with NO_CONVERGENCE or BAD_INPUT.
    """
    shape, given = stances((points, normals, mu, wrench), (2, 2, 1, 1))
    rows = [_share(*(item[index] for item in given)) for index in np.ndindex(shape)]
    share, status = np.array([row[0] for row in rows]), np.array([row[1] for row in rows], np.int32)
    return share.reshape(shape), status.reshape(shape)


def load_margin(
    points: ArrayLike, normals: ArrayLike, mu: ArrayLike, wrench: ArrayLike, direction: ArrayLike
) -> tuple[Reals, Reals, Integers]:
    """How much more load the feet carry, and the normal force that every foot has in reserve.

    Args:
        points: as `friction_share` takes them, like the others.
        normals: [..., k, 3].
        mu: above 0 [..., k].
        wrench: [..., 6].
        direction: of the further load [..., 6].

    Returns:
        reach [...], the most of `direction`, infinite from 1e6 loads on; lift [...], N, the greatest N - |T| / mu that all feet can have;
        status [...]: INFEASIBLE where the load itself cannot be carried (reach NaN), NO_CONVERGENCE or BAD_INPUT with NaN.
    """
    shape, given = stances((points, normals, mu, wrench, direction), (2, 2, 1, 1, 1))
    rows = [_margin(*(item[index] for item in given)) for index in np.ndindex(shape)]
    most, lift = (np.array([row[i] for row in rows]).reshape(shape) for i in range(2))
    return most, lift, np.array([row[2] for row in rows], np.int32).reshape(shape)


def foot_admissible(
    points: ArrayLike,
    normals: ArrayLike,
    mu: ArrayLike,
    wrench: ArrayLike,
    foot: ArrayLike,
    candidate: ArrayLike,
    candidate_normal: ArrayLike,
) -> tuple[Reals, Integers]:
    """`friction_share` with a foot, by its number [...], on a candidate [..., 3] with its normal [..., 3] instead of its own."""
    shape, given = stances((points, normals, mu, wrench, foot, candidate, candidate_normal), (2, 2, 1, 1, 0, 1, 1))
    feet, directions, rough, load, number, spot, aim = given
    moved = (number[..., None] == np.arange(feet.shape[-2]))[..., None]
    share, status = friction_share(np.where(moved, spot[..., None, :], feet), np.where(moved, aim[..., None, :], directions), rough, load)
    known = np.broadcast_to(moved.any(axis=(-1, -2)), shape)
    return np.where(known, share, np.nan), np.where(known, status, BAD_INPUT).astype(np.int32)


def scaled(problem: Problem, mu: Reals) -> Carrying:
    """The problem in which a common coefficient of 1 stands for mu."""
    size = np.stack([np.ones_like(mu), mu, mu], axis=-1).ravel()
    return replace(problem.carrying, columns=problem.carrying.columns * size)


def _rough(mu: Reals) -> bool:
    return bool(np.all((mu >= 0.0) & (mu <= _ROUGHEST)))


def _share(points: Reals, normals: Reals, mu: Reals, wrench: Reals) -> tuple[float, int]:
    if not are_feet(points, normals, wrench) or not are_unit(normals) or not _rough(mu):
        return np.nan, BAD_INPUT
    problem = problem_of(points, normals, wrench)
    if problem.helpless() is not None:
        return np.inf, INFEASIBLE
    share = needed(scaled(problem, mu))
    return (np.nan, NO_CONVERGENCE) if share is None else (share, OK)


def _margin(points: Reals, normals: Reals, mu: Reals, wrench: Reals, direction: Reals) -> tuple[float, float, int]:
    fine = are_feet(points, normals, wrench, direction) and are_unit(normals) and _rough(mu)
    if not fine or not mu.min() > 0.0 or not direction.any():
        return np.nan, np.nan, BAD_INPUT
    problem = problem_of(points, normals, wrench)
    if problem.helpless() is not None:
        return np.nan, np.nan, INFEASIBLE
    carrying = scaled(problem, mu)
    s = reach(carrying, 1.0)[0]
    lift = np.inf if s > _FAR else s * problem.stance.force
    if s < -_NONE:
        return np.nan, lift, INFEASIBLE
    return _most(problem, carrying, points, direction), lift, OK


def _most(problem: Problem, carrying: Carrying, points: Reals, direction: Reals) -> float:
    """The most of a direction, by doubling and halving: the loads that can be carried are convex."""
    other = problem_of(points, problem.frames[:, 0], direction).stance
    if np.linalg.norm(other.load - problem.kept @ (problem.kept.T @ other.load)) > _NONE:
        return 0.0
    along = -problem.kept.T @ other.load

    def carried(t: float) -> bool:
        size = 1.0 + t
        return reach(replace(carrying, b=(carrying.b + t * along) / size), 1.0)[0] >= -_NONE

    low, high = 0.0, 1.0
    while carried(high):
        low, high = high, 2.0 * high
        if high > _FAR:
            return np.inf
    while high - low > 1e-13 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if carried(middle) else (low, middle)
    return low * problem.stance.force / other.force

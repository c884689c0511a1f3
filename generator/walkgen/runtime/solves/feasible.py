"""Where a centre of mass may be and which level forces a stance withstands, with friction as it is: the reference of walkgen_feasible.h."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.friction_needed import stances
from walkgen.runtime.solves.shadow import MOST_DIRECTIONS, Shadow, nearest, shadow_of
from walkgen.runtime.solves.stance import BAD_INPUT, NO_CONVERGENCE, OK, Integers, Reals, Stance, are_feet, are_unit, stance_of

_ROUGHEST = 1e9
_FAIR = 1e-7


def feasible_region(
    points: ArrayLike, mu: ArrayLike, normals: ArrayLike, gravity: ArrayLike, own: ArrayLike, tolerance: ArrayLike
) -> tuple[Reals, Integers, Reals, Integers]:
    """Where the centre of mass may be for the feet to carry the weight within their friction cones (Bretl and Lall 2008).

    Args:
        points: the feet [..., k, 3], m.
        mu: coefficients of friction [..., k].
        normals: the ground's at the feet, unit vectors towards the robot, or zeros for up [..., k, 3].
        gravity: [..., 3], m/s^2; zeros for `own`.
        own: the robot's gravity and mass [..., 4].
        tolerance: how far the region may reach beyond the polygon, m [...].

    Returns:
        The corners of a polygon inside the region [..., 64, 3], counterclockwise as seen from above, at the height of the feet's centre;
        what is left over repeats the last; their number [...]; how far the region reaches beyond at most, m, infinite where it has no
        bound [...]; status [...]: NO_CONVERGENCE where that is more than the tolerance; with NaN and no corners INFEASIBLE where the
        region is empty, SINGULAR where it has no area, BAD_INPUT.
    """
    shape, given = stances((points, mu, normals, gravity, own, tolerance), (2, 1, 2, 1, 1, 0))
    rows = [_region(*(item[index] for item in given)) for index in np.ndindex(shape)]
    polygon, error = (np.array([row[i] for row in rows]) for i in (0, 2))
    vertices, status = (np.array([row[i] for row in rows], np.int32).reshape(shape) for i in (1, 3))
    return polygon.reshape(*shape, MOST_DIRECTIONS, 3), vertices, error.reshape(shape), status


def disturbance_margin(
    points: ArrayLike,
    com: ArrayLike,
    mu: ArrayLike,
    point: ArrayLike,
    normals: ArrayLike,
    gravity: ArrayLike,
    mass: ArrayLike,
    own: ArrayLike,
) -> tuple[Reals, Reals, Integers]:
    """The greatest level force that feet withstand together with the weight, whatever its direction, before one slips or lifts off.

    Args:
        points: the feet [..., k, 3], m.
        com: the centre of mass [..., 3], m.
        mu: coefficients of friction [..., k].
        point: where the force acts [..., 3], m.
        normals: as `feasible_region` takes them, like gravity and own.
        gravity: [..., 3].
        mass: [...], kg; 0 for `own`.
        own: [..., 4].

    Returns:
        The force [...], N, infinite where pressing feet set the limit; the level direction [..., 3] in which they withstand no more;
        status [...]: INFEASIBLE where they do not even carry the weight, else as `feasible_region` has it, with NaN.
    """
    shape, given = stances((points, com, mu, point, normals, gravity, mass, own), (2, 1, 1, 1, 2, 1, 0, 1))
    rows = [_disturbance(*(item[index] for item in given)) for index in np.ndindex(shape)]
    force, direction = np.array([row[0] for row in rows]).reshape(shape), np.array([row[1] for row in rows])
    return force, direction.reshape(*shape, 3), np.array([row[2] for row in rows], np.int32).reshape(shape)


def burden(gravity: Reals, mass: Reals | float, own: Reals) -> tuple[Reals, float]:
    """The gravity [3] and the mass that count: those given, or where they are 0 the robot's own [4]."""
    return (gravity if gravity.any() else own[:3]), float(mass) or float(own[3])


def friction_margin(points: Reals, com: Reals, mu: Reals, normals: Reals, gravity: Reals) -> tuple[float, Reals, int]:
    """Signed distance of a centre of mass from the region's border, its gradient [3] and a status."""
    found = _weight_region(points, mu, normals, gravity)
    if isinstance(found, int):
        return np.nan, np.full(3, np.nan), found
    margin, out, status = found.shadow.margin(found.axes @ (com - found.stance.centre) / found.stance.length)
    gradient = -out @ found.axes
    return (found.stance.length * margin, gradient, OK) if status == OK else (np.nan, np.full(3, np.nan), status)


@dataclass(frozen=True)
class _Region:
    """What feet can carry, along level axes [2, 3], in the stance's units about its centre."""

    shadow: Shadow
    stance: Stance
    axes: Reals


def _region(points: Reals, mu: Reals, normals: Reals, gravity: Reals, own: Reals, tolerance: Reals) -> tuple[Reals, int, float, int]:
    found = _weight_region(points, mu, normals, burden(gravity, 0.0, own)[0]) if tolerance > 0.0 else BAD_INPUT
    if isinstance(found, int):
        return np.full((MOST_DIRECTIONS, 3), np.nan), 0, np.nan, found
    length = found.stance.length
    error = length * found.shadow.refine(float(tolerance) / length)
    corners = found.stance.centre + length * _corners([point for _, point, *_ in found.shadow.known]) @ found.axes
    filled = corners[np.minimum(np.arange(MOST_DIRECTIONS), len(corners) - 1)]
    return filled, len(corners), error, OK if error <= tolerance else NO_CONVERGENCE


def _weight_region(points: Reals, mu: Reals, normals: Reals, gravity: Reals) -> "_Region | int":
    """Of centres of mass; a status where there is none."""
    ground = _ground(points, normals, mu, gravity)
    if ground is None:
        return BAD_INPUT
    down, axes = _unit(gravity), _level_axes(gravity)
    stance = stance_of(points, np.concatenate([down, np.cross(points.mean(axis=0), down)]))
    plane = np.concatenate([np.zeros((2, 3)), np.cross(axes, down)], axis=1)
    shadow = shadow_of(stance, ground, mu, plane, 2)
    return shadow if isinstance(shadow, int) else _Region(shadow, stance, axes)


def _disturbance(
    points: Reals, com: Reals, mu: Reals, point: Reals, normals: Reals, gravity: Reals, mass: Reals, own: Reals
) -> tuple[float, Reals, int]:
    pull, carried = burden(gravity, mass, own)
    ground = _ground(points, normals, mu, pull)
    if ground is None or not (carried > 0.0 and are_feet(points, com, point, np.array(carried))):
        return np.nan, np.full(3, np.nan), BAD_INPUT
    weight, axes = carried * pull, _level_axes(pull)
    stance = stance_of(points, np.concatenate([weight, np.cross(com, weight)]))
    plane = np.concatenate([axes, np.cross((point - stance.centre) / stance.length, axes)], axis=1)
    shadow = shadow_of(stance, ground, mu, plane, 0)
    if isinstance(shadow, int):
        return np.nan, np.full(3, np.nan), shadow
    margin, out, status = shadow.margin(np.zeros(2))
    return (max(margin, 0.0) * stance.force, out @ axes, OK) if status == OK else (np.nan, np.full(3, np.nan), status)


def _ground(points: Reals, normals: Reals, mu: Reals, gravity: Reals) -> Reals | None:
    """The normals as they count; None where the stance is none."""
    if not are_feet(points, normals, mu, gravity) or not gravity.any() or not bool(((mu >= 0.0) & (mu <= _ROUGHEST)).all()):
        return None
    ground = np.where(normals.any(axis=1, keepdims=True), normals, -_unit(gravity))
    return ground if are_unit(ground) else None


def _level_axes(gravity: Reals) -> Reals:
    """Two level unit vectors that make a right-handed frame with up [2, 3]."""
    axes = np.linalg.svd(_unit(gravity)[None])[2][1:]
    return axes if np.cross(*axes) @ gravity < 0.0 else axes[::-1]


def _corners(points: list[Reals]) -> Reals:
    """Without points that are no corners, to rounding."""
    kept, left = list(points), 0
    while left < len(kept) and len(kept) > 1:
        before, after = kept[left - 1], kept[(left + 1) % len(kept)]
        if np.linalg.norm(kept[left] - nearest(before, after, kept[left])) > _FAIR:
            left += 1
        else:
            del kept[left]
    return np.array(kept)


def _unit(vector: Reals) -> Reals:
    return np.asarray(vector / np.linalg.norm(vector))

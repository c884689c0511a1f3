"""Where a centre of mass may be and which level forces a stance withstands, with friction as it is: the reference of walkgen_feasible.h."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.friction_needed import Carrying, frame_of, greatest, stances
from walkgen.runtime.solves.stance import (
    BAD_INPUT,
    INFEASIBLE,
    NO_CONVERGENCE,
    OK,
    SINGULAR,
    Integers,
    Reals,
    Stance,
    are_feet,
    are_unit,
    stance_of,
)

MOST_DIRECTIONS = 64
_ROUGHEST = 1e9
_STEEP = 1e-7
_NONE = 1e-10
_SHARP = 1e-11
_FAIR = 1e-7
_FAR = 1e3
_SPARE = 1e-4
_SAME = 1e-12
_ROUND = 2e-3


@dataclass
class Shadow:
    """The mixtures of two wrenches that feet can carry on top of a load: directions, the points farthest in them, how far these are, and
    whether they are open: limited only by normal forces of 1e3 loads in sum, by which feet press against each other.

    Attributes:
        columns: wrenches of the feet's forces in a basis of those that they can give [rank, 3k].
        load: in that basis [rank].
        plane: the two wrenches in it, by columns [rank, 2].
    """

    columns: Reals
    load: Reals
    plane: Reals
    known: list[tuple[Reals, Reals, float, bool]] = field(default_factory=list)

    def spare(self, count: int) -> float | None:
        """The greatest normal force that every foot can have above what its friction needs, with `count` wrenches free."""
        rows = _complement(self.plane[:, :count])
        lift = self.columns[:, ::3].sum(axis=1)
        s, _, _, closed = greatest(Carrying(rows @ self.columns, -rows @ self.load), rows @ lift, 1.0)
        return s if closed or s > 1.0 else None

    def look(self, u: Reals) -> bool:
        """One more direction: whether it tells anything."""
        if len(self.known) == MOST_DIRECTIONS or any(abs(_turn(u, v)) <= _SAME and u @ v > 0.0 for v, *_ in self.known):
            return False
        across = np.array([-u[1], u[0]])
        gone, sought = self.plane @ across, self.plane @ u
        rows, forces = _complement(gone[:, None]), self.columns.shape[1]
        bound = np.concatenate([np.where(np.arange(forces) % 3 == 0, 1.0 / _FAR, 0.0), [1.0, 0.0, 0.0]])
        columns = np.concatenate([np.concatenate([rows @ self.columns, np.zeros((len(rows), 3))], axis=1), bound[None]])
        s, x, _, closed = greatest(Carrying(columns, np.append(-rows @ self.load, 1.0)), np.append(rows @ sought, 0.0), np.inf)
        if not closed:
            return False
        aside = float(gone @ (-self.load - s * sought - self.columns @ x[:forces]) / (gone @ gone))
        self.known.append((u, s * u + aside * across, s, bool(x[forces] < _SPARE)))
        self.known.sort(key=lambda item: float(np.arctan2(item[0][1], item[0][0])) % (2.0 * np.pi))
        return True

    def margin(self, start: Reals) -> tuple[float, Reals, int]:
        """Signed distance of a point from the region's border, the way out and a status."""
        for _ in range(MOST_DIRECTIONS + 1):
            least, toward = _way_out(np.array([item[1] for item in self.known]), start)
            margin, out, is_open = min(((reach - u @ start, u, is_open) for u, _, reach, is_open in self.known), key=lambda pair: pair[0])
            if margin - least <= _SHARP * (1.0 + abs(least)) or not self.look(toward):
                break
        if not margin - least <= _FAIR * (1.0 + abs(least)) + _ROUND * abs(margin):
            return np.nan, np.full(2, np.nan), NO_CONVERGENCE
        return (np.inf, np.zeros(2), OK) if is_open else (float(margin), out, OK)

    def refine(self, tolerance: float) -> float:
        """The polygon of points brought within a distance of the region: how far it may be."""
        for _ in range(MOST_DIRECTIONS + 1):
            largest, normal = max((self._gap(side) for side in range(len(self.known))), key=lambda gap: gap[0])
            if largest <= tolerance or not self.look(normal):
                break
        return np.inf if any(is_open for *_, is_open in self.known) else largest

    def _gap(self, side: int) -> tuple[float, Reals]:
        (u, a, *_), (v, b, *_) = self.known[side], self.known[(side + 1) % len(self.known)]
        normal, length = _normal(a, b)
        before, after = _turn(u, normal), _turn(normal, v)
        return (length * before * after / _turn(u, v) if min(before, after) > 0.0 else 0.0), normal


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
    shadow = _shadow(stance, ground, mu, plane, 2)
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
    shadow = _shadow(stance, ground, mu, plane, 0)
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


def _shadow(stance: Stance, normals: Reals, mu: Reals, plane: Reals, free: int) -> Shadow | int:
    """The region by four directions, of two wrenches [2, 6] in the stance's units, `free` of which may be any, or why there is none."""
    frames = np.array([frame_of(normal) for normal in normals])
    columns = np.concatenate([stance.grasp[:, 3 * i : 3 * i + 3] @ frames[i].T for i in range(len(normals))], axis=1)
    size = np.stack([np.ones_like(mu), mu, mu], axis=-1).ravel()
    U, singular, _ = np.linalg.svd(columns * (size > 0.0))
    kept = U[:, : np.count_nonzero(singular > _STEEP)]
    if np.linalg.norm(stance.load - kept @ (kept.T @ stance.load)) > _NONE:
        return INFEASIBLE
    if np.linalg.norm(plane - plane @ kept @ kept.T) > _NONE:
        return SINGULAR
    shadow = Shadow(kept.T @ (columns * size), kept.T @ stance.load, kept.T @ plane.T)
    spare = shadow.spare(free)
    if spare is None or spare < -_NONE:
        return NO_CONVERGENCE if spare is None else INFEASIBLE
    if not all(shadow.look(np.array(u)) for u in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))):
        return NO_CONVERGENCE if spare > _NONE else SINGULAR
    points = [point for _, point, *_ in shadow.known]
    area = sum(_turn(a, b) for a, b in zip(points, (*points[1:], points[0]), strict=True))
    return SINGULAR if spare <= _NONE and area <= _NONE else shadow


def _level_axes(gravity: Reals) -> Reals:
    """Two level unit vectors that make a right-handed frame with up [2, 3]."""
    axes = np.linalg.svd(_unit(gravity)[None])[2][1:]
    return axes if np.cross(*axes) @ gravity < 0.0 else axes[::-1]


def _complement(vectors: Reals) -> Reals:
    """An orthonormal basis, by rows, of what is across the columns [n, c]."""
    return np.asarray(np.linalg.qr(vectors, mode="complete")[0][:, vectors.shape[1] :].T)


def _way_out(polygon: Reals, start: Reals) -> tuple[float, Reals]:
    """How far it is from a point out of a polygon [n, 2], negative from outside, and the unit vector that way."""
    sides = [(a, *_normal(a, b), b) for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)]
    insides = [(float(normal @ (a - start)), normal) for a, normal, length, _ in sides if length > _SHARP]
    least, normal = min(insides, key=lambda pair: pair[0]) if insides else (-np.inf, np.array([1.0, 0.0]))
    if least >= 0.0:
        return least, normal
    away = min((start - _nearest(a, b, start) for a, _, _, b in sides), key=lambda way: float(np.linalg.norm(way)))
    far = float(np.linalg.norm(away))
    return -far, away / far if far > _SHARP else normal


def _corners(points: list[Reals]) -> Reals:
    """Without points that are no corners, to rounding."""
    kept, left = list(points), 0
    while left < len(kept) and len(kept) > 1:
        before, after = kept[left - 1], kept[(left + 1) % len(kept)]
        if np.linalg.norm(kept[left] - _nearest(before, after, kept[left])) > _FAIR:
            left += 1
        else:
            del kept[left]
    return np.array(kept)


def _nearest(a: Reals, b: Reals, point: Reals) -> Reals:
    square = float((b - a) @ (b - a))
    share = np.clip((point - a) @ (b - a) / square, 0.0, 1.0) if square > 0.0 else 0.0
    return np.asarray(a + share * (b - a))


def _normal(a: Reals, b: Reals) -> tuple[Reals, float]:
    """The outward normal of a polygon's side, and its length."""
    way = b - a
    length = float(np.hypot(*way))
    return (np.array([way[1], -way[0]]) / length if length > 0.0 else np.zeros(2)), length


def _turn(a: Reals, b: Reals) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _unit(vector: Reals) -> Reals:
    return np.asarray(vector / np.linalg.norm(vector))

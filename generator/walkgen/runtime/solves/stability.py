"""The margins of static stability of a stance and their gradients: the reference of walkgen_stability.h."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.feasible import burden, friction_margin
from walkgen.runtime.solves.friction_needed import stances
from walkgen.runtime.solves.stance import BAD_INPUT, OK, SINGULAR, Integers, Reals, are_feet
from walkgen.runtime.solves.support import Support, heights, is_level, static_margin, support_of, way_margin

_RANKS = (2, 1, 1, 1, 2, 1, 0, 1)
_INTEGERS = frozenset({"polygon", "vertices", "edge", "status"})


class Margins(NamedTuple):
    """Static [...], longitudinal front and rear [..., 2], energy (J) [...], height (m) [...], with friction (m) [...]; the polygon
    [..., k], -1 beyond its vertices [...]; the edge that tips [..., 2]; the heights of all edges [..., k], infinite beyond; status [...].
    """

    static_margin: Reals
    longitudinal: Reals
    energy: Reals
    height: Reals
    friction: Reals
    polygon: Integers
    vertices: Integers
    edge: Integers
    heights: Reals
    status: Integers


class Gradients(NamedTuple):
    """By the centre of mass: static [..., 3], longitudinal [..., 2, 3], energy (N) [..., 3], height [..., 3], friction [..., 3]; status."""

    static_margin: Reals
    longitudinal: Reals
    energy: Reals
    height: Reals
    friction: Reals
    status: Integers


def stability_margins(
    points: ArrayLike,
    com: ArrayLike,
    direction: ArrayLike,
    mu: ArrayLike,
    normals: ArrayLike,
    gravity: ArrayLike,
    mass: ArrayLike,
    own: ArrayLike,
) -> Margins:
    """How far a centre of mass over feet at any heights is from tipping, and with friction from slipping.

    Args:
        points: the feet [..., k, 3], m.
        com: the centre of mass [..., 3], m.
        direction: of travel, not along gravity [..., 3].
        mu: coefficients of friction [..., k]; all infinite: the support polygon counts.
        normals: the ground's at the feet, unit vectors towards the robot, or zeros for up [..., k, 3].
        gravity: [..., 3], m/s^2; zeros for `own`.
        mass: [...], kg; 0 for `own`.
        own: the robot's gravity and mass [..., 4].

    Returns:
        SINGULAR with NaN but for the static margin for fewer than three feet, or feet on a line as seen along gravity; with NaN for
        friction's alone INFEASIBLE where the weight cannot be carried anywhere, SINGULAR where its region has no area, NO_CONVERGENCE;
        BAD_INPUT with NaN.
    """
    shape, given = stances((points, com, direction, mu, normals, gravity, mass, own), _RANKS)
    rows = [_all(*(item[index] for item in given)).margins() for index in np.ndindex(shape)]
    k = given[0].shape[-2]
    return Margins(*_stacked(rows, shape, ((), (2,), (), (), (), (k,), (), (2,), (k,), ()), Margins._fields))


def stability_margins_d_com(
    points: ArrayLike,
    com: ArrayLike,
    direction: ArrayLike,
    mu: ArrayLike,
    normals: ArrayLike,
    gravity: ArrayLike,
    mass: ArrayLike,
    own: ArrayLike,
) -> Gradients:
    """The gradients of `stability_margins` by the centre of mass: those of the first edge, foot or direction that limits them."""
    shape, given = stances((points, com, direction, mu, normals, gravity, mass, own), _RANKS)
    rows = [_all(*(item[index] for item in given)).gradients() for index in np.ndindex(shape)]
    return Gradients(*_stacked(rows, shape, ((3,), (2, 3), (3,), (3,), (3,), ()), Gradients._fields))


def _stacked(
    rows: Sequence[tuple[Any, ...]], shape: tuple[int, ...], tails: Sequence[tuple[int, ...]], names: Sequence[str]
) -> Iterator[np.ndarray]:
    """Rows' entries as arrays with the leading shape, each with its own tail."""
    for i, (name, tail) in enumerate(zip(names, tails, strict=True)):
        yield np.array([row[i] for row in rows], np.int32 if name in _INTEGERS else float).reshape((*shape, *tail))


@dataclass(frozen=True)
class _Found:
    """Of one stance of k feet: static, front, rear, height and friction margins, their gradients [5, 3], the weight (N)."""

    k: int
    values: Reals
    slopes: Reals
    heights: tuple[float, ...] = ()
    polygon: tuple[int, ...] = ()
    weight: float = np.nan
    status: int = BAD_INPUT

    def margins(self) -> tuple[Any, ...]:
        """As `Margins` has them."""
        static, front, rear, height, friction = map(float, self.values)
        rest = self.k - len(self.polygon)
        polygon = np.array([*self.polygon, *[-1] * rest], np.int32)
        edge, high = np.full(2, -1, np.int32), np.full(self.k, np.nan)
        if self.heights:
            first = int(np.argmin(self.heights))
            edge = np.array([self.polygon[first], self.polygon[(first + 1) % len(self.polygon)]], np.int32)
            high = np.array([*self.heights, *[np.inf] * rest])
        found = static, np.array([front, rear]), height * self.weight, height, friction
        return (*found, polygon, len(self.polygon), edge, high, self.status)

    def gradients(self) -> tuple[Any, ...]:
        """As `Gradients` has them."""
        static, front, rear, height, friction = self.slopes
        return static, np.array([front, rear]), height * self.weight, height, friction, self.status


def _all(points: Reals, com: Reals, direction: Reals, mu: Reals, normals: Reals, gravity: Reals, mass: Reals, own: Reals) -> _Found:
    pull, carried = burden(gravity, mass, own)
    values, slopes = np.full(5, np.nan), np.full((5, 3), np.nan)
    fine = are_feet(points, com, direction, pull, np.array(carried)) and pull.any() and carried >= 0.0 and bool((mu >= 0.0).all())
    if not fine or not is_level(-pull / np.linalg.norm(pull), direction):
        return _Found(len(points), values, slopes)
    support = support_of(points, com, pull)
    values[0], slopes[0] = static_margin(support)
    if len(support.polygon) < 3:
        return _Found(len(points), values, slopes, (), support.polygon, np.nan, SINGULAR)
    tall = _tip(support, direction, values, slopes)
    values[4], slopes[4], status = _rough(points, com, mu, normals, pull, (float(values[0]), slopes[0]))
    if status == BAD_INPUT:
        return _Found(len(points), np.full(5, np.nan), np.full((5, 3), np.nan))
    return _Found(len(points), values, slopes, tall, support.polygon, carried * float(np.linalg.norm(pull)), status)


def _tip(support: Support, direction: Reals, values: Reals, slopes: Reals) -> tuple[float, ...]:
    """Longitudinal margins and the least height, in place; the heights of all edges."""
    values[1], slopes[1] = way_margin(support, direction)
    values[2], slopes[2] = way_margin(support, -direction)
    tall = heights(support)
    values[3], slopes[3] = min(tall, key=lambda pair: pair[0])
    return tuple(height for height, _ in tall)


def _rough(points: Reals, com: Reals, mu: Reals, normals: Reals, gravity: Reals, smooth: tuple[float, Reals]) -> tuple[float, Reals, int]:
    """The margin with friction; the static one where nothing slips."""
    return (*smooth, OK) if np.isinf(mu).all() else friction_margin(points, com, mu, normals, gravity)

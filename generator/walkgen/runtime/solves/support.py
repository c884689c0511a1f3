"""The support polygon of feet at any heights and how far a centre of mass is from tipping: the reference of walkgen_support.h."""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.stance import Reals, stance_of

_ACROSS = 1e-12
Margin = tuple[float, Reals]
"""A margin, and its gradient by the centre of mass in the frame given [3]."""


@dataclass(frozen=True)
class Support:
    """The polygon seen along gravity.

    Attributes:
        points: the feet [k, 3], m.
        com: the centre of mass [3], m.
        up: the unit vector against gravity [3].
        polygon: numbers of feet counterclockwise as seen from above, the lowest first; fewer than three where the feet are on a line.
    """

    points: Reals
    com: Reals
    up: Reals
    polygon: tuple[int, ...]

    @property
    def edges(self) -> list[tuple[Reals, Reals]]:
        """The feet at both ends of every edge."""
        ends = zip(self.polygon, (*self.polygon[1:], *self.polygon[:1]), strict=True)
        return [(self.points[first], self.points[second]) for first, second in ends]

    def level(self, vector: Reals) -> Reals:
        """Its part across gravity."""
        return np.asarray(vector - self.up * (vector @ self.up))

    def inward(self, ends: tuple[Reals, Reals]) -> Reals:
        """The level unit vector from an edge to the polygon's inside."""
        return _unit(np.cross(self.up, ends[1] - ends[0]))


def support_of(points: Reals, com: Reals, gravity: Reals) -> Support:
    """The polygon of feet [k, 3] under a gravity [3] that is not 0."""
    up = -_unit(gravity)
    stance = stance_of(points, np.zeros(6))
    blur = stance.length * min(stance.blur, 1.0)
    axes = np.linalg.svd(up[None])[2][1:]
    axes = axes if np.cross(*axes) @ up > 0.0 else axes[::-1]
    offsets = points - stance.centre
    flat, height = offsets @ axes.T, offsets @ up
    near = np.linalg.norm(flat[:, None] - flat, axis=-1) <= blur
    drop = height - height[:, None]
    lower_number = np.arange(len(points)) < np.arange(len(points))[:, None]
    covered = (near & ((drop < -blur) | ((drop <= blur) & lower_number))).any(axis=1)
    kept = [int(foot) for foot in np.flatnonzero(~covered)]
    return Support(points, com, up, _hull(flat, kept, blur))


def static_margin(support: Support) -> Margin:
    """Signed distance of the centre of mass, seen along gravity, from the polygon's border; minus the distance from outside."""
    normal = np.zeros(3)
    if len(support.polygon) > 2:
        insides = [_inside(support, ends) for ends in support.edges]
        first = int(np.argmin(insides))
        normal = support.inward(support.edges[first])
        if insides[first] >= 0.0:
            return insides[first], normal
    ways = [support.level(_nearest(support, ends) - support.com) for ends in support.edges]
    way = min(ways, key=lambda way: float(np.linalg.norm(way)))
    away = float(np.linalg.norm(way))
    if away > 0.0:
        return -away, way / away
    return 0.0, normal


def way_margin(support: Support, direction: Reals) -> Margin:
    """How far the centre of mass can go along the level part of a direction before the line of an edge, negative past one."""
    ahead = _unit(support.level(direction))
    facing = ((-support.inward(ends) @ ahead, ends) for ends in support.edges)
    ways = [(_inside(support, ends) / out, support.inward(ends) / out) for out, ends in facing if out > _ACROSS]
    way, slope = min(ways, key=lambda pair: pair[0])
    return float(way), np.asarray(slope)


def is_level(up: Reals, direction: Reals) -> bool:
    """Whether a direction has a part across gravity."""
    largest = float(np.abs(direction).max())
    unit = _unit(direction / largest) if largest > 0.0 else up
    return bool(np.linalg.norm(np.cross(up, unit)) > _ACROSS)


def heights(support: Support) -> list[Margin]:
    """How much higher the centre of mass must go to pass over each edge, turning about the line between its feet; past one, minus that."""
    return [_height(support, *ends) for ends in support.edges]


def _height(support: Support, a: Reals, b: Reals) -> Margin:
    """|R| cos(psi) - R . up (Messuri and Klein 1985)."""
    e = _unit(b - a)
    R = (support.com - a) - e * (e @ (support.com - a))
    cosine = float(np.linalg.norm(np.cross(e, support.up)))
    inside = R @ np.cross(support.up, e) / cosine
    side = 1.0 if inside >= 0.0 else -1.0
    across = _unit(support.up - e * (e @ support.up))
    far, high = float(np.linalg.norm(R)), float(R @ across)
    rise = inside**2 / (far + high) if high > 0.0 else far - high
    toward = R / far if far > 0.0 else np.zeros(3)
    return side * cosine * float(rise), side * cosine * (toward - across)


def _hull(flat: Reals, kept: list[int], blur: float) -> tuple[int, ...]:
    """Gift wrapping from the foot farthest from the centre; of feet on a line, to rounding, only those at its ends."""
    found = [kept[int(np.argmax(np.sum(flat[kept] ** 2, axis=1)))]]
    while len(found) <= len(kept):
        after = _next(flat, kept, blur, found[-1])
        if after in found:
            break
        found.append(after)
    start = found.index(min(found))
    return (*found[start:], *found[:start])


def _next(flat: Reals, kept: list[int], blur: float, last: int) -> int:
    after, best, far = last, np.zeros(2), 0.0
    for foot in kept:
        way = flat[foot] - flat[last]
        length = float(np.hypot(*way))
        if foot == last:
            continue
        left = 0.0 if after == last else float(best[0] * way[1] - best[1] * way[0]) / max(far, length)
        if left < -blur or (left <= blur and length > far):
            after, best, far = foot, way, length
    return after


def _inside(support: Support, ends: tuple[Reals, Reals]) -> float:
    return float(support.inward(ends) @ (support.com - ends[0]))


def _nearest(support: Support, ends: tuple[Reals, Reals]) -> Reals:
    """The point between an edge's ends that is nearest as seen along gravity."""
    along = support.level(ends[1] - ends[0])
    square = float(along @ along)
    share = np.clip((support.com - ends[0]) @ along / square, 0.0, 1.0) if square > 0.0 else 0.0
    return np.asarray(ends[0] + share * (ends[1] - ends[0]))


def _unit(vector: Reals) -> Reals:
    return np.asarray(vector / np.linalg.norm(vector))

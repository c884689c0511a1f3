"""Values of a drive at which a function of it is 0, on two sides; the reference of walkgen_crossings.h and walkgen_crossing_search.h."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[Any]
Integers = NDArray[np.int32]
Callback = tuple[Any, ...]

ROOTS, JOINTS = 16, 3
_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR = (STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR"))
_SAMPLES, _HALVINGS, _PARTS = 256, 100, 6
_MET, _CROSSED, _SAME = 1e-12, 1e-9, 1e-9
_LEFT, _MARGIN = 0, 1
_BEYOND = -(float(np.finfo(float).eps) ** 2)


def crossings(bounds: ArrayLike, p: ArrayLike, callback: Callback, sides: int, closed: int) -> tuple[Reals, Integers, Reals, Integers]:
    """Joint values at which a function of the drive is 0, in order of the drive.

    Args:
        bounds: of the drive [..., 2].
        p: the target [..., 3].
        callback: of a point [..., 5], which is the drive, the side (1 or -1) and the target, what gives [..., 9] function and margin,
            their slopes, the size of what the function is a sum of, whether a joint is free, joint values: NaN in the function where the
            margin is negative, in both where nothing moves; and what it takes after the point.
        sides: 1 or 2.
        closed: 1 where the drive is an angle and the bounds are a turn apart.

    Returns:
        Joint values [..., 16, 3] and status [..., 16]: OK, or SINGULAR where a joint is free; beyond the last UNREACHABLE with the first
        again. Then the first row [..., 3] and its status [...]: where it is UNREACHABLE, the sample that comes closest to 0, or 0.
        BAD_INPUT with NaN.
    """
    function, *data = callback
    given = [np.asarray(item, float) for item in (bounds, p, *data)]
    shape = np.broadcast_shapes(*(item.shape[:-1] for item in given))
    items = [np.broadcast_to(item, (*shape, item.shape[-1])) for item in given]
    q, status = np.full((*shape, ROOTS, JOINTS), np.nan), np.full((*shape, ROOTS), _BAD_INPUT, np.int32)
    for place in np.ndindex(shape):
        span, target, *rest = (item[place] for item in items)
        width = span[1] - span[0]
        if np.isfinite(target).all() and 0.0 < width < np.inf:
            search = _Search(lambda point, rest=rest: function(point, *rest), target, float(width) / _SAMPLES, bool(closed))  # type: ignore[misc]
            for side in (1.0, -1.0)[:sides]:
                _of_side(replace(search, side=side), float(span[0]))
            q[place], status[place] = search.told()
    return q, status, q[..., 0, :], status[..., 0]


@dataclass(frozen=True)
class _Point:
    """At one drive: function and margin; whether something moves, and whether the function is there."""

    drive: float
    value: tuple[float, float]
    slope: tuple[float, float]
    size: float
    free: float
    q: tuple[float, ...]
    moves: bool
    there: bool


def _point(drive: float, profile: Reals) -> _Point:
    left, margin, *slopes, size, free = map(float, profile[:6])
    moves = bool(np.isfinite([margin, slopes[_MARGIN]]).all())
    there = moves and margin >= 0.0 and bool(np.isfinite([left, slopes[_LEFT], size]).all())
    if moves and not there and margin >= 0.0:  # the very end, where slopes are infinite, is beyond it
        margin = _BEYOND
    return _Point(drive, (left, margin), (slopes[_LEFT], slopes[_MARGIN]), size, free, tuple(map(float, profile[6:])), moves, there)


@dataclass
class _Found:
    """The roots, and the sample that is closest to one."""

    roots: list[_Point] = field(default_factory=list)
    some: _Point | None = None


@dataclass(frozen=True)
class _Search:
    """The function, the target, the samples' distance, whether the drive turns round, the side, and what has been found."""

    function: Callable[[Reals], Reals]
    target: Reals
    step: float
    closed: bool
    side: float = 1.0
    found: _Found = field(default_factory=_Found)

    def points(self, drives: Reals) -> list[_Point]:
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            rest = np.broadcast_to([self.side, *self.target], (len(drives), 4))
            profile = np.asarray(self.function(np.concatenate([drives[:, None], rest], -1)))
        return [_point(float(drive), row) for drive, row in zip(drives, profile, strict=True)]

    def at(self, drive: float) -> _Point:
        return self.points(np.array([drive]))[0]

    def keep(self, point: _Point, nothing: float) -> None:
        """Once, in order of the drives."""
        if not point.there or abs(point.value[_LEFT]) > nothing * point.size:
            return
        roots = self.found.roots
        point = replace(point, drive=point.drive - 2.0 * np.pi) if self.closed and point.drive > np.pi else point
        if any(_are_one(root, point) for root in roots):
            return
        place = len(roots)
        while place > 0 and roots[place - 1].drive > point.drive + _SAME:
            place -= 1
        self.found.roots = [*roots[:place], point, *roots[place:]][:ROOTS]

    def told(self) -> tuple[Reals, Integers]:
        """All rows."""
        roots, some = self.found.roots, self.found.some
        rest = roots[0].q if roots else some.q if some else (0.0,) * JOINTS
        states = [_SINGULAR if root.free > 0.0 else _OK for root in roots]
        empty = ROOTS - len(roots)
        return np.array([*(root.q for root in roots), *[rest] * empty]), np.array([*states, *[_UNREACHABLE] * empty], np.int32)


def _are_one(one: _Point, other: _Point) -> bool:
    """An angle counts without whole turns."""
    away = [abs(a - b) for a, b in zip(one.q, other.q, strict=True)]
    return all(min(each, abs(each - 2.0 * np.pi)) <= _SAME for each in away)


def _of_side(search: _Search, start: float) -> None:
    """From end to end."""
    samples = search.points(start + search.step * np.arange(_SAMPLES + 1))
    if search.closed:
        samples[-1] = replace(samples[0], drive=start + search.step * _SAMPLES)
    for low, high in pairwise(samples):
        if low.there and (search.found.some is None or abs(low.value[_LEFT]) < abs(search.found.some.value[_LEFT])):
            search.found.some = low
        if low.moves and high.moves:
            _stretch(search, low, high)
        elif low.moves:
            _last(search, low, high.drive)
        elif high.moves:
            _last(search, high, low.drive)


def _last(search: _Search, start: _Point, beyond: float) -> None:
    """From a point to where nothing moves."""
    end = _end(search, start, beyond)
    way = end.drive - start.drive
    for part in range(_PARTS - 1, -1, -1):
        point = search.at(end.drive - (part / _PARTS) * (part / _PARTS) * way) if part else end
        if not point.moves:
            return
        _stretch(search, *((start, point) if way > 0.0 else (point, start)))
        start = point
    search.keep(end, _MET)


def _end(search: _Search, moving: _Point, beyond: float) -> _Point:
    """The last point at which something moves before a drive at which nothing does."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (moving.drive + beyond)
        if middle in (moving.drive, beyond):
            break
        point = search.at(middle)
        moving, beyond = (point, beyond) if point.moves else (moving, middle)
    return moving


def _stretch(search: _Search, low: _Point, high: _Point) -> None:
    """Roots between two points at which something moves."""
    if _between(low, high, _MARGIN):
        _edge(search, low, high)
        return
    if _turns(low, high, _MARGIN):
        middle, crossed = _turn(search, low, high, _MARGIN)
        if crossed:
            _edge(search, low, middle)
            _edge(search, middle, high)
            return
    if low.there and high.there:
        _pieces(search, low, high)


def _edge(search: _Search, low: _Point, high: _Point) -> None:
    """Up to where the margin is 0."""
    before, behind = _narrow(search, low, high, _MARGIN)
    _to_end(search, *((low, before) if low.value[_MARGIN] >= 0.0 else (high, behind)))


def _to_end(search: _Search, start: _Point, end: _Point) -> None:
    """In parts that become narrower as the function, a root of the way to the end, becomes steeper."""
    way = end.drive - start.drive
    for part in range(_PARTS - 1, -1, -1):
        point = search.at(end.drive - (part / _PARTS) * (part / _PARTS) * way) if part else end
        if not start.there or not point.there:
            return
        _pieces(search, *((start, point) if way > 0.0 else (point, start)))
        start = point
    search.keep(end, _MET)


def _pieces(search: _Search, low: _Point, high: _Point) -> None:
    """In two pieces where the slopes tell that the function turns round twice."""
    rise, slope = high.value[_LEFT] - low.value[_LEFT], low.slope[_LEFT]
    if slope * high.slope[_LEFT] > 0.0 and rise * slope < 0.0:
        middle = search.at(0.5 * (low.drive + high.drive))
        if middle.there:
            _piece(search, low, middle)
            _piece(search, middle, high)
            return
    _piece(search, low, high)


def _piece(search: _Search, low: _Point, high: _Point) -> None:
    """Between two points between which the function turns round once at most."""
    if _between(low, high, _LEFT):
        _root(search, low, high)
    elif _turns(low, high, _LEFT):
        middle, crossed = _turn(search, low, high, _LEFT)
        if crossed:
            _root(search, low, middle)
            _root(search, middle, high)
        else:
            search.keep(middle, _MET)


def _root(search: _Search, low: _Point, high: _Point) -> None:
    """Between two points of other signs."""
    search.keep(_nearer(*_narrow(search, low, high, _LEFT), _LEFT), _CROSSED)


def _narrow(search: _Search, low: _Point, high: _Point, which: int) -> tuple[_Point, _Point]:
    """The neighbours of a root."""
    for turn in range(_HALVINGS):
        near, middle = _nearer(low, high, which), 0.5 * (low.drive + high.drive)
        newton = near.drive - near.value[which] / near.slope[which] if near.slope[which] else np.nan
        met = which == _LEFT and (near.value[which] == 0.0 or newton == near.drive)
        if met or not low.drive < middle < high.drive:
            break
        point = search.at(newton if turn % 3 != 2 and low.drive < newton < high.drive else middle)
        if not (point.there if which == _LEFT else point.moves):
            break
        low, high = (low, point) if _between(low, point, which) else (point, high)
    return low, high


def _turn(search: _Search, low: _Point, high: _Point, which: int) -> tuple[_Point, bool]:
    """A point of the other sign between two of one sign, else the one that is nearest to 0."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (low.drive + high.drive)
        if not low.drive < middle < high.drive or not _turns(low, high, which):
            break
        point = search.at(middle)
        if not (point.there if which == _LEFT else point.moves):
            break
        if _between(low, point, which):
            return point, True
        low, high = (point, high) if point.value[which] * point.slope[which] < 0.0 else (low, point)
    return _nearer(low, high, which), False


def _between(low: _Point, high: _Point, which: int) -> bool:
    """Whether the sign changes."""
    return (low.value[which] < 0.0) != (high.value[which] < 0.0)


def _turns(low: _Point, high: _Point, which: int) -> bool:
    """Whether there may be a 0 between two points of one sign: the first leads to it, the second away from it, and fast enough."""
    width, a, b = 4.0 * (high.drive - low.drive), low.value[which], high.value[which]
    slow = abs(a) > width * abs(low.slope[which]) and abs(b) > width * abs(high.slope[which])
    return a * low.slope[which] <= 0.0 <= b * high.slope[which] and not slow


def _nearer(low: _Point, high: _Point, which: int) -> _Point:
    return low if abs(low.value[which]) < abs(high.value[which]) else high

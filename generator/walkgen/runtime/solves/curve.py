"""Where a curve of one drive meets a point, or comes closest to it; the reference of walkgen_curve.h."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[Any]
Integers = NDArray[np.int32]
Callback = tuple[Any, ...]

ROOTS = 8
_OK, _UNREACHABLE, _BAD_INPUT = (STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT"))
_SAMPLES, _COARSE, _HALVINGS, _STEPS = 256, 8, 100, 12
_MET, _SAME = 1e-12, 1e-9
_EPSILON = float(np.finfo(float).eps)


def curve_roots(bounds: ArrayLike, aim: ArrayLike, callback: Callback, closed: int) -> tuple[Reals, Integers]:
    """Drives at which a curve meets a point, in order.

    Args:
        bounds: of the drive [..., 2].
        aim: the point [..., 3].
        callback: the function of a drive [..., 1] that gives the point of the curve and its slopes [..., 6], NaN where there is none, and
            what it takes after the drive.
        closed: 1 where the drive is an angle and the bounds are a turn apart.

    Returns:
        Drives [..., 8] and status [..., 8]: OK; beyond the last UNREACHABLE with the first again, or with the nearest of all where there
        is none, NaN where the curve is nowhere; BAD_INPUT with NaN.
    """
    function, *data = callback
    given = [np.asarray(item, float) for item in (bounds, aim, *data)]
    shape = np.broadcast_shapes(*(item.shape[:-1] for item in given))
    rows = [np.broadcast_to(item, (*shape, item.shape[-1])) for item in given]
    drives, status = np.full((*shape, ROOTS), np.nan), np.full((*shape, ROOTS), _BAD_INPUT, np.int32)
    for place in np.ndindex(shape):
        span, target, *rest = (row[place] for row in rows)
        width = span[1] - span[0]
        if np.isfinite(target).all() and 0.0 < width < np.inf:
            search = _Search(lambda drive, rest=rest: function(drive, *rest), target, float(width) / _SAMPLES, bool(closed))  # type: ignore[misc]
            drives[place], status[place] = _found(search, float(span[0]))
    return drives, status


@dataclass(frozen=True)
class _Point:
    """At one drive: the squared distance from the aim, half its slope, the squared speed, the sizes of both."""

    drive: float
    square: float
    slope: float
    speed: float
    size: float

    @property
    def there(self) -> bool:
        return bool(np.isfinite([self.square, self.slope, self.speed]).all())

    @property
    def newton(self) -> float:
        return self.drive - self.slope / self.speed if self.speed > 0.0 else np.nan


@dataclass
class _Search:
    """The curve, the aim, their size, how far apart the samples are, whether the drive turns round, and what has been found."""

    curve: Callable[[Reals], Reals]
    aim: Reals
    step: float
    closed: bool
    size: float = 0.0
    roots: list[float] = field(default_factory=list)
    best: _Point | None = None

    def points(self, drives: Reals) -> list[_Point]:
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            profile = np.asarray(self.curve(drives[:, None]))
            gap, along = profile[:, :3] - self.aim, profile[:, 3:]
            sizes = np.abs(profile[:, :3]).sum(-1) + np.abs(self.aim).sum()
            numbers = (drives, (gap * gap).sum(-1), (gap * along).sum(-1), (along * along).sum(-1), sizes)
        return [_Point(*map(float, row)) for row in zip(*numbers, strict=True)]

    def at(self, drive: float) -> _Point:
        return self.points(np.array([drive]))[0]

    def wrapped(self, drive: float) -> float:
        return drive - 2.0 * np.pi if self.closed and drive > np.pi else drive

    def keep(self, point: _Point) -> None:
        """The nearest of all, and every one that meets the aim."""
        if self.best is None or point.square < self.best.square:
            self.best = point
        drive, turn = self.wrapped(point.drive), 2.0 * np.pi if self.closed else 0.0
        meets = point.square <= (_MET * max(self.size, point.size)) ** 2
        if meets and all(min(away, abs(away - turn)) > _SAME for away in (abs(root - drive) for root in self.roots)):
            self.roots = sorted([*self.roots, drive])[:ROOTS]


def _found(search: _Search, start: float) -> tuple[Reals, Integers]:
    samples = search.points(start + search.step * np.arange(_SAMPLES + 1))
    search.size = max((sample.size for sample in samples[:_SAMPLES:_COARSE] if sample.there), default=0.0)
    if search.closed:
        samples[-1] = _Point(start + search.step * _SAMPLES, *(getattr(samples[0], key) for key in ("square", "slope", "speed", "size")))
    for low, high in pairwise(samples):
        if low.there and high.there:
            _between(search, low, high)
        elif low.there:
            _between(search, low, _end(search, low, high.drive))
        elif high.there:
            _between(search, _end(search, high, low.drive), high)
    rest = search.roots[0] if search.roots else search.wrapped(search.best.drive) if search.best else np.nan
    count = len(search.roots)
    status = np.where(np.arange(ROOTS) < count, _OK, _UNREACHABLE).astype(np.int32)
    return np.array([*search.roots, *[rest] * (ROOTS - count)]), status


def _between(search: _Search, low: _Point, high: _Point) -> None:
    """What lies between two points of the curve."""
    near = low if low.square < high.square else high
    found = near
    if low.slope <= 0.0 < high.slope:
        found = _narrowed(search, low, high)
    elif near.square <= 4.0 * search.step**2 * max(low.speed, high.speed) and near.speed > 0.0:
        polished = _polished(search, near)
        found = polished if abs(polished.drive - near.drive) <= search.step else near
    search.keep(found)


def _narrowed(search: _Search, low: _Point, high: _Point) -> _Point:
    """The nearest point between two where the distance first falls and then grows."""
    for turn in range(_HALVINGS):
        near = low if low.square < high.square else high
        middle = 0.5 * (low.drive + high.drive)
        inside = turn % 2 == 0 and low.drive < near.newton < high.drive
        if abs(near.newton - near.drive) <= _EPSILON * abs(near.drive) or not low.drive < middle < high.drive:
            break
        point = search.at(near.newton if inside else middle)
        if not point.there:
            break
        low, high = (low, point) if point.slope > 0.0 else (point, high)
    return low if low.square < high.square else high


def _polished(search: _Search, point: _Point) -> _Point:
    """Gauss's and Newton's steps from a point as long as they come nearer."""
    for _ in range(_STEPS):
        tried = search.at(point.newton)
        if not tried.there or not tried.square < point.square:
            break
        point = tried
    return point


def _end(search: _Search, there: _Point, beyond: float) -> _Point:
    """The last point of the curve between one that is there and one that is not."""
    for _ in range(_HALVINGS):
        middle = 0.5 * (there.drive + beyond)
        if middle in (there.drive, beyond):
            break
        point = search.at(middle)
        there, beyond = (point, beyond) if point.there else (there, middle)
    return there

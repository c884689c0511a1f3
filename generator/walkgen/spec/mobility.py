"""Degrees of freedom of a planar linkage by the rank of its pairs' equations at an assembled pose: what counting cannot see."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from walkgen.spec.assur import Structure
from walkgen.spec.scalar import Scalar

_NOTHING = 1e-6
"""Of the largest singular value: below it a direction is free. It is the sine at which a dyad counts as at its dead point."""
_PART = 1e-3
"""Least entry of a unit vector that counts."""
_STARTS, _STEPS, _POSES = 12, 40, 3
_MOST_UNKNOWNS = 45
"""Of what poses are looked for: more take seconds."""
_CLOSED = 1e-10

Vector = np.ndarray
Entries = tuple[float, float]
Seen = tuple[Vector, Vector]


@dataclass(frozen=True)
class Mobility:
    """Freedoms by rank, and the names of the pairs whose equations say one thing twice, in their order."""

    freedoms: int
    pairs: tuple[str, ...]


@dataclass(frozen=True)
class Loops:
    """The equations of a linkage's pairs in the poses of its bodies.

    Unknowns are x, y and angle of every body but the frame, then the length of every driven cylinder; drives are free.

    Attributes:
        structure: bodies and pairs.
        points: of every pair, one a body, in the body's axes (m); None at a driven cylinder's far end.
        angles: direction of every slider's guide in its body's axes (rad), 0 of pins.
    """

    structure: Structure
    points: tuple[tuple[Entries | None, ...], ...]
    angles: tuple[float, ...]

    @property
    def size(self) -> float:
        """The largest distance of a point from its body's origin (m); 1 where there is none."""
        return max((float(np.hypot(*point)) for ends in self.points for point in ends if point is not None), default=0.0) or 1.0

    @property
    def unknowns(self) -> int:
        """How many there are."""
        return 3 * (len(self.structure.names) - 1) + len(self.structure.bars)

    def equations(self, x: Vector) -> tuple[Vector, Vector]:
        """Residuals [e] (m) and slopes [e, unknowns] by the unknowns, angles times `size`."""
        rows = [row for index in range(len(self.points)) for row in self._pair(index, x)]
        slopes = np.array([slope for _, slope in rows]).reshape(len(rows), self.unknowns)
        return np.array([value for value, _ in rows]), slopes / self._scales

    def mobility(self, x: Vector) -> Mobility:
        """At a pose that closes."""
        slopes = self.equations(x)[1]
        left, values, _ = np.linalg.svd(slopes)
        rank = int((values > _NOTHING * values.max(initial=0.0)).sum())
        twice = np.abs(left[:, rank:]).max(axis=1, initial=0.0) > _PART
        owners = [self.structure.pairs[index].name for index in range(len(self.points)) for _ in self._pair(index, x)]
        names = dict.fromkeys(owner for owner, part in zip(owners, twice, strict=True) if part)
        return Mobility(self.unknowns - rank, tuple(names))

    def poses(self) -> Iterator[Vector]:
        """A few poses that close, from random starts: least squares damped by the residual (Levenberg 1944); none of large linkages."""
        random, found = np.random.default_rng(0), 0
        for _ in range(_STARTS if self.unknowns <= _MOST_UNKNOWNS else 0):
            x = self._closed(random.uniform(-1, 1, self.unknowns) * np.pi * self.size / self._scales)
            if x is not None:
                yield x
                found += 1
                if found == _POSES:
                    return

    def _closed(self, x: Vector) -> Vector | None:
        """The pose that a start leads to, if it closes."""
        for _ in range(_STEPS):
            value, slopes = self.equations(x)
            if np.abs(value).max(initial=0.0) < _CLOSED * self.size:
                return x
            damping = float(value @ value) / self.size**2
            normal = slopes.T @ slopes + min(damping, 1.0) * np.eye(self.unknowns)
            x = x - np.linalg.lstsq(normal, slopes.T @ value, rcond=None)[0] / self._scales
        return None

    @property
    def _scales(self) -> Vector:
        """What makes every unknown a length."""
        bodies = np.tile([1.0, 1.0, self.size], len(self.structure.names) - 1)
        return np.concatenate([bodies, np.ones(len(self.structure.bars))])

    def _pair(self, index: int, x: Vector) -> Iterator[tuple[float, Vector]]:
        pair = self.structure.pairs[index]
        first, *others = [self._seen(body, point, x) for body, point in zip(pair.bodies, self.points[index], strict=True)]
        if pair.kind == "P":
            yield from self._slider(index, x, first, others[0])
            return
        for other in others:
            yield from ((other[0][axis] - first[0][axis], other[1][axis] - first[1][axis]) for axis in range(2))

    def _slider(self, index: int, x: Vector, runner: Seen, start: Seen) -> Iterator[tuple[float, Vector]]:
        """Off the guide, and turned against it."""
        (own, on_runner), (guide, on_guide) = (self._angle(body, x) for body in self.structure.pairs[index].bodies)
        along = guide + self.angles[index]
        ahead, across = np.array([np.cos(along), np.sin(along)]), np.array([-np.sin(along), np.cos(along)])
        span = runner[0] - start[0]
        yield float(across @ span), across @ (runner[1] - start[1]) - (ahead @ span) * on_guide
        yield self.size * float(np.sin(own - guide)), self.size * float(np.cos(own - guide)) * (on_runner - on_guide)

    def _angle(self, body: int, x: Vector) -> tuple[float, Vector]:
        slope = np.zeros(self.unknowns)
        if body == 0:
            return 0.0, slope
        slope[3 * body - 1] = 1
        return float(x[3 * body - 1]), slope

    def _seen(self, body: int, point: Entries | None, x: Vector) -> Seen:
        """A point in the frame's axes [2], and its slopes [2, unknowns]."""
        angle, turning = self._angle(body, x)
        rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        slope = np.zeros((2, self.unknowns))
        if point is None:
            place = 3 * (len(self.structure.names) - 1) + sorted(self.structure.bars).index(body)
            own, slope[:, place] = np.array([x[place], 0.0]), rotation[:, 0]
        else:
            own = np.array(point)
        turned = rotation @ own
        slope += np.outer([-turned[1], turned[0]], turning)
        if body == 0:
            return turned, slope
        slope[0, 3 * body - 3] = slope[1, 3 * body - 2] = 1
        return x[3 * body - 3 : 3 * body - 1] + turned, slope


def loops_of(
    structure: Structure,
    points: Sequence[Sequence[tuple[Scalar, Scalar] | None]],
    angles: Sequence[Scalar],
    number: Callable[[Scalar], Fraction | float | None],
) -> Loops | None:
    """The equations at the parameters' values, which `number` knows; None where one has none."""
    found = [[None if point is None else (number(point[0]), number(point[1])) for point in ends] for ends in points]
    guides = [number(angle) for angle in angles]
    if None in guides or any(None in point for ends in found for point in ends if point is not None):
        return None
    places = tuple(tuple(None if point is None else (_double(point[0]), _double(point[1])) for point in ends) for ends in found)
    return Loops(structure, places, tuple(map(_double, guides)))


def _double(number: Fraction | float | None) -> float:
    assert number is not None
    return float(number)

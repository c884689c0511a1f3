"""Degrees of freedom of a planar linkage by the rank of its pairs' equations at an assembled pose: what counting cannot see."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from walkgen.spec.assur import Structure
from walkgen.spec.pair_equations import PairEquations, Row
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


@dataclass(frozen=True)
class Mobility:
    """Freedoms by rank, and the names of the pairs whose equations say one thing twice, in their order."""

    freedoms: int
    pairs: tuple[str, ...]


@dataclass(frozen=True)
class FreeLinkage:
    """A linkage whose drives are free: the equations of its pairs in the poses of its bodies.

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
        slopes = np.zeros((len(rows), self.unknowns))
        for place, (_, row) in enumerate(rows):
            slopes[place, list(row)] = list(row.values())
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

    def _pair(self, index: int, x: Vector) -> Iterator[tuple[float, Row]]:
        """A pair's equations, a slider's turn as a length."""
        bars = 3 * (len(self.structure.names) - 1)
        equations = PairEquations(self.structure, self.points, self.angles, float, math.cos, math.sin, bars)
        turns = int(self.structure.pairs[index].kind == "P")
        for place, (value, row) in enumerate(equations.rows(x.tolist(), x[bars:].tolist(), index)):
            scale = self.size if place < turns else 1.0
            yield scale * value, {column: scale * slope for column, slope in row.items()}


def free_linkage(
    structure: Structure,
    points: Sequence[Sequence[tuple[Scalar, Scalar] | None]],
    angles: Sequence[Scalar],
    number: Callable[[Scalar], Fraction | float | None],
) -> FreeLinkage | None:
    """The equations at the parameters' values, which `number` knows; None where one has none."""
    found = [[None if point is None else (number(point[0]), number(point[1])) for point in ends] for ends in points]
    guides = [number(angle) for angle in angles]
    if None in guides or any(None in point for ends in found for point in ends if point is not None):
        return None
    places = tuple(tuple(None if point is None else (_double(point[0]), _double(point[1])) for point in ends) for ends in found)
    return FreeLinkage(structure, places, tuple(map(_double, guides)))


def _double(number: Fraction | float | None) -> float:
    assert number is not None
    return float(number)

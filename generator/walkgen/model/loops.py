"""Every pair of a planar linkage as equations in the places of all its bodies: what closes its loops, whatever the order of placement."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from walkgen.model.linkage import Linkage, Point
from walkgen.model.walk import CONTEXT
from walkgen.spec.scalar import evaluate

Row = dict[int, Any]
"""Slopes of an equation: x, y and angle of every body but the frame, then the drives; zeros are left out."""
Planar = tuple[Any, Any]


@dataclass(frozen=True)
class Seen:
    """A point in the frame's axes and the slopes of its two coordinates."""

    at: Planar
    slopes: tuple[Row, Row]

    def minus(self, other: "Seen") -> "Seen":
        """The vector from the other point to this one."""
        x, y = (_less(*rows) for rows in zip(self.slopes, other.slopes, strict=True))
        return Seen((self.at[0] - other.at[0], self.at[1] - other.at[1]), (x, y))


class Loops:
    """A linkage at given drives.

    Args:
        linkage: bodies and pairs.
        values: the runtime parameters' values by name.
        drives: its q.
        real: what numbers are: `float`, or the 50 digits of `CONTEXT.mpf`.
    """

    def __init__(
        self, linkage: Linkage, values: Mapping[str, Any], drives: Sequence[Any], real: Callable[[Any], Any] = CONTEXT.mpf
    ) -> None:
        self.linkage, self.drives, self.real = linkage, [real(drive) for drive in drives], real
        self.size = 3 * (len(linkage.structure.names) - 1)
        self._math: Any = math if real is float else CONTEXT
        self._values, self._bars = values, sorted(linkage.structure.bars)
        self._drive_of = {pair: number for number, pair in enumerate(linkage.driven)}
        self._points = [[None if point is None else self.planar(point) for point in ends] for ends in linkage.points]
        self._angles = [self._number(angle) for angle in linkage.angles]

    def _number(self, scalar: Any) -> Any:
        return self.real(evaluate(scalar, CONTEXT, self._values))

    def planar(self, point: Point) -> Planar:
        """A point of the spec in numbers."""
        return self._number(point[0]), self._number(point[1])

    @property
    def reach(self) -> float:
        """The largest coordinate of any point and the largest drive that is a length."""
        points = [abs(float(entry)) for ends in self._points for point in ends if point for entry in point]
        turning = {number for pair, number in self._drive_of.items() if self.linkage.structure.pairs[pair].kind == "R"}
        lengths = [abs(float(drive)) for number, drive in enumerate(self.drives) if number not in turning]
        return max(*points, *lengths, 1e-3)

    def seen(self, x: Sequence[Any], body: int, point: Planar, stretch: int | None = None) -> Seen:
        """A point of a body; `stretch` is the drive that moves it along the body's x."""
        if body == 0:
            return Seen(point, ({}, {}))
        place = 3 * (body - 1)
        cosine, sine = self._math.cos(x[place + 2]), self._math.sin(x[place + 2])
        across = (cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1])
        slopes: tuple[Row, Row] = ({place: self.real(1), place + 2: -across[1]}, {place + 1: self.real(1), place + 2: across[0]})
        if stretch is not None:
            slopes[0][self.size + stretch], slopes[1][self.size + stretch] = cosine, sine
        return Seen((x[place] + across[0], x[place + 1] + across[1]), slopes)

    def end(self, x: Sequence[Any], pair: int, place: int) -> Seen:
        """The point of a pair on one of its bodies, by the body's place among them."""
        body, point = self.linkage.structure.pairs[pair].bodies[place], self._points[pair][place]
        if point is not None:
            return self.seen(x, body, point)
        drive = len(self.linkage.driven) + self._bars.index(body)
        return self.seen(x, body, (self.drives[drive], self.real(0)), drive)

    def angle(self, x: Sequence[Any], body: int) -> Any:
        """Of a body to the frame."""
        return x[3 * body - 1] if body else self.real(0)

    def guide(self, x: Sequence[Any], pair: int) -> Planar:
        """The direction of a slider's guide in the frame's axes."""
        angle = self.angle(x, self.linkage.structure.pairs[pair].bodies[1]) + self._angles[pair]
        return self._math.cos(angle), self._math.sin(angle)

    def equations(self, x: Sequence[Any]) -> Iterator[tuple[Any, Row]]:
        """As many as there are unknowns: what is 0 where all pairs hold, and its slopes."""
        for index, pair in enumerate(self.linkage.structure.pairs):
            if pair.kind == "P":
                yield from self._slides(x, index)
                continue
            first = self.end(x, index, 0)
            for place in range(1, len(pair.bodies)):
                gap = self.end(x, index, place).minus(first)
                yield from zip(gap.at, gap.slopes, strict=True)
            if index in self._drive_of:
                drive = self._drive_of[index]
                turn, slope = self._turn(x, pair.bodies[0], pair.bodies[1])
                yield turn - self.drives[drive], slope | {self.size + drive: self.real(-1)}

    def _turn(self, x: Sequence[Any], base: int, moved: int) -> tuple[Any, Row]:
        """The second body's angle to the first."""
        slope = {3 * body - 1: self.real(sign) for body, sign in ((base, -1), (moved, 1)) if body}
        return self.angle(x, moved) - self.angle(x, base), slope

    def _slides(self, x: Sequence[Any], index: int) -> Iterator[tuple[Any, Row]]:
        """Not off the guide, not turned to it, and as far along it as its drive says."""
        runner, guide = self.linkage.structure.pairs[index].bodies
        yield self._turn(x, guide, runner)
        away, along = self.end(x, index, 0).minus(self.end(x, index, 1)), self.guide(x, index)
        way, off = _dot(along, away.at), _dot((-along[1], along[0]), away.at)
        turns = {3 * guide - 1: -way} if guide else {}
        yield off, _sum(_scaled(-along[1], away.slopes[0]), _scaled(along[0], away.slopes[1]), turns)
        if index in self._drive_of:
            drive = self._drive_of[index]
            turns = {self.size + drive: self.real(-1)} | ({3 * guide - 1: off} if guide else {})
            yield way - self.drives[drive], _sum(_scaled(along[0], away.slopes[0]), _scaled(along[1], away.slopes[1]), turns)


def _dot(a: Planar, b: Planar) -> Any:
    return a[0] * b[0] + a[1] * b[1]


def _scaled(factor: Any, row: Row) -> Row:
    return {column: factor * slope for column, slope in row.items()}


def _less(row: Row, other: Row) -> Row:
    return _sum(row, _scaled(-1, other))


def _sum(*rows: Row) -> Row:
    total: Row = {}
    for row in rows:
        for column, slope in row.items():
            total[column] = total[column] + slope if column in total else slope
    return total

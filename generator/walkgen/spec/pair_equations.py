"""What every pair of a planar linkage asks of the places of its bodies, drives apart: equations and their slopes, in any kind of number."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from walkgen.spec.assur import Structure

Row = dict[int, Any]
"""Slopes of an equation: x, y and angle of every body but the frame, then what else moves points; zeros are left out."""
Planar = tuple[Any, Any]


@dataclass(frozen=True)
class Seen:
    """A point in the frame's axes and the slopes of its two coordinates."""

    at: Planar
    slopes: tuple[Row, Row]

    def minus(self, other: "Seen") -> "Seen":
        """The vector from the other point to this one."""
        x, y = (_sum(own, _scaled(-1, its)) for own, its in zip(self.slopes, other.slopes, strict=True))
        return Seen((self.at[0] - other.at[0], self.at[1] - other.at[1]), (x, y))


@dataclass(frozen=True)
class PairEquations:
    """Of a linkage with known dimensions.

    Attributes:
        structure: bodies and pairs.
        points: of every pair, one a body, in the body's axes (m); None at a driven cylinder's far end.
        angles: direction of every slider's guide in its body's axes (rad), 0 of pins.
        real: makes a number.
        cos: of such a number.
        sin: likewise.
        lengths: the column of the first driven cylinder's length.
    """

    structure: Structure
    points: Sequence[Sequence[Planar | None]]
    angles: Sequence[Any]
    real: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    lengths: int

    def seen(self, x: Sequence[Any], body: int, point: Planar, stretch: int | None = None) -> Seen:
        """A point of a body; `stretch` is the column of what moves it along the body's x."""
        if body == 0:
            return Seen(point, ({}, {}))
        place = 3 * (body - 1)
        cosine, sine = self.cos(x[place + 2]), self.sin(x[place + 2])
        across = (cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1])
        slopes: tuple[Row, Row] = ({place: self.real(1), place + 2: -across[1]}, {place + 1: self.real(1), place + 2: across[0]})
        if stretch is not None:
            slopes[0][stretch], slopes[1][stretch] = cosine, sine
        return Seen((x[place] + across[0], x[place + 1] + across[1]), slopes)

    def end(self, x: Sequence[Any], bars: Sequence[Any], pair: int, place: int) -> Seen:
        """The point of a pair on one of its bodies, by the body's place among them, for lengths of the driven cylinders."""
        body, point = self.structure.pairs[pair].bodies[place], self.points[pair][place]
        if point is not None:
            return self.seen(x, body, point)
        bar = sorted(self.structure.bars).index(body)
        return self.seen(x, body, (bars[bar], self.real(0)), self.lengths + bar)

    def angle(self, x: Sequence[Any], body: int) -> Any:
        """Of a body to the frame."""
        return x[3 * body - 1] if body else self.real(0)

    def guide(self, x: Sequence[Any], pair: int) -> Planar:
        """The direction of a slider's guide in the frame's axes."""
        angle = self.angle(x, self.structure.pairs[pair].bodies[1]) + self.angles[pair]
        return self.cos(angle), self.sin(angle)

    def turn(self, x: Sequence[Any], base: int, moved: int) -> tuple[Any, Row]:
        """The second body's angle to the first."""
        slope = {3 * body - 1: self.real(sign) for body, sign in ((base, -1), (moved, 1)) if body}
        return self.angle(x, moved) - self.angle(x, base), slope

    def rows(self, x: Sequence[Any], bars: Sequence[Any], pair: int) -> Iterator[tuple[Any, Row]]:
        """What is 0 where a pair holds, and its slopes: gaps between a pin's points, a slider's turn and how far it is off its guide."""
        bodies = self.structure.pairs[pair].bodies
        if self.structure.pairs[pair].kind == "P":
            yield self.turn(x, bodies[1], bodies[0])
            yield self.along(x, bars, pair)[1]
            return
        first = self.end(x, bars, pair, 0)
        for place in range(1, len(bodies)):
            gap = self.end(x, bars, pair, place).minus(first)
            yield from zip(gap.at, gap.slopes, strict=True)

    def along(self, x: Sequence[Any], bars: Sequence[Any], pair: int) -> tuple[tuple[Any, Row], tuple[Any, Row]]:
        """How far a slider is along its guide and off it, each with its slopes."""
        away, ahead = self.end(x, bars, pair, 0).minus(self.end(x, bars, pair, 1)), self.guide(x, pair)
        guide = self.structure.pairs[pair].bodies[1]
        way, off = _dot(ahead, away.at), _dot((-ahead[1], ahead[0]), away.at)
        turns: tuple[Row, Row] = ({3 * guide - 1: off}, {3 * guide - 1: -way}) if guide else ({}, {})
        slopes = _sum(_scaled(ahead[0], away.slopes[0]), _scaled(ahead[1], away.slopes[1]), turns[0])
        across = _sum(_scaled(-ahead[1], away.slopes[0]), _scaled(ahead[0], away.slopes[1]), turns[1])
        return (way, slopes), (off, across)


def _dot(a: Planar, b: Planar) -> Any:
    return a[0] * b[0] + a[1] * b[1]


def _scaled(factor: Any, row: Row) -> Row:
    return {column: factor * slope for column, slope in row.items()}


def _sum(*rows: Row) -> Row:
    total: Row = {}
    for row in rows:
        for column, slope in row.items():
            total[column] = total[column] + slope if column in total else slope
    return total

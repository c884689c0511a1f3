"""Coordinates in a linkage's plane, lengths and angles, with their slopes and curvatures by the drives."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.symbolic.planar import Planar, angle_of
from walkgen.symbolic.tangents import tangents
from walkgen.symbolic.tape import Tape, dot

Exprs = Sequence[sympy.Expr]


@dataclass(frozen=True)
class Coordinate:
    """A length, or where `rotor` is given the angle whose cosine and sine it holds."""

    name: str
    length: sympy.Expr = sympy.S.Zero
    rotor: Planar | None = None

    @property
    def value(self) -> sympy.Expr:
        """In m or rad."""
        return self.length if self.rotor is None else angle_of(self.rotor)


class PlanarMotion:
    """What coordinates do when the drives move."""

    def __init__(self, tape: Tape, drives: Sequence[sympy.Symbol], coordinates: Sequence[Coordinate]) -> None:
        self._tape, self._coordinates = tape, coordinates
        self._named = [(f"drive_{number}", symbol) for number, symbol in enumerate(drives, 1)]

    def on(self, tape: Tape) -> "PlanarMotion":
        """The same, written on a tape that began as this one's."""
        return PlanarMotion(tape, [symbol for _, symbol in self._named], self._coordinates)

    @cached_property
    def slopes(self) -> tuple[tuple[sympy.Expr, ...], ...]:
        """Of every coordinate (rows) by the drives; an angle's is c ds - s dc."""
        parts = [part for c in self._coordinates for part in ((c.length,) if c.rotor is None else c.rotor)]
        found = iter(tangents(self._tape, parts, self._named))
        return tuple(self._slope(coordinate, [next(found) for _ in coordinate.rotor or (0,)]) for coordinate in self._coordinates)

    def _slope(self, coordinate: Coordinate, rows: Sequence[Exprs]) -> tuple[sympy.Expr, ...]:
        row = rows[0]
        if coordinate.rotor is not None:
            cosine, sine = coordinate.rotor
            row = [cosine * ds - sine * dc for dc, ds in zip(*rows, strict=True)]
        return tuple(self._tape.let(f"{coordinate.name}_d_{label}", slope) for (label, _), slope in zip(self._named, row, strict=True))

    @cached_property
    def bends(self) -> tuple[tuple[tuple[sympy.Expr, ...], ...], ...]:
        """Second derivatives of every coordinate by two drives."""
        flat = [slope for row in self.slopes for slope in row]
        rows, count = tangents(self._tape, flat, self._named), len(self._named)
        return tuple(tuple(tuple(row) for row in rows[count * place : count * (place + 1)]) for place in range(len(self._coordinates)))

    def rates(self, rates: Exprs) -> tuple[sympy.Expr, ...]:
        """Of the coordinates, for the drives' rates."""
        return tuple(self._tape.let(f"{c.name}_rate", dot(row, rates)) for c, row in zip(self._coordinates, self.slopes, strict=True))

    def curved(self, rates: Exprs) -> tuple[sympy.Expr, ...]:
        """Accelerations of the coordinates while the drives' rates are constant."""
        columns = tangents(self._tape, self.rates(rates), self._named)
        return tuple(self._tape.let(f"{c.name}_curve", dot(row, rates)) for c, row in zip(self._coordinates, columns, strict=True))

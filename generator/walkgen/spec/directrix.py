"""What a directrix is, whichever way it is given: pieces whose x and y are expressions in lambda, with derivatives at any point of them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from walkgen.spec.curved_sole import CurvedSoleSpec, DirectrixSpec
from walkgen.spec.scalar import (
    CURVE_PARAMETER,
    ONE,
    ZERO,
    Exact,
    Name,
    Pi,
    Scalar,
    add,
    apply,
    div,
    evaluate,
    exact,
    mul,
    power,
    sub,
    total,
)
from walkgen.spec.spline import Segment, quintic
from walkgen.spec.taylor import ORDER, Arithmetic, Field, Taylor, constant, variable

LAMBDA = Name(CURVE_PARAMETER)
Number = Callable[[Scalar], float]
"""The value of a scalar at the parameters' values."""
AHEAD = {"toe": 1, "heel": -1}
"""Which way along y a curve begins."""


@dataclass(frozen=True)
class Piece:
    """x and y in lambda (m), from `start` to `end`."""

    x: Scalar
    y: Scalar
    start: Scalar
    end: Scalar


def pieces_of(sole: CurvedSoleSpec, which: str, number: Number) -> tuple[Piece, ...]:
    """Of a curve that is given in one complete way, along its lambda; none where the sole has no such curve.

    Raises:
        ValueError: two points next to each other are one.
    """
    given: DirectrixSpec | None = getattr(sole, which)
    if given is None:
        return ()
    edge = (sole.si("depth"), sole.si("flat")[1 if which == "toe" else 0])
    if given.points is not None:
        corners = [(number(x), number(y)) for x, y in (edge, *given.points)]
        return tuple(_segment(segment) for segment in quintic(corners, (0.0, float(AHEAD[which]))))
    return (_whole(given, edge, AHEAD[which]),)


def _whole(given: DirectrixSpec, edge: tuple[Scalar, Scalar], ahead: int) -> Piece:
    """In one piece; a polynomial and an ellipse leave the flat part along it."""
    depth, side = edge
    if given.polynomial is not None:
        rise = total(mul(c, power(LAMBDA, exact(order))) for order, c in enumerate(given.polynomial, 2))
        return Piece(sub(depth, rise), _beside(side, ahead, LAMBDA), ZERO, given.si("end") or ZERO)
    if given.ellipse is not None:
        along, across = given.ellipse
        x = sub(depth, mul(across, sub(ONE, apply("cos", LAMBDA))))
        return Piece(x, _beside(side, ahead, mul(along, apply("sin", LAMBDA))), ZERO, given.si("end") or div(Pi(), exact(2)))
    assert given.x is not None
    assert given.y is not None
    return Piece(given.x, given.y, given.start or ZERO, given.si("end"))


def _beside(side: Scalar, ahead: int, away: Scalar) -> Scalar:
    return add(side, away) if ahead > 0 else sub(side, away)


def _segment(segment: Segment) -> Piece:
    """A polynomial in lambda - start, as nested products."""
    start, end = (Exact(Fraction(value)) for value in (segment.start, segment.end))
    here = sub(LAMBDA, start)
    return Piece(_nested(segment.x, here), _nested(segment.y, here), start, end)


def _nested(coefficients: Sequence[float], here: Scalar) -> Scalar:
    found: Scalar = ZERO
    for entry in reversed(coefficients):
        found = add(mul(found, here), Exact(Fraction(entry)))
    return found


@dataclass(frozen=True)
class Jet:
    """x and y with derivatives by lambda, the value first."""

    x: tuple[Any, ...]
    y: tuple[Any, ...]

    @property
    def speed(self) -> float:
        """|r'|."""
        return math.hypot(self.x[1], self.y[1])

    @property
    def turning(self) -> float:
        """phi3' |r'|^2 = x'' y' - x' y''."""
        return float(self.x[2] * self.y[1] - self.x[1] * self.y[2])


def series(piece: Piece, at: Any, field: Field, values: Mapping[str, Any], order: int = ORDER) -> tuple[Taylor, Taylor]:
    """x and y about a point to some order, in the numbers of a field; `values` are those of the runtime parameters."""
    known = {name: constant(field, value, order + 1) for name, value in values.items()}
    known[CURVE_PARAMETER] = variable(field, at, order + 1)
    x, y = (evaluate(scalar, Arithmetic(field, order + 1), known) for scalar in (piece.x, piece.y))
    return x, y


_DOUBLES = Field(float, math.pi, math.sqrt, math.sin, math.cos, math.atan2)


def jet(piece: Piece, at: float, values: Mapping[str, Any]) -> Jet:
    """In doubles.

    Raises:
        ArithmeticError, ValueError: the curve has no value there.
    """
    x, y = series(piece, at, _DOUBLES, values)
    return Jet(x.derivatives, y.derivatives)

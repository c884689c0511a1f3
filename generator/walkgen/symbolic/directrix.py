"""A directrix on a tape at its parameter: the curve with three derivatives, its arc length, the foot's angle where it touches the ground.

Theory 8.3: everything of a rolling foot is a function of lambda. Toe and heel differ by the way they go along the ground: `ahead`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.spec.directrix import AHEAD, series
from walkgen.spec.spline import DEGREE
from walkgen.spec.taylor import ORDER, Field, Taylor, variable
from walkgen.symbolic.arc_length import length, node_count, nodes
from walkgen.symbolic.choices import less
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Angle, Select
from walkgen.symbolic.rolling_leg import Planar, RollingLeg
from walkgen.symbolic.tape import DIGITS, Tape

_HALF = sympy.Rational(1, 2)


def rotated(cosine: sympy.Expr, sine: sympy.Expr, vector: Planar) -> Planar:
    """R(angle) v."""
    x, y = vector
    return cosine * x - sine * y, sine * x + cosine * y


def quarter(factor: sympy.Expr, vector: Planar) -> Planar:
    """factor * z x v."""
    return -factor * vector[1], factor * vector[0]


@dataclass(frozen=True)
class _Part:
    """The piece of a curve that holds a parameter: where it starts, how long the curve is up to there, polynomials of its x and y."""

    start: sympy.Expr
    before: sympy.Expr
    x: tuple[sympy.Expr, ...]
    y: tuple[sympy.Expr, ...]


class Directrix:
    """One curve of a leg's sole at one parameter; intermediates go onto the tape."""

    def __init__(self, mechanism: Mechanism, leg: RollingLeg, which: str, at: sympy.Expr, tape: Tape) -> None:
        self._mechanism, self._leg, self._at, self.tape = mechanism, leg, at, tape
        self._pieces = leg.sole.curves()[which]
        self.ahead = AHEAD[which]
        self._parameters: Mapping[str, sympy.Expr] = parameter_symbols(mechanism)

    @property
    def bounds(self) -> Planar:
        """Least and largest parameter."""
        start, end = (expression(scalar, self._parameters) for scalar in (self._pieces[0].start, self._pieces[-1].end))
        return self.tape.let("start", start), self.tape.let("end", end)

    # ---- the curve in the foot's axes, from the ankle

    @cached_property
    def _jets(self) -> tuple[tuple[sympy.Expr, ...], tuple[sympy.Expr, ...]]:
        x, y = self._series(self._at, ORDER)
        return x.derivatives, y.derivatives

    def _series(self, at: sympy.Expr, order: int) -> tuple[Taylor, Taylor]:
        if len(self._pieces) == 1:
            return series(self._pieces[0], at, self._field, self._parameters, order)
        here = variable(self._field, self.tape.let("along", at - self._part.start), order + 1)
        x, y = (_nested(here, coefficients) for coefficients in (self._part.x, self._part.y))
        return x, y

    @cached_property
    def _field(self) -> Field:
        let = self.tape.let
        return Field(
            sympy.sympify,
            sympy.pi,
            lambda a: let("root", sympy.sqrt(a)),
            lambda a: let("sin_lambda", sympy.sin(a)),
            lambda a: let("cos_lambda", sympy.cos(a)),
            lambda y, x: let("angle", Angle(y, x)),
            lambda entry: let("curve", sympy.sympify(entry)),
        )

    @cached_property
    def _part(self) -> _Part:
        """Of a spline: chosen by the parameter."""
        parts = [self._whole(number) for number in range(len(self._pieces))]
        found = parts[0]
        for part in parts[1:]:
            found = self._chosen(part, found)
        return found

    def _whole(self, number: int) -> _Part:
        """One piece: its Taylor polynomial about its start is all of it."""
        exact = Field(sympy.sympify, sympy.pi, sympy.sqrt, sympy.sin, sympy.cos, sympy.atan2)
        piece = self._pieces[number]
        start = expression(piece.start, {})
        x, y = series(piece, start, exact, {}, DEGREE)
        before = sympy.Add(*(_number(length(self._mechanism, earlier)) for earlier in self._pieces[:number]))
        return _Part(start, before, x.c, y.c)

    def _chosen(self, part: _Part, other: _Part) -> _Part:
        def choose(name: str, then: sympy.Expr, otherwise: sympy.Expr) -> sympy.Expr:
            return self.tape.let(name, Select(less(self._at, part.start), otherwise, then))

        x, y = (tuple(choose("c", a, b) for a, b in zip(new, old, strict=True)) for new, old in ((part.x, other.x), (part.y, other.y)))
        return _Part(choose("knot", part.start, other.start), choose("rolled", part.before, other.before), x, y)

    @property
    def point(self) -> Planar:
        """r: the point of the curve, from the ankle (m)."""
        x, y = self._leg.foot
        return self.tape.let("x3", x + self._jets[0][0]), self.tape.let("y3", y + self._jets[1][0])

    def _slope(self, order: int) -> Planar:
        x, y = self._jets
        return self.tape.let(f"x3_{order}", x[order]), self.tape.let(f"y3_{order}", y[order])

    # ---- arc length

    @cached_property
    def speed(self) -> sympy.Expr:
        """sigma' = |r'|."""
        x, y = self._slope(1)
        return self.tape.let("speed", sympy.sqrt(self._square)) if x != 0 else abs(y)

    @cached_property
    def _square(self) -> sympy.Expr:
        x, y = self._slope(1)
        return self.tape.let("speed2", x**2 + y**2)

    @cached_property
    def stretching(self) -> sympy.Expr:
        """sigma'' = r' r'' / sigma'."""
        (x1, y1), (x2, y2) = self._slope(1), self._slope(2)
        return self.tape.let("stretching", (x1 * x2 + y1 * y2) / self.speed)

    @cached_property
    def rolled(self) -> sympy.Expr:
        """s: the arc length from the edge of the flat part on (m)."""
        start, before = (self.bounds[0], sympy.S.Zero) if len(self._pieces) == 1 else (self._part.start, self._part.before)
        half = self.tape.let("half", _HALF * (self._at - start))
        middle = self.tape.let("middle", start + half)
        rule = ((_number(place), _number(weight)) for place, weight in nodes(node_count(self._mechanism, self._pieces)))
        terms = [weight * self._speed_at(middle + place * half) for place, weight in rule]
        return self.tape.let("rolled", before + half * sympy.Add(*terms))

    def _speed_at(self, at: sympy.Expr) -> sympy.Expr:
        x, y = self._series(self.tape.let("node", at), 1)
        return self.tape.let("node_speed", sympy.sqrt(x.c[1] ** 2 + y.c[1] ** 2))

    # ---- the foot where the curve touches the ground

    @cached_property
    def rotor(self) -> Planar:
        """cos and sin of the foot's angle: the curve's direction lies along the ground."""
        x, y = self._slope(1)
        return self.tape.let("cos_foot", self.ahead * x / self.speed), self.tape.let("sin_foot", -self.ahead * y / self.speed)

    @property
    def angle(self) -> sympy.Expr:
        """phi3 = atan2(-y3', x3') (theory 8.3, erratum 8.4)."""
        x, y = self._slope(1)
        return self.tape.let("foot_angle", Angle(-self.ahead * y, self.ahead * x))

    @cached_property
    def turning(self) -> sympy.Expr:
        """phi3' = n / sigma'^2, n = x3'' y3' - x3' y3''."""
        return self.tape.let("turning", self._bend / self._square)

    @cached_property
    def _bend(self) -> sympy.Expr:
        (x1, y1), (x2, y2) = self._slope(1), self._slope(2)
        return self.tape.let("bend", x2 * y1 - x1 * y2)

    @cached_property
    def turning_rate(self) -> sympy.Expr:
        """phi3'' = (x3''' y3' - x3' y3''') / sigma'^2 - 2 n sigma'' / sigma'^3."""
        (x1, y1), (x3, y3) = self._slope(1), self._slope(3)
        change = self.tape.let("bend_change", x3 * y1 - x1 * y3)
        return self.tape.let("turning_rate", (change - 2 * self._bend * self.stretching / self.speed) / self._square)

    @cached_property
    def lever(self) -> Planar:
        """C - P: from the contact point to the ankle."""
        x, y = rotated(*self.rotor, self.point)
        return self.tape.let("lever_x", -x), self.tape.let("lever_y", -y)

    def contact_point(self, edge: sympy.Expr) -> Planar:
        """P on the ground."""
        return self.tape.let("contact_x", edge + self.ahead * self.rolled), sympy.S.Zero

    def ankle(self, edge: sympy.Expr) -> Planar:
        """C = P - R(phi3) r."""
        x, y = self.lever
        return self.tape.let("rolled_ankle_x", self.contact_point(edge)[0] + x), y

    @cached_property
    def ankle_slope(self) -> Planar:
        """C' = phi3' z x (C - P): P is the instantaneous centre."""
        x, y = quarter(self.turning, self.lever)
        return self.tape.let("ankle_slope_x", x), self.tape.let("ankle_slope_y", y)

    @cached_property
    def ankle_bend(self) -> Planar:
        """C'' = phi3'' z x (C - P) + phi3' z x (C' - (sigma', 0))."""
        x, y = quarter(self.turning_rate, self.lever)
        ahead_x, ahead_y = quarter(self.turning, (self.ankle_slope[0] - self.ahead * self.speed, self.ankle_slope[1]))
        return self.tape.let("ankle_bend_x", x + ahead_x), self.tape.let("ankle_bend_y", y + ahead_y)

    def tangency(self, cosine: sympy.Expr, sine: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
        """x3' sin(phi3) + y3' cos(phi3), which is 0 where the foot at an angle touches level ground, its slope, its size."""
        (x1, y1), (x2, y2) = self._slope(1), self._slope(2)
        return x1 * sine + y1 * cosine, x2 * sine + y2 * cosine, self.speed


def _number(value: Any) -> sympy.Expr:
    return sympy.Float(str(value), DIGITS)


def _nested(here: Taylor, coefficients: Sequence[sympy.Expr]) -> Taylor:
    found = here.constant(0)
    for entry in reversed(coefficients):
        found = found * here + here.constant(entry)
    return found

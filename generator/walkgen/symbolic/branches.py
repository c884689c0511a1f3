"""The closed form of a yaw-pitch-pitch leg, step by step: canonical target, rho, sheets, knee, joint values (theory 3.2)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import STATUSES
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Angle, Both, Either, Epsilon, Finite, Indicator, Less, LessEqual, Opposite, Residue, Same, Select
from walkgen.symbolic.geometry import Geometry, geometry
from walkgen.symbolic.tape import Tape, Vec, constant, dot, minus

_NAMES = ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE", "DUPLICATE", "INFEASIBLE")
OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, DUPLICATE, INFEASIBLE = (sympy.Integer(STATUSES.index(name)) for name in _NAMES)
_TOLERANCE = sympy.Rational(1, 10**12)
_PI = constant(sympy.pi)
_FALSE = sympy.false

_KNEES = ((1, "plus"), (-1, "minus"))

Row = tuple[tuple[sympy.Expr, sympy.Expr, sympy.Expr], sympy.Expr]
"""Three joint values and a status."""


@dataclass(frozen=True)
class Knee:
    """The knee triangle: 1 + cos, cos and sin (positive) of the knee angle, whether 1 + cos had to be brought into [0, 2], out of reach,
    foot on the hip with a folded knee.
    """

    opening: sympy.Expr
    cosine: sympy.Expr
    sine: sympy.Expr
    clamped: sympy.Basic
    outside: sympy.Expr
    collapsed: sympy.Expr


class Branches:
    """The steps of the closed form on one tape: canonical target, rho, sheets, knee, joint values."""

    def __init__(self, mechanism: Mechanism, leg: Limb, p: Sequence[sympy.Expr], index: sympy.Expr = sympy.S.Zero) -> None:
        self.tape = Tape()
        self._p, self._index = p, index
        self._parameters = parameter_symbols(mechanism)
        self._geometry: Geometry = geometry(leg, self._parameters, self.tape)

    @cached_property
    def _taint(self) -> sympy.Expr:
        """0 for finite inputs and a known branch, NaN otherwise: it poisons every angle and decides BAD_INPUT."""
        valid = Both(LessEqual(0, self._index), LessEqual(self._index, 3))
        bones = () if self._knee_scale.is_number else (self._knee_scale,)  # infinite where a runtime parameter leaves out a bone
        stray = sympy.S.Zero if self._index == 0 else Select(valid, 0, sympy.sqrt(-1 - self._index**2))
        return self.tape.let("taint", sympy.Add(*(Residue(x) for x in (*self._p, *self._parameters.values(), *bones))) + stray)

    @cached_property
    def _knee_scale(self) -> sympy.Expr:
        return self.tape.let("knee_scale", 1 / (2 * self._geometry.a2 * self._geometry.l3))

    @cached_property
    def target(self) -> Vec:
        """The target in the canonical frame, height counted from the hip."""
        x, y, z = self._p
        offset = self.tape.vector("offset", minus((x, y, z), self._geometry.origin))
        return self.tape.vector("target", [dot(axis, offset) for axis in self._geometry.axes])

    @cached_property
    def _distance2(self) -> sympy.Expr:
        x, y, _ = self.target
        return self.tape.let("radius2", x**2 + y**2)

    @cached_property
    def _reach(self) -> sympy.Expr:
        g = self._geometry
        return abs(g.a1) + g.a2 + g.l3 + abs(g.w)

    @cached_property
    def _tolerance(self) -> sympy.Expr:
        """1e-12 of the reach, or what rounding leaves of it in single precision."""
        roundoff = 8 * self.tape.let("epsilon", Epsilon())
        return self.tape.let("tolerance", Select(Less(_TOLERANCE, roundoff), roundoff, _TOLERANCE))

    @cached_property
    def _touching2(self) -> sympy.Expr:
        """The square of a distance that counts as none: 1e-12 of the reach."""
        return self.tape.let("touching2", (self._tolerance * self._reach) ** 2)

    @cached_property
    def _rho2(self) -> sympy.Expr:
        return self.tape.let("rho2", self._distance2 - self._geometry.w**2)

    @cached_property
    def rho(self) -> sympy.Expr:
        """|rho|, 0 where the target is on axis 1 or inside the hip cylinder."""
        return self.tape.let("rho", Select(self.on_axis, 0, self.tape.let("radius", sympy.sqrt(self._inside2))))

    @cached_property
    def _inside2(self) -> sympy.Expr:
        """rho^2, not below 0."""
        return self._distance2 if self._geometry.w == 0 else self.tape.let("rho2_clamped", Select(Less(self._rho2, 0), 0, self._rho2))

    @cached_property
    def inside_cylinder(self) -> sympy.Expr:
        """Whether the target is nearer to axis 1 than the leg plane's offset, by more than 1e-12 of the reach."""
        if self._geometry.w == 0:
            return _FALSE
        slack = self.tape.let("cylinder_slack", -2 * abs(self._geometry.w) * self._tolerance * self._reach)
        return Less(self._rho2, slack)

    @cached_property
    def on_axis(self) -> sympy.Expr:
        """Whether the target lies on axis 1, to 1e-12 of the reach, and the leg plane holds it: any yaw will do."""
        w = self._geometry.w
        return _FALSE if w.is_number and w != 0 else LessEqual(self._distance2 + w**2, self._touching2)

    @cached_property
    def bad(self) -> sympy.Expr:
        """Whether the target is not finite, or the branch unknown."""
        return Opposite(Finite(self._taint))

    def yaw(self, rho: sympy.Expr, sign: sympy.Expr, name: str, usual: sympy.Basic) -> sympy.Expr:
        """q1 of the sheet with this signed rho; the target turned back by the leg plane's own angle."""
        return self._yaw_of(Angle(*self._yaw_direction(rho, sign, name)), name, usual)

    def _yaw_direction(self, rho: sympy.Expr, sign: sympy.Expr, name: str) -> tuple[sympy.Expr, sympy.Expr]:
        x, y, _ = self.target
        w, turn = self._geometry.w, self._geometry.sign1
        if w == 0:
            return turn * sign * y, sign * x
        sine = self.tape.let(f"yaw_{name}_sin", y * rho + x * w)
        return turn * sine, self.tape.let(f"yaw_{name}_cos", x * rho - y * w)

    def _yaw_of(self, angle: sympy.Expr, name: str, usual: sympy.Basic) -> sympy.Expr:
        """Any yaw will do where the target lies on the axis."""
        name = f"yaw_{name}"
        return self._poisoned(Select(self.on_axis, 0, self.half_open(angle, name)), name, usual)

    def _opposite_yaw(self, usual: sympy.Basic) -> sympy.Expr:
        """The other sheet's yaw where w = 0: half a turn away."""
        ahead = self.tape.let("yaw_plus_angle", Angle(*self._yaw_direction(self.rho, sympy.S.One, "plus")))
        return self._yaw_of(ahead + Select(LessEqual(ahead, 0), _PI, -_PI), "minus", usual)

    def half_open(self, angle: sympy.Expr, name: str) -> sympy.Expr:
        """-pi becomes pi: angles live in (-pi, pi]."""
        angle = self.tape.let(f"{name}_angle", angle)
        return self.tape.let(f"{name}_half_open", Select(LessEqual(angle, -_PI), _PI, angle))

    def wrapped(self, angle: sympy.Expr, name: str) -> sympy.Expr:
        """An angle within two turns brought into (-pi, pi]."""
        angle = self.tape.let(f"{name}_sum", angle)
        turns = self.tape.let(f"{name}_turns", Indicator(Less(_PI, angle)) - Indicator(LessEqual(angle, -_PI)))
        return self.tape.let(f"{name}_wrapped", angle - 2 * _PI * turns)

    def knee(self, X: sympy.Expr, name: str) -> Knee:
        """The knee triangle over the hip-foot vector (X, z).

        1 + cos is computed, not cos: it keeps its digits where the leg folds, and so does the foot's distance from the hip.
        """
        g, z = self._geometry, self.target[2]
        across2 = self._inside2 if g.a1 == 0 else X**2  # no need to wait for the root
        hypotenuse2 = self.tape.let(f"distance2_{name}", across2 + z**2)
        bones, longest = self.tape.let("bones", abs(g.a2 - g.l3)), self.tape.let("longest", g.a2 + g.l3)
        slack = self.tape.let("slack", 2 * self._tolerance * self._reach)
        outer2, inner2 = self.tape.let("outer2", longest * (longest + slack)), self.tape.let("inner2", bones * (bones - slack))
        outside = Either(Less(outer2, hypotenuse2), Less(hypotenuse2, inner2))
        collapsed = _FALSE if bones.is_number and bones != 0 else LessEqual(hypotenuse2, self._touching2)
        versine = self.tape.let(f"knee_{name}", (hypotenuse2 - bones**2) * self._knee_scale)
        stretched, folded = Less(2, versine), Either(Less(versine, 0), collapsed)
        opening = self.tape.let(f"knee_{name}_clamped", Select(stretched, 2, Select(folded, 0, versine)))
        sine = self.tape.let(f"knee_sin_{name}", sympy.sqrt(opening * (2 - opening)))
        cosine = self.tape.let(f"knee_cos_{name}", opening - 1)
        return Knee(opening, cosine, sine, Either(stretched, folded), outside, collapsed)

    def _from_zero(self, sine: sympy.Expr, cosine: sympy.Expr, name: str) -> tuple[sympy.Expr, sympy.Expr]:
        zero, turn = self._geometry.zero2, self._geometry.sign2
        if zero == 0:
            return turn * sine, cosine
        c, s = (self.tape.let(f"thigh_zero_{word}", function(zero)) for word, function in (("cos", sympy.cos), ("sin", sympy.sin)))
        return turn * self.tape.let(f"lift_{name}_sin", sine * c - cosine * s), self.tape.let(f"lift_{name}_cos", cosine * c + sine * s)

    def thigh(self, X: sympy.Expr, knee: Knee, sign: int, name: str, usual: sympy.Basic) -> sympy.Expr:
        """q2 in [-pi, pi]: the hip-foot vector's direction less the thigh's angle to it, on the knee's side."""
        along, across = self._shank(knee, knee.sine)
        z = self.target[2]
        sine = self.tape.let(f"thigh_{name}_sin", z * along - sign * (X * across))
        cosine = self.tape.let(f"thigh_{name}_cos", X * along + sign * (z * across))
        return self._poisoned(Angle(*self._from_zero(sine, cosine, f"lift_{name}")), f"thigh_{name}", usual)

    def _shank(self, knee: Knee, sine: sympy.Expr) -> tuple[sympy.Expr, sympy.Expr]:
        """The foot seen from the hip: along the thigh and across it."""
        g = self._geometry
        return self.tape.let("along", g.a2 + g.l3 * knee.cosine), self.tape.let("across", g.l3 * sine)

    def knee_value(self, gamma: sympy.Expr, name: str, reaches_minus_pi: bool, usual: sympy.Basic) -> sympy.Expr:
        """q3 of a knee angle within [-pi, pi]; that of a usual one, which is bent, is not -pi."""
        g = self._geometry
        value = g.sign3 * (gamma - g.zero3)
        if g.zero3 != 0:
            return self.wrapped(value, f"q3_{name}")
        return Select(usual, value, self.half_open(value, f"q3_{name}")) if reaches_minus_pi else value

    def status(self, outside: sympy.Expr, duplicate: sympy.Expr, singular: sympy.Expr, bad: sympy.Expr) -> sympy.Expr:
        """The first that applies: BAD_INPUT, UNREACHABLE, DUPLICATE, SINGULAR, OK."""
        reachable = Select(duplicate, DUPLICATE, Select(singular, SINGULAR, OK))
        return Select(bad, BAD_INPUT, Select(Either(self.inside_cylinder, outside), UNREACHABLE, reachable))

    def all_rows(self) -> list[Row]:
        """Rows and statuses in the fixed order."""
        rho, g = self.rho, self._geometry
        X, X_minus = self._ahead(rho, "X_plus"), self._ahead(-rho, "X_minus")
        knee = self.knee(X, "plus")
        far = knee if g.a1 == 0 else self.knee(X_minus, "minus")
        usual = self._usual(knee) if g.a1 == 0 else _FALSE  # with a shoulder ordinary targets are out of the other sheet's reach
        thighs = [self.thigh(X, knee, sign, f"plus_{word}", usual) for sign, word in _KNEES]
        if g.a1 == 0 and g.zero2 == 0:  # mirror images, of the other knee
            others = [Select(Less(thigh, 0), -_PI, _PI) - thigh for thigh in reversed(thighs)]
        else:
            others = [self.thigh(X_minus, far, sign, f"minus_{word}", usual) for sign, word in _KNEES]
        yaw = self.yaw(rho, sympy.S.One, "plus", usual)
        other = self._opposite_yaw(usual) if g.w == 0 else self.yaw(-rho, -sympy.S.One, "minus", usual)
        near = self._sheet(yaw, thighs, knee, "plus", _FALSE, usual)
        return [*near, *self._sheet(other, others, far, "minus", Same(rho, 0), usual)]

    def _ahead(self, rho: sympy.Expr, name: str) -> sympy.Expr:
        """The foot's place seen from the hip, along the leg plane."""
        return self.tape.let(name, rho - self._geometry.a1)

    def _sheet(
        self, yaw: sympy.Expr, thighs: Sequence[sympy.Expr], knee: Knee, name: str, repeated: sympy.Expr, usual: sympy.Basic
    ) -> list[Row]:
        gamma = self._poisoned(Angle(knee.sine, knee.cosine), f"gamma_{name}", usual)
        singular = Either(self.on_axis, knee.collapsed)
        straight = Either(repeated, Same(knee.sine, 0))
        missed = self.tape.let("missed", Select(self.bad, BAD_INPUT, Select(Either(self.inside_cylinder, knee.outside), UNREACHABLE, OK)))
        rows: list[Row] = []
        for (sign, word), thigh, duplicate in zip(_KNEES, thighs, (repeated, straight), strict=True):
            bent = self.knee_value(sign * gamma, f"{name}_{word}", sign != self._geometry.sign3, usual)
            values = (yaw, self._free(thigh, knee, f"{name}_{word}"), bent)
            reached = Select(duplicate, DUPLICATE, Select(singular, SINGULAR, OK))
            rows.append((values, Select(usual, OK, Select(Same(missed, OK), reached, missed))))
        return rows

    def _free(self, thigh: sympy.Expr, knee: Knee, name: str) -> sympy.Expr:
        """q2 in (-pi, pi]; 0 where any thigh will do."""
        return Select(knee.collapsed, self._taint, self.half_open(thigh, f"q2_{name}"))

    def _poisoned(self, angle: sympy.Expr, name: str, usual: sympy.Basic) -> sympy.Expr:
        """The angle, NaN for a bad input, which no usual one is; a difference keeps the sign of -0."""
        angle = self.tape.let(name, angle)
        return self.tape.let(f"{name}_checked", Select(usual, angle, angle - self._taint))

    def one_row(self) -> Row:
        """The branch with this index, by signs instead of choices; what decides for usual targets comes first and is enough."""
        g, index, z = self._geometry, self._index, self.target[2]
        rho_sign = self.tape.let("rho_sign", 1 - 2 * Indicator(LessEqual(2, index)))
        knee_sign = self.tape.let("knee_sign", 1 - 2 * Indicator(Either(Same(index, 1), Same(index, 3))))
        rho = self.tape.let("rho_signed", rho_sign * self.rho)
        X = self._ahead(rho, "X")
        knee = self.knee(X, "plus")
        usual = self._usual(knee)
        sine = self.tape.let("knee_sin", knee_sign * knee.sine)
        along, across = self._shank(knee, sine)
        opposite, adjacent = self.tape.let("thigh_sin", z * along - X * across), self.tape.let("thigh_cos", X * along + z * across)
        straight = Both(Same(knee.sine, 0), Less(knee_sign, 0))
        duplicate = Either(straight, Both(Same(self.rho, 0), Less(rho_sign, 0)))
        singular = Either(self.on_axis, knee.collapsed)
        unusual = self.tape.let("unusual_state", self.status(knee.outside, duplicate, singular, self.bad))
        status = self.tape.let("state", Select(usual, OK, unusual))
        yaw = self.yaw(rho, rho_sign, "one", usual)
        side = Select(usual, sine, Select(Same(knee.opening, 0), g.sign3, sine))  # of a folded knee, which has none
        half = Angle(side, sympy.Abs(knee.opening))  # at most a right angle: no half planes to tell
        gamma = self.tape.let("gamma", 2 * half)
        thigh = self._poisoned(Angle(*self._from_zero(opposite, adjacent, "thigh")), "thigh", usual)
        last = self.knee_value(self._poisoned(gamma, "gamma", usual), "one", False, usual)
        return (yaw, self._free(thigh, knee, "one"), last), status

    def _usual(self, knee: Knee) -> sympy.Basic:
        """Enough for OK: a known branch, a knee neither straight nor folded by the tolerance, and a foot away from axis 1.

        What is not finite leaves no such knee; nor, but for a runtime parameter, does what is out of reach.
        """
        parts = [] if self._index == 0 else [Both(LessEqual(0, self._index), LessEqual(self._index, 3))]
        parts += [Less(self._tolerance, knee.sine)]
        parts += [Opposite(truth) for truth in (knee.clamped, self.on_axis) if truth != _FALSE]
        if self.inside_cylinder != _FALSE:
            parts += [Opposite(self.inside_cylinder), Opposite(Less(self._rho2, 0)), Less(0, self.rho)]
        parts += [] if self._knee_scale.is_number else [Opposite(knee.outside), Finite(self._taint)]
        return reduce(Both, parts)

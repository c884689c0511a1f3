"""Poses of a leg that reach a target, by elimination down to its last joint: what the general inverse's Newton steps start from.

As walkgen_elimination.h does it, on links: what joint 1 cannot change of the foot, seen from joint 2, gives s1 y1 = k1 and s2 y2 = k2 for
the foot's place y across axis 2 (across axis 1 where joint 2 slides), and |y|^2 = r^2, all of them known functions of joint 3. Then

    F = k2^2 - s2^2 (r^2 - (k1 / s1)^2) = 0,    y2 = k2 / s2

is a conic in (cos q3, sin q3), a quadratic in a sliding q3. Where s2 is 0 or nearly so, k2 = 0 is solved instead and y2 takes both signs;
where k2 does not depend on joint 3 either, the leg has one joint too many: q3 = 0 if y2 is real there, else a root of y2 = 0.
"""

from dataclasses import dataclass, replace

import sympy

from walkgen.symbolic.choices import at_most, both, chosen, indicator, less
from walkgen.symbolic.forms import Affine, Quadratic, at, combined, less_multiple, negligible, product, tidy
from walkgen.symbolic.links import Links
from walkgen.symbolic.roots import (
    Pair,
    back,
    circle_and_conic,
    circle_and_line,
    either_pair,
    half_angle,
    nonzero,
    quadratic,
    root,
    turned,
    unit,
)
from walkgen.symbolic.tape import Tape, Vec, constant, dot

_SMALL = sympy.Rational(1, 10**5)
_APART = sympy.Rational(1, 10)
_SLACK = sympy.Rational(1, 10**5)  # what is less real than that is no double root that rounding hides

_PAIR_0: Pair = (sympy.S.One, sympy.S.Zero)


@dataclass(frozen=True)
class Pose:
    """A start: each joint's pair and slide, whether it is one, the joint (or -1) that has to stay, and how real the last square root is."""

    pairs: tuple[Pair, ...]
    slides: tuple[sympy.Expr, ...]
    usable: sympy.Basic = sympy.true
    frozen: int = -1
    margin: sympy.Expr = sympy.S.One


@dataclass(frozen=True)
class _Equations:
    """s1 y1 = k1, s2 y2 = k2 along two directions of the plane: `e` is the first, in frame 2 (1 where joint 2 slides)."""

    s1: sympy.Expr
    s2: sympy.Expr
    k1: Affine
    k2: Affine
    e: Pair


def poses(links: Links, tape: Tape) -> list[Pose]:
    """Starts near every pose that reaches the target, at most four; joints 1 and 2 of more do not both slide."""
    if links.kinds in ("R", "P", "PP", "PPP"):
        return [_single(links, tape)]
    return _Elimination(links, tape).poses()


def _single(links: Links, tape: Tape) -> Pose:
    """The angle or slide of one joint; several sliding joints start at 0 and are right after one Newton step, next to right if not two."""
    if links.kinds == "P":
        return Pose(links.offsets, (tape.let("slide", links.target[2] - links.foot[2]),))
    if links.kinds != "R":
        return Pose(links.offsets, (sympy.S.Zero,) * len(links.kinds))
    x, y, _ = links.target
    direction, start = unit(x, y, tape, "target_direction"), unit(links.foot[0], links.foot[1], tape, "foot_direction")
    return Pose((turned(direction, back(start), tape, "single"),), (sympy.S.Zero,))


class _Elimination:
    """The equations of one leg, and their solutions."""

    def __init__(self, links: Links, tape: Tape) -> None:
        self._links, self._tape, self._kinds = links, tape, links.kinds
        self._turning = self._kinds[2:] == "R"
        self._g = self._affine()
        self._equations = self._set_up()

    def _affine(self) -> tuple[Affine, Affine, Affine]:
        """The foot moved by joint 3 alone, in frame 2."""
        x, y, z = self._links.foot
        zero = sympy.S.Zero
        if len(self._kinds) == 2:
            return (x, zero, zero), (y, zero, zero), (z, zero, zero)
        u = ((zero, x, -y), (zero, y, x), (z, zero, zero)) if self._turning else ((x, zero, zero), (y, zero, zero), (z, sympy.S.One, zero))
        (tx, ty, tz), (c, s) = self._links.links[1].t, self._links.links[1].twist
        rotated = (u[0], combined(((c, u[1]), (-s, u[2]))), combined(((s, u[1]), (c, u[2]))))
        gx, gy, gz = (self._tidy(combined(((1, row),), shift)) for row, shift in zip(rotated, (tx, ty, tz), strict=True))
        return gx, gy, gz

    def _tidy(self, form: Affine) -> Affine:
        """Names, and nothing where there is next to nothing: these are starts."""
        first, second, third = (tidy(self._tape.let("form", number)) for number in form)
        return first, second, third

    def _square(self) -> Affine:
        """|g|^2, where joint 3 turns or there is none."""
        x, y, z = self._links.foot
        square = x**2 + y**2 + z**2
        if len(self._kinds) == 2:
            return square, sympy.S.Zero, sympy.S.Zero
        (tx, ty, tz), (c, s) = self._links.links[1].t, self._links.links[1].twist
        ahead, up, along = tx, c * ty + s * tz, c * tz - s * ty
        square = square + tx**2 + ty**2 + tz**2 + 2 * along * z
        return square, 2 * (ahead * x + up * y), 2 * (up * x - ahead * y)

    def _set_up(self) -> _Equations:
        (bx, by, bz), (c, s) = self._links.target, self._links.links[0].twist
        gx, gy, gz = self._g
        one, nothing = sympy.S.One, sympy.S.Zero
        if self._kinds[0] == "P":  # y = (b_x, (b_y + s g_z) / c)
            return _Equations(one, c, (bx, nothing, nothing), self._tidy(combined(((s, gz),), by)), _PAIR_0)
        if self._kinds[1] == "P":  # y = (w_x, (w_y - s b_z) / c) with w = g turned by joint 2's offset
            co, so = self._links.offsets[1]
            wx, wy = combined(((co, gx), (-so, gy))), combined(((so, gx), (co, gy)))
            return _Equations(one, c, self._tidy(wx), self._tidy(combined(((1, wy),), -s * bz)), _PAIR_0)
        return self._turning_twice()

    def _turning_twice(self) -> _Equations:
        """Height along axis 1 and distance from its point, rotated into each other where that makes their rows orthogonal."""
        tape, (bx, by, bz), link = self._tape, self._links.target, self._links.links[0]
        (tx, ty, tz), (c, s) = link.t, link.twist
        ahead, across, along = tx, tape.let("offset_across", c * ty + s * tz), tape.let("offset_along", c * tz - s * ty)
        distance2 = tape.let("target_distance2", bx**2 + by**2 + bz**2)
        height = self._tidy(combined(((-c, self._g[2]),), bz - tz))
        size = (distance2 - tx**2 - ty**2 - tz**2) / 2
        distance = self._tidy(combined(((-sympy.Rational(1, 2), self._square()), (-along, self._g[2])), size))
        if s == 0 and across != 0:
            length = root(ahead**2 + across**2, tape, "offset_length")
            return _Equations(length, s, distance, height, unit(ahead, across, tape, "offset"))
        if across == 0 and s.is_number and abs(s) >= (min(abs(ahead), _APART) if ahead.is_number else _APART):
            return _Equations(s, -ahead, height, distance, (sympy.S.Zero, sympy.S.One))
        if across == 0 and (s.is_number or (ahead.is_number and abs(ahead) > _APART)):
            return _Equations(ahead, s, distance, height, _PAIR_0)
        return self._mixed((sympy.S.Zero, s), (ahead, across), height, distance)

    def _mixed(self, a: Pair, b: Pair, height: Affine, distance: Affine) -> _Equations:
        tape = self._tape
        cosine, sine = half_angle(unit(dot(a, a) - dot(b, b), 2 * dot(a, b), tape, "mixing"), tape)
        row1 = [cosine * x + sine * y for x, y in zip(a, b, strict=True)]
        row2 = [cosine * y - sine * x for x, y in zip(a, b, strict=True)]
        e = unit(row1[0], row1[1], tape, "plane")
        s1 = tape.let("s1", row1[0] * e[0] + row1[1] * e[1])
        s2 = tape.let("s2", row2[1] * e[0] - row2[0] * e[1])
        k1 = self._tidy(combined(((cosine, height), (sine, distance))))
        k2 = self._tidy(combined(((cosine, distance), (-sine, height))))
        return _Equations(s1, s2, k1, k2, e)

    def poses(self) -> list[Pose]:
        equations, tape = self._equations, self._tape
        if len(self._kinds) == 2:
            unique = equations.s2.is_number and abs(equations.s2) > _APART
            return [self._pose(_Last(), sign) for sign in ((0,) if unique else (1, -1))]
        if equations.s2.is_number:
            if negligible(equations.s2) and self._one_too_many():
                return self._idle()
            return self._blunt() if abs(equations.s2) < _SMALL * self._swing() else self._sharp()
        sharp = self._sharp()
        if self._one_too_many():
            return sharp
        blunt, narrow = self._blunt(), less(abs(tape.let("s2", equations.s2)), _SMALL)
        count = max(len(blunt), len(sharp))
        return [_either_pose(narrow, blunt[index % len(blunt)], sharp[index % len(sharp)], tape) for index in range(count)]

    def _one_too_many(self) -> bool:
        """Whether k2 does not depend on joint 3."""
        return all(negligible(number) for number in self._equations.k2[1:])

    def _swing(self) -> sympy.Expr:
        """How much k2 varies with joint 3, about 1 but for special legs."""
        first, second = self._equations.k2[1:]
        return sympy.sqrt(first**2 + second**2) if first.is_number and second.is_number else sympy.S.One

    def _sharp(self) -> list[Pose]:
        """From the roots of F, y2 = k2 / s2; both scaled where they are small because axes are nearly parallel."""
        eq = self._equations
        if eq.s2.is_number:
            scale = 1 / constant(max(abs(eq.s2), self._swing()))
            eq = replace(eq, s2=eq.s2 * scale, k2=self._tidy(combined(((scale, eq.k2),))))
        inverse = 1 / nonzero(eq.s1, self._tape)
        y2 = less_multiple(self._radius2(), inverse**2, product(eq.k1, eq.k1))
        F = less_multiple(product(eq.k2, eq.k2), eq.s2**2, y2)
        return [self._pose(found, 0) for found in self._roots(F)]

    def _blunt(self) -> list[Pose]:
        """From the roots of k2, y2 = +-sqrt(r^2 - y1^2)."""
        tape, k2 = self._tape, self._equations.k2
        if self._turning:
            found = [_Last(pair, sympy.S.Zero, margin) for pair, margin in circle_and_line(k2[1], k2[2], -k2[0], tape)]
        else:
            found = [_Last(_PAIR_0, tape.let("slide3", -k2[0] / nonzero(k2[1], tape)))]
        return [self._pose(last, sign) for last in found for sign in (1, -1)]

    def _idle(self) -> list[Pose]:
        """Joint 3 is one too many: it stays at 0 where the others reach, or where they just do."""
        tape, eq = self._tape, self._equations
        inverse = 1 / nonzero(eq.s1, tape)
        margin = less_multiple(self._radius2(), inverse**2, product(eq.k1, eq.k1))
        rest = self._links.offsets[2]
        at_rest = margin.at(*rest) if self._turning else margin.linear[0]
        free = less(0, tape.let("margin", at_rest))
        found: list[Pose] = []
        for index, last in enumerate(self._roots(margin)):
            taken = _Last(
                either_pair(free, rest, last.pair, tape),
                tape.let("slide3", chosen(free, 0, last.slide)),
                tape.let("margin", chosen(free, 1 if index < 2 else -1, last.margin)),
            )
            found.append(replace(self._pose(taken, 1 if index % 2 == 0 else -1), frozen=2))
        return found

    def _radius2(self) -> Quadratic:
        """r^2 as a form in joint 3."""
        bx, by, _ = self._links.target
        gx, gy, gz = self._g
        if self._kinds[1] == "P":
            return Quadratic((bx**2 + by**2, sympy.S.Zero, sympy.S.Zero))
        if self._turning:
            return less_multiple(Quadratic(self._square()), sympy.S.One, product(gz, gz))
        return less_multiple(product(gx, gx), -sympy.S.One, product(gy, gy))

    def _roots(self, form: Quadratic) -> list["_Last"]:
        """Zeros of a form in joint 3."""
        tape = self._tape
        constant_term, first, second = (tidy(tape.let("zero_form", number)) for number in form.linear)
        square, mixed = (tidy(tape.let("zero_form", number)) for number in (form.square, form.mixed))
        if not self._turning:
            return [_Last(_PAIR_0, slide, margin) for slide, margin in quadratic(square, first, constant_term, tape)]
        axes, length = _PAIR_0, square
        if mixed != 0:
            length = root(square**2 + mixed**2, tape, "principal")
            axes = half_angle(unit(square, mixed, tape, "principal_axes"), tape)
        c, s = axes
        rest = constant_term + (square - length) / 2
        found = circle_and_conic(length, (first * c + second * s) / 2, (second * c - first * s) / 2, rest, tape)
        return [_Last(turned(pair, axes, tape, "third"), sympy.S.Zero, margin) for pair, margin in found]

    def _pose(self, last: "_Last", sign: int) -> Pose:
        """All joints from the last one; sign 0 where y2 = k2 / s2."""
        tape, eq = self._tape, self._equations
        c, s = last.pair if self._turning else (last.slide, sympy.S.Zero)
        gx, gy, gz = (tape.let("g", at(form, c, s)) for form in self._g)
        first = tape.let("y_first", at(eq.k1, c, s) / nonzero(eq.s1, tape))
        margin = sympy.S.One
        if sign == 0:
            second = tape.let("y_second", at(eq.k2, c, s) / nonzero(eq.s2, tape))
        else:
            bx, by, _ = self._links.target
            radius2 = bx**2 + by**2 if self._kinds[1] == "P" else gx**2 + gy**2
            margin = tape.let("margin", radius2 - first**2)
            second = sign * root(margin, tape, "y_across")
        e, f = eq.e
        y = (tape.let("y", first * e - second * f), tape.let("y", first * f + second * e))
        pairs, slides = self._first_joints((gx, gy, gz), y)
        real = both(at_most(-_SLACK, last.margin), at_most(-_SLACK, margin))
        if len(self._kinds) == 2:
            return Pose(pairs, slides, real, margin=margin)
        third = last.pair if self._turning else self._links.offsets[2]
        return Pose((*pairs, third), (*slides, last.slide), real)

    def _first_joints(self, g: Vec, y: Pair) -> tuple[tuple[Pair, Pair], tuple[sympy.Expr, sympy.Expr]]:
        tape, (bx, by, bz), link = self._tape, self._links.target, self._links.links[0]
        (tx, ty, tz), (c, s) = link.t, link.twist
        pair2, slide2 = self._links.offsets[1], sympy.S.Zero
        if self._kinds[1] == "R":
            pair2 = unit(g[0] * y[0] + g[1] * y[1], g[0] * y[1] - g[1] * y[0], tape, "second")
            x = (tx + y[0], ty + c * y[1] - s * g[2], tz + s * y[1] + c * g[2])
        else:
            slide2 = tape.let("slide2", c * bz - s * y[1] - g[2])
            x = (y[0], y[1], bz)
        if self._kinds[0] == "P":
            return (self._links.offsets[0], pair2), (tape.let("slide1", bz - x[2]), slide2)
        px, py = tape.let("x", x[0]), tape.let("x", x[1])
        return (unit(px * bx + py * by, px * by - py * bx, tape, "first"), pair2), (sympy.S.Zero, slide2)


@dataclass(frozen=True)
class _Last:
    """Joint 3: its pair, its slide, and how real they are."""

    pair: Pair = _PAIR_0
    slide: sympy.Expr = sympy.S.Zero
    margin: sympy.Expr = sympy.S.One


def _either_pose(truth: sympy.Basic, then: Pose, otherwise: Pose, tape: Tape) -> Pose:
    pairs = tuple(either_pair(truth, a, b, tape) for a, b in zip(then.pairs, otherwise.pairs, strict=True))
    slides = tuple(tape.let("start", chosen(truth, a, b)) for a, b in zip(then.slides, otherwise.slides, strict=True))
    return Pose(pairs, slides, less(0, chosen(truth, indicator(then.usable), indicator(otherwise.usable))))

"""Roots without branches: points of the unit circle on a line or a conic (a quartic in the half-angle tangent), and of a quadratic.

The conic is A c^2 + 2 B c + 2 C s + D = 0 with c^2 + s^2 = 1. Of all conics through the common points some are pairs of lines:
    u c -+ w s = -(U +- W),    u^2 = 1 - x, w^2 = x, U = B / (A u), W = C / (A w),    U^2 - W^2 = D / A + x
where x is a root of x^3 - b x^2 + c x - d with b = 1 - D / A, c = (B/A)^2 + (C/A)^2 - D / A, d = (C/A)^2; one lies in [0, 1] always, and
all do where all four points are real (Ferrari's resolvent, without an angle at which a tangent is infinite). Every division and square
root is guarded, for a choice computes both its values and automatic differentiation multiplies the other one's slope by zero.
"""

import sympy

from walkgen.symbolic.choices import at_most, both, chosen, either, less
from walkgen.symbolic.function import Angle
from walkgen.symbolic.tape import Tape, constant

Pair = tuple[sympy.Expr, sympy.Expr]
"""Cosine and sine."""
Point = tuple[Pair, sympy.Expr]
"""A pair and its margin, which is negative where it is no root but only stands for one."""

_TINY = sympy.Float("1e-100", 50)  # dividing by more than that overflows nowhere, not even in derivatives
_STEPS = 3
_QUARTERS = 4
_POLISHING = 2
_FLAT = sympy.Rational(1, 10**7)


def root(square: sympy.Expr, tape: Tape, name: str) -> sympy.Expr:
    """The square root, 0 (or next to it) for what is negative; its slope is finite everywhere."""
    square = tape.let(f"{name}2", square)
    if square.is_number:
        return constant(sympy.sqrt(sympy.Max(square, 0)))
    return tape.let(name, sympy.sqrt(chosen(less(_TINY, square), square, _TINY)))


def nonzero(number: sympy.Expr, tape: Tape) -> sympy.Expr:
    """The number, 1 where nothing can be divided by it."""
    number = tape.let("divisor", number)
    return number if number.is_number and number != 0 else tape.let("divisor", chosen(less(abs(number), _TINY), sympy.S.One, number))


def clamped(number: sympy.Expr, low: sympy.Expr | int, high: sympy.Expr | int, tape: Tape, name: str) -> sympy.Expr:
    """The number brought into an interval."""
    number = tape.let(name, number)
    below = tape.let(name, chosen(less(number, sympy.sympify(low)), sympy.sympify(low), number))
    return tape.let(name, chosen(less(sympy.sympify(high), below), sympy.sympify(high), below))


def turned(pair: Pair, by: Pair, tape: Tape, name: str) -> Pair:
    """The pair of the sum of two angles."""
    (c, s), (a, b) = pair, by
    return tape.let(f"{name}_cos", c * a - s * b), tape.let(f"{name}_sin", s * a + c * b)


def back(pair: Pair) -> Pair:
    """The pair of the angle's negative."""
    return pair[0], -pair[1]


def unit(x: sympy.Expr, y: sympy.Expr, tape: Tape, name: str) -> Pair:
    """The direction of (x, y), (1, 0) where there is none."""
    x, y = tape.let(f"{name}_x", x), tape.let(f"{name}_y", y)
    square = tape.let(f"{name}_2", x**2 + y**2)
    if square.is_number:
        length = constant(sympy.sqrt(square))
        return (sympy.S.One, sympy.S.Zero) if length == 0 else (constant(x / length), constant(y / length))
    none = less(square, _TINY)
    scale = tape.let(f"{name}_scale", 1 / sympy.sqrt(chosen(none, 1, square)))
    return tape.let(f"{name}_cos", chosen(none, 1, x * scale)), tape.let(f"{name}_sin", y * scale)


def half_angle(pair: Pair, tape: Tape) -> Pair:
    """The pair of half the angle in (-pi, pi]."""
    c, s = pair
    cosine, sine = root((1 + c) / 2, tape, "half_cos"), root((1 - c) / 2, tape, "half_sin")
    return cosine, tape.let("half", chosen(less(s, 0), -sine, sine))


def quadratic(a: sympy.Expr, b: sympy.Expr, c: sympy.Expr, tape: Tape) -> list[tuple[sympy.Expr, sympy.Expr]]:
    """Both roots of a x^2 + b x + c with their margins; the extremum twice where they are not real, one root where a is known to be 0."""
    a, b, c = (tape.let(f"quadratic_{letter}", number) for letter, number in zip("abc", (a, b, c), strict=True))
    if a == 0:
        return [(tape.let("linear_root", -c / nonzero(b, tape)), sympy.S.One)]
    square, product = tape.let("b2", b**2), tape.let("four_ac", 4 * a * c)
    discriminant = tape.let("discriminant", square - product)
    margin = tape.let("margin", discriminant / nonzero(square + abs(product), tape))
    spread = root(discriminant, tape, "quadratic_spread")
    twice = tape.let("quadratic_twice", -b - chosen(less(b, 0), -spread, spread))
    extremum = tape.let("extremum", -b / nonzero(2 * a, tape))
    ends = twice / nonzero(2 * a, tape), 2 * c / nonzero(twice, tape)
    return [(tape.let("quadratic_root", chosen(less(0, discriminant), end, extremum)), margin) for end in ends]


def circle_and_line(a: sympy.Expr, b: sympy.Expr, d: sympy.Expr, tape: Tape) -> list[Point]:
    """Both points with a c + b s = d; the nearest twice where the line misses the circle."""
    square = tape.let("normal2", a**2 + b**2)
    scale = tape.let("normal_scale", 1 / sympy.sqrt(nonzero(square, tape)))
    return _on_chord(unit(a, b, tape, "normal"), d * scale, tape)


def _on_chord(normal: Pair, distance: sympy.Expr, tape: Tape) -> list[Point]:
    """The points of the unit circle on the line with this unit normal and distance from the centre."""
    distance = tape.let("chord", distance)
    margin = tape.let("margin", 1 - abs(distance))
    along = clamped(distance, -1, 1, tape, "chord")
    half = root((1 - along) * (1 + along), tape, "half_chord")
    c, s = normal
    x, y = tape.let("foot_point_x", along * c), tape.let("foot_point_y", along * s)
    ends = ((x - sign * half * s, y + sign * half * c) for sign in (1, -1))
    return [((tape.let("circle_cos", x), tape.let("circle_sin", y)), margin) for x, y in ends]


def circle_and_conic(A: sympy.Expr, B: sympy.Expr, C: sympy.Expr, D: sympy.Expr, tape: Tape) -> list[Point]:
    """All four points with A c^2 + 2 B c + 2 C s + D = 0, two where A is next to nothing beside 1.

    Args:
        A: a number, or known only at run time: then a line takes over where it is negligible.
        B: half the factor of the cosine.
        C: half the factor of the sine.
        D: the rest.
        tape: where the steps are written.
    """
    A, B, C, D = (tape.let(f"conic_{letter}", number) for letter, number in zip("ABCD", (A, B, C, D), strict=True))
    if A.is_number:
        return circle_and_line(2 * B, 2 * C, -D, tape) if abs(A) < _FLAT else _parabola(B / A, C / A, D / A, tape)
    flat = less(abs(A), _FLAT * (abs(B) + abs(C) + abs(D)) + _TINY)
    scale = tape.let("conic_scale", 1 / chosen(flat, 1, A))
    straight = circle_and_line(2 * B, 2 * C, -D, tape)
    straight += [(pair, -sympy.S.One) for pair, _ in straight]
    bent = _parabola(B * scale, C * scale, D * scale, tape)
    return [(either_pair(flat, a, b, tape), tape.let("margin", chosen(flat, c, d))) for (a, c), (b, d) in zip(straight, bent, strict=True)]


def either_pair(truth: sympy.Basic, then: Pair, otherwise: Pair, tape: Tape) -> Pair:
    """One of two pairs."""
    c, s = (tape.let("either", chosen(truth, a, b)) for a, b in zip(then, otherwise, strict=True))
    return c, s


def _parabola(q: sympy.Expr, r: sympy.Expr, t: sympy.Expr, tape: Tape) -> list[Point]:
    """The points with c^2 + 2 q c + 2 r s + t = 0."""
    q, r, t = (tape.let(name, number) for name, number in (("parabola_q", q), ("parabola_r", r), ("parabola_t", t)))
    x = _resolvent(q, r, t, tape)
    u, w = root(1 - x, tape, "line_u"), root(x, tape, "line_w")
    flat = less(x, sympy.Rational(1, 2))
    U, W = tape.let("line_U", q / nonzero(u, tape)), tape.let("line_W", r / nonzero(w, tape))
    # the one with the greater divisor is sharp; the other follows from U^2 - W^2 = t + x, unless dividing is sharper
    W2, U2 = tape.let("line_W2", U**2 - t - x), tape.let("line_U2", W**2 + t + x)
    other_W, other_U = root(W2, tape, "other_W"), root(U2, tape, "other_U")
    W_taken = chosen(both(flat, at_most(x, W2)), chosen(less(r, 0), -other_W, other_W), W)
    U_taken = chosen(either(flat, less(U2, 1 - x)), U, chosen(less(q, 0), -other_U, other_U))
    U, W = tape.let("line_U_taken", U_taken), tape.let("line_W_taken", W_taken)
    points = [*_on_chord((u, -w), -U - W, tape), *_on_chord((u, w), W - U, tape)]
    return [(_polished(pair, q, r, t, tape), margin) for pair, margin in points]


def _resolvent(q: sympy.Expr, r: sympy.Expr, t: sympy.Expr, tape: Tape) -> sympy.Expr:
    """A root in [0, 1] of x^3 - (1 - t) x^2 + (q^2 + r^2 - t) x - r^2: the only one (Cardano), or the most isolated of three (Viete).

    Two points that nearly are one then lie on one line, which is sharp; two other roots nearly are one, and not used.
    """
    b, d = tape.let("cubic_b", t - 1), tape.let("cubic_d", -(r**2))
    c = tape.let("cubic_c", q**2 + r**2 - t)
    middle = tape.let("inflection", -b / 3)
    p = tape.let("cubic_p", c / 3 - middle**2)
    h = tape.let("cubic_h", (((middle + b) * middle + c) * middle + d) / 2)
    discriminant = tape.let("cubic_discriminant", h**2 + p**3)
    size = tape.let("cubic_size", abs(h))
    third = tape.let("third", Angle(root(-discriminant, tape, "cubic_root"), size) / 3)
    three = 2 * root(-p, tape, "cubic_radius") * sympy.cos(third)
    side = _cube_root(size + root(discriminant, tape, "cardano_root"), tape)
    apart = tape.let("apart", chosen(less(discriminant, 0), three, side - p / nonzero(side, tape)))
    x = clamped(middle + chosen(less(0, h), -apart, apart), 0, 1, tape, "resolvent")
    for _ in range(_STEPS):  # Halley
        value = tape.let("cubic_value", ((x + b) * x + c) * x + d)
        slope = tape.let("cubic_slope", (3 * x + 2 * b) * x + c)
        divisor = nonzero(slope**2 - value * (3 * x + b), tape)
        x = tape.let("resolvent", x - value * slope / divisor)
    return clamped(x, 0, 1, tape, "resolvent")


def _cube_root(number: sympy.Expr, tape: Tape) -> sympy.Expr:
    """Of a positive number, by 1/3 = 1/4 + 1/16 + 1/64 + ..., which is 10 % off at worst, and one step of Halley's."""
    number = tape.let("cube", number)
    start, power = sympy.S.One, number
    for _ in range(_QUARTERS):
        power = root(root(power, tape, "half_power"), tape, "quarter_power")
        start = start * power
    start = tape.let("cube_start", start)
    cube = tape.let("cubed", start**3)
    return tape.let("cube_root", start * (cube + 2 * number) / nonzero(2 * cube + number, tape))


def _polished(point: Pair, q: sympy.Expr, r: sympy.Expr, t: sympy.Expr, tape: Tape) -> Pair:
    """Newton steps along the circle: they make the points, and their derivatives, as exact as the coefficients."""
    c, s = point
    for _ in range(_POLISHING):
        value = tape.let("conic_value", c**2 + 2 * q * c + 2 * r * s + t)
        slope = tape.let("conic_slope", 2 * (r * c - s * (c + q)))
        near = both(at_most(2 * abs(value), abs(slope)), less(_TINY, abs(slope)))
        step = tape.let("conic_step", -value * chosen(near, 1 / chosen(near, slope, 1), 0))
        c, s = advanced((c, s), step, tape, "circle")
    return c, s


def advanced(pair: Pair, step: sympy.Expr, tape: Tape, name: str) -> Pair:
    """The pair of the angle and the arc tangent of a step, which is the step to third order."""
    c, s = pair
    scale = tape.let(f"{name}_scale", 1 / sympy.sqrt(1 + step**2))
    return tape.let(f"{name}_cos", (c - step * s) * scale), tape.let(f"{name}_sin", (s + step * c) * scale)


def angle(pair: Pair, tape: Tape, name: str) -> sympy.Expr:
    """The angle in (-pi, pi]."""
    c, s = pair
    if c.is_number and s.is_number:
        return constant(sympy.atan2(s, c))
    half_turn = constant(sympy.pi)
    value = tape.let(name, Angle(s, c))
    return tape.let(name, chosen(at_most(value, -half_turn), half_turn, value))

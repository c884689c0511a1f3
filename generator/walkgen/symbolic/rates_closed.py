"""Damped joint rates as straight-line expressions, for targets without support routines: any number of joints."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.walk import CONTEXT
from walkgen.signature import STATUSES
from walkgen.symbolic.function import Finite, Less, LessEqual, Residue, Select
from walkgen.symbolic.tape import DIGITS, Tape, Vec, constant, cross, dot, minus, plus, scaled

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR = map(sympy.Integer, map(STATUSES.index, ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR")))
_ATTAINED = sympy.Rational(1, 10**9)


@dataclass(frozen=True)
class Damping:
    """Epsilon and lambda_max, in the Jacobian's unit."""

    epsilon: sympy.Rational
    largest: sympy.Rational


@dataclass(frozen=True)
class _Loading:
    """Whether the rates are damped, and lambda^2, 0 where they are not."""

    damped: sympy.Basic
    lambda2: sympy.Expr


def closed_rates(columns: Sequence[Vec], wanted: Vec, damping: Damping, tape: Tape) -> tuple[sympy.Expr, ...]:
    """Rates [n] and their status, as `wg_damped_inverse` has them.

    Args:
        columns: the foot's Jacobian.
        wanted: the foot's velocity.
        damping: where damping begins and how strong it gets.
        tape: takes the intermediates.
    """
    solve = {1: _one_joint, 2: _two_joints}.get(len(columns), _spatial)
    rates, loading = solve(columns, wanted, damping, tape)
    total = tape.let("total", sympy.Add(*wanted, *(entry for column in columns for entry in column)))
    poison = tape.let("poison", Residue(total))
    told = _choose(loading.damped, _SINGULAR, _attained(columns, wanted, rates, tape) if len(columns) < 3 else _OK)
    return (*(rate + poison for rate in rates), Select(Finite(total), told, _BAD_INPUT))


def _one_joint(columns: Sequence[Vec], wanted: Vec, damping: Damping, tape: Tape) -> tuple[list[sympy.Expr], _Loading]:
    (column,) = columns
    square = tape.let("square", dot(column, column))
    loading = _loading(square, damping, tape)
    return [tape.let("rate", dot(column, wanted) / _divisor(square + loading.lambda2, tape))], loading


def _two_joints(columns: Sequence[Vec], wanted: Vec, damping: Damping, tape: Tape) -> tuple[list[sympy.Expr], _Loading]:
    """(J'J + lambda^2)^-1 J'v by Cramer's rule, with det J'J = |n|^2 of n = J1 x J2: no squares cancel (Lagrange's identity)."""
    first, second = columns
    normal = tape.vector("normal", cross(first, second))
    area2 = tape.let("area2", dot(normal, normal))
    squares = [tape.let("square", dot(column, column)) for column in columns]
    trace = tape.let("trace", squares[0] + squares[1])
    spread = _root(tape.let("spread2", (squares[0] - squares[1]) ** 2 + 4 * dot(first, second) ** 2), tape)
    loading = _loading(tape.let("smallest2", 2 * area2 / _divisor(trace + spread, tape)), damping, tape)
    divisor = _divisor(area2 + loading.lambda2 * (trace + loading.lambda2), tape)
    crossed = (tape.vector("crossed", cross(wanted, second)), tape.vector("crossed", cross(first, wanted)))
    above = [dot(side, normal) + loading.lambda2 * dot(column, wanted) for side, column in zip(crossed, columns, strict=True)]
    return [tape.let("rate", part / divisor) for part in above], loading


def _spatial(columns: Sequence[Vec], wanted: Vec, damping: Damping, tape: Tape) -> tuple[list[sympy.Expr], _Loading]:
    """J'(JJ' + lambda^2)^-1 v by Cramer's rule; one refinement, of the rates themselves, takes back what the squared matrix costs."""
    gram = [[tape.let("gram", dot([c[i] for c in columns], [c[j] for c in columns])) for j in range(3)] for i in range(3)]
    loading = _loading(_smallest_eigenvalue(gram, tape), damping, tape)
    loaded = [tape.vector("loaded", [gram[i][j] + (loading.lambda2 if i == j else 0) for i in range(3)]) for j in range(3)]
    along = _cramer(loaded, wanted, tape)
    rates = [tape.let("rate", dot(column, along)) for column in columns]
    rest = tape.vector("rest", minus(wanted, plus(_reached(columns, rates), scaled(loading.lambda2, along))))
    further = _cramer(loaded, rest, tape)
    return [tape.let("rate", rate + dot(column, further)) for rate, column in zip(rates, columns, strict=True)], loading


def _reached(columns: Sequence[Vec], rates: Sequence[sympy.Expr]) -> Vec:
    """J qd."""
    x, y, z = (dot([column[row] for column in columns], rates) for row in range(3))
    return (x, y, z)


def _attained(columns: Sequence[Vec], wanted: Vec, rates: Sequence[sympy.Expr], tape: Tape) -> sympy.Expr:
    """OK where J qd is v, else UNREACHABLE."""
    rest = tape.vector("rest", minus(wanted, _reached(columns, rates)))
    return Select(Less(_ATTAINED**2 * dot(wanted, wanted), tape.let("rest2", dot(rest, rest))), _UNREACHABLE, _OK)


def _loading(smallest2: sympy.Expr, damping: Damping, tape: Tape) -> _Loading:
    """Damping by the square of the least singular value; where that is known, the choice is made here."""
    if damping.epsilon == 0:
        known = sympy.true if smallest2 == 0 else sympy.false
        return _Loading(known if smallest2.is_number else LessEqual(smallest2, 0), sympy.S.Zero)
    limit2 = damping.epsilon**2
    lambda2 = tape.let("lambda2", (1 - smallest2 / limit2) * damping.largest**2)
    if smallest2.is_number:
        damped = sympy.true if smallest2 < limit2 else sympy.false
        return _Loading(damped, _choose(damped, lambda2, sympy.S.Zero))
    damped = Less(smallest2, limit2)
    return _Loading(damped, tape.let("lambda2", Select(damped, lambda2, 0)))


def _choose(truth: sympy.Basic, then: sympy.Expr, otherwise: sympy.Expr) -> sympy.Expr:
    return then if truth is sympy.true else Select(truth, then, otherwise)


def _divisor(value: sympy.Expr, tape: Tape) -> sympy.Expr:
    """What is not negative, and 1 where it is 0: the numerators over it are 0 then, and so are the rates."""
    named = tape.let("divisor", value)
    if named.is_number:
        return named if named != 0 else sympy.S.One
    return tape.let("divisor", Select(Less(0, named), named, 1))


def _root(square: sympy.Expr, tape: Tape) -> sympy.Expr:
    """Square root of what rounding may make negative, 0 there, with a derivative that is a number where the square is 0."""
    if square.is_number:
        return constant(sympy.sqrt(square))
    positive = Less(0, square)
    return tape.let("root", Select(positive, sympy.sqrt(tape.let("radicand", Select(positive, square, 1))), 0))


def _cramer(columns: Sequence[Vec], right: Vec, tape: Tape) -> Vec:
    """Solve a positive 3x3 system given by columns; shared work is named once."""
    a, b, c = columns
    bc, ca, ab = (tape.vector("minor", cross(*pair)) for pair in ((b, c), (c, a), (a, b)))
    determinant = _divisor(dot(a, bc), tape)
    return tape.vector("solution", [dot(minor, right) / determinant for minor in (bc, ca, ab)])


def _smallest_eigenvalue(gram: Sequence[Sequence[sympy.Expr]], tape: Tape) -> sympy.Expr:
    """Of a symmetric positive 3x3 matrix, by the trigonometric solution of its cubic (Smith 1961); exact where known beforehand."""
    if any(all(entry == 0 for entry in row) for row in gram):
        return sympy.S.Zero
    if all(entry.is_number for row in gram for entry in row):
        known = CONTEXT.eigsy(CONTEXT.matrix([[CONTEXT.mpf(str(entry.evalf(DIGITS))) for entry in row] for row in gram]), eigvals_only=True)
        return sympy.Float(CONTEXT.nstr(max(min(known), CONTEXT.zero), DIGITS), DIGITS)
    mean = tape.let("mean", (gram[0][0] + gram[1][1] + gram[2][2]) / 3)
    shifted = [tape.vector("shifted", [gram[i][j] - (mean if i == j else 0) for i in range(3)]) for j in range(3)]
    spread2 = tape.let("spread2", sympy.Add(*(entry**2 for column in shifted for entry in column)) / 6)
    spread = _root(spread2, tape)
    half = tape.let("half_det", dot(shifted[0], tape.vector("minor", cross(shifted[1], shifted[2]))) / 2)
    cube = tape.let("cube", spread * spread2)
    other = _root(tape.let("discriminant", (cube - half) * (cube + half)), tape)
    angle = tape.let("third_angle", sympy.atan2(other, Select(Less(0, spread2), half, 1)) / 3)
    value = tape.let("eigenvalue", mean + 2 * spread * sympy.cos(angle + 2 * sympy.pi / 3))
    return tape.let("smallest2", Select(Less(value, 0), 0, value))

"""Affine and quadratic forms in cosine and sine of a leg's last joint, or in its slide: what the general elimination adds and squares."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.symbolic.tape import constant

_NONE = sympy.Rational(1, 10**12)

Affine = tuple[sympy.Expr, sympy.Expr, sympy.Expr]
"""Constant, factor of cos q3 (or of a sliding q3) and of sin q3."""


@dataclass(frozen=True)
class Quadratic:
    """linear + square c^2 + mixed c s, where s^2 = 1 - c^2 if joint 3 turns and s is 0 if it slides."""

    linear: Affine
    square: sympy.Expr = sympy.S.Zero
    mixed: sympy.Expr = sympy.S.Zero

    def at(self, c: sympy.Expr, s: sympy.Expr) -> sympy.Expr:
        """Its value."""
        return at(self.linear, c, s) + self.square * c**2 + self.mixed * c * s


def at(form: Affine, c: sympy.Expr, s: sympy.Expr) -> sympy.Expr:
    """The value of an affine form."""
    return form[0] + form[1] * c + form[2] * s


def product(a: Affine, b: Affine) -> Quadratic:
    """a * b."""
    linear = (a[0] * b[0] + a[2] * b[2], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0])
    return Quadratic(linear, a[1] * b[1] - a[2] * b[2], a[1] * b[2] + a[2] * b[1])


def combined(terms: Sequence[tuple[sympy.Expr | int, Affine]], shift: sympy.Expr = sympy.S.Zero) -> Affine:
    """A sum of multiples of affine forms, and of a constant."""
    first, second, third = (sympy.Add(*(factor * form[index] for factor, form in terms)) for index in range(3))
    return first + shift, second, third


def less_multiple(a: Quadratic, factor: sympy.Expr, b: Quadratic) -> Quadratic:
    """a - factor * b."""
    return Quadratic(combined(((1, a.linear), (-factor, b.linear))), a.square - factor * b.square, a.mixed - factor * b.mixed)


def negligible(number: sympy.Expr) -> bool:
    """Whether it is known, and next to nothing beside 1."""
    return bool(number.is_number and abs(constant(number)) < _NONE)


def tidy(number: sympy.Expr) -> sympy.Expr:
    """Nothing instead of next to nothing."""
    return sympy.S.Zero if negligible(number) else number

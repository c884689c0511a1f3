"""Numbers affine in the unknowns that are left free while forces are balanced."""

import sympy

from walkgen.symbolic.sole_ports import Exprs
from walkgen.symbolic.tape import Tape

FREE = 3
"""How many unknowns are left."""


class Affine:
    """A constant, and factors of the three free unknowns."""

    def __init__(self, constant: sympy.Expr, factors: Exprs = (sympy.S.Zero,) * FREE) -> None:
        self.constant, self.factors = sympy.sympify(constant), tuple(factors)

    def __add__(self, other: "Affine") -> "Affine":
        return Affine(self.constant + other.constant, [a + b for a, b in zip(self.factors, other.factors, strict=True)])

    def __sub__(self, other: "Affine") -> "Affine":
        return self + other.scaled(sympy.S.NegativeOne)

    def scaled(self, factor: sympy.Expr) -> "Affine":
        """factor times it."""
        return Affine(factor * self.constant, [factor * entry for entry in self.factors])

    def at(self, free: Exprs) -> sympy.Expr:
        """Its value."""
        return self.constant + sympy.Add(*(factor * value for factor, value in zip(self.factors, free, strict=True)))

    def named(self, tape: Tape, name: str) -> "Affine":
        """On the tape."""
        return Affine(tape.let(name, self.constant), [tape.let(f"{name}_by", factor) for factor in self.factors])

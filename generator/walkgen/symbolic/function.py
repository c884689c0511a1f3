"""A Function: a signature, named intermediates and outputs, each a small sympy expression in what came before."""

from dataclasses import dataclass

import sympy

from walkgen.signature import Argument, Port, Signature, Table


class Truth(sympy.Function):
    """A condition; it may stand only inside `Select`, `Both`, `Either`, `Opposite`."""


class Less(Truth):
    """left < right."""

    nargs = 2


class LessEqual(Truth):
    """left <= right."""

    nargs = 2


class Same(Truth):
    """left == right, bit for bit but for the sign of zero."""

    nargs = 2


class Finite(Truth):
    """Neither infinite nor NaN."""

    nargs = 1


class Both(Truth):
    """Logical and."""

    nargs = 2

    @classmethod
    def eval(cls, left: sympy.Basic, right: sympy.Basic) -> sympy.Basic | None:
        """False if either is known to be."""
        return sympy.false if sympy.false in (left, right) else None


class Either(Truth):
    """Logical or."""

    nargs = 2

    @classmethod
    def eval(cls, left: sympy.Basic, right: sympy.Basic) -> sympy.Basic | None:
        """The other if one is known to be false."""
        if left is sympy.false:
            return right
        return left if right is sympy.false else None


class Opposite(Truth):
    """Logical not."""

    nargs = 1


class Select(sympy.Function):
    """(truth, then, otherwise): both values are computed, one is taken."""

    nargs = 3

    @classmethod
    def eval(cls, truth: sympy.Basic, then: sympy.Basic, otherwise: sympy.Basic) -> sympy.Basic | None:
        """The second value if the condition is known to be false, or both are one."""
        return otherwise if truth is sympy.false or then == otherwise else None

    def _eval_derivative(self, symbol: sympy.Basic) -> sympy.Expr:
        """That of the value that is taken."""
        truth, then, otherwise = self.args
        return Select(truth, then.diff(symbol), otherwise.diff(symbol))


class Indicator(sympy.Function):
    """1 where a condition holds, 0 elsewhere: for choices that the data make unpredictable."""

    nargs = 1

    def _eval_derivative(self, symbol: sympy.Basic) -> sympy.Expr:
        """0 but where it jumps."""
        del symbol
        return sympy.S.Zero


class Epsilon(sympy.Function):
    """The distance from 1 to the next number of the target's precision: no number until a target is chosen."""

    nargs = 0
    is_number = False


class Residue(sympy.Function):
    """x - x: 0 for a finite x, NaN otherwise; algebra must not cancel it."""

    nargs = 1


class Angle(sympy.Function):
    """atan2(y, x) as the C library has it: no algebra is done on it."""

    nargs = 2

    def fdiff(self, argindex: int = 1) -> sympy.Expr:
        """x / (x^2 + y^2) by y, -y / (x^2 + y^2) by x."""
        y, x = self.args
        return (x if argindex == 1 else -y) / (x**2 + y**2)


@dataclass(frozen=True)
class Function:
    """`inputs` holds a symbol for every element of every input port, port by port, row-major; `outputs` likewise, flat."""

    signature: Signature
    inputs: tuple[sympy.Symbol, ...]
    intermediates: tuple[tuple[sympy.Symbol, sympy.Expr], ...]
    outputs: tuple[sympy.Expr, ...]


@dataclass(frozen=True)
class Step:
    """A call inside a Solve: of a Function, or of a support routine by name; with `guard` only where it holds.

    A Function may read what it writes, and with `repeat` it runs that often.
    """

    callee: Function | str
    arguments: tuple[Argument, ...]
    guard: tuple[str, tuple[Argument, ...]] | None = None
    repeat: int = 1


@dataclass(frozen=True)
class Solve:
    """A function of several steps in order, joined by `locals`; steps may be support routines.

    `closed_form` computes the same map without routines, for targets that have none: a Function, or a Solve of Functions alone.
    `tables` are constants that routines read, named among a step's arguments; `callbacks` are functions that routines call with a point,
    which they pass on with the runtime parameters: an argument names one by its full name, or Records several. `slopes` tell how inputs of
    the last step that earlier ones compute move with the runtime parameters: for an input `x` they write `x_d_param`.
    """

    signature: Signature
    locals: tuple[Port, ...]
    steps: tuple[Step, ...]
    closed_form: "Function | Solve | None" = None
    tables: tuple[Table, ...] = ()
    callbacks: tuple["Solve", ...] = ()
    slopes: tuple[Step, ...] = ()


Derivation = Function | Solve

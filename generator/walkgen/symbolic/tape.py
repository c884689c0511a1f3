"""The tape on which a derivation writes its named intermediates, folding every constant at 50 digits."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.signature import Port, Signature
from walkgen.symbolic.function import Function

DIGITS = 50
_NEGLIGIBLE = sympy.Float("1e-40", DIGITS)

Vec = tuple[sympy.Expr, sympy.Expr, sympy.Expr]
Columns = tuple[Vec, Vec, Vec]
"""A 3x3 matrix by columns."""


@dataclass(frozen=True)
class Closure:
    """Inputs of a tape that are what makes as many of its lines 0: functions of the other inputs."""

    unknowns: tuple[sympy.Symbol, ...]
    residuals: tuple[sympy.Expr, ...]


class Tape:
    """Records `name = expression` in order; equal expressions share one name, so derivations may recompute freely."""

    def __init__(self) -> None:
        self._closures: dict[tuple[sympy.Symbol, ...], Closure] = {}
        self._entries: list[tuple[sympy.Symbol, sympy.Expr]] = []
        self._known: dict[sympy.Expr, sympy.Symbol] = {}
        self._uses: Counter[str] = Counter()

    def let(self, name: str, expression: sympy.Expr) -> sympy.Expr:
        """The expression under a name; numbers and (negated) symbols stay as they are."""
        if expression.is_number:
            return constant(expression)
        if expression.is_Symbol or _is_negated_symbol(expression):
            return expression
        if (known := self._known.get(expression)) is not None:
            return known
        if (excess := _negative_excess(expression)) > 0:
            return -self.let(name, -expression)
        if excess == 0 and (opposite := self._known.get(-expression)) is not None:
            return -opposite
        self._uses[name] += 1
        symbol = sympy.Symbol(name if self._uses[name] == 1 else f"{name}_{self._uses[name]}")
        self._entries.append((symbol, expression))
        self._known[expression] = symbol
        return symbol

    @property
    def lines(self) -> tuple[tuple[sympy.Symbol, sympy.Expr], ...]:
        """What is on the tape, in order."""
        return tuple(self._entries)

    @property
    def closures(self) -> tuple[Closure, ...]:
        """Inputs that depend on others, in order."""
        return tuple(self._closures.values())

    def close(self, unknowns: tuple[sympy.Symbol, ...], residuals: tuple[sympy.Expr, ...]) -> None:
        """Inputs that make the residuals 0; they may rest on those of earlier closures. Said again, it is the same."""
        self._closures.setdefault(unknowns, Closure(unknowns, residuals))

    def fork(self) -> "Tape":
        """Another tape that begins with what is on this one."""
        other = Tape()
        other._entries, other._known, other._uses = list(self._entries), dict(self._known), Counter(self._uses)
        other._closures = dict(self._closures)
        return other

    def vector(self, name: str, vector: Sequence[sympy.Expr]) -> Vec:
        """Three components under `name_x`, `name_y`, `name_z`."""
        x, y, z = (self.let(f"{name}_{axis}", component) for axis, component in zip("xyz", vector, strict=True))
        return (x, y, z)

    def function(self, signature: Signature, outputs: Sequence[sympy.Expr]) -> Function:
        """Close the tape so far over the signature; what the outputs do not need is dropped when lowered."""
        inputs = tuple(symbol for port in signature.inputs for symbol in symbols_of(port))
        return Function(signature, inputs, tuple(self._entries), tuple(sympy.sympify(output) for output in outputs))


def symbols_of(port: Port) -> tuple[sympy.Symbol, ...]:
    """The symbols that stand for a port's elements, row-major."""
    if not port.shape:
        return (sympy.Symbol(port.name),)
    return tuple(sympy.Symbol(f"{port.name}[{index}]") for index in range(port.size))


def constant(number: sympy.Expr) -> sympy.Expr:
    """A rational as it is; anything else to 50 digits, with halves that it is recognised (cos 60 degrees is 1/2)."""
    if number.is_Rational:
        return number
    value = number.evalf(DIGITS)
    nearest = sympy.Rational(int(sympy.floor(2 * value + sympy.Rational(1, 2))), 2) if abs(value) < 2 else None
    if nearest is not None and abs(value - nearest) < _NEGLIGIBLE:
        return nearest
    return value


def _is_negated_symbol(expression: sympy.Expr) -> bool:
    return bool(
        expression.is_Mul and len(expression.args) == 2 and expression.args[0] is sympy.S.NegativeOne and expression.args[1].is_Symbol
    )


def _negative_excess(expression: sympy.Expr) -> int:
    """How many more terms of a sum are negative than are not: a sum goes by the name of the one with fewer, the first one at a tie."""
    if not expression.is_Add:
        return 1 if _is_negative(expression) else -1
    return sum(1 if _is_negative(term) else -1 for term in expression.args)


def _is_negative(term: sympy.Expr) -> bool:
    number = term.args[0] if term.is_Mul else term
    return bool(number.is_Number and number < 0)


ZERO_VECTOR: Vec = (sympy.S.Zero, sympy.S.Zero, sympy.S.Zero)
IDENTITY: Columns = (
    (sympy.S.One, sympy.S.Zero, sympy.S.Zero),
    (sympy.S.Zero, sympy.S.One, sympy.S.Zero),
    (sympy.S.Zero, sympy.S.Zero, sympy.S.One),
)


def cross(a: Vec, b: Vec) -> Vec:
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Sequence[sympy.Expr], b: Sequence[sympy.Expr]) -> sympy.Expr:
    """Sum of products."""
    return sympy.Add(*(x * y for x, y in zip(a, b, strict=True)))


def plus(a: Vec, b: Vec) -> Vec:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def minus(a: Vec, b: Vec) -> Vec:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(factor: sympy.Expr, a: Vec) -> Vec:
    """factor * a."""
    return (factor * a[0], factor * a[1], factor * a[2])


def times(matrix: Columns, vector: Vec) -> Vec:
    """matrix * vector."""
    x, y, z = (dot((matrix[0][row], matrix[1][row], matrix[2][row]), vector) for row in range(3))
    return (x, y, z)


def constant_vector(vector: Vec) -> Vec:
    """Fold the components that are numbers."""
    x, y, z = (constant(component) if component.is_number else component for component in vector)
    return (x, y, z)

"""Values with first and second derivatives of a spec's expressions, operation by operation on a tape: nothing is expanded."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import sympy

from walkgen.spec.scalar import Apply, Exact, Name, Scalar
from walkgen.symbolic.frames import Parameters, expression
from walkgen.symbolic.tape import Tape

_ONE, _ZERO = sympy.S.One, sympy.S.Zero


@dataclass(frozen=True)
class Jet:
    """A value, its gradient [m], and its second derivatives [m, m] (symmetric)."""

    value: sympy.Expr
    first: tuple[sympy.Expr, ...]
    second: tuple[tuple[sympy.Expr, ...], ...]


def ratio(above: sympy.Expr, below: sympy.Expr, anything: sympy.Expr) -> sympy.Expr:
    """above / below; NaN, whatever `anything` is, where below is the number 0, which algebra does not divide by."""
    return sympy.sqrt(-1 - anything**2) if below == 0 else above / below


class Jets:
    """Jets of expressions in some coordinates; intermediates go onto the tape under `name`.

    Args:
        tape: where intermediates are written.
        name: what they are called, with the coordinates differentiated by.
        coordinates: the variables' names in the spec, and what stands for them.
        parameters: symbols of the runtime parameters.
    """

    def __init__(self, tape: Tape, name: str, coordinates: Mapping[str, sympy.Expr], parameters: Parameters) -> None:
        self._tape, self._name, self._parameters = tape, name, parameters
        self._coordinates = coordinates
        self._places = tuple(coordinates)
        self._anything = coordinates[self._places[0]]

    def of(self, scalar: Scalar) -> Jet:
        """The expression's jet."""
        if isinstance(scalar, Name) and scalar.name in self._coordinates:
            place = self._places.index(scalar.name)
            return self._jet(self._coordinates[scalar.name], lambda i: _ONE if i == place else _ZERO, lambda _i, _j: _ZERO)
        if isinstance(scalar, Apply):
            return _RULES[scalar.function](self, *scalar.arguments)
        return self._jet(expression(scalar, self._parameters), lambda _: _ZERO, lambda _i, _j: _ZERO)

    def _jet(self, value: sympy.Expr, first: Callable[[int], sympy.Expr], second: Callable[[int, int], sympy.Expr]) -> Jet:
        let, names = self._let, self._places
        upper = {(i, j): let(f"_{names[i]}{names[j]}", second(i, j)) for i in range(len(names)) for j in range(i, len(names))}
        matrix = tuple(tuple(upper[min(i, j), max(i, j)] for j in range(len(names))) for i in range(len(names)))
        return Jet(let("", value), tuple(let(f"_{name}", first(i)) for i, name in enumerate(names)), matrix)

    def _let(self, suffix: str, expression: sympy.Expr) -> sympy.Expr:
        return self._tape.let(self._name + suffix, expression)

    def sum(self, left: Scalar, right: Scalar, sign: int = 1) -> Jet:
        """(a + b)' = a' + b'."""
        a, b = self.of(left), self.of(right)
        second = lambda i, j: a.second[i][j] + sign * b.second[i][j]  # noqa: E731 - a formula with its indices
        return self._jet(a.value + sign * b.value, lambda i: a.first[i] + sign * b.first[i], second)

    def negative(self, argument: Scalar) -> Jet:
        """(-a)' = -a'."""
        a = self.of(argument)
        return self._jet(-a.value, lambda i: -a.first[i], lambda i, j: -a.second[i][j])

    def product(self, left: Scalar, right: Scalar) -> Jet:
        """(ab)' = a'b + ab'."""
        return self._product(self.of(left), self.of(right))

    def _product(self, a: Jet, b: Jet) -> Jet:
        def second(i: int, j: int) -> sympy.Expr:
            return a.second[i][j] * b.value + a.first[i] * b.first[j] + a.first[j] * b.first[i] + a.value * b.second[i][j]

        return self._jet(a.value * b.value, lambda i: a.first[i] * b.value + a.value * b.first[i], second)

    def quotient(self, dividend: Scalar, divisor: Scalar) -> Jet:
        """(a/b)' = (a' - (a/b) b') / b."""
        a, b = self.of(dividend), self.of(divisor)
        q = self._let("", ratio(a.value, b.value, self._anything))
        first = [self._let(f"_{name}", ratio(a.first[i] - q * b.first[i], b.value, self._anything)) for i, name in enumerate(self._places)]

        def second(i: int, j: int) -> sympy.Expr:
            change = a.second[i][j] - first[i] * b.first[j] - first[j] * b.first[i] - q * b.second[i][j]
            return ratio(change, b.value, self._anything)

        return self._jet(q, lambda i: first[i], second)

    def power(self, base: Scalar, exponent: Scalar) -> Jet:
        """(a^n)' = n a^(n-1) a'."""
        assert isinstance(exponent, Exact)
        n = int(exponent.value)
        a = self.of(base)
        return self._chain(a, a.value**n, n * a.value ** (n - 1), n * (n - 1) * a.value ** (n - 2))

    def root(self, argument: Scalar) -> Jet:
        """sqrt(a)' = a' / (2 sqrt a)."""
        return self._root(self.of(argument))

    def _root(self, a: Jet) -> Jet:
        root = self._let("_root", sympy.sqrt(a.value))
        slope = self._let("_slope", 1 / (2 * root))
        return self._chain(a, root, slope, -slope / (2 * a.value))

    def sine(self, argument: Scalar) -> Jet:
        """sin(a)' = cos(a) a'."""
        a = self.of(argument)
        sine, cosine = self._let("_sin", sympy.sin(a.value)), self._let("_cos", sympy.cos(a.value))
        return self._chain(a, sine, cosine, -sine)

    def cosine(self, argument: Scalar) -> Jet:
        """cos(a)' = -sin(a) a'."""
        a = self.of(argument)
        sine, cosine = self._let("_sin", sympy.sin(a.value)), self._let("_cos", sympy.cos(a.value))
        return self._chain(a, cosine, -sine, -cosine)

    def tangent(self, argument: Scalar) -> Jet:
        """tan(a)' = (1 + tan(a)^2) a'."""
        a = self.of(argument)
        tangent = self._let("_tan", sympy.tan(a.value))
        slope = self._let("_slope", 1 + tangent**2)
        return self._chain(a, tangent, slope, 2 * tangent * slope)

    def _chain(self, a: Jet, value: sympy.Expr, slope: sympy.Expr, bend: sympy.Expr) -> Jet:
        """f(a) with f' and f'' at a."""
        slope, bend = self._let("_slope", slope), self._let("_bend", bend)
        return self._jet(value, lambda i: slope * a.first[i], lambda i, j: bend * a.first[i] * a.first[j] + slope * a.second[i][j])

    def arctangent(self, opposite: Scalar, adjacent: Scalar) -> Jet:
        """atan2(y, x)' = (x y' - y x') / (x^2 + y^2)."""
        y, x = self.of(opposite), self.of(adjacent)
        square = self._let("_square", x.value**2 + y.value**2)
        first = [self._let(f"_{n}", (x.value * y.first[i] - y.value * x.first[i]) / square) for i, n in enumerate(self._places)]

        def second(i: int, j: int) -> sympy.Expr:
            turning = x.first[j] * y.first[i] + x.value * y.second[i][j] - y.first[j] * x.first[i] - y.value * x.second[i][j]
            return (turning - 2 * first[i] * (x.value * x.first[j] + y.value * y.first[j])) / square

        return self._jet(sympy.atan2(y.value, x.value), lambda i: first[i], second)

    def hypotenuse(self, left: Scalar, right: Scalar) -> Jet:
        """sqrt(a^2 + b^2)."""
        a, b = self.of(left), self.of(right)
        c, d = self._product(a, a), self._product(b, b)
        first, second = (lambda i: c.first[i] + d.first[i]), (lambda i, j: c.second[i][j] + d.second[i][j])
        return self._root(self._jet(c.value + d.value, first, second))


_RULES: Mapping[str, Callable[..., Jet]] = {
    "add": Jets.sum,
    "sub": partial(Jets.sum, sign=-1),
    "neg": Jets.negative,
    "mul": Jets.product,
    "div": Jets.quotient,
    "pow": Jets.power,
    "sqrt": Jets.root,
    "sin": Jets.sine,
    "cos": Jets.cosine,
    "tan": Jets.tangent,
    "atan2": Jets.arctangent,
    "hypot": Jets.hypotenuse,
}

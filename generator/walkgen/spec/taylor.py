"""Values with derivatives by one variable, as truncated power series: arithmetic of doubles, of many digits or of symbols alike."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import factorial
from typing import Any

ORDER = 3
"""Derivatives that are kept."""


@dataclass(frozen=True)
class Field:
    """The numbers that series are made of: what makes one of an integer or fraction, and their functions."""

    number: Callable[[Any], Any]
    pi: Any
    sqrt: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    atan2: Callable[[Any, Any], Any]
    kept: Callable[[Any], Any] = lambda number: number
    """What becomes of every coefficient that is computed: names for intermediates of symbols."""


class Taylor:
    """c[0] + c[1] t + c[2] t^2 + ..., with `evaluate`'s operators."""

    def __init__(self, field: Field, coefficients: Sequence[Any]) -> None:
        self.field, self.c = field, tuple(coefficients)

    @property
    def derivatives(self) -> tuple[Any, ...]:
        """The value and its derivatives."""
        return tuple(factorial(k) * entry for k, entry in enumerate(self.c))

    def of(self, coefficients: Sequence[Any]) -> "Taylor":
        """Another series of the field."""
        return Taylor(self.field, [self.field.kept(entry) for entry in coefficients])

    def __int__(self) -> int:
        """Of an exponent, which is a whole number."""
        return int(self.c[0])

    def __pos__(self) -> "Taylor":
        return self

    def __neg__(self) -> "Taylor":
        return self.of([-a for a in self.c])

    def __add__(self, other: "Taylor") -> "Taylor":
        return self.of([a + b for a, b in zip(self.c, other.c, strict=True)])

    def __sub__(self, other: "Taylor") -> "Taylor":
        return self.of([a - b for a, b in zip(self.c, other.c, strict=True)])

    def __mul__(self, other: "Taylor") -> "Taylor":
        return self.of([self._convolved(self.c, other.c, k) for k in range(len(self.c))])

    def __truediv__(self, other: "Taylor") -> "Taylor":
        """q b = a, coefficient by coefficient."""
        found: list[Any] = []
        for k, a in enumerate(self.c):
            found.append(self.field.kept((a - self._sum(found[j] * other.c[k - j] for j in range(k))) / other.c[0]))
        return self.of(found)

    def __pow__(self, exponent: int) -> "Taylor":
        """By squaring; a negative one divides."""
        if exponent < 0:
            return self.constant(1) / self**-exponent
        power, factor = self.constant(1), self
        while exponent:
            power = power * factor if exponent % 2 else power
            factor, exponent = factor * factor, exponent // 2
        return power

    def constant(self, number: Any) -> "Taylor":
        """A number of the field as a series as long as this one."""
        return constant(self.field, number, len(self.c))

    def slope(self) -> "Taylor":
        """The derivative, one coefficient shorter."""
        return self.of([k * entry for k, entry in enumerate(self.c)][1:])

    def shortened(self) -> "Taylor":
        """Without the last coefficient."""
        return self.of(self.c[:-1])

    def rise(self, start: Any) -> "Taylor":
        """The integral from `start` on, one coefficient longer."""
        return self.of([start, *(entry / self.field.number(k) for k, entry in enumerate(self.c, 1))])

    def _convolved(self, a: Sequence[Any], b: Sequence[Any], k: int) -> Any:
        return self._sum(a[j] * b[k - j] for j in range(k + 1))

    def _sum(self, terms: Any) -> Any:
        return sum(terms, self.field.number(0))


def constant(field: Field, number: Any, count: int = ORDER + 1) -> Taylor:
    """A series of a number alone."""
    return Taylor(field, [field.number(number), *[field.number(0)] * (count - 1)])


def variable(field: Field, value: Any, count: int = ORDER + 1) -> Taylor:
    """The series of what is differentiated by."""
    return Taylor(field, [value, field.number(1), *[field.number(0)] * (count - 2)][:count])


@dataclass(frozen=True)
class Arithmetic:
    """What `walkgen.spec.scalar.evaluate` needs to compute with series of a field."""

    field: Field
    count: int = ORDER + 1

    @property
    def pi(self) -> Taylor:
        """As a series."""
        return Taylor(self.field, [self.field.pi, *[self.field.number(0)] * (self.count - 1)])

    def mpf(self, number: Any) -> Taylor:
        """An exact number as a series."""
        return constant(self.field, number, self.count)

    def sqrt(self, a: Taylor) -> Taylor:
        """r r = a, coefficient by coefficient."""
        found = [self.field.sqrt(a.c[0])]
        for k in range(1, len(a.c)):
            inner = sum((found[j] * found[k - j] for j in range(1, k)), self.field.number(0))
            found.append(self.field.kept((a.c[k] - inner) / (self.field.number(2) * found[0])))
        return a.of(found)

    def sin(self, a: Taylor) -> Taylor:
        """sin' = a' cos."""
        return a.of(self._turned(a)[0])

    def cos(self, a: Taylor) -> Taylor:
        """cos' = -a' sin."""
        return a.of(self._turned(a)[1])

    def _turned(self, a: Taylor) -> tuple[list[Any], list[Any]]:
        sine, cosine, nil = [self.field.sin(a.c[0])], [self.field.cos(a.c[0])], self.field.number(0)
        for k in range(1, len(a.c)):
            weights = [self.field.number(j) * a.c[j] / self.field.number(k) for j in range(1, k + 1)]
            rise = sum((w * cosine[k - j] for j, w in enumerate(weights, 1)), nil)
            fall = sum((w * sine[k - j] for j, w in enumerate(weights, 1)), nil)
            sine.append(self.field.kept(rise))
            cosine.append(self.field.kept(-fall))
        return sine, cosine

    def tan(self, a: Taylor) -> Taylor:
        """sin / cos."""
        return self.sin(a) / self.cos(a)

    def atan2(self, y: Taylor, x: Taylor) -> Taylor:
        """(x y' - y x') / (x^2 + y^2), integrated."""
        value = self.field.atan2(y.c[0], x.c[0])
        if len(x.c) == 1:
            return x.of([value])
        a, b = x.shortened(), y.shortened()
        return ((a * y.slope() - b * x.slope()) / (a * a + b * b)).rise(value)

    def hypot(self, a: Taylor, b: Taylor) -> Taylor:
        """sqrt(a^2 + b^2)."""
        return self.sqrt(a * a + b * b)

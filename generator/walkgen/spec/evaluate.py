"""Values of a spec's numbers at its parameters' values, for rules that need a size; and the rules of parameters themselves."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from graphlib import CycleError, TopologicalSorter

from walkgen.spec.problems import Finding
from walkgen.spec.scalar import Apply, ExpressionError, Name, Scalar, evaluate, names, substitute
from walkgen.spec.schema import ParameterSpec

_MOST_TERMS = 5_000


class Uncomputable(ValueError):
    """A number that does not exist at the parameters' values; the message says why."""


class _Doubles:
    """What `evaluate` needs: fractions where all is rational, doubles elsewhere."""

    mpf = Fraction
    pi = math.pi
    sqrt = staticmethod(math.sqrt)
    sin = staticmethod(math.sin)
    cos = staticmethod(math.cos)
    tan = staticmethod(math.tan)
    atan2 = staticmethod(math.atan2)
    hypot = staticmethod(math.hypot)


@dataclass(frozen=True)
class Numbers:
    """`constants` replace names, `values` are what every parameter is worth, `terms` how long it is when written out."""

    constants: Mapping[str, Scalar]
    values: Mapping[str, float]
    terms: Mapping[str, int]

    def value(self, scalar: Scalar) -> Fraction | float | None:
        """The scalar's value; None where it uses a name that has none.

        Raises:
            Uncomputable: division by zero, root of a negative number, too large for a double.
        """
        if not names(scalar) <= self.values.keys():
            return None
        if _terms(scalar, self.terms) > _MOST_TERMS:
            raise Uncomputable(f"written out, the expression has more than {_MOST_TERMS} terms")
        try:
            number: Fraction | float = evaluate(substitute(scalar, self.constants), _Doubles, self.values)
            if not math.isfinite(number):
                raise Uncomputable("the value is too large for a double")
        except OverflowError:
            raise Uncomputable("the value is too large for a double") from None
        except (ArithmeticError, ExpressionError, ValueError) as error:
            raise Uncomputable(str(error)) from None
        return number

    def number(self, scalar: Scalar | None) -> Fraction | float | None:
        """The scalar's value, None where it has none."""
        try:
            return None if scalar is None else self.value(scalar)
        except Uncomputable:
            return None


def numbers_of(parameters: Mapping[str, ParameterSpec]) -> tuple[Numbers, tuple[Finding, ...]]:
    """The parameters' values, and what is wrong with how they depend on each other."""
    constants: dict[str, Scalar] = {}
    values: dict[str, float] = {}
    terms: dict[str, int] = {}
    numbers = Numbers(constants, values, terms)
    order, findings = _ordered(parameters)
    for name in order:
        scalar = parameters[name].value
        number = numbers.number(scalar)
        if number is None:
            continue  # the general check of every number says why
        values[name] = float(number)
        terms[name] = _terms(scalar, terms)
        if not parameters[name].runtime:
            constants[name] = substitute(scalar, constants)
    known = {name: entry for name, entry in parameters.items() if name in values}
    return numbers, (*findings, *_runtime_dependence(known, constants))


def _ordered(parameters: Mapping[str, ParameterSpec]) -> tuple[list[str], tuple[Finding, ...]]:
    """Parameters after those they use; those on or behind a circle are left out."""
    sorter = TopologicalSorter({name: sorted(names(entry.value) & parameters.keys()) for name, entry in parameters.items()})
    findings: tuple[Finding, ...] = ()
    try:
        sorter.prepare()
    except CycleError as error:
        circle = list(reversed(error.args[1]))
        message = f"the parameters depend on each other in a circle: {' -> '.join(circle)}"
        findings = (Finding("WG142", ("parameters", circle[0]), message, "give one of them a number"),)
    order: list[str] = []
    while ready := sorter.get_ready():
        order += ready
        sorter.done(*ready)
    return order, findings


def _runtime_dependence(parameters: Mapping[str, ParameterSpec], constants: Mapping[str, Scalar]) -> Iterator[Finding]:
    """A runtime parameter's default is fixed when the code is generated, so it cannot follow another runtime parameter."""
    for name, entry in parameters.items():
        if entry.runtime:
            others = sorted(other for other in names(substitute(entry.value, constants)) if other in parameters)
            if others and others != [name]:
                message = f'the default of a runtime parameter cannot follow the runtime parameter "{others[0]}"'
                yield Finding("WG167", ("parameters", name), message, "give a number, or use the other parameter's own value")


def _terms(scalar: Scalar, terms: Mapping[str, int]) -> int:
    if isinstance(scalar, Name):
        return terms.get(scalar.name, 1)
    if isinstance(scalar, Apply):
        return 1 + sum(_terms(argument, terms) for argument in scalar.arguments)
    return 1

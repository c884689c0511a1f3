"""Derivatives of a Program by one of its inputs, forward mode on value-numbered ops: exact, and shared with the value itself."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import accumulate

from walkgen.graph.number import Numbering
from walkgen.graph.passes import fused, pruned, scheduled
from walkgen.graph.program import TRUTH_CODES, Call, Code, Composite, Program
from walkgen.signature import Port, Signature

_ZERO, _ONE, _TWO = Decimal(0), Decimal(1), Decimal(2)


def derivative(program: Program, port: str, moving: Collection[str] = ()) -> Program:
    """`<name>_d_<port>`: every output port gains the input port's shape at its end.

    Args:
        program: without fused ops; choices are differentiated branch by branch, truths not at all.
        port: name of the real input port to differentiate by.
        moving: names of other input ports that are functions of it; their derivatives are inputs as well, after all others.
    """
    declared = next(p for p in program.signature.inputs if p.name == port)
    inputs = (*program.signature.inputs, *(_derived(p, declared) for p in program.signature.inputs if p.name in moving))
    numbering = Numbering(replace(program.signature, inputs=inputs))
    columns = [_Forward(numbering, program, _Moved(inputs, declared, element)).tangents for element in range(declared.size)]
    outputs = tuple(column[number] for number in program.outputs for column in columns)
    return scheduled(pruned(Program(replace(_signature(program.signature, declared), inputs=inputs), numbering.ops, outputs)))


def composite_derivative(composite: Composite, plain: Composite, port: str, fma: bool) -> Composite | None:
    """The same of a function whose last call computes its outputs from what earlier ones find; None where nothing tells how these move.

    Args:
        composite: the function.
        plain: the same without fused ops.
        port: as above.
        fma: whether to fuse multiply-adds.
    """
    *before, last = composite.calls
    callee = plain.calls[-1].callee
    if not composite.slopes or not isinstance(callee, Program):
        return None
    declared = next(p for p in composite.signature.inputs if p.name == port)
    moving = [p for p in callee.signature.inputs if any(f"{p.name}_d_{port}" in call.arguments for call in composite.slopes)]
    derived = derivative(callee, port, [p.name for p in moving])
    rates = tuple(_derived(p, declared) for p in moving)
    count = len(callee.signature.inputs)
    results = (f"{name}_d_{port}" for name in last.arguments[count:])
    call = Call(fused(derived) if fma else derived, (*last.arguments[:count], *(p.name for p in rates), *results))
    form, other = composite.closed_form, plain.closed_form
    derived_form = composite_derivative(form, other, port, fma) if isinstance(form, Composite) and isinstance(other, Composite) else None
    return replace(
        composite,
        signature=_signature(composite.signature, declared),
        locals=(*composite.locals, *rates),
        calls=(*before, *composite.slopes, call),
        closed_form=derived_form,
        slopes=(),
    )


def _derived(port: Port, by: Port) -> Port:
    return replace(port, name=f"{port.name}_d_{by.name}", shape=port.shape + by.shape, unit=f"{port.unit} per unit")


def _signature(signature: Signature, port: Port) -> Signature:
    outputs = tuple(_derived(out, port) for out in signature.outputs)
    doc = f"Derivatives of {signature.name} by {port.name}."
    return replace(signature, name=f"{signature.name}_d_{port.name}", outputs=outputs, doc=doc, source="forward differentiation")


class _Moved:
    """Tangents of inputs where one element of a port moves, and with it ports whose derivatives by it are inputs."""

    def __init__(self, inputs: tuple[Port, ...], port: Port, element: int) -> None:
        names, starts = [p.name for p in inputs], list(accumulate((p.size for p in inputs), initial=0))
        self._one = names.index(port.name), element
        rates = ((index, f"{name}_d_{port.name}") for index, name in enumerate(names))
        self._rates = {index: (starts[names.index(name)] + element, port.size) for index, name in rates if name in names}

    def tangent(self, element: tuple[int, int], constant: Callable[[Decimal], int]) -> int:
        """Of one element of an input."""
        if element[0] in self._rates:
            start, size = self._rates[element[0]]
            return start + size * element[1]
        return constant(_ONE if element == self._one else _ZERO)


@dataclass(frozen=True)
class _Value:
    """An op being differentiated: its own number, its arguments' numbers and tangents."""

    number: int
    arguments: tuple[int, ...]
    tangents: tuple[int, ...]


class _Forward:
    """Copies a Program into a numbering and carries the tangent of one input element along."""

    def __init__(self, numbering: Numbering, program: Program, moved: _Moved) -> None:
        self._op, self._constant = numbering.op, numbering.constant
        self._zero = self._constant(_ZERO)
        self.tangents: list[int] = []
        numbers: list[int] = []
        for position, op in enumerate(program.ops):
            if op.code is Code.INPUT:
                numbers.append(position)
                self.tangents.append(moved.tangent(op.element, self._constant))
            elif op.code is Code.CONSTANT:
                numbers.append(self._constant(op.value))
                self.tangents.append(self._zero)
            else:
                arguments = tuple(numbers[argument] for argument in op.arguments)
                numbers.append(numbering.named(self._op(op.code, *arguments), op.name))
                value = _Value(numbers[-1], arguments, tuple(self.tangents[argument] for argument in op.arguments))
                self.tangents.append(self._tangent(op.code, value))

    def _tangent(self, code: Code, value: _Value) -> int:
        """Zero where no argument moves (a condition never does): the rules below would divide 0 by what may be 0."""
        if code in TRUTH_CODES or all(tangent == self._zero for tangent in value.tangents):
            return self._zero
        return _RULES[code](self, value)

    def _plus(self, left: int, right: int) -> int:
        return self._op(Code.ADD, left, right)

    def _times(self, left: int, right: int) -> int:
        return self._op(Code.MUL, left, right)

    def product(self, value: _Value) -> int:
        """(ab)' = a'b + ab'."""
        (a, b), (da, db) = value.arguments, value.tangents
        return self._plus(self._times(da, b), self._times(a, db))

    def quotient(self, value: _Value) -> int:
        """(a/b)' = (a' - (a/b) b') / b."""
        (_, b), (da, db) = value.arguments, value.tangents
        return self._op(Code.DIV, self._op(Code.SUB, da, self._times(value.number, db)), b)

    def root(self, value: _Value) -> int:
        """sqrt(a)' = a' / (2 sqrt a)."""
        return self._op(Code.DIV, value.tangents[0], self._times(self._constant(_TWO), value.number))

    def sine(self, value: _Value) -> int:
        """sin(a)' = cos(a) a'."""
        return self._times(self._op(Code.COS, value.arguments[0]), value.tangents[0])

    def cosine(self, value: _Value) -> int:
        """cos(a)' = -sin(a) a'."""
        return self._op(Code.NEG, self._times(self._op(Code.SIN, value.arguments[0]), value.tangents[0]))

    def tangent(self, value: _Value) -> int:
        """tan(a)' = (1 + tan(a)^2) a'."""
        return self._times(self._plus(self._constant(_ONE), self._times(value.number, value.number)), value.tangents[0])

    def arctangent(self, value: _Value) -> int:
        """atan2(y, x)' = (x y' - y x') / (x^2 + y^2)."""
        (y, x), (dy, dx) = value.arguments, value.tangents
        numerator = self._op(Code.SUB, self._times(x, dy), self._times(y, dx))
        return self._op(Code.DIV, numerator, self._plus(self._times(x, x), self._times(y, y)))

    def absolute(self, value: _Value) -> int:
        """|a|' = a' or -a'."""
        negative = self._op(Code.LESS, value.arguments[0], self._constant(_ZERO))
        return self._op(Code.SELECT, negative, self._op(Code.NEG, value.tangents[0]), value.tangents[0])

    def smaller(self, value: _Value) -> int:
        """min(a, b)': of the one taken."""
        return self._op(Code.SELECT, self._op(Code.LESS, *value.arguments), *value.tangents)

    def larger(self, value: _Value) -> int:
        """max(a, b)': of the one taken."""
        return self._op(Code.SELECT, self._op(Code.LESS, *value.arguments[::-1]), *value.tangents)

    def choice(self, value: _Value) -> int:
        """select(c, a, b)' = select(c, a', b')."""
        return self._op(Code.SELECT, value.arguments[0], *value.tangents[1:])

    def sum_rule(self, value: _Value) -> int:
        """(a + b)' = a' + b'."""
        return self._op(Code.ADD, *value.tangents)

    def difference(self, value: _Value) -> int:
        """(a - b)' = a' - b'."""
        return self._op(Code.SUB, *value.tangents)

    def negative(self, value: _Value) -> int:
        """(-a)' = -a'."""
        return self._op(Code.NEG, value.tangents[0])


_RULES: dict[Code, Callable[[_Forward, _Value], int]] = {
    Code.ADD: _Forward.sum_rule,
    Code.SUB: _Forward.difference,
    Code.NEG: _Forward.negative,
    Code.MUL: _Forward.product,
    Code.DIV: _Forward.quotient,
    Code.SQRT: _Forward.root,
    Code.SIN: _Forward.sine,
    Code.COS: _Forward.cosine,
    Code.TAN: _Forward.tangent,
    Code.ATAN2: _Forward.arctangent,
    Code.ABS: _Forward.absolute,
    Code.MIN: _Forward.smaller,
    Code.MAX: _Forward.larger,
    Code.SELECT: _Forward.choice,
}

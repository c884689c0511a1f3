"""Functions as equations and Programs as numbered operations, for people to read."""

import difflib
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import Protocol, TypeVar

import sympy

from walkgen.errors import Problem, SpecError
from walkgen.graph.program import Call, Code, Composite, Op, Program
from walkgen.signature import Port, Signature
from walkgen.symbolic.function import Derivation, Function, Step

_SIGNIFICANT = 17
_OPERATORS = {
    Code.ADD: "{} + {}",
    Code.SUB: "{} - {}",
    Code.MUL: "{} * {}",
    Code.DIV: "{} / {}",
    Code.NEG: "-{}",
    Code.FMA: "{} * {} + {}",
    Code.FMS: "{} * {} - {}",
    Code.FNMA: "{2} - {0} * {1}",
    Code.LESS: "{} < {}",
    Code.LESS_EQUAL: "{} <= {}",
    Code.EQUAL: "{} == {}",
    Code.AND: "{} and {}",
    Code.OR: "{} or {}",
    Code.NOT: "not {}",
    Code.SELECT: "{1} if {0} else {2}",
    Code.INDICATOR: "1 if {} else 0",
}


class _Signed(Protocol):
    @property
    def signature(self) -> Signature: ...


Item = TypeVar("Item", bound=_Signed)


def chosen(items: Sequence[Item], name: str) -> tuple[Item, ...]:
    """The functions of that name: full (`mero_front_left_inverse`) or every owner's (`inverse`); all for an empty name.

    Raises:
        SpecError: there is none; the nearest name is given.
    """
    found = tuple(item for item in items if name in {"", item.signature.name, item.signature.full_name})
    if not found:
        names = sorted({item.signature.name for item in items} | {item.signature.full_name for item in items})
        near = difflib.get_close_matches(name, names, 1, 0)
        raise SpecError(Problem("WG519", f"this robot has no function {name!r}", f"did you mean {near[0]!r}?" if near else ""))
    return found


def equations(derivation: Derivation) -> Iterator[str]:
    """The function's named intermediates and outputs, one a line; of a solve, its steps."""
    yield from _head(derivation.signature)
    if isinstance(derivation, Function):
        yield from _expressions(derivation)
        return
    for step in derivation.steps:
        yield f"    {_call(step)}"
    kernels: list[Derivation] = [step.callee for step in derivation.steps if isinstance(step.callee, Function)]
    for inner in (*kernels, *derivation.callbacks):
        yield ""
        yield from equations(inner)


def listing(body: Program | Composite, *, whole: bool) -> Iterator[str]:
    """Operation counts, and with `whole` every operation, numbered."""
    yield from _head(body.signature)
    if isinstance(body, Composite):
        for call in body.calls:
            yield f"    {_call(call)}"
        kernels: list[Program | Composite] = [call.callee for call in body.calls if isinstance(call.callee, Program)]
        for inner in (*kernels, *body.callbacks):
            yield from listing(inner, whole=whole)
        return
    counts = {name: count for name, count in sorted(body.counts().items()) if name not in {Code.INPUT.value, Code.CONSTANT.value}}
    yield f"    {body.operation_count} operations: {', '.join(f'{count} {name}' for name, count in counts.items()) or 'none'}"
    if whole:
        yield from _operations(body)


def _head(signature: Signature) -> Iterator[str]:
    yield f"{signature.full_name}({_ports(signature.inputs)}) -> {_ports(signature.outputs)}"
    for line in (signature.doc, signature.source):
        if line:
            yield f"    {line}"


def _ports(ports: Iterable[Port]) -> str:
    return ", ".join(f"{port.name}{list(port.shape) if port.shape else ''}{f' {port.unit}' if port.unit != '1' else ''}" for port in ports)


def _elements(ports: Iterable[Port]) -> tuple[str, ...]:
    """Each element of each port by name and index, row-major."""
    return tuple(
        f"{port.name}{list(index) if index else ''}".replace(" ", "")
        for port in ports
        for index in product(*(range(size) for size in port.sizes))
    )


def _expressions(function: Function) -> Iterator[str]:
    names = dict(zip(function.inputs, map(sympy.Symbol, _elements(function.signature.inputs)), strict=True))
    for symbol, expression in function.intermediates:
        yield f"    {symbol} = {_text(expression.xreplace(names))}"
    for name, expression in zip(_elements(function.signature.outputs), function.outputs, strict=True):
        yield f"    {name} = {_text(expression.xreplace(names))}"


def _text(expression: sympy.Expr) -> str:
    """The expression with its 50-digit constants shown to double precision."""
    shown = expression.xreplace({number: sympy.Float(number, _SIGNIFICANT) for number in expression.atoms(sympy.Float)})
    return str(sympy.sstr(shown, full_prec=False))


def _call(step: Step | Call) -> str:
    callee = step.callee if isinstance(step.callee, str) else step.callee.signature.full_name
    guard = f"  where {step.guard[0]}({', '.join(map(str, step.guard[1]))})" if step.guard else ""
    return f"{callee}({', '.join(map(str, step.arguments))}){guard}"


def _operations(program: Program) -> Iterator[str]:
    inputs = program.signature.inputs
    for index, op in enumerate(program.ops):
        name = f"  # {op.name}" if op.name else ""
        yield f"    v{index} = {_operation(op, inputs)}{name}"
    for name, index in zip(_elements(program.signature.outputs), program.outputs, strict=True):
        yield f"    {name} = v{index}"


def _operation(op: Op, inputs: tuple[Port, ...]) -> str:
    if op.code is Code.INPUT:
        port, element = op.element
        return _elements(inputs[port : port + 1])[element]
    if op.code is Code.CONSTANT:
        return f"{op.value.normalize():.{_SIGNIFICANT}g}"
    arguments = [f"v{argument}" for argument in op.arguments]
    pattern = _OPERATORS.get(op.code)
    return pattern.format(*arguments) if pattern else f"{op.code.value}({', '.join(arguments)})"

"""Evaluate a Program op by op in plain Python: the oracle, which shares no table with any printer."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from walkgen.graph.program import Code, Op, Program


def interpret(program: Program, inputs: Mapping[str, Sequence[float]], context: Any = math) -> dict[str, list[Any]]:
    """Every output port's elements, row-major.

    Args:
        program: what to evaluate.
        inputs: for each input port its elements, row-major; a scalar port is a sequence of one.
        context: `math` for doubles, or an mpmath context for more digits.

    Returns:
        Elements by output port; integer ports hold int.

    Raises:
        ValueError: an input has the wrong number of elements.
    """
    ports = program.signature.inputs
    for port in ports:
        if len(inputs[port.name]) != port.size:
            raise ValueError(f"{port.name} has {len(inputs[port.name])} elements, not {port.size}")
    number = getattr(context, "mpf", float)
    given = [[number(element) for element in inputs[port.name]] for port in ports]
    values: list[Any] = []
    for op in program.ops:
        values.append(_value(op, values, given, context))
    return _outputs(program, values)


def _outputs(program: Program, values: Sequence[Any]) -> dict[str, list[Any]]:
    elements = iter(program.outputs)
    found: dict[str, list[Any]] = {}
    for port in program.signature.outputs:
        flat = [values[next(elements)] for _ in range(port.size)]
        found[port.name] = flat if port.kind == "real" else [int(value) for value in flat]
    return found


def _value(op: Op, values: Sequence[Any], given: Sequence[Sequence[Any]], context: Any) -> Any:
    if op.code is Code.INPUT:
        port, element = op.element
        return given[port][element]
    if op.code is Code.CONSTANT:
        return context.mpf(str(op.value)) if hasattr(context, "mpf") else float(op.value)
    arguments = [values[index] for index in op.arguments]
    if op.code in _ARITHMETIC:
        return _ARITHMETIC[op.code](*arguments)
    return _FUNCTIONS[op.code](context, *arguments)


def _divide(dividend: Any, divisor: Any) -> Any:
    """As IEEE 754 divides: by zero it is infinite, zero by zero is NaN."""
    if divisor != 0:
        return dividend / divisor
    sign = math.copysign(1.0, float(dividend)) * math.copysign(1.0, float(divisor))
    return sign * math.inf if dividend != 0 and not math.isnan(float(dividend)) else math.nan


def _sqrt(context: Any, square: Any) -> Any:
    return math.nan if square < 0 else context.sqrt(square)


def _circular(name: str) -> Callable[[Any, Any], Any]:
    """sin, cos or tan; NaN for an infinite angle."""
    return lambda context, angle: getattr(context, name)(angle) if context.isfinite(angle) else math.nan


def _select(truth: bool, then: Any, otherwise: Any) -> Any:
    return then if truth else otherwise


_ARITHMETIC: dict[Code, Callable[..., Any]] = {
    Code.NEG: lambda a: -a,
    Code.ADD: lambda a, b: a + b,
    Code.SUB: lambda a, b: a - b,
    Code.MUL: lambda a, b: a * b,
    Code.DIV: _divide,
    Code.FMA: lambda a, b, c: a * b + c,
    Code.FMS: lambda a, b, c: a * b - c,
    Code.FNMA: lambda a, b, c: c - a * b,
    Code.ABS: abs,
    Code.MIN: lambda a, b: a if a < b else b,
    Code.MAX: lambda a, b: a if a > b else b,
    Code.LESS: lambda a, b: bool(a < b),
    Code.LESS_EQUAL: lambda a, b: bool(a <= b),
    Code.EQUAL: lambda a, b: bool(a == b),
    Code.AND: lambda a, b: a and b,
    Code.OR: lambda a, b: a or b,
    Code.NOT: lambda a: not a,
    Code.SELECT: _select,
    Code.INDICATOR: lambda truth: 1.0 if truth else 0.0,
    Code.EPSILON: lambda: math.ulp(1.0),
}
_FUNCTIONS: dict[Code, Callable[..., Any]] = {
    Code.SQRT: _sqrt,
    Code.SIN: _circular("sin"),
    Code.COS: _circular("cos"),
    Code.TAN: _circular("tan"),
    Code.ATAN2: lambda context, y, x: context.atan2(y, x),
    Code.FINITE: lambda context, a: bool(context.isfinite(a)),
}

"""Values of what is on a tape, to 50 digits: for choices that algebra alone cannot make."""

from collections.abc import Mapping, Sequence
from functools import cache, reduce
from operator import mul
from typing import Any

import sympy

from walkgen.model.walk import CONTEXT
from walkgen.symbolic.function import Angle, Less, Select
from walkgen.symbolic.tape import DIGITS, Tape

_FUNCTIONS = {
    sympy.sin: CONTEXT.sin,
    sympy.cos: CONTEXT.cos,
    sympy.tan: CONTEXT.tan,
    sympy.atan2: CONTEXT.atan2,
    Angle: CONTEXT.atan2,
    Less: lambda left, right: left < right,
    Select: lambda truth, then, otherwise: then if truth else otherwise,
}


def tape_values(tape: Tape, given: Mapping[sympy.Symbol, Any]) -> dict[sympy.Symbol, Any]:
    """Every line's value for the inputs' values; lines that rest on other inputs are left out."""
    known = dict(given)
    for symbol, definition in tape.lines:
        if definition.free_symbols <= known.keys():
            known[symbol] = value(definition, known)
    return known


def lines_behind(tape: Tape, wanted: Sequence[sympy.Expr]) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """The lines that expressions rest on, in order."""
    needed = {symbol for expression in wanted for symbol in expression.free_symbols}
    found = []
    for symbol, definition in reversed(tape.lines):
        if symbol in needed:
            needed |= definition.free_symbols
            found.append((symbol, definition))
    return found[::-1]


def value(expression: sympy.Expr, known: Mapping[sympy.Symbol, Any]) -> Any:
    """The value of sums, products, powers, circular functions and choices of known symbols."""
    if expression.is_Symbol:
        return known[expression]
    if expression.is_number:
        return _number(expression)
    arguments: Sequence[Any] = [value(argument, known) for argument in expression.args]
    if expression.is_Add:
        return sum(arguments)
    if expression.is_Mul:
        return reduce(mul, arguments)
    if expression.is_Pow:
        return arguments[0] ** arguments[1]
    return _FUNCTIONS[expression.func](*arguments)


@cache
def _number(expression: sympy.Expr) -> Any:
    return CONTEXT.mpf(str(expression.evalf(DIGITS)))

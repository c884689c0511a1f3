"""Values of what is on a tape, to 50 digits: for choices that algebra alone cannot make."""

from collections.abc import Mapping, Sequence
from functools import reduce
from operator import mul
from typing import Any

import sympy

from walkgen.model.walk import CONTEXT
from walkgen.symbolic.tape import DIGITS, Tape

_FUNCTIONS = {sympy.sin: CONTEXT.sin, sympy.cos: CONTEXT.cos, sympy.tan: CONTEXT.tan, sympy.atan2: CONTEXT.atan2}


def tape_values(tape: Tape, given: Mapping[sympy.Symbol, Any]) -> dict[sympy.Symbol, Any]:
    """Every line's value for the inputs' values; lines that rest on other inputs are left out."""
    known = dict(given)
    for symbol, definition in tape.lines:
        if definition.free_symbols <= known.keys():
            known[symbol] = value(definition, known)
    return known


def value(expression: sympy.Expr, known: Mapping[sympy.Symbol, Any]) -> Any:
    """The value of sums, products, powers and circular functions of known symbols."""
    if expression.is_Symbol:
        return known[expression]
    if expression.is_number:
        return CONTEXT.mpf(str(expression.evalf(DIGITS)))
    arguments: Sequence[Any] = [value(argument, known) for argument in expression.args]
    if expression.is_Add:
        return sum(arguments)
    if expression.is_Mul:
        return reduce(mul, arguments)
    if expression.is_Pow:
        return arguments[0] ** arguments[1]
    return _FUNCTIONS[expression.func](*arguments)

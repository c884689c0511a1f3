"""sympy's `cse` and C printer on the leg's recursions; a whole robot's expressions are more than `cse` finishes."""

from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

from motions import DynamicFunction
from peers.dynamics_source import HEAD, LEG, LEG_FORMS, adapter, core, entrant, expressions
from peers.source import Peer, Source
from peers.sympy_c import ALGEBRA


def _core(function: DynamicFunction, form: str, optimizations: str | None) -> str:
    ports = {name: sp.symbols(f"{name}_:{size}", real=True) for name, size in function.inputs}
    numbers = {symbol: sp.Symbol(f"{name}[{index}]") for name, symbols in ports.items() for index, symbol in enumerate(symbols)}
    elements = expressions(function, ALGEBRA, {name: list(symbols) for name, symbols in ports.items()}, form)
    shared, reduced = sp.cse(list(map(sp.sympify, elements)), optimizations=optimizations)
    lines = [f"    const double {symbol} = {_text(x, numbers)};" for symbol, x in shared]
    return core(function, "\n".join([*lines, *(f"    out[{place}] = {_text(x, numbers)};" for place, x in enumerate(reduced))]))


def _text(expression: Any, numbers: Mapping[Any, Any]) -> str:
    """C, with rational constants as decimals so that no division is left at run time."""
    decimal = expression.xreplace(numbers).replace(lambda x: x.is_Rational and not x.is_Integer, lambda x: sp.Float(x, 17))
    return str(sp.ccode(decimal))


def _source(functions: Sequence[DynamicFunction], form: str, optimizations: str | None) -> Source:
    label = f"{form}, cse {optimizations}" if optimizations else form
    bodies = (_core(function, form, optimizations) for function in functions)
    return Source(entrant("sympy cse", form), label, "\n".join([HEAD, *bodies, adapter(functions)]))


PEER = Peer("sympy cse", lambda: tuple(_source(LEG, form, how) for form in LEG_FORMS for how in (None, "basic")), "sympy")

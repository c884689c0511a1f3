"""sympy's `cse` and C printer: the expressions of the formulas, common subexpressions named, each printed by `ccode`."""

from collections.abc import Sequence
from typing import Any

import sympy as sp

from peers.formulas import FORMS, Algebra, inverse, inverse_branch, position
from peers.source import ADAPTER, CORES, Peer, Source, core

ALGEBRA = Algebra(sp.sin, sp.cos, sp.sqrt, sp.acos, sp.atan2, sp.Min, sp.Max, sp.Rational)
Q, P, SIGNS = sp.symbols("q:3", real=True), sp.symbols("p:3", real=True), sp.symbols("signs:2", real=True)


def expressions(form: str) -> dict[str, list[list[Any]]]:
    """Every function's outputs, one list a port."""
    foot = position(ALGEBRA, Q, form)
    return {
        "foot_position": [foot],
        "foot_position_jacobian": [foot, [sp.diff(x, a) for x in foot for a in Q]],
        "foot_hessian": [[sp.diff(x, a, b) for x in foot for a in Q for b in Q]],
        "inverse_branch": [inverse_branch(ALGEBRA, P, SIGNS, form)],
        "inverse": [inverse(ALGEBRA, P, form)],
    }


def _body(name: str, ports: Sequence[Sequence[Any]], optimizations: str | None) -> str:
    _, outputs = CORES[name]
    shared, reduced = sp.cse([x for port in ports for x in port], optimizations=optimizations)
    places = [f"{output}[{i}]" for output, port in zip(outputs, ports, strict=True) for i in range(len(port))]
    numbers = {x: sp.Symbol(f"{x.name[:-1]}[{x.name[-1]}]") for x in (*Q, *P, *SIGNS)}
    lines = [f"    const double {symbol} = {_text(x, numbers)};" for symbol, x in shared]
    return "\n".join(lines + [f"    {place} = {_text(x, numbers)};" for place, x in zip(places, reduced, strict=True)])


def _text(expression: Any, numbers: dict[Any, Any]) -> str:
    """C, with rational constants as decimals so that no division is left at run time."""
    decimal = expression.xreplace(numbers).replace(lambda x: x.is_Rational and not x.is_Integer, lambda x: sp.Float(x, 17))
    return str(sp.ccode(decimal))


def _source(form: str, optimizations: str | None) -> Source:
    bodies = (core(name, _body(name, ports, optimizations)) for name, ports in expressions(form).items())
    label = f"{form}, cse {optimizations}" if optimizations else form
    return Source("sympy cse", label, "\n".join(["#include <math.h>\n", *bodies]) + ADAPTER)


def _sources() -> tuple[Source, ...]:
    return tuple(_source(form, optimizations) for form in FORMS for optimizations in (None, "basic"))


PEER = Peer("sympy cse", _sources, "sympy")

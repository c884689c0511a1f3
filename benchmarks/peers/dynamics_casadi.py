"""CasADi's own C of the same recursions: SX expressions, its CodeGenerator, and the call with arg and res of its C interface."""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import casadi as ca

from motions import DynamicFunction
from peers.casadi_c import ALGEBRA
from peers.dynamics_formulas import FORMS
from peers.dynamics_source import HEAD, LEG, LEG_FORMS, MERO, adapter, core, entrant, expressions
from peers.source import Peer, Source


def graph(function: DynamicFunction, form: str) -> Any:
    """A CasADi Function; its output flat, row-major and dense."""
    symbols = {name: ca.SX.sym(name, size) for name, size in function.inputs}
    ports = {name: ca.vertsplit(symbol) for name, symbol in symbols.items()}
    output = ca.densify(ca.vertcat(*expressions(function, ALGEBRA, ports, form)))
    return ca.Function(function.name, list(symbols.values()), [output], {"cse": True})


def _core(function: DynamicFunction) -> str:
    pointers = f"    const double *arg[] = {{{', '.join(dict(function.inputs))}}};\n    double *res[] = {{out}};"
    return core(function, f"{pointers}\n    {function.name}(arg, res, 0, 0, 0);")


def _source(functions: Sequence[DynamicFunction], form: str) -> Source:
    generator = ca.CodeGenerator("peer.c")
    for function in functions:
        generator.add(graph(function, form))
    with tempfile.TemporaryDirectory() as folder:
        text = Path(generator.generate(folder + "/")).read_text()
    return Source(entrant("CasADi", form), form, "\n".join([text, HEAD, *map(_core, functions), adapter(functions)]))


PEER = Peer("CasADi", lambda: (*(_source(LEG, form) for form in LEG_FORMS), *(_source(MERO, form) for form in FORMS)), "casadi")

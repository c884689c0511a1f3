"""CasADi's own C: SX expressions, its CodeGenerator, and the call with arg and res that its C interface asks for."""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import casadi as ca

from peers.formulas import FORMS, Algebra, inverse, inverse_branch, position
from peers.source import ADAPTER, CORES, Peer, Source, core

ALGEBRA = Algebra(ca.sin, ca.cos, ca.sqrt, ca.acos, ca.atan2, ca.fmin, ca.fmax, float)


def _function(name: str, inputs: Sequence[Any], outputs: Sequence[Any]) -> Any:
    return ca.Function(name, list(inputs), list(outputs), {"cse": True})


def functions(form: str) -> tuple[Any, ...]:
    """The five functions; J transposed, since CasADi stores columns, and H flat: both then lie row-major."""
    q, p, signs = ca.SX.sym("q", 3), ca.SX.sym("p", 3), ca.SX.sym("signs", 2)
    foot = ca.vertcat(*position(ALGEBRA, ca.vertsplit(q), form))
    J = ca.jacobian(foot, q)
    H = ca.vertcat(*(ca.vec(ca.jacobian(ca.jacobian(foot[k], q), q)) for k in range(3)))
    return (
        _function("foot_position", [q], [foot]),
        _function("foot_position_jacobian", [q], [foot, ca.densify(J.T)]),
        _function("foot_hessian", [q], [ca.densify(H)]),
        _function("inverse_branch", [p, signs], [ca.vertcat(*inverse_branch(ALGEBRA, ca.vertsplit(p), ca.vertsplit(signs), form))]),
        _function("inverse", [p], [ca.vertcat(*inverse(ALGEBRA, ca.vertsplit(p), form))]),
    )


def _core(name: str) -> str:
    given, outputs = CORES[name]
    inputs = f"{given}, signs" if name == "inverse_branch" else given
    pointers = f"    const double *arg[] = {{{inputs}}};\n    double *res[] = {{{', '.join(outputs)}}};"
    return core(name, f"{pointers}\n    {name}(arg, res, 0, 0, 0);")


def _source(form: str) -> Source:
    generator = ca.CodeGenerator("peer.c")
    for function in functions(form):
        generator.add(function)
    with tempfile.TemporaryDirectory() as folder:
        text = Path(generator.generate(folder + "/")).read_text()
    return Source("CasADi", form, "\n".join([text, *map(_core, CORES)]) + ADAPTER)


def _sources() -> tuple[Source, ...]:
    return tuple(map(_source, FORMS))


PEER = Peer("CasADi", _sources, "casadi")

"""wrenfold's C++: its symbolic functions, its optimiser, its generator in the mode that takes Eigen matrices."""

from collections.abc import Callable
from typing import Any

import wrenfold as wf
from wrenfold import sym

from peers.eigen import HEADERS, call
from peers.formulas import FORMS, Algebra, inverse, inverse_branch, position
from peers.source import ADAPTER, CORES, Peer, Source


def _number(text: str) -> Any:
    """An integer stays one, so that zeros and ones vanish; anything else is a float."""
    value = float(text)
    return sym.integer(int(value)) if value.is_integer() else sym.float_constant(value)


ALGEBRA = Algebra(sym.sin, sym.cos, sym.sqrt, sym.acos, sym.atan2, sym.min, sym.max, _number)
PASSES = (0, 4)
"""Passes that factor sums of products: none, as by default, and some."""


def _columns(matrix: Any, count: int) -> list[Any]:
    return [matrix[i] for i in range(count)]


def functions(form: str) -> dict[str, Callable[..., Any]]:
    """The five functions as wrenfold takes them: annotated Python."""

    def foot(q: Any) -> Any:
        return sym.vector(*position(ALGEBRA, _columns(q, 3), form))

    def foot_position(q: wf.Vector3):
        return [wf.OutputArg(foot(q), "p")]

    def foot_position_jacobian(q: wf.Vector3):
        return [wf.OutputArg(foot(q), "p"), wf.OutputArg(sym.jacobian(foot(q), q).T, "J")]

    def foot_hessian(q: wf.Vector3):
        J = sym.jacobian(foot(q), q)
        rows = [sym.jacobian(J[k, :].T, q) for k in range(3)]
        return [wf.OutputArg(sym.vector(*(row[i, j] for row in rows for i in range(3) for j in range(3))), "H")]

    def one_branch(p: wf.Vector3, signs: wf.Vector2):
        return [wf.OutputArg(sym.vector(*inverse_branch(ALGEBRA, _columns(p, 3), _columns(signs, 2), form)), "q")]

    def all_branches(p: wf.Vector3):
        return [wf.OutputArg(sym.vector(*inverse(ALGEBRA, _columns(p, 3), form)), "q")]

    found = (foot_position, foot_position_jacobian, foot_hessian, one_branch, all_branches)
    return dict(zip(CORES, found, strict=True))


def _source(form: str, passes: int) -> Source:
    generator = wf.CppGenerator(wf.CppMatrixTypeBehavior.Eigen)
    parameters = wf.OptimizationParams()
    parameters.factorization_passes = passes
    texts = [
        wf.generate_function(function, generator, name=f"peer_{name}", optimization_params=parameters)
        for name, function in functions(form).items()
    ]
    cores = [call(name, f"peer_{name}", address_of="") for name in CORES]
    text = "\n".join(["#include <cmath>\n#include <cstdint>\n#include <Eigen/Core>\n", *texts, *cores]) + ADAPTER
    return Source("wrenfold", f"{form}, {passes} passes", text, "c++", (HEADERS,))


def _sources() -> tuple[Source, ...]:
    return tuple(_source(form, passes) for form in FORMS for passes in PASSES)


PEER = Peer("wrenfold", _sources, "wrenfold")

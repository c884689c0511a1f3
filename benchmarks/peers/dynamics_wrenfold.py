"""wrenfold's C++ of the leg's recursions: its symbolic functions, its optimiser, Eigen matrices."""

import inspect
from collections.abc import Callable
from typing import Any

import wrenfold as wf
from wrenfold import sym

from motions import DynamicFunction
from peers.dynamics_source import HEAD, LEG, LEG_FORMS, adapter, core, entrant, expressions
from peers.eigen import HEADERS
from peers.source import Peer, Source
from peers.wrenfold_cpp import ALGEBRA, PASSES

_VECTORS = {3: wf.Vector3}


def _described(function: DynamicFunction, form: str) -> Callable[..., Any]:
    """A function whose annotations are vectors of the ports' sizes, which is how wrenfold learns of them."""

    def body(**given: Any) -> Any:
        ports = {name: [given[name][index] for index in range(size)] for name, size in function.inputs}
        return [wf.OutputArg(sym.vector(*expressions(function, ALGEBRA, ports, form)), "out")]

    kinds = {name: _VECTORS[size] for name, size in function.inputs}
    body.__annotations__ = dict(kinds)
    body.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=kind) for name, kind in kinds.items()]
    )
    return body


def _text(function: DynamicFunction, form: str, passes: int) -> str:
    parameters = wf.OptimizationParams()
    parameters.factorization_passes = passes
    generator = wf.CppGenerator(wf.CppMatrixTypeBehavior.Eigen)
    return str(wf.generate_function(_described(function, form), generator, name=f"peer_{function.name}", optimization_params=parameters))


def _core(function: DynamicFunction) -> str:
    inputs = [f"*reinterpret_cast<const Eigen::Matrix<double, {size}, 1> *>({name})" for name, size in function.inputs]
    output = f"*reinterpret_cast<Eigen::Matrix<double, {function.size}, 1> *>(out)"
    return core(function, f"    peer_{function.name}<double>({', '.join([*inputs, output])});")


def _source(form: str, passes: int) -> Source:
    texts = [_text(function, form, passes) for function in LEG]
    parts = ["#include <cmath>\n#include <cstdint>\n#include <Eigen/Core>\n", *texts, HEAD, *map(_core, LEG), adapter(LEG)]
    return Source(entrant("wrenfold", form), f"{form}, {passes} passes", "\n".join(parts), "c++", (HEADERS,))


PEER = Peer("wrenfold", lambda: tuple(_source(form, passes) for form in LEG_FORMS for passes in PASSES), "wrenfold")

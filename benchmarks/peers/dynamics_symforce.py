"""SymForce's C++ of the leg's recursions: its symbolic matrices and its Codegen, on Eigen."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from peers.symforce_cpp import ALGEBRA  # first: it chooses SymForce's epsilon

# isort: split
import symforce.symbolic as sf
from symforce.codegen import Codegen, CppConfig
from symforce.codegen.codegen_config import RenderTemplateConfig, ZeroEpsilonBehavior
from symforce.values import Values

from motions import DynamicFunction
from peers.dynamics_source import HEAD, LEG, LEG_FORMS, adapter, core, entrant, expressions
from peers.eigen import HEADERS
from peers.source import Peer, Source


def _text(function: DynamicFunction, form: str) -> str:
    """One function's header, without the pragma that its own file carries."""
    config = CppConfig(render_template_config=RenderTemplateConfig(autoformat=False), zero_epsilon_behavior=ZeroEpsilonBehavior.ALLOW)
    ports = {name: sf.Matrix(size, 1).symbolic(name) for name, size in function.inputs}
    elements = expressions(function, ALGEBRA, {name: port.to_flat_list() for name, port in ports.items()}, form)
    inputs, outputs = Values(**ports), Values(out=sf.Matrix(function.size, 1, elements))
    codegen = Codegen(inputs=inputs, outputs=outputs, config=config, name=f"peer_{function.name}")
    with tempfile.TemporaryDirectory() as folder:
        generated = codegen.generate_function(output_dir=folder, skip_directory_nesting=True)
        return Path(generated.generated_files[0]).read_text().replace("#pragma once", "")


def _core(function: DynamicFunction) -> str:
    name = "".join(part.capitalize() for part in function.name.split("_"))
    inputs = [f"*reinterpret_cast<const Eigen::Matrix<double, {size}, 1> *>({port})" for port, size in function.inputs]
    output = f"reinterpret_cast<Eigen::Matrix<double, {function.size}, 1> *>(out)"
    return core(function, f"    sym::Peer{name}<double>({', '.join([*inputs, output])});")


def _source(functions: Sequence[DynamicFunction], form: str) -> Source:
    texts = [_text(function, form) for function in functions]
    parts = [*texts, HEAD, *map(_core, functions), adapter(functions)]
    return Source(entrant("symforce", form), form, "\n".join(parts), "c++", (HEADERS,))


PEER = Peer("symforce", lambda: tuple(_source(LEG, form) for form in LEG_FORMS), "symforce")

"""SymForce's C++: its symbolic matrices and its Codegen, on Eigen."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import symforce

symforce.set_epsilon_to_number(0.0)

import symforce.symbolic as sf  # noqa: E402  (epsilon must be chosen first)
from symforce.codegen import Codegen, CppConfig  # noqa: E402
from symforce.codegen.codegen_config import RenderTemplateConfig, ZeroEpsilonBehavior  # noqa: E402

from peers.eigen import HEADERS, call  # noqa: E402
from peers.formulas import FORMS, Algebra, inverse, inverse_branch, position  # noqa: E402
from peers.source import ADAPTER, CORES, Peer, Source  # noqa: E402

ALGEBRA = Algebra(sf.sin, sf.cos, sf.sqrt, sf.acos, lambda y, x: sf.atan2(y, x, epsilon=0), sf.Min, sf.Max, lambda text: sf.S(float(text)))


def functions(form: str) -> dict[str, Callable[..., Any]]:
    """The five functions as SymForce takes them: annotated Python."""

    def foot(q: sf.V3) -> sf.V3:
        return sf.V3(*position(ALGEBRA, q.to_flat_list(), form))

    def foot_position(q: sf.V3) -> Any:
        return foot(q)

    def foot_position_jacobian(q: sf.V3) -> Any:
        return foot(q), foot(q).jacobian(q).T

    def foot_hessian(q: sf.V3) -> Any:
        J = foot(q).jacobian(q)
        return sf.Matrix(27, 1, [x for k in range(3) for x in J.row(k).T.jacobian(q).to_flat_list()])

    def one_branch(p: sf.V3, signs: sf.V2) -> Any:
        return sf.V3(*inverse_branch(ALGEBRA, p.to_flat_list(), signs.to_flat_list(), form))

    def all_branches(p: sf.V3) -> Any:
        return sf.Matrix(12, 1, inverse(ALGEBRA, p.to_flat_list(), form))

    found = (foot_position, foot_position_jacobian, foot_hessian, one_branch, all_branches)
    return dict(zip(CORES, found, strict=True))


def _text(name: str, function: Callable[..., Any]) -> str:
    """One function's header, without the pragma that its own file carries; outputs are pointers, never returned."""
    config = CppConfig(
        render_template_config=RenderTemplateConfig(autoformat=False),
        zero_epsilon_behavior=ZeroEpsilonBehavior.ALLOW,
    )
    outputs = list(CORES[name][1])
    codegen = Codegen.function(function, config=config, name=f"peer_{name}", output_names=outputs, return_key=None)
    with tempfile.TemporaryDirectory() as folder:
        generated = codegen.generate_function(output_dir=folder, skip_directory_nesting=True)
        return Path(generated.generated_files[0]).read_text().replace("#pragma once", "")


def _callee(name: str) -> str:
    return "sym::Peer" + "".join(part.capitalize() for part in name.split("_"))


def _source(form: str) -> Source:
    texts = [_text(name, function) for name, function in functions(form).items()]
    cores = [call(name, _callee(name), address_of="&") for name in CORES]
    return Source("symforce", form, "\n".join([*texts, *cores]) + ADAPTER, "c++", (HEADERS,))


def _sources() -> tuple[Source, ...]:
    return tuple(map(_source, FORMS))


PEER = Peer("symforce", _sources, "symforce")

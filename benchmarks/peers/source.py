"""What a peer hands to the harness: a unit that defines the core functions adapter.h asks for, or functions to call from Python."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent

Answer = Callable[..., Any]

CORES = {
    "foot_position": ("q", ("p",)),
    "foot_position_jacobian": ("q", ("p", "J")),
    "foot_hessian": ("q", ("H",)),
    "inverse_branch": ("p", ("q",)),
    "inverse": ("p", ("q",)),
}
"""Every function: its input and its outputs; `inverse_branch` also takes `signs` [2], after p."""


@dataclass(frozen=True)
class Source:
    """A unit to compile: who wrote it, from which form of the formulas, and what it needs."""

    peer: str
    form: str
    text: str
    language: str = "c"
    includes: tuple[Path, ...] = ()
    extra: tuple[str, ...] = ()
    flags: tuple[str, ...] = ()
    """When given, the only flags measured; otherwise every set of flags is."""


@dataclass(frozen=True)
class Peer:
    """A generator: how to make its units, and the package whose version counts."""

    name: str
    make: Callable[[], tuple[Source, ...]]
    package: str = ""

    @property
    def version(self) -> str:
        return version(self.package) if self.package else ""


@dataclass(frozen=True)
class Caller:
    """One function from Python: `row(in [3], branch)` and, where it exists, `batch(in [rows,3], branch [rows])`."""

    peer: str
    form: str
    function: str
    row: Answer
    batch: Answer | None


def core(name: str, body: str) -> str:
    """`static inline void core_<name>(inputs, outputs)` around statements that compute the outputs."""
    given, outputs = CORES[name]
    inputs = [f"const double *{given}"] + (["const double *signs"] if name == "inverse_branch" else [])
    arguments = ", ".join(inputs + [f"double *{output}" for output in outputs])
    return f"static inline void core_{name}({arguments}) {{\n{body}\n}}\n"


ADAPTER = '\n#include "adapter.h"\n'

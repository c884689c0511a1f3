"""One robot computed in every way walkgen offers: the compiled library, NumPy, CasADi, and the interpreter on its Programs."""

import pickle
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from walkgen.graph.interpret import interpret
from walkgen.graph.program import Composite, Program
from walkgen.pipeline import programs_of
from walkgen.runtime import load
from walkgen.signature import Signature

Array = np.ndarray
BACKENDS = ("c", "numpy", "casadi", "interpreter")
KEPT = "programs.pickle"
"""Beside a spec: the programs that its build derived."""


def programs(spec: Path) -> dict[str, Program | Composite]:
    """Every function of a spec that is a Program, or steps that are, by full name; what needs a support routine is left out."""
    kept = spec.with_name(KEPT)
    found = pickle.loads(kept.read_bytes()) if kept.exists() else programs_of(spec)  # noqa: S301 (written by this run)
    return {body.signature.full_name: body for body in found if isinstance(body, Program) or not body.calls_routines}


def interpreted(program: Program | Composite, *inputs: Any) -> Array:
    """The first output port for rows of inputs, each [..., *shape of the port]."""
    signature = program.signature
    arrays = [np.asarray(value, dtype=float) for value in inputs]
    batch = arrays[0].shape[: arrays[0].ndim - len(signature.inputs[0].shape)]
    found = [_interpret_row(program, row) for row in zip(*(_rows(array, batch) for array in arrays), strict=True)]
    return np.reshape(found, (*batch, *signature.outputs[0].shape))


def _rows(array: Array, batch: tuple[int, ...]) -> Array:
    return array.reshape(int(np.prod(batch)), -1)


def _interpret_row(body: Program | Composite, row: tuple[Array, ...]) -> list[float]:
    values = {port.name: list(value) for port, value in zip(body.signature.inputs, row, strict=True)}
    return _interpret(body, values)[body.signature.outputs[0].name]


def _interpret(body: Program | Composite, values: dict[str, list[float]]) -> dict[str, list[float]]:
    """All values by their names, of a Composite those of its steps too."""
    if isinstance(body, Program):
        return interpret(body, values)
    for call in body.calls:
        ports = call.callee.signature.inputs
        read, written = call.arguments[: len(ports)], call.arguments[len(ports) :]
        given = [[float(each)] if isinstance(each, Decimal) else values[each] for each in read]
        found = interpret(call.callee, {port.name: value for port, value in zip(ports, given, strict=True)})
        values = values | dict(zip(written, found.values(), strict=True))
    return values


@dataclass(frozen=True)
class Built:
    """A robot's generated folder and the spec it came from."""

    spec: Path
    folder: Path

    @cached_property
    def c(self) -> Any:
        return self._loaded("c")

    @cached_property
    def numpy(self) -> Any:
        return self._loaded("numpy")

    def _loaded(self, backend: str) -> Any:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("WALKGEN_BACKEND", backend)
            robot = load(self.folder)
        assert robot.backend == backend
        return robot

    @cached_property
    def programs(self) -> dict[str, Program]:
        return programs(self.spec)

    def signature(self, owner: str, name: str) -> Signature:
        signatures = (program.signature for program in self.programs.values())
        return next(signature for signature in signatures if (signature.owner, signature.name) == (owner, name))

    def call(self, backend: str, owner: str, name: str, *inputs: Any) -> Array:
        """The first output of a function, in one of the `BACKENDS`, for inputs with a leading batch dimension."""
        signature = self.signature(owner, name)
        if backend == "interpreter":
            return interpreted(self.programs[signature.full_name], *inputs)
        if backend == "casadi":
            return self._casadi(signature, inputs)
        robot = self.c if backend == "c" else self.numpy
        found = robot.functions[signature.full_name](*inputs)
        return np.asarray(found[0] if len(signature.outputs) > 1 else found)

    def _casadi(self, signature: Signature, inputs: tuple[Any, ...]) -> Array:
        function = self.c.casadi(signature.full_name)
        shapes = [function.size_in(index) for index in range(function.n_in())]
        found = []
        for row in zip(*inputs, strict=True):
            arguments = [np.reshape(value, shape) for value, shape in zip(row, shapes, strict=True)]
            found.append(np.reshape(np.array(function.call(arguments)[0]), signature.outputs[0].shape))
        return np.array(found)

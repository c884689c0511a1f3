"""The harness for functions of several input ports: Pinocchio reads the same motions in its own coordinates."""

import ctypes
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np

from compiling import compile_one
from leg import Array
from motions import TOLERANCE, DynamicFunction, MotionRows, draw, error, expected
from peers.source import HERE, Source
from timing import Bench, Contestant, Times

_ROW = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
_BATCH = ctypes.CFUNCTYPE(ctypes.c_size_t, ctypes.c_size_t, *4 * [ctypes.c_void_p])


@dataclass(frozen=True)
class MotionBench(Bench):
    """One function's rows, `few` for single calls and `many` for batches, and the same for Pinocchio."""

    few: MotionRows
    many: MotionRows
    function: DynamicFunction
    native: tuple[MotionRows, MotionRows]

    @classmethod
    def of(cls, function: DynamicFunction, few: int, many: int) -> "MotionBench":
        """With as many rows."""
        return cls(
            draw(function, few), draw(function, many), function, (draw(function, few, native=True), draw(function, many, native=True))
        )

    def _rows_for(self, contestant: Contestant) -> tuple[MotionRows, MotionRows]:
        return self.native if contestant.peer == "Pinocchio" else (self.few, self.many)

    @cached_property
    def _space(self) -> tuple[Array, Any]:
        rows = len(self.many.branch)
        return np.zeros(max(self.function.size, 6) * rows), np.zeros(rows, np.int32)

    def measure(self, contestant: Contestant) -> Times:
        """One repetition, ns."""
        few, many = self._rows_for(contestant)
        harness, (out, status) = _harness(few.q.shape[1]), self._space
        last = ctypes.c_size_t((contestant.function.size or 6) - 1)
        single = _arguments(few, few.q, out, status)
        return {
            "throughput": harness.time_throughput(contestant.row, *single),
            "latency": harness.time_latency(contestant.row, *single, last),
            "batch": harness.time_batch(contestant.batch, *_arguments(many, many.blocks, out, status)),
        }

    @cached_property
    def _right(self) -> Array:
        return expected(self.function, len(self.few.branch))

    def check(self, contestant: Contestant) -> str:
        """Empty when row and batch agree with the reference; else what differs."""
        few, _ = self._rows_for(contestant)
        whole = np.ones(len(few.branch), np.int32)
        rows, batch = np.full((2, len(few.branch), self.function.size), np.nan)
        call = _ROW(contestant.row.value or 0)
        for row, out in zip(few.q, rows, strict=True):
            call(row.ctypes.data, 1, out.ctypes.data, whole.ctypes.data)
        _BATCH(contestant.batch.value or 0)(len(batch), few.blocks.ctypes.data, whole.ctypes.data, batch.ctypes.data, whole.ctypes.data)
        errors = {"row": error(rows, self._right), "batch": error(batch, self._right)}
        return ", ".join(f"{kind} is off by {value:.3g}" for kind, value in errors.items() if not value <= TOLERANCE)


def _arguments(inputs: MotionRows, values: Array, out: Array, status: Any) -> tuple[ctypes.c_size_t | ctypes.c_void_p, ...]:
    pointers = (ctypes.c_void_p(array.ctypes.data) for array in (values, inputs.branch, out, status))
    return (ctypes.c_size_t(len(inputs.branch)), *pointers)


@cache
def _harness(width: int) -> Any:
    """harness.c for rows of so many numbers."""
    text = f"#define WIDTH {width}\n{(HERE.parent / 'harness.c').read_text()}"
    library = ctypes.CDLL(str(compile_one(Source("harness", "", text), ("-O2",)).library))
    for timed in (library.time_throughput, library.time_latency, library.time_batch):
        timed.restype = ctypes.c_double
    return library

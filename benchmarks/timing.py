"""Runs contestants side by side on one core, in rotating order, after comparing what they compute."""

import ctypes
import os
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from compiling import Build, compile_one
from leg import TOLERANCE, Array, Inputs, LegFunction, error, expected
from peers.source import HERE, Source

METRICS = ("throughput", "latency", "batch")
"""ns a call when calls are independent; ns a call when each waits for the last; ns a row of one call on 1e5 rows."""

Times = dict[str, float]


@dataclass(frozen=True)
class Contestant:
    """A loaded library's version of one function."""

    build: Build
    function: LegFunction

    @property
    def peer(self) -> str:
        return self.build.source.peer

    @cached_property
    def _library(self) -> Any:
        return ctypes.CDLL(str(self.build.library))

    @cached_property
    def row(self) -> ctypes.c_void_p:
        return ctypes.cast(self._library[f"bench_{self.function.name}"], ctypes.c_void_p)

    @cached_property
    def batch(self) -> ctypes.c_void_p:
        return ctypes.cast(self._library[f"bench_{self.function.name}_batch"], ctypes.c_void_p)

    @property
    def exists(self) -> bool:
        return hasattr(self._library, f"bench_{self.function.name}")


@dataclass(frozen=True)
class Bench:
    """The harness with the rows it feeds: few for single calls, many for batches."""

    few: Inputs
    many: Inputs

    @cached_property
    def _harness(self) -> Any:
        build = compile_one(Source("harness", "", (HERE.parent / "harness.c").read_text()), ("-O2",))
        library = ctypes.CDLL(str(build.library))
        for timed in (library.time_throughput, library.time_latency, library.time_batch):
            timed.restype = ctypes.c_double
        return library

    def measure(self, contestant: Contestant) -> Times:
        """One repetition, ns."""
        function = contestant.function
        few = _arguments(self.few, function, self._out)
        last = ctypes.c_size_t((function.size or 6) - 1)
        return {
            "throughput": self._harness.time_throughput(contestant.row, *few),
            "latency": self._harness.time_latency(contestant.row, *few, last),
            "batch": self._harness.time_batch(contestant.batch, *_arguments(self.many, function, self._out)),
        }

    @cached_property
    def _out(self) -> tuple[Array, Any]:
        return np.zeros(27 * len(self.many.branch)), np.zeros(4 * len(self.many.branch), np.int32)

    def check(self, contestant: Contestant) -> str:
        """Empty when row and batch agree with the reference; else what differs."""
        function = contestant.function
        right = expected(function, self.few)
        errors = {"row": error(function, self._rows(contestant), right), "batch": error(function, self._batch(contestant), right)}
        wrong = [f"{kind} is off by {value:.3g}" for kind, value in errors.items() if not value <= TOLERANCE]
        return ", ".join(wrong)

    def _rows(self, contestant: Contestant) -> Array:
        kind = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
        call = kind(contestant.row.value or 0)
        rows, status = self.few.rows(contestant.function), np.zeros(4, np.int32)
        found = np.full((len(rows), contestant.function.size), np.nan)
        for row, branch, out in zip(rows, self.few.branch, found, strict=True):
            call(row.ctypes.data, int(branch), out.ctypes.data, status.ctypes.data)
        return found

    def _batch(self, contestant: Contestant) -> Array:
        """The batch's ports, which lie one after another, joined row by row."""
        rows = len(self.few.branch)
        flat, status = np.full(contestant.function.size * rows, np.nan), np.zeros(4 * rows, np.int32)
        call = ctypes.CFUNCTYPE(ctypes.c_size_t, ctypes.c_size_t, *4 * [ctypes.c_void_p])(contestant.batch.value or 0)
        call(*_arguments(self.few, contestant.function, (flat, status)))
        starts = np.cumsum((0, *contestant.function.ports)) * rows
        return np.hstack([flat[a:b].reshape(rows, -1) for a, b in pairwise(starts)])


def _arguments(inputs: Inputs, function: LegFunction, out: tuple[Array, Any]) -> tuple[ctypes.c_void_p | ctypes.c_size_t, ...]:
    arrays = (inputs.rows(function), inputs.branch, *out)
    return (ctypes.c_size_t(len(inputs.branch)), *(ctypes.c_void_p(array.ctypes.data) for array in arrays))


def pin_core() -> int:
    """Stay on the last core that this process may use; its number."""
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


def race(bench: Bench, contestants: Sequence[Contestant], repetitions: int) -> Mapping[Contestant, Times]:
    """Median ns of each contestant and metric; every repetition starts with another contestant."""
    samples: dict[Contestant, list[Times]] = {contestant: [] for contestant in contestants}
    for repetition in range(repetitions):
        turn = repetition % len(contestants)
        for contestant in (*contestants[turn:], *contestants[:turn]):
            samples[contestant].append(bench.measure(contestant))
    return {contestant: _medians(times) for contestant, times in samples.items()}


def _medians(times: Sequence[Times]) -> Times:
    return {metric: statistics.median(time[metric] for time in times) for metric in METRICS}

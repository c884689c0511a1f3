"""Gives inverse problems to solvers, compiled or from Python: judges what they answer, then times them."""

import ctypes
import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from chains import Array
from compiling import Build, compile_one
from peers.solver import Solver
from peers.source import HERE, Source
from problems import Problem, Verdict

_KIND = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
_BUDGET = 4e8
"""ns that one compiled solver's repetitions may take."""


@dataclass(frozen=True)
class Entrant:
    """A solver with one kind of seed, and its library where it is compiled."""

    problem: Problem
    solver: Solver
    seeds: str
    build: Build | None

    @property
    def rows(self) -> int:
        return min(self.solver.rows or len(self.problem.q), len(self.problem.q))

    @cached_property
    def _seeds(self) -> Array:
        return self.problem.seeds(self.seeds or "near")

    @cached_property
    def _function(self) -> ctypes.c_void_p:
        assert self.build is not None
        return ctypes.cast(ctypes.CDLL(str(self.build.library))[f"bench_{self.solver.symbol}"], ctypes.c_void_p)

    def measured(self, repetitions: int) -> tuple[Verdict, dict[str, float]]:
        """How good its answers are; ns a call, the mean over the targets.

        Compiled, that is the median of the repetitions, and stands beside calls that each wait for the last; from Python it is one pass.
        """
        found = np.full((self.rows, self.solver.slots, self.problem.q.shape[1]), np.nan)
        if self.solver.solve is None:
            self._fill(found)
            return self.problem.judge(found), self._compiled_times(repetitions)
        ns = self._fill_and_time(self.solver.solve, found)
        return self.problem.judge(found), {"throughput": ns}

    def _fill(self, found: Array) -> None:
        call, inputs = _KIND(self._function.value or 0), self.problem.inputs(self.seeds)
        status = np.empty(self.solver.slots, np.int32)
        for row, out in zip(inputs, found, strict=True):
            status[:] = -1
            call(row.ctypes.data, 0, out.ctypes.data, status.ctypes.data)
            out[status != 0] = np.nan

    def _fill_and_time(self, solve: Callable[[int, Array], Any], found: Array) -> float:
        spent = 0
        for row, seed in enumerate(self._seeds[: self.rows]):
            start = time.thread_time_ns()
            answer = solve(row, seed)
            spent += time.thread_time_ns() - start
            given = answer[: self.solver.slots]
            found[row, : len(given)] = given if len(given) else np.nan
        return spent / self.rows

    def _compiled_times(self, repetitions: int) -> dict[str, float]:
        inputs = self.problem.inputs(self.seeds)
        harness, rows = _harness(inputs.shape[1]), len(inputs)
        branch, out, status = np.zeros(rows, np.int32), np.zeros((self.solver.slots, self.problem.q.shape[1])), np.zeros(8, np.int32)
        arrays = [ctypes.c_void_p(array.ctypes.data) for array in (inputs, branch, out, status)]
        call = (self._function, ctypes.c_size_t(rows), *arrays)
        first = rows * harness.time_throughput(*call)
        often = max(3, min(repetitions, int(_BUDGET / first / 2)))
        pairs = [(harness.time_throughput(*call), harness.time_latency(*call, ctypes.c_size_t(out.size - 1))) for _ in range(often)]
        throughput, latency = (statistics.median(times) for times in zip(*pairs, strict=True))
        return {"throughput": throughput, "latency": latency}


def _harness(inputs: int) -> Any:
    text = f"#define WIDTH {inputs}\n{(HERE.parent / 'harness.c').read_text()}"
    library = ctypes.CDLL(str(compile_one(Source("harness", "", text), ("-O2",)).library))
    for timed in (library.time_throughput, library.time_latency):
        timed.restype = ctypes.c_double
    return library


def entrants(problem: Problem, solver: Solver) -> tuple[list[Entrant], str]:
    """The solver once for every kind of seed; or nobody, and the compiler's words."""
    build = compile_one(solver.source, solver.source.flags) if solver.source else None
    if build and build.message:
        return [], build.message
    return [Entrant(problem, solver, seeds, build) for seeds in solver.seeds], ""


def entry(entrant: Entrant, repetitions: int) -> dict[str, Any]:
    """Judged and timed, for the results."""
    verdict, ns = entrant.measured(repetitions)
    flags = list(entrant.build.flags) if entrant.build else []
    who = {"problem": entrant.problem.name, "peer": entrant.solver.peer, "form": entrant.solver.form, "flags": flags}
    return {**who, "seeds": entrant.seeds, "targets": entrant.rows, **asdict(verdict), "ns": ns}

"""What a peer of the inverse benchmark hands over: a compiled solver, or one to call from Python, for one problem."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from chains import Array
from peers.source import Source
from problems import Problem

SEEDS = ("near", "random")
UNSEEDED = ("",)


@dataclass(frozen=True)
class Solver:
    """One way to solve a problem.

    Attributes:
        peer: Who.
        form: How.
        seeds: The kinds of seeds it is measured with; one empty word where it takes none.
        solve: From Python: number of the target, its seed [n] -> what it calls solutions [k,n].
        source: Compiled: a unit with `bench_<symbol>`; it reads target and seed in a row, and a status 0 marks what it calls a solution.
        symbol: Of the compiled solver.
        slots: Most solutions of a target.
        rows: How many targets it is measured on, where all would take too long; 0 for all.
    """

    peer: str
    form: str
    seeds: tuple[str, ...]
    slots: int
    solve: Callable[[int, Array], Any] | None = None
    source: Source | None = None
    symbol: str = ""
    rows: int = 0


Refuse = Callable[[str, str], None]
"""Notes who does not accept a problem, and in which words."""

Solvers = Callable[[Problem, Refuse], Iterable[Solver]]


def refusal(call: Callable[[], Any]) -> str:
    """The words of the exception that `call` raises, up to an empty line (addresses of objects follow); empty when it raises none."""
    try:
        call()
    except Exception as error:
        return f"{type(error).__name__}: {error}".split("\n\n", maxsplit=1)[0]
    return ""

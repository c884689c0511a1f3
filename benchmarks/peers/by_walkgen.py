"""walkgen's own solvers: generated C under its default flags and for this processor, and the runtime from Python."""

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from peers.solver import SEEDS, UNSEEDED, Refuse, Solver
from peers.source import Source
from peers.walkgen_c import OUTPUT
from problems import Problem
from walkgen import pipeline, toolchain
from walkgen.runtime import load

_HEAD = """
#define ENTRY __attribute__((visibility("default")))
#define ROW const double *restrict in, int32_t branch, double *restrict out, int32_t *restrict status
"""
_ALL = "ENTRY int32_t bench_inverse(ROW) {{ (void)branch; return {prefix}_inverse(in, out, status); }}\n"
_ONE = "ENTRY int32_t bench_{name}(ROW) {{ (void)branch; return *status = {prefix}_{name}(in, in + {size}, out); }}\n"
_SLOTS = 4
_FLAGS = (("default flags", toolchain.FLAGS), ("-march=native", (*toolchain.FLAGS, "-march=native")))


@cache
def _built(spec: Path) -> Path:
    return pipeline.build(spec, OUTPUT).folder


def _source(problem: Problem, form: str, flags: tuple[str, ...]) -> Source:
    folder = _built(problem.spec)
    digest, name = json.loads((folder / "manifest.json").read_text())["digest"], folder.name
    prefix, size = f"{name}_{problem.leg}", problem.targets.shape[1]
    calls = [_ONE.format(name="inverse_pose" if problem.posed else "inverse_near", prefix=prefix, size=size)]
    calls += [] if problem.posed else [_ALL.format(prefix=prefix)]
    text = f"/* sources {digest} */\n{(folder / f'{name}.c').read_text()}{_HEAD}{''.join(calls)}"
    return Source("walkgen", form, text, includes=(folder,), flags=flags)


def solvers(problem: Problem, _: Refuse) -> Iterable[Solver]:
    """`inverse` and `inverse_near`, or `inverse_pose`; `inverse` from Python as well."""
    seeded = "inverse_pose" if problem.posed else "inverse_near"
    for form, flags in _FLAGS:
        source = _source(problem, form, flags)
        if not problem.posed:
            yield Solver("walkgen", f"inverse, C, {form}", UNSEEDED, _SLOTS, source=source, symbol="inverse")
        yield Solver("walkgen", f"{seeded}, C, {form}", SEEDS, 1, source=source, symbol=seeded)
    leg = load(_built(problem.spec)).legs[problem.leg]
    targets = problem.poses if problem.posed else problem.targets
    call = getattr(leg, seeded)

    def one(row: int, seed: object) -> object:
        q, status = call(targets[row], seed)
        return q[None] if status == 0 else q[:0]

    def every(row: int, _seed: object) -> object:
        q, status = leg.inverse(targets[row])
        return q[status == 0]

    yield Solver("walkgen", f"{seeded}, Python", SEEDS, 1, solve=one)
    if not problem.posed:
        yield Solver("walkgen", "inverse, Python", UNSEEDED, _SLOTS, solve=every)

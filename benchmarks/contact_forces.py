"""What do contact forces cost beside solvers of quadratic programs? Writes results/contact_forces.json.

Stances of 3 to 6 feet, cones inactive and active, walkgen cold with circular cones and with four facets, beside DAQP (cold: one call;
kept: cold in a workspace that is kept) and OSQP (warm) through their C interfaces, which come with CasADi, and PIQP and ProxQP through
Python, less an empty call. All get the same stances in one run and their matrices ready made; forces are compared before anything is
timed. Asked: DAQP at least 25 times as long while no cone is active, 2.5 times with active cones (four facets); circular cones at most 0.7
of DAQP.
"""

import argparse
import ctypes
import hashlib
import importlib
import statistics
import sysconfig
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

import numpy as np

from compiling import COMMON, FLAG_SETS, FOLDER, compile_one, versions
from contact_stances import SEED, Array, Stances, draw, pyramids
from contest import Entry, Failures
from peers.source import HERE, Source
from report import packages, table, write
from timing import pin_core

ASKED = {"inactive": 25.0, "active": 2.5}
CIRCLES = 0.7
KINDS = {"inactive": ((0.9, 1.2), 0.05), "active": ((0.2, 0.5), 0.1)}
CSUPPORT = HERE.parents[1] / "generator" / "walkgen" / "emit" / "csupport"
CASADI = Path(sysconfig.get_paths()["purelib"]) / "casadi"
TOLERANCES = {"DAQP cold": 1e-6, "DAQP kept": 1e-6, "OSQP warm": 1e-3, "PIQP": 1e-5, "ProxQP": 1e-4}
Timer = Callable[[], float]


def _pointers(*arrays: Array) -> list[ctypes.c_void_p]:
    return [ctypes.c_void_p(array.ctypes.data) for array in arrays]


def _library(unit: str, flags: tuple[str, ...], *extra: str) -> ctypes.CDLL | str:
    FOLDER.mkdir(exist_ok=True)
    headers = "".join(path.read_text() for path in sorted(CSUPPORT.glob("*.h")))
    digest = hashlib.sha256(headers.encode()).hexdigest()  # a library is built again when a header changes
    source = Source(
        unit, "c", f"{(HERE.parent / unit).read_text()}/* {digest} */\n", includes=(CSUPPORT, CASADI / "include"), extra=extra, flags=flags
    )
    build = compile_one(source, flags)
    return build.message or ctypes.CDLL(str(build.library))


class Walkgen:
    """The routine under one set of flags."""

    def __init__(self, flags: tuple[str, ...]) -> None:
        self.flags = flags
        library = _library("contact_walkgen.c", (*flags, *COMMON))
        assert not isinstance(library, str), library
        self._time = library.time_rows
        self._time.restype = ctypes.c_double

    def timer(self, stances: Stances, facets: int) -> tuple[Timer, Array, Array]:
        """ns a stance when called; the forces and statuses that a call fills."""
        rows, k = stances.mu.shape
        inputs = [np.ascontiguousarray(value) for value in vars(stances).values()]
        f, status = np.zeros((rows, k, 3)), np.full(rows, -1, np.int32)
        return lambda: self._time(rows, k, facets, *_pointers(*inputs, f, status)), f, status


def by_matrices(unit: str, name: str, stances: Stances, columns: bool, function: str = "time_matrices") -> tuple[Timer, Array] | str:
    """A solver behind its C interface; the compiler's words where it does not build."""
    library = _library(unit, ("-O3", "-march=native"), f"-L{CASADI}", f"-l{name}", f"-Wl,-rpath,{CASADI}")
    if isinstance(library, str):
        return library
    A, lower, upper = pyramids(stances)
    rows, m, n = A.shape
    inputs = [np.ascontiguousarray(np.swapaxes(A, 1, 2) if columns else A), lower, upper]
    f, status = np.zeros((rows, n // 3, 3)), np.zeros(rows, np.int32)
    timed = library[function]
    timed.restype = ctypes.c_double
    return lambda: timed(rows, n, m, *_pointers(*inputs, f, status)), f


def by_python(name: str, stances: Stances) -> tuple[Timer, Array]:
    """A solver's Python interface, dense, less an empty call of as many arguments."""
    A, _, upper = pyramids(stances)
    rows, n = len(A), A.shape[2]
    H, g, f = np.eye(n), np.zeros(n), np.zeros((rows, n // 3, 3))
    solve = _PYTHON[name](H, g)

    def one(row: int) -> None:
        f[row] = solve(A[row, :6], upper[row, :6], A[row, 6:], upper[row, 6:]).reshape(-1, 3)

    def empty(*_: Array) -> Array:
        return g

    def timer() -> float:
        start = time.thread_time_ns()
        for row in range(rows):
            one(row)
        middle = time.thread_time_ns()
        for row in range(rows):
            f_row = empty(A[row, :6], upper[row, :6], A[row, 6:], upper[row, 6:]).reshape(-1, 3)
        assert f_row.shape[1] == 3
        return (2 * middle - start - time.thread_time_ns()) / rows

    return timer, f


def _piqp(H: Array, g: Array) -> Callable[..., Array]:
    piqp = importlib.import_module("piqp")
    solver = piqp.DenseSolver()
    solver.settings.verbose = False
    ready = []

    def solve(E: Array, e: Array, C: Array, c: Array) -> Array:
        low = np.full(len(c), -1e30)
        if ready:
            solver.update(A=E, b=e, G=C, h_l=low, h_u=c)
        else:
            ready.append(solver.setup(H, g, E, e, C, low, c))
        solver.solve()
        return np.array(solver.result.x)

    return solve


def _proxqp(H: Array, g: Array) -> Callable[..., Array]:
    proxqp = importlib.import_module("proxsuite").proxqp
    state = []

    def solve(E: Array, e: Array, C: Array, c: Array) -> Array:
        low = np.full(len(c), -1e20)
        if not state:
            state.append(proxqp.dense.QP(len(g), 6, len(c)))
            state[0].settings.eps_abs = 1e-6
            state[0].init(H, g, E, e, C, low, c)
        else:
            state[0].update(A=E, b=e, C=C, l=low, u=c)
        state[0].solve()
        return np.array(state[0].results.x)

    return solve


_PYTHON = {"PIQP": _piqp, "ProxQP": _proxqp}


def chosen(kind: str, rows: int, k: int, judge: Walkgen) -> Stances:
    """Stances that carry their load with circles and with pyramids, with no foot on its pyramid or with some."""
    drawn = draw(60 * rows, k, *KINDS[kind])
    results = []
    for facets in (0, 4):
        timer, f, status = judge.timer(drawn, facets)
        timer()
        results.append((f, status))
    good = (results[0][1] == 0) & (results[1][1] == 0)
    A, _, upper = pyramids(drawn)
    on_side = (np.einsum("rij,rj->ri", A, results[1][0].reshape(len(good), -1)) > upper - 1e-9)[:, 6:].any(-1)
    slides = np.abs(results[0][0] - results[1][0]).max((-1, -2)) > 1e-9
    fits = good & (~on_side if kind == "inactive" else on_side & slides)
    found = np.flatnonzero(fits)[:rows]
    assert len(found) == rows, (kind, k, len(found))
    return drawn[found]


def raced(timers: dict[str, Timer], repetitions: int) -> dict[str, float]:
    """Medians of ns, every repetition beginning with another one; a slow one is measured less often."""
    samples: dict[str, list[float]] = {name: [timer()] for name, timer in timers.items()}
    often = {name: repetitions if first[0] < 2e4 else 7 for name, first in samples.items()}
    for turn in range(repetitions):
        names = list(timers)
        for name in names[turn % len(names) :] + names[: turn % len(names)]:
            if turn < often[name]:
                samples[name].append(timers[name]())
    return {name: statistics.median(times[1:]) for name, times in samples.items()}


def measured(kind: str, k: int, options: argparse.Namespace, own: list[Walkgen], failures: Failures) -> Entry:
    """ns of everyone on the same stances, and what the forces of pyramids differ by."""
    stances = chosen(kind, options.rows, k, own[0])
    timers: dict[str, Timer] = {}
    for entrant in own:
        for facets, form in ((0, "circles"), (4, "4 facets")):
            timers[f"walkgen {form} {' '.join(entrant.flags)}"] = entrant.timer(stances, facets)[0]
    timer, right, _ = own[0].timer(stances, 4)
    timer()
    errors = {}
    peers: dict[str, Callable[[], tuple[Timer, Array] | str]] = {
        "DAQP cold": lambda: by_matrices("contact_daqp.c", "daqp", stances, False, "time_calls"),
        "DAQP kept": lambda: by_matrices("contact_daqp.c", "daqp", stances, False),
        "OSQP warm": lambda: by_matrices("contact_osqp.c", "osqp", stances, True),
        **{name: lambda name=name: by_python(name, stances) for name in _PYTHON},
    }
    for name, make in peers.items():
        try:
            entrant = make()
            if isinstance(entrant, str):
                failures.add(name, entrant)
                continue
            if entrant[0]() < 0.0:
                failures.add(name, "its setup refuses the problem")
                continue
        except Exception:
            failures.add_raised(name)
            continue
        errors[name] = float(np.abs(entrant[1] - right).max())
        if errors[name] > TOLERANCES[name]:
            failures.add(f"{name}, {kind}, {k} feet", f"forces differ by {errors[name]:.1e} of the load")
        timers[name] = entrant[0]
    ns = raced(timers, options.repetitions)
    best = {form: min(value for name, value in ns.items() if f"walkgen {form}" in name) for form in ("circles", "4 facets")}
    ratios = (
        {"DAQP / 4 facets": ns["DAQP cold"] / best["4 facets"], "circles / DAQP": best["circles"] / ns["DAQP cold"]}
        if "DAQP cold" in ns
        else {}
    )
    return {"kind": kind, "feet": k, "ns": ns, "best": best, "ratios": ratios, "errors": errors}


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=201, help="medians are taken of so many")
    parser.add_argument("--rows", type=int, default=1024, help="stances of every kind")
    return parser.parse_args()


def main() -> None:
    """Draw, compare, time, print, write."""
    options, failures, core = _options(), Failures(), pin_core()
    own = [Walkgen(flags) for flags in FLAG_SETS]
    entries = [measured(kind, k, options, own, failures) for kind in KINDS for k in (3, 4, 5, 6)]
    peers = tuple(TOLERANCES)
    rows = []
    for line in entries:
        mine = [f"{line['best'][form]:.0f}" for form in ("4 facets", "circles")]
        theirs = [f"{line['ns'][name]:.0f}" if name in line["ns"] else "" for name in peers]
        ratios = [f"{line['ratios'].get(name, float('nan')):.2f}" for name in ("DAQP / 4 facets", "circles / DAQP")]
        rows.append((f"{line['feet']} feet, cones {line['kind']}", *mine, *theirs, *ratios))
    print(table(("ns a stance", "walkgen, 4 facets", "circles", *peers, "DAQP / 4 facets", "circles / DAQP"), rows))
    for message in dict.fromkeys(failures.messages):
        print(f"NOT AS ASKED  {message}")
    settings = {**vars(options), "seed": SEED, "core": core, "asked": ASKED, "circles": CIRCLES}
    flags = {"flag_sets": [list(flags) for flags in FLAG_SETS], "common_flags": list(COMMON)}
    names = {"packages": {**packages(("numpy", "casadi")), **{name: version(name) for name in ("piqp", "proxsuite")}}}
    path = write(
        "contact_forces",
        {"settings": settings, "compilers": versions(), **flags, **names, "not_measured": failures.messages, "entries": entries},
    )
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()

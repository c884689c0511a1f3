"""Is walkgen's C at least as fast as the peers' on one 3R leg? Prints ns and ratios, writes results/kinematics_<span>.json.

Foot position, position and Jacobian, Hessian, inverse on one branch and on all four, for the leg of specs/mero_leg.toml. Every peer
gets the same formulas, every set of flags, and counts with its best; outputs are compared before anything is timed. The peers'
inverses give joint angles only; walkgen's also decide a status for each branch and wrap every angle, and are timed doing so.
"""

import argparse
import importlib
from collections.abc import Sequence

import python_timing
from compiling import COMMON, FLAG_SETS, versions
from contest import Entry, Failures, best_of, collect, contestants, measure, ratios, yardsticks
from leg import FUNCTIONS, RANGES, SEED, TOLERANCE, LegFunction, draw
from peers.source import HERE, Caller
from report import packages, table, write
from timing import METRICS, Bench, Times, pin_core

PEERS = ("walkgen_libm", "hand_c", "casadi_c", "sympy_c", "symforce_cpp", "wrenfold_cpp", "pinocchio_cpp")
RIVALS = ("CasADi", "sympy cse", "symforce", "wrenfold")
"""The generators that walkgen is measured against; hand-written code and Pinocchio stand beside."""
PACKAGES = ("casadi", "sympy", "symforce", "wrenfold", "pin", "numpy")


def called_from_python(bench: Bench, repetitions: int, failures: Failures) -> list[Entry]:
    """lambdify, Pinocchio's bindings and walkgen's runtime."""
    try:
        everyone = importlib.import_module("peers.python_calls").callers()
    except Exception:
        failures.add_raised("from Python")
        return []
    entries: list[Entry] = []
    for function in FUNCTIONS:
        callers = []
        for caller in (caller for caller in everyone if caller.function == function.name):
            wrong = python_timing.check(caller, function, bench.few)
            callers += [] if wrong else [caller]
            if wrong:
                failures.add(f"{caller.peer} from Python, {function.name} ({caller.form})", wrong)
        times = python_timing.race(callers, function, bench.few, bench.many, repetitions)
        entries += [_python_entry(caller, ns) for caller, ns in zip(callers, times, strict=True)]
    return entries


def _python_entry(caller: Caller, ns: Times) -> Entry:
    return {"function": caller.function, "peer": f"{caller.peer} (Python)", "form": caller.form, "flags": [], "ns": ns}


def show(function: LegFunction, entries: Sequence[Entry]) -> None:
    """A row for each contestant's best by each measure, then walkgen against the best rival."""
    own = [entry for entry in entries if entry["peer"] == "walkgen"]
    heads = [function.title, *(f"{metric} ns" for metric in METRICS), *(f"/ walkgen {metric}" for metric in METRICS)]
    names = dict.fromkeys(entry["peer"] for entry in entries)
    rows = [_row(name, [entry for entry in entries if entry["peer"] == name], own) for name in names]
    default = [entry for entry in own if entry["form"] == "default flags"]
    print(table(heads, [*rows, _row("walkgen, its own flags", default, own)]))
    for metric, ratio in ratios(entries, RIVALS).items():
        shares = f"{ratio['default']:.3f} by default, {ratio['plain']:.3f} with -O2, {ratio['best']:.3f} with its best flags"
        shares += f", {ratio['libm']:.3f} with the C library"
        print(f"  walkgen / best rival ({ratio['rival']}), {metric}: {shares}")
    print()


def _row(name: str, entries: Sequence[Entry], own: Sequence[Entry]) -> list[str]:
    bests = [best_of(entries, metric) for metric in METRICS]
    yard = [best_of(own, metric) for metric in METRICS]
    numbers = [f"{best['ns'][metric]:.2f}" if best else "" for best, metric in zip(bests, METRICS, strict=True)]
    shares = [f"{a['ns'][m] / b['ns'][m]:.2f}" if a and b else "" for a, b, m in zip(bests, yard, METRICS, strict=True)]
    return [name, *numbers, *shares]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=201, help="medians are taken of so many")
    parser.add_argument("--rows", type=int, default=4096, help="varied rows for single calls")
    parser.add_argument("--batch", type=int, default=100_000, help="rows of a batch")
    parser.add_argument("--span", choices=tuple(RANGES), default="limits", help="joint angles: the spec's limits or the full turn")
    return parser.parse_args()


def main() -> None:
    """Build, compare, time, print, write."""
    options, failures = _options(), Failures()
    bench = Bench(draw(options.rows, options.span), draw(options.batch, options.span))
    runners = contestants(collect(PEERS, failures), FUNCTIONS, bench, failures)
    beside = yardsticks()
    core = pin_core()
    entries = [entry for name in runners for entry in measure(runners[name], beside, bench, options.repetitions)]
    entries += called_from_python(bench, options.repetitions, failures)
    by_function = {function.name: [entry for entry in entries if entry["function"] == function.name] for function in FUNCTIONS}
    for function in FUNCTIONS:
        show(function, by_function[function.name])
    for message in failures.messages:
        print(f"NOT MEASURED  {message}")
    print("Pinocchio has no closed-form inverse; its Hessian is z_i x J_j from its Jacobian.")
    shares = {"walkgen_over_best_rival": {name: ratios(found, RIVALS) for name, found in by_function.items()}}
    measured = {"not_measured": failures.messages, **shares, "entries": entries}
    path = write(f"kinematics_{options.span}", {**_settings(options, core), **measured})
    print(f"written: {path.relative_to(HERE.parents[1])}")


def _settings(options: argparse.Namespace, core: int) -> Entry:
    """What a reader needs to run this again."""
    inputs = {**vars(options), "seed": SEED, "tolerance": TOLERANCE, "core": core}
    flags = {"flag_sets": [list(flags) for flags in FLAG_SETS], "common_flags": list(COMMON)}
    return {"settings": inputs, "compilers": versions(), **flags, "packages": packages(PACKAGES)}


if __name__ == "__main__":
    main()

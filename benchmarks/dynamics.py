"""Is walkgen's C of dynamics and rates faster than the peers'? Prints ns and ratios, writes results/dynamics.json.

One 3R leg (specs/mero_leg.toml) held at its platform: inverse dynamics, mass matrix, forward dynamics, the foot's Jdot qd, and joint
rates and accelerations from those of the foot, which walkgen damps and gives a status and the others do not. The whole of
specs/mero.toml, 24 joints on a floating base: inverse dynamics and mass matrix. The generators are given recursive Newton-Euler and
composite bodies, exact zeros and ones kept as such; "closed" is the leg simplified by hand beforehand. Every peer counts with its best
form and flags; outputs are compared, most with Pinocchio's called from Python, before anything is timed.
"""

import argparse
import importlib
from collections.abc import Iterable, Sequence

from compiling import COMMON, FLAG_SETS, versions
from contest import Entry, Failures, best_of, contestants, measure, ratios, yardsticks
from motion_bench import MotionBench
from motions import FUNCTIONS, SEED, TOLERANCE, DynamicFunction
from peers.dynamics_source import CLOSED_SUFFIX
from peers.source import HERE, Source
from report import packages, table, write
from timing import METRICS, pin_core

PEERS = ("hand", "casadi", "sympy", "symforce", "wrenfold", "pinocchio")
SLOW = ("pinocchio_native",)
"""Peers that take minutes to compile once; their library of an earlier run is used again."""
GENERATORS = ("CasADi", "sympy cse", "symforce", "wrenfold")
SIMPLIFIED = tuple(name + CLOSED_SUFFIX for name in GENERATORS)
RIVALS = {
    "generators": GENERATORS,
    "generators given simplified equations": SIMPLIFIED,
    "generators given either": (*GENERATORS, *SIMPLIFIED),
    "Pinocchio": ("Pinocchio",),
}
_EITHER = "generators given either"
BOUNDS = {
    "leg_inverse_dynamics": (_EITHER, 0.50),
    "leg_mass_matrix": (_EITHER, 0.40),
    "leg_bias_acceleration": (_EITHER, 0.40),
    "leg_inverse_rates": (_EITHER, 0.40),
    "mero_inverse_dynamics": ("Pinocchio", 0.5),
}
"""What walkgen's time over the rivals' best must not exceed."""
PACKAGES = ("casadi", "sympy", "symforce", "wrenfold", "pin", "numpy")
BATCHES = {"leg": 16_384, "mero": 512}
"""Rows of a batch."""


def sources(peers: Iterable[str], failures: Failures) -> tuple[Source, ...]:
    """walkgen's units, which must build, and every peer's; a peer that breaks is reported."""
    found = list(importlib.import_module("peers.dynamics_walkgen").PEER.make())
    for module in peers:
        try:
            found += importlib.import_module(f"peers.dynamics_{module}").PEER.make()
        except Exception:
            failures.add_raised(module)
    return tuple(found)


def shares(entries: Sequence[Entry]) -> dict[str, Entry]:
    """walkgen over each kind of rival, by each measure."""
    return {kind: ratios(entries, names) for kind, names in RIVALS.items()}


def show(function: DynamicFunction, entries: Sequence[Entry]) -> None:
    """A row for each contestant's best by each measure, then walkgen against the best of each kind of rival."""
    own = [entry for entry in entries if entry["peer"] == "walkgen"]
    heads = [function.title, *(f"{metric} ns" for metric in METRICS), *(f"/ walkgen {metric}" for metric in METRICS), "form and flags"]
    names = dict.fromkeys(entry["peer"] for entry in entries)
    rows = [_row(name, [entry for entry in entries if entry["peer"] == name], own) for name in names]
    default = [entry for entry in own if entry["form"] == "default flags"]
    print(table(heads, [*rows, _row("walkgen, its own flags", default, own)]))
    for kind, found in shares(entries).items():
        for metric, ratio in found.items():
            bound = BOUNDS.get(function.name, ("", 0.0))
            wanted = f"; asked: at most {bound[1]}" if bound[0] == kind and metric == "throughput" else ""
            numbers = f"{ratio['default']:.3f} by default, {ratio['plain']:.3f} with -O2, {ratio['best']:.3f} with its best flags"
            print(f"  walkgen / best of {kind} ({ratio['rival']}), {metric}: {numbers}{wanted}")
    print()


def _row(name: str, entries: Iterable[Entry], own: Sequence[Entry]) -> list[str]:
    entries = list(entries)
    bests = [best_of(entries, metric) for metric in METRICS]
    yard = [best_of(own, metric) for metric in METRICS]
    ns = [f"{best['ns'][metric]:.1f}" if best else "" for best, metric in zip(bests, METRICS, strict=True)]
    over = [f"{a['ns'][m] / b['ns'][m]:.2f}" if a and b else "" for a, b, m in zip(bests, yard, METRICS, strict=True)]
    fastest = bests[0]
    return [name, *ns, *over, f"{fastest['form']}; {' '.join(fastest['flags'])}" if fastest and fastest["form"] != "default flags" else ""]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=201, help="medians are taken of so many")
    parser.add_argument("--rows", type=int, default=4096, help="varied rows for single calls")
    parser.add_argument("--slow", action="store_true", help="also Pinocchio compiled from its headers, which takes minutes and 6 GB")
    return parser.parse_args()


def main() -> None:
    """Build, compare, time, print, write."""
    options, failures = _options(), Failures()
    units, beside = sources((*PEERS, *(SLOW if options.slow else ())), failures), yardsticks()
    benches = {function: MotionBench.of(function, options.rows, BATCHES[function.robot]) for function in FUNCTIONS}
    runners = {function: contestants(units, (function,), bench, failures)[function.name] for function, bench in benches.items()}
    core = pin_core()
    found: dict[str, list[Entry]] = {}
    for function, bench in benches.items():
        found[function.name] = measure(runners[function], beside, bench, options.repetitions)
        show(function, found[function.name])
    for message in dict.fromkeys(failures.messages):
        print(f"NOT MEASURED  {message}")
    print("Pinocchio is called from C++; on mero its answers stay in its memory, and its base pose is a quaternion made beforehand.")
    settings = {**vars(options), "batches": BATCHES, "seed": SEED, "tolerance": TOLERANCE, "core": core}
    flags = {"flag_sets": [list(flags) for flags in FLAG_SETS], "common_flags": list(COMMON)}
    context = {"settings": settings, "compilers": versions(), **flags, "packages": packages(PACKAGES)}
    measured = {"bounds": BOUNDS, "walkgen_over_best": {name: shares(entries) for name, entries in found.items()}}
    entries = [entry for each in found.values() for entry in each]
    path = write("dynamics", {**context, "not_measured": list(dict.fromkeys(failures.messages)), **measured, "entries": entries})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()

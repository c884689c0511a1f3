"""What does walkgen's inverse cost beside a hand-written one, and how often do others find it? Writes results/inverse.json.

First the Fig. 7 leg of specs/mero_leg.toml, one branch and all four, beside the formulas written by hand in by_hand.c (3 and 4 atan2, no
status), everyone with its best flags; the bound is 1.2 times the hand-written version. Then targets that forward kinematics made, for that
leg, for two legs of no special class and for a 6R arm: Newton's method on Pinocchio, Robotics Toolbox, EAIK and ssik, from near and from
random seeds, with the share of targets they reach, or the words of their refusal; without a refusal of its own, why it was not tried.
"""

import argparse
import importlib
import warnings
from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError
from itertools import product

from compiling import COMMON, FLAG_SETS, versions
from contest import Entry, Failures, best_of, collect, contestants, measure
from leg import FUNCTIONS, SEED, TOLERANCE, draw
from peers.solver import Solvers
from peers.source import HERE
from problems import CLOSE, REACHED, Problem, problems
from problems import SEED as PROBLEM_SEED
from report import packages, table, write
from solving import entrants, entry
from timing import METRICS, Bench, pin_core

BOUND = 1.2
HAND = "by hand"
HANDS = (HAND, "by hand, walkgen's atan2")
"""The second is information: what the gain owes to the arctangent, and what to the rest."""
HANDWRITTEN = ("hand_c", "hand_trig_c")
SPANS = ("limits", "turn")
INVERSES = tuple(function for function in FUNCTIONS if function.angles)
PEERS = ("by_walkgen", "by_newton_cpp", "by_newton", "by_robotics_toolbox", "by_eaik", "by_ssik")
PACKAGES = ("numpy", "pin", "roboticstoolbox-python", "EAIK", "ssik")


def beside_hand(span: str, options: argparse.Namespace, failures: Failures) -> list[Entry]:
    """Times of walkgen and of the hand-written versions, in one run."""
    bench = Bench(draw(options.rows, span), draw(options.batch, span))
    runners = contestants(collect(HANDWRITTEN, failures), INVERSES, bench, failures)
    found = [entry for name in runners for entry in measure(runners[name], (), bench, options.repetitions)]
    return [{"span": span, **entry} for entry in found]


def comparison(entries: Sequence[Entry]) -> list[Entry]:
    """For every span, function and measure: ns of walkgen by default, with its best flags and by hand, and the ratios."""
    found = []
    for span, function, metric in product(SPANS, INVERSES, METRICS):
        mine = [entry for entry in entries if (entry["span"], entry["function"]) == (span, function.name)]
        default = [entry for entry in mine if entry["form"] == "default flags"]
        groups = {"default": default, **{name: [entry for entry in mine if entry["peer"] == name] for name in ("walkgen", *HANDS)}}
        best = {name: best_of(group, metric) for name, group in groups.items()}
        ns = {name: entry["ns"][metric] for name, entry in best.items() if entry}
        shares = {f"{name} / {HAND}": ns[name] / ns[HAND] for name in ("default", "walkgen")}
        found.append({"span": span, "function": function.name, "title": function.title, "metric": metric, "ns": ns, "shares": shares})
    return found


def solved(problem: Problem, repetitions: int, failures: Failures, refusals: list[Entry]) -> list[Entry]:
    """Everyone's answers to one problem, judged and timed; a peer that breaks is reported, whatever it raises."""

    def refuse(who: str, words: str) -> None:
        refusals.append({"problem": problem.name, "peer": who, "words": words})

    found: list[Entry] = []
    for module in PEERS:
        try:
            solvers: Solvers = importlib.import_module(f"peers.{module}").solvers
            for solver in solvers(problem, refuse):
                everyone, message = entrants(problem, solver)
                if message:
                    failures.add(f"{solver.peer} {solver.form}", message)
                found += [entry(entrant, repetitions) for entrant in everyone]
        except Exception:
            failures.add_raised(f"{module}, {problem.name}")
    return found


def show_comparison(found: Iterable[Entry]) -> None:
    """walkgen beside the hand-written versions."""
    heads = ("joint angles, function, measure", "walkgen, its flags", "best flags", *HANDS, "its flags / by hand", "best flags / by hand")
    rows = []
    for line in found:
        ns = [f"{line['ns'][name]:.1f}" if name in line["ns"] else "" for name in ("default", "walkgen", *HANDS)]
        rows.append((f"{line['span']}, {line['title']}, {line['metric']}", *ns, *(f"{share:.2f}" for share in line["shares"].values())))
    print(table(heads, rows))
    worst = ", ".join(f"{max(row[column] for row in rows)} {words}" for column, words in ((-2, "with its flags"), (-1, "with the best")))
    print(f"  ns a call; the bound is {BOUND} times by hand; at the worst {worst}\n")


def show_solved(problem: Problem, entries: Iterable[Entry], refusals: Iterable[Entry]) -> None:
    """Who reaches how many targets, and in what time."""
    heads = (problem.title, "seed", "reached", "to 1 mm", "beyond", "its q found", "answers", "largest error", "us a call")
    rows = []
    for line in entries:
        shares = [f"{100 * line[name]:.1f} %" for name in ("reached", "close", "wrong", "found")]
        time = f"{1e-3 * line['ns']['throughput']:.3f}"
        name, error = f"{line['peer']}: {line['form']}", f"{line['error']:.0e}" if line["reached"] else ""
        rows.append((name, line["seeds"] or "none", *shares, f"{line['branches']:.2f}", error, time))
    print(table(heads, rows))
    for line in refusals:
        print(f"  WITHOUT  {line['peer']}: {line['words']}")
    print()


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=201, help="medians are taken of so many")
    parser.add_argument("--rows", type=int, default=4096, help="varied rows for single calls")
    parser.add_argument("--batch", type=int, default=20_000, help="rows of a batch")
    return parser.parse_args()


def _versions() -> dict[str, str]:
    """Of the packages that are there."""
    found = {}
    for name in PACKAGES:
        try:
            found |= packages((name,))
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def main() -> None:
    """Compare, time, judge, print, write."""
    warnings.simplefilter("ignore")  # of the peers
    options, failures, refusals, core = _options(), Failures(), [], pin_core()
    entries = [entry for span in SPANS for entry in beside_hand(span, options, failures)]
    compared = comparison(entries)
    show_comparison(compared)
    answers: list[Entry] = []
    for problem in problems(options.rows):
        found = solved(problem, options.repetitions, failures, refusals)
        show_solved(problem, found, (line for line in refusals if line["problem"] == problem.name))
        answers += found
    for message in failures.messages:
        print(f"NOT MEASURED  {message}")
    settings = {**vars(options), "seeds": [SEED, PROBLEM_SEED], "tolerance": TOLERANCE, "reached": REACHED, "close": CLOSE, "core": core}
    flags = {"flag_sets": [list(flags) for flags in FLAG_SETS], "common_flags": list(COMMON)}
    conditions = {"settings": settings, "compilers": versions(), **flags, "packages": _versions()}
    measured = {"bound": BOUND, "beside_hand": compared, "answers": answers, "refusals": refusals, "not_measured": failures.messages}
    path = write("inverse", {**conditions, **measured, "entries": entries})
    print(f"written: {path.relative_to(HERE.parents[1])}")


if __name__ == "__main__":
    main()

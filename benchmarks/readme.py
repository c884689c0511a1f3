"""Puts the measured figures on the README's first screen: reads results/*.json, writes what stands between the two marks."""

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import contest
from contest import Entry, best_of
from kinematics import RIVALS
from leg import FUNCTIONS
from report import RESULTS
from timing import METRICS

README = Path(__file__).parents[1] / "README.md"
MARKS = ("<!-- figures: benchmarks/readme.py writes them -->", "<!-- end of figures -->")
METRIC = "throughput"
YARDSTICKS = tuple(function.name for function in contest.YARDSTICKS)


def result(name: str) -> dict[str, Any]:
    """One benchmark's JSON."""
    content: dict[str, Any] = json.loads((RESULTS / f"{name}.json").read_text())
    return content


def lines() -> Iterator[str]:
    """The figures as Markdown."""
    kinematics, build, counts = result("kinematics_limits"), result("build_time")["median_s"], result("operations")["counts"]
    yield from _table(kinematics)
    yield ""
    yield from _conditions(kinematics)
    yield ""
    yield _behind([*kinematics["entries"], *result("dynamics")["entries"]])
    yield ""
    yield (
        f"`benchmarks/build_time.py`: `walkgen build specs/mero.toml`, compiler included, {build['build mero']:.1f} s; "
        f"`import walkgen.runtime` {build['import walkgen.runtime']:.2f} s. `benchmarks/operations.py`: "
        f"{counts['foot_position']['walkgen']} operations for the foot's position, {counts['foot_position_jacobian']['walkgen']} with its "
        "Jacobian, inputs and outputs counted."
    )
    yield ""
    yield _size({entry["name"]: entry for entry in result("size")["entries"]})
    yield ""
    yield _robot(result("robot_compile_time")["seconds"]["walkgen's flags"])
    yield ""
    yield from _many_rows(result("batches"))


def _table(kinematics: dict[str, Any]) -> Iterator[str]:
    yield "| 3R leg, ns a call in C | walkgen | its default flags | best of CasADi, SymPy, SymForce, wrenfold | by hand | Pinocchio C++ |"
    yield "| --- | --: | --: | --: | --: | --: |"
    for function in FUNCTIONS:
        entries = [entry for entry in kinematics["entries"] if entry["function"] == function.name]
        own = [entry for entry in entries if entry["peer"] == "walkgen"]
        default = [entry for entry in own if entry["form"] == "default flags"]
        others = [[entry for entry in entries if entry["peer"] in peers] for peers in (RIVALS, ("by hand",), ("Pinocchio",))]
        yield f"| {function.title} | {' | '.join(_cell(group) for group in (own, default, *others))} |"


def _cell(entries: list[Entry]) -> str:
    best = best_of(entries, METRIC)
    return f"{best['ns'][METRIC]:.1f}" if best else ""


def _conditions(kinematics: dict[str, Any]) -> Iterator[str]:
    machine, packages = kinematics["machine"], kinematics["packages"]
    versions = ", ".join(f"{name} {packages[name]}" for name in ("casadi", "sympy", "symforce", "wrenfold", "pin"))
    yield (
        f"Measured {kinematics['date'][:10]} by `benchmarks/kinematics.py` on {machine['processor']}, {kinematics['compilers']['gcc']}, "
        f"{versions}; all in one run, each with its best flags, outputs compared before timing. walkgen's inverse decides a status for "
        "every branch and wraps its angles, the others' give angles alone."
    )


def _size(found: dict[str, Entry]) -> str:
    own, hand, casadi = (found[name] for name in ("walkgen", "by hand", "CasADi"))
    return (
        f"`benchmarks/size.py`: nine functions of the leg take {own['bytes']} bytes on a Cortex-M7, {own['small']} with WALKGEN_SMALL, "
        f"{own['least']} also without closest points and damping, CasADi's {casadi['bytes']}, by hand {hand['bytes']}; to compile, "
        f"{own['seconds'] / casadi['seconds']:.1f} times as long as CasADi's C, batches included, "
        f"{own['single'] / casadi['single']:.1f} times without."
    )


def _robot(seconds: dict[str, float]) -> str:
    own, single = (seconds[name] / seconds["CasADi"] for name in ("walkgen", "without batches"))
    return (
        "`benchmarks/robot_compile_time.py`: the same functions of a whole robot, mero with its six legs and the routes to its feet, take "
        f"{own:.2f} of the time of CasADi's C to compile, batches included, {single:.2f} without."
    )


def _many_rows(batches: dict[str, Any]) -> Iterator[str]:
    """Of those in cache and of a million, in double and in float."""
    names = ("lanes", "C library, row by row", "lanes, planar", "C library, planar", "memcpy of as many bytes")
    yield "| Many rows of the leg, ns a row in C | rows | C library's sines | component-major | C library's sines | memcpy |"
    yield "| --- | --: | --: | --: | --: | --: |"
    for entry in batches["entries"]:
        figures = " | ".join(f"{entry['ns'][name]:.1f}" for name in names)
        yield f"| {entry['function']}, {entry['real']}, {entry['span']} | {figures} |"
    python = " and ".join(f"{entry['function']} {entry['ns']['NumPy'] / entry['ns']['walkgen']:.1f}" for entry in batches["from_python"])
    yield ""
    yield f"By `benchmarks/batches.py`. From Python a million rows of {python} times as fast as the same formulas in NumPy."


def _behind(entries: list[Entry]) -> str:
    """Where somebody is as fast as walkgen or faster, by any measure; walkgen's own flags where they are the slower ones."""
    found = [
        f"{function} ({metric}), {name}: {share:.2f} times {other}"
        for function, metric in product(dict.fromkeys(entry["function"] for entry in entries), METRICS)
        for name, share, other in _shares([entry for entry in entries if entry["function"] == function], metric)
    ]
    if not found:
        return "In neither run is anybody ahead of walkgen, its default flags included."
    return f"Where walkgen is not ahead, by `kinematics_limits.json` and `dynamics.json`: {'; '.join(found)}."


def _shares(entries: list[Entry], metric: str) -> Iterator[tuple[str, float, str]]:
    kinds = {
        "default flags": [entry for entry in entries if entry["peer"] == "walkgen" and entry["form"] == "default flags"],
        "any flags": [entry for entry in entries if entry["peer"] == "walkgen"],
    }
    others = [entry for entry in entries if not entry["peer"].startswith("walkgen") and entry["peer"] not in YARDSTICKS]
    best = best_of(others, metric)
    for name, own in kinds.items():
        mine = best_of(own, metric)
        if best and mine and mine["ns"][metric] >= best["ns"][metric]:
            yield name, mine["ns"][metric] / best["ns"][metric], best["peer"]


def main() -> None:
    """Replace what stands between the marks."""
    before, rest = README.read_text().split(MARKS[0])
    _, after = rest.split(MARKS[1])
    README.write_text("\n".join([before + MARKS[0], *lines(), MARKS[1] + after]))
    print(f"written: {README.name}")


if __name__ == "__main__":
    main()

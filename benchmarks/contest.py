"""Finds everyone who can take part in a race of leg functions, and the ratios that come out: what two benchmarks have in common."""

import importlib
import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from compiling import compile_all, first_words
from leg import LegFunction
from peers import walkgen_c, walkgen_libm
from peers.source import HERE, Peer, Source
from timing import METRICS, Bench, Contestant, Times, race

SCREENING = 15
YARDSTICKS = (LegFunction("three_sincos", "", ()), LegFunction("empty", "", ()))

Entry = dict[str, Any]


@dataclass
class Failures:
    """Who could not take part, and why; said in the table and in the JSON."""

    messages: list[str] = field(default_factory=list)

    def add(self, who: str, why: str) -> None:
        self.messages.append(f"{who}: {why}")

    def add_raised(self, who: str) -> None:
        """The words of the exception that is being handled."""
        self.add(who, first_words(traceback.format_exc(limit=-1)))


def collect(modules: Iterable[str], failures: Failures) -> tuple[Source, ...]:
    """walkgen's units, which must build, and every peer's; a peer that breaks is reported, whatever it raises."""
    found = list(walkgen_c.PEER.make())
    for module in modules:
        try:
            peer: Peer = importlib.import_module(f"peers.{module}").PEER
            found += peer.make()
        except Exception:
            failures.add_raised(module)
    return tuple(found)


def contestants(
    sources: Sequence[Source], functions: Iterable[LegFunction], bench: Bench, failures: Failures
) -> dict[str, list[Contestant]]:
    """By function, everyone who builds and computes the right numbers."""
    builds = compile_all(sources)
    for source in sources:
        messages = {build.message for build in builds if build.source == source and build.message}
        for message in messages:
            failures.add(f"{source.peer} ({source.form})", message)
    good: dict[str, list[Contestant]] = {}
    for function in functions:
        runners = [Contestant(build, function) for build in builds if not build.message]
        good[function.name] = [runner for runner in runners if runner.exists and _agrees(runner, bench, failures)]
    return good


def _agrees(runner: Contestant, bench: Bench, failures: Failures) -> bool:
    wrong = bench.check(runner)
    if wrong:
        failures.add(f"{runner.peer} {runner.function.name} ({runner.build.label})", wrong)
    return not wrong


def yardsticks() -> list[Contestant]:
    """The C library's three sincos, and an empty call."""
    source = Source("yardstick", "libm", (HERE.parent / "yardstick.c").read_text(), flags=("-O2",))
    (build,) = compile_all([source])
    return [Contestant(build, function) for function in YARDSTICKS]


def finalists(times: Mapping[Contestant, Times]) -> list[Contestant]:
    """Each peer's best by each measure; all of walkgen's."""
    chosen: dict[Contestant, None] = {}
    for peer in dict.fromkeys(runner.peer for runner in times):
        own = [runner for runner in times if runner.peer == peer]
        best = own if peer == "walkgen" else [min(own, key=lambda runner: times[runner][metric]) for metric in METRICS]
        chosen |= dict.fromkeys(best)
    return list(chosen)


def measure(runners: Sequence[Contestant], beside: Sequence[Contestant], bench: Bench, repetitions: int) -> list[Entry]:
    """Screen everyone on one function, then time the best of each side by side with the yardsticks."""
    best = finalists(race(bench, runners, min(SCREENING, repetitions)))
    times = race(bench, [*best, *beside], repetitions)
    return [_entry(runners[0].function, runner, ns) for runner, ns in times.items()]


def _entry(function: LegFunction, runner: Contestant, ns: Times) -> Entry:
    name = runner.peer if runner.peer != "yardstick" else runner.function.name
    return {"function": function.name, "peer": name, "form": runner.build.source.form, "flags": list(runner.build.flags), "ns": ns}


def best_of(entries: Iterable[Entry], metric: str) -> Entry | None:
    """The fastest entry by a measure."""
    return min((entry for entry in entries if metric in entry["ns"]), key=lambda entry: entry["ns"][metric], default=None)


def ratios(entries: Sequence[Entry], rivals: Iterable[str]) -> dict[str, Entry]:
    """walkgen over the best rival by each measure: with its default flags, with -O2 for any processor, with its best, and with libm where
    that ran.
    """
    own = [entry for entry in entries if entry["peer"] == "walkgen"]
    kinds = {"default": [entry for entry in own if entry["form"] == "default flags"], "best": own}
    kinds |= {"plain": [entry for entry in own if entry["flags"][0] == "-O2"]}
    with_libm = [entry for entry in entries if entry["peer"] == walkgen_libm.NAME]
    kinds |= {"libm": with_libm} if with_libm else {}
    found: dict[str, Entry] = {}
    for metric in METRICS:
        rival = best_of((entry for entry in entries if entry["peer"] in rivals), metric)
        if rival and all(kinds.values()):
            shares = {kind: min(entry["ns"][metric] for entry in mine) / rival["ns"][metric] for kind, mine in kinds.items()}
            found[metric] = {**shares, "rival": rival["peer"]}
    return found

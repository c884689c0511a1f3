"""From a spec to what balances it: its cam, or its best springs, every choice of the catalogue solved and the best one kept."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import ClassVar

import numpy as np

from walkgen.design.apart import check_apart
from walkgen.design.balance import Balance, Residue
from walkgen.design.cam_search import CamDesigned, cam_designed
from walkgen.design.fitting import limits_of
from walkgen.design.masses import weighed
from walkgen.design.multistart import Found, Progress
from walkgen.design.problem import Reals
from walkgen.errors import Problem, SpecError
from walkgen.spec.checks_balance import CAMS
from walkgen.spec.problems import did_you_mean, shown
from walkgen.spec.read import read
from walkgen.spec.schema import RobotSpec

_MOST_CHOICES = 256
_SPRING_STARTS, _CAM_STARTS = 24, 8
_DIGITS = 9
"""Of the values that are written: what is told is what these give."""


@dataclass(frozen=True)
class Wanted:
    """What the command line asks for; an empty name stands for the spec's only balance, None for its number of starts."""

    balance: str = ""
    starts: int | None = None
    seed: int = 0


@dataclass(frozen=True)
class Designed:
    """A balance with the values that were found.

    Attributes:
        balance: of the spec.
        values: of every parameter that changes.
        before: moments without springs.
        given: with those of the spec.
        after: with those that were found.
        lengths: least and largest of every spring (m), with its free length [3, springs].
    """

    module_prefix: ClassVar[str] = ""
    """Of the modules that report and draw it."""

    balance: Balance
    values: dict[str, float]
    before: tuple[Residue, ...]
    given: tuple[Residue, ...]
    after: tuple[Residue, ...]
    lengths: Reals


def designed(path: Path, wanted: Wanted = Wanted(), progress: Progress = lambda _: None) -> Designed | CamDesigned:
    """The springs or the cam of a spec's balance.

    Raises:
        SpecError: the spec is not a robot, has no such balance; as `springs_designed` and `cam_designed`.
    """
    progress("read")
    spec = read(path)
    name = _chosen(spec, wanted.balance, path)
    if spec.balance[name].device in CAMS:
        return cam_designed(spec, name, path, _starts(spec, name, wanted, _CAM_STARTS), wanted.seed, progress)
    return springs_designed(spec, name, path, wanted, progress)


def springs_designed(spec: RobotSpec, name: str, path: Path, wanted: Wanted = Wanted(), progress: Progress = lambda _: None) -> Designed:
    """Search the springs of a spec's balance.

    Raises:
        SpecError: joints that are to be balanced each by itself are not apart, no springs within the bounds only pull and fit, or their
            masses do not settle.
    """
    starts, given = _starts(spec, name, wanted, _SPRING_STARTS), Balance(spec, name, path.parent)
    check_apart(given)
    best: tuple[Found, Balance] | None = None
    for settings in _choices(given, path):
        made = weighed(lambda values: Balance(spec, name, path.parent, values), settings, starts, wanted.seed, progress)
        best = made if best is None or made[0].better(best[0]) else best
    assert best is not None
    return _rounded(given, *best)


def _starts(spec: RobotSpec, name: str, wanted: Wanted, usual: int) -> int:
    """What the command line asks for, else the spec, else as many as usual."""
    return next(starts for starts in (wanted.starts, spec.balance[name].starts, usual) if starts is not None)


def _chosen(spec: RobotSpec, name: str, path: Path) -> str:
    if not spec.balance:
        raise SpecError(Problem("WG215", f"{path} has no [balance.NAME]", "add one: device, leg, load, support_deg; see docs/balancing.md"))
    if name and name not in spec.balance:
        raise SpecError(Problem("WG215", f'there is no balance "{shown(name)}"', did_you_mean(name, spec.balance, "known balances")))
    if not name and len(spec.balance) > 1:
        raise SpecError(Problem("WG215", f"{path} has several balances", f"choose one: --balance {next(iter(spec.balance))}"))
    return name or next(iter(spec.balance))


def _choices(balance: Balance, path: Path) -> Iterator[dict[str, float]]:
    """One row of the catalogue for every spring, as values of parameters."""
    rows, springs = balance.table.catalogue, [spring.name for spring in balance.leg.springs]
    if len(rows) ** len(springs) > _MOST_CHOICES:
        message = f"{path}: {len(rows)} rows of the catalogue for {len(springs)} springs are {len(rows) ** len(springs)} choices"
        raise SpecError(Problem("WG216", message, f"keep to {_MOST_CHOICES} of them"))
    if not rows:
        yield {}
        return
    for choice in product(rows, repeat=len(springs)):
        yield {f"{spring}_{key}": balance.number(value) for spring, row in zip(springs, choice, strict=True) for key, value in row.items()}


def _rounded(given: Balance, found: Found, balance: Balance) -> Designed:
    """What is written and told; springs that would push are refused."""
    low, high = balance.problem.low, balance.problem.high
    x = np.array([float(f"{value:.{_DIGITS}g}") for value in np.clip(found.x, low, high)])
    if not found.feasible:
        raise SpecError(_unfit(balance, x))
    values = dict(zip(balance.names, map(float, x), strict=True)) | balance.settings
    lengths = np.array([*balance.stretches(x), balance.free_lengths(x)])
    return Designed(given, values, given.bare, given.residues(given.problem.start), balance.residues(x), lengths)


def _unfit(balance: Balance, x: Reals) -> Problem:
    """Of the nearest answer, where a spring is worst."""
    low, high = limits_of(balance.table, balance.free_lengths(x), balance.number)
    worst: tuple[float, str] = (0.0, "its ends are out of their boxes")
    for each in balance.ranges:
        values, lengths = balance.lengths_over(each, x)
        for number, spring in enumerate(balance.leg.springs):
            for excess, words in ((low[number] - lengths[:, number], "shorter"), (lengths[:, number] - high[number], "longer")):
                place = int(excess.argmax())
                limit = low[number] if words == "shorter" else high[number]
                if excess[place] > worst[0]:
                    at = f"{each.name} = {values[place]:.4g} {each.unit}"
                    worst = (
                        float(excess[place]),
                        f"{spring.name} is {lengths[place, number]:.4g} m long at {at}, {words} than {limit:.4g} m",
                    )
    message = f"balance {balance.name}: no springs within the bounds only pull and fit; of the nearest ones {worst[1]}"
    return Problem("WG218", message, "widen the bounds of parameters, stretch or boxes, or narrow the ranges")

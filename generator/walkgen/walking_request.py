"""What `walkgen gait` is asked for, checked against the spec: which gait, over which ground, with which options; every problem at once."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from walkgen.errors import Problem, SpecError, WalkgenError
from walkgen.gait import balance
from walkgen.gait.ground import Ground
from walkgen.gait.pattern import Gait
from walkgen.gait.simulate import Options
from walkgen.gait.trajectory import Trajectory
from walkgen.model.gait import Gait as SpecGait
from walkgen.model.gait import Schedule
from walkgen.model.mechanism import Mechanism
from walkgen.model.walk import number
from walkgen.spec.problems import did_you_mean, shown
from walkgen.walking_ground import terrain_of

_SPACE = 3
"""Joints of a leg that puts its foot anywhere."""


@dataclass(frozen=True)
class Wanted:
    """What the command line asks for; empty texts and None stand for what the spec says."""

    gait: str = ""
    terrain: str = ""
    body: str = ""
    margin: float | None = None
    cycles: int = 3
    rate: float = 100.0
    from_rest: bool = False
    adapt: bool = False
    give: float = 0.0
    heading: float = 0.0
    mu: float | None = None


class Request(NamedTuple):
    """Timing, feet unless they have paths of their own, ground unless it is the spec's, and how to walk."""

    timing: Gait
    trajectory: Trajectory | None
    ground: Ground | None
    options: Options


def request(mechanism: Mechanism, wanted: Wanted, path: Path) -> Request:
    """What to walk.

    Raises:
        SpecError: everything that is wrong with what was asked for at once.
    """
    problems: list[Problem] = []
    gait = _collected(problems, lambda: _chosen(mechanism, wanted.gait, path))
    feet = _collected(problems, lambda: _trajectory(mechanism, gait, wanted, path)) if gait else None
    ground = _collected(problems, lambda: terrain_of(wanted.terrain))
    problems += _out_of_range(wanted)
    if problems:
        raise SpecError(*problems)
    assert feet is not None
    timing, trajectory = feet
    return Request(timing, trajectory, ground, _options(mechanism, gait, wanted))


def _out_of_range(wanted: Wanted) -> list[Problem]:
    found = []
    if wanted.cycles < 1 or not 0.0 < wanted.rate <= 1e5:
        message = f"{wanted.cycles} cycles at {wanted.rate:g} instants a second"
        found.append(Problem("WG615", message, "one cycle at least, 0 to 1e5 instants"))
    numbers = {"--heading": wanted.heading, "--margin": wanted.margin or 0.0, "--give": wanted.give, "--mu": wanted.mu or 0.0}
    signed = ("--heading", "--margin")
    for name, value in numbers.items():
        if not math.isfinite(value) or (value < 0.0 and name not in signed):
            found.append(Problem("WG622", f"{name} {value:g}", f"give a finite number{'' if name in signed else ', 0 at least'}"))
    return found


def _collected(problems: list[Problem], one: Callable[[], Any]) -> Any:
    try:
        return one()
    except WalkgenError as error:
        problems.extend(error.problems)
        return None


def _trajectory(mechanism: Mechanism, gait: SpecGait, wanted: Wanted, path: Path) -> tuple[Gait, Trajectory | None]:
    label = f"gait {shown(gait.name)}" if gait.name else "the gait"
    own = all(len(leg.joints) < _SPACE for leg in mechanism.legs)
    if (gait.stance is None or gait.lift is None) and not own:
        cure = "give it stance = { leg = [x, y, z], ... }, where each foot is in the middle of its support, and lift"
        raise SpecError(Problem("WG612", f"{path}: {label} only says when legs step, not where", cure))
    timing = Gait(
        tuple(leg.name for leg in mechanism.legs),
        tuple(map(float, gait.duty_factor)),
        tuple(map(float, gait.phase)),
        float(gait.period),
        float(gait.stride),
    )
    if gait.stance is None or gait.lift is None:
        return timing, None
    x, y, z = zip(*gait.stance, strict=True)
    found = Trajectory(timing, tuple(zip(map(float, x), map(float, y), map(float, z), strict=True)), float(gait.lift))
    if _body(gait, wanted) != "level":
        _one_at_a_time(found, label)
    return timing, found


def _chosen(mechanism: Mechanism, name: str, path: Path) -> SpecGait:
    gaits = {gait.name: gait for gait in mechanism.gaits}
    if not gaits:
        raise SpecError(
            Problem("WG610", f"{path} has no [gait]", "add one: kind, period, stride, lift, left, right and stance; see docs/gait.md")
        )
    if name and name not in gaits:
        raise SpecError(Problem("WG611", f'there is no gait "{shown(name)}"', did_you_mean(name, filter(None, gaits), "known gaits")))
    cycles = {key: gait for key, gait in gaits.items() if not isinstance(gait, Schedule)}
    chosen = cycles.get(name) if name else next(iter(cycles.values()), None)
    if chosen is None:
        message = f"{path}: the gait is a list of events; a walk goes on in cycles"
        raise SpecError(Problem("WG621", message, did_you_mean("", filter(None, cycles), "its other gaits")))
    return chosen


def _one_at_a_time(trajectory: Trajectory, label: str) -> None:
    try:
        balance.with_pauses(trajectory)
    except ValueError as error:
        raise SpecError(
            Problem("WG614", f"{label}: {error}", 'take kind = "crawl" or "wave" with a larger duty factor, or a level body')
        ) from None


def _body(gait: SpecGait, wanted: Wanted) -> str:
    return wanted.body or gait.body


def _options(mechanism: Mechanism, gait: SpecGait, wanted: Wanted) -> Options:
    joints = [joint for limb in mechanism.limbs for joint in limb.joints]
    speeds = tuple(math.inf if joint.max_speed is None else float(number(joint.max_speed, mechanism)) for joint in joints)
    own = 0.0 if gait.margin is None else float(gait.margin)
    return Options(
        cycles=wanted.cycles,
        rate=wanted.rate,
        from_rest=wanted.from_rest,
        adapt=wanted.adapt,
        body=_body(gait, wanted),  # type: ignore[arg-type]
        margin=own if wanted.margin is None else wanted.margin,
        max_speed=speeds,
        give=wanted.give,
        heading=math.radians(wanted.heading),
        mu=wanted.mu,
        units=tuple(joint.unit for joint in joints),
    )

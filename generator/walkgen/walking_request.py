"""What `walkgen gait` is asked for, checked against the spec: which gait, over which ground, with which options; every problem at once."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from walkgen.errors import Problem, SpecError, WalkgenError
from walkgen.gait import balance
from walkgen.gait.ground import Ground
from walkgen.gait.pattern import Event, Gait
from walkgen.gait.schedule import Schedule as ScheduledEvents
from walkgen.gait.simulate import Options
from walkgen.gait.steps import Point, Steps
from walkgen.gait.trajectory import Trajectory
from walkgen.model.gait import Gait as SpecGait
from walkgen.model.gait import Schedule
from walkgen.model.mechanism import Mechanism
from walkgen.model.walk import number
from walkgen.spec.problems import did_you_mean, shown
from walkgen.walking_ground import terrain_of

_SPACE = 3
"""Joints of a leg that puts its foot anywhere."""
_CYCLES = "take a periodic gait"


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
    """Timing of feet that have paths of their own, all other feet, ground unless it is the spec's, and how to walk."""

    timing: Gait | None
    feet: Trajectory | Steps | None
    ground: Ground | None
    options: Options


def request(mechanism: Mechanism, wanted: Wanted, path: Path) -> Request:
    """What to walk.

    Raises:
        SpecError: everything that is wrong with what was asked for at once.
    """
    problems: list[Problem] = []
    gait = _collected(problems, lambda: _chosen(mechanism, wanted.gait, path))
    feet = _collected(problems, lambda: _feet(mechanism, gait, wanted, path)) if gait else None
    ground = _collected(problems, lambda: terrain_of(wanted.terrain))
    problems += _out_of_range(wanted)
    if problems:
        raise SpecError(*problems)
    timing, others = (feet, None) if isinstance(feet, Gait) else (None, feet)
    return Request(timing, others, ground, _options(mechanism, gait, wanted))


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


def _feet(mechanism: Mechanism, gait: SpecGait | Schedule, wanted: Wanted, path: Path) -> Gait | Trajectory | Steps:
    """Only the timing of feet that have paths of their own and no stance."""
    label = f"gait {shown(gait.name)}" if gait.name else "the gait"
    own = all(len(leg.joints) < _SPACE for leg in mechanism.legs)
    if gait.stance is None or gait.lift is None:
        if own and isinstance(gait, SpecGait):
            return _timing(gait, mechanism)
        cure = "give it stance = { leg = [x, y, z], ... }, where each foot is in the middle of its support, and lift"
        raise SpecError(Problem("WG612", f"{path}: {label} only says when legs step, not where", cure))
    x, y, z = zip(*gait.stance, strict=True)
    stance = tuple(zip(map(float, x), map(float, y), map(float, z), strict=True))
    found: Trajectory | Steps
    if isinstance(gait, SpecGait):
        found = Trajectory(_timing(gait, mechanism), stance, float(gait.lift), float(gait.heel_off))
    else:
        found = _steps(gait, mechanism, stance, label)
    if _body(gait, wanted) != "level":
        _one_at_a_time(found, label)
        _refuse_rolling(mechanism, f"{label}: legs that roll on their soles step in planes of their own", "take --body level")
    return found


def _timing(gait: SpecGait, mechanism: Mechanism) -> Gait:
    legs = tuple(leg.name for leg in mechanism.legs)
    return Gait(legs, tuple(map(float, gait.duty_factor)), tuple(map(float, gait.phase)), float(gait.period), float(gait.stride))


def _steps(gait: Schedule, mechanism: Mechanism, stance: tuple[Point, ...], label: str) -> Steps:
    legs = tuple(leg.name for leg in mechanism.legs)
    lifted = tuple(leg for leg, up in zip(legs, gait.lifted, strict=True) if up)
    events = tuple(Event(float(event.at), legs[event.leg], event.does) for event in gait.events)
    _refuse_rolling(mechanism, f"{label}: legs that roll on their soles walk in cycles, not by a list of events", _CYCLES)
    if any(len(leg.joints) < _SPACE for leg in mechanism.legs):
        raise SpecError(Problem("WG621", f"{label}: legs with a path of their own walk in cycles, not by a list of events", _CYCLES))
    assert gait.lift is not None
    try:
        return Steps(ScheduledEvents(legs, events, lifted), stance, float(gait.lift), float(gait.stride))
    except ValueError as error:
        raise SpecError(Problem("WG621", f"{label}: {error}", "place it before the last event; lift it after 0 s")) from None


def _refuse_rolling(mechanism: Mechanism, message: str, cure: str) -> None:
    if any(leg.curved_sole for leg in mechanism.legs):
        raise SpecError(Problem("WG623", message, cure))


def _chosen(mechanism: Mechanism, name: str, path: Path) -> SpecGait | Schedule:
    gaits = {gait.name: gait for gait in mechanism.gaits}
    if not gaits:
        raise SpecError(
            Problem("WG610", f"{path} has no [gait]", "add one: kind, period, stride, lift, left, right and stance; see docs/gait.md")
        )
    if name and name not in gaits:
        raise SpecError(Problem("WG611", f'there is no gait "{shown(name)}"', did_you_mean(name, filter(None, gaits), "known gaits")))
    return gaits[name] if name else mechanism.gaits[0]


def _one_at_a_time(feet: Trajectory | Steps, label: str) -> None:
    try:
        balance.with_room(feet)
    except ValueError as error:
        raise SpecError(
            Problem("WG614", f"{label}: {error}", "let one leg step at a time with pauses between, as a crawl does, or take a level body")
        ) from None


def _body(gait: SpecGait | Schedule, wanted: Wanted) -> str:
    return wanted.body or gait.body


def _options(mechanism: Mechanism, gait: SpecGait | Schedule, wanted: Wanted) -> Options:
    joints = [joint for limb in mechanism.limbs for joint in limb.joints]
    speeds = tuple(math.inf if joint.max_speed is None else float(number(joint.max_speed, mechanism)) for joint in joints)
    own = 0.0 if gait.margin is None else float(gait.margin)
    return Options(
        cycles=wanted.cycles,
        rate=wanted.rate,
        from_rest=wanted.from_rest,
        adapt=wanted.adapt,
        body=_body(gait, wanted),  # type: ignore[arg-type]
        static=gait.static,
        margin=own if wanted.margin is None else wanted.margin,
        max_speed=speeds,
        give=wanted.give,
        heading=math.radians(wanted.heading),
        mu=wanted.mu,
        units=tuple(joint.unit for joint in joints),
    )

"""From a spec to a walk: the robot built with what a walk calls, its gait and ground chosen, the results written."""

import hashlib
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from walkgen import __version__
from walkgen.errors import Problem, SpecError, ToolchainError, WalkgenError
from walkgen.gait import balance
from walkgen.gait.chains import held
from walkgen.gait.drawing import drawing
from walkgen.gait.driven import is_driven, own_stance
from walkgen.gait.ground import Described, Ground, Slope
from walkgen.gait.legs import missing, postures
from walkgen.gait.pattern import Gait
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.table import table
from walkgen.gait.trajectory import Trajectory
from walkgen.gait.walk import Walk
from walkgen.model.assemble import assemble
from walkgen.model.gait import Gait as SpecGait
from walkgen.model.mechanism import Mechanism
from walkgen.model.walk import number
from walkgen.pipeline import BuildOptions, Progress, build
from walkgen.runtime import load
from walkgen.runtime.robot import Robot
from walkgen.spec.problems import did_you_mean, shown
from walkgen.spec.read import read
from walkgen.walking_ground import TERRAINS, terrain_of

_FUNCTIONS = (
    *("foot_positions", "foot_jacobians", "foot_bias_acceleration", "joint_frames", "frames", "inverse", "platform_poses", "adapt", "com"),
    *("height", "normal", "demanded_wrench", "floating_inverse_dynamics", "contact_forces", "stability_margins"),
)
"""What a walk calls, of those that the robot has."""
_DRIVEN = ("foot_position", "foot_jacobian")
"""And where a leg has a path of its own."""
_WITHOUT_BRANCHES = ("inverse_near",)
"""And where a leg has more than three joints."""
SUFFIXES = (".html", ".csv")
_REACHED = 1e-9
_FRAMES = 150


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


@dataclass(frozen=True)
class Walked:
    """A robot's walk over a ground; `units` are its joints'."""

    robot: Robot
    walk: Walk
    ground: Ground
    units: tuple[str, ...]


def walked(path: Path, wanted: Wanted = Wanted(), progress: Progress = lambda _: None) -> Walked:
    """Simulate a walk of the robot of a spec.

    Raises:
        SpecError: the spec is not a robot, has no such gait, or asks for a walk that no ground could help.
        ToolchainError: the compiler refused the generated code.
    """
    progress("read")
    mechanism = assemble(read(path), path.parent)
    timing, trajectory, relief = _checked(mechanism, wanted, path)
    robot = _robot(path, mechanism, progress)
    trajectory = trajectory or _on_own_paths(robot, timing)
    ground = relief or (Described(robot.terrain) if mechanism.terrain and robot.terrain else Slope())
    options = _options(mechanism, wanted)
    if options.body != "level" and not hasattr(robot, "com"):
        message = f"{path}: a {options.body} body moves the centre of mass, and the robot has no mass"
        raise SpecError(Problem("WG620", message, "give its platforms and links masses, or take --body level"))
    _refuse_unreachable(robot, trajectory, ground, options)
    progress("walk")
    return Walked(robot, simulate(robot, trajectory, ground, options), ground, options.units)


def _checked(mechanism: Mechanism, wanted: Wanted, path: Path) -> tuple[Gait, Trajectory | None, Ground | None]:
    """Gait, its feet unless they have paths of their own, and ground; everything that is wrong with what was asked for at once."""
    problems: list[Problem] = []
    feet = _collected(problems, lambda: _trajectory(mechanism, wanted, path))
    ground = _collected(problems, lambda: terrain_of(wanted.terrain))
    if wanted.cycles < 1 or not 0.0 < wanted.rate <= 1e5:
        problems.append(
            Problem("WG615", f"{wanted.cycles} cycles at {wanted.rate:g} instants a second", "one cycle at least, 0 to 1e5 instants")
        )
    if problems:
        raise SpecError(*problems)
    return *feet, ground


def _collected(problems: list[Problem], one: Callable[[], Any]) -> Any:
    try:
        return one()
    except WalkgenError as error:
        problems.extend(error.problems)
        return None


def _trajectory(mechanism: Mechanism, wanted: Wanted, path: Path) -> tuple[Gait, Trajectory | None]:
    gait = _chosen(mechanism, wanted.gait, path)
    label = f"gait {shown(gait.name)}" if gait.name else "the gait"
    own = all(len(leg.joints) < 3 for leg in mechanism.legs)
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


def _on_own_paths(robot: Robot, timing: Gait) -> Trajectory:
    try:
        return own_stance(robot, timing)
    except ValueError as error:
        raise SpecError(Problem("WG616", str(error), "take a shorter stride, or a smaller duty factor")) from None


def _chosen(mechanism: Mechanism, name: str, path: Path) -> SpecGait:
    gaits = {gait.name: gait for gait in mechanism.gaits}
    if not gaits:
        raise SpecError(
            Problem("WG610", f"{path} has no [gait]", "add one: kind, period, stride, lift, left, right and stance; see docs/gait.md")
        )
    if name and name not in gaits:
        raise SpecError(Problem("WG611", f'there is no gait "{shown(name)}"', did_you_mean(name, filter(None, gaits), "known gaits")))
    return gaits[name] if name else mechanism.gaits[0]


def _one_at_a_time(trajectory: Trajectory, label: str) -> None:
    try:
        balance.with_pauses(trajectory)
    except ValueError as error:
        raise SpecError(
            Problem("WG614", f"{label}: {error}", 'take kind = "crawl" or "wave" with a larger duty factor, or a level body')
        ) from None


def _body(gait: SpecGait, wanted: Wanted) -> str:
    return wanted.body or gait.body


def _options(mechanism: Mechanism, wanted: Wanted) -> Options:
    gait = next(gait for gait in mechanism.gaits if not wanted.gait or gait.name == wanted.gait)
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
        units=tuple(joint.unit for joint in joints),
    )


def _robot(path: Path, mechanism: Mechanism, progress: Progress) -> Robot:
    """Built with what a walk calls, kept for the next walk: gaits may change, the mechanism not."""
    text = repr(replace(mechanism, gaits=())) + "".join(repr(getattr(patch.surface, "heights", "")) for patch in _patches(mechanism))
    functions = functions_of(mechanism)
    key = hashlib.sha256("\n".join((__version__, *functions, text)).encode()).hexdigest()[:20]
    folder = cache() / key
    if not (folder / mechanism.name / "manifest.json").exists():
        build(path, folder, BuildOptions(targets=("c", "numpy"), functions=functions), progress)
    return load(folder / mechanism.name)


def functions_of(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the functions that a walk of the robot calls."""
    counts = [len(leg.joints) for leg in mechanism.legs]
    return _FUNCTIONS + (_WITHOUT_BRANCHES if max(counts) > 3 else ()) + (_DRIVEN if min(counts) < 3 else ())


def _patches(mechanism: Mechanism) -> tuple[Any, ...]:
    return mechanism.terrain.patches if mechanism.terrain else ()


def cache() -> Path:
    """Where robots that were built for walks are kept: XDG_CACHE_HOME/walkgen, ~/.cache/walkgen where it is not set."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "walkgen"


def _refuse_unreachable(robot: Robot, trajectory: Trajectory, ground: Ground, options: Options) -> None:
    """No stroke that leaves a leg's workspace on level ground; no start without ground."""
    stance, problems = np.array(trajectory.stance), []
    half = 0.5 * np.array(trajectory.gait.stroke)
    ends = stance + np.array([-1.0, 0.0, 1.0])[:, None, None] * half[:, None] * [1.0, 0.0, 0.0]
    if not (options.adapt and robot.chains):
        found = postures(robot, ends, held(robot, np.zeros(3)).q)
        away = missing(robot, ends, found.q)
        for foot, leg in enumerate(robot.legs):
            place = int(np.argmax(away[:, foot]))
            if not (away[place, foot] <= _REACHED or is_driven(robot.legs[leg])):
                where = ("the rear end of its stroke", "its stance", "the front end of its stroke")[place]
                message = f"{leg}: {where} is {1000 * away[place, foot]:.4g} mm outside of the leg's workspace"
                problems.append(Problem("WG616", message, "move its stance nearer, or take a shorter stride"))
    for leg, (x, y, _) in zip(robot.legs, stance, strict=True):
        if not np.isfinite(ground.height(np.array(x), np.array(y))):
            problems.append(Problem("WG617", f"{leg}: there is no ground at x = {x:g}, y = {y:g}, where it starts", TERRAINS))
    if problems:
        raise SpecError(*problems)


def written(result: Walked, output: Path) -> str:
    """The text of a walk's file, by its suffix.

    Raises:
        SpecError: another suffix than .html and .csv.
        ToolchainError: plotly, which draws the page, is not installed.
    """
    if output.suffix == ".csv":
        return table(result.walk, result.units)
    if output.suffix != ".html":
        raise SpecError(
            Problem("WG618", f"{shown(output.name)}: a walk is written as {' or '.join(SUFFIXES)}", "name a file with one of them")
        )
    draws = _module("page", "plotly")
    rows = np.unique(np.linspace(0, len(result.walk.times) - 1, min(_FRAMES, len(result.walk.times))).astype(int))
    text: str = draws.page(result.walk, drawing(result.robot, result.walk, result.ground, rows), result.units)
    return text


def pictured(result: Walked) -> bytes:
    """PNG of the robot in the middle of its walk.

    Raises:
        ToolchainError: matplotlib is not installed.
    """
    draws = _module("picture", "matplotlib")
    gait = result.walk.trajectory.gait
    row = int(np.searchsorted(result.walk.times, result.walk.times[-1] / 2 + gait.period / 10))
    data: bytes = draws.picture(result.walk, drawing(result.robot, result.walk, result.ground, np.array([row])), 0)
    return data


def _module(name: str, library: str) -> ModuleType:
    try:
        return import_module(f"walkgen.gait.{name}")
    except ModuleNotFoundError as error:
        missed = error.name or library
        raise ToolchainError(
            Problem("WG619", f"{missed} is not installed; it draws walks", "pip install 'walkgen[gait]', or write .csv")
        ) from error

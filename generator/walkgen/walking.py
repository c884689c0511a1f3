"""From a spec to a walk: the robot built with what a walk calls, its gait and ground chosen, the results written."""

import hashlib
import math
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from walkgen import __version__
from walkgen.errors import Problem, SpecError, ToolchainError
from walkgen.gait.drawing import Linked, drawing
from walkgen.gait.driven import own_stance
from walkgen.gait.footholds import Footholds
from walkgen.gait.ground import Described, Ground, Slope
from walkgen.gait.leaning import leaned
from walkgen.gait.pattern import Gait
from walkgen.gait.reach import shortfalls
from walkgen.gait.rolling_ground import hindrances
from walkgen.gait.simulate import Options, instants, planned, simulate
from walkgen.gait.standing import crowd
from walkgen.gait.steps import Steps
from walkgen.gait.table import table
from walkgen.gait.trajectory import Trajectory
from walkgen.gait.walk import Walk
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.pipeline import BuildOptions, Progress, build
from walkgen.runtime import load
from walkgen.runtime.robot import Robot
from walkgen.spec.problems import shown
from walkgen.spec.read import read
from walkgen.walking_ground import TERRAINS
from walkgen.walking_request import Wanted, request

_FUNCTIONS = (
    *("foot_positions", "foot_jacobians", "foot_bias_acceleration", "joint_frames", "frames", "inverse", "platform_poses", "adapt", "com"),
    *("height", "normal", "ground", "pair_positions", "demanded_wrench", "floating_inverse_dynamics"),
    *("contact_forces", "stability_margins", "contact_points", "sole_points"),
)
"""What a walk calls, of those that the robot has."""
_DRIVEN = ("foot_position", "foot_jacobian")
"""And where a leg has a path of its own."""
_SOLED = ("foot_spatial_jacobian",)
"""And where a leg has a sole."""
_ROLLING = ("foot_position", "link_angles", "joint_angles", "flat_motion", "hip_position", "toe_rolling")
"""And where a leg rolls on a curved sole."""
_WITHOUT_BRANCHES = ("inverse_near",)
"""And where a leg has more than three joints."""
SUFFIXES = (".html", ".csv")
_FRAMES = 150
_AS_THE_SPEC_SAYS = Wanted()


@dataclass(frozen=True)
class Walked:
    """A robot's walk over a ground; `units` are its joints', `linked` says which pairs the links of its linkages join."""

    robot: Robot
    walk: Walk
    ground: Ground
    units: tuple[str, ...]
    linked: Linked


def walked(path: Path, wanted: Wanted = _AS_THE_SPEC_SAYS, progress: Progress = lambda _: None) -> Walked:
    """Simulate a walk of the robot of a spec.

    Raises:
        SpecError: the spec is not a robot, has no such gait, or asks for a walk that no ground could help.
        ToolchainError: the compiler refused the generated code.
    """
    progress("read")
    mechanism = assemble(read(path), path.parent)
    timing, given, relief, options = request(mechanism, wanted, path)
    robot = _robot(path, mechanism, progress)
    trajectory = _on_own_paths(robot, timing) if timing else given
    assert trajectory is not None
    ground = relief or (Described(robot.terrain) if mechanism.terrain and robot.terrain else Slope())
    if options.body != "level" and not hasattr(robot, "com"):
        message = f"{path}: a {options.body} body moves the centre of mass, and the robot has no mass"
        raise SpecError(Problem("WG620", message, "give its platforms and links masses, or take --body level"))
    _refuse_soles(robot, trajectory, ground, options)
    if isinstance(trajectory, Trajectory):
        trajectory = leaned(robot, trajectory, ground, options)
    _refuse_unreachable(robot, trajectory, ground, options)
    progress("walk")
    return Walked(robot, simulate(robot, trajectory, ground, options), ground, options.units, linked_of(mechanism))


def linked_of(mechanism: Mechanism) -> Linked:
    """What the links of all linkages join, as `drawing` takes it."""
    return {leg.name: tuple(_links(leg)) for leg in mechanism.legs if leg.linkage}


def _links(leg: Limb) -> Iterator[tuple[int, ...]]:
    """Of each link of a linkage the numbers of its pairs, and where the foot is on it, of what follows them."""
    assert leg.linkage is not None
    pairs = leg.linkage.structure.pairs
    for body in range(len(leg.linkage.structure.names)):
        foot = (len(pairs),) if body == leg.linkage.foot[0] else ()
        yield (*(number for number, pair in enumerate(pairs) if body in pair.bodies), *foot)


def _on_own_paths(robot: Robot, timing: Gait) -> Trajectory:
    try:
        return own_stance(robot, timing)
    except ValueError as error:
        raise SpecError(Problem("WG616", str(error), "take a shorter stride, or a smaller duty factor")) from None


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
    soled = _SOLED if any(leg.contacts > 1 for leg in mechanism.legs) else ()
    rolling = _ROLLING if any(leg.curved_sole for leg in mechanism.legs) else ()
    return _FUNCTIONS + (_WITHOUT_BRANCHES if max(counts) > 3 else ()) + (_DRIVEN if min(counts) < 3 else ()) + soled + rolling


def _patches(mechanism: Mechanism) -> tuple[Any, ...]:
    return mechanism.terrain.patches if mechanism.terrain else ()


def cache() -> Path:
    """Where robots that were built for walks are kept: XDG_CACHE_HOME/walkgen, ~/.cache/walkgen where it is not set."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "walkgen"


def _refuse_unreachable(robot: Robot, trajectory: Trajectory | Steps, ground: Ground, options: Options) -> None:
    """No stroke that leaves a leg's workspace on level ground; no start without ground."""
    bends = options.adapt and robot.chains
    short = shortfalls(robot, trajectory, samples=0, limits=False) if isinstance(trajectory, Trajectory) and not bends else ()
    problems = [Problem("WG616", str(one), "move its stance nearer, or take a shorter stride") for one in short]
    c, s = math.cos(options.heading), math.sin(options.heading)
    for leg, (x, y, _) in zip(robot.legs, np.array(trajectory.stance) @ [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]], strict=True):
        if not np.isfinite(ground.height(np.array(x), np.array(y))):
            problems.append(Problem("WG617", f"{leg}: there is no ground at x = {x:g}, y = {y:g}, where it starts", TERRAINS))
    if problems:
        raise SpecError(*problems)


def _refuse_soles(robot: Robot, trajectory: Trajectory | Steps, ground: Ground, options: Options) -> None:
    """No ground on which soles cannot roll, no platform that their legs cannot follow, no more corners at once than have room."""
    plan, times = planned(trajectory, ground, options), instants(trajectory, options)
    if crowded := crowd(robot, plan.footholds.motion(times)[1], times):
        raise SpecError(Problem("WG624", crowded, "let fewer feet with soles stand at once, or give a curved sole no width: two corners"))
    if not isinstance(plan.footholds, Footholds):
        return
    found = tuple(hindrances(robot, plan.footholds, plan.body, ground, times))
    if found:
        raise SpecError(
            *(Problem("WG623", message, "take --terrain flat or slope:DEGREES, and legs along the platform") for message in found)
        )


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
    text: str = draws.page(result.walk, drawing(result.robot, result.walk, result.ground, rows, result.linked), result.units)
    return text


def pictured(result: Walked) -> bytes:
    """PNG of the robot soon after a leg was lifted in the middle of its walk.

    Raises:
        ToolchainError: matplotlib is not installed.
    """
    draws = _module("picture", "matplotlib")
    walk = result.walk
    lifted = (~walk.stance).any(axis=1) & (walk.times >= 0.5 * (walk.times[0] + walk.times[-1]))
    found = np.flatnonzero(lifted) if lifted.any() else np.array([len(walk.times) // 2])
    row = int(found[len(found) // 20])
    data: bytes = draws.picture(walk, drawing(result.robot, walk, result.ground, np.array([row]), result.linked), 0)
    return data


def _module(name: str, library: str) -> ModuleType:
    try:
        return import_module(f"walkgen.gait.{name}")
    except ModuleNotFoundError as error:
        missed = error.name or library
        raise ToolchainError(
            Problem("WG619", f"{missed} is not installed; it draws walks", "pip install 'walkgen[gait]', or write .csv")
        ) from error

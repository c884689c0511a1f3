"""The macros of a robot's header: sizes, branches, limits, masses, parameters, digest and version."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from walkgen import __version__
from walkgen.emit.artifact import RobotCode
from walkgen.emit.c_text import comment_text, words
from walkgen.model.classify import inverse_class
from walkgen.model.gait import Gait
from walkgen.model.mechanism import Body, Joint, Limb, Mechanism
from walkgen.model.walk import defaults, number
from walkgen.spec.checks_gait import gait_owner
from walkgen.spec.scalar import Scalar


@dataclass(frozen=True)
class Macro:
    """`#define name value`, with what it means."""

    name: str
    value: str
    meaning: str


def macros(code: RobotCode) -> tuple[Macro, ...]:
    """Every constant of the robot, in a fixed order; a name that two things share is left out rather than given one of two values."""
    found = tuple(_all(code))
    taken = Counter(macro.name for macro in found)
    return tuple(macro for macro in found if taken[macro.name] == 1)


def _all(code: RobotCode) -> Iterator[Macro]:
    robot = code.mechanism
    prefix = words(robot.name)
    yield Macro(f"{prefix}_VERSION", f'"{__version__}"', "of walkgen")
    yield Macro(f"{prefix}_DIGEST", f'"{code.digest}"', "sha256 of the spec")
    yield Macro(f"{prefix}_NQ", str(sum(len(limb.joints) for limb in robot.limbs)), "joints: chains, then legs")
    yield Macro(f"{prefix}_NP", str(len(robot.parameters)), "runtime parameters")
    yield Macro(f"{prefix}_PLATFORMS", str(len(robot.platforms)), "the first is the root")
    yield Macro(f"{prefix}_FEET", str(len(robot.legs)), "in the order of the legs")
    yield from _terrain(robot, prefix)
    yield from _gaits(robot, prefix)
    yield from _parameters(robot, prefix)
    for platform in robot.platforms:
        yield from _mass(robot, f"{prefix}_PLATFORM_{words(platform.name)}", platform.body)
    for limb in robot.limbs:
        yield from _limb(robot, f"{prefix}_{words(limb_owner(robot, limb))}", limb)


def _terrain(robot: Mechanism, prefix: str) -> Iterator[Macro]:
    patches = robot.terrain.patches if robot.terrain else ()
    if patches:
        yield Macro(f"{prefix}_TERRAIN_PATCHES", str(len(patches)), "the first that holds a point counts")
    for index, patch in enumerate(patches):
        yield Macro(f"{prefix}_TERRAIN_PATCH_{words(patch.name)}", str(index), "index of the patch")


def _gaits(robot: Mechanism, prefix: str) -> Iterator[Macro]:
    for gait in robot.gaits:
        stem = f"{prefix}_{words(gait_owner(gait.name))}"
        if isinstance(gait, Gait):
            yield Macro(f"{stem}_PERIOD", _literal(gait.period), "s")
            yield Macro(f"{stem}_STRIDE", _literal(gait.stride), "m in a period")
        else:
            yield Macro(f"{stem}_EVENTS", str(len(gait.events)), "legs lifted or placed")
        if gait.lift is not None:
            yield Macro(f"{stem}_LIFT", _literal(gait.lift), "m, of a foot in transfer")


def limb_owner(robot: Mechanism, limb: Limb) -> str:
    """Whose name a limb's functions carry: the leg's, or the chain's child platform's."""
    return limb.name if limb.child is None else robot.platforms[limb.child].name


def _parameters(robot: Mechanism, prefix: str) -> Iterator[Macro]:
    values = defaults(robot)
    for index, parameter in enumerate(robot.parameters):
        stem = f"{prefix}_PARAM_{words(parameter.name)}"
        yield Macro(stem, str(index), "index in param")
        yield Macro(f"{stem}_DEFAULT", _literal(values[parameter.name]), comment_text(parameter.unit))
        if parameter.bounds:
            yield Macro(f"{stem}_MIN", _real(robot, parameter.bounds[0]), comment_text(parameter.unit))
            yield Macro(f"{stem}_MAX", _real(robot, parameter.bounds[1]), comment_text(parameter.unit))


def _limb(robot: Mechanism, stem: str, limb: Limb) -> Iterator[Macro]:
    yield Macro(f"{stem}_JOINTS", str(len(limb.joints)), ", ".join(joint.name for joint in limb.joints))
    yield Macro(f"{stem}_OFFSET", str(robot.offset(limb)), "of its first joint in the robot's q")
    branches = inverse_class(robot, limb).branch_names if limb.child is None else ()
    if branches:
        yield Macro(f"{stem}_BRANCHES", str(len(branches)), "of the inverse")
    for index, branch in enumerate(branches):
        yield Macro(f"{stem}_BRANCH_{words(branch)}", str(index), "slot of the inverse")
    for joint in limb.joints:
        yield from _joint(robot, f"{stem}_{words(joint.name)}", joint)


def _joint(robot: Mechanism, stem: str, joint: Joint) -> Iterator[Macro]:
    unit, effort = joint.unit, "N m" if joint.kind == "revolute" else "N"
    name = f", {comment_text(joint.source_name)}" if joint.source_name else ""
    if joint.limits:
        yield Macro(f"{stem}_MIN", _real(robot, joint.limits[0]), unit + name)
        yield Macro(f"{stem}_MAX", _real(robot, joint.limits[1]), unit)
    if joint.max_speed is not None:
        yield Macro(f"{stem}_MAX_SPEED", _real(robot, joint.max_speed), f"{unit}/s")
    if joint.max_effort is not None:
        yield Macro(f"{stem}_MAX_EFFORT", _real(robot, joint.max_effort), effort)
    yield from _mass(robot, stem, joint.body)


def _mass(robot: Mechanism, stem: str, body: Body | None) -> Iterator[Macro]:
    if body is not None:
        yield Macro(f"{stem}_MASS", _real(robot, body.mass), "kg")


def _real(robot: Mechanism, scalar: Scalar) -> str:
    return _literal(number(scalar, robot))


def _literal(value: Any) -> str:
    text = repr(float(value))
    return f"({text})" if text.startswith("-") else text

"""Lays out an imported robot as a spec that a person would have written: one leg design a foot, comments where URDF is silent."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

from walkgen.spec.checks_values import unphysical
from walkgen.spec.urdf_pose import IDENTITY, Inertial, Pose
from walkgen.spec.urdf_read import MOVABLE, UrdfJoint

_MANY_TURNS = Decimal(12)
_DEGREES = Decimal("57.29577951308232087679815481")


@dataclass(frozen=True)
class Row:
    """A movable joint with the folded pose before it and the folded body after it."""

    key: str
    joint: UrdfJoint
    origin: Pose
    body: Inertial | None


@dataclass(frozen=True)
class Leg:
    """A leg from the base to its foot; `foot` is the foot frame in the frame after the last joint."""

    key: str
    rows: tuple[Row, ...]
    foot: Pose


def write(robot: str, source: str, base: tuple[str, Inertial | None], legs: tuple[Leg, ...]) -> str:
    """The spec's text.

    Args:
        robot: its name.
        source: the imported file's name, for the description.
        base: the first platform's name and body, in the base link's frame.
        legs: in the order of the feet.
    """
    blocks = [
        ["#:schema ./walkgen-spec-1.json", "walkgen = 1"],
        [
            "[robot]",
            f"name = {_text(robot)}",
            f"description = {_text(f'Imported from {source}')}",
            "gravity = [0.0, 0.0, -9.80665]  # a URDF gives none: standard gravity along the base's -z; change it if the base is turned",
        ],
    ]
    for leg in legs:
        blocks.append([f"[leg_designs.{leg.key}]", f"foot = {_pose(leg.foot)}"])
        blocks.extend(_joint(leg.key, row) for row in leg.rows)
    blocks.append(["[[platforms]]", f"name = {_text(base[0])}", *_body(base[1])])
    blocks.extend(_mounted(leg, base[0]) for leg in legs)
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _joint(design: str, row: Row) -> list[str]:
    joint = row.joint
    lines = [
        f"[[leg_designs.{design}.joints]]",
        f"name = {_text(row.key)}",
        f"type = {_text(MOVABLE[joint.kind])}",
        f"xyz = {_array(row.origin.xyz)}",
        f"rpy = {_array(row.origin.rpy)}",
        f"axis = {_array(joint.axis)}",
    ]
    if joint.limits:
        lines.append(_limits(joint.kind, joint.limits))
    if joint.max_speed:
        lines.append(f"max_speed = {_number(joint.max_speed)}")
    if joint.max_effort:
        lines.append(f"max_effort = {_number(joint.max_effort)}")
    if row.body:
        lines.append(f"link = {{ {', '.join(_body(row.body))} }}")
    return lines


def _limits(kind: str, limits: tuple[Decimal, Decimal]) -> str:
    """Of many turns in degrees: a spec takes so many radians for degrees with their unit forgotten."""
    if kind == "prismatic" or max(map(abs, limits)) < _MANY_TURNS:
        return f"limits = {_array(limits)}"
    return f"limits_deg = {_array(limit * _DEGREES for limit in limits)}"


def _mounted(leg: Leg, platform: str) -> list[str]:
    sources = ", ".join(_text(row.joint.name) for row in leg.rows)
    return [
        "[[legs]]",
        f"name = {_text(leg.key)}",
        f"design = {_text(leg.key)}",
        f"platform = {_text(platform)}",
        f"source_names = [{sources}]",
    ]


def _body(body: Inertial | None) -> list[str]:
    if body is None:
        return []
    lines = [f"mass = {_number(body.mass)}", f"com = {_array(body.origin.xyz)}", f"inertia = {_array(body.moments)}"]
    return [*lines, "allow_unphysical = true"] if oddity(body) else lines


def oddity(body: Inertial) -> str:
    """Why no real body has this inertia, by the rules that specs are checked with; empty if one has."""
    return unphysical(Fraction(body.mass), [Fraction(moment) for moment in body.moments])


def _pose(pose: Pose) -> str:
    parts = [f"xyz = {_array(pose.xyz)}"]
    if pose.rpy != IDENTITY.rpy:
        parts.append(f"rpy = {_array(pose.rpy)}")
    return f"{{ {', '.join(parts)} }}"


def _array(numbers: Iterable[Decimal]) -> str:
    return f"[{', '.join(_number(number) for number in numbers)}]"


def _number(number: Decimal) -> str:
    """The decimal as TOML writes it: the digits of the source, always with a point or an exponent."""
    text = str(number)
    return text if any(mark in text for mark in ".E") else f"{text}.0"


def _text(text: str) -> str:
    """A TOML basic string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")

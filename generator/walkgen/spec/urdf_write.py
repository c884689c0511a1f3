"""Lays out an imported robot as a spec that a person would have written: one design a limb, comments where URDF is silent."""

import json
import re
from collections.abc import Iterable
from decimal import Decimal
from fractions import Fraction

from walkgen.spec.checks_values import unphysical
from walkgen.spec.urdf_limbs import Limb, Limbs, Platform, Row
from walkgen.spec.urdf_pose import IDENTITY, Inertial, Pose
from walkgen.spec.urdf_read import MOVABLE

_TURN = Decimal("6.283185307179586")
_DEGREES = Decimal("57.29577951308232087679815481410517033240547246656432")
_GRAVITY = "gravity = [0.0, 0.0, -9.80665]  # a URDF gives none: standard gravity along the base's -z; change it if the base is turned"


def key(name: str) -> str:
    """The spec's name for a name of the URDF: lower case, every other character an underscore."""
    return re.sub(r"[^a-z0-9_]", "_", name.lower())


def write(robot: str, source: str, limbs: Limbs) -> str:
    """The spec's text.

    Args:
        robot: its name.
        source: the imported file's name, for the description.
        limbs: platforms, chains and legs, each under the name of the link that it ends in.
    """
    blocks = [
        ["#:schema ./walkgen-spec-1.json", "walkgen = 1"],
        ["[robot]", f"name = {_text(robot)}", f"description = {_text(f'Imported from {source}')}", _GRAVITY],
    ]
    for chain in limbs.chains:
        blocks.extend(_design(f"chain_designs.{key(chain.end)}", chain, []))
    for leg in limbs.legs:
        blocks.extend(_design(f"leg_designs.{key(leg.end)}", leg, [f"foot = {_pose(leg.tip)}"]))
    blocks.extend(_platform(platform) for platform in limbs.platforms)
    blocks.extend(_mounted(leg) for leg in limbs.legs)
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _design(table: str, limb: Limb, lines: list[str]) -> list[list[str]]:
    return [[f"[{table}]", *lines], *(_joint(table, row) for row in limb.rows)]


def _joint(table: str, row: Row) -> list[str]:
    joint = row.joint
    lines = [
        f"[[{table}.joints]]",
        f"name = {_text(key(joint.name))}",
        f"type = {_text(MOVABLE[joint.kind])}",
        f"xyz = {_array(row.origin.xyz)}",
        _angles("rpy", row.origin.rpy, _TURN),
        f"axis = {_array(joint.axis)}",
    ]
    if joint.limits:
        turning = joint.kind != "prismatic"
        lines.append(_angles("limits", joint.limits, 2 * _TURN) if turning else f"limits = {_array(joint.limits)}")
    if joint.max_speed:
        lines.append(f"max_speed = {_number(joint.max_speed)}")
    if joint.max_effort:
        lines.append(f"max_effort = {_number(joint.max_effort)}")
    if row.body:
        lines.append(f"link = {{ {', '.join(_body(row.body))} }}")
    return lines


def _angles(name: str, angles: Iterable[Decimal], most: Decimal) -> str:
    """In degrees where they are large: a spec takes so many radians for degrees with their unit forgotten."""
    listed = tuple(angles)
    if max(map(abs, listed)) <= most:
        return f"{name} = {_array(listed)}"
    return f"{name}_deg = {_array(angle * _DEGREES for angle in listed)}"


def _platform(platform: Platform) -> list[str]:
    lines = ["[[platforms]]", f"name = {_text(key(platform.link))}"]
    if platform.chain is None:
        return [*lines, *_body(platform.body)]
    joined = [f"parent = {_text(key(platform.chain.start))}", f"chain = {_text(key(platform.link))}", f"end = {_pose(platform.chain.tip)}"]
    return [*lines, *joined, *_body(platform.body), _sources(platform.chain)]


def _mounted(leg: Limb) -> list[str]:
    name = _text(key(leg.end))
    return ["[[legs]]", f"name = {name}", f"design = {name}", f"platform = {_text(key(leg.start))}", _sources(leg)]


def _sources(limb: Limb) -> str:
    return f"source_names = [{', '.join(_text(row.joint.name) for row in limb.rows)}]"


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
        parts.append(_angles("rpy", pose.rpy, _TURN))
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

"""Which closed-form inverse a leg admits, and why: read off its joint axes, before any algebra."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from walkgen.model.carried import on_a_surface
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, along, defaults, joint_axis, limb_frames
from walkgen.spec.branches import (
    BRANCHED_JOINTS,
    CARRIED_BRANCHES,
    CURVE_BRANCHES,
    branch_count,
    carries_curve,
    follows_curve,
    linkage_branches,
    linkage_choices,
    linkage_hindrance,
)
from walkgen.spec.scalar import ZERO, evaluate


@dataclass(frozen=True)
class InverseClass:
    """A leg's class: `name` is empty where there is no closed form; `reason` is a sentence for people."""

    name: str
    branch_names: tuple[str, ...]
    reason: str


YAW_PITCH_PITCH = "yaw-pitch-pitch"
LINKAGE = "linkage"
CURVE = "coupler curve"
CARRIED = "carried coupler curve"
FLAT_SOLE = "flat sole"
_KNEES = ("knee_plus", "knee_minus")
_YAWED_KNEES = ("ahead_knee_plus", "ahead_knee_minus", "behind_knee_plus", "behind_knee_minus")
_YAW_BRANCHES = ("rho_plus_knee_plus", "rho_plus_knee_minus", "rho_minus_knee_plus", "rho_minus_knee_minus")
_NEGLIGIBLE = CONTEXT.mpf(10) ** -40
_STRETCHES = (Fraction(1), Fraction(13, 11), Fraction(7, 9))
_METHODS = {
    1: "at most one solution, from the projection on what the joints reach",
    2: "the roots of a quadratic, then Newton's polish",
    4: "the roots of a quartic by elimination (Pieper 1968), then Newton's polish",
}


def inverse_class(mechanism: Mechanism, leg: Limb) -> InverseClass:
    """The class of the leg's position inverse.

    Yaw-pitch-pitch (the chapter's Fig. 7 leg with general offsets): three revolute joints, axis 1 perpendicular to
    axis 2, axis 2 parallel to axis 3, exactly and for all values of the runtime parameters (tested at three). Every other
    leg of one to three joints is named after its joints, `general RRP`; longer ones have no class.
    """
    if leg.linkage is not None:
        return linkage_class(mechanism, leg, leg.linkage)
    if leg.curved_sole is not None:
        return _rolling_class(mechanism, leg)
    kinds = "".join(joint.kind[0].upper() for joint in leg.joints)
    if len(kinds) > BRANCHED_JOINTS:
        return InverseClass("", (), f"{len(kinds)} joints leave the foot position redundant: solved by iteration from a seed")
    hindrance = _not_yaw_pitch_pitch(mechanism, leg, kinds)
    if not hindrance:
        reason = "axis 1 is perpendicular to axis 2 and axis 2 parallel to axis 3"
        return InverseClass(YAW_PITCH_PITCH, leg.branches or _YAW_BRANCHES, reason)
    slots = branch_count(kinds)
    names = leg.branches or tuple(f"root_{number}" for number in range(1, slots + 1))
    return InverseClass(f"general {kinds}", names, f"{hindrance}; {_METHODS[slots]}")


def _rolling_class(mechanism: Mechanism, leg: Limb) -> InverseClass:
    """Hip, knee and ankle by themselves, or after a joint that turns their plane about the vertical."""
    reason = "the foot is put flat, so that hip and knee follow from the cosine rule"
    if len(leg.joints) == BRANCHED_JOINTS:
        return InverseClass(FLAT_SOLE, leg.branches or _KNEES, reason)
    if len(leg.joints) == BRANCHED_JOINTS + 1 and _yaws(mechanism, leg):
        return InverseClass(FLAT_SOLE, leg.branches or _YAWED_KNEES, f"{reason}, and {leg.joints[0].name} turns their plane to the target")
    reason = "the foot rolls on a curved sole: hip, knee and ankle follow from flat_position, stance_position, *_motion"
    return InverseClass("", (), reason)


def _yaws(mechanism: Mechanism, leg: Limb) -> bool:
    """Whether the first joint turns about the vertical, over ground that is level."""
    sole, first = leg.curved_sole, leg.joints[0]
    if sole is None or first.kind != "revolute" or sole.slope != ZERO:
        return False
    for values in _samples(mechanism):
        up = [-evaluate(entry, CONTEXT, values) for entry in mechanism.gravity]
        if not any(up):
            up = [0, 0, 1]
        if _norm(_cross(joint_axis(mechanism, leg, 0, values), up)) > _NEGLIGIBLE * (1 + _norm(up)):
            return False
    return True


def linkage_class(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> InverseClass:
    """Of a leg with a linkage: at most one joint turns its plane or the foot out of it, two drives place the foot in it, dyad after dyad.

    One drive leads the foot along a curve; then the joint may slide as well, or two joints carry it.
    """
    kinds, after = ("".join(joint.kind[0].upper() for joint in joints) for joints in (leg.serial, leg.distal))
    if not after and follows_curve(linkage.structure, len(kinds)):
        return _curve_class(leg)
    if carries_curve(linkage.structure, len(kinds) + len(after)):
        return _carried_class(mechanism, leg)
    hindrance = linkage_hindrance(linkage.structure, linkage.foot[0], kinds, after) or _in_plane(mechanism, leg)
    if hindrance:
        return InverseClass("", (), hindrance)
    turning = [joint.name for joint in (*leg.serial, *leg.distal) if joint.kind == "revolute"]
    choices = linkage_choices(linkage.structure, linkage.foot[0], turning)
    back, held = "dyads placed one after another from the foot held in the plane", linkage.inverse.triads
    followed = f", the triad {held[0].name} followed from its assemblies at one place of the foot" if held else ""
    put_in = ", then put in, since they hold a triad" if linkage.forward.triads else ""
    return InverseClass(LINKAGE, leg.branches or linkage_branches(choices), f"{back}{followed}{put_in}")


def _in_plane(mechanism: Mechanism, leg: Limb) -> str:
    """What keeps a joint after the linkage from saying how far the foot is from the plane; empty where nothing does, or none follows."""
    for joint in leg.distal:
        if min(_lift(leg, joint, values) for values in _samples(mechanism)) < _NEGLIGIBLE:
            return f"{joint.name} moves the foot along the linkage's plane alone, as the drives do: one of them is free"
    return ""


def _lift(leg: Limb, joint: Joint, values: dict[str, Any]) -> Any:
    """How far the joint takes the foot out of the plane, per metre where it slides."""
    before, lever = along(CONTEXT.eye(4), joint.before, values), along(CONTEXT.eye(4), joint.after + leg.foot, values)
    if joint.kind == "prismatic":
        return abs(before[2, 2])
    return CONTEXT.hypot(before[2, 0], before[2, 1]) * CONTEXT.hypot(lever[0, 3], lever[1, 3])


def _unbounded(leg: Limb) -> str:
    """What keeps a curve from being looked at from end to end; empty where nothing does."""
    drive = leg.drives[0]
    if drive.kind == "prismatic" and drive.limits is None:
        return f"between which values of {drive.name} to look for the foot's place its limits say: it has none"
    return ""


def _curve_class(leg: Limb) -> InverseClass:
    if hindrance := _unbounded(leg):
        return InverseClass("", (), hindrance)
    reason = "one drive leads the foot along a curve, whose least distances from the target are found by a bounded search"
    return InverseClass(CURVE, leg.branches or CURVE_BRANCHES, reason)


def _carried_class(mechanism: Mechanism, leg: Limb) -> InverseClass:
    first, second = (joint.name for joint in (*leg.serial, *leg.distal))
    if hindrance := _unbounded(leg):
        return InverseClass("", (), hindrance)
    if all(on_a_surface(leg, values) for values in _samples(mechanism)):
        return InverseClass("", (), f"{first}, {second} and {leg.drives[0].name} leave the foot on a surface")
    reason = (
        f"with the drive held {first} and {second} meet two of three equations in closed form; where the third is met is found by a "
        "bounded search over the drive"
    )
    return InverseClass(CARRIED, leg.branches or CARRIED_BRANCHES, reason)


def _not_yaw_pitch_pitch(mechanism: Mechanism, leg: Limb, kinds: str) -> str:
    """What keeps the leg out of the class; empty where nothing does."""
    if kinds != "RRR":
        return f"the joints are {kinds}, not three revolute ones"
    axes = [[joint_axis(mechanism, leg, index, values) for index in range(3)] for values in _samples(mechanism)]
    tilt = max(abs(_dot(first, second)) for first, second, _ in axes)
    skew = max(_norm(_cross(second, third)) for _, second, third in axes)
    if tilt > _NEGLIGIBLE:
        return f"axes 1 and 2 are {_angle(CONTEXT.acos(min(tilt, 1)))} apart, not perpendicular"
    if skew > _NEGLIGIBLE:
        return f"axes 2 and 3 are {_angle(CONTEXT.asin(min(skew, 1)))} apart, not parallel"
    if min(_lever(mechanism, leg, values) for values in _samples(mechanism)) < _NEGLIGIBLE:
        return "axis 3 lies on axis 2, or the foot on axis 3: a joint does not move the foot on its own"
    return ""


def _lever(mechanism: Mechanism, leg: Limb, values: dict[str, Any]) -> Any:
    """The shorter of the distances axis 2 - axis 3 and axis 3 - foot."""
    frames = limb_frames(mechanism, leg, [0, 0, 0], values)
    points = [along(frames[index], leg.joints[index].before, values)[:3, 3] for index in (1, 2)] + [frames[-1][:3, 3]]
    axis = joint_axis(mechanism, leg, 1, values)
    return min(_norm(_cross(axis, end - start)) for start, end in pairwise(points))


def _samples(mechanism: Mechanism) -> Iterator[dict[str, Any]]:
    values = defaults(mechanism)
    for stretch in _STRETCHES[: len(_STRETCHES) if values else 1]:
        yield {name: value * stretch.numerator / stretch.denominator for name, value in values.items()}


def _angle(radians: Any) -> str:
    return f"{CONTEXT.nstr(radians, 6)} rad"


def _dot(a: Any, b: Any) -> Any:
    return sum(a[i] * b[i] for i in range(3))


def _cross(a: Any, b: Any) -> Any:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def _norm(a: Any) -> Any:
    return CONTEXT.sqrt(sum(value * value for value in a))

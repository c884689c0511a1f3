"""Which closed-form inverse a leg admits, and why: read off its joint axes, before any algebra."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT, along, defaults, joint_axis, limb_frames


@dataclass(frozen=True)
class InverseClass:
    """A leg's class: `name` is empty where no closed form is known; `reason` is a sentence for people."""

    name: str
    branch_names: tuple[str, ...]
    reason: str


YAW_PITCH_PITCH = "yaw-pitch-pitch"
_YAW_BRANCHES = ("rho_plus_knee_plus", "rho_plus_knee_minus", "rho_minus_knee_plus", "rho_minus_knee_minus")
_NEGLIGIBLE = CONTEXT.mpf(10) ** -40
_STRETCHES = (Fraction(1), Fraction(13, 11), Fraction(7, 9))


def inverse_class(mechanism: Mechanism, leg: Limb) -> InverseClass:
    """The class of the leg's position inverse.

    Yaw-pitch-pitch (the chapter's Fig. 7 leg with general offsets): three revolute joints, axis 1 perpendicular to
    axis 2, axis 2 parallel to axis 3, exactly and for all values of the runtime parameters (tested at three).
    """
    kinds = "".join(joint.kind[0].upper() for joint in leg.joints)
    if kinds != "RRR":
        return InverseClass("", (), f"no closed form for the joint sequence {kinds}: yaw-pitch-pitch needs three revolute joints")
    axes = [[joint_axis(mechanism, leg, index, values) for index in range(3)] for values in _samples(mechanism)]
    tilt = max(abs(_dot(first, second)) for first, second, _ in axes)
    skew = max(_norm(_cross(second, third)) for _, second, third in axes)
    if tilt > _NEGLIGIBLE:
        return InverseClass("", (), f"axes 1 and 2 are {_angle(CONTEXT.acos(min(tilt, 1)))} apart, not perpendicular")
    if skew > _NEGLIGIBLE:
        return InverseClass("", (), f"axes 2 and 3 are {_angle(CONTEXT.asin(min(skew, 1)))} apart, not parallel")
    if min(_lever(mechanism, leg, values) for values in _samples(mechanism)) < _NEGLIGIBLE:
        return InverseClass("", (), "axis 3 lies on axis 2, or the foot on axis 3: a joint does not move the foot on its own")
    return InverseClass(YAW_PITCH_PITCH, _YAW_BRANCHES, "axis 1 is perpendicular to axis 2 and axis 2 parallel to axis 3")


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

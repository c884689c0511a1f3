"""Writes a Mechanism as URDF, so that simulators and other libraries can read the same robot; a URDF joint's value is the user's q."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import PurePosixPath
from typing import Any

from walkgen.emit.artifact import Artifact
from walkgen.errors import Problem, UnsupportedMechanism
from walkgen.model.mechanism import Body, Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, Matrix, along, defaults, moved
from walkgen.spec.scalar import ZERO, Scalar, evaluate

_NEGLIGIBLE = CONTEXT.mpf(10) ** -40


def urdf(mechanism: Mechanism) -> Artifact:
    """The robot as one URDF file: a link for each body, platform and foot, a fixed joint before each platform and foot.

    Runtime parameters are at their defaults. Numbers are the nearest doubles to a 50-digit walk.

    Raises:
        UnsupportedMechanism: a leg is a closed linkage, and URDF knows trees alone.
    """
    closed = [leg.name for leg in mechanism.legs if leg.linkage is not None]
    if closed:
        message = f"legs {', '.join(closed)} are closed linkages, and URDF describes trees of joints"
        raise UnsupportedMechanism(Problem("WG188", message, "export a robot of serial legs"))
    return Artifact(PurePosixPath(f"{mechanism.name}.urdf"), _Writer(mechanism).text())


@dataclass(frozen=True)
class _Names:
    """Names of the links, by what they stand for; a platform's and a foot's are their own wherever two do not meet."""

    platforms: tuple[str, ...]
    feet: Mapping[str, str]
    bodies: Mapping[tuple[int, int], str]
    fixed: Mapping[str, str]

    @classmethod
    def of(cls, mechanism: Mechanism) -> "_Names":
        links: set[str] = set()
        platforms = tuple(_free(platform.name, links) for platform in mechanism.platforms)
        feet = {leg.name: _free(leg.name, links) for leg in mechanism.legs}
        bodies = {
            (place, index): _free(f"{limb.name}_{joint.name}_link", links)
            for place, limb in enumerate(mechanism.limbs)
            for index, joint in enumerate(limb.joints)
        }
        joints = {_joint_name(limb, joint) for limb in mechanism.limbs for joint in limb.joints}
        return cls(platforms, feet, bodies, {link: _free(f"{link}_fixed", joints) for link in (*platforms, *feet.values())})


def _free(name: str, taken: set[str]) -> str:
    """The name, numbered if it is taken; from now on it is."""
    number = 1
    free = name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    taken.add(free)
    return free


def _joint_name(limb: Limb, joint: Joint) -> str:
    return joint.source_name or f"{limb.name}_{joint.name}"


class _Writer:
    """One robot's text; `values` are the runtime parameters' defaults."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.values = defaults(mechanism)
        self.names = _Names.of(mechanism)

    def text(self) -> str:
        lines = ['<?xml version="1.0" encoding="utf-8"?>', *self.head(), f'<robot name="{self.mechanism.name}">']
        lines += self.link(self.names.platforms[0], self.mechanism.platforms[0].body, CONTEXT.eye(4))
        for place, limb in enumerate(self.mechanism.limbs):
            lines += self.limb(place, limb)
        return "\n".join([*lines, "</robot>"]) + "\n"

    def head(self) -> Iterator[str]:
        """What a URDF has no element for, as a comment."""
        gravity = ", ".join(self.number(entry) for entry in self.mechanism.gravity)
        lines = [self.mechanism.description] if self.mechanism.description else []
        lines += [f"Gravity in the first platform's frame: [{gravity}] m/s^2.", f"Feet: {', '.join(self.names.feet.values())}."]
        if self.mechanism.parameters:
            entries = (f"{entry.name} = {_text(self.values[entry.name])} {entry.unit}" for entry in self.mechanism.parameters)
            lines.append(f"Runtime parameters stand at their defaults: {', '.join(entries)}.")
        lines.append("An effort or velocity of 0 is not given; so are the limits of a prismatic joint without lower and upper.")
        for line in lines:
            yield f"<!-- {line.replace('--', '- -').replace('--', '- -')} -->"

    def limb(self, place: int, limb: Limb) -> Iterator[str]:
        """The limb's links from its platform on; `pose` leads from the last link's frame to the next joint."""
        parent, pose = self.names.platforms[limb.platform], along(CONTEXT.eye(4), limb.mount, self.values)
        for index, joint in enumerate(limb.joints):
            link = self.names.bodies[place, index]
            before, frame, after = self.split(joint, pose)
            yield from self.joint(_joint_name(limb, joint), joint, (parent, link), before * frame, frame[2, :3].T * joint.sign)
            yield from self.link(link, joint.body, after)
            parent, pose = link, after
        end = self.names.feet[limb.name] if limb.child is None else self.names.platforms[limb.child]
        yield f'  <joint name="{escape(self.names.fixed[end])}" type="fixed">'
        yield from _between(parent, end, along(pose, limb.tip, self.values))
        yield "  </joint>"
        yield from self.link(end, None if limb.child is None else self.mechanism.platforms[limb.child].body, CONTEXT.eye(4))

    def split(self, joint: Joint, pose: Matrix) -> tuple[Matrix, Matrix, Matrix]:
        """The joint at q = 0 as three frames: up to the axis z, from there to the link's frame, from there to the joint's frame.

        The link's frame is the joint's own wherever a URDF can have it there: on the axis, or anywhere if nothing turns.
        """
        kind = "rotate" if joint.kind == "revolute" else "translate"
        before = moved(along(pose, joint.before, self.values), kind, 2, evaluate(joint.zero, CONTEXT, self.values))
        after = along(CONTEXT.eye(4), joint.after, self.values)
        if joint.kind == "prismatic" or max(abs(after[0, 3]), abs(after[1, 3])) < _NEGLIGIBLE:
            return before, after, CONTEXT.eye(4)
        return before, CONTEXT.eye(4), after

    def joint(self, name: str, joint: Joint, links: tuple[str, str], origin: Matrix, axis: Matrix) -> Iterator[str]:
        kind = "continuous" if joint.kind == "revolute" and joint.limits is None else joint.kind
        yield f'  <joint name="{escape(name)}" type="{kind}">'
        yield from _between(*links, origin)
        yield f'    <axis xyz="{_texts(axis)}"/>'
        if kind != "continuous" or joint.max_speed or joint.max_effort:
            low, high = joint.limits or (None, None)
            ends = f'lower="{self.number(low)}" upper="{self.number(high)}" ' if low is not None and high is not None else ""
            yield f'    <limit {ends}effort="{self.number(joint.max_effort)}" velocity="{self.number(joint.max_speed)}"/>'
        yield "  </joint>"

    def link(self, name: str, body: Body | None, pose: Matrix) -> Iterator[str]:
        """A link and its body, whose own frame has this pose in the link's."""
        moments = body.inertia if body else ()
        if body is None or all(evaluate(entry, CONTEXT, self.values) == 0 for entry in (body.mass, *moments)):
            yield f'  <link name="{escape(name)}"/>'
            return
        centre = CONTEXT.eye(4)
        centre[:3, 3] = CONTEXT.matrix([evaluate(entry, CONTEXT, self.values) for entry in body.com])
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        yield f'  <link name="{escape(name)}">'
        yield "    <inertial>"
        yield f"      {_origin(pose * centre)}"
        yield f'      <mass value="{self.number(body.mass)}"/>'
        entries = (f'{key}="{self.number(moment)}"' for key, moment in zip(keys, moments, strict=True))
        yield f"      <inertia {' '.join(entries)}/>"
        yield "    </inertial>"
        yield "  </link>"

    def number(self, scalar: Scalar | None) -> str:
        return _text(evaluate(scalar or ZERO, CONTEXT, self.values))


def _between(parent: str, child: str, origin: Matrix) -> Iterator[str]:
    yield f'    <parent link="{escape(parent)}"/>'
    yield f'    <child link="{escape(child)}"/>'
    yield f"    {_origin(origin)}"


def _origin(pose: Matrix) -> str:
    return f'<origin xyz="{_texts(pose[:3, 3])}" rpy="{_texts(_angles(pose))}"/>'


def _angles(pose: Matrix) -> tuple[Any, Any, Any]:
    """Roll, pitch, yaw: the rotation is Rz(yaw) Ry(pitch) Rx(roll); at pitch = +-pi/2 the roll is 0."""
    level = CONTEXT.hypot(pose[0, 0], pose[1, 0])
    pitch = CONTEXT.atan2(-pose[2, 0], level)
    if level < _NEGLIGIBLE:
        return CONTEXT.zero, pitch, _angle(-pose[0, 1], pose[1, 1])
    return _angle(pose[2, 1], pose[2, 2]), pitch, _angle(pose[1, 0], pose[0, 0])


def _angle(sine: Any, cosine: Any) -> Any:
    return CONTEXT.atan2(_chopped(sine), _chopped(cosine))


def _chopped(number: Any) -> Any:
    return CONTEXT.zero if abs(number) < _NEGLIGIBLE else number


def _texts(numbers: Any) -> str:
    return " ".join(_text(number) for number in numbers)


def _text(number: Any) -> str:
    """The nearest double, in the fewest digits that name it."""
    return repr(float(_chopped(number)))

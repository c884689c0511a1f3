"""The moving bodies as a tree of links in frames made for few operations: groups of parallel axes, quarter turns folded away.

Every link has a frame of its own: z along its joint, the orientation its group's turned about z by the summed angles. Groups
are fixed in the link that bears them. What hangs on a link (platforms at a chain's end) is lumped into it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import sympy

from walkgen.model.mechanism import Joint
from walkgen.symbolic.frames import Frame, Parameters, expression, frame_of
from walkgen.symbolic.inertia import Inertia, inertia_of, placed
from walkgen.symbolic.path import yaw_of
from walkgen.symbolic.tape import IDENTITY, Columns, Tape, Vec, constant_vector, cross, dot, plus, scaled

BASE = -1
"""Parent of the links that hang on the root platform."""


@dataclass(frozen=True)
class Link:
    """A joint and all that it moves up to the next joints.

    `turn` holds the axes of the link's group in the parent's frame; None continues the parent's group. `origin` lies in the
    parent's frame at q = 0 for a joint that slides. `sense` is the motion about or along z for growing q, `offset` the constant
    part of the angle about z; `frame` is the joint's own frame, that of its link's data, in the link's.
    """

    name: str
    joint: Joint
    coordinate: int
    parent: int
    sense: int
    turn: Columns | None
    origin: Vec
    offset: sympy.Expr
    inertia: Inertia
    frame: Frame

    @property
    def revolute(self) -> bool:
        """Whether the joint turns."""
        return self.joint.kind == "revolute"

    @property
    def axis(self) -> Vec:
        """The joint's direction z in the parent's frame."""
        return (self.turn or IDENTITY)[2]


@dataclass(frozen=True)
class Foot:
    """A foot point in the frame of the link that bears it, or of the base."""

    link: int
    origin: Vec


@dataclass(frozen=True)
class Tree:
    """Links, parents before children; `base` is what does not move relative to the root platform, in its frame."""

    links: tuple[Link, ...]
    base: Inertia
    feet: tuple[Foot, ...]

    def children(self, index: int) -> Iterator[int]:
        """The links that hang on a link (or on the base)."""
        return (child for child, link in enumerate(self.links) if link.parent == index)

    def bears(self, index: int) -> bool:
        """Whether the link has a group of other axes on it."""
        return any(self.links[child].turn is not None for child in self.children(index))

    def route(self, index: int) -> tuple[int, ...]:
        """The links from the base to this one."""
        return () if index == BASE else (*self.route(self.links[index].parent), index)


@dataclass(frozen=True)
class Attachment:
    """Where things are attached: a link (or the base) and a frame in the link's frame."""

    link: int
    frame: Frame


@dataclass
class Growth:
    """A tree being grown; `flips` say which links' own z runs against their group's."""

    parameters: Parameters
    tape: Tape
    links: list[Link] = field(default_factory=list)
    flips: list[int] = field(default_factory=list)
    base: Inertia = field(default_factory=Inertia)
    feet: list[Foot] = field(default_factory=list)

    def joint(self, joint: Joint, place: Attachment, coordinate: int, name: str) -> Attachment:
        """Add one link."""
        before = self.named(place.frame * frame_of(joint.before, self.parameters), f"{name}_before")
        turn, flip, offset = self.orientation(place.link, before.rotation)
        zero = expression(joint.zero, self.parameters)
        origin = before.origin
        if joint.kind == "prismatic":
            origin = constant_vector(plus(origin, scaled(flip * zero, (turn or IDENTITY)[2])))
        else:
            offset = offset + flip * zero
        origin = self.tape.vector(f"{name}_origin", origin)
        after = self.named(_flipped(flip) * frame_of(joint.after, self.parameters), f"{name}_after")
        self.links.append(Link(name, joint, coordinate, place.link, flip * joint.sign, turn, origin, offset, Inertia(), after))
        self.flips.append(flip)
        here = Attachment(len(self.links) - 1, after)
        if joint.body:
            self.carry(here, inertia_of(joint.body, self.parameters, self.tape, f"{name}_link"), f"{name}_link")
        return here

    def orientation(self, parent: int, rotation: Columns) -> tuple[Columns | None, int, sympy.Expr]:
        """A group's axes in the parent's (None: its own group goes on), whether z is against it, and the angle about z."""
        yaw = yaw_of(rotation)
        if yaw is not None:
            flip = int(rotation[2][2])
            if parent == BASE:
                return IDENTITY, flip, yaw
            return None, flip, self.links[parent].offset + yaw
        axes = _squared(rotation[2])
        if axes is None:
            return rotation, 1, sympy.S.Zero
        quarter = constant_vector((dot(axes[0], rotation[0]), dot(axes[1], rotation[0]), sympy.S.Zero))
        turned = yaw_of((quarter, (-quarter[1], quarter[0], sympy.S.Zero), IDENTITY[2]))
        return (rotation, 1, sympy.S.Zero) if turned is None else (axes, 1, turned)

    def carry(self, place: Attachment, inertia: Inertia, name: str) -> None:
        """Lump a body, given in the frame of `place`, into the link or the base."""
        moved = placed(inertia, place.frame, self.tape, name)
        if place.link == BASE:
            self.base = self.base + moved
        else:
            link = self.links[place.link]
            self.links[place.link] = replace(link, inertia=(link.inertia + moved).named(self.tape, f"{name}_sum"))

    def named(self, frame: Frame, name: str) -> Frame:
        """Keep expressions in runtime parameters small."""
        x, y, z = (self.tape.vector(f"{name}_{axis}", column) for axis, column in zip("xyz", frame.rotation, strict=True))
        return Frame((x, y, z), self.tape.vector(f"{name}_origin", frame.origin))

    def tree(self) -> Tree:
        """What has grown."""
        return Tree(tuple(self.links), self.base, tuple(self.feet))


def _flipped(flip: int) -> Frame:
    """Half a turn about x where z runs against the group's."""
    x, y, z = IDENTITY
    return Frame() if flip == 1 else Frame((x, scaled(sympy.S.NegativeOne, y), scaled(sympy.S.NegativeOne, z)))


def _squared(axis: Vec) -> Columns | None:
    """Axes with this z that only rename the parent's; None if z is none of the parent's axes."""
    if not all(component in (-1, 0, 1) for component in axis):
        return None
    along = next(index for index in range(3) if axis[index] != 0)
    first = IDENTITY[0] if along else IDENTITY[1]
    x, y, z = cross(axis, first)
    return (first, (x, y, z), axis)

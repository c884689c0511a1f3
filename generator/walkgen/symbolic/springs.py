"""A leg's springs: how long they are, and what they do to the coordinates of the leg's links.

A spring between frames of joints in series sees no joint but those between them, one between links of a linkage only the plane, one that
presses a cam's follower the cam's joint and the follower.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import sympy

from walkgen.model.cam_potential import stretched
from walkgen.model.mechanism import Cam, Joint, Limb, Transform
from walkgen.model.springs import Coil, End, Spring
from walkgen.model.transform import X, Y, Z, translation
from walkgen.spec.scalar import ZERO, Vector, sub
from walkgen.symbolic.driven import planar_joints
from walkgen.symbolic.frames import Parameters, expression, frame_of
from walkgen.symbolic.path import Kinematics, path_of
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import difference, named, outer
from walkgen.symbolic.tape import Tape, Vec, dot, minus

Exprs = Sequence[sympy.Expr]
_FLAT = 3
"""Coordinates of a link in its plane: where it is along X and along Y, and its angle."""
END = -1
"""Among the links of a linkage its end, where joints after it hang; their coordinates follow its own."""
_Way = tuple[tuple[Limb, ...], list[int]]
"""The joints from one frame to a point, with the numbers of their coordinates."""


@dataclass(frozen=True)
class Place:
    """A link of a linkage among the tree's coordinates: where its three begin, and the point of it that they follow."""

    start: int
    point: Vector


@dataclass(frozen=True)
class Stretch:
    """A spring's length, and half the slopes of its square by the tree's coordinates."""

    length: sympy.Expr
    slopes: Mapping[int, sympy.Expr]


@dataclass(frozen=True)
class Springs:
    """Of one leg, in `values` of the tree's coordinates; `start` is the first one of its joints in series, `places` are its linkage's,
    `ways` those of the rollers of its cams.
    """

    leg: Limb
    parameters: Parameters
    values: Exprs
    start: int
    tape: Tape
    placing: Placing | None = None
    places: Mapping[int, Place] = field(default_factory=dict)
    ways: tuple[int, ...] = ()

    def on(self, tape: Tape) -> "Springs":
        """The same, written on a tape that began as this one's."""
        return replace(self, tape=tape)

    @property
    def coils(self) -> tuple[Coil, ...]:
        """The leg's springs, then those of its cams."""
        return (*self.leg.springs, *(cam.spring for cam in self.leg.cams))

    @cached_property
    def stretches(self) -> tuple[Stretch, ...]:
        """Of every spring."""
        pressing = (self._pressing(cam, way) for cam, way in zip(self.leg.cams, self.ways, strict=True))
        return (*(self._stretch(spring) for spring in self.leg.springs), *pressing)

    def tensions(self) -> Iterator[sympy.Expr]:
        """What every spring pulls with (N)."""
        for spring, stretch in zip(self.coils, self.stretches, strict=True):
            stiffness, constant = self._coefficients(spring)
            yield constant + stiffness * stretch.length

    def energies(self) -> Iterator[sympy.Expr]:
        """What every spring has stored since it began to stretch (J)."""
        for spring, stretch in zip(self.coils, self.stretches, strict=True):
            more = self.tape.let(f"{spring.name}_stretch", stretch.length - self._number(spring, "free_length"))
            yield more * (self._number(spring, "tension") + self._number(spring, "stiffness") * more / 2)

    def efforts(self, spring: int) -> Iterator[tuple[int, sympy.Expr]]:
        """On the tree's coordinates, by number: what holds against a spring, dU/dy."""
        own, stretch = self.coils[spring], self.stretches[spring]
        stiffness, constant = self._coefficients(own)
        rate = self.tape.let(f"{own.name}_rate", stiffness + constant / stretch.length)
        yield from ((number, rate * slope) for number, slope in stretch.slopes.items())

    def _number(self, spring: Coil, key: str) -> sympy.Expr:
        return self.tape.let(f"{spring.name}_{key}", expression(getattr(spring, key), self.parameters))

    def _coefficients(self, spring: Coil) -> tuple[sympy.Expr, sympy.Expr]:
        """k, and c of the tension c + k length."""
        stiffness = self._number(spring, "stiffness")
        constant = self._number(spring, "tension") - stiffness * self._number(spring, "free_length")
        return stiffness, self.tape.let(f"{spring.name}_constant", constant)

    def _stretch(self, spring: Spring) -> Stretch:
        way, slopes = self._in_plane(spring) if all(end.planar for end in spring.ends) else self._in_space(spring)
        return self._named(spring, dot(way, way), slopes)

    def _named(self, spring: Coil, square: sympy.Expr, slopes: Mapping[int, sympy.Expr]) -> Stretch:
        named = {number: self.tape.let(f"{spring.name}_slope", slope) for number, slope in slopes.items()}
        return Stretch(self.tape.let(f"{spring.name}_length", sympy.sqrt(self.tape.let(f"{spring.name}_square", square))), named)

    def _pressing(self, cam: Cam, way: int) -> Stretch:
        """Of a cam's spring, by its joint and by the roller's way."""
        joint, lever, reach = self.start + cam.joint, expression(cam.lever, self.parameters), expression(cam.reach, self.parameters)
        phi, r = self.values[joint], self.values[way]
        end = self.tape.let(f"{cam.name}_end", r - reach if cam.on == "link" else r + reach)
        square, slopes, _ = stretched(lever, end, sympy.sin(phi), sympy.cos(phi))
        return self._named(cam.spring, square, {number: slope / 2 for number, slope in zip((joint, way), slopes, strict=True)})

    def _in_plane(self, spring: Spring) -> tuple[Exprs, dict[int, sympy.Expr]]:
        """From the first end to the second, and its products with its slopes."""
        placing = self.placing
        assert placing is not None
        points = [placing.point(end.link, placing.planar(end.at[:2])) for end in spring.ends]
        dx, dy = named(self.tape, f"{spring.name}_way", difference(points[1], points[0]))
        slopes: dict[int, sympy.Expr] = {}
        for sign, end, point in zip((-1, 1), spring.ends, points, strict=True):
            if end.link:
                place = self.places[end.link]
                lever = difference(point, placing.point(end.link, placing.planar(place.point[:2])))
                entries = (sign * dx, sign * dy, sign * outer(lever, (dx, dy)))
                slopes |= dict(zip(range(place.start, place.start + _FLAT), entries, strict=True))
        return (dx, dy), slopes

    def _in_space(self, spring: Spring) -> tuple[Exprs, dict[int, sympy.Expr]]:
        """The same in the axes of the frame that is nearer to the mount, of a link of the linkage in those of the plane."""
        near, far = sorted(spring.ends, key=self._order)
        if near.planar:
            ends = [self._from_plane(near), self._from_plane(far)]
        else:
            ends = [self._fixed(near), self._beyond(self._after(near), far) if self._after(near) else self._between(near.link, far)]
        (start, back), (end, on) = (self._seen(*way) for way in ends)
        way = self.tape.vector(f"{spring.name}_way", minus(end, start))
        pulled = {number: -dot(way, column) for number, column in back.items()}
        return way, pulled | {number: dot(way, column) for number, column in on.items()}

    def _order(self, end: End) -> tuple[bool, bool, int]:
        """From the mount outwards."""
        return self._after(end) > 0, end.planar, end.link

    def _after(self, end: End) -> int:
        """How many joints after the linkage move it."""
        return 0 if end.planar else max(0, end.link - len(self.leg.serial))

    def _seen(self, limbs: tuple[Limb, ...], numbers: Sequence[int]) -> tuple[Vec, dict[int, Vec]]:
        """Where a point is, and how it moves with the tree's coordinates."""
        if not numbers:
            return frame_of(sum((limb.tip for limb in limbs), ()), self.parameters).origin, {}
        kinematics = Kinematics(path_of(limbs, [self.values[number] for number in numbers], self.parameters), self.tape)
        return kinematics.position, dict(zip(numbers, kinematics.jacobian, strict=True))

    def _fixed(self, end: End) -> _Way:
        """In its own frame."""
        return (self._limb((), _shift(end.at)),), []

    def _between(self, near: int, far: End) -> _Way:
        """From one of the frames before the linkage."""
        flat = far.planar or self._after(far) > 0
        joints = self.leg.serial[near:] if flat else self.leg.serial[near : far.link]
        limbs, numbers = self._from_plane(far) if flat else self._fixed(far)
        own = list(range(self.start + near, self.start + near + len(joints)))
        return (self._limb(joints, self.leg.tip if flat else ()), *limbs), [*own, *numbers]

    def _from_plane(self, end: End) -> _Way:
        """From the plane of the linkage."""
        if end.planar and end.link == 0:
            return self._fixed(end)
        place = self.places[end.link if end.planar else END]
        numbers = list(range(place.start, place.start + _FLAT))
        if end.planar:
            x, y, _ = (sub(entry, origin) for entry, origin in zip(end.at, place.point, strict=True))
            return (self._limb(planar_joints(), _shift((x, y, ZERO))),), numbers
        limbs, more = self._beyond(0, end)
        return (self._limb(planar_joints(), ()), *limbs), [*numbers, *more]

    def _beyond(self, near: int, far: End) -> _Way:
        """From one of the frames after the linkage, 0 its end, to another."""
        first, last = self.places[END].start + _FLAT + near, self._after(far)
        return (self._limb(self.leg.distal[near:last], _shift(far.at)),), list(range(first, first + last - near))

    def _limb(self, joints: tuple[Joint, ...], tip: Transform) -> Limb:
        return Limb(self.leg.name, self.leg.platform, (), joints, tip)


def _shift(at: Vector) -> Transform:
    return sum((translation(axis, at[axis]) for axis in (X, Y, Z)), ())

"""Springs of a leg, SI and exact: between frames of its joints, points of its linkage, or both."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from walkgen.model.values import Values
from walkgen.spec.linkage import EndMasses
from walkgen.spec.planar import located
from walkgen.spec.scalar import ZERO, Scalar, Vector, neg
from walkgen.spec.schema import LegDesign
from walkgen.spec.springs import MOUNT, SpringEnd


@dataclass(frozen=True)
class End:
    """Where a spring is hooked on.

    Attributes:
        link: of a `planar` end a body of the linkage, of others 0 the mount, i the frame that moves with the joint i - 1 of those before
            the linkage, then those after it.
        at: the point in that frame, of a planar end in the link's axes with z = 0 (m).
        planar: whether the link is one of the linkage.
        mass: what the spring weighs there (kg).
    """

    link: int
    at: Vector
    planar: bool
    mass: Scalar = ZERO


@dataclass(frozen=True)
class Coil:
    """Pulls its ends together with tension + stiffness (length - free_length): N, N/m, m."""

    name: str
    stiffness: Scalar
    free_length: Scalar
    tension: Scalar


@dataclass(frozen=True)
class Spring(Coil):
    """Between two points of a leg."""

    ends: tuple[End, End]


def springs_of(design: LegDesign, values: Values) -> tuple[Spring, ...]:
    """Those of a leg design, whose references were checked."""
    return tuple(
        Spring(
            spring.name,
            values.resolve(spring.stiffness),
            values.resolve(spring.si("free_length")),
            values.resolve(spring.initial_tension),
            _ends(design, spring.between, spring.masses, values),
        )
        for spring in design.springs
    )


def _ends(design: LegDesign, between: tuple[SpringEnd, SpringEnd], masses: EndMasses, values: Values) -> tuple[End, End]:
    first, second = between
    return _end(design, first, values.resolve(masses.at_first), values), _end(design, second, values.resolve(masses.at_second), values)


def _end(design: LegDesign, end: SpringEnd, mass: Scalar, values: Values) -> End:
    if isinstance(end, str):
        body, point = located(design, end)
        return End(body, (*values.point(point), ZERO), True, mass)
    frames = (MOUNT, *(joint.name for joint in design.rows))
    return End(frames.index(end.link), values.vector(end.si("xyz")), False, mass)


def mirrored_springs(springs: Sequence[Spring]) -> tuple[Spring, ...]:
    """Of the leg reflected in its platform's plane y = 0; points in a linkage's plane stay, since the plane is turned over."""
    return tuple(replace(spring, ends=(_mirrored(spring.ends[0]), _mirrored(spring.ends[1]))) for spring in springs)


def _mirrored(end: End) -> End:
    x, y, z = end.at
    return end if end.planar else replace(end, at=(x, neg(y), z))


def lumps(springs: Sequence[Spring], link: int, *, planar: bool) -> Iterator[tuple[Scalar, Vector]]:
    """Masses that springs lump on a link, with their points."""
    for spring in springs:
        yield from ((end.mass, end.at) for end in spring.ends if (end.link, end.planar) == (link, planar) and end.mass != ZERO)

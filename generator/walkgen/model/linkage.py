"""A planar linkage: links in a plane, SI and exact. Its structure says how it is solved, its points where its pairs are."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import hypot

from walkgen.model.pair_friction import PairFriction, frictions_of
from walkgen.model.springs import Spring, lumps
from walkgen.model.values import Values
from walkgen.spec.assur import SIDES, Group, Order, Structure, Triad, order
from walkgen.spec.planar import End, joined_pairs, link_names, structure_of
from walkgen.spec.scalar import ZERO, Scalar, add, div, exact, mul, power, sub, total
from walkgen.spec.schema import LegDesign

Point = tuple[Scalar, Scalar]


@dataclass(frozen=True)
class PlanarBody:
    """Mass (kg), centre of mass (m) and inertia about it, normal to the plane (kg m^2)."""

    mass: Scalar
    com: Point
    inertia: Scalar


@dataclass(frozen=True)
class Start:
    """Values of the drives at which triads are assembled, where given, and what is known of the assembly there.

    `points` hold a body, one of its points and about where that is in the frame; `angles` a body and about its angle to the frame.
    """

    drives: tuple[Scalar, ...] = ()
    points: tuple[tuple[int, Point, Point], ...] = ()
    angles: tuple[tuple[int, Scalar], ...] = ()


@dataclass(frozen=True)
class Linkage:
    """Bodies are the links, the frame first, then one bar for each driven cylinder, pinned at (0, 0) and (q, 0).

    `points` are those of every pair of the structure, one a body, in the body's axes, None for a bar's far end; a slider's are the
    sliding point and the point of its guide where q is 0, `angles` its guide's direction (0 for pins). `foot` is a body and its point that
    the drives place: the leg's foot, or where the joints beyond the linkage begin. q is in the order of the
    structure's driven pairs, then of its bars. `masses` are those of every link, with what cylinders and
    springs lump at its points; a link at which springs pull has one even where it weighs nothing. `sides` name how dyads are assembled, the
    first side where they are silent; `start` says how triads are, none where there is none. `size` (m) is that of the longest link, to two
    digits. `frictions` are those of the pairs that have any; `sections` names every body's cross-section, empty where it is rigid.
    `bears` says whether joints follow at the linkage's end.
    """

    structure: Structure
    points: tuple[tuple[Point | None, ...], ...]
    angles: tuple[Scalar, ...]
    foot: tuple[int, Point]
    masses: tuple[PlanarBody | None, ...]
    sides: tuple[tuple[str, str], ...]
    size: Scalar
    start: Start = Start()
    frictions: tuple[PairFriction, ...] = ()
    sections: tuple[str, ...] = ()
    bears: bool = False

    @property
    def driven(self) -> tuple[int, ...]:
        """Indices of the driven pairs, those whose q come first."""
        return tuple(index for index, pair in enumerate(self.structure.pairs) if pair.driven)

    @property
    def drive_count(self) -> int:
        """How many q the linkage has."""
        return self.structure.drive_count

    @property
    def heavy(self) -> tuple[tuple[int, PlanarBody], ...]:
        """The links that have mass, or springs, and move."""
        return tuple((body, mass) for body, mass in enumerate(self.masses) if mass and body)

    @property
    def forward(self) -> Order:
        """From the drives to every link."""
        return order(self.structure)

    @property
    def inverse(self) -> Order:
        """From the foot to every link."""
        return order(self.structure.released(self.foot[0]))

    def side(self, group: Group | Triad) -> int:
        """1 for the first of the group's sides, -1 for the other."""
        return -1 if dict(self.sides).get(group.name) in SIDES[group.kind][1:] else 1


def linkage_of(design: LegDesign, values: Values, springs: Sequence[Spring] = ()) -> Linkage:
    """The linkage of a leg design, whose references and mobility were checked, with its springs."""
    structure = structure_of(design)
    names = link_names(design)
    link, _, point = design.placed.partition(".")
    angles = [values.resolve(slider.guide.si("angle")) for slider in design.sliders]
    points = tuple(tuple(_end(end, values) for end in joined.points) for joined in joined_pairs(design))
    foot = values.point(design.links[link].points[point])
    return Linkage(
        structure,
        points,
        (*(ZERO,) * (len(structure.pairs) - len(angles)), *angles),
        (names.index(link), foot),
        tuple(_mass(body, design, springs, values) for body in range(len(names))),
        tuple(design.assembly.items()),
        _size([*(end for ends in points for end in ends if end is not None), foot], values),
        _start(design, names, values),
        frictions_of(design, values),
        _sections(design, names),
        bool(design.joints_after),
    )


def _sections(design: LegDesign, names: Sequence[str]) -> tuple[str, ...]:
    """Of links, then of driven cylinders."""
    links = (design.links[name].section or "" for name in names)
    return (*links, *(cylinder.section or "" for cylinder in design.cylinders if cylinder.driven))


def _size(points: Iterable[Point], values: Values) -> Scalar:
    """Of what lies farthest from the origin of its link; a metre where everything lies there."""
    size = max(hypot(values.number(x), values.number(y)) for x, y in points) or 1.0
    return exact(Decimal(f"{size:.2g}"))


def _start(design: LegDesign, names: Sequence[str], values: Values) -> Start:
    """As the spec has it."""
    given = design.start
    if given is None:
        return Start()
    points = ((text.partition(".")[::2], at) for text, at in given.points.items())
    return Start(
        tuple(values.resolve(drive) for drive in given.si("drives") or ()),
        tuple((names.index(link), values.point(design.links[link].points[name]), values.point(at)) for (link, name), at in points),
        tuple((names.index(link), values.resolve(angle)) for link, angle in given.turned.items()),
    )


def _end(end: End, values: Values) -> Point | None:
    return None if end is None else values.point(end)


def _mass(body: int, design: LegDesign, springs: Sequence[Spring], values: Values) -> PlanarBody | None:
    """All that a link weighs."""
    name = link_names(design)[body]
    return _whole((*_masses(name, design, values), *_lumped(body, springs))) or _pulled(body, springs)


def _masses(name: str, design: LegDesign, values: Values) -> Iterator[PlanarBody]:
    """The link's own, then what cylinders lump at its points."""
    link = design.links[name]
    if link.mass is not None:
        yield PlanarBody(values.resolve(link.mass), values.point(link.com or (ZERO, ZERO)), values.resolve(link.inertia))
    for cylinder in design.cylinders:
        for text, mass in zip(cylinder.between, (cylinder.masses.at_first, cylinder.masses.at_second), strict=True):
            owner, _, point = text.partition(".")
            if owner == name and mass is not None:
                yield PlanarBody(values.resolve(mass), values.point(link.points[point]), ZERO)


def _lumped(body: int, springs: Sequence[Spring]) -> Iterator[PlanarBody]:
    """What springs weigh at a link's points."""
    for mass, (x, y, _) in lumps(springs, body, planar=True):
        yield PlanarBody(mass, (x, y), ZERO)


def _pulled(body: int, springs: Sequence[Spring]) -> PlanarBody | None:
    """A place for forces, where springs pull at a link that weighs nothing."""
    pulled = body and any(end.planar and end.link == body for spring in springs for end in spring.ends)
    return PlanarBody(ZERO, (ZERO, ZERO), ZERO) if pulled else None


def _whole(parts: Sequence[PlanarBody]) -> PlanarBody | None:
    """All as one body."""
    if len(parts) < 2:
        return parts[0] if parts else None
    mass = total(part.mass for part in parts)
    x, y = (div(total(mul(part.mass, part.com[axis]) for part in parts), mass) for axis in range(2))
    spans = (add(power(sub(part.com[0], x), exact(2)), power(sub(part.com[1], y), exact(2))) for part in parts)
    return PlanarBody(mass, (x, y), total(add(part.inertia, mul(part.mass, span)) for part, span in zip(parts, spans, strict=True)))

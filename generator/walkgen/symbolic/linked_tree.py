"""Trees of links whose coordinates are not all q: a linkage's links slide and turn in its plane, each on its own, as the drives say.

A link counts as a flat plate: about any axis in its plane through its centre of mass it has half its inertia about the normal, so that
only where the centre is matters in space, and how fast the link turns.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import sympy

from walkgen.model.linkage import Linkage, PlanarBody, Point
from walkgen.model.mechanism import Body, Joint, Limb, Mechanism
from walkgen.spec.scalar import ZERO, div, exact
from walkgen.symbolic.cams import grow_cam
from walkgen.symbolic.closure import forward_placing
from walkgen.symbolic.driven import planar_joints
from walkgen.symbolic.frames import Frame, frame_of, parameter_symbols
from walkgen.symbolic.inertia import inertia_of
from walkgen.symbolic.path import touched
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import Planar
from walkgen.symbolic.planar_motion import Coordinate, PlanarMotion
from walkgen.symbolic.robot import joint_indices
from walkgen.symbolic.rubbing import rubbing_of
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.springs import END, Place, Springs
from walkgen.symbolic.tape import Tape
from walkgen.symbolic.tree import BASE, Attachment, Foot, Growth, Tree

Exprs = Sequence[sympy.Expr]


def spread_leg(mechanism: Mechanism, leg: Limb, q: Exprs, tape: Tape, *, whole: bool = False) -> tuple[Tree, Spread]:
    """One leg on its platform, which is held; `whole`: with every link of a linkage as one body in its own axes, weightless or not."""
    growth, spread = Growth(parameter_symbols(mechanism), tape), Spread(len(q), tape)
    grow_leg(mechanism, growth, spread, leg, Attachment(BASE, Frame()), q, range(len(q)), "", whole=whole)
    return growth.tree(), spread


def whole_bodies(leg: Limb) -> tuple[int, ...]:
    """Links of the leg's whole tree whose inertia may be anything: one a joint in series, then one a cam's follower, or one a link of the
    linkage but the frame, then one a joint beyond it.
    """
    serial, links = len(leg.serial), len(leg.linkage.masses) - 1 if leg.linkage else 0
    planar, end = (serial + 3 * number + 2 for number in range(links)), serial + 3 * (links + 1)
    return (*range(serial + len(leg.cams)), *planar, *range(end, end + leg.beyond))


def spread_robot(mechanism: Mechanism, q: Exprs, tape: Tape) -> tuple[Tree, Spread]:
    """The whole robot on its root platform; feet in the order of the legs."""
    growth, spread = Growth(parameter_symbols(mechanism), tape), Spread(len(q), tape)
    places = {0: Attachment(BASE, Frame())}
    for index in range(len(mechanism.platforms)):
        for chain in mechanism.ancestors(index):
            assert chain.child is not None
            if chain.child not in places:
                indices = joint_indices(mechanism, chain)
                *_, places[chain.child] = _grow_series(growth, spread, chain, places[chain.platform], q, indices, f"{chain.name}_")
    for index, platform in enumerate(mechanism.platforms):
        if platform.body:
            body = inertia_of(platform.body, growth.parameters, tape, platform.name)
            growth.carry(places[index], body, platform.name)
    for leg in mechanism.legs:
        grow_leg(mechanism, growth, spread, leg, places[leg.platform], q, joint_indices(mechanism, leg), f"{leg.name}_")
    return growth.tree(), spread


def _grow_series(
    growth: Growth, spread: Spread, limb: Limb, start: Attachment, q: Exprs, indices: Sequence[int], prefix: str
) -> list[Attachment]:
    """Add a limb's joints in series; its mount, the frame that moves with each, its tip."""
    places = [Attachment(start.link, start.frame * frame_of(limb.mount, growth.parameters))]
    places += _grow_joints(growth, spread, limb.serial, places[-1], q, indices, prefix)
    tip = frame_of(limb.tip, growth.parameters)
    return [*places, Attachment(places[-1].link, places[-1].frame * (tip * touched(limb) if limb.curved_sole else tip))]


def _grow_joints(
    growth: Growth, spread: Spread, joints: Sequence[Joint], place: Attachment, q: Exprs, indices: Sequence[int], prefix: str
) -> Iterator[Attachment]:
    """Add joints in series, each on the one before; the frames that move with them."""
    for joint, index in zip(joints, indices, strict=False):
        place = growth.joint(joint, place, spread.joint(index, q[index]), prefix + joint.name)
        yield place


def grow_leg(
    mechanism: Mechanism,
    growth: Growth,
    spread: Spread,
    leg: Limb,
    start: Attachment,
    q: Exprs,
    indices: Sequence[int],
    prefix: str,
    *,
    whole: bool = False,
) -> None:
    """Add a leg with its foot; `indices` are its joints' in the robot's q."""
    springs = Springs(leg, growth.parameters, spread.values, len(spread.values), growth.tape)
    *series, place = _grow_series(growth, spread, leg, start, q, indices, prefix)
    if leg.linkage is not None:
        first = len(leg.serial)
        drives, distal = indices[first : len(indices) - leg.beyond], indices[len(indices) - leg.beyond :]
        parts = _whole_parts(leg.linkage) if whole else _parts(leg.linkage)
        placing = forward_placing(leg, [q[index] for index in drives], growth.parameters, growth.tape)
        springs = replace(springs, placing=placing, places=_places(parts, len(spread.values), leg.linkage))
        place = _grow_linkage(growth, spread, leg, place, q, drives, prefix, parts, placing)
        *_, place = (place, *_grow_joints(growth, spread, leg.distal, place, q, distal, prefix))
        place = Attachment(place.link, place.frame * frame_of(leg.foot, growth.parameters))
    for cam in leg.cams:
        drive = indices[cam.joint], q[indices[cam.joint]]
        springs = replace(springs, ways=(*springs.ways, grow_cam(mechanism, leg, cam, growth, spread, series, drive, prefix)))
    if springs.coils:
        spread.springs.append(springs)
    origin = growth.tape.vector(f"{prefix}foot", place.frame.origin) if prefix else place.frame.origin
    growth.feet.append(Foot(place.link, origin))


@dataclass(frozen=True)
class Part:
    """A link of a linkage: the point of it that is followed, what slides with that point, and what turns as well."""

    body: int
    point: Point
    sliding: Body | None
    turning: Body | None


def _parts(linkage: Linkage) -> list[Part]:
    """Those with mass, by their centres."""
    return [Part(body, mass.com, *_bodies(mass)) for body, mass in linkage.heavy]


def _whole_parts(linkage: Linkage) -> list[Part]:
    """All that move, by their origins."""
    return [Part(body, (ZERO, ZERO), None, _plate(mass) if mass else None) for body, mass in enumerate(linkage.masses) if body]


def _places(parts: Sequence[Part], start: int, linkage: Linkage) -> dict[int, Place]:
    """Where the coordinates of the parts are, the first one's from `start` on, and last those of the linkage's end."""
    size, followed = len(planar_joints()), [*((part.body, part.point) for part in parts), (END, linkage.foot[1])]
    return {body: Place(start + size * number, (*point, ZERO)) for number, (body, point) in enumerate(followed)}


def _grow_linkage(
    growth: Growth,
    spread: Spread,
    leg: Limb,
    place: Attachment,
    q: Exprs,
    indices: Sequence[int],
    prefix: str,
    parts: Sequence[Part],
    placing: Placing,
) -> Attachment:
    """Add links, and without mass the linkage's end, which turns as well where it bears joints; where that is.

    The frame's mass is that of the last joint before the linkage.
    """
    linkage = leg.linkage
    assert linkage is not None
    if linkage.masses[0]:
        growth.carry(place, inertia_of(_plate(linkage.masses[0]), growth.parameters, growth.tape, f"{prefix}frame"), f"{prefix}frame")
    drives = [q[index] for index in indices]
    names = [f"{prefix}{linkage.structure.names[part.body]}" for part in parts]
    coordinates: list[Coordinate] = []
    for name, part in zip(names, parts, strict=True):
        coordinates += _at(name, placing.point(part.body, placing.planar(part.point)), growth.tape)
        coordinates.append(Coordinate(f"{name}_angle", rotor=placing.pose(part.body).rotor))
    coordinates += _at(f"{prefix}foot", placing.point(linkage.foot[0], placing.planar(linkage.foot[1])), growth.tape)
    if linkage.bears:
        coordinates.append(Coordinate(f"{prefix}foot_angle", rotor=placing.pose(linkage.foot[0]).rotor))
    motion = PlanarMotion(growth.tape, drives, coordinates)
    own = spread.driven(indices, [coordinate.value for coordinate in coordinates], motion)
    if linkage.frictions:
        spread.rubbings.append(rubbing_of(linkage, placing, growth.parameters, own.start, indices, drives, growth.tape))
    numbers = iter(own)
    for name, part in zip(names, parts, strict=True):
        at = place
        for joint, number in zip(planar_joints(part.sliding, part.turning), numbers, strict=False):
            at = growth.joint(joint, at, number, f"{name}_{joint.name}")
    for joint, number in zip(planar_joints() if linkage.bears else planar_joints()[:2], numbers, strict=True):
        place = growth.joint(joint, place, number, f"{prefix}foot_{joint.name}")
    return place


def _at(name: str, point: Planar, tape: Tape) -> list[Coordinate]:
    return [Coordinate(f"{name}_{axis}", tape.let(f"{name}_{axis}", value)) for axis, value in zip("xy", point, strict=True)]


def _plate(mass: PlanarBody) -> Body:
    """In axes of the link whose z is the plane's normal."""
    half = div(mass.inertia, exact(2))
    return Body(mass.mass, (*mass.com, ZERO), (half, half, mass.inertia, ZERO, ZERO, ZERO))


def _bodies(mass: PlanarBody) -> tuple[Body, Body]:
    """What slides with the centre of mass, and what turns as well: the inertia about the normal."""
    half = div(mass.inertia, exact(2))
    centre = (ZERO, ZERO, ZERO)
    return Body(mass.mass, centre, (half, half, ZERO, ZERO, ZERO, ZERO)), Body(ZERO, centre, (ZERO, ZERO, mass.inertia, ZERO, ZERO, ZERO))

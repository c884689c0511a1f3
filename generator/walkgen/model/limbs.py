"""Designs become limbs: joint rows as exact transforms in either DH convention or by origin and axis, mounted or mirrored."""

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from typing import Literal, cast

from walkgen.model.curved_sole import curved_sole_of
from walkgen.model.lumping import with_lumps
from walkgen.model.mechanism import Body, Joint, Limb, Sole, Transform
from walkgen.model.springs import Spring, lumps, mirrored_springs, springs_of
from walkgen.model.transform import HALF_TURN, X, Z, align, inverse, mirrored, origin, rotation, translation
from walkgen.model.values import Values
from walkgen.spec.joint_tables import JointRow, Link, Pose, Rotor
from walkgen.spec.linkage import PairSpec
from walkgen.spec.scalar import ONE, ZERO, Scalar, exact, mul, neg, power
from walkgen.spec.schema import ChainDesign, LegDesign, LegSpec, PlatformSpec, SoleSpec

Sign = Literal[1, -1]
_DAMPING_PER_SIZE = Decimal("0.01")


def pose_transform(pose: Pose | None, values: Values) -> Transform:
    """A spec's xyz and rpy as a transform; identity where left out."""
    return () if pose is None else origin(values.vector(pose.si("xyz")), values.vector(pose.si("rpy")))


def leg_limb(leg: LegSpec, design: LegDesign, platform: int, values: Values) -> Limb:
    """A design mounted as one leg."""
    springs = springs_of(design, values)
    joints = weighted(joints_of(leg, design, values), springs)
    mount, tip = pose_transform(leg.mount, values), pose_transform(cast(Pose | None, design.foot), values)
    return Limb(
        *(leg.name, platform, mount, joints, tip),
        damping=given_damping(design, values) or _default_damping(_size(joints, tip, values)),
        senses=_signs(leg, design),
        branches=design.branches or (),
        sole=sole_of(leg.sole or design.sole, values),
        springs=springs,
        curved_sole=curved_sole_of(design.curved_sole, values),
    )


def weighted(joints: Sequence[Joint], springs: Sequence[Spring]) -> tuple[Joint, ...]:
    """All joints of a design's rows, with what springs weigh at their ends as part of what the joints move."""
    return tuple(
        replace(joint, body=with_lumps(joint.body, tuple(lumps(springs, number, planar=False)))) for number, joint in enumerate(joints, 1)
    )


def sole_of(sole: SoleSpec | None, values: Values) -> Sole | None:
    """The rectangle on which a leg stands, if it does."""
    if sole is None:
        return None
    length, width = (values.resolve(sole.si(key)) for key in ("length", "width"))
    turn = origin((ZERO, ZERO, ZERO), values.vector(sole.si("rpy")))
    return Sole(length, width, turn, values.optional(sole.kn), values.optional(sole.kt))


def chain_limb(platform: PlatformSpec, design: ChainDesign, parent: int, child: int, values: Values) -> Limb:
    """A chain design between a platform and its parent; the limb bears the child's name."""
    joints = joints_of(platform, design, values)
    mount = pose_transform(platform.root, values)
    end = platform.end
    tip = _level_end(mount, joints, values.vector(platform.si("end_xyz"))) if end == "level" else pose_transform(cast(Pose, end), values)
    return Limb(platform.name, parent, mount, joints, tip, child=child)


def mirrored_limb(limb: Limb, name: str, source_names: Sequence[str] | None) -> Limb:
    """The leg reflected in its platform's plane y = 0, so that the same joint values give the mirrored foot.

    A linkage stays as it is: its plane is turned over instead, which reflects it as well.
    """
    series = (*limb.serial, *limb.distal)
    named = zip(series, source_names or [""] * len(series), strict=True)
    joints = tuple(replace(_mirrored_joint(joint), source_name=source) for joint, source in named)
    before, after = joints[: len(limb.serial)], _turned_over(joints[len(limb.serial) :])
    senses = tuple(-sense if index == 0 else sense for index, sense in enumerate(limb.senses))
    tip = mirrored(limb.tip) + (rotation(X, HALF_TURN) if limb.linkage else ())
    sole = replace(limb.sole, turn=_overturn(limb) + mirrored(limb.sole.turn)) if limb.sole else None
    foot = mirrored(limb.foot)
    rolling = replace(limb.curved_sole, side=-limb.curved_sole.side) if limb.curved_sole else None
    mount, springs = mirrored(limb.mount), mirrored_springs(limb.springs)
    placed = replace(limb, name=name, mount=mount, joints=(*before, *limb.drives, *after), tip=tip, senses=senses)
    return replace(placed, sole=sole, springs=springs, curved_sole=rolling, foot=foot)


def _turned_over(joints: tuple[Joint, ...]) -> tuple[Joint, ...]:
    """Mirrored joints on a linkage whose plane is turned over: the first one turns back."""
    return tuple(replace(joint, before=rotation(X, HALF_TURN) + joint.before) for joint in joints[:1]) + joints[1:]


def _overturn(limb: Limb) -> Transform:
    """What turns a sole back where it is on a link of a linkage whose plane is turned over."""
    return rotation(X, HALF_TURN) if limb.linkage and not limb.beyond else ()


def _mirrored_joint(joint: Joint) -> Joint:
    turned = joint.kind == "revolute"  # a reflection turns a rotation about z round and leaves a shift along z
    return replace(
        joint,
        before=mirrored(joint.before),
        after=mirrored(joint.after),
        sign=-joint.sign if turned else joint.sign,
        zero=neg(joint.zero) if turned else joint.zero,
        body=_mirrored_body(joint.body) if joint.body else None,
    )


def _mirrored_body(body: Body) -> Body:
    x, y, z = body.com
    xx, yy, zz, xy, xz, yz = body.inertia
    return Body(body.mass, (x, neg(y), z), (xx, yy, zz, neg(xy), xz, neg(yz)))


def joints_of(user: LegSpec | PlatformSpec, design: LegDesign | ChainDesign, values: Values) -> tuple[Joint, ...]:
    """The design's rows as joints, with the user's signs, zeros and names."""
    count = len(design.rows)
    own = user if isinstance(user, LegSpec) else None
    signs = _signs(own, design)
    zeros = (own.si("zeros") if own else None) or design.si("zeros") or (ZERO,) * count
    sources = user.source_names or ("",) * count
    rows = zip(design.rows, signs, zeros, sources, strict=True)
    return tuple(_joint(row, design.dh, sign, values.resolve(zero), source, values) for row, sign, zero, source in rows)


def _signs(own: LegSpec | None, design: LegDesign | ChainDesign) -> tuple[Sign, ...]:
    """The user's signs, a leg's own before its design's."""
    return cast(tuple[Sign, ...], tuple((own.signs if own else None) or design.signs or (1,) * len(design.rows)))


def _joint(row: JointRow, convention: str | None, sign: Sign, zero: Scalar, source: str, values: Values) -> Joint:
    before, after, direction = _geometry(row, convention, values)
    section = (row.link.section or "") if row.link else ""
    place = Joint(row.name, row.type, before, cast(Sign, sign * direction), mul(exact(direction), zero), after)
    return replace(actuated(place, row, values), body=_body(row.link, values), section=section, source_name=source)


def actuated(joint: Joint, row: JointRow | PairSpec, values: Values) -> Joint:
    """The joint with what its row says of its limits, friction and motor."""
    return replace(
        joint,
        limits=values.pair(row.si("limits")),
        max_speed=values.optional(row.si("max_speed")),
        max_effort=values.optional(row.si("max_effort")),
        viscous=values.resolve(row.friction.viscous) if row.friction else ZERO,
        coulomb=values.resolve(row.friction.coulomb) if row.friction else ZERO,
        rotor=_reflected(row.rotor, values),
    )


def _reflected(rotor: Rotor | None, values: Values) -> Scalar:
    """Inertia as the joint feels it: gear^2 times the rotor's own."""
    if rotor is None:
        return ZERO
    gear = ONE if rotor.gear is None else values.resolve(rotor.gear)
    return mul(power(gear, exact(2)), values.resolve(rotor.inertia))


def _geometry(row: JointRow, convention: str | None, values: Values) -> tuple[Transform, Transform, Sign]:
    """What stands before and after the motion about z, and whether the axis points along +z or -z."""
    if row.axis is not None:
        turned, direction = align(values.vector(row.axis), values.number)
        place = origin(values.vector(row.si("xyz")), values.vector(row.si("rpy")))
        return place + turned, inverse(turned), direction
    theta, offset = (values.resolve(row.si(key)) for key in ("theta", "d"))
    length, twist = (values.resolve(row.si(key)) for key in ("a", "alpha"))
    screw = translation(X, length) + rotation(X, twist)
    if convention == "classic":
        return rotation(Z, theta), translation(Z, offset) + screw, 1
    return rotation(X, twist) + translation(X, length) + rotation(Z, theta), translation(Z, offset), 1


def _body(link: Link | None, values: Values) -> Body | None:
    if link is None:
        return None
    return body_of(link.mass, link.si("com"), link.inertia, values)


def body_of(mass: Scalar | None, com: Sequence[Scalar] | None, inertia: Sequence[Scalar] | None, values: Values) -> Body:
    """A rigid body from its spec's numbers; what is left out is zero."""
    xx, yy, zz, xy, xz, yz = (values.resolve(entry) for entry in inertia or (ZERO,) * 6)
    return Body(values.resolve(mass), values.vector(com), (xx, yy, zz, xy, xz, yz))


def _level_end(mount: Transform, joints: tuple[Joint, ...], offset: tuple[Scalar, Scalar, Scalar]) -> Transform:
    """Undo the chain's rotation at q = 0, then shift along the parent's axes (theory: E of the modular robot)."""
    turned: Transform = mount
    for joint in joints:
        angle = rotation(Z, joint.zero) if joint.kind == "revolute" else ()
        turned = turned + joint.before + angle + joint.after
    rotations = tuple(motion for motion in turned if motion.kind == "rotate")
    return inverse(rotations) + origin(offset, (ZERO, ZERO, ZERO))


def given_damping(design: LegDesign, values: Values) -> tuple[Scalar, Scalar] | None:
    """The spec's (epsilon, lambda_max)."""
    return (values.resolve(design.damping.epsilon), values.resolve(design.damping.lambda_max)) if design.damping else None


def _default_damping(size: float) -> tuple[Scalar, Scalar]:
    """For both a hundredth of `size`: how far a unit of the joints' rates moves the foot."""
    default = exact(Decimal(f"{size:.2g}") * _DAMPING_PER_SIZE)
    return default, default


def _size(joints: tuple[Joint, ...], tip: Transform, values: Values) -> float:
    """Per radian of a turning joint the leg's reach, per metre of a sliding one 1 m; of a leg with both, the lesser."""
    sizes = {"revolute": _reach(joints, tip, values), "prismatic": 1.0}
    return min(sizes[joint.kind] for joint in joints)


def _reach(joints: tuple[Joint, ...], tip: Transform, values: Values) -> float:
    """Sum of the leg's lengths and of how far its sliding joints may go (m); 1 where nothing has a length."""
    motions = [motion for joint in joints for motion in joint.before + joint.after] + list(tip)
    lengths = [motion.amount for motion in motions if motion.kind == "translate"]
    slides = [joint.limits for joint in joints if joint.kind == "prismatic" and joint.limits is not None]
    travel = sum(max(abs(values.number(limit)) for limit in limits) for limits in slides)
    return sum(abs(values.number(length)) for length in lengths) + travel or 1.0

"""A leg with a planar linkage: joints in series, then the linkage's drives as joints of the leg, then the joints at its end."""

from collections.abc import Iterator
from dataclasses import replace

from walkgen.model.limbs import actuated, given_damping, joints_of, pose_transform, sole_of, weighted
from walkgen.model.linkage import linkage_of
from walkgen.model.mechanism import Joint, Limb
from walkgen.model.springs import springs_of
from walkgen.model.values import Values
from walkgen.spec.joint_tables import Pose
from walkgen.spec.linkage import CylinderSpec, SliderSpec
from walkgen.spec.planar import pin_name
from walkgen.spec.scalar import ZERO
from walkgen.spec.schema import LegDesign, LegSpec


def linkage_limb(leg: LegSpec, design: LegDesign, platform: int, values: Values) -> Limb:
    """A design with a linkage, mounted as one leg."""
    springs = springs_of(design, values)
    linkage = linkage_of(design, values, springs)
    joints = weighted(joints_of(leg, design, values), springs)
    before, after = joints[: len(design.joints)], _hung(joints[len(design.joints) :], design, values)
    mount, plane = pose_transform(leg.mount, values), pose_transform(design.plane, values)
    sole = sole_of(leg.sole or design.sole, values)
    return Limb(
        *(leg.name, platform, mount, (*before, *_drives(design, values), *after), plane),
        damping=given_damping(design, values),
        linkage=linkage,
        branches=design.branches or (),
        sole=sole,
        springs=springs,
        beyond=len(after),
        foot=pose_transform(design.foot, values) if isinstance(design.foot, Pose) else (),
    )


def _hung(joints: tuple[Joint, ...], design: LegDesign, values: Values) -> tuple[Joint, ...]:
    """The joints after the linkage, the first on the frame at its end."""
    end = pose_transform(design.linkage_end, values)
    return tuple(replace(joint, before=end + joint.before) for joint in joints[:1]) + joints[1:]


def _drives(design: LegDesign, values: Values) -> Iterator[Joint]:
    """Pins, sliders, cylinders: the order of q."""
    for pin in design.pins:
        if pin.driven:
            yield actuated(Joint(pin_name(pin.joins, pin.name), "revolute", (), 1, ZERO, ()), pin, values)
    slides: tuple[SliderSpec | CylinderSpec, ...] = (*design.sliders, *design.cylinders)
    for slide in slides:
        if slide.driven:
            yield actuated(Joint(slide.name, "prismatic", (), 1, ZERO, ()), slide, values)

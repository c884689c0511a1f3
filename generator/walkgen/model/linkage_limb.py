"""A leg that ends in a planar linkage: joints in series, then the linkage's drives as joints of the leg."""

from collections.abc import Iterator

from walkgen.model.limbs import actuated, damping_of, joints_of, pose_transform, sole_of, weighted
from walkgen.model.linkage import linkage_of
from walkgen.model.mechanism import Joint, Limb
from walkgen.model.springs import springs_of
from walkgen.model.values import Values
from walkgen.spec.linkage import CylinderSpec, SliderSpec
from walkgen.spec.planar import pin_name
from walkgen.spec.scalar import ZERO
from walkgen.spec.schema import LegDesign, LegSpec


def linkage_limb(leg: LegSpec, design: LegDesign, platform: int, values: Values) -> Limb:
    """A design with a linkage, mounted as one leg."""
    springs = springs_of(design, values)
    linkage = linkage_of(design, values, springs)
    joints = (*weighted(joints_of(leg, design, values), springs), *_drives(design, values))
    mount, plane = pose_transform(leg.mount, values), pose_transform(design.plane, values)
    damping = damping_of(design, min(values.number(linkage.size), 1.0), values)
    sole = sole_of(leg.sole or design.sole, values)
    return Limb(
        *(leg.name, platform, mount, joints, plane),
        damping=damping,
        linkage=linkage,
        branches=design.branches or (),
        sole=sole,
        springs=springs,
    )


def _drives(design: LegDesign, values: Values) -> Iterator[Joint]:
    """Pins, sliders, cylinders: the order of q."""
    for pin in design.pins:
        if pin.driven:
            yield actuated(Joint(pin_name(pin.joins, pin.name), "revolute", (), 1, ZERO, ()), pin, values)
    slides: tuple[SliderSpec | CylinderSpec, ...] = (*design.sliders, *design.cylinders)
    for slide in slides:
        if slide.driven:
            yield actuated(Joint(slide.name, "prismatic", (), 1, ZERO, ()), slide, values)

"""A leg that ends in a planar linkage: joints in series, then the linkage's drives as joints of the leg."""

from collections.abc import Iterator
from decimal import Decimal
from typing import Literal

from walkgen.model.limbs import joints_of, pose_transform, reflected, sole_of
from walkgen.model.linkage import Linkage, linkage_of
from walkgen.model.mechanism import Joint, Limb
from walkgen.model.values import Values
from walkgen.spec.linkage import CylinderSpec, PairSpec, SliderSpec
from walkgen.spec.planar import pin_name
from walkgen.spec.scalar import ZERO, Scalar, exact
from walkgen.spec.schema import LegDesign, LegSpec

_DAMPING_PER_SIZE = Decimal("0.01")


def linkage_limb(leg: LegSpec, design: LegDesign, platform: int, values: Values) -> Limb:
    """A design with a linkage, mounted as one leg."""
    linkage = linkage_of(design, values)
    joints = (*joints_of(leg, design, values), *_drives(design, values))
    mount, plane = pose_transform(leg.mount, values), pose_transform(design.plane, values)
    damping = _damping(design, linkage, values)
    sole = sole_of(leg.sole or design.sole, values)
    return Limb(leg.name, platform, mount, joints, plane, damping=damping, linkage=linkage, branches=design.branches or (), sole=sole)


def _drives(design: LegDesign, values: Values) -> Iterator[Joint]:
    """Pins, sliders, cylinders: the order of q."""
    for pin in design.pins:
        if pin.driven:
            yield _drive(pin_name(pin.joins, pin.name), "revolute", pin, values)
    slides: tuple[SliderSpec | CylinderSpec, ...] = (*design.sliders, *design.cylinders)
    for slide in slides:
        if slide.driven:
            yield _drive(slide.name, "prismatic", slide, values)


def _drive(name: str, kind: Literal["revolute", "prismatic"], pair: PairSpec, values: Values) -> Joint:
    return Joint(
        name=name,
        kind=kind,
        before=(),
        sign=1,
        zero=ZERO,
        after=(),
        limits=values.pair(pair.si("limits")),
        max_speed=values.optional(pair.max_speed),
        max_effort=values.optional(pair.max_effort),
        body=None,
        section="",
        source_name="",
        viscous=values.resolve(pair.friction.viscous) if pair.friction else ZERO,
        coulomb=values.resolve(pair.friction.coulomb) if pair.friction else ZERO,
        rotor=reflected(pair.rotor, values),
    )


def _damping(design: LegDesign, linkage: Linkage, values: Values) -> tuple[Scalar, Scalar]:
    """The spec's, else a hundredth of the linkage's size: its longest link, or what a metre of a slider moves."""
    if design.damping is not None:
        return values.resolve(design.damping.epsilon), values.resolve(design.damping.lambda_max)
    default = exact(Decimal(f"{min(values.number(linkage.size), 1.0):.2g}") * _DAMPING_PER_SIZE)
    return default, default

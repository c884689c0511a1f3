"""Friction in the pairs of a planar linkage, beside that of its drives' own joints."""

from collections.abc import Iterator
from dataclasses import dataclass

from walkgen.model.values import Values
from walkgen.spec.joint_tables import Friction
from walkgen.spec.planar import End, joined_pairs, located
from walkgen.spec.scalar import ZERO, Scalar, mul
from walkgen.spec.schema import LegDesign

LinkPoint = tuple[int, tuple[Scalar, Scalar]]
"""A link by its number, and a point of it in its axes (m)."""


@dataclass(frozen=True)
class PairFriction:
    """Against a pin's turning, a slider's or a passive cylinder's sliding.

    Attributes:
        name: of the pair.
        pair: index in the structure; None for a passive cylinder, which is no pair of it.
        ends: both links with the points where they meet; the second moves on the first.
        viscous: N m s/rad or N s/m. Of a driven pair this and `coulomb` belong to its joint, and are 0 here.
        coulomb: N m or N.
        lever: of each newton that the pair carries, what rubs: mu times radius (m) of a pin, mu of a slider.
    """

    name: str
    pair: int | None
    ends: tuple[LinkPoint, LinkPoint]
    viscous: Scalar
    coulomb: Scalar
    lever: Scalar = ZERO


def frictions_of(design: LegDesign, values: Values) -> tuple[PairFriction, ...]:
    """Those that are not 0: of pins, each further link against the first, of sliders, of passive cylinders."""
    found = (*_pins(design, values), *_sliders(design, values), *_cylinders(design, values))
    return tuple(each for each in found if (each.viscous, each.coulomb, each.lever) != (ZERO, ZERO, ZERO))


def _pins(design: LegDesign, values: Values) -> Iterator[PairFriction]:
    for index, (pin, joined) in enumerate(zip(design.pins, joined_pairs(design), strict=False)):
        if pin.friction is not None:
            first, *others = (_end(*end, values) for end in zip(joined.pair.bodies, joined.points, strict=True))
            lever = mul(values.resolve(pin.friction.mu), values.resolve(pin.friction.radius))
            for other in others:
                yield PairFriction(joined.pair.name, index, (first, other), *_own(pin.friction, pin.driven, values), lever)


def _sliders(design: LegDesign, values: Values) -> Iterator[PairFriction]:
    joined = joined_pairs(design)
    for index, slider in enumerate(design.sliders, len(joined) - len(design.sliders)):
        if slider.friction is not None:
            runner, guide = (_end(*end, values) for end in zip(joined[index].pair.bodies, joined[index].points, strict=True))
            own = _own(slider.friction, slider.driven, values)
            yield PairFriction(slider.name, index, (guide, runner), *own, values.resolve(slider.friction.mu))


def _cylinders(design: LegDesign, values: Values) -> Iterator[PairFriction]:
    for cylinder in design.cylinders:
        if cylinder.friction is not None and not cylinder.driven:
            first, second = (_end(*located(design, text), values) for text in cylinder.between)
            yield PairFriction(cylinder.name, None, (first, second), *_own(cylinder.friction, False, values))


def _own(friction: Friction, driven: bool, values: Values) -> tuple[Scalar, Scalar]:
    """Viscous and Coulomb part, where no joint has them."""
    return (ZERO, ZERO) if driven else (values.resolve(friction.viscous), values.resolve(friction.coulomb))


def _end(body: int, point: End, values: Values) -> LinkPoint:
    assert point is not None  # only bars have a far end
    return body, values.point(point)

"""From the spec's gait tables to Gaits: parameters put in, phases from the kind's formula, legs in the order of the feet."""

from walkgen.gait import phases
from walkgen.model.gait import Gait, Point
from walkgen.model.values import Values
from walkgen.spec.checks_gait import gaits_of, is_static
from walkgen.spec.gait import GaitSpec
from walkgen.spec.gait_timing import timing
from walkgen.spec.scalar import ZERO
from walkgen.spec.schema import RobotSpec


def gaits(spec: RobotSpec, values: Values) -> tuple[Gait, ...]:
    """All gaits of a validated spec, in the order of the file."""
    legs = tuple(leg.name for leg in spec.legs)
    return tuple(_gait(name, gait, legs, values) for name, _, gait in gaits_of(spec))


def _gait(name: str, gait: GaitSpec, legs: tuple[str, ...], values: Values) -> Gait:
    times = timing(gait, values.fraction)
    stride, lift, margin = (gait.si(key) for key in ("stride", "lift", "margin"))
    return Gait(
        name=name,
        kind=gait.kind,
        duty_factor=tuple(times[leg][0] for leg in legs),
        phase=tuple(phases.fraction(times[leg][1]) for leg in legs),
        period=values.fraction(gait.period),
        stride=values.fraction(ZERO if stride is None else stride),
        lift=None if lift is None else values.fraction(lift),
        stance=None if gait.stance is None else tuple(_point(gait, leg, values) for leg in legs),
        static=is_static(gait),
        body=gait.body,
        margin=None if margin is None else values.fraction(margin),
    )


def _point(gait: GaitSpec, leg: str, values: Values) -> Point:
    assert gait.stance is not None
    x, y, z = (values.fraction(entry) for entry in gait.stance[leg])
    return (x, y, z)

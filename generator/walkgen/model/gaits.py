"""From the spec's gait tables to Gaits and Schedules: parameters put in, phases from the kind's formula, legs in the order of the feet."""

from collections.abc import Mapping
from fractions import Fraction

from walkgen.gait import phases
from walkgen.model.gait import Event, Gait, Point, Schedule, Stepping
from walkgen.model.values import Values
from walkgen.spec.checks_gait import gaits_of, is_static
from walkgen.spec.gait import GaitSpec
from walkgen.spec.gait_timing import timing
from walkgen.spec.scalar import ZERO, Vector
from walkgen.spec.schema import RobotSpec

_HALF = Fraction(1, 2)


def gaits(spec: RobotSpec, values: Values) -> tuple[Gait | Schedule, ...]:
    """All gaits of a validated spec, in the order of the file."""
    legs = tuple(leg.name for leg in spec.legs)
    tables = {name: gait for name, _, gait in gaits_of(spec)}
    return tuple(
        (_cycle if gait.events is None else _schedule)(name, gait, _stance(gait, tables), legs, values) for name, gait in tables.items()
    )


def _common(name: str, gait: GaitSpec, points: Mapping[str, Vector] | None, legs: tuple[str, ...], values: Values) -> Stepping:
    stride, lift, margin = (gait.si(key) for key in ("stride", "lift", "margin"))
    return Stepping(
        name=name,
        stride=values.fraction(ZERO if stride is None else stride),
        lift=None if lift is None else values.fraction(lift),
        stance=None if points is None else tuple(_point(points[leg], values) for leg in legs),
        static=is_static(gait),
        body=gait.body,
        margin=None if margin is None else values.fraction(margin),
    )


def _schedule(name: str, gait: GaitSpec, points: Mapping[str, Vector] | None, legs: tuple[str, ...], values: Values) -> Schedule:
    return Schedule(
        events=tuple(Event(values.fraction(event.at), legs.index(event.leg), event.does) for event in gait.events or ()),
        lifted=tuple(leg in (gait.lifted or ()) for leg in legs),
        **vars(_common(name, gait, points, legs, values)),
    )


def _cycle(name: str, gait: GaitSpec, points: Mapping[str, Vector] | None, legs: tuple[str, ...], values: Values) -> Gait:
    assert gait.period is not None
    times = timing(gait, values.fraction)
    return Gait(
        kind=gait.kind,
        duty_factor=tuple(times[leg][0] for leg in legs),
        phase=tuple(phases.fraction(times[leg][1]) for leg in legs),
        period=values.fraction(gait.period),
        heel_off=_HALF if gait.heel_off is None else values.fraction(gait.heel_off),
        **vars(_common(name, gait, points, legs, values)),
    )


def _stance(gait: GaitSpec, others: Mapping[str, GaitSpec]) -> Mapping[str, Vector] | None:
    """The gait's own, or that of the gait it names."""
    given = others[gait.stance].stance if isinstance(gait.stance, str) else gait.stance
    assert not isinstance(given, str)
    return given


def _point(entries: Vector, values: Values) -> Point:
    x, y, z = (values.fraction(entry) for entry in entries)
    return (x, y, z)

"""Where a curved sole touches the ground, by bisection in 50 digits: what the self-test takes for the foot point."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from walkgen.model.mechanism import Limb, Mechanism, Motion
from walkgen.model.walk import CONTEXT, defaults, limb_frames
from walkgen.spec.directrix import Piece, series
from walkgen.spec.scalar import Exact, Scalar, evaluate
from walkgen.spec.taylor import Field, Taylor

_HALVINGS = 180
_FIELD = Field(CONTEXT.mpf, +CONTEXT.pi, CONTEXT.sqrt, CONTEXT.sin, CONTEXT.cos, CONTEXT.atan2)


def touched(mechanism: Mechanism, leg: Limb, q: Sequence[Any]) -> Limb:
    """The leg with its tip where its sole touches the ground at q, held there in the foot; itself without a curved sole.

    At q, which are rational, no sole lies flat.
    """
    sole = leg.curved_sole
    if sole is None:
        return leg
    values = defaults(mechanism)
    down, ahead = normal_in_foot(mechanism, leg, q)
    curve, edge = (sole.toe, sole.front) if ahead < 0 else (sole.heel, sole.rear)
    level = (evaluate(sole.depth, CONTEXT, values), evaluate(edge, CONTEXT, values))
    x, y = _rolled(curve, down, ahead, values) if curve else level
    shift = (Motion("translate", axis, _exact(entry)) for axis, entry in enumerate((x, sole.side * y)))
    return replace(leg, tip=(*leg.tip, *shift), curved_sole=None)


def normal_in_foot(mechanism: Mechanism, leg: Limb, q: Sequence[Any]) -> tuple[Any, Any]:
    """Of the ground: along the foot's x, and forward along its y."""
    sole, values = leg.curved_sole, defaults(mechanism)
    assert sole is not None
    foot = limb_frames(mechanism, leg, q, values)[-1]
    gravity = [evaluate(entry, CONTEXT, values) for entry in mechanism.gravity]
    against = [-entry for entry in gravity] if any(gravity) else [CONTEXT.zero, CONTEXT.zero, CONTEXT.one]
    size = CONTEXT.sqrt(sum(entry * entry for entry in against))
    down, ahead = (sum(foot[row, axis] * against[row] for row in range(3)) / size for axis in (0, 1))
    slope = evaluate(sole.slope, CONTEXT, values)
    cosine, sine = CONTEXT.cos(slope), CONTEXT.sin(slope)
    return cosine * down - sine * sole.side * ahead, cosine * sole.side * ahead + sine * down


def _rolled(curve: tuple[Piece, ...], down: Any, ahead: Any, values: dict[str, Any]) -> tuple[Any, Any]:
    """The point at which the curve lies along the ground; its end where that is beyond it."""
    low, high = (evaluate(scalar, CONTEXT, values) for scalar in (curve[0].start, curve[-1].end))
    sign = _slope(curve, low, down, ahead, values) > 0
    if (_slope(curve, high, down, ahead, values) > 0) == sign:
        low = high
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if (_slope(curve, middle, down, ahead, values) > 0) == sign else (low, middle)
    x, y = _at(curve, high, values)
    return x.c[0], y.c[0]


def _slope(curve: tuple[Piece, ...], at: Any, down: Any, ahead: Any, values: dict[str, Any]) -> Any:
    """Of the curve against the ground."""
    x, y = _at(curve, at, values)
    return x.c[1] * down + y.c[1] * ahead


def _at(curve: tuple[Piece, ...], at: Any, values: dict[str, Any]) -> tuple[Taylor, Taylor]:
    piece = next((each for each in reversed(curve) if at >= evaluate(each.start, CONTEXT, values)), curve[0])
    return series(piece, at, _FIELD, values, 1)


def _exact(value: Any) -> Scalar:
    return Exact(Fraction(CONTEXT.nstr(value, CONTEXT.dps)))

"""Duty factors and phases of a spec's gait, leg by leg: exact, from the kind's formula or from its tables."""

from collections.abc import Callable, Mapping
from fractions import Fraction

from walkgen.gait import phases
from walkgen.spec.gait import GaitSpec
from walkgen.spec.scalar import Scalar

Timing = Mapping[str, tuple[Fraction, Fraction]]
"""By leg: duty factor and phase."""

_DUTY: Mapping[str, Callable[[int], Fraction]] = {
    "tripod": lambda _: Fraction(1, 2),
    "trot": lambda _: Fraction(1, 2),
    "crawl": lambda _: Fraction(3, 4),
    "overlapping": lambda pairs: 1 - Fraction(1, 2 * pairs),
}
"""Where the spec gives none, for so many pairs of legs."""
WITHOUT_DUTY = frozenset((*_DUTY, "events"))
"""Kinds that have a duty factor of their own, or none."""


def timing(gait: GaitSpec, number: Callable[[Scalar], Fraction]) -> Timing:
    """Of every leg that the gait names; what its kind needs is there.

    Args:
        gait: of the spec.
        number: the value of one of its numbers.
    """
    if gait.kind == "free":
        return {leg: (number(_factor_of(gait, leg)), phases.fraction(number(phase))) for leg, phase in (gait.phase or {}).items()}
    left, right = gait.left or (), gait.right or ()
    duty = _common(gait, len(left), number)
    return {leg: (duty, phase) for leg, phase in zip((*left, *right), _phases(gait, len(left), duty, number), strict=True)}


def _factor_of(gait: GaitSpec, leg: str) -> Scalar:
    factor = gait.duty_factor[leg] if isinstance(gait.duty_factor, dict) else gait.duty_factor
    assert factor is not None
    return factor


def _common(gait: GaitSpec, pairs: int, number: Callable[[Scalar], Fraction]) -> Fraction:
    given = gait.duty_factor
    return _DUTY[gait.kind](pairs) if given is None or isinstance(given, dict) else number(given)


def _phases(gait: GaitSpec, pairs: int, duty: Fraction, number: Callable[[Scalar], Fraction]) -> tuple[Fraction, ...]:
    if gait.kind in {"tripod", "trot"}:
        return phases.alternating(pairs, duty)
    if gait.kind == "overlapping":
        return phases.overlapping(pairs, duty)
    if gait.kind == "follow_the_leader":
        return phases.following(pairs, duty, number(gait.si("pitch")) / number(gait.si("stride")))
    return phases.wave(pairs, duty)

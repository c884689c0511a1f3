"""When each leg is placed in the usual gaits, and what that makes of the cycle: plain arithmetic, exact on fractions."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TypeVar

Number = TypeVar("Number", Fraction, float)
"""Phases and duty factors, in periods."""

_HALF = Fraction(1, 2)
STATIC = 3
"""Supporting legs that a walk without falling needs."""


def fraction(number: Number) -> Number:
    """F(x) = x - floor(x), in [0, 1) whatever the rounding."""
    rest = number - math.floor(number)
    return rest if rest < 1 else rest - rest


def wave(pairs: int, duty: Number) -> tuple[Number, ...]:
    """Phases of a wave gait, legs on the left from the front, then on the right: F(m beta), F(m beta + 1/2) (theory 3.1)."""
    return _sided(tuple(m * duty for m in range(pairs)))


def alternating(pairs: int, duty: Number) -> tuple[Number, ...]:
    """Two groups in turn, neighbours in different ones: 0, 1/2, 0, ... | 1/2, 0, 1/2, ...; the tripod for three pairs, the trot for two."""
    zero = duty - duty
    return _sided(tuple(zero + m * _HALF for m in range(pairs)))


def following(pairs: int, duty: Number, pitch_per_stride: Number) -> tuple[Number, ...]:
    """Every foot is placed where the one before it on its side stood: F(m P/lambda), the right side half a period later.

    The place is free once the foot before has left it: P/lambda >= beta, in other words stroke <= pitch.
    """
    zero = duty - duty
    return _sided(tuple(zero + m * pitch_per_stride for m in range(pairs)))


def overlapping(pairs: int, duty: Number) -> tuple[Number, ...]:
    """Strokes of a side's legs overlap wholly, as Ambler's: its last leg passes the others and is placed before them.

    Placing goes round each side from the last leg at t = 0 to the first, F(-(m + 1)/n), the right side half a share later.
    """
    zero = duty - duty
    left = tuple(fraction(zero - Fraction(m + 1, pairs)) for m in range(pairs))
    return left + tuple(fraction(phase + Fraction(1, 2 * pairs)) for phase in left)


def _sided(left: Sequence[Number]) -> tuple[Number, ...]:
    """Those of the left, and of the right half a period later."""
    return tuple(fraction(phase) for phase in left) + tuple(fraction(phase + _HALF) for phase in left)


def least_duty(pairs: int) -> Fraction:
    """Below 3/(2n) a wave gait of 2n legs cannot have three supporting always."""
    return Fraction(STATIC, 2 * pairs)


def instants(duty: Sequence[Number], phase: Sequence[Number]) -> tuple[tuple[Number, int, int], ...]:
    """The cycle's events in order: when (in periods), which leg, 1 lifted or -1 placed."""
    placed = [(fraction(at), leg, -1) for leg, at in enumerate(phase)]
    lifted = [(fraction(at + factor), leg, 1) for leg, (at, factor) in enumerate(zip(phase, duty, strict=True))]
    return tuple(sorted(placed + lifted))


def supports(duty: Sequence[Number], phase: Sequence[Number], at: Number) -> tuple[bool, ...]:
    """Which legs support at an instant, in periods: from when they are placed on, until they are lifted."""
    return tuple(fraction(at - placed) < factor for placed, factor in zip(phase, duty, strict=True))


def spans(duty: Sequence[Number], phase: Sequence[Number], shortest: float = 0.0) -> tuple[tuple[Number, Number, tuple[bool, ...]], ...]:
    """The parts of a cycle between its events, begun at the first: from when, until when, and which legs support.

    Args:
        duty: factors.
        phase: when each leg is placed.
        shortest: parts up to this long, which rounding made of events at one instant, are left out.
    """
    starts: list[Number] = sorted({at for at, _, _ in instants(duty, phase)})
    ends = starts[1:]
    ends.append(starts[0] + 1)
    pairs = [(start, end) for start, end in zip(starts, ends, strict=True) if end - start > shortest]
    return tuple((start, end, supports(duty, phase, (start + end) * _HALF)) for start, end in pairs)

"""The usual gaits by their names; legs are given from the front, on the left and on the right."""

from collections.abc import Sequence

from walkgen.gait import phases
from walkgen.gait.pattern import Gait

_EVEN = 0.5


def wave(left: Sequence[str], right: Sequence[str], duty_factor: float, period: float = 1.0, stride: float = 0.0) -> Gait:
    """A wave gait of 2n legs: placing runs from the front to the rear, a leg as its fore neighbour lifts (theory 3.1).

    Raises:
        ValueError: sides of different lengths; a duty factor below 3/(2n), where fewer than three legs would support.
    """
    pairs = _pairs(left, right)
    least = phases.least_duty(pairs)
    if duty_factor < float(least):
        raise ValueError(f"a wave gait of {2 * pairs} legs needs a duty factor of {least} at least, not {duty_factor:g}")
    return _gait(left, right, duty_factor, phases.wave(pairs, duty_factor), period, stride)


def tripod(left: Sequence[str], right: Sequence[str], duty_factor: float = _EVEN, period: float = 1.0, stride: float = 0.0) -> Gait:
    """3 x 3: front and rear of one side with the middle of the other, then the other three.

    Raises:
        ValueError: not three legs on each side.
    """
    return _gait(left, right, duty_factor, phases.alternating(_sided(left, right, 3), duty_factor), period, stride)


def crawl(left: Sequence[str], right: Sequence[str], duty_factor: float = 0.75, period: float = 1.0, stride: float = 0.0) -> Gait:
    """The wave gait of a quadruped, which has the largest longitudinal margin of all its gaits (McGhee and Frank).

    Raises:
        ValueError: not two legs on each side, or a duty factor below 3/4.
    """
    _sided(left, right, 2)
    return wave(left, right, duty_factor, period, stride)


def trot(left: Sequence[str], right: Sequence[str], duty_factor: float = _EVEN, period: float = 1.0, stride: float = 0.0) -> Gait:
    """Diagonal pairs in turn; two legs support at times, so it is not static.

    Raises:
        ValueError: not two legs on each side.
    """
    return _gait(left, right, duty_factor, phases.alternating(_sided(left, right, 2), duty_factor), period, stride)


def follow_the_leader(
    left: Sequence[str], right: Sequence[str], duty_factor: float, pitch: float, stride: float, period: float = 1.0
) -> Gait:
    """Each foot is placed where its fore neighbour stood, so that only the first two choose their footholds.

    Args:
        left: legs from the front, whose stroke centres are `pitch` apart.
        right: those beside them.
        duty_factor: of all legs.
        pitch: m.
        stride: m.
        period: s.

    Raises:
        ValueError: a stroke longer than the pitch: the place is taken; sides of different lengths.
    """
    pairs = _pairs(left, right)
    if not 0.0 < duty_factor * stride <= pitch * (1.0 + 1e-12):
        raise ValueError(
            f"a stroke of {duty_factor * stride:g} m is not between 0 and the pitch of {pitch:g} m: the fore foot is still there"
        )
    return _gait(left, right, duty_factor, phases.following(pairs, duty_factor, pitch / stride), period, stride)


def overlapping(
    left: Sequence[str], right: Sequence[str], duty_factor: float | None = None, period: float = 1.0, stride: float = 0.0
) -> Gait:
    """Ambler's: the last leg of a side passes the others and is placed before them, sides in turn.

    The stroke centres of a side's legs are one point. Where the duty factor is left out one leg at a time is in transfer: 1 - 1/(2n).

    Raises:
        ValueError: sides of different lengths.
    """
    pairs = _pairs(left, right)
    factor = 1.0 - 1.0 / (2 * pairs) if duty_factor is None else duty_factor
    return _gait(left, right, factor, phases.overlapping(pairs, factor), period, stride)


def _gait(left: Sequence[str], right: Sequence[str], duty_factor: float, phase: Sequence[float], period: float, stride: float) -> Gait:
    return Gait((*left, *right), (duty_factor,) * len(phase), tuple(phase), period, stride)


def _pairs(left: Sequence[str], right: Sequence[str]) -> int:
    if len(left) != len(right) or not left:
        raise ValueError(f"{len(left)} legs on the left and {len(right)} on the right: each has one beside it")
    return len(left)


def _sided(left: Sequence[str], right: Sequence[str], pairs: int) -> int:
    if _pairs(left, right) != pairs:
        raise ValueError(f"this gait has {pairs} legs on each side, not {len(left)}")
    return pairs

"""The longitudinal stability margin of gaits: a formula for wave gaits where it holds, the cycle gone through elsewhere (theory 3.1)."""

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from walkgen.gait import phases
from walkgen.gait.pattern import Gait
from walkgen.gait.standard import wave

_LONGEST_STROKE = 1.7
_TOGETHER = 1e-12


def wave_margin(pairs: int, duty_factor: float, pitch: float, stroke: float) -> float:
    """S of a wave gait of 2n legs: the least distance along the body from the middle to the end of the support polygon, in m.

    In the range where it holds by Song and Waldron's formula and its second limit, S = min((n/2 - 1) P + (1 - 3/(4 beta)) R,
    (n - 1) P/2 + (1/(4 beta) - 1/2) R), elsewhere by going through the cycle.

    Args:
        pairs: n, two at least.
        duty_factor: beta, at least 3/(2n) and below 1.
        pitch: P, distance of a side's stroke centres (m).
        stroke: R (m).

    Raises:
        ValueError: a gait that does not exist.
    """
    if not formula_holds(pairs, duty_factor, pitch, stroke):
        return cycle_margin(*_on_two_lines(pairs, duty_factor, pitch, stroke))
    first = (pairs / 2 - 1) * pitch + (1 - 3 / (4 * duty_factor)) * stroke
    second = (pairs - 1) * pitch / 2 + (1 / (4 * duty_factor) - 0.5) * stroke
    return min(first, second)


def formula_holds(pairs: int, duty_factor: float, pitch: float, stroke: float) -> bool:
    """Whether the formula is valid: 1/2 <= beta < 1 (3/4 for a quadruped), R <= 1.7 P."""
    least = max(0.5, float(phases.least_duty(pairs)))
    return least <= duty_factor < 1.0 and 0.0 <= stroke <= _LONGEST_STROKE * pitch


def _on_two_lines(pairs: int, duty_factor: float, pitch: float, stroke: float) -> tuple[Gait, list[tuple[float, float]]]:
    left, right = ([f"{side}{m}" for m in range(pairs)] for side in "lr")
    gait = wave(left, right, duty_factor, stride=stroke / duty_factor)
    centres = [(((pairs - 1) / 2 - m) * pitch, side) for side in (1.0, -1.0) for m in range(pairs)]
    return gait, centres


def cycle_margin(gait: Gait, centres: Sequence[tuple[float, float]]) -> float:
    """S of any gait by going through its cycle (m): minus infinity where the polygon misses the middle line.

    Between two events the polygon only slides back, so its ends are looked at just after the first and just before the second.

    Args:
        gait: with its stride, along x.
        centres: x and y of each foot's stroke centre from the centre of gravity (m).
    """
    margins = [_margin(gait, centres, start, end) for start, end, _ in phases.spans(gait.duty_factor, gait.phase, _TOGETHER)]
    return min(margins)


def _margin(gait: Gait, centres: Sequence[tuple[float, float]], start: float, end: float) -> float:
    """The least in a span: the rear end counts at its start, the front end at its end."""
    middle, half = (start + end) / 2, (end - start) / 2
    u = gait.leg_phase(middle * gait.period)
    down = [leg for leg, (now, factor) in enumerate(zip(u, gait.duty_factor, strict=True)) if now < factor]
    feet = [_passed(gait, centres, leg, float(u[leg])) for leg in down]
    crossings = [_crossing(here, there) for here, there in product(feet, feet) if here[1] >= 0.0 >= there[1]]
    slid = gait.stride * half
    return min(max(crossings) - slid, -min(crossings) - slid) if crossings else -math.inf


def _passed(gait: Gait, centres: Sequence[tuple[float, float]], leg: int, u: float) -> tuple[float, float]:
    """Where a supporting foot is: x0 + R/2 - R u/beta."""
    x, y = centres[leg]
    return x + gait.stride * (gait.duty_factor[leg] / 2 - u), y


def _crossing(here: tuple[float, float], there: tuple[float, float]) -> float:
    """Where the line between two feet on either side crosses the middle line; of two feet on it, the first."""
    (x, y), (other_x, other_y) = here, there
    return x if y == other_y else x + (other_x - x) * y / (y - other_y)


def normalised(margin: float, gait: Gait) -> float:
    """S/lambda, NaN for a gait without stride."""
    return margin / gait.stride if gait.stride else float(np.nan)

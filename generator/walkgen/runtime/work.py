"""Work over a cycle of a sampled motion: what drives put in, and what they would put in if nothing came back."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

_FEWEST = 3


class Work(NamedTuple):
    """Work over one cycle (J) of leading dimensions [...].

    Attributes:
        joints: of every joint, signed [..., n].
        total: their sum [...].
        joints_positive: of every joint while its power is above 0 [..., n].
        positive: their sum [...]: what actuators without regeneration take.
    """

    joints: np.ndarray
    total: np.ndarray
    joints_positive: np.ndarray
    positive: np.ndarray


def cycle_work(power: ArrayLike, period: float, times: ArrayLike | None = None) -> Work:
    """The integrals of power and of its positive part over a cycle, power running straight from sample to sample and back to the first.

    That is of second order in the step; signed work of a smooth cycle in even steps is far more accurate (the rule of a periodic function).

    Args:
        power: of every joint at the samples [..., samples, n] (W).
        period: of the cycle (s).
        times: of the samples [samples] (s) from the first on, not falling, two alike where power jumps; even steps where left out.

    Raises:
        ValueError: fewer than three samples, times that are not as many, that fall or reach beyond the period, or a period not above 0.
    """
    samples = np.asarray(power, dtype=float)
    steps = _steps(samples.shape[-2], period, times)[:, None]
    following = np.roll(samples, -1, axis=-2)
    signed = np.sum(steps * (samples + following) / 2, axis=-2)
    positive = np.sum(steps * _above(samples, following), axis=-2)
    return Work(signed, signed.sum(-1), positive, positive.sum(-1))


def _steps(count: int, period: float, times: ArrayLike | None) -> np.ndarray:
    """From every sample to the next, from the last to the first of the next cycle."""
    if count < _FEWEST or not period > 0:
        raise ValueError(f"a cycle takes {_FEWEST} samples or more and a period above 0; there are {count} and {period:g} s")
    if times is None:
        return np.full(count, period / count)
    stamps = np.asarray(times, dtype=float)
    steps = np.append(np.diff(stamps), period - (stamps[-1] - stamps[0])) if stamps.shape == (count,) else np.array([-1.0])
    if not np.all(steps >= 0):
        raise ValueError(f"times are those of the {count} samples, do not fall and span no more than the period of {period:g} s")
    return steps


def _above(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Mean of the positive part of what runs straight from first to second."""
    high, low = np.maximum(first, second), np.minimum(first, second)
    crossing = (high > 0) & (low < 0)
    part = high**2 / np.where(crossing, high - low, 1.0) / 2
    mean: np.ndarray = np.where(crossing, part, np.maximum(first, 0) / 2 + np.maximum(second, 0) / 2)
    return mean

"""Real roots of polynomials up to degree four, clusters and double roots included: the reference of walkgen_quartic.h."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]

_STEPS = 96
_ROUNDOFF = 16.0 * np.finfo(float).eps
_LEAST = 1e-300
SPLIT = 1.118  # roots up to it are sought as they are, greater ones by their reciprocals


def quartic_roots(coefficients: ArrayLike) -> tuple[Reals, Integers]:
    """Real roots of c0 + c1 x + ... + c4 x^4 in rising order, a double root twice.

    An extremum that misses zero by no more than the rounding of its own evaluation counts as a double root.

    Args:
        coefficients: c0 to c4 [..., 5], finite; leading ones may be 0.

    Returns:
        roots [..., 4], NaN after the last, and their number [...] (0 for the zero polynomial).
    """
    polynomial = scaled(np.asarray(coefficients, float))
    inner = roots_within(polynomial, SPLIT, _ROUNDOFF)
    degree = np.max(np.where(polynomial != 0.0, np.arange(5), 0), axis=-1)
    places = degree[..., None] - np.arange(5)
    backwards = np.where(places >= 0, np.take_along_axis(polynomial, np.maximum(places, 0), axis=-1), 0.0)
    outer = roots_within(backwards, 1.0 / SPLIT, _ROUNDOFF)
    finite = np.abs(outer) > _LEAST
    both = np.concatenate([inner, np.where(finite, 1.0 / np.where(finite, outer, 1.0), np.nan)], axis=-1)
    roots = np.where(np.arange(8) < degree[..., None], np.sort(both, axis=-1), np.nan)[..., :4]
    return roots, np.sum(~np.isnan(roots), axis=-1).astype(np.int32)


def scaled(coefficients: Reals) -> Reals:
    """The polynomial times a power of 2 that brings its largest coefficient to [1/2, 1)."""
    _, exponent = np.frexp(np.max(np.abs(coefficients), axis=-1, keepdims=True))
    return np.asarray(np.ldexp(coefficients, -exponent))


def roots_within(polynomial: Reals, bound: float, slack: float) -> Reals:
    """Roots in [-bound, bound] in rising order, [..., 4], NaN after the last; the zero polynomial has none.

    The roots of each derivative cut the interval into pieces on which the next lower one is monotonic and has at most one root.
    An extremum that misses zero by at most `slack` times the sum of the terms' magnitudes counts twice.
    """
    levels = [polynomial]
    for _ in range(3):
        levels.append(levels[-1][..., 1:] * np.arange(1, levels[-1].shape[-1]))
    cuts = _pieces(np.empty((*polynomial.shape[:-1], 0)), bound)
    for derivative in levels[:0:-1]:
        cuts = _pieces(_crossings(derivative, cuts), bound)
    touching = _touching(polynomial, cuts, slack)
    found = np.concatenate([_crossings(polynomial, cuts), touching, touching], axis=-1)
    return np.asarray(np.sort(found, axis=-1)[..., :4])


def _pieces(inner: Reals, bound: float) -> Reals:
    """The lower end, the cuts between (missing ones at the upper end), the upper end."""
    ends = np.full((*inner.shape[:-1], 1), bound)
    return np.concatenate([-ends, np.where(np.isnan(inner), bound, inner), ends], axis=-1)


def _value(polynomial: Reals, x: Reals) -> tuple[Reals, Reals]:
    """Value and derivative at x [..., k]."""
    value, slope = np.zeros_like(x), np.zeros_like(x)
    for index in range(polynomial.shape[-1] - 1, -1, -1):
        slope = slope * x + value
        value = value * x + polynomial[..., index, None]
    return value, slope


def _crossings(polynomial: Reals, cuts: Reals) -> Reals:
    """The sign change in each piece, sorted, NaN where there is none; 0 counts as positive."""
    low, high = cuts[..., :-1], cuts[..., 1:]
    negative = _value(polynomial, cuts)[0] < 0.0
    crossing = negative[..., :-1] != negative[..., 1:]
    x, before, last = 0.5 * (low + high), high - low, high - low
    moving = crossing
    for _ in range(_STEPS):
        if not moving.any():
            break
        value, slope = _value(polynomial, x)
        left = (value < 0.0) == negative[..., :-1]
        low, high = np.where(left, x, low), np.where(left, high, x)
        newton = x - value / np.where(slope == 0.0, _LEAST, slope)
        safe = (newton >= low) & (newton <= high) & (2.0 * np.abs(newton - x) < before)
        following = np.where(value == 0.0, x, np.where(safe, newton, low + 0.5 * (high - low)))
        before, last = last, np.abs(following - x)
        x = np.where(moving, following, x)
        moving = moving & (last > 0.5 * np.finfo(float).eps * np.abs(x)) & (last > _LEAST)
    return np.asarray(np.sort(np.where(crossing, x, np.nan), axis=-1))


def _touching(polynomial: Reals, cuts: Reals, slack: float) -> Reals:
    """Extrema [..., 3] that miss zero by rounding, without a sign change on either side; NaN for the others."""
    points = cuts[..., 1:-1]
    value = _value(polynomial, points)[0]
    size = _value(np.abs(polynomial), np.abs(points))[0] + _LEAST * np.max(np.abs(polynomial), axis=-1, keepdims=True)
    negative = _value(polynomial, cuts)[0] < 0.0
    crossed = (negative[..., 1:-1] != negative[..., :-2]) | (negative[..., 1:-1] != negative[..., 2:])
    inside = (points > cuts[..., :1]) & (points < cuts[..., -1:])
    return np.where(inside & ~crossed & (size > 0.0) & (np.abs(value) <= slack * size), points, np.nan)

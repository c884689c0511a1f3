"""The roller's way of a cam as a Chebyshev series over the cam's range: what the generated code has of the profile."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from walkgen.model.cam_potential import CamError, bend, level_set, refuse_unfit
from walkgen.model.cams import placed
from walkgen.model.mechanism import Cam, Limb, Mechanism
from walkgen.model.walk import CONTEXT, number

_CLOSE = CONTEXT.mpf(10) ** -40
_FEWEST, _MOST = 32, 256
_NEGLIGIBLE, _SMOOTH = CONTEXT.mpf(10) ** -18, CONTEXT.mpf(10) ** -15
"""Of the largest coefficient: what is left out, and what the last ones must be below."""
_LAST = 4
_DIGITS = 25


@dataclass(frozen=True)
class Way:
    """Sum of `coefficients[k]` T_k(t) (m), where t goes from -1 to 1 as the joint goes from `low` to `high` (rad)."""

    low: Fraction
    high: Fraction
    coefficients: tuple[Fraction, ...]


def way_of(mechanism: Mechanism, leg: Limb, cam: Cam) -> Way:
    """Of a leg's cam at the runtime parameters' defaults, as it is cut.

    Raises:
        CamError: it loses contact, the roller cuts into it, its spring would have to push, it bends too sharply for a series, its joint is
            not level, or there is no gravity.
    """
    potential, (low, high) = placed(mechanism, leg, cam).potential, (number(end, mechanism) for end in cam.span)
    start, degree = number(cam.start, mechanism), _FEWEST
    while True:
        angles = [(low + high - (high - low) * CONTEXT.cos(CONTEXT.pi * place / degree)) / 2 for place in range(degree + 1)]
        ways = level_set(potential, angles, start, CONTEXT, _CLOSE)
        series = _series(ways[::-1])
        size = max(map(abs, series))
        if max(map(abs, series[-_LAST:])) < _SMOOTH * size:
            found = [(at, potential.potential(at, r, CONTEXT), r) for at, r in zip(angles, ways, strict=True)]
            bent = [(state.r, bend(state, r, CONTEXT).curvature, state.length) for _, state, r in found]
            refuse_unfit(angles, bent, number(cam.roller, mechanism), number(cam.spring.free_length, mechanism))
            kept = 1 + max(place for place, entry in enumerate(series) if abs(entry) > _NEGLIGIBLE * size)
            return Way(_rounded(low), _rounded(high), tuple(map(_rounded, series[:kept])))
        if degree == _MOST:
            raise CamError("contact", "the cam bends too sharply", float(low))
        degree *= 2


def _series(values: Sequence[Any]) -> list[Any]:
    """Coefficients of what has these values at cos(pi k / n), k = 0 .. n."""
    n = len(values) - 1
    waves = [CONTEXT.cos(CONTEXT.pi * place / n) for place in range(2 * n)]
    halved = [values[0] / 2, *values[1:-1], values[-1] / 2]
    sums = [2 * sum(value * waves[k * place % (2 * n)] for place, value in enumerate(halved)) / n for k in range(n + 1)]
    return [sums[0] / 2, *sums[1:-1], sums[-1] / 2]


def _rounded(value: Any) -> Fraction:
    return Fraction(CONTEXT.nstr(value, _DIGITS))

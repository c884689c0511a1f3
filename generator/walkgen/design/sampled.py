"""A leg at all places where a search looks at it, in one call: Gauss nodes of every range for its moments, even steps for its springs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkgen.design.ranges import Range
from walkgen.design.statics import Rest, Statics

Reals = NDArray[np.float64]
_STEPS = 101
"""Points of each range at which springs must fit."""


@dataclass(frozen=True)
class Moments:
    """What is left of a range's moment at its Gauss nodes [m], slopes [m, n], and weights whose sum is 1 [m]."""

    values: Reals
    slopes: Reals
    weights: Reals


class Sampled:
    """Of one leg; the last answer is kept, since objectives and constraints ask for the same values.

    Args:
        statics: of the leg.
        ranges: where it is judged.
        nodes: Gauss nodes of each.
    """

    def __init__(self, statics: Statics, ranges: Sequence[Range], nodes: int) -> None:
        self._statics, self._ranges = statics, ranges
        gauss = [each.gauss(nodes) for each in ranges]
        places = [each.loaded(values) for each, (values, _) in zip(ranges, gauss, strict=True)]
        self._weights = [np.tile(weights / len(each.rest), len(each.rest)) for each, (_, weights) in zip(ranges, gauss, strict=True)]
        self._starts = np.cumsum([0, *(len(load) for _, load in places)])
        places += [each.loaded(each.dense(_STEPS)) for each in ranges]
        self._q, self._load = (np.concatenate(parts) for parts in zip(*places, strict=True))
        self._last: tuple[bytes, Rest] | None = None

    def _at(self, x: Reals) -> Rest:
        key = x.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, self._statics.at(self._q, self._load, x)
        return self._last[1]

    def moments(self, number: int, x: Reals) -> Moments:
        """Of one range, by its number."""
        rows, joint, found = slice(self._starts[number], self._starts[number + 1]), self._ranges[number].joint, self._at(x)
        return Moments(found.moments[rows, joint], found.moments_slopes[rows, joint], self._weights[number])

    def lengths(self, x: Reals) -> tuple[Reals, Reals]:
        """Of every spring over all ranges [m, springs] (m), and slopes [m, springs, n]."""
        found = self._at(x)
        return found.lengths[self._starts[-1] :], found.lengths_slopes[self._starts[-1] :]

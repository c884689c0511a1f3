"""Poses of many sets of one topology by scipy, on the wanted sides: from random starts, and from where another method ends."""

import numpy as np

from linkages.by_scipy import Plane
from linkages.closure import Closure, apart

BESIDE = (1e-2, 1e-4, 1e-6, 0)
"""How far from another method's pose scipy starts, in sizes, until it comes to one that is wanted."""
NEAR = 1e-12


class Sought:
    """What scipy finds; `alone` counts the sets whose pose it came to from random starts, `exact` those that 40 digits had to tell."""

    def __init__(self, text, sides, dimensions, drives, random):
        self._text, self._sides, self._dimensions, self._drives = text, sides, dimensions, drives
        self._plane, self._random, self.alone, self.exact = Plane(text), random, 0, 0

    def pose(self, row, starts, guess):
        """On the wanted sides; None where neither a random start nor the guess, if that is a number, leads to one."""
        for _ in range(starts):
            found = self._wanted(row, self._plane.closed(*self._set(row), self._start(len(guess))))
            if found is not None:
                self.alone += 1
                return found
        for beside in BESIDE if np.isfinite(guess).all() else ():
            away = beside * max(1, np.abs(guess).max()) * self._random.normal(size=len(guess))
            found = self._wanted(row, self._plane.closed(*self._set(row), guess + away))
            if found is not None:
                return found
        return None

    def polished(self, row, pose):
        """To all digits."""
        self.exact += 1
        return self._plane.exact(*self._set(row), pose)

    def nearer(self, row, found, own):
        """Of scipy's pose and the same to all digits the one that tells: scipy's where it is as good as that."""
        return found if apart(own, found) <= NEAR * max(1, np.abs(found).max()) else self.polished(row, found)

    def _set(self, row):
        return self._dimensions[row], self._drives[row]

    def _wanted(self, row, found):
        if found is None:
            return None
        one = slice(row, row + 1)
        return found if Closure(self._text, self._dimensions[one], self._drives[one]).as_wanted(found[None], self._sides)[0] else None

    def _start(self, count):
        x = self._random.uniform(-1.5, 1.5, count)
        x[2::3] = self._random.uniform(-np.pi, np.pi, count // 3)
        return x

"""One linkage closed by scipy: every pair's equations in complex numbers, poses of all links the unknowns, none of walkgen's tables."""

import cmath
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath.ctx_mp import MPContext
from scipy.optimize import root

CLOSED, MOST = 1e-11, 300
"""What scipy's method may leave where it says that it is there; how often it may ask for the equations."""
CONTEXT = MPContext()
CONTEXT.dps = 40


@dataclass(frozen=True)
class Numbers:
    """What complex numbers are made by, of parts or of radius and angle, and their angles."""

    complex: Callable[..., Any]
    rect: Callable[..., Any]
    phase: Callable[..., Any]


DOUBLE, EXACT = Numbers(complex, cmath.rect, cmath.phase), Numbers(CONTEXT.mpc, CONTEXT.rect, CONTEXT.arg)


class Plane:
    """The tables of a spec's leg design, read once for any number of dimensions and drives.

    Unknowns are x, y and angle of every link but the frame, in the order of the tables.
    """

    def __init__(self, text):
        tables = tomllib.loads(text)
        self._design = next(iter(tables["leg_designs"].values()))
        self._names = list(tables.get("parameters", ()))
        self.links = ["frame", *(name for name in self._design["links"] if name != "frame")]

    def equations(self, dimensions, drives, numbers=DOUBLE):
        """The residuals of a list of unknowns, for one set."""
        values, left = dict(zip(self._names, map(float, dimensions), strict=True)), list(map(float, drives))
        pairs = [*self._pins(values, left, numbers), *self._sliders(values, left, numbers), *self._cylinders(values, left)]
        assert not left
        count = len(self.links)

        def residuals(x):
            at = [0j, *(numbers.complex(x[3 * link], x[3 * link + 1]) for link in range(count - 1))]
            turn = [1 + 0j, *(numbers.rect(1, x[3 * link + 2]) for link in range(count - 1))]
            return [entry for pair in pairs for entry in pair(at, turn)]

        return residuals

    def _point(self, text, values):
        link, _, name = text.partition(".")
        return self.links.index(link), _complex(self._design["links"][link]["points"][name], values)

    def _pins(self, values, left, numbers):
        for pin in self._design.get("pins", ()):
            (base, p), *others = [self._point(text, values) for text in pin["joins"]]
            yield from (_pinned(base, p, link, q) for link, q in others)
            if pin.get("driven"):
                yield _turned(base, others[0][0], numbers.rect(1, left.pop(0)), numbers)

    def _sliders(self, values, left, numbers):
        for slider in self._design.get("sliders", ()):
            (runner, p), guide = self._point(slider["link"], values), slider["guide"]
            base, start = self.links.index(guide["link"]), _complex(guide["point"], values)
            along = numbers.rect(1, _number(guide["angle"], values))
            yield _turned(base, runner, 1 + 0j, numbers)
            yield _guided(base, start, along, runner, p, left.pop(0) if slider.get("driven") else None)

    def _cylinders(self, values, left):
        for cylinder in self._design.get("cylinders", ()):
            (base, p), (link, q) = (self._point(text, values) for text in cylinder["between"])
            yield _apart(base, p, link, q, left.pop(0))

    def closed(self, dimensions, drives, x):
        """The pose that scipy finds from a start, None where it finds none; from there once more, so that the last steps are Newton's."""
        residuals = self.equations(dimensions, drives)
        found = root(residuals, x, method="hybr", options={"xtol": 1e-13, "maxfev": MOST})
        if np.abs(found.fun).max() > 1e-6:
            return None
        found = root(residuals, found.x, method="hybr", options={"xtol": 1e-15})
        return found.x if np.abs(found.fun).max() < CLOSED * max(1.0, np.abs(found.x).max()) else None

    def exact(self, dimensions, drives, x):
        """The pose beside one that nearly closes, by Newton's method in 40 digits; None where it does not get there."""
        residuals = self.equations(dimensions, drives, EXACT)
        try:
            found = CONTEXT.findroot(lambda *own: residuals(own), [CONTEXT.mpf(float(entry)) for entry in x], tol=1e-50)
        except (ValueError, ZeroDivisionError):
            return None
        return np.array([float(entry) for entry in found])

    def reaches(self, dimensions, drives, foot, target, random, starts):
        """Whether from one of some random starts a pose closes that has its foot on the target."""
        link, point = self._point(foot, dict(zip(self._names, map(float, dimensions), strict=True)))
        for _ in range(starts):
            x = random.uniform(-1.5, 1.5, 3 * (len(self.links) - 1))
            x[2::3] = random.uniform(-np.pi, np.pi, len(x) // 3)
            x = self.closed(dimensions, drives, x)
            if x is not None:
                at = complex(*x[3 * link - 3 : 3 * link - 1]) + cmath.rect(1.0, x[3 * link - 1]) * point
                if abs(at - complex(*target)) < 1e-9:
                    return True
        return False


def _number(entry, values):
    return values[entry] if isinstance(entry, str) else float(entry)


def _complex(entries, values):
    return complex(*(_number(entry, values) for entry in entries))


def _pinned(base, p, link, q):
    def pair(at, turn):
        gap = at[link] + turn[link] * q - at[base] - turn[base] * p
        return gap.real, gap.imag

    return pair


def _turned(base, link, wanted, numbers):
    """Half turns off are no solutions: the second link's direction seen from the first, less the wanted one, on one side."""

    def pair(at, turn):
        del at
        return (numbers.phase(turn[link] * turn[base].conjugate() * wanted.conjugate()),)

    return pair


def _guided(base, start, along, runner, p, drive):
    def pair(at, turn):
        way = (at[runner] + turn[runner] * p - at[base] - turn[base] * start) * (turn[base] * along).conjugate()
        return (way.imag,) if drive is None else (way.imag, way.real - drive)

    return pair


def _apart(base, p, link, q, length):
    def pair(at, turn):
        return (abs(at[link] + turn[link] * q - at[base] - turn[base] * p) - length,)

    return pair

"""The assembly modes of a linkage whose triads are not closed by drives or foot alone: all of them at given values.

The roots of a polynomial are the modes of a triad, at most six, with Newton's method from a lattice of unknowns for dimensions so special
that there is no polynomial.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from walkgen.model.sliding import slid, unslid
from walkgen.model.walk import CONTEXT
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.closure import Closing
from walkgen.symbolic.planar import Planar
from walkgen.symbolic.tape_values import tape_values, value
from walkgen.symbolic.triad_roots import roots

Reals = NDArray[np.float64]
_ANGLES, _WAYS = 16, (-8.0, -4.0, -2.0, -1.0, -0.5, -0.2, 0.1, 0.3, 0.7, 1.5, 3.0, 6.0)
_STEPS, _STRIDE, _CLOSED, _APART, _FAR = 40, 0.5, 1e-10, 1e-6, 1e3


@dataclass(frozen=True)
class AssemblyMode:
    """Unknowns of a configuration, the least sine of its groups' transmission angles, how badly it meets hints, and the angles to the frame
    of a ternary link of every triad.
    """

    unknowns: tuple[float, ...]
    sine: float
    misfit: float
    degrees: tuple[float, ...]


@dataclass(frozen=True)
class Hint:
    """About where a point of a body lies (m), or about which angle a body has; `size` is that of the linkage."""

    body: int
    point: Planar | None
    wanted: tuple[float, ...]
    size: float

    def told(self, closing: Closing) -> Planar:
        """Where the point is, or the cosine and sine of the angle."""
        pose = closing.placing.pose(self.body)
        return pose.rotor if self.point is None else pose.point(self.point)

    def square(self, told: Sequence[float]) -> float:
        """How far it is from being met, in units of the size or rad, squared."""
        if self.point is None:
            return float(np.hypot(told[0] - np.cos(self.wanted[0]), told[1] - np.sin(self.wanted[0])) ** 2)
        return float(np.hypot(*np.subtract(told, self.wanted)) / self.size) ** 2


class AssemblyModes:
    """Of one linkage, for any values of what it is closed for.

    Args:
        closing: its closure.
        hints: which mode is meant.
    """

    def __init__(self, closing: Closing, hints: Sequence[Hint] = ()) -> None:
        self._closing, self._hints, self._count = closing, hints, len(closing.unknowns)
        self._triads, placing = closing.placing.order.triads, closing.placing
        margins = [margin.value for margin in placing.margins]
        told = [entry for hint in hints for entry in hint.told(closing)]
        told += [entry for triad in self._triads for entry in placing.pose(max(triad.ends)).rotor]
        slopes = [entry for row in closing.slopes for entry in row]
        self._closure = self._compiled([*closing.residuals, *slopes])
        self._told = self._compiled([sympy.Min(*margins), *told])
        self._shapes = [self._compiled([entry for planar in shape for entry in planar]) for shape in placing.shapes]

    def _compiled(self, outputs: Sequence[sympy.Expr]) -> Any:
        return compiled(self._closing.tape, (*self._closing.given, *self._closing.unknowns), outputs)

    def at(self, given: Sequence[float]) -> list[AssemblyMode]:
        """Every mode at these values; the one that is meant first."""
        found: list[tuple[float, ...]] = [()]
        for number in range(len(self._triads)):
            found = [(*known, *more) for known in found for more in self._closed(given, known, number)]
        modes = [mode for unknowns in found if (mode := self._mode(given, unknowns))]
        return sorted(modes, key=lambda one: (one.misfit, -one.sine, one.unknowns))

    def exact(self, given: Sequence[Any], unknowns: Sequence[float]) -> list[Any]:
        """A mode's unknowns to 50 digits."""
        exact, names = [CONTEXT.mpf(number) for number in unknowns], (*self._closing.given, *self._closing.unknowns)
        for _ in range(4):
            known = tape_values(self._closing.tape, dict(zip(names, (*given, *exact), strict=True)))
            slopes = CONTEXT.matrix([[value(entry, known) for entry in row] for row in self._closing.slopes])
            step = CONTEXT.lu_solve(slopes, CONTEXT.matrix([value(residual, known) for residual in self._closing.residuals]))
            exact = [unknown - change for unknown, change in zip(exact, step, strict=True)]
        return exact

    def _closed(self, given: Sequence[float], known: tuple[float, ...], number: int) -> list[tuple[float, ...]]:
        """Unknowns of one triad, those of the triads before it known."""
        kinds = self._kinds(number)[0]
        axes = [np.linspace(-np.pi, np.pi, _ANGLES, endpoint=False) if kind == "R" else unslid(np.array(_WAYS)) for kind in kinds]
        u = np.concatenate([self._roots(given, known, number), np.array(list(product(*axes))).T], -1)
        turning = np.array([kind == "R" for kind in kinds])[:, None]
        for _ in range(_STEPS):
            r, slopes = self._evaluated(given, known, u, number)
            step = _solved(slopes, r)
            u = u - step / np.maximum(1.0, np.abs(step).max(0) / _STRIDE)
        r, _ = self._evaluated(given, known, u, number)
        size = np.where(turning, 1.0, np.hypot(1.0, slid(u))).max(0)
        u = np.where(turning, np.angle(np.exp(1j * u)), u)[:, (np.abs(r).max(0) < _CLOSED * size**2) & (size < _FAR)]
        return _apart(u, turning[:, 0])

    def _kinds(self, number: int) -> list[str]:
        """Of a triad's struts."""
        kind = self._closing.placing.kind
        return ["".join(kind(pair) for pair in strut.pairs) for strut in self._triads[number].struts]

    def _roots(self, given: Sequence[float], known: tuple[float, ...], number: int) -> Reals:
        """Of a triad's polynomial."""
        kinds = self._kinds(number)
        turning = np.array([kind == "R" for kind in kinds[0]])[:, None]

        def evaluate(moved: Reals) -> Any:
            u, later = np.where(turning, moved, unslid(moved)), np.zeros((self._count - len(known) - 2, moved.shape[1]))
            entries = np.array([np.broadcast_to(entry, u.shape[1:]) for entry in self._shapes[number](*given, *known, *u, *later)])
            return entries[::2] + 1j * entries[1::2]

        with np.errstate(all="ignore"):
            found = roots(kinds, evaluate)
        return np.where(turning, found, unslid(found))

    def _evaluated(self, given: Sequence[float], known: tuple[float, ...], u: Reals, number: int) -> tuple[Reals, Reals]:
        """Residuals [2, n] and slopes [2, 2, n] of one triad."""
        later = np.zeros((self._count - len(known) - 2, u.shape[1]))
        with np.errstate(all="ignore"):
            values = [np.broadcast_to(entry, u.shape[1:]) for entry in self._closure(*given, *known, *u, *later)]
        rows, slopes = range(2 * number, 2 * number + 2), values[self._count :]
        own = [[slopes[self._count * row + column] for column in rows] for row in rows]
        return np.array([values[row] for row in rows]), np.array(own)

    def _mode(self, given: Sequence[float], unknowns: tuple[float, ...]) -> AssemblyMode | None:
        with np.errstate(all="ignore"):
            margin, *told = (float(entry) for entry in self._told(*given, *unknowns))
        pairs = list(zip(told[::2], told[1::2], strict=True))
        misfit = sum(hint.square(pair) for hint, pair in zip(self._hints, pairs, strict=False))
        degrees = tuple(math.degrees(math.atan2(sine, cosine)) for cosine, sine in pairs[len(self._hints) :])
        return AssemblyMode(unknowns, math.sqrt(margin), misfit, degrees) if margin > 0 else None  # not where a later dyad cannot close


def _solved(slopes: Reals, r: Reals) -> Reals:
    """(dr/du)^-1 r by Cramer's rule, 0 where there is none."""
    (a, b), (c, d) = slopes
    determinant = a * d - b * c
    safe = np.where(np.abs(determinant) > 1e-14, determinant, np.inf)
    step: Reals = np.nan_to_num(np.array([(d * r[0] - b * r[1]) / safe, (a * r[1] - c * r[0]) / safe]))
    return step


def _apart(u: Reals, turning: NDArray[np.bool_]) -> list[tuple[float, ...]]:
    """Different columns, in order."""
    kept: list[Reals] = []
    for column in u.T:
        away = [np.where(turning, np.angle(np.exp(1j * (column - other))), column - other) for other in kept]
        if all(np.abs(one).max() > _APART for one in away):
            kept.append(column)
    return sorted(tuple(float(entry) for entry in column) for column in kept)

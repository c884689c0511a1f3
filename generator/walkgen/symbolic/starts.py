"""The configuration that triads are continued from: every assembly at the start's drive values, and the one that the spec means.

This is done once, when code is generated: the roots of a polynomial are the assemblies, at most six of a triad, with Newton's method from a
lattice of unknowns for dimensions so special that there is no polynomial; the start's hints choose one, 50 digits make it exact.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from walkgen.errors import Problem, UnsupportedMechanism
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.scalar import evaluate
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.closure import Closing, closing_at, point_parameters, point_port, unknowns_port
from walkgen.symbolic.planar import Planar
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.tape_values import tape_values, value
from walkgen.symbolic.triad_roots import roots

Reals = NDArray[np.float64]
_DIGITS = 20
_ANGLES, _WAYS = 16, (-8.0, -4.0, -2.0, -1.0, -0.5, -0.2, 0.1, 0.3, 0.7, 1.5, 3.0, 6.0)
_STEPS, _STRIDE, _CLOSED, _APART, _FAR = 40, 0.5, 1e-10, 1e-6, 1e3
_FRACTIONS = (0.5, 0.375, 0.625, 0.25, 0.75, 0.125, 0.875, 0.0, 1.0)
_TURNS = (0, 3, -3, 6, -6, 1, -1, 2, -2, 4, -4, 5, -5)
"""Sixths of half a turn."""
_STRETCHES = (1.0, 0.8, 1.25, 0.6, 1.5, 0.4, 2.0)
_MOST_CANDIDATES = 40


@dataclass(frozen=True)
class Assembly:
    """Unknowns of a configuration, the least sine of its groups' transmission angles, how badly it meets the start's hints, and the angles
    to the frame of a ternary link of every triad.
    """

    unknowns: tuple[float, ...]
    sine: float
    misfit: float
    degrees: tuple[float, ...]


@dataclass(frozen=True)
class FoundStart:
    """Drives, parameters that matter and unknowns, 20 digits; the sign of every triad's determinant; all assemblies, the chosen first."""

    drives: tuple[Decimal, ...]
    parameters: tuple[Decimal, ...]
    unknowns: tuple[Decimal, ...]
    senses: tuple[int, ...]
    assemblies: tuple[Assembly, ...]


def found_start(mechanism: Mechanism, leg: Limb) -> FoundStart:
    """Of a leg whose linkage has triads.

    Raises:
        UnsupportedMechanism: no assembly is found (WG189).
    """
    found = start_of(mechanism, leg)
    if found is None:
        triads = ", ".join(triad.name for triad in leg.linkage.forward.triads) if leg.linkage else ""
        message = f"leg {leg.name}: the triad {triads} has no assembly at the start"
        raise UnsupportedMechanism(Problem("WG189", message, "mend the lengths that it joins, or give start other drives"))
    return found


@cache
def start_of(mechanism: Mechanism, leg: Limb) -> FoundStart | None:
    """The same, None where no assembly is found."""
    assemblies = Assemblies(mechanism, leg)
    for drives in assemblies.candidates():
        found = assemblies.at([float(number) for number in (*drives, *assemblies.parameters)])
        if found:
            return assemblies.start(drives, found)
    return None


class Assemblies:
    """All ways in which a linkage's triads close.

    Args:
        mechanism: the robot.
        leg: one whose linkage has triads.
    """

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        assert leg.linkage is not None
        self._leg, self._linkage, self._values = leg, leg.linkage, defaults(mechanism)
        self.names = tuple(point_parameters(mechanism, leg))
        self.parameters = [self._values[name] for name in self.names]
        self._symbols = symbols_of(point_port(mechanism, leg))
        self._count = unknowns_port(leg).size
        self._closing = closing_at(mechanism, leg, self._symbols[: -self._count], self._symbols[-self._count :], Tape())
        self._hints = list(self._hinted())
        margins = [margin.value for margin in self._closing.placing.margins]
        pose = self._closing.placing.pose
        told = [entry for hint in self._hints for entry in hint.told(self._closing)]
        told += [entry for triad in self._linkage.forward.triads for entry in pose(max(triad.ends)).rotor]
        slopes = [entry for row in self._closing.slopes for entry in row]
        self._closure = compiled(self._closing.tape, self._symbols, [*self._closing.residuals, *slopes])
        self._told = compiled(self._closing.tape, self._symbols, [sympy.Min(*margins), *told])
        shapes = [[entry for planar in shape for entry in planar] for shape in self._closing.placing.shapes]
        self._shapes = [compiled(self._closing.tape, self._symbols, shape) for shape in shapes]

    def _hinted(self) -> Iterator["Hint"]:
        size, planar = float(self._number(self._linkage.size)), self._closing.placing.planar
        for body, point, at in self._linkage.start.points:
            yield Hint(body, planar(point), tuple(float(self._number(entry)) for entry in at), size)
        for body, angle in self._linkage.start.angles:
            yield Hint(body, None, (float(self._number(angle)),), size)

    def _number(self, scalar: Any) -> Any:
        return evaluate(scalar, CONTEXT, self._values)

    def candidates(self) -> Iterator[tuple[Any, ...]]:
        """Values of the drives to start from: the spec's, else the middles of their limits and places around."""
        if self._linkage.start.drives:
            yield tuple(self._number(drive) for drive in self._linkage.start.drives)
            return
        options = [self._options(joint) for joint in self._leg.joints[len(self._leg.serial) :]]
        ranked = sorted(product(*(range(len(own)) for own in options)), key=lambda places: (sum(places), places))
        for places in ranked[:_MOST_CANDIDATES]:
            yield tuple(own[place] for own, place in zip(options, places, strict=True))

    def _options(self, joint: Joint) -> list[Any]:
        if joint.limits is not None:
            low, high = (self._number(limit) for limit in joint.limits)
            return [low + (high - low) * CONTEXT.mpf(fraction) for fraction in _FRACTIONS]
        if joint.kind == "revolute":
            return [CONTEXT.pi * sixths / 6 for sixths in _TURNS]
        return [self._number(self._linkage.size) * CONTEXT.mpf(str(stretch)) for stretch in _STRETCHES]

    def at(self, given: Sequence[float]) -> list[Assembly]:
        """Every one that a lattice of unknowns leads to, for drives and the parameters that matter; the one that is meant first."""
        found: list[tuple[float, ...]] = [()]
        for number in range(len(self._linkage.forward.triads)):
            found = [(*known, *more) for known in found for more in self._closed(given, known, number)]
        known = [assembly for unknowns in found if (assembly := self._assembly(given, unknowns))]
        return sorted(known, key=lambda one: (one.misfit, -one.sine, one.unknowns))

    def _closed(self, given: Sequence[float], known: tuple[float, ...], number: int) -> list[tuple[float, ...]]:
        """Unknowns of one triad, those of the triads before it known."""
        kinds = self._kinds(number)[0]
        axes = [np.linspace(-np.pi, np.pi, _ANGLES, endpoint=False) if kind == "R" else np.array(_WAYS) for kind in kinds]
        u = np.concatenate([self._roots(given, known, number), np.array(list(product(*axes))).reshape(-1, 2).T], -1)
        turning = np.array([kind == "R" for kind in kinds])[:, None]
        for _ in range(_STEPS):
            r, slopes = self._evaluated(given, known, u, number)
            step = _solved(slopes, r)
            u = u - step / np.maximum(1.0, np.abs(step).max(0) / _STRIDE)
        r, _ = self._evaluated(given, known, u, number)
        size = np.where(turning, 1.0, np.hypot(1.0, u)).max(0)
        u = np.where(turning, np.angle(np.exp(1j * u)), u)[:, (np.abs(r).max(0) < _CLOSED * size**2) & (size < _FAR)]
        return _apart(u, turning[:, 0])

    def _kinds(self, number: int) -> list[str]:
        """Of a triad's struts."""
        kind = self._closing.placing.kind
        return ["".join(kind(pair) for pair in strut.pairs) for strut in self._linkage.forward.triads[number].struts]

    def _roots(self, given: Sequence[float], known: tuple[float, ...], number: int) -> Reals:
        """Of a triad's polynomial."""

        def evaluate(u: Reals) -> Any:
            later = np.zeros((self._count - len(known) - 2, u.shape[1]))
            x = np.array([np.broadcast_to(entry, u.shape[1:]) for entry in self._shapes[number](*given, *known, *u, *later)])
            return x[::2] + 1j * x[1::2]

        with np.errstate(all="ignore"):
            return roots(self._kinds(number), evaluate)

    def _evaluated(self, given: Sequence[float], known: tuple[float, ...], u: Reals, number: int) -> tuple[Reals, Reals]:
        """Residuals [2, n] and slopes [2, 2, n] of one triad."""
        later = np.zeros((self._count - len(known) - 2, u.shape[1]))
        with np.errstate(all="ignore"):
            values = [np.broadcast_to(entry, u.shape[1:]) for entry in self._closure(*given, *known, *u, *later)]
        rows, slopes = range(2 * number, 2 * number + 2), values[self._count :]
        own = [[slopes[self._count * row + column] for column in rows] for row in rows]
        return np.array([values[row] for row in rows]), np.array(own)

    def _assembly(self, given: Sequence[float], unknowns: tuple[float, ...]) -> Assembly | None:
        with np.errstate(all="ignore"):
            margin, *told = (float(entry) for entry in self._told(*given, *unknowns))
        pairs = list(zip(told[::2], told[1::2], strict=True))
        misfit = sum(hint.square(pair) for hint, pair in zip(self._hints, pairs, strict=False))
        degrees = tuple(math.degrees(math.atan2(sine, cosine)) for cosine, sine in pairs[len(self._hints) :])
        return Assembly(unknowns, math.sqrt(margin), misfit, degrees) if margin > 0 else None  # not where a later dyad cannot close

    def start(self, drives: tuple[Any, ...], assemblies: Sequence[Assembly]) -> FoundStart:
        """The first of the assemblies, to 50 digits."""
        given = (*drives, *self.parameters)
        unknowns = [CONTEXT.mpf(number) for number in assemblies[0].unknowns]
        for _ in range(4):
            known = tape_values(self._closing.tape, dict(zip(self._symbols, (*given, *unknowns), strict=True)))
            slopes = CONTEXT.matrix([[value(entry, known) for entry in row] for row in self._closing.slopes])
            step = CONTEXT.lu_solve(slopes, CONTEXT.matrix([value(residual, known) for residual in self._closing.residuals]))
            unknowns = [unknown - change for unknown, change in zip(unknowns, step, strict=True)]
        pairs = range(0, self._count, 2)
        senses = tuple(int(CONTEXT.sign(slopes[i, i] * slopes[i + 1, i + 1] - slopes[i, i + 1] * slopes[i + 1, i])) for i in pairs)
        numbers = [tuple(Decimal(CONTEXT.nstr(number, _DIGITS)) for number in part) for part in (drives, self.parameters, unknowns)]
        return FoundStart(numbers[0], numbers[1], numbers[2], senses, tuple(assemblies))


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

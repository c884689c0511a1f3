"""Where the bodies of a linkage are, by Newton's method on its loops in 50 digits: on the sides of its dyads, or from a triad's start."""

import math
import random
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

from walkgen.model.linkage import Linkage
from walkgen.model.loops import DrivenLoops
from walkgen.model.sliding import unslid
from walkgen.model.walk import CONTEXT
from walkgen.spec.assur import SIDES, Group
from walkgen.spec.pair_equations import Planar, Row
from walkgen.spec.scalar import evaluate

_STARTS, _MOST_STARTS, _STEPS, _HALVINGS = 300, 3000, 40, 5
_CLOSED, _EXACT = 1e-12, CONTEXT.mpf(10) ** -46
_TOLD = ("RRR", "RRP", "RPP")
"""Groups of which there is one on each side."""
_LIKE, _FIRST_STEP, _LEAST_STEP, _CHANGE = 1e-6, 1 / 32, 1e-5, 0.1
_DIGITS = 9
"""Drives that agree to so many decimal places start from one pose."""


@dataclass(frozen=True)
class Posture:
    """A linkage whose loops are closed: `x` holds x, y and angle of every body but the frame."""

    loops: DrivenLoops
    x: tuple[Any, ...]

    def place(self, body: int, point: Planar) -> tuple[Any, Any, Any]:
        """A body's point in the frame's axes, and its angle."""
        return (*self.loops.seen(self.x, body, point).at, self.loops.angle(self.x, body))

    def slopes(self, body: int, point: Planar) -> list[tuple[Any, Any, Any]]:
        """Of `place`, by every drive."""
        rows = (*self.loops.seen(self.x, body, point).slopes, {3 * body - 1: CONTEXT.mpf(1)} if body else {})
        columns = [[sum(slope * self._by_drives[at][drive] for at, slope in row.items()) for row in rows] for drive in self._drives]
        return [(x, y, angle) for x, y, angle in columns]

    @property
    def _drives(self) -> range:
        return range(len(self.loops.drives))

    @cached_property
    def _by_drives(self) -> list[list[Any]]:
        """Slopes of all unknowns: the equations hold while the drives move."""
        rows = [row for _, row in self.loops.equations(self.x)]
        solved = _solved(rows, self.loops.size)
        assert solved is not None
        return [[-row.get(self.loops.size + drive, CONTEXT.zero) for drive in self._drives] for row in solved]

    def pin(self, pair: int) -> Planar:
        """Where a pair is, in the frame's axes."""
        return self.loops.end(self.x, pair, 0).at

    def transmission(self, group: Group) -> Any:
        """The angle of a dyad that has two sides: positive on its first, 0 and pi at its dead points."""
        if group.kind == "RRR":
            p, q, inner = (self.pin(pair) for pair in group.pairs)
            a, b = ((p[0] - inner[0], p[1] - inner[1]), (q[0] - inner[0], q[1] - inner[1]))
            return CONTEXT.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1])
        slider = next(pair for pair in group.pairs if self.loops.linkage.structure.pairs[pair].kind == "P")
        runner, guide = self._rod(group, slider)
        rod, along = (runner[0] - guide[0], runner[1] - guide[1]), self.loops.guide(self.x, slider)
        return CONTEXT.atan2(rod[0] * along[0] + rod[1] * along[1], rod[1] * along[0] - rod[0] * along[1])

    def _rod(self, group: Group, slider: int) -> tuple[Planar, Planar]:
        """The pins on the side of the slider's runner and of its guide."""
        on_base, on_second, between = group.pairs
        pairs_of = ((on_base, on_second), (on_base, between), (on_second, between))
        guide = next(pair for pair in pairs_of[group.guide] if pair != slider)
        runner = next(pair for pair in group.pairs if pair not in (slider, guide))
        return self.pin(runner), self.pin(guide)

    @property
    def angles(self) -> list[Any]:
        """Transmission angles of the dyads that have sides, in the order of placement."""
        return [self.transmission(group) for group in self.loops.linkage.forward.dyads if SIDES[group.kind]]

    @property
    def as_stated(self) -> bool:
        """Whether every dyad is on the side that the spec says."""
        linkage = self.loops.linkage
        sides = [linkage.side(group) for group in linkage.forward.dyads if SIDES[group.kind]]
        return all(side * angle > 0 for side, angle in zip(sides, self.angles, strict=True))


@dataclass(frozen=True)
class KnownStart:
    """Where triads are continued from: the drives, and the unknowns of every triad: of its first strut's pins the angle (rad)."""

    drives: tuple[float, ...]
    unknowns: tuple[float, ...]


def closed(linkage: Linkage, values: Mapping[str, Any], drives: Sequence[Any], start: KnownStart | None = None) -> Posture | None:
    """The posture in 50 digits: on the spec's sides, or what the start moves to; None where there is none, or nothing tells which it is."""
    if start is None and any(group.kind not in _TOLD for group in linkage.forward.groups):
        return None
    near = tuple(round(float(drive), _DIGITS) for drive in drives)
    found = _found(linkage, tuple(values.items()), near) if start is None else _continued(linkage, tuple(values.items()), near, start)
    return found and _exact(linkage, values, drives, found.x)


@cache
def _started(linkage: Linkage, values: tuple[tuple[str, Any], ...], start: KnownStart) -> list[float] | None:
    """Poses of a start, from random ones."""
    loops, generator = DrivenLoops(linkage, dict(values), start.drives, float), random.Random(len(start.drives))  # noqa: S311
    for _ in range(_MOST_STARTS):
        x = _descended(loops, _start(loops, generator))
        if x is not None and _is_start(loops, x, start):
            return x
    return None


def _is_start(loops: DrivenLoops, x: list[float], start: KnownStart) -> bool:
    pairs = zip(_measured(loops, x), start.unknowns, strict=True)
    return all(abs(math.remainder(own - known, math.tau)) < _LIKE for own, known in pairs)


def _measured(loops: DrivenLoops, x: list[float]) -> Iterator[float]:
    """The unknowns of all triads."""
    linkage = loops.linkage
    for triad in linkage.forward.triads:
        strut = triad.struts[0]
        own = linkage.forward.rigid_before(triad, strut.body)
        for end, index in zip(triad.ends, strut.pairs, strict=True):
            pair, beyond = linkage.structure.pairs[index], linkage.forward.rigid_before(triad, end)
            if pair.kind == "P":
                yield float(unslid(loops.along(x, index)[0] / float(evaluate(linkage.size, CONTEXT, loops.values))))
            else:
                base, moved = (next(body for body in pair.bodies if body in bodies) for bodies in (beyond, own))
                yield loops.angle(x, moved) - loops.angle(x, base)


@cache
def _continued(linkage: Linkage, values: tuple[tuple[str, Any], ...], drives: tuple[float, ...], start: KnownStart) -> Posture | None:
    """What a start moves to."""
    own = _started(linkage, values, start)
    x = own and _led(linkage, dict(values), own, start.drives, drives)
    posture = x and Posture(DrivenLoops(linkage, dict(values), drives, float), tuple(x))
    return posture if posture and posture.as_stated else None


def _led(
    linkage: Linkage, values: Mapping[str, Any], x: list[float], begin: Sequence[float], drives: Sequence[float]
) -> list[float] | None:
    """Poses while the drives go straight to their values, turning ones the shorter way, in steps that change little."""
    turning = [linkage.structure.pairs[pair].kind == "R" for pair in linkage.driven] + [False] * len(linkage.structure.bars)
    spans = zip((end - own for own, end in zip(begin, drives, strict=True)), turning, strict=True)
    ways = [math.remainder(span, math.tau) if turns else span for span, turns in spans]
    part, step = 0.0, _FIRST_STEP
    while part < 1:
        further = min(part + step, 1.0)
        loops = DrivenLoops(linkage, values, [own + further * way for own, way in zip(begin, ways, strict=True)], float)
        tried = _descended(loops, x)
        if tried is not None and max(abs(a - b) for a, b in zip(tried, x, strict=True)) < _CHANGE * max(1.0, loops.reach):
            x, part, step = tried, further, 2 * step
        else:
            step /= 2
        if step < _LEAST_STEP:
            return None
    return x


@cache
def _found(linkage: Linkage, values: tuple[tuple[str, Any], ...], drives: tuple[float, ...]) -> Posture | None:
    """Followed from a posture found before, else searched for."""
    known = _known(linkage, values)
    posture = next(filter(None, (_followed(before, linkage, dict(values), drives) for before in known)), None)
    posture = posture or _searched(linkage, dict(values), drives)
    if posture:
        known.append(posture)
    return posture


@cache
def _known(linkage: Linkage, values: tuple[tuple[str, Any], ...]) -> deque[Posture]:
    """The last postures found of a linkage: a search costs a hundred times what following one of them does."""
    del linkage, values
    return deque(maxlen=2)


def _followed(before: Posture, linkage: Linkage, values: Mapping[str, Any], drives: Sequence[float]) -> Posture | None:
    """What another posture moves to, should it be on the spec's sides."""
    begin = [float(drive) for drive in before.loops.drives]
    x = _led(linkage, values, [float(entry) for entry in before.x], begin, drives)
    posture = x and _exact(linkage, values, drives, x)
    return posture if posture and posture.as_stated else None


def _searched(linkage: Linkage, values: Mapping[str, Any], drives: Sequence[float]) -> Posture | None:
    """From random starts, until one is as the spec says; where the loops close at all, which some of few starts shows, from many more."""
    loops, generator = DrivenLoops(linkage, values, drives, float), random.Random(len(drives))  # noqa: S311 (starts, not secrets)
    closes = False
    for start in range(_MOST_STARTS):
        x = _descended(loops, _start(loops, generator)) if closes or start < _STARTS else None
        closes |= x is not None
        posture = x and _exact(linkage, values, drives, x)
        if posture and posture.as_stated:
            return posture
    return None


def _start(loops: DrivenLoops, generator: random.Random) -> list[float]:
    size = 1.5 * loops.reach
    spans = (size, size, CONTEXT.pi)
    return [generator.uniform(-float(spans[place % 3]), float(spans[place % 3])) for place in range(loops.size)]


def _descended(loops: DrivenLoops, x: list[float]) -> list[float] | None:
    """Newton's method with steps that lessen the residual."""
    size = _residual(loops, x)
    for _ in range(_STEPS):
        if size < _CLOSED * max(1.0, loops.reach):
            return x
        step = _step(loops, x)
        trials = ([a + b / 2**halving for a, b in zip(x, step, strict=True)] for halving in range(_HALVINGS)) if step else iter(())
        better = next(((trial, left) for trial in trials if (left := _residual(loops, trial)) < size), None)
        if better is None:
            return None
        x, size = better
    return None


def _exact(linkage: Linkage, values: Mapping[str, Any], drives: Sequence[Any], start: Sequence[Any]) -> Posture | None:
    """Newton's method to the last digit, from close by."""
    loops, x = DrivenLoops(linkage, values, drives), [CONTEXT.mpf(entry) for entry in start]
    for _ in range(8):
        step = _step(loops, x)
        if step is None:
            return None
        x = [a + b for a, b in zip(x, step, strict=True)]
        if max(abs(entry) for entry in step) < _EXACT:
            return Posture(loops, tuple(x))
    return None


def _residual(loops: DrivenLoops, x: Sequence[Any]) -> Any:
    return max(abs(value) for value, _ in loops.equations(x))


def _step(loops: DrivenLoops, x: Sequence[Any]) -> list[Any] | None:
    """Newton's, None where the slopes are singular."""
    right = loops.size + len(loops.drives)
    solved = _solved([row | {right: -value} for value, row in loops.equations(x)], loops.size)
    return None if solved is None else [row.get(right, loops.real(0)) for row in solved]


def _solved(rows: Sequence[Row], size: int) -> list[Row] | None:
    """Gauss and Jordan on sparse rows: row i holds what is right of unknown i; None where there is no pivot."""
    left, done = [dict(row) for row in rows], dict[int, Row]()
    for column in range(size):
        index = max(range(len(left)), key=lambda index: abs(left[index].get(column, 0)))
        pivot = left.pop(index)
        scale = pivot.get(column, 0)
        if scale == 0:
            return None
        pivot = {at: value / scale for at, value in pivot.items() if at > column}
        for row in (*left, *done.values()):
            factor = row.pop(column, 0)
            if factor:
                for at, value in pivot.items():
                    row[at] = row[at] - factor * value if at in row else -factor * value
        done[column] = pivot
    return [done[column] for column in range(size)]

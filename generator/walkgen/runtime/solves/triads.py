"""What closes the triads of a linkage, continued from a known assembly: the reference of walkgen_triads.h."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]
Truths = NDArray[np.bool_]
Callback = tuple[Callable[[Reals], Reals]]
"""The closure of points [..., z and u]: residuals [n], then their slopes by u, row by row."""

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR, _NO_CONVERGENCE = (
    STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE")
)
_ROUGH, _FINE, _LEAST_PART, _AT_THE_END = 1e-4, 1e-10, 1e-8, 1e-6
_TURNS, _STEPS = 16, 400
_FAR_OUT, _STEADY = 6.0, 0.02


def close_triads(unknowns: int, z: ArrayLike, start: ArrayLike, callback: Callback) -> tuple[Reals, Integers]:
    """The unknowns of a linkage's triads for its drives: the assembly that the start moves to while the drives go straight to z.

    Args:
        unknowns: how many, n.
        z: drives and parameters [..., k].
        start: a point where the linkage is assembled [..., k + n].
        callback: the closure.

    Returns:
        u [..., n] and status [...] as `approach`, but NaN unless the status is OK.
    """
    _, u, status = approach(unknowns, z, start, callback)
    return np.where((status == _OK)[..., None], u, np.nan), status


def approach(unknowns: int, z: ArrayLike, start: ArrayLike, callback: Callback) -> tuple[Reals, Reals, Integers]:
    """How far a linkage comes from its start on the straight way to z, and the unknowns of its triads there.

    Args:
        unknowns: how many, n.
        z: drives, or coordinates of a foot that is held, and parameters [..., k].
        start: a point where the linkage is assembled [..., k + n].
        callback: the closure.

    Returns:
        What was reached [..., k], z where the status [...] is OK, and u [..., n] there. UNREACHABLE where the linkage comes to a dead point
        on the way, or something before the triads does not assemble; SINGULAR where z is such a point; NO_CONVERGENCE where the start is no
        assembly, a slider runs off to infinity, or 400 steps were not enough; BAD_INPUT where z is not finite, with NaN.
    """
    given, point = np.asarray(z, float), np.asarray(start, float)
    shape = np.broadcast_shapes(given.shape[:-1], point.shape[:-1])
    rows, points = (np.broadcast_to(entry, (*shape, entry.shape[-1])).reshape(-1, entry.shape[-1]) for entry in (given, point))
    with np.errstate(all="ignore"):
        move = _Move(callback[0], points[:, :-unknowns], rows, points[:, -unknowns:].copy())
        status = move.status()
    bad = (status == _BAD_INPUT)[:, None]
    reached, u = np.where(bad, np.nan, move.way(move.part)), np.where(bad, np.nan, move.u)
    return reached.reshape(*shape, -1), u.reshape(*shape, unknowns), status.reshape(shape)


@dataclass
class _Tried:
    """Whether Newton's method converged at once, where, and with which determinant."""

    taken: Truths
    u: Reals
    determinant: Reals


class _Move:
    """All rows on their ways."""

    def __init__(self, closure: Callable[[Reals], Reals], start: Reals, z: Reals, u: Reals) -> None:
        self._closure, self._from, self._to, self.u = closure, start, z, u
        self.part, self._determinant = np.zeros(len(z)), np.zeros(len(z))
        self._slope = np.zeros_like(u)

    def status(self) -> Integers:
        """Of every row, once it is there or cannot go on."""
        count = len(self._to)
        status = np.where(np.isfinite(self._to).all(-1), _NO_CONVERGENCE, _BAD_INPUT).astype(np.int32)
        part, length, flight = self.part, np.ones(count), _Flight(count)
        first = self._newton(np.arange(count), part, np.full(count, _ROUGH), self.u)
        self.u, self._determinant = first.u, first.determinant
        going = first.taken & (status != _BAD_INPUT)
        for _ in range(_STEPS):
            rows = np.flatnonzero(going)
            if not len(rows):
                break
            further = np.minimum(part[rows] + length[rows], 1.0)
            taken = self._step(rows, part[rows], further)
            length[rows] = np.where(taken, 2.0, 0.25) * (further - part[rows])
            part[rows] = np.where(taken, further, part[rows])
            there, stuck = ~(part[rows] < 1.0), length[rows] < _LEAST_PART
            lost = taken & ~there & flight.runs_off(rows, part[rows], self.u[rows])
            ended = np.where(part[rows] > 1.0 - _AT_THE_END, _SINGULAR, _UNREACHABLE)
            status[rows] = np.where(there, _OK, np.where(stuck, ended, status[rows]))
            going[rows] = ~(there | stuck | lost)
        return status

    def way(self, part: Reals, rows: NDArray[np.intp] | slice = slice(None)) -> Reals:
        """Between start and end."""
        start, end = self._from[rows], self._to[rows]
        between: Reals = np.where(part[:, None] < 1.0, start + part[:, None] * (end - start), end)
        return between

    def _step(self, rows: NDArray[np.intp], part: Reals, further: Reals) -> Truths:
        """One step of some rows; those that take it are moved."""
        guess = self.u[rows] + (further - part)[:, None] * self._slope[rows]
        tried = self._newton(rows, further, np.where(further < 1.0, _ROUGH, _FINE), guess)
        change = tried.u - self.u[rows]
        taken: Truths = tried.taken & (np.abs(change).max(-1) <= 0.5) & _alike(tried.determinant, self._determinant[rows])
        taken &= self._passes(rows, part, further, tried)
        moved = rows[taken]
        self._slope[moved] = (change / (further - part)[:, None])[taken]
        self.u[moved], self._determinant[moved] = tried.u[taken], tried.determinant[taken]
        return taken

    def _passes(self, rows: NDArray[np.intp], part: Reals, further: Reals, tried: _Tried) -> Truths:
        """Whether the linkage gets from part to part: one correction leads there, one back, and halfway it is much the same."""
        start, end = self.u[rows], tried.u
        change, middle = np.abs(end - start).max(-1), start + 0.5 * (end - start)
        back, _ = self._leads(rows, part, end, start, change)
        on, _ = self._leads(rows, further, start, end, change)
        stays, between = self._leads(rows, part + 0.5 * (further - part), middle, middle, change)
        passes: Truths = back & on & stays & _alike(between, self._determinant[rows]) & _alike(between, tried.determinant)
        return passes

    def _leads(self, rows: NDArray[np.intp], part: Reals, start: Reals, end: Reals, change: Reals) -> tuple[Truths, Reals]:
        """Whether a correction of unknowns at a part of the way leads to others: it leaves at most half of the change. The determinant."""
        correction, determinant = self._correction(np.concatenate([self.way(part, rows), start], -1))
        left = np.abs(start - correction - end).max(-1)
        leads: Truths = (np.abs(determinant) > 0.0) & (left <= 0.5 * change + _ROUGH)
        return leads, determinant

    def _newton(self, rows: NDArray[np.intp], part: Reals, close: Reals, guess: Reals) -> _Tried:
        """Newton's method at a part of the way: each correction at most half of the one before, the first at most a quarter."""
        way = self.way(part, rows)
        u, last, taken = guess.copy(), np.full(len(rows), 0.5), np.zeros(len(rows), bool)
        determinant, going = np.zeros(len(rows)), np.ones(len(rows), bool)
        for _ in range(_TURNS):
            own = np.flatnonzero(going)
            if not len(own):
                break
            step, determinant[own] = self._correction(np.concatenate([way[own], u[own]], -1))
            size = np.abs(step).max(-1)
            u[own] -= step
            fine = (np.abs(determinant[own]) > 0.0) & ((size <= 0.5 * last[own]) | (size <= close[own]))
            taken[own], last[own] = fine & (size <= close[own]), size
            going[own] = fine & ~taken[own]
        return _Tried(taken, u, determinant)

    def _correction(self, points: Reals) -> tuple[Reals, Reals]:
        """(dr/du)^-1 r, NaN where there is none, and the determinant."""
        closure: Any = self._closure(points)
        count = self.u.shape[-1]
        r, slopes = closure[:, :count], closure[:, count:].reshape(-1, count, count)
        determinant = np.linalg.det(slopes)
        regular = np.isfinite(closure).all(-1) & (np.abs(determinant) > 0.0)
        slopes = np.where(regular[:, None, None], slopes, np.eye(count))
        step = np.linalg.solve(slopes, r[..., None])[..., 0]
        return np.where(regular[:, None], step, np.nan), np.where(regular, determinant, 0.0)


class _Flight:
    """How the farthest unknowns went out: which, at which parts one over their way was halved last, how fast it fell, for how many."""

    def __init__(self, count: int) -> None:
        self._unknown, self._alike = np.full(count, -1), np.zeros(count, int)
        self._part, self._inverse, self._rate = np.zeros(count), np.ones(count), np.zeros(count)

    def runs_off(self, rows: NDArray[np.intp], part: Reals, u: Reals) -> Truths:
        """Whether the farthest unknowns of rows run off to infinity before the ends of the ways, where one over their way goes to 0."""
        far = np.argmax(np.abs(u), axis=-1)
        most = np.take_along_axis(u, far[:, None], -1)[:, 0]
        out, inverse = np.abs(most) > _FAR_OUT, 1.0 / (most * (16.0 + most**2))  # of 16 times the way in sizes
        share = inverse / self._inverse[rows]
        begun = out & ((self._unknown[rows] != far) | ~(share <= 1.0))
        halved = out & ~begun & (share <= 0.5)
        rate = (self._inverse[rows] - inverse) / (part - self._part[rows])
        steady = np.abs(rate - self._rate[rows]) <= _STEADY * np.abs(rate)
        self._unknown[rows] = np.where(out, far, -1)
        self._alike[rows] = np.where(begun, 0, np.where(halved, np.where(steady, self._alike[rows] + 1, 0), self._alike[rows]))
        self._rate[rows] = np.where(begun, 0.0, np.where(halved, rate, self._rate[rows]))
        kept = begun | halved
        self._part[rows], self._inverse[rows] = np.where(kept, part, self._part[rows]), np.where(kept, inverse, self._inverse[rows])
        runs: Truths = halved & (self._alike[rows] >= 2) & (part + 1.25 * inverse / rate < 1.0)
        return runs


def _alike(determinant: Reals, other: Reals) -> Truths:
    """Whether determinants are near others."""
    ratio = determinant / other
    alike: Truths = (ratio >= 0.4) & (ratio <= 2.5)
    return alike

"""The solution of a chain near a seed, sought from several starts; the reference of walkgen_search.h and walkgen_limits.h."""

from dataclasses import dataclass, replace

import numpy as np

from walkgen.runtime.solves.boxed import Box, boxed_descent
from walkgen.runtime.solves.rows import Reals, Truths
from walkgen.runtime.solves.serial import Arm, Places, Stance, every, stance_at
from walkgen.runtime.solves.starts import all_in_rows, backward_rows, forward_rows, reversed_arm

SPREAD_STARTS = 32
_CLOSE, _CLOSE_STARTS, _CLOSE_PART = 1e-3, 8, 0.03
_TURN = 2.0 * np.pi
_SEED_IS_NEAR = 0.5
_LONGEST = 16.0  # of the reach: what a sliding joint's start is cut to
_PRIMES = np.array([2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53], float)
_ROOTS = np.sqrt(_PRIMES) % 1.0


@dataclass(frozen=True)
class Search:
    """What is sought: the arms, the bounds that hold them, and the seeds [b, n]."""

    arm: Arm
    box: Box
    seed: Reals

    def take(self, rows: Places) -> "Search":
        """Some rows."""
        return Search(self.arm.take(rows), self.box.take(rows), self.seed[rows])


@dataclass(frozen=True)
class Best:
    """The best found: `reached` and near the seed, by the sum of squares `apart`, or else closest."""

    at: Stance
    apart: Reals
    reached: Truths


def fitted(sliding: Truths, q: Reals, box: Box, seed: Reals) -> Reals:
    """Angles less full turns [b, n], in (-pi, pi] if the bounds allow that, else nearest the seed between them if they allow that."""
    wrapped = np.where(sliding, q, in_range(_short_way(q)))
    near = seed + _short_way(wrapped - seed)
    below, above = np.maximum(box.low - near, 0.0), np.maximum(near - box.high, 0.0)
    with np.errstate(invalid="ignore"):
        near = near + _TURN * (np.ceil(below / _TURN) - np.ceil(above / _TURN))
    kept = np.where((q >= box.low) & (q <= box.high), q, wrapped)
    inside = np.where((near >= box.low) & (near <= box.high), near, kept)
    return np.where(sliding | ((wrapped >= box.low) & (wrapped <= box.high)), wrapped, inside)


def in_range(q: Reals) -> Reals:
    """Angles in (-pi, pi]."""
    wrapped = q - _TURN * np.ceil(q / _TURN - 0.5)
    return np.where(wrapped > np.pi, wrapped - _TURN, np.where(wrapped <= -np.pi, np.pi, wrapped))


def _short_way(angle: Reals) -> Reals:
    """Less full turns, within half a turn."""
    rest = np.fmod(angle, _TURN)
    return np.asarray(rest - _TURN * np.round(rest / _TURN))


def read_limits(arm: Arm, limits: Reals) -> tuple[Box, Truths]:
    """Limits [b, n, 2] in the arm's scale; whether they are any [b]."""
    low, high = limits[..., 0], limits[..., 1]
    fine = every((low <= high) & (low < np.inf) & (high > -np.inf))
    with np.errstate(over="ignore"):
        low, high = (np.where(arm.sliding, np.ldexp(bound, -arm.size[:, None]), bound) for bound in (low, high))
    return Box(np.where(fine[:, None], low, -np.inf), np.where(fine[:, None], high, np.inf)), fine


def read_seed(arm: Arm, limits: Box, q: Reals) -> tuple[Reals, Truths]:
    """Start values [b, n] in the arm's scale, in the range of angles and of lengths that matter; whether they are numbers [b]."""
    fine = np.isfinite(q)
    values = np.where(fine, q, 0.0)
    with np.errstate(over="ignore"):
        slid = _cut(arm, np.ldexp(values, -arm.size[:, None]))
    return np.where(arm.sliding, slid, fitted(np.zeros_like(arm.sliding), values, limits, np.zeros_like(q))), every(fine)


def bounding(arm: Arm, limits: Box) -> Box:
    """The limits that hold a joint back: those of angles less than a full turn apart."""
    held = arm.sliding | (limits.high - limits.low < _TURN)
    return Box(np.where(held, limits.low, -np.inf), np.where(held, limits.high, np.inf))


def _cut(arm: Arm, q: Reals) -> Reals:
    most = _LONGEST * arm.reach[:, None]
    return np.asarray(np.minimum(np.maximum(q, -most), most))


def nothing(arm: Arm, seed: Reals) -> Best:
    """Before the first attempt."""
    at = stance_at(arm, seed)
    far = np.full(len(seed), np.inf)
    return Best(replace(at, gap=far), far, np.zeros(len(seed), bool))


def from_seed(search: Search, q: Reals) -> tuple[Reals, Reals]:
    """Greatest and squared difference of joint values to the seed, modulo full turns [b]."""
    gap = q - search.seed
    short = np.where(search.arm.sliding, gap, _short_way(gap))
    return np.max(np.abs(short), axis=-1), np.sum(short * short, axis=-1)


def spread_start(search: Search, centre: Reals, part_of_box: float, k: int) -> Reals:
    """Start number k [b, n] of a sequence that spreads over the box, or over a part of it around a centre: multiples of roots of primes."""
    arm, low, high = search.arm, search.box.low, search.box.high
    part = k * _ROOTS[: len(arm.sliding)]
    share = part - np.floor(part) - 0.5
    away = share * np.where(arm.sliding, 2.0 * arm.reach[:, None], _TURN)
    span = high - low
    closed = np.isfinite(span)
    away = np.where(closed, np.where(closed, low, 0.0) + (0.5 + share) * np.where(closed, span, 0.0) - centre, away)
    q = centre + part_of_box * away
    return np.where(arm.sliding, _cut(arm, q), q)


def spread_starts(search: Search, first: int, last: int) -> Reals:
    """Starts first to last [m, b, n], those below 8 around the seed."""
    return np.array([spread_start(search, search.seed, min(k / 8.0, 1.0), k) for k in range(first, last + 1)])


def attempted(search: Search, best: Best, rows: Places, starts: Reals, *, exhaustive: bool) -> Best:
    """Descend in some rows from starts [m, rows, n], brought into the box, and keep what is better than before.

    Starts that are no numbers are none; unless `exhaustive`, a row's starts count until one reaches the target.
    """
    usable = every(np.isfinite(starts))
    tries, places = np.nonzero(usable)
    if not tries.size:
        return best
    some = search.take(rows[places])
    q = some.box.clamped(fitted(some.arm.sliding, starts[tries, places], some.box, some.seed))
    at, reached = boxed_descent(some.arm, some.box, q)
    _, apart = from_seed(some, at.q)
    for turn in range(len(starts)):
        these = np.flatnonzero((tries == turn) & (exhaustive | ~best.reached[rows[places]]))
        best = _better(best, rows[places[these]], Best(at.take(these), apart[these], reached[these]))
    return best


def _better(best: Best, rows: Places, other: Best) -> Best:
    """The better one in some rows."""
    before = best.reached[rows]
    nearer = np.where(other.reached, other.apart < best.apart[rows], ~(other.at.gap >= best.at.gap[rows]))
    kept = np.flatnonzero((other.reached & ~before) | ((other.reached == before) & nearer))
    apart, reached = best.apart.copy(), best.reached.copy()
    apart[rows[kept]], reached[rows[kept]] = other.apart[kept], other.reached[kept]
    return Best(best.at.put(rows[kept], other.at.take(kept)), apart, reached)


def searched(search: Search, hopeful: Truths) -> Best:
    """Search in the box: from the seed; from all rows of a closed form that has all solutions, unless the seed's is near; and from spread
    starts, one in eight turned into rows of a closed form (not `hopeful`: only where no closed form has all). Near the target, where a
    singular pose can hold the arm back, from starts around the best so far.
    """
    everything = np.arange(len(search.seed))
    best = attempted(search, nothing(search.arm, search.seed), everything, search.seed[None], exhaustive=True)
    asked = ~(best.reached & (from_seed(search, best.at.q)[0] <= _SEED_IS_NEAR))
    if not asked.any():
        return best
    forward = all_in_rows(search.arm)
    backward = ~forward & all_in_rows(reversed_arm(search.arm))
    for complete, back in ((forward, False), (backward, True)):
        rows = np.flatnonzero(asked & complete)
        best = attempted(search, best, rows, _closed_forms(search.take(rows), search.seed[rows], back), exhaustive=True)
    spread = asked & (hopeful | ~(forward | backward))
    for first in range(1, SPREAD_STARTS, 8):
        rows = np.flatnonzero(spread & ~best.reached)
        starts = spread_starts(search.take(rows), first, first + 7)
        best = attempted(search, best, rows, starts[:7], exhaustive=False)
        rows, starts = np.flatnonzero(spread & ~best.reached), starts[7, ~best.reached[rows]]
        best = attempted(search, best, rows, _closed_forms(search.take(rows), starts, first % 16 == 9), exhaustive=False)
    rows = np.flatnonzero(asked & ~best.reached & (best.at.gap < _CLOSE * search.arm.reach))
    for k in range(1, _CLOSE_STARTS + 1):
        rows = rows[~best.reached[rows]]
        starts = spread_start(search.take(rows), best.at.q[rows], _CLOSE_PART, k)
        best = attempted(search, best, rows, starts[None], exhaustive=False)
    return best


def _closed_forms(search: Search, q: Reals, back: bool) -> Reals:
    """Starts [m, b, n] from the closed form of the arms, or of the arms seen from their feet, joints not solved for as in q [b, n]."""
    if not q.size:
        return np.empty((0, *q.shape))
    rows = backward_rows(reversed_arm(search.arm), q) if back else forward_rows(search.arm, q)
    return np.swapaxes(rows, 0, 1)

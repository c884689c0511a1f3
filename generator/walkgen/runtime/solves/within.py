"""Joint values within limits that bring a foot closest to a target; the reference of walkgen_within.h."""

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.boxed import boxed_descent
from walkgen.runtime.solves.edges import come_to_rest
from walkgen.runtime.solves.reach import flat_rows, in_the_callers_scale
from walkgen.runtime.solves.rows import Integers, Reals, Truths
from walkgen.runtime.solves.search import SPREAD_STARTS, Search, bounding, fitted, read_limits, read_seed, spread_starts
from walkgen.runtime.solves.serial import Arm, Places, Stance, reaches, read_arm, stance_at
from walkgen.signature import STATUSES

_OK, _UNREACHABLE, _BAD_INPUT, _NO_CONVERGENCE = (STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "NO_CONVERGENCE"))
_ALONG = {1: 64, 2: 24, 3: 10}
_VALLEYS = 16


def closest_within(
    geometry: ArrayLike, p: ArrayLike, limits: ArrayLike, sequence: int, q: ArrayLike, status: ArrayLike
) -> tuple[Reals, Integers]:
    """Where the status is UNREACHABLE, the joint values within the limits that bring the foot closest to a position.

    Args:
        geometry: for every joint its unit axis, positive for growing q, and a point on it at q = 0, then the foot at q = 0 [..., 6 n + 3].
        p: the foot's target [..., 3], m.
        limits: lower and upper [..., n, 2], infinite where there is none.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides; 1 <= n <= 16.
        q: a guess [..., n].
        status: of the guess [...].

    Returns:
        q [..., n] and status [...]: as they came in where the status is not UNREACHABLE; else OK where the foot gets there, UNREACHABLE at
        rest, NO_CONVERGENCE on the way; BAD_INPUT and NaN where an input is not finite or the limits are none.
    """
    shape, (numbers, target, bounds, guess, state) = flat_rows((geometry, p, limits, q, status), (1, 1, 2, 1, 0))
    values, states = guess.copy(), state.astype(np.int32)
    asked = np.flatnonzero(states == _UNREACHABLE)
    if asked.size:
        arm, fine = read_arm(numbers[asked], target[asked], sequence)
        values[asked], states[asked] = all_closest(arm, fine, bounds[asked], guess[asked])
    return values.reshape(*shape, guess.shape[-1]), states.reshape(shape)


def all_closest(arm: Arm | None, fine: Truths, limits: Reals, guess: Reals) -> tuple[Reals, Integers]:
    """q [b, n] and status [b] of the rows that are arms, from their guesses; BAD_INPUT and NaN of the others."""
    q, status = np.full(guess.shape, np.nan), np.full(len(guess), _BAD_INPUT, np.int32)
    if arm is None:
        return q, status
    bounds, limited = read_limits(arm, limits)
    seed, given = read_seed(arm, bounds, guess)
    for row in np.flatnonzero(fine & limited & given):
        place = np.array([row])
        some, box = arm.take(place), bounds.take(place)
        at, state = _closest(Search(some, bounding(some, box), seed[place]))
        found, status[place] = in_the_callers_scale(some, box, seed[place], at, np.array([state], np.int32))
        q[place] = np.minimum(np.maximum(found, limits[place, :, 0]), limits[place, :, 1])  # roundings
    return q, status


def _closest(search: Search) -> tuple[Stance, int]:
    """Of one row: from the guess, then from valleys of a grid or from spread starts."""
    at, there, rests = _at_rest(search, search.seed)
    if not there.any():
        n = search.seed.shape[-1]
        others, found, ended = _at_rest(search, _valleys(search) if n in _ALONG else spread_starts(search, 1, SPREAD_STARTS)[:, 0])
        both = Stance(
            *(np.concatenate([getattr(at, name), getattr(others, name)]) for name in ("q", "jacobian", "turning", "error", "gap", "edge"))
        )
        at, there, rests = both, np.concatenate([there, found]), np.concatenate([rests, ended])
    chosen = int(np.argmax(there)) if there.any() else int(np.argmin(np.where(np.isnan(at.gap), np.inf, at.gap)))
    return at.take(np.array([chosen])), _OK if there[chosen] else _UNREACHABLE if rests[chosen] and np.isfinite(
        at.gap[chosen]
    ) else _NO_CONVERGENCE


def _at_rest(search: Search, starts: Reals) -> tuple[Stance, Truths, Truths]:
    """Of one row: descents from starts [m, n], brought into the box, to rest: whether each reaches the target, and is at rest."""
    some = search.take(np.zeros(len(starts), np.intp))
    at, there = boxed_descent(some.arm, some.box, some.box.clamped(fitted(some.arm.sliding, starts, some.box, some.seed)))
    rests, astray = there.copy(), np.flatnonzero(~there)
    if astray.size:
        slow = some.take(astray)
        ended, rests[astray] = come_to_rest(slow.arm, slow.box, at.take(astray))
        at = at.put(astray, ended)
    return at, reaches(some.arm, at), rests


def _valleys(search: Search) -> Reals:
    """Of one row: the lowest points [m, n] of a regular grid over the box, each lower than its neighbours along every joint.

    Where a joint has no bound, the grid is over a turn or over lengths twice the reach.
    """
    arm, n = search.arm, search.seed.shape[-1]
    low, high = (bound[0] for bound in _surveyed(arm, search.box.low, search.box.high))
    along = _ALONG[n]
    ticks = np.linspace(low, high, along, axis=-1)
    points = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1).reshape(-1, n)
    gap = stance_at(arm.take(np.zeros(len(points), np.intp)), points).gap.reshape((along,) * n)
    lowest = np.ones(gap.shape, bool)
    for axis in range(n):
        fall = np.diff(np.minimum(gap, np.finfo(float).max), axis=axis)
        first, last = [(0, 0)] * n, [(0, 0)] * n
        first[axis], last[axis] = (1, 0), (0, 1)
        lowest &= ~(np.pad(fall, first) > 0.0) & ~(np.pad(fall, last) < 0.0)
    places: Places = np.flatnonzero(lowest & np.isfinite(gap))
    order = places[np.argsort(gap.ravel()[places], kind="stable")]
    return np.asarray(points[order[:_VALLEYS]])


def _surveyed(arm: Arm, low: Reals, high: Reals) -> tuple[Reals, Reals]:
    """The range of the grid [b, n]."""
    most = np.where(arm.sliding, 2.0 * arm.reach[:, None], np.pi)
    start = np.minimum(np.maximum(low, -most), high)
    end = np.maximum(np.minimum(high, most), start)
    held = np.isfinite(low) & np.isfinite(high) & ~arm.sliding
    return np.where(held, low, start), np.where(held, high, end)

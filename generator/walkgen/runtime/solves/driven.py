"""Joint values of a chain whose foot a function describes, for a position of the foot; the reference of walkgen_driven.h."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.boxed import Box, boxed_descent
from walkgen.runtime.solves.reach import answered, flat_rows, in_the_callers_scale, rank_lost
from walkgen.runtime.solves.rows import Integers, Reals, Truths, sliding_of
from walkgen.runtime.solves.search import Search, from_seed, read_limits, read_seed
from walkgen.runtime.solves.serial import FAR, MOST_JOINTS, TOLERANCE, Arm, Motion, every
from walkgen.runtime.solves.within import all_closest
from walkgen.signature import STATUSES

Callback = tuple[Any, ...]
"""A function as `Motion` has it, and what it takes after q."""
_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR = (STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR"))


def closest_driven(
    p: ArrayLike, limits: ArrayLike, reach: ArrayLike, sequence: int, edges: int, callback: Callback, q: ArrayLike, status: ArrayLike
) -> tuple[Reals, Integers]:
    """Where the status is UNREACHABLE, the joint values within the limits that bring the foot closest to a position.

    Args:
        p: the foot's target [..., 3], m.
        limits: lower and upper [..., n, 2], infinite where there is none.
        reach: about how far the foot gets [...], m.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides; 1 <= n <= 16.
        edges: how many margins the callback gives.
        callback: the foot and margins.
        q: a guess [..., n].
        status: of the guess [...].

    Returns:
        As `closest_within`; the guess and NO_CONVERGENCE where no q that is tried has a foot.
    """
    function, *given = callback
    shape, (target, bounds, far, guess, state, *data) = flat_rows(
        (p, limits, reach, q, status, *given), (1, 2, 0, 1, 0, *(1 for _ in given))
    )
    values, states = guess.copy(), state.astype(np.int32)
    asked = np.flatnonzero(states == _UNREACHABLE)
    if asked.size:
        motion = Motion(function, tuple(data), edges).take(asked)
        values[asked], states[asked] = all_closest(*_arm(target[asked], far[asked], sequence, motion), bounds[asked], guess[asked])
    return values.reshape(*shape, guess.shape[-1]), states.reshape(shape)


def inverse_driven(
    p: ArrayLike, q_seed: ArrayLike, limits: ArrayLike, reach: ArrayLike, sequence: int, edges: int, callback: Callback
) -> tuple[Reals, Integers]:
    """Joint values near a seed that bring the foot to a position.

    Args:
        p: as of `closest_driven`.
        q_seed: joint values to start from [..., n].
        limits: as of `closest_driven`; a solution within them goes before others.
        reach: as of `closest_driven`.
        sequence: as of `closest_driven`.
        edges: as of `closest_driven`.
        callback: as of `closest_driven`.

    Returns:
        As `inverse_reach`; the seed and NO_CONVERGENCE where no q that is tried has a foot.
    """
    function, *given = callback
    shape, (target, seed, bounds, far, *data) = flat_rows((p, q_seed, limits, reach, *given), (1, 1, 2, 0, *(1 for _ in given)))
    return answered(*_arm(target, far, sequence, Motion(function, tuple(data), edges)), seed, bounds, shape)


def nearer_driven(
    p: ArrayLike,
    q_seed: ArrayLike,
    limits: ArrayLike,
    reach: ArrayLike,
    sequence: int,
    edges: int,
    callback: Callback,
    q: ArrayLike,
    status: ArrayLike,
) -> tuple[Reals, Integers]:
    """A solution, or one that a descent from the seed comes to, whichever is nearer to the seed.

    Args:
        p: as of `inverse_driven`.
        q_seed: as of `inverse_driven`.
        limits: as of `inverse_driven`.
        reach: as of `inverse_driven`.
        sequence: as of `inverse_driven`.
        edges: as of `inverse_driven`.
        callback: as of `inverse_driven`.
        q: joint values [..., n].
        status: theirs [...]; a solution where OK or SINGULAR.

    Returns:
        q [..., n] and status [...]; as `inverse_driven` where neither is a solution.
    """
    function, *given = callback
    inputs, ranks = (p, q_seed, limits, reach, q, status, *given), (1, 1, 2, 0, 1, 0, *(1 for _ in given))
    shape, (target, seed, bounds, far, row, state, *data) = flat_rows(inputs, ranks)
    arm, fine = _arm(target, far, sequence, Motion(function, tuple(data), edges))
    values, states = answered(None, fine, seed, bounds, (len(row),))
    known = (state == _OK) | (state == _SINGULAR)
    if arm is not None:
        values, states = _nearer(arm, fine, bounds, seed, row, known)
        kept = known & (states != _BAD_INPUT) & np.isnan(values[:, 0])
        values, states = np.where(kept[:, None], row, values), np.where(kept, state, states).astype(np.int32)
        if (rest := np.flatnonzero(~known & (states == _UNREACHABLE))).size:
            values[rest], states[rest] = answered(arm.take(rest), fine[rest], seed[rest], bounds[rest], (rest.size,))
    return values.reshape(*shape, row.shape[-1]), states.reshape(shape)


def _nearer(arm: Arm, fine: Truths, limits: Reals, seed: Reals, row: Reals, known: Truths) -> tuple[Reals, Integers]:
    """Where descents from the seeds end; NaN and UNREACHABLE where that is no solution, or farther from the seed than one that is known."""
    bounds, limited = read_limits(arm, limits)
    starts, given = read_seed(arm, bounds, seed)
    fine = fine & limited & given
    free = Box(np.full_like(seed, -np.inf), np.full_like(seed, np.inf))
    search = Search(arm, free, starts)
    at, there = boxed_descent(arm, free, starts)
    with np.errstate(invalid="ignore", over="ignore"):
        own = from_seed(search, np.where(arm.sliding, np.ldexp(row, -arm.size[:, None]), row))[1]
        taken = there & ~(known & (own <= from_seed(search, at.q)[1]))
    states = np.where(fine, np.where(taken, np.where(rank_lost(at), _SINGULAR, _OK), _UNREACHABLE), _BAD_INPUT).astype(np.int32)
    found, states = in_the_callers_scale(arm, bounds, starts, at, states)
    return np.where((taken & fine)[:, None], found, np.nan), states


def _arm(p: Reals, reach: Reals, sequence: int, motion: Motion) -> tuple[Arm | None, Truths]:
    """The arms of rows, lengths scaled by a power of 2 to about 1, a target very far away brought nearer; which rows are arms."""
    sliding = sliding_of(sequence) if sequence > 1 else np.zeros(0, bool)
    if not 0 < len(sliding) <= MOST_JOINTS:
        return None, np.zeros(len(p), bool)
    fine = every(np.isfinite(p)) & np.isfinite(reach) & (reach > 0.0)
    target, far = np.where(fine[:, None], p, 0.0), np.where(fine, reach, 1.0)
    size = np.frexp(far)[1]
    scale = np.frexp(np.max(np.abs(target), axis=-1))[1]
    scale = np.where(scale - size > FAR, scale - FAR, size)
    own, none = np.ldexp(far, -size), np.zeros((len(p), len(sliding), 3))
    target = np.ldexp(target, -scale[:, None])
    return Arm(sliding, none, none, none, none[:, 0], target, None, size, 0.25 * own, own, TOLERANCE * own, motion), fine

"""Joint values of chains of up to 16 joints for a position or a pose of the foot, within limits where that can be: as walkgen_reach.h."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.boxed import Box
from walkgen.runtime.solves.edges import come_to_rest
from walkgen.runtime.solves.rows import Integers, Reals, Truths
from walkgen.runtime.solves.search import Search, bounding, fitted, read_limits, read_seed, searched
from walkgen.runtime.solves.serial import Arm, Stance, every, reaches, read_arm, read_pose, some
from walkgen.signature import STATUSES

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR, _NO_CONVERGENCE = (
    STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE")
)
_LOST = 1e-9


def inverse_reach(geometry: ArrayLike, p: ArrayLike, q_seed: ArrayLike, limits: ArrayLike, sequence: int) -> tuple[Reals, Integers]:
    """Joint values near a seed that bring the foot to a position.

    Args:
        geometry: for every joint its unit axis, positive for growing q, and a point on it at q = 0, then the foot at q = 0 [..., 6 n + 3].
        p: the foot's target [..., 3], m.
        q_seed: joint values to start from [..., n].
        limits: lower and upper [..., n, 2], infinite where there is none; a solution within them goes before others.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides; 1 <= n <= 16.

    Returns:
        q [..., n] and status [...]: OK; SINGULAR where the Jacobian has lost rank; where the foot does not get there, UNREACHABLE at a q of
        rest, the best found, or NO_CONVERGENCE on the way to it; BAD_INPUT and NaN where an input is not finite or the limits are none.
        Angles are in (-pi, pi], or another turn where limits ask for it.
    """
    shape, (numbers, target, seed, bounds) = flat_rows((geometry, p, q_seed, limits), (1, 1, 1, 2))
    arm, fine = read_arm(numbers, target, sequence)
    return answered(arm, fine, seed, bounds, shape)


def inverse_pose(geometry: ArrayLike, T: ArrayLike, q_seed: ArrayLike, limits: ArrayLike, sequence: int) -> tuple[Reals, Integers]:
    """The same for a pose.

    What comes closest is the least sum of the squared distance and the squared angle times a quarter of the reach.

    Args:
        geometry: as of `inverse_reach`; the foot's rotation at q = 0, row-major, follows its position [..., 6 n + 12].
        T: rigid transforms of the foot [..., 4, 4], m.
        q_seed: as of `inverse_reach`.
        limits: as of `inverse_reach`.
        sequence: as of `inverse_reach`.

    Returns:
        As `inverse_reach`; BAD_INPUT also where T is not rigid to 1e-6.
    """
    shape, (numbers, target, seed, bounds) = flat_rows((geometry, T, q_seed, limits), (1, 2, 1, 2))
    arm, fine = read_pose(numbers, target, sequence)
    return answered(arm, fine, seed, bounds, shape)


def flat_rows(inputs: Sequence[ArrayLike], ranks: Sequence[int]) -> tuple[tuple[int, ...], list[Reals]]:
    """The common leading dimensions of inputs with so many dimensions of their own, and the inputs with one leading dimension."""
    arrays = [np.asarray(item, float) for item in inputs]
    tails = [item.shape[item.ndim - rank :] for item, rank in zip(arrays, ranks, strict=True)]
    shape = np.broadcast_shapes(*(item.shape[: item.ndim - rank] for item, rank in zip(arrays, ranks, strict=True)))
    return shape, [np.broadcast_to(item, (*shape, *tail)).reshape(-1, *tail) for item, tail in zip(arrays, tails, strict=True)]


def answered(arm: Arm | None, fine: Truths, seed: Reals, limits: Reals, shape: tuple[int, ...]) -> tuple[Reals, Integers]:
    """q [*shape, n] and status [*shape] of the rows that are arms, near their seeds; BAD_INPUT and NaN of the others."""
    q, status = np.full(seed.shape, np.nan), np.full(len(seed), _BAD_INPUT, np.int32)
    if arm is not None:
        bounds, limited = read_limits(arm, limits)
        starts, given = read_seed(arm, bounds, seed)
        rows = np.flatnonzero(fine & limited & given)
        if rows.size:
            some, box = arm.take(rows), bounds.take(rows)
            at, states = _found(some, box, starts[rows])
            q[rows], status[rows] = in_the_callers_scale(some, box, starts[rows], at, states)
    return q.reshape(*shape, seed.shape[-1]), status.reshape(shape)


def _found(arm: Arm, limits: Box, seed: Reals) -> tuple[Stance, Integers]:
    """The solution near the seed: within the limits, or else without them; or else where the arm comes closest."""
    box = bounding(arm, limits)
    bounded = some(np.isfinite(box.low) | np.isfinite(box.high))
    best = searched(Search(arm, box, seed), ~bounded)
    at, again = best.at, np.flatnonzero(~best.reached & bounded)
    if again.size:
        free = Search(arm.take(again), _free(again.size, arm), seed[again])
        at = at.put(again, searched(free, np.ones(again.size, bool)).at)
    there = reaches(arm, at)
    states = np.where(there, _OK, _UNREACHABLE).astype(np.int32)
    states[~np.isfinite(at.gap)] = _NO_CONVERGENCE
    astray = np.flatnonzero(~there & np.isfinite(at.gap))
    if astray.size:
        lost = arm.take(astray)
        ended, rests = come_to_rest(lost, _free(astray.size, arm), at.take(astray))
        at = at.put(astray, ended)
        states[astray] = np.where(reaches(lost, ended), _OK, np.where(rests, _UNREACHABLE, _NO_CONVERGENCE))
    states[(states == _OK) & rank_lost(at)] = _SINGULAR
    return at, states


def _free(count: int, arm: Arm) -> Box:
    """No limits."""
    wide = np.full((count, len(arm.sliding)), np.inf)
    return Box(-wide, wide)


def rank_lost(at: Stance) -> Truths:
    """Whether the Jacobians have lost rank [b]."""
    values = np.linalg.svd(np.where(np.isfinite(at.jacobian), at.jacobian, 0.0), compute_uv=False)
    return np.asarray(values[:, -1] <= _LOST * values[:, 0])


def in_the_callers_scale(arm: Arm, limits: Box, seed: Reals, at: Stance, states: Integers) -> tuple[Reals, Integers]:
    """q [b, n] and status [b]; BAD_INPUT and NaN where q is not finite."""
    value = fitted(arm.sliding, at.q, limits, seed)
    with np.errstate(over="ignore"):
        q = np.where(arm.sliding, np.ldexp(value, arm.size[:, None]), value)
    fine = every(np.isfinite(q)) & (np.isfinite(at.gap) | (arm.motion is not None))  # or a foot that is nowhere
    return np.where(fine[:, None], q, np.nan), np.where(fine, states, _BAD_INPUT).astype(np.int32)

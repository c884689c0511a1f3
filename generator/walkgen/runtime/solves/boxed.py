"""Joint values of a chain led to its target inside a box of limits; the reference of walkgen_boxed.h.

Levenberg and Marquardt's damped Gauss-Newton steps with the exact Jacobian. Joints at a bound that the step would cross stay there, and
joints that the step would take across one stop at it while the others make up for them.
"""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.rows import Reals, Truths
from walkgen.runtime.solves.serial import EPSILON, Arm, Places, Stance, every, reaches, some, stance_at

_USUAL_STEPS = 60
_MOST_STEPS = 300
_NEAR = 1e-3


@dataclass(frozen=True)
class Box:
    """Bounds of the joint values [b, n], infinite where there are none."""

    low: Reals
    high: Reals

    def take(self, rows: Places) -> "Box":
        """Some rows."""
        return Box(self.low[rows], self.high[rows])

    def clamped(self, q: Reals) -> Reals:
        """The values brought inside."""
        return np.asarray(np.minimum(np.maximum(q, self.low), self.high))


def free_joints(box: Box, at: Stance) -> tuple[Truths, Reals]:
    """The joints [b, n] that may move downhill, and the slope [b, n] of half the squared error; 0 for the others."""
    slope = np.einsum("bij,bi->bj", at.jacobian, at.error)
    free = ((slope >= 0.0) & (at.q > box.low)) | ((slope <= 0.0) & (at.q < box.high))
    return free, np.where(free, slope, 0.0)


def stepped(arm: Arm, box: Box, q: Reals, step: Reals) -> Reals:
    """q plus a step, cut so that no joint turns by more than 2, in the box."""
    turn = np.maximum(2.0, np.max(np.abs(np.where(arm.sliding, 0.0, step)), axis=-1, keepdims=True))
    return box.clamped(q + step * (2.0 / turn))


def boxed_descent(arm: Arm, box: Box, q: Reals) -> tuple[Stance, Truths]:
    """Lead q [b, n], which is inside the box, to the target or to rest, and then to its roundings: the stances, and which reach it.

    A descent ends after 60 steps, one that came near the target after 300; earlier where eight steps gain less than a twentieth.
    """
    at, rows = stance_at(arm, q), np.arange(len(q))
    factor, before, ended = np.full(len(q), 0.1), np.full(len(q), np.inf), ~np.isfinite(at.gap)
    for turn in range(_MOST_STEPS):
        near = at.gap < _NEAR * arm.reach
        if turn % 8 == 7:
            ended = ended | (~near & (at.gap > 0.95 * before))
            before = at.gap
        ended = ended | (at.gap <= 2.0 * EPSILON * arm.reach) | (~near & (turn >= _USUAL_STEPS))
        active = rows[~ended]
        if not active.size:
            break
        last, factor[active], after = _descended(arm.take(active), box.take(active), at.take(active), factor[active])
        ended[active] = last
        at = at.put(active, after)
    return at, reaches(arm, at)


def _descended(arm: Arm, box: Box, at: Stance, factor: Reals) -> tuple[Truths, Reals, Stance]:
    """One step: whether it was the last one, the factor of the damping, and the stance, the same one where the step does not help."""
    reached = reaches(arm, at)
    damping = np.where(reached, 0.0, factor * at.gap * at.gap) + EPSILON * EPSILON * arm.reach
    step = _boxed_step(box, at, damping)
    after = stance_at(arm, stepped(arm, box, at.q, step))
    better = after.gap < at.gap
    short = ~(np.max(np.abs(step), axis=-1) > EPSILON)
    last = np.where(better, reached & (after.gap > 0.25 * at.gap), reached | short)
    gained = np.flatnonzero(better)
    return last, np.where(better, np.maximum(0.3 * factor, 1e-3), 8.0 * factor), at.put(gained, after.take(gained))


def _boxed_step(box: Box, at: Stance, damping: Reals) -> Reals:
    """The damped steps [b, n]: joints that would cross a bound stop there."""
    free, _ = free_joints(box, at)
    error, step, rows = at.error.copy(), np.zeros_like(at.q), np.arange(len(damping))
    while rows.size:
        trial = _gauss_step(at.jacobian[rows] * free[rows, None, :], error[rows], damping[rows])
        moved = at.q[rows] + trial
        inside = box.take(rows).clamped(moved)
        crossing = free[rows] & (inside != moved)
        stopped = np.where(crossing, inside - at.q[rows], 0.0)
        step[rows] = np.where(free[rows], np.where(crossing, stopped, trial), step[rows])
        error[rows] += np.einsum("bij,bj->bi", at.jacobian[rows], stopped)
        free[rows] &= ~crossing
        rows = rows[some(crossing) & some(free[rows])]
    return step


def _gauss_step(jacobian: Reals, error: Reals, damping: Reals) -> Reals:
    """The steps [b, n] that make up for the errors best and shortest."""
    fine = every(every(np.isfinite(jacobian)))
    u, values, v = np.linalg.svd(np.where(fine[:, None, None], jacobian, 0.0), full_matrices=False)
    divisor = values * values + damping[:, None]
    along = np.einsum("bij,bi->bj", u, error) * values / np.where(divisor > 0.0, divisor, 1.0)
    return np.asarray(-np.einsum("bji,bj->bi", v, along))

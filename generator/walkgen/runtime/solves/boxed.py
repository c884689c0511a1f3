"""Joint values of a chain led to its target inside a box of limits; the reference of walkgen_boxed.h.

Levenberg and Marquardt's damped Gauss-Newton steps with the exact Jacobian. Joints at a bound that the step would cross stay there, and
joints that the step would take across one stop at it while the others make up for them.
"""

from dataclasses import dataclass, replace

import numpy as np

from walkgen.runtime.solves.rows import Reals, Truths
from walkgen.runtime.solves.serial import EPSILON, Arm, Places, Stance, every, reaches, some, stance_at

_USUAL_STEPS = 60
_MOST_STEPS = 300
_NEAR = 1e-3
_PARTS, _CUTS, _TURNS = 8, 64, 10


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
    with np.errstate(invalid="ignore"):
        slope = np.einsum("bij,bi->bj", at.jacobian, at.error)
    free = ((slope >= 0.0) & (at.edge >= 0.0) & (at.q > box.low)) | ((slope <= 0.0) & (at.edge <= 0.0) & (at.q < box.high))
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
    calmer = np.where(better, np.maximum(0.3 * factor, 1e-3), 8.0 * factor)
    astray = np.flatnonzero(~np.isfinite(after.gap)) if arm.ends else np.zeros(0, np.intp)
    at = move_to(at, after, better)
    if astray.size:
        met, found = meet_edges(arm.take(astray), after.q[astray], at.take(astray))
        at = at.put(astray, found)
        last[astray], calmer[astray] = last[astray] & ~met, np.where(met, factor[astray], calmer[astray])
    return last, calmer, at


def move_to(at: Stance, after: Stance, better: Truths) -> Stance:
    """Stances that are better; joints that have not moved are at the edges where they were."""
    gained = np.flatnonzero(better)
    moved = after.take(gained)
    return at.put(gained, replace(moved, edge=np.where(moved.q == at.q[gained], at.edge[gained], 0.0)))


def meet_edges(arm: Arm, after: Reals, at: Stance) -> tuple[Truths, Stance]:
    """Where steps to q = after [b, n] lead to where there is no foot: every joint that alone does so, led towards where the foot ends.

    Or to a part of this way: there slopes grow with the square root of what is left of it. Which rows were, where that is nearer.
    """
    met = np.zeros(len(after), bool)
    for joint in range(after.shape[1]):
        rows = np.flatnonzero(~np.isfinite(stance_at(arm, _with(at.q, joint, after[:, joint])).gap))
        if rows.size:
            some_met, found = _meet_edge(arm.take(rows), joint, after[rows, joint], at.take(rows))
            at, met[rows] = at.put(rows, found), met[rows] | some_met
    return met, at


def _with(q: Reals, joint: int, value: Reals) -> Reals:
    changed = q.copy()
    changed[:, joint] = value
    return changed


def _meet_edge(arm: Arm, joint: int, none: Reals, at: Stance) -> tuple[Truths, Stance]:
    """Of one joint, which has no foot at `none` [b]."""
    start = at.q[:, joint]
    edge, root, waiting = _last_foot(arm, joint, none, at), 0.0, np.ones(len(none), bool)
    for turn in range(_PARTS):
        tried = stance_at(arm, _with(at.q, joint, edge + root * root * (start - edge)))
        better = waiting & (tried.gap < at.gap)
        with np.errstate(invalid="ignore"):
            on = (none - start) * np.einsum("bi,bi->b", tried.jacobian[:, :, joint], tried.error) < 0.0
        flags = _with(at.edge, joint, np.where(on & (turn == 0), np.sign(none - start), 0.0))
        rows = np.flatnonzero(better)
        at, waiting = at.put(rows, replace(tried, edge=flags).take(rows)), waiting & ~better
        root = 0.5 + 0.5 * root
    return ~waiting, at


def _last_foot(arm: Arm, joint: int, none: Reals, at: Stance) -> Reals:
    """The joint's values [b] at which the foot ends, between those of the stances and those that have none."""
    there, count = at.q[:, joint].copy(), len(none)
    shares = np.arange(1, _CUTS) / _CUTS
    every_row = arm.take(np.repeat(np.arange(count), len(shares)))
    for _ in range(_TURNS):
        values = there[:, None] + shares * (none - there)[:, None]
        fine = np.isfinite(stance_at(every_row, _with(np.repeat(at.q, len(shares), axis=0), joint, values.ravel())).gap).reshape(
            values.shape
        )
        first = np.where(fine.all(-1), len(shares), np.argmin(fine, axis=-1))  # without a foot
        known = np.concatenate([there[:, None], values, none[:, None]], axis=-1)
        there, none = known[np.arange(count), first], known[np.arange(count), first + 1]
    return there


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

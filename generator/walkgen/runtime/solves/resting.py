"""Where a chain that does not reach its target comes to rest closest to it; the reference of walkgen_resting.h.

Newton's method on half the squared error, with second derivatives, damped as far as its matrix and the error need it.
"""

from itertools import product

import numpy as np

from walkgen.runtime.solves.boxed import Box, boxed_descent, free_joints, meet_edges, move_to, stepped
from walkgen.runtime.solves.rows import Reals, Truths
from walkgen.runtime.solves.serial import EPSILON, Arm, Stance, every, reaches, stance_at
from walkgen.runtime.solves.spatial import norm

_STEPS = 200
_SADDLE_STEPS = 16
_SADDLES = 3
_FLAT = 1e-10
_LITTLE, _CALM = 1e-3, 256.0


def settle_down(arm: Arm, box: Box, at: Stance) -> tuple[Stance, Truths]:
    """Lead stances to rest where no joint that may move leads down: which get there [b].

    At most three times past a saddle or on from where it is slow.
    """
    at, rests = _slowed_down(arm, box, at)
    for _ in range(_SADDLES):
        astray, saddles = np.flatnonzero(~reaches(arm, at)), np.flatnonzero(~reaches(arm, at) & rests)
        if not astray.size:
            break
        after, left = _leave_saddle(arm.take(saddles), box.take(saddles), at.take(saddles))
        at = at.put(saddles, after)
        rows = np.setdiff1d(astray, saddles[~left])
        below, there = boxed_descent(arm.take(rows), box.take(rows), at.q[rows])
        still, ends = _slowed_down(arm.take(rows), box.take(rows), below)
        at, rests[rows] = at.put(rows, below).put(rows[~there], still.take(np.flatnonzero(~there))), there | ends
    return at, rests


def edges_stand(arm: Arm, box: Box, at: Stance) -> Truths:
    """Whether the foot ends for joints at the same values when others move a little [b]: else a way along an edge may lead down."""
    stand, n = np.ones(len(at.q), bool), at.q.shape[1]
    for joint, other, way, side in product(range(n), range(n), (-1.0, 1.0), (-1.0, 1.0)):
        rows = np.flatnonzero(stand & (at.edge[:, joint] != 0.0))
        if joint == other or not rows.size:
            continue
        q, little = at.q[rows].copy(), _LITTLE * (0.1 + np.abs(at.q[rows, joint]))
        q[:, other] = np.clip(q[:, other] + way * little, box.low[rows, other], box.high[rows, other])
        q[:, joint] += side * at.edge[rows, joint] * _LITTLE * little
        stand[rows] = np.isfinite(stance_at(arm.take(rows), q).gap) == (side < 0.0)
    return stand


def _slowed_down(arm: Arm, box: Box, at: Stance) -> tuple[Stance, Truths]:
    """Lead stances to where no joint that may move brings the foot nearer, be it a saddle: whether they get there in 200 steps."""
    size = np.maximum(arm.reach, arm.length)
    rough = arm.motion.rough if arm.motion else 1.0
    flat, noise = size * (at.gap + size), max(4.0, rough / _CALM) * EPSILON * (at.gap + size)
    damping, fine = np.zeros(len(flat)), EPSILON * rough
    for _ in range(_STEPS):
        free, slope = free_joints(box, at)
        steep = norm(slope)
        rows = np.flatnonzero((steep > fine * flat) & (damping < 1e6 * flat))
        if not rows.size:
            break
        step, found = _newton_step(curvature(arm.take(rows), at.take(rows)), free[rows], slope[rows], damping[rows])
        after = stance_at(arm.take(rows), stepped(arm.take(rows), box.take(rows), at.q[rows], step))
        less, same = after.gap < (at.gap - noise)[rows], after.gap < (at.gap + noise)[rows]
        better = found & (less | (same & (norm(free_joints(box.take(rows), after)[1]) < 0.5 * steep[rows])))
        calm = np.where(damping[rows] < 1e-6 * flat[rows], 0.0, 0.1 * damping[rows])
        damped = np.where(better, calm, np.maximum(10.0 * damping[rows], 1e-7 * flat[rows]))
        here = move_to(at.take(rows), after, better)
        astray = np.flatnonzero(found & ~np.isfinite(after.gap)) if arm.ends else np.zeros(0, np.intp)
        if astray.size:
            met, moved = meet_edges(arm.take(rows[astray]), after.q[astray], here.take(astray))
            here, damped[astray] = here.put(astray, moved), np.where(met, damping[rows[astray]], damped[astray])
        damping[rows], at = damped, at.put(rows, here)
    return at, norm(free_joints(box, at)[1]) <= max(_FLAT, fine) * flat


def _newton_step(matrix: Reals, free: Truths, slope: Reals, damping: Reals) -> tuple[Reals, Truths]:
    """Newton's damped steps [b, n] of the free joints, and whether the matrix is positive [b]."""
    values, vectors = np.linalg.eigh(_of_free(matrix, free))
    shifted = values + damping[:, None]
    found = np.min(shifted, axis=-1) > EPSILON * np.max(np.abs(values), axis=-1)
    along = np.einsum("bji,bj->bi", vectors, slope) / np.where(found[:, None], shifted, 1.0)
    return np.where(free, -np.einsum("bij,bj->bi", vectors, along), 0.0), found


def _of_free(matrix: Reals, free: Truths) -> Reals:
    """The rows and columns of free joints, those of the unit matrix for the others; the unit matrix where it is not finite."""
    both = free[:, :, None] & free[:, None, :] & every(every(np.isfinite(matrix)))[:, None, None]
    return np.where(both, matrix, np.eye(free.shape[-1]))


def _leave_saddle(arm: Arm, box: Box, at: Stance) -> tuple[Stance, Truths]:
    """Leave saddles along the direction of the most negative curvature, as far as that helps; which were left [b]."""
    free, _ = free_joints(box, at)
    values, vectors = np.linalg.eigh(_of_free(curvature(arm, at), free))
    waiting = values[:, 0] < -8.0 * EPSILON * arm.reach * arm.reach
    way = vectors[:, :, 0] / np.max(np.abs(vectors[:, :, 0]), axis=-1, keepdims=True)
    left = np.zeros(len(values), bool)
    share = 0.5
    for turn in range(2 * _SADDLE_STEPS):
        rows = np.flatnonzero(waiting & ~left)
        if not rows.size:
            break
        after = stance_at(arm.take(rows), box.take(rows).clamped(at.q[rows] + share * way[rows]))
        better = after.gap < at.gap[rows]
        at = at.put(rows[better], after.take(np.flatnonzero(better)))
        left[rows[better]] = True
        share *= -1.0 if turn % 2 == 0 else -0.3
    return at, left


def curvature(arm: Arm, at: Stance) -> Reals:
    """Second derivatives [b, n, n] of half the squared error by the joint values."""
    columns, turning = np.swapaxes(at.jacobian, -1, -2), at.turning
    n = turning.shape[1]
    matrix = np.einsum("bik,bjk->bij", columns[..., :3], columns[..., :3])
    if arm.motion is None:
        second = np.cross(turning[:, :, None, :], columns[:, None, :, :3])
    else:
        second = np.moveaxis(arm.motion.at(arm.sliding, arm.size, at.q)[2][:, :3], 1, -1)
    matrix = matrix + np.einsum("bijk,bk->bij", second, at.error[:, :3])
    if arm.rotation is not None:
        vector = at.error[:, 3:] / arm.length[:, None]
        twist = 0.5 * np.einsum("bijk,bk->bij", np.cross(turning[:, :, None, :], turning[:, None, :, :]), vector)
        matrix = matrix + (arm.length * arm.length)[:, None, None] * (_bend(vector, turning) + twist)
    upper = np.triu(np.ones((n, n), bool))
    return np.asarray(np.where(upper, matrix, np.swapaxes(matrix, -1, -2)))


def _bend(vector: Reals, turning: Reals) -> Reals:
    """Half the squared length of rotation vectors, derived along turns twice [b, n, n]: its shape on rotations."""
    angle, around = norm(vector), np.einsum("bjk,bk->bj", turning, vector)
    half = 0.5 * angle
    curved, some = half > 1e-4, angle > 1e-150
    factor = np.where(curved, half * np.cos(half) / np.where(curved, np.sin(half), 1.0), 1.0)[:, None, None]
    square = np.where(some, angle * angle, 1.0)[:, None, None]
    along = np.where(some[:, None, None], (1.0 - factor) * around[:, :, None] * around[:, None, :] / square, 0.0)
    return np.asarray(factor * np.einsum("bik,bjk->bij", turning, turning) + along)

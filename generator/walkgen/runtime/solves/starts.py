"""Joint values to start a search from, in closed form where three joints of a chain allow it; the reference of walkgen_starts.h.

Three joints next to each other, the others at rest, bring a point to its target by the general inverse. The points: the foot; for a pose,
a point on the last axis, which the last joint does not move; the centre of a wrist, where the last three axes meet, whose angles follow in
closed form too. A chain seen from its foot has its first joints last.
"""

from dataclasses import replace

import numpy as np

from walkgen.runtime.solves.inverse_general import inverse_general
from walkgen.runtime.solves.rows import Reals, Truths
from walkgen.runtime.solves.serial import Arm, every
from walkgen.runtime.solves.spatial import across, angle_about, dot, norm, turned
from walkgen.signature import STATUSES

_UNREACHABLE, _BAD_INPUT, _DUPLICATE = (STATUSES.index(name) for name in ("UNREACHABLE", "BAD_INPUT", "DUPLICATE"))
_MEETING = 1e-9
_PARALLEL = 1e-6


def reversed_arm(arm: Arm) -> Arm:
    """The arms that lead the targets back to the feet by the same joint values, last joint first."""
    rotation = None if arm.rotation is None else np.swapaxes(arm.rotation, -1, -2)
    axes, points = -arm.axes[:, ::-1], arm.points[:, ::-1]
    return replace(arm, sliding=arm.sliding[::-1], axes=axes, points=points, foot=arm.target, target=arm.foot, rotation=rotation)


def all_in_rows(arm: Arm) -> Truths:
    """Whether `forward_rows` gives all solutions [b], but for those with a free joint."""
    n = len(arm.sliding)
    if arm.motion is not None or arm.rotation is None:
        return np.full(len(arm.target), arm.motion is None and n == 3)
    return wrist_centre(arm)[1] if n == 6 else np.full(len(arm.foot), n == 4 and not arm.sliding[3])


def forward_rows(arm: Arm, q: Reals) -> Reals:
    """Rows [b, m, n] by the best closed form of each arm, joints that it does not solve for as in q [b, n]; NaN where there is no row."""
    n = len(arm.sliding)
    if arm.motion is not None:
        return np.empty((len(q), 0, n))
    if arm.rotation is None:
        return _three_joints(arm, n - 3, arm.foot, q) if n >= 3 else np.empty((len(q), 0, n))
    if n < 4:
        return np.empty((len(q), 0, n))
    centre, meets = wrist_centre(arm)
    rows = np.full((len(q), 8, n), np.nan)
    wrists, others = np.flatnonzero(meets), np.flatnonzero(~meets)
    if wrists.size:
        found = _wrist_rows(arm.take(wrists), centre[wrists], q[wrists])
        rows[wrists, : found.shape[1]] = found
    if others.size:
        some = arm.take(others)
        found = _three_joints(some, n - 4, some.points[:, -1], q[others])
        rows[others, : found.shape[1]] = _last_angle(some, found)
    return rows


def backward_rows(back: Arm, q: Reals) -> Reals:
    """The same of arms seen from their feet, in the order of q."""
    return forward_rows(back, q[:, ::-1])[..., ::-1]


def wrist_centre(arm: Arm) -> tuple[Reals, Truths]:
    """The points [b, 3] where the last three axes meet, all of them turning; whether there is one [b]."""
    n, none = len(arm.sliding), np.zeros(len(arm.foot), bool)
    if n < 6 or arm.sliding[-3:].any():
        return np.zeros_like(arm.foot), none
    axes, points = arm.axes[:, -3:], arm.points[:, -3:]
    side = np.cross(axes[:, 1], axes[:, 2])
    square = dot(side, side)
    fine = square > _PARALLEL
    lever = np.cross(axes[:, 1], points[:, 1] - points[:, 2])
    centre = points[:, 2] + (dot(lever, side) / np.where(fine, square, 1.0))[:, None] * axes[:, 2]
    miss = norm(np.cross(axes, points - centre[:, None]))
    return centre, fine & every(miss <= _MEETING * arm.reach[:, None])


def _three_joints(arm: Arm, first: int, point: Reals, q: Reals) -> Reals:
    """Rows of q [b, m, n] whose joints first .. first + 2 bring a point, given at q = 0, to where the target has it, or closest."""
    n = len(arm.sliding)
    goal = arm.target + _of_target(arm, point - arm.foot)
    for joint in range(n - 1, first + 2, -1):
        point = _moved(arm, joint, q[:, joint], point)
    for joint in range(first):
        goal = _moved(arm, joint, -q[:, joint], goal)
    three = slice(first, first + 3)
    screws = np.concatenate([arm.axes[:, three], arm.points[:, three]], axis=-1).reshape(len(q), 18)
    sequence = int("1" + "".join("01"[int(slides)] for slides in arm.sliding[three]), 2)
    found, states = inverse_general(np.concatenate([screws, point], axis=-1), goal, sequence)
    later = np.arange(states.shape[-1]) > 0
    none = (states == _BAD_INPUT) | (states == _DUPLICATE) | (later & (states == _UNREACHABLE))
    rows = np.repeat(q[:, None], states.shape[-1], axis=1)
    rows[..., three] = found
    return np.where(none[..., None], np.nan, rows)


def _of_target(arm: Arm, vector: Reals) -> Reals:
    """Vectors of the foot as the target has them."""
    return vector if arm.rotation is None else np.asarray((arm.rotation @ vector[..., None])[..., 0])


def _moved(arm: Arm, joint: int, q: Reals, point: Reals) -> Reals:
    axis, centre = arm.axes[:, joint], arm.points[:, joint]
    return np.asarray(point + q[:, None] * axis if arm.sliding[joint] else centre + turned(axis, q, point - centre))


def _seen_by(arm: Arm, before: int, q: Reals, direction: Reals) -> Reals:
    """Directions of the foot as the target has them, seen by joint `before` where the joints before it have the values q [b, m, n]."""
    seen = np.broadcast_to(_of_target(arm, direction)[:, None], (*q.shape[:2], 3))
    for joint in range(before):
        if not arm.sliding[joint]:
            seen = turned(arm.axes[:, None, joint], -q[..., joint], seen)
    return seen


def _last_angle(arm: Arm, rows: Reals) -> Reals:
    """Rows [b, m, n] whose last joint turns the foot as near as it can to what the target wants."""
    axis, after = arm.axes[:, -1], rows.copy()
    if not arm.sliding[-1]:
        mark, _ = across(axis)
        after[..., -1] = angle_about(axis[:, None], mark[:, None], _seen_by(arm, len(arm.sliding) - 1, rows, mark))
    return after


def _wrist_rows(arm: Arm, centre: Reals, q: Reals) -> Reals:
    """Rows for arms with a wrist; joints before the three that move its centre are as in q.

    With the wrist's axes a, b, c and B(q) the turn about b, a . B(q) c is known: two ways.
    """
    rows = np.repeat(_three_joints(arm, len(arm.sliding) - 6, centre, q), 2, axis=1)
    a, b, c = np.moveaxis(arm.axes[:, -3:], 1, 0)
    along = dot(a, b) * dot(b, c)
    sine, rest = dot(a, np.cross(b, c)), dot(a, c) - along
    aim = _seen_by(arm, len(arm.sliding) - 3, rows, c)
    wanted = dot(a[:, None], aim) - along[:, None]
    cosine = np.clip(wanted / np.maximum(np.hypot(sine, rest), np.finfo(float).tiny)[:, None], -1.0, 1.0)
    ways = np.where(np.arange(rows.shape[1]) % 2 == 0, 1.0, -1.0)
    rows[..., -2] = np.arctan2(sine, rest)[:, None] + ways * np.arccos(cosine)
    rows[..., -3] = angle_about(a[:, None], turned(b[:, None], rows[..., -2], np.broadcast_to(c[:, None], aim.shape)), aim)
    return _last_angle(arm, rows)

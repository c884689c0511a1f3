"""Chains of up to 16 joints given by their axes: foot, Jacobian and distance from a target; the reference of walkgen_serial.h.

Lengths are scaled to about 1 by a power of 2 and seen from the first joint's point. Of a pose, the error is the foot's distance and the
rotation vector to the target, times `length`. Or chains given by a function of theirs: then a foot that is nowhere is infinitely far from
its target.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from walkgen.runtime.solves.rows import Integers, Reals, Truths, sliding_of
from walkgen.runtime.solves.spatial import dot, norm

Places = NDArray[np.intp]

MOST_JOINTS = 16
EPSILON = float(np.finfo(float).eps)
TOLERANCE = 1e-12
_RIGID = 1e-6
FAR = 20
_POSITION = 3


@dataclass(frozen=True)
class Motion:
    """The function of q [b, n] that describes the chains instead of their axes, in the caller's lengths; what it takes after q [b, ...].

    It gives the foot [3] and margins [edges], their slopes [3 + edges, n] and second derivatives [3 + edges, n, n] in one row
    [b, (3 + edges) (1 + n + n n)], NaN where there is no foot. A margin has no unit, it is positive where loops close and 0 where they
    cease to, and goes there in proportion to q. Or it is `charted`, see `walkgen.runtime.solves.edges`.
    """

    function: Callable[..., Reals]
    data: tuple[Reals, ...]
    edges: int = 0
    charted: bool = False

    @property
    def rough(self) -> float:
        """How many roundings slopes are known to."""
        return EPSILON**-0.5 if self.charted else 1024.0

    def take(self, rows: Places) -> "Motion":
        """Some rows."""
        return replace(self, data=tuple(item[rows] for item in self.data))

    def at(self, sliding: Truths, size: Integers, q: Reals) -> tuple[Reals, Reals, Reals, Truths]:
        """Foot and margins [b, 3 + edges], their slopes [.., n] and second derivatives [.., n, n] at q, all in the scale 2^-size [b].

        And which rows have a foot.
        """
        n, count, rows = len(sliding), len(q), 3 + self.edges
        with np.errstate(all="ignore"):
            own = np.where(sliding, np.ldexp(q, size[:, None]), q)
            values = np.asarray(self.function(own, *self.data), float).reshape(count, rows * (1 + n + n * n))
            feet, slopes, bends = (
                values[:, :rows],
                values[:, rows : rows * (1 + n)].reshape(count, rows, n),
                values[:, rows * (1 + n) :].reshape(count, rows, n, n),
            )
            units, lengths = sliding.astype(int), (np.arange(rows) < _POSITION).astype(int)
            feet = np.ldexp(feet, -lengths * size[:, None])
            slopes = np.ldexp(slopes, (units - lengths[:, None]) * size[:, None, None])
            bends = np.ldexp(bends, (units[:, None] + units - lengths[:, None, None]) * size[:, None, None, None])
        there = every(np.isfinite(feet[:, :3])) & every(every(np.isfinite(slopes[:, :3]))) & np.isfinite(bends[:, :3]).all((1, 2, 3))
        return feet, slopes, bends, there


@dataclass(frozen=True)
class Arm:
    """Rows of chains at q = 0, base to foot, and their targets, in the arm's scale: the caller's lengths times 2^-size.

    `sliding` [n]; `axes`, `points`, `levers` [b, n, 3] with levers from a joint's point to the next one's, the last to the foot; `foot`,
    `target` [b, 3]; `rotation` [b, 3, 3] is what turns the foot from its rotation at q = 0 to the target's, None for a position;
    `size`, `length`, `reach`, `tolerance` [b]. With a `motion` there are no axes, points, levers and foot.
    """

    sliding: Truths
    axes: Reals
    points: Reals
    levers: Reals
    foot: Reals
    target: Reals
    rotation: Reals | None
    size: Integers
    length: Reals
    reach: Reals
    tolerance: Reals
    motion: Motion | None = None

    @property
    def ends(self) -> bool:
        """Whether edges where the foot ends are to be met."""
        return self.motion is not None and not self.motion.charted

    def take(self, rows: Places) -> "Arm":
        """Some rows."""
        axes, points, levers, foot, target = (item[rows] for item in (self.axes, self.points, self.levers, self.foot, self.target))
        rotation = None if self.rotation is None else self.rotation[rows]
        length, reach, tolerance = (item[rows] for item in (self.length, self.reach, self.tolerance))
        motion = None if self.motion is None else self.motion.take(rows)
        return Arm(self.sliding, axes, points, levers, foot, target, rotation, self.size[rows], length, reach, tolerance, motion)


@dataclass(frozen=True)
class Stance:
    """Joint values [b, n] and what follows.

    `jacobian` [b, 3 or 6, n], rotations times `length`; `turning` [b, n, 3], the axes that turn; `error` [b, 3 or 6]; its size `gap` [b];
    `edge` [b, n], 1 or -1 where the foot is known to end above or below a joint's value.
    """

    q: Reals
    jacobian: Reals
    turning: Reals
    error: Reals
    gap: Reals
    edge: Reals

    def take(self, rows: Places) -> "Stance":
        """Some rows."""
        return Stance(*(item[rows] for item in (self.q, self.jacobian, self.turning, self.error, self.gap, self.edge)))

    def put(self, rows: Places, other: "Stance") -> "Stance":
        """Other values in some rows."""
        return Stance(
            _put(self.q, rows, other.q),
            _put(self.jacobian, rows, other.jacobian),
            _put(self.turning, rows, other.turning),
            _put(self.error, rows, other.error),
            _put(self.gap, rows, other.gap),
            _put(self.edge, rows, other.edge),
        )


def _put(old: Reals, rows: Places, new: Reals) -> Reals:
    values = old.copy()
    values[rows] = new
    return values


def read_arm(geometry: Reals, p: Reals, sequence: int) -> tuple[Arm | None, Truths]:
    """The arms of rows of geometry [b, 6 n + 3] and positions [b, 3]; None for an impossible sequence; which rows are arms."""
    sliding = sliding_of(sequence) if sequence > 1 else np.zeros(0, bool)
    n = len(sliding)
    if not 0 < n <= MOST_JOINTS:
        return None, np.zeros(len(p), bool)
    with np.errstate(over="ignore", invalid="ignore"):
        fine = every(np.isfinite(geometry[:, : 6 * n + 3])) & every(np.isfinite(p))
        parts = np.where(fine[:, None], geometry[:, : 6 * n], 0.0).reshape(-1, n, 2, 3)
        base = parts[:, 0, 1]
        points, foot, target = parts[:, :, 1] - base[:, None], geometry[:, 6 * n : 6 * n + 3] - base, p - base
        fine &= every(np.isfinite(np.concatenate([points.reshape(len(p), 3 * n), foot, target], axis=-1)))
    points, foot, target = (
        np.where(fine[:, None, None], points, 0.0),
        np.where(fine[:, None], foot, 0.0),
        np.where(fine[:, None], target, 0.0),
    )
    away = np.max(np.abs(np.where(fine[:, None], base, 0.0)), axis=-1)
    return _scaled(sliding, parts[:, :, 0], points, foot, target, away), fine


def read_pose(geometry: Reals, T: Reals, sequence: int) -> tuple[Arm | None, Truths]:
    """The same with rigid transforms [b, 4, 4] for targets; the foot's rotation at q = 0 follows its position: geometry [b, 6 n + 12]."""
    arm, fine = read_arm(geometry, T[:, :3, 3], sequence)
    if arm is None:
        return None, fine
    with np.errstate(over="ignore", invalid="ignore"):
        turn = T[:, :3, :3]
        fine = fine & (np.abs(T[:, 3] - np.array([0.0, 0.0, 0.0, 1.0])) <= _RIGID).all(axis=-1) & (np.abs(turn) <= 2.0).all(axis=(-2, -1))
        home = geometry[:, 6 * len(arm.sliding) + 3 :].reshape(-1, 3, 3)
        rotation = turn @ np.swapaxes(home, -1, -2)
        for _ in range(3):  # the nearest rotation
            square = rotation @ np.swapaxes(rotation, -1, -2)
            fine = fine & (np.abs(square - np.eye(3)) <= _RIGID).all(axis=(-2, -1))
            rotation = (1.5 * np.eye(3) - 0.5 * square) @ rotation
        fine = fine & (dot(turn[:, 0], np.cross(turn[:, 1], turn[:, 2])) > 0.0)
    return replace(arm, rotation=np.where(fine[:, None, None], rotation, np.eye(3))), fine


def _scaled(sliding: Truths, axes: Reals, points: Reals, foot: Reals, target: Reals, away: Reals) -> Arm:
    """Lengths by a power of 2 to about 1. A target very far from an arm that does not slide comes nearer: only its direction counts.

    The tolerance is what roundings leave open, those of where the arm stands too, so far away [b]; an arm that is one is not enlarged.
    """
    farthest = np.max(np.abs(target), axis=-1)
    largest = np.maximum(np.max(np.abs(foot), axis=-1), np.max(np.abs(points), axis=(-2, -1)))
    largest = np.maximum(largest, np.ldexp(away, -FAR))
    _, size = np.frexp(np.maximum(largest, farthest) if sliding.any() else largest)
    far = np.frexp(farthest)[1]
    far = np.where(far - size > FAR, far - FAR, size)
    target, foot, points = np.ldexp(target, -far[:, None]), np.ldexp(foot, -size[:, None]), np.ldexp(points, -size[:, None, None])
    points, levers = _next_to_each_other(sliding, axes, points, foot)
    reach = np.sum(norm(levers), axis=-1) + (norm(target) if sliding.any() else 0.0)
    length, tolerance = 0.25 * np.maximum(reach, 0.01), TOLERANCE * reach + 4.0 * EPSILON * np.ldexp(away, -far)
    return Arm(sliding, axes, points, levers, foot, target, None, size, length, reach, tolerance)


def _next_to_each_other(sliding: Truths, axes: Reals, points: Reals, foot: Reals) -> tuple[Reals, Reals]:
    """Points slid along their axes towards the foot, and the levers between them."""
    near, levers, beyond = points.copy(), np.empty_like(points), foot
    with np.errstate(over="ignore", invalid="ignore"):
        for joint in range(len(sliding) - 1, -1, -1):
            if sliding[joint]:
                near[:, joint] = beyond
            else:
                near[:, joint] += dot(axes[:, joint], beyond - points[:, joint])[:, None] * axes[:, joint]
            levers[:, joint] = beyond - near[:, joint]
            beyond = near[:, joint]
    return near, levers


def stance_at(arm: Arm, q: Reals) -> Stance:
    """Everything at q [b, n]."""
    if arm.motion is not None:
        return _moved_to(arm, arm.motion, q)
    n = len(arm.sliding)
    R, x = np.broadcast_to(np.eye(3), (len(q), 3, 3)), arm.points[:, 0]
    directions, origins = np.empty((len(q), n, 3)), np.empty((len(q), n, 3))
    with np.errstate(over="ignore", invalid="ignore"):
        for joint in range(n):
            direction = _times(R, arm.axes[:, joint])
            directions[:, joint], origins[:, joint] = direction, x
            if arm.sliding[joint]:
                x = x + q[:, joint, None] * direction
            else:
                R = R @ _turn(arm.axes[:, joint], q[:, joint])
            x = x + _times(R, arm.levers[:, joint])
        sliding = arm.sliding[:, None]
        columns = np.where(sliding, directions, np.cross(directions, x[:, None] - origins))
        turning = np.where(sliding, 0.0, directions)
        error = x - arm.target
        if arm.rotation is not None:
            columns = np.concatenate([columns, arm.length[:, None, None] * turning], axis=-1)
            missing = rotation_vector(R @ np.swapaxes(arm.rotation, -1, -2))
            error = np.concatenate([error, arm.length[:, None] * missing], axis=-1)
        return Stance(q, np.swapaxes(columns, -1, -2), turning, error, norm(error), np.zeros_like(q))


def _moved_to(arm: Arm, motion: Motion, q: Reals) -> Stance:
    feet, slopes, _, there = motion.at(arm.sliding, arm.size, q)
    error = np.where(there[:, None], feet[:, :_POSITION] - arm.target, np.inf)
    jacobian = np.where(there[:, None, None], slopes[:, :_POSITION], 0.0)
    return Stance(q, jacobian, np.zeros((*q.shape, 3)), error, norm(error), np.zeros_like(q))


def _times(R: Reals, vector: Reals) -> Reals:
    return np.asarray((R @ vector[..., None])[..., 0])


def _turn(axis: Reals, angle: Reals) -> Reals:
    """Rodrigues: rotation matrices [b, 3, 3] about unit axes [b, 3]."""
    x, y, z = axis.T
    zero = np.zeros_like(x)
    side = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)
    c, s = np.cos(angle)[:, None, None], np.sin(angle)[:, None, None]
    return np.asarray(c * np.eye(3) + s * side + (1.0 - c) * axis[:, :, None] * axis[:, None, :])


def rotation_vector(M: Reals) -> Reals:
    """The rotation vectors [b, 3] of rotation matrices [b, 3, 3], at most pi long."""
    cosine = 0.5 * (np.trace(M, axis1=-2, axis2=-1) - 1.0)
    half = 0.5 * np.stack([M[:, 2, 1] - M[:, 1, 2], M[:, 0, 2] - M[:, 2, 0], M[:, 1, 0] - M[:, 0, 1]], axis=-1)
    sine = norm(half)
    angle = np.arctan2(sine, cosine)
    usual = half * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 1.0)[:, None]
    # Nearly half a turn: the axis from M + M', which is about 2 axis axis' - 2.
    place = np.argmax(np.diagonal(M, axis1=-2, axis2=-1), axis=-1)[:, None, None]
    even = 0.5 * (M + np.swapaxes(M, -1, -2)) - cosine[:, None, None] * np.eye(3)
    column = np.take_along_axis(even, place, axis=-1)[..., 0]
    signed = np.where(dot(column, half) < 0.0, -angle, angle)
    size = norm(column)
    turned = column * (signed / np.where(size > 0.0, size, 1.0))[:, None]
    return np.where((cosine > -0.9)[:, None], usual, turned)


def every(truths: Truths) -> Truths:
    """Over the last axis."""
    return np.asarray(np.all(truths, axis=-1))


def some(truths: Truths) -> Truths:
    """Over the last axis."""
    return np.asarray(np.any(truths, axis=-1))


def reaches(arm: Arm, at: Stance) -> Truths:
    """Whether the foot, and its rotation, are where they are wanted but for roundings [b]."""
    there = norm(at.error[:, :3]) <= arm.tolerance
    return there if arm.rotation is None else there & (norm(at.error[:, 3:]) <= TOLERANCE * arm.length)

"""Joint values of a walk: every leg's inverse for a whole walk in one call, on the branch that it keeps."""

from typing import NamedTuple

import numpy as np

from walkgen.gait.planned import is_planned
from walkgen.runtime.robot import Leg, Robot
from walkgen.signature import STATUSES

_OK, _UNREACHABLE = STATUSES.index("OK"), STATUSES.index("UNREACHABLE")


class Postures(NamedTuple):
    """Joint values [t,nq] and every leg's status [t,k]."""

    q: np.ndarray
    status: np.ndarray


def postures(robot: Robot, feet: np.ndarray, chains: np.ndarray) -> Postures:
    """Joint values with every foot on its target, begun near the middle of the limits.

    Args:
        robot: with `inverse` or `inverse_near` of every leg.
        feet: targets [t,k,3] in the first platform's frame (m).
        chains: robot's joint values [t,nq] of which those of the chains, and of legs that are planned by their joints, are kept.
    """
    q = chains.copy()
    near = middle(robot.limits)
    status = np.zeros(feet.shape[:2], np.int32)
    targets = _on_platforms(robot, feet, chains)
    for foot, leg in enumerate(robot.legs.values()):
        if is_planned(leg):
            continue
        q[:, leg.slice], status[:, foot] = _leg(leg, targets[:, foot], near[leg.slice])
    return Postures(q, status)


def middle(limits: np.ndarray) -> np.ndarray:
    """The middle of the limits, 0 where there is none."""
    bounded = np.isfinite(limits).all(axis=-1)
    found: np.ndarray = np.where(bounded, np.where(np.isfinite(limits), limits, 0.0).mean(axis=-1), 0.0)
    return found


def platform_poses(robot: Robot, q: np.ndarray) -> np.ndarray:
    """Poses of the platforms in the first one's frame [t,m,4,4]."""
    if not robot.chains:
        return np.broadcast_to(np.eye(4), (len(q), len(robot.platforms), 4, 4))
    found: np.ndarray = robot.platform_poses(q)
    return found


def carriers(robot: Robot) -> list[int]:
    """The number of every leg's platform."""
    return [robot.platforms.index(leg.platform) for leg in robot.legs.values()]


def _on_platforms(robot: Robot, feet: np.ndarray, q: np.ndarray) -> np.ndarray:
    poses = platform_poses(robot, q)[:, carriers(robot)]
    if len(robot.platforms) == 1:
        return feet
    away = feet - poses[..., :3, 3]
    targets: np.ndarray = sum(away[..., axis, None] * poses[..., axis, :3] for axis in range(3))
    return targets


def _leg(leg: Leg, targets: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if "inverse" in leg.functions:
        q, status = leg.inverse(targets)
        return _kept(q, status, near, leg.limits)
    return _seeded(leg, targets, near)


def _kept(q: np.ndarray, status: np.ndarray, near: np.ndarray, limits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of all branches [t,b,n] the one that begins within the limits and nearest to `near`, and goes on without a jump."""
    lost = status != _OK
    outside = np.maximum(limits[:, 0] - q[0], q[0] - limits[:, 1]).max(axis=-1) > 0.0
    away = np.nan_to_num(np.abs(wrapped(q[0] - near)).sum(axis=-1), nan=np.inf)
    first = min(range(q.shape[1]), key=lambda b: (lost[0, b], outside[b], away[b]))
    slots = _followed(q, lost, first)
    rows = np.arange(len(q))
    return continued(q[rows, slots], limits), status[rows, slots]


def _followed(q: np.ndarray, lost: np.ndarray, first: int) -> np.ndarray:
    """Slots [t] that follow each other with the least change; a slot stays where no branch reaches the target."""
    along = np.ascontiguousarray(q.transpose(2, 1, 0))  # the instants last: sums of few terms run along memory
    near = np.abs(wrapped(along[..., 1:] - along[:, first, None, :-1])).sum(axis=0).T
    if not lost[:, first].any() and (np.nan_to_num(near, nan=np.inf).argmin(axis=1) == first).all():
        return np.full(len(q), first)
    change = np.abs(wrapped(q[1:, None] - q[:-1, :, None])).sum(axis=-1)
    change = np.where(lost[1:, None, :] | np.isnan(change), np.inf, change)
    own = np.arange(q.shape[1])
    change[:, own, own] -= 1e-9
    following = np.where(np.isinf(change).all(axis=-1), own, change.argmin(axis=-1)).tolist()
    slots = [first]
    for step in following:
        slots.append(step[slots[-1]])
    return np.array(slots)


def _seeded(leg: Leg, targets: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Instant after instant, each from the one before."""
    q, status = np.empty((len(targets), len(near))), np.empty(len(targets), np.int32)
    for i, target in enumerate(targets):
        q[i], status[i] = leg.inverse_near(target, near)
        near = q[i] if status[i] == _OK else near
    return continued(q, leg.limits), status


def wrapped(angle: np.ndarray) -> np.ndarray:
    """The difference of two angles in (-pi, pi]; of small lengths the same."""
    turned: np.ndarray = angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
    return turned


def continued(q: np.ndarray, limits: np.ndarray) -> np.ndarray:
    """Without jumps by a turn from instant to instant [t,n]; begun within the limits where a whole turn brings it there."""
    steps = np.diff(q, axis=0)
    turns = np.cumsum(np.round(np.nan_to_num(steps) / (2.0 * np.pi)), axis=0)
    joined = q.copy()
    joined[1:] -= 2.0 * np.pi * turns
    for shift in (2.0 * np.pi, -2.0 * np.pi):
        outside = (joined[0] < limits[:, 0]) | (joined[0] > limits[:, 1])
        moved = joined[0] + shift
        fits = outside & (moved >= limits[:, 0]) & (moved <= limits[:, 1])
        joined[:, fits] += shift
    return joined


def missing(robot: Robot, feet: np.ndarray, q: np.ndarray) -> np.ndarray:
    """How far every foot [t,k] stays from its target (m); NaN where the target is none."""
    away: np.ndarray = np.linalg.norm(robot.foot_positions(q) - feet, axis=-1)
    return away

"""Connecting chains of a modular robot on its way: held, or adapted to the footholds at knots and smooth between them."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from walkgen.gait.motion import Motion
from walkgen.gait.spline import Spline
from walkgen.gait.steps import Standing
from walkgen.runtime.robot import Robot
from walkgen.signature import STATUSES

Rest = tuple[float, float] | None
"""When a walk from rest to rest begins and ends (s); None of steady ones."""
_OK = STATUSES.index("OK")


class Bending(NamedTuple):
    """Robot's joint values [t,nq] that are 0 for legs, their rates and accelerations; `failed` are knots (s) without a stationary pose."""

    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    failed: np.ndarray


def held(robot: Robot, t: np.ndarray) -> Bending:
    """Chains straight, at the joint values 0, or as near as their limits are."""
    chains = joints(robot)
    q = np.zeros((len(t), len(robot.joint_names)))
    q[:, chains] = np.clip(0.0, robot.limits[chains, 0], robot.limits[chains, 1])
    return Bending(q, np.zeros_like(q), np.zeros_like(q), np.empty(0))


def adapted(robot: Robot, footholds: Standing, body: Callable[[np.ndarray], Motion], t: np.ndarray, rest: Rest) -> Bending:
    """Chains as `robot.adapt` has them best at instants of equal distance, 16 a period, on a spline between them.

    Legs follow by their own inverse at every instant, so feet stay exactly where they are placed.

    Args:
        robot: with `adapt`.
        footholds: of the feet.
        body: motion of the first platform at times [m].
        t: instants (s).
        rest: from when to when the walk goes, where chains are at rest; steadily where it is None.
    """
    start, end = (float(t[0]), float(t[-1])) if rest is None else rest
    count = max(math.ceil((end - start) / footholds.spacing), 1)
    spacing = footholds.spacing if rest is None else (end - start) / count
    knots = start + spacing * np.arange(count + 1)
    motion, below = body(knots), footholds.below(knots)
    targets = motion.inward(below - motion.position[:, None])
    known = np.isfinite(targets).all(axis=(1, 2))
    if not known.any():
        return held(robot, t)
    q, status = best_poses(robot, targets[known])
    chains = joints(robot)
    values = _bridged(knots, knots[known], q[:, chains])
    value, rate, second = Spline(start, spacing, values, rest is not None).at(t)
    found = np.zeros((3, len(t), len(robot.joint_names)))
    found[:, :, chains] = value, rate, second
    return Bending(found[0], found[1], found[2], knots[known][status != _OK])


def best_poses(robot: Robot, targets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joint values [m,nq] of footholds [m,k,3] (m), with statuses: from the first pose; where that is no good start, from those beside.

    Args:
        robot: with `adapt`.
        targets: of its feet in the first platform's frame, one after another.
    """
    none = np.zeros((len(robot.platforms), 3))
    start, _, _ = robot.adapt(targets[0], none)
    q, status, _ = robot.adapt(targets, none, start)
    for shift in (1, -1, 2, -2):
        beside = np.clip(np.arange(len(q)) + shift, 0, len(q) - 1)
        again = np.flatnonzero((status != _OK) & (status[beside] == _OK))
        if again.size:
            found, then, _ = robot.adapt(targets[again], none, q[beside[again]])
            better = then == _OK
            q[again[better]], status[again[better]] = found[better], _OK
    return q, status


def _bridged(knots: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values at all knots [m,n]: straight from one known knot to the next over those where a foot has no ground or no pose was found."""
    fine = np.isfinite(values).all(axis=1)
    return np.stack([np.interp(knots, known[fine], column[fine]) if fine.any() else np.zeros(len(knots)) for column in values.T], axis=-1)


def joints(robot: Robot) -> list[int]:
    """The numbers of all chains' joints."""
    return [joint for chain in robot.chains.values() for joint in range(chain.slice.start, chain.slice.stop)]

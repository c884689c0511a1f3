"""Connecting chains of a modular robot on its way: held, or adapted to the footholds at knots and smooth between them."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from walkgen.gait.footholds import Footholds
from walkgen.gait.motion import Motion
from walkgen.gait.spline import Spline
from walkgen.runtime.robot import Robot
from walkgen.signature import STATUSES

_KNOTS_PER_PERIOD = 16
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


def adapted(robot: Robot, footholds: Footholds, body: Callable[[np.ndarray], Motion], t: np.ndarray) -> Bending:
    """Chains as `robot.adapt` has them best at 16 instants of a period, on a spline between them.

    Legs follow by their own inverse at every instant, so feet stay exactly where they are placed.

    Args:
        robot: with `adapt`.
        footholds: of the feet.
        body: motion of the first platform at times [m].
        t: instants (s).
    """
    spacing = footholds.trajectory.gait.period / _KNOTS_PER_PERIOD
    count = math.ceil((t[-1] - t[0]) / spacing) + 1
    knots = t[0] + spacing * np.arange(max(count, 2))
    motion, below = body(knots), footholds.below(knots)
    targets = motion.inward(below - motion.position[:, None])
    none = np.zeros((len(robot.platforms), 3))
    start, _, _ = robot.adapt(targets[0], none)
    q, status, _ = robot.adapt(targets, none, start)
    chains = joints(robot)
    value, rate, second = Spline(float(knots[0]), spacing, q[:, chains]).at(t)
    found = np.zeros((3, len(t), len(robot.joint_names)))
    found[:, :, chains] = value, rate, second
    return Bending(found[0], found[1], found[2], knots[status != _OK])


def joints(robot: Robot) -> list[int]:
    """The numbers of all chains' joints."""
    return [joint for chain in robot.chains.values() for joint in range(chain.slice.start, chain.slice.stop)]

"""Where robots on curved soles put their feet on a slope: so far up or down that the load is over them as it is on level ground."""

from dataclasses import replace

import numpy as np

from walkgen.gait.ground import Ground, Slope
from walkgen.gait.rolling import is_rolling
from walkgen.gait.simulate import Options, planned, state
from walkgen.gait.trajectory import Trajectory
from walkgen.runtime.robot import Robot

_LOOKS = 48
_REPEATS = 40
_SETTLED = 1e-12
"""m."""


def leaned(robot: Robot, trajectory: Trajectory, ground: Ground, options: Options) -> Trajectory:
    """The walk with its stance moved along the platform's x, all feet alike; as it is where nothing rolls, or nothing has a mass.

    The platform goes along with the ground, and the load hangs from it vertically: over a cycle its mean place on the ground, from the
    feet, is to be that of the same walk on level ground. Sideways such legs cannot move.

    Args:
        robot: that walks.
        trajectory: of its feet.
        ground: that it walks over.
        options: how it walks.
    """
    if not hasattr(robot, "com") or not any(map(is_rolling, robot.legs.values())):
        return trajectory
    steady = replace(options, from_rest=False, adapt=False)
    wanted, shift = _ahead(robot, trajectory, Slope(), steady), 0.0
    for _ in range(_REPEATS):
        away = _ahead(robot, _moved(trajectory, shift), ground, steady) - wanted
        if not abs(away) > _SETTLED:
            break
        shift += away
    return _moved(trajectory, shift)


def _ahead(robot: Robot, trajectory: Trajectory, ground: Ground, options: Options) -> float:
    """How far the load is over the ground ahead of the feet's middle along the platform's x, in the mean of a cycle (m)."""
    plan = planned(trajectory, ground, options)
    now = state(robot, plan, options.adapt, np.arange(_LOOKS) / _LOOKS * trajectory.gait.period)
    com = now.motion.inward((now.com - now.motion.position)[:, None])[:, 0]
    up = now.motion.rotation[:, 2]
    feet = np.mean(trajectory.stance, axis=0)
    below = com[:, 0] - (com[:, 2] - feet[2]) * up[:, 0] / up[:, 2]
    return float(np.mean(below) - feet[0])


def _moved(trajectory: Trajectory, shift: float) -> Trajectory:
    return replace(trajectory, stance=tuple((x + shift, y, z) for x, y, z in trajectory.stance)) if shift else trajectory

"""Whether a robot's legs reach the feet of a gait: where targets leave a leg's workspace, joint limits counted, and by how much."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.gait.trajectory import Trajectory
from walkgen.runtime.robot import Gait as BuiltGait
from walkgen.runtime.robot import Leg, Robot

_SAMPLES = 64
_HAIR = 1e-9
"""m; less than this is rounding."""


@dataclass(frozen=True)
class Shortfall:
    """The worst of what a leg misses in a cycle.

    Attributes:
        leg: its name.
        phase: local phase of the point.
        point: where the foot should be, in the frame of the leg's platform (m).
        distance: how far from there the leg can bring its foot at best (m).
    """

    leg: str
    phase: float
    point: tuple[float, float, float]
    distance: float

    def __str__(self) -> str:
        where = ", ".join(f"{entry:.4f}" for entry in self.point)
        return f"{self.leg} misses ({where}), at {self.phase:.3f} of its cycle, by {self.distance:.4f} m"


def shortfalls(robot: Robot, gait: BuiltGait, twist: Any = None, samples: int = _SAMPLES) -> tuple[Shortfall, ...]:
    """Legs that cannot follow the gait on level ground, with connecting chains at q = 0.

    Args:
        robot: built with its legs' `inverse_admissible` and `foot_position`, and with `platform_poses` where it has chains.
        gait: one of its gaits, with a stance.
        twist: of the first platform [3], as `foot_targets` takes it.
        samples: instants of the cycle that are looked at, beside the ends of every support.

    Raises:
        ValueError: the gait has no stance.
    """
    trajectory = Trajectory.of(gait)
    poses = robot.platform_poses(np.zeros(len(robot.joint_names))) if robot.chains else np.eye(4)[None]
    frames = dict(zip(robot.platforms, poses, strict=True))
    return tuple(_missed(robot, trajectory, frames, twist, samples))


def _missed(robot: Robot, trajectory: Trajectory, frames: dict[str, np.ndarray], twist: Any, samples: int) -> Iterator[Shortfall]:
    gait = trajectory.gait
    ends = [event.at * gait.period for event in gait.events]
    times = np.concatenate([np.arange(samples) / samples * gait.period, ends])
    feet, phases = trajectory.platform(times, twist).position, gait.leg_phase(times)
    for place, name in enumerate(gait.legs):
        leg = robot.legs[name]
        pose = frames[leg.platform]
        points = (feet[:, place] - pose[:3, 3]) @ pose[:3, :3]
        away = _distances(leg, points)
        worst = int(np.argmax(away))
        if away[worst] > _HAIR:
            x, y, z = points[worst].tolist()
            yield Shortfall(name, float(phases[worst, place]), (x, y, z), float(away[worst]))


def _distances(leg: Leg, points: np.ndarray) -> np.ndarray:
    q, _ = leg.inverse_admissible(points)
    distances: np.ndarray = np.linalg.norm(leg.foot_position(q) - points, axis=-1)
    return distances

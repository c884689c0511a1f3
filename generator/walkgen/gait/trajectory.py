"""Where feet are in support and in transfer: over level ground at a steady pace, or between footholds of any height."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from walkgen.gait.pattern import Gait
from walkgen.runtime.robot import Gait as BuiltGait
from walkgen.runtime.solves.gait import gait_targets, gait_transfers


class FootMotion(NamedTuple):
    """Position (m), velocity (m/s) and acceleration (m/s^2) of every foot [..., k, 3]."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


@dataclass(frozen=True)
class Trajectory:
    """The feet of a gait. Everything is continuous up to the acceleration, and feet meet the ground at its speed.

    Attributes:
        gait: when each foot is lifted and placed.
        stance: where each foot is in the middle of its support [k][3], in the platform's frame (m); z up.
        lift: how far a foot rises over the higher of its two footholds, half way (m).
        heel_off: the share of its support after which a foot with a curved sole rolls over its toe, less than 1.

    Raises:
        ValueError: not one point a leg.
    """

    gait: Gait
    stance: tuple[tuple[float, float, float], ...]
    lift: float
    heel_off: float = 0.5

    def __post_init__(self) -> None:
        points = np.asarray(self.stance, float)
        if points.shape != (len(self.gait.legs), 3):
            raise ValueError(f"stance has shape {list(points.shape)}; {len(self.gait.legs)} legs have [{len(self.gait.legs)}, 3]")
        object.__setattr__(self, "stance", tuple(map(tuple, points.tolist())))

    @classmethod
    def of(cls, built: BuiltGait) -> "Trajectory":
        """That of a loaded robot's gait: `Trajectory.of(robot.gait)`.

        Raises:
            ValueError: the spec gives it no stance.
        """
        if built.stance is None or built.lift is None:
            raise ValueError(f"{built!r} has no stance; the spec's gait table gives it")
        return cls(Gait.of(built), built.stance, built.lift, built.heel_off)

    @property
    def speed(self) -> float:
        """Of the platform, steadily (m/s)."""
        return self.gait.speed

    @property
    def summary(self) -> str:
        """In words."""
        return f"period {self.gait.period:.4g} s, stride {self.gait.stride:.4g} m"

    def ordered(self, legs: Sequence[str]) -> "Trajectory":
        """The same with its legs in another order.

        Raises:
            ValueError: not the same legs.
        """
        gait = self.gait.ordered(legs)
        return Trajectory(gait, tuple(self.stance[self.gait.legs.index(leg)] for leg in legs), self.lift, self.heel_off)

    def platform(self, t: Any, twist: Any = None) -> FootMotion:
        """In the frame of the platform, which moves steadily over level ground.

        Args:
            t: [...] (s).
            twist: of the platform in its own frame [..., 3]: velocity along x and y (m/s), turning about z (rad/s); the gait's speed
                along x where it is left out.
        """
        return FootMotion(*gait_targets(*self._numbers, np.array(self.stance), t, self._twist(twist)))

    def world(self, t: Any, twist: Any = None) -> FootMotion:
        """The same in the world, where the platform's frame was at t = 0: feet in support stand still."""
        position, velocity, acceleration = self.platform(t, twist)
        pose, rates = platform_pose(t, self._twist(twist)), self._twist(twist)[..., None, :]
        carried = velocity + _moved(rates, position)
        felt = acceleration + _turned(rates, velocity) + _turned(rates, carried)
        here, *there = (np.einsum("...ij,...kj->...ki", pose[..., :3, :3], part) for part in (position, carried, felt))
        return FootMotion(here + pose[..., None, :3, 3], *there)

    def between(self, t: Any, start: Any, end: Any) -> FootMotion:
        """In a frame at rest: feet in support stand at `start`, the others are on their way from `start` to `end` [..., k, 3] (m)."""
        return FootMotion(*gait_transfers(*self._numbers, t, start, end))

    def _twist(self, twist: Any) -> np.ndarray:
        return np.array([self.gait.speed, 0.0, 0.0]) if twist is None else np.asarray(twist, float)

    @property
    def _numbers(self) -> tuple[np.ndarray, np.ndarray, int, float, float]:
        gait = self.gait
        return np.array(gait.duty_factor), np.array(gait.phase), len(gait.legs), gait.period, self.lift


def platform_pose(t: Any, twist: Any) -> np.ndarray:
    """world_T_platform [..., 4, 4] at t [...] of a platform with a constant twist [..., 3] in its own frame, which starts as the world."""
    t, twist = np.asarray(t, float), np.asarray(twist, float)
    angle = twist[..., 2] * t
    along, across = np.sinc(angle / np.pi), np.sin(angle / 2) * np.sinc(angle / (2 * np.pi))
    pose = np.zeros((*angle.shape, 4, 4))
    pose[..., 0, 0] = pose[..., 1, 1] = np.cos(angle)
    pose[..., 1, 0] = np.sin(angle)
    pose[..., 0, 1] = -pose[..., 1, 0]
    pose[..., 2, 2] = pose[..., 3, 3] = 1.0
    pose[..., 0, 3] = t * (along * twist[..., 0] - across * twist[..., 1])
    pose[..., 1, 3] = t * (across * twist[..., 0] + along * twist[..., 1])
    return pose


def _turned(twist: np.ndarray, vector: np.ndarray) -> np.ndarray:
    return np.cross(twist * [0.0, 0.0, 1.0], vector)


def _moved(twist: np.ndarray, point: np.ndarray) -> np.ndarray:
    moved: np.ndarray = twist * [1.0, 1.0, 0.0] + _turned(twist, point)
    return moved

"""Whether a robot's legs reach the feet of a gait: where targets leave a leg's workspace or its limits, and by how much."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.gait.chains import held
from walkgen.gait.legs import carriers, missing, platform_poses, postures
from walkgen.gait.planned import is_planned
from walkgen.gait.trajectory import Trajectory
from walkgen.runtime.robot import Leg, Robot

_SAMPLES = 64
_HAIR = 1e-9
_TOGETHER = 1e-9
"""m, and periods; less than this is rounding."""


@dataclass(frozen=True)
class Shortfall:
    """The worst of what a leg misses in a cycle.

    Attributes:
        leg: its name.
        phase: local phase of the point.
        point: where the foot should be, in the frame of the leg's platform (m).
        distance: how far from there the leg can bring its foot at best (m).
        part: of the cycle, in words.
    """

    leg: str
    phase: float
    point: tuple[float, float, float]
    distance: float
    part: str

    def __str__(self) -> str:
        where = ", ".join(f"{entry:.4f}" for entry in self.point)
        return f"{self.leg}: {self.part}, ({where}), is {1000 * self.distance:.4g} mm out of reach"


def shortfalls(
    robot: Robot, trajectory: Trajectory, twist: Any = None, samples: int = _SAMPLES, *, limits: bool = True
) -> tuple[Shortfall, ...]:
    """Legs that cannot follow a gait's feet on level ground, with connecting chains straight; but those that are planned by their joints.

    Args:
        robot: built with its legs' `inverse_admissible` and `foot_position`, or without limits with `inverse` and `foot_positions`, and
            where it has chains with `platform_poses`.
        trajectory: feet of all its legs.
        twist: of the first platform [3], as `foot_targets` takes it.
        samples: instants of the cycle that are looked at, beside ends and middle of every support.
        limits: whether joints keep to theirs.
    """
    return tuple(_missed(robot, trajectory.ordered(tuple(robot.legs)), twist, samples, limits=limits))


def _missed(robot: Robot, trajectory: Trajectory, twist: Any, samples: int, *, limits: bool) -> Iterator[Shortfall]:
    gait = trajectory.gait
    duty, phase = np.array(gait.duty_factor), np.array(gait.phase)
    looks = np.concatenate([np.arange(samples) / (samples or 1), phase, phase + 0.5 * duty, [event.at for event in gait.events]])
    feet, phases = trajectory.platform(looks * gait.period, twist).position, gait.leg_phase(looks * gait.period)
    local, away = _distances(robot, feet, limits=limits)
    for foot, (name, leg) in enumerate(robot.legs.items()):
        worst = int(np.argmax(away[:, foot]))
        if away[worst, foot] > _HAIR and not is_planned(leg):
            x, y, z = local[worst, foot].tolist()
            u = float(phases[worst, foot])
            yield Shortfall(name, u, (x, y, z), float(away[worst, foot]), _part(u, gait.duty_factor[foot]))


def _part(u: float, duty: float) -> str:
    """Of a cycle, at a local phase."""
    named = {0.0: "the front end of its stroke", 0.5 * duty: "its stance", duty: "the rear end of its stroke"}
    near = min(named, key=lambda place: abs(place - u))
    if abs(near - u) < _TOGETHER:
        return named[near]
    return f"its foot at {u:.3f} of its cycle, in {'support' if u < duty else 'transfer'}"


def _distances(robot: Robot, feet: np.ndarray, *, limits: bool) -> tuple[np.ndarray, np.ndarray]:
    """Targets [t,k,3] in the frames of the legs' platforms, and how far the legs stay from them [t,k]."""
    chains = held(robot, np.zeros(len(feet))).q
    poses = platform_poses(robot, chains)[:, carriers(robot)]
    local: np.ndarray = ((feet - poses[..., :3, 3])[..., None, :] @ poses[..., :3, :3])[..., 0, :]
    if not limits:
        return local, missing(robot, feet, postures(robot, feet, chains).q)
    away = [np.zeros(len(feet)) if is_planned(leg) else _missing(leg, local[:, foot]) for foot, leg in enumerate(robot.legs.values())]
    return local, np.stack(away, axis=-1)


def _missing(leg: Leg, points: np.ndarray) -> np.ndarray:
    q, _ = leg.inverse_admissible(points)
    distances: np.ndarray = np.linalg.norm(leg.foot_position(q) - points, axis=-1)
    return distances

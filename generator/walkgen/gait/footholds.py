"""Footholds of a walk: where each foot stands in each of its supports, and how it goes from one to the next."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from walkgen.gait.course import Course, Pace
from walkgen.gait.ground import Ground
from walkgen.gait.trajectory import FootMotion, Trajectory

_KNOTS_PER_PERIOD = 16


class Holds(NamedTuple):
    """Supports of all legs, one a row: leg, from when until when (s), where (m)."""

    leg: np.ndarray
    start: np.ndarray
    end: np.ndarray
    point: np.ndarray


@dataclass(frozen=True)
class Footholds:
    """Of supports `first`, `first` + 1, ... of every leg: points [k, m, 3] in the world (m); NaN where there is no ground.

    `skipped` [k, m] are the transfers after a support that a walk from rest to rest does not make: they began before it or would end after.
    """

    trajectory: Trajectory
    first: int
    points: np.ndarray
    skipped: np.ndarray

    @property
    def spacing(self) -> float:
        """Between instants at which chains are adapted (s)."""
        return self.trajectory.gait.period / _KNOTS_PER_PERIOD

    def transfers(self, cycles: int) -> list[tuple[float, float]]:
        """When legs are in transfer, in order (s): those of a walk of so many cycles, and one cycle more at either end where it goes on."""
        gait = self.trajectory.gait
        times = []
        for cycle in range(-1, cycles + 1):
            for leg, (phase, duty) in enumerate(zip(gait.phase, gait.duty_factor, strict=True)):
                if not self.skipped[leg, cycle - self.first]:
                    times.append(((cycle + phase + duty) * gait.period, (cycle + phase + 1) * gait.period))
        return sorted(times)

    def motion(self, t: np.ndarray) -> tuple[FootMotion, np.ndarray]:
        """Feet in the world [t,k,3], and whether each supports [t,k]."""
        support, start, end, held = self._between(t)
        moving = self.trajectory.between(t, start, end)
        rest = held[..., None]
        position, velocity, acceleration = np.where(rest, start, moving[0]), np.where(rest, 0.0, moving[1]), np.where(rest, 0.0, moving[2])
        return FootMotion(position, velocity, acceleration), support | held

    def below(self, t: np.ndarray) -> np.ndarray:
        """Feet in the world [t,k,3] that go straight from foothold to foothold instead of being lifted."""
        _, start, end, held = self._between(t)
        level = Trajectory(self.trajectory.gait, self.trajectory.stance, 0.0)
        flat = np.array([1.0, 1.0, 0.0])
        u = level.between(t, np.zeros_like(start), np.broadcast_to(flat, start.shape)).position[..., :1]
        return np.where(held[..., None], start, start + u * (end - start))

    def holds(self, until: float) -> Holds:
        """Supports that touch the time from 0 to `until` (s)."""
        gait = self.trajectory.gait
        duty, phase = np.array(gait.duty_factor)[:, None], np.array(gait.phase)[:, None]
        start = (self.first + np.arange(self.points.shape[1]) + phase) * gait.period
        end = start + duty * gait.period
        within = (end >= 0.0) & (start <= until)
        leg = np.broadcast_to(np.arange(len(start))[:, None], start.shape)
        return Holds(leg[within], start[within], end[within], self.points[within])

    def support(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The number of every leg's support, counted from `first`, that began last [t,k], and whether it has not ended yet."""
        gait = self.trajectory.gait
        u = gait.leg_phase(t)
        number = np.rint(t[:, None] / gait.period - gait.phase - u).astype(int) - self.first
        return number, u < np.array(gait.duty_factor)

    def _between(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        support, down = self.support(t)
        legs = np.arange(self.points.shape[0])
        return down, self.points[legs, support], self.points[legs, support + 1], self.skipped[legs, support] & ~down


def place(trajectory: Trajectory, course: Course, pace: Pace, ground: Ground) -> Footholds:
    """Every foot stands where its stance point is in the middle of a support.

    Args:
        trajectory: gait and stance.
        course: of the platform.
        pace: from 0 to its duration.
        ground: gives the footholds' height.
    """
    gait = trajectory.gait
    duty, phase = np.array(gait.duty_factor)[:, None], np.array(gait.phase)[:, None]
    first, last = -2, math.ceil(pace.duration / gait.period) + 2
    placed = (np.arange(first, last + 1) + phase) * gait.period
    points = stood(trajectory.stance, course, pace, ground, placed + 0.5 * duty * gait.period)
    if not pace.ramp:
        return Footholds(trajectory, first, points, np.zeros(points.shape[:2], bool))
    before = placed + duty * gait.period < -1e-12 * gait.period
    after = placed + gait.period > pace.duration * (1.0 + 1e-12)
    return Footholds(trajectory, first, _kept(points, before, after), before | after)


def stood(stance: Sequence[Sequence[float]], course: Course, pace: Pace, ground: Ground, middle: np.ndarray) -> np.ndarray:
    """Where feet with stance points [k,3] (m) stand [k, m, 3] (m) whose supports have their middles [k, m] (s)."""
    pose = course.at(pace.at(middle.ravel()))
    points: np.ndarray = pose.position + np.einsum("tij,tj->ti", pose.rotation, np.repeat(np.array(stance), middle.shape[1], axis=0))
    points[:, 2] = ground.height(points[:, 0], points[:, 1])
    return points.reshape(*middle.shape, 3)


def _kept(points: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Footholds of legs that stay where they are in the transfers that are not made."""
    points = points.copy()
    for m in range(points.shape[1] - 2, -1, -1):
        points[before[:, m], m] = points[before[:, m], m + 1]
    for m in range(points.shape[1] - 1):
        points[after[:, m], m + 1] = points[after[:, m], m]
    return points

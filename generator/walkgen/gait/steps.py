"""Feet of a list of events: the walk from rest to rest that a schedule's steps make, each foot from foothold to foothold."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from walkgen.gait.course import Course, Pace
from walkgen.gait.footholds import Footholds, Holds, stood
from walkgen.gait.ground import Ground
from walkgen.gait.schedule import Schedule
from walkgen.gait.trajectory import FootMotion
from walkgen.runtime.robot import Schedule as BuiltSchedule

_KNOTS_PER_TRANSFER = 6
_RAMP = 0.25
_NEEDED = "a body that helps every lift needs half a transfer for it"
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Steps:
    """A list of events with feet.

    Attributes:
        schedule: all legs stand before its first event and after its last.
        stance: where each foot is in the middle of its supports [k][3], in the platform's frame (m); z up.
        lift: how far a foot rises over the higher of its two footholds, half way (m).
        stride: how far the robot travels in all (m).

    Raises:
        ValueError: no event; not one point a leg; a leg in transfer at the start or in the end.
    """

    schedule: Schedule
    stance: tuple[Point, ...]
    lift: float
    stride: float = 0.0

    def __post_init__(self) -> None:
        legs = self.schedule.legs
        if not self.schedule.events:
            raise ValueError("a walk by events has some")
        if np.shape(self.stance) != (len(legs), 3):
            raise ValueError(f"stance has shape {list(np.shape(self.stance))}; {len(legs)} legs have [{len(legs)}, 3]")
        last = self.schedule.states(self.end)
        up = self.schedule.lifted or tuple(leg for leg, state in zip(legs, last, strict=True) if state)
        if up:
            raise ValueError(
                f"{', '.join(up)}: in transfer at the {'start' if self.schedule.lifted else 'end'}; a walk begins and ends standing"
            )

    @classmethod
    def of(cls, built: BuiltSchedule) -> "Steps":
        """Those of a loaded robot's event list: `Steps.of(robot.gaits["first_steps"])`.

        Raises:
            ValueError: the spec gives it no stance; a leg in transfer at the start or in the end.
        """
        if built.stance is None or built.lift is None:
            raise ValueError(f"{built!r} has no stance; the spec's gait table gives it")
        return cls(Schedule.of(built), built.stance, built.lift, built.stride)

    @property
    def start(self) -> float:
        """When the walk begins: at 0, or at the first event where that is before (s)."""
        return min(0.0, self.schedule.events[0].at)

    @property
    def end(self) -> float:
        """When it ends, at the last event (s)."""
        return self.schedule.events[-1].at

    @property
    def ramp(self) -> float:
        """How long the platform takes to its full speed, and from it (s)."""
        return _RAMP * (self.end - self.start)

    @property
    def speed(self) -> float:
        """Of the platform between its ramps (m/s)."""
        return self.stride / (self.end - self.start - self.ramp)

    @property
    def summary(self) -> str:
        """In words."""
        return f"{len(self.schedule.events)} events, {self.stride:.4g} m in {self.end - self.start:.4g} s"

    def ordered(self, legs: tuple[str, ...]) -> "Steps":
        """The same with its legs in another order.

        Raises:
            ValueError: not the same legs.
        """
        own = self.schedule.legs
        if sorted(legs) != sorted(own):
            raise ValueError(f"the gait's legs are {', '.join(own)}, not {', '.join(legs)}")
        schedule = Schedule(tuple(legs), self.schedule.events, self.schedule.lifted)
        return Steps(schedule, tuple(self.stance[own.index(leg)] for leg in legs), self.lift, self.stride)

    @property
    def supports(self) -> list[np.ndarray]:
        """When each leg's supports begin and end [m,2] (s)."""
        own = ([event.at for event in self.schedule.events if event.leg == leg] for leg in self.schedule.legs)
        return [np.array([self.start, *times, self.end]).reshape(-1, 2) for times in own]

    @property
    def transfers(self) -> list[tuple[float, float]]:
        """When legs are in transfer, in order (s)."""
        return sorted((lifted, placed) for own in self.supports for (_, lifted), (placed, _) in pairwise(own.tolist()))

    def refuse_crowded(self, pause: float) -> None:
        """See that one leg at a time is in transfer.

        Args:
            pause: for how long all legs stand before a transfer, in shares of it.

        Raises:
            ValueError: a leg is lifted too soon.
        """
        lifts = [event for event in self.schedule.events if event.does == "lift"]
        for (_, placed), (lifted, then), event in zip(self.transfers, self.transfers[1:], lifts[1:], strict=False):
            if lifted - placed < pause * (then - lifted):
                raise ValueError(
                    f"{event.leg} is lifted at {lifted:g} s, {lifted - placed:.4g} s after the last foot was placed; {_NEEDED}"
                )


@dataclass(frozen=True)
class SteppedFootholds:
    """Of every leg's supports in order [k, m, 3] in the world (m), the last one repeated; NaN where there is no ground."""

    trajectory: Steps
    points: np.ndarray

    @property
    def spacing(self) -> float:
        """Between instants at which chains are adapted (s)."""
        shortest = min(
            (placed - lifted for lifted, placed in self.trajectory.transfers), default=self.trajectory.end - self.trajectory.start
        )
        return shortest / _KNOTS_PER_TRANSFER

    def motion(self, t: np.ndarray) -> tuple[FootMotion, np.ndarray]:
        """Feet in the world [t,k,3], and whether each supports [t,k]."""
        schedule = self.trajectory.schedule
        return schedule.feet(t, *self._between(t), self.trajectory.lift), schedule.states(t) == 0

    def below(self, t: np.ndarray) -> np.ndarray:
        """Feet in the world [t,k,3] that go straight from foothold to foothold instead of being lifted."""
        start, end = self._between(t)
        flat = np.broadcast_to([1.0, 1.0, 0.0], start.shape)
        share = self.trajectory.schedule.feet(t, np.zeros_like(start), flat, 0.0).position[..., :1]
        feet: np.ndarray = start + share * (end - start)
        return feet

    def holds(self, until: float) -> Holds:
        """Supports that begin by `until` (s)."""
        rows = [
            (leg, *times, *point)
            for leg, own in enumerate(self.trajectory.supports)
            for times, point in zip(own, self.points[leg], strict=False)
        ]
        leg, start, end, *point = np.array([row for row in rows if row[1] <= until]).T
        return Holds(leg.astype(int), start, end, np.stack(point, axis=-1))

    def transfers(self, _: int) -> list[tuple[float, float]]:
        """When legs are in transfer, in order (s); a list has no cycles."""
        return self.trajectory.transfers

    def _between(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        number, legs = self.trajectory.schedule.passed(t) // 2, np.arange(len(self.points))
        return self.points[legs, number], self.points[legs, np.minimum(number + 1, self.points.shape[1] - 1)]


Standing = Footholds | SteppedFootholds
"""Footholds of a gait, or of a list of events."""


def place_steps(steps: Steps, course: Course, pace: Pace, ground: Ground) -> SteppedFootholds:
    """Every foot stands where its stance point is in the middle of a support.

    Args:
        steps: events and stance.
        course: of the platform.
        pace: from 0, the start of the walk, to its end.
        ground: gives the footholds' height.
    """
    most = max(map(len, steps.supports))
    middle = np.array([np.pad(own.mean(axis=1), (0, most - len(own)), mode="edge") for own in steps.supports])
    return SteppedFootholds(steps, stood(steps.stance, course, pace, ground, middle - steps.start))

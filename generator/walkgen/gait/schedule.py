"""An aperiodic gait: a list of events in time, for walks that choose every step."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.gait.pattern import Event
from walkgen.gait.trajectory import FootMotion
from walkgen.runtime.robot import Schedule as BuiltSchedule
from walkgen.runtime.solves.schedule import schedule_next_event, schedule_phase, schedule_states, schedule_transfers

_KINDS = ("lift", "place")


@dataclass(frozen=True)
class Schedule:
    """Legs that support or not at the start, and the events after it; what the last ones leave lasts for ever.

    Attributes:
        legs: their names.
        events: in order of time; `at` in seconds.
        lifted: legs that are in transfer before the first event.

    Raises:
        ValueError: events out of order, of unknown legs, or that lift a leg that is lifted or has just been placed.
    """

    legs: tuple[str, ...]
    events: tuple[Event, ...]
    lifted: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _refuse(self.legs, self.events, self.lifted)

    @classmethod
    def of(cls, built: BuiltSchedule) -> "Schedule":
        """That of a loaded robot's event list: `Schedule.of(robot.gaits["first_steps"])`."""
        return cls(built.legs, tuple(Event(at, leg, "lift" if does == "lift" else "place") for at, leg, does in built.events), built.lifted)

    def states(self, t: Any) -> np.ndarray:
        """0 supports, 1 in transfer, -1 where t is not finite: [..., k] for times t [...] (s). At an event's time the state after it."""
        return schedule_states(*self._timing, t)

    def leg_phase(self, t: Any) -> np.ndarray:
        """The share of its support or transfer that each leg has behind it: [..., k] in [0, 1); NaN where that has no start or no end."""
        times, first, _, k = self._timing
        return schedule_phase(times, first, k, t)

    def next_event(self, t: Any) -> tuple[np.ndarray, np.ndarray]:
        """The first time after t [...] at which legs change (s), and which do [..., k]: 1 lifted, -1 placed; NaN and 0 after the last."""
        return schedule_next_event(*self._timing, t)

    def feet(self, t: Any, start: Any, end: Any, lift: float) -> FootMotion:
        """Feet in a frame at rest: those in support stand at `start`, the others are on their way from `start` to `end` [..., k, 3] (m).

        As `Trajectory.between` has it; NaN for a transfer that has no start or no end.

        Args:
            t: [...] (s).
            start: footholds.
            end: those to come; those of feet in support do not count.
            lift: how far a foot rises over the higher of the two, half way (m).
        """
        return FootMotion(*schedule_transfers(*self._timing, lift, t, np.asarray(start, float), np.asarray(end, float)))

    def passed(self, t: Any) -> np.ndarray:
        """How many of its own events each leg has behind it at times t [...]: [..., k]."""
        own = [[event.at for event in self.events if event.leg == leg] for leg in self.legs]
        return np.stack([np.searchsorted(times, np.asarray(t, float), side="right") for times in own], axis=-1)

    @property
    def fewest_supporting(self) -> int:
        """The least number of legs that support at any instant."""
        instants = [event.at for event in self.events]
        before = [instants[0] - 1.0] if instants else [0.0]
        return int((self.states([*before, *instants]) == 0).sum(axis=-1).min())

    @property
    def _timing(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
        own = [[event.at for event in self.events if event.leg == leg] for leg in self.legs]
        first = np.cumsum([0, *map(len, own)])
        lifted = np.array([leg in self.lifted for leg in self.legs], dtype=float)
        return np.array([at for times in own for at in times], dtype=float), first, lifted, len(self.legs)


def _refuse(legs: Sequence[str], events: Sequence[Event], lifted: Sequence[str]) -> None:
    up, changed = {leg: leg in lifted for leg in legs}, dict.fromkeys(legs, -math.inf)
    for name in (*lifted, *(event.leg for event in events)):
        if name not in up:
            raise ValueError(f"there is no leg {name}; the legs are {', '.join(legs)}")
    before = -math.inf
    for event in events:
        if event.does not in _KINDS:
            raise ValueError(f"{event.leg} at {event.at} s: an event is lift or place, not {event.does!r}")
        if not (math.isfinite(event.at) and event.at >= before):
            raise ValueError(f"{event.leg} at {event.at} s: events stand in order of time")
        if up[event.leg] == (event.does == "lift"):
            raise ValueError(f"{event.leg} at {event.at:g} s: a leg that is {'lifted' if up[event.leg] else 'placed'} already")
        if event.at == changed[event.leg]:
            raise ValueError(f"{event.leg} at {event.at:g} s: lifted and placed at one instant")
        before, up[event.leg], changed[event.leg] = event.at, event.does == "lift", event.at

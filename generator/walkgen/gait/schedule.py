"""An aperiodic gait: a list of events in time, for walks that choose every step."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.gait.pattern import Event
from walkgen.gait.trajectory import FootMotion
from walkgen.runtime.solves.gait import gait_step

_CHANGE = {"lift": 1, "place": -1}


@dataclass(frozen=True)
class Schedule:
    """Legs that support or not at the start, and the events after it; what the last ones leave lasts for ever.

    Attributes:
        legs: their names.
        events: in order of time; `at` in seconds.
        lifted: legs that are in transfer before the first event.

    Raises:
        ValueError: events out of order, of unknown legs, or that lift a leg that is lifted.
    """

    legs: tuple[str, ...]
    events: tuple[Event, ...]
    lifted: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _refuse(self.legs, self.events, self.lifted)

    def states(self, t: Any) -> np.ndarray:
        """0 supports, 1 in transfer, -1 where t is not finite: [..., k] for times t [...] (s). At an event's time the state after it."""
        t = np.asarray(t, float)
        rows = np.cumsum([self._first, *self._changes], axis=0)
        found = rows[np.searchsorted(self._times, t, side="right")]
        return np.where(np.isfinite(t)[..., None], found, -1).astype(np.int32)

    def leg_phase(self, t: Any) -> np.ndarray:
        """The share of its support or transfer that each leg has behind it: [..., k] in [0, 1); NaN where that has no start or no end."""
        t = np.asarray(t, float)
        around = [self._around(leg, t) for leg in self.legs]
        return np.stack([(t - start) / (end - start) for start, end in around], axis=-1)

    def feet(self, t: Any, start: Any, end: Any, lift: float) -> FootMotion:
        """Feet in a frame at rest: those in support stand at `start`, the others are on their way from `start` to `end` [..., k, 3] (m).

        As `Trajectory.between` has it; NaN for a transfer that has no start or no end.

        Args:
            t: [...] (s).
            start: footholds.
            end: those to come; those of feet in support do not count.
            lift: how far a foot rises over the higher of the two, half way (m).
        """
        start, end = np.asarray(start, float), np.asarray(end, float)
        stands, share = self.states(t) == 0, self.leg_phase(t)
        rate = 1.0 / np.stack([np.subtract(*self._around(leg, t)[::-1]) for leg in self.legs], axis=-1)
        goal = np.where(stands[..., None], start, end)
        return FootMotion(*gait_step(np.where(stands, 0.0, share), np.where(stands, 0.0, rate), lift, start, goal))

    def next_event(self, t: Any) -> tuple[np.ndarray, np.ndarray]:
        """The first time after t [...] at which legs change (s), and which do [..., k]: 1 lifted, -1 placed; NaN and 0 after the last."""
        t = np.asarray(t, float)
        times = np.append(self._times, math.nan)
        time = times[np.where(np.isfinite(t), np.searchsorted(self._times, t, side="right"), len(self._times))]
        change = self.states(np.where(np.isfinite(time), time, np.inf)) - self.states(np.where(np.isfinite(time), t, np.inf))
        return time, change.astype(np.int32)

    @property
    def fewest_supporting(self) -> int:
        """The least number of legs that support at any instant."""
        rows = np.array([self._first, *self.states(self._times).tolist()])
        return int((rows == 0).sum(axis=-1).min())

    @property
    def _times(self) -> np.ndarray:
        return np.array([event.at for event in self.events], dtype=float)

    @property
    def _first(self) -> list[int]:
        return [int(leg in self.lifted) for leg in self.legs]

    @property
    def _changes(self) -> list[list[int]]:
        return [[_CHANGE[event.does] * (leg == event.leg) for leg in self.legs] for event in self.events]

    def _around(self, leg: str, t: Any) -> tuple[np.ndarray, np.ndarray]:
        """Times of the leg's own last and next event at t; NaN where there is none."""
        t = np.asarray(t, float)
        own = np.array([event.at for event in self.events if event.leg == leg], dtype=float)
        bounds = np.concatenate([[math.nan], own, [math.nan]])
        place = np.searchsorted(own, t, side="right")
        return np.where(np.isfinite(t), bounds[place], math.nan), bounds[place + 1]


def _refuse(legs: Sequence[str], events: Sequence[Event], lifted: Sequence[str]) -> None:
    up = {leg: leg in lifted for leg in legs}
    for name in (*lifted, *(event.leg for event in events)):
        if name not in up:
            raise ValueError(f"there is no leg {name}; the legs are {', '.join(legs)}")
    before = -math.inf
    for event in events:
        if event.does not in _CHANGE:
            raise ValueError(f"{event.leg} at {event.at} s: an event is lift or place, not {event.does!r}")
        if not (math.isfinite(event.at) and event.at >= before):
            raise ValueError(f"{event.leg} at {event.at} s: events stand in order of time")
        if up[event.leg] == (event.does == "lift"):
            raise ValueError(f"{event.leg} at {event.at:g} s: a leg that is {'lifted' if up[event.leg] else 'placed'} already")
        before, up[event.leg] = event.at, event.does == "lift"

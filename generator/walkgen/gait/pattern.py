"""A gait: when each leg supports and when it is in transfer, and the numbers that describe it (theory 3.1)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress
from typing import Any, Literal

import numpy as np

from walkgen.gait import phases
from walkgen.runtime.robot import Gait as BuiltGait
from walkgen.runtime.solves.gait import gait_next_event, gait_phase, gait_states

_TOGETHER = 1e-12
"""Periods; events closer than this are one instant."""


@dataclass(frozen=True)
class Event:
    """A leg is lifted or placed: `at` in periods of a Gait, in seconds of a Schedule."""

    at: float
    leg: str
    does: Literal["lift", "place"]


@dataclass(frozen=True)
class Span:
    """Part of a cycle between two events, in periods, with the legs that support then."""

    start: float
    end: float
    supporting: tuple[str, ...]


@dataclass(frozen=True)
class Gait:
    """A periodic gait: leg i is placed at phase[i] and lifted at phase[i] + duty_factor[i], in periods.

    Attributes:
        legs: their names.
        duty_factor: the share of the period in which each leg supports, in (0, 1).
        phase: when each leg is placed, taken modulo 1.
        period: T (s).
        stride: how far the robot travels in a period (m).

    Raises:
        ValueError: lists of different lengths, a leg twice, numbers out of their range.
    """

    legs: tuple[str, ...]
    duty_factor: tuple[float, ...]
    phase: tuple[float, ...]
    period: float = 1.0
    stride: float = 0.0

    def __post_init__(self) -> None:
        for name in ("duty_factor", "phase"):
            object.__setattr__(self, name, tuple(float(entry) for entry in getattr(self, name)))
        object.__setattr__(self, "legs", tuple(self.legs))
        _refuse(self)
        object.__setattr__(self, "phase", tuple(phases.fraction(entry) for entry in self.phase))

    @classmethod
    def of(cls, built: BuiltGait) -> "Gait":
        """The gait of a loaded robot: `Gait.of(robot.gait)`, `Gait.of(robot.gaits["tripod"])`."""
        return cls(built.legs, built.duty_factor, built.phase, built.period, built.stride)

    def states(self, t: Any) -> np.ndarray:
        """0 supports, 1 in transfer, -1 where t is not finite: [..., k] for times t [...] (s). At an event's time the state after it."""
        return gait_states(*self._timing, t)

    def leg_phase(self, t: Any) -> np.ndarray:
        """How far each leg is since it was placed, in periods: [..., k] in [0, 1)."""
        return gait_phase(*self._timing, t)

    def next_event(self, t: Any) -> tuple[np.ndarray, np.ndarray]:
        """The first time after t [...] at which legs change (s), and which do [..., k]: 1 lifted, -1 placed, 0 neither."""
        return gait_next_event(*self._timing, t)

    @property
    def formula(self) -> tuple[float, ...]:
        """(beta_1, ..., beta_k, phi_2, ..., phi_k): 2k - 1 numbers, phases after the first leg's placing."""
        return self.duty_factor + tuple(phases.fraction(entry - self.phase[0]) for entry in self.phase[1:])

    @property
    def events(self) -> tuple[Event, ...]:
        """The event sequence of a cycle, from t = 0; events at one instant stand in the order of the legs."""
        found = phases.instants(self.duty_factor, self.phase)
        order = sorted(found, key=lambda event: (round(event[0] / _TOGETHER) * _TOGETHER % 1.0, event[1]))
        return tuple(Event(at, self.legs[leg], "lift" if change > 0 else "place") for at, leg, change in order)

    @property
    def spans(self) -> tuple[Span, ...]:
        """What supports between the events."""
        found = phases.spans(self.duty_factor, self.phase, _TOGETHER)
        return tuple(Span(start, end, tuple(compress(self.legs, downs))) for start, end, downs in found)

    @property
    def fewest_supporting(self) -> int:
        """The least number of legs that support at any instant."""
        return min(len(span.supporting) for span in self.spans)

    @property
    def is_static(self) -> bool:
        """Three legs support at every instant."""
        return self.fewest_supporting >= phases.STATIC

    @property
    def is_regular(self) -> bool:
        """All duty factors are equal."""
        return max(self.duty_factor) - min(self.duty_factor) <= _TOGETHER

    @property
    def is_singular(self) -> bool:
        """Two events fall on one instant."""
        times = [event.at for event in self.events]
        return any(_apart(here, there) <= _TOGETHER for here, there in zip(times, times[1:] + times[:1], strict=True))

    def is_symmetric(self, left: Sequence[str], right: Sequence[str]) -> bool:
        """Each leg on the right is placed half a period after the one beside it: phi_R = F(phi_L + 1/2).

        Args:
            left: legs.
            right: those beside them, in the same order.
        """
        placed = dict(zip(self.legs, self.phase, strict=True))
        return all(_apart(placed[here] + 0.5, placed[there]) <= _TOGETHER for here, there in zip(left, right, strict=True))

    @property
    def stroke(self) -> tuple[float, ...]:
        """R = beta lambda: how far each foot goes back under the platform while it supports (m)."""
        return tuple(factor * self.stride for factor in self.duty_factor)

    @property
    def speed(self) -> float:
        """v = lambda / T (m/s)."""
        return self.stride / self.period

    def ordered(self, legs: Sequence[str]) -> "Gait":
        """The same gait with its legs in another order.

        Raises:
            ValueError: not the same legs.
        """
        if sorted(legs) != sorted(self.legs):
            raise ValueError(f"the gait's legs are {', '.join(self.legs)}, not {', '.join(legs)}")
        places = [self.legs.index(leg) for leg in legs]
        duty, phase = ([values[place] for place in places] for values in (self.duty_factor, self.phase))
        return Gait(tuple(legs), tuple(duty), tuple(phase), self.period, self.stride)

    @property
    def _timing(self) -> tuple[np.ndarray, np.ndarray, int, float]:
        return np.array(self.duty_factor), np.array(self.phase), len(self.legs), self.period


def event_sequences(legs: int) -> int:
    """How many nonsingular event sequences k legs have: (2k - 1)!."""
    return math.factorial(2 * legs - 1)


def _apart(here: float, there: float) -> float:
    """Distance round the cycle."""
    rest = phases.fraction(here - there)
    return min(rest, 1.0 - rest)


def _refuse(gait: Gait) -> None:
    count = len(gait.legs)
    if not count == len(set(gait.legs)) == len(gait.duty_factor) == len(gait.phase) or count == 0:
        raise ValueError(f"each of {count} legs has a name of its own, a duty factor and a phase")
    for leg, factor, phase in zip(gait.legs, gait.duty_factor, gait.phase, strict=True):
        if not 0.0 < factor < 1.0:
            raise ValueError(f"the duty factor of {leg} is {factor:g}; it lies between 0 and 1")
        if not math.isfinite(phase):
            raise ValueError(f"the phase of {leg} is {phase}")
    if not (math.isfinite(gait.period) and gait.period > 0.0 and math.isfinite(gait.stride)):
        raise ValueError(f"period {gait.period:g} s and stride {gait.stride:g} m: a period is more than 0, both are finite")

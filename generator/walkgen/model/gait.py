"""A robot's gaits, periodic ones and lists of events: exact numbers, legs in the order of the feet."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, NamedTuple

Point = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True, kw_only=True)
class Stepping:
    """What gaits of both sorts have; `name` is empty for the only gait of a robot.

    Attributes:
        name: as in the spec.
        stride: along the first platform's x, in a period or in all (m).
        lift: of a foot over the higher of its footholds (m), None where the gait only says when.
        stance: of each foot in the middle of its supports, in the first platform's frame (m).
        static: whether three legs, or a sole, support at every instant.
        body: what the platform does before a leg lifts, to keep the `margin` (m).
    """

    name: str
    stride: Fraction
    lift: Fraction | None
    stance: tuple[Point, ...] | None
    static: bool
    body: Literal["level", "waved", "swinging"]
    margin: Fraction | None


@dataclass(frozen=True, kw_only=True)
class Gait(Stepping):
    """When each leg supports and where its foot goes, period by period.

    Attributes:
        kind: as in the spec: wave, tripod, ..., free.
        duty_factor: of each leg, in (0, 1).
        phase: when each leg is placed, in periods.
        period: s.
        heel_off: the share of its support after which a foot with a curved sole rolls over its toe.
    """

    kind: str
    duty_factor: tuple[Fraction, ...]
    phase: tuple[Fraction, ...]
    period: Fraction
    heel_off: Fraction


class Event(NamedTuple):
    """A leg, by its number, is lifted or placed at a time (s)."""

    at: Fraction
    leg: int
    does: Literal["lift", "place"]


@dataclass(frozen=True, kw_only=True)
class Schedule(Stepping):
    """A gait that is no cycle: events in order of time, each leg lifted and placed in turn.

    Attributes:
        events: in order of time.
        lifted: whether each leg is in transfer before the first event.
    """

    events: tuple[Event, ...]
    lifted: tuple[bool, ...]

    @property
    def kind(self) -> Literal["events"]:
        """As in the spec."""
        return "events"

    def own(self, leg: int) -> tuple[Fraction, ...]:
        """When a leg, by its number, changes (s)."""
        return tuple(event.at for event in self.events if event.leg == leg)

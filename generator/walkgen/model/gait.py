"""A robot's gaits: exact numbers, leg by leg in the order of the feet."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

Point = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Gait:
    """When each leg supports and where its foot goes; `name` is empty for the only gait of a robot.

    Attributes:
        name: as in the spec.
        kind: as in the spec: wave, tripod, ..., free.
        duty_factor: of each leg, in (0, 1).
        phase: when each leg is placed, in periods.
        period: s.
        stride: along the first platform's x in a period (m).
        lift: of a foot over the higher of its footholds (m), None where the gait only says when.
        stance: of each foot in the middle of its support, in the first platform's frame (m).
        static: whether three legs support at every instant.
        body: what the platform does before a leg lifts, to keep the `margin` (m).
    """

    name: str
    kind: str
    duty_factor: tuple[Fraction, ...]
    phase: tuple[Fraction, ...]
    period: Fraction
    stride: Fraction
    lift: Fraction | None
    stance: tuple[Point, ...] | None
    static: bool
    body: Literal["level", "waved", "swinging"]
    margin: Fraction | None

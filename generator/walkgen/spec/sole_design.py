"""The tables of a sole's design: a step's last part, in which the foot rolls over its toe, and what may be varied for it."""

from typing import ClassVar, Literal

from pydantic import Field, StrictInt, StrictStr

from walkgen.spec.table import Number, Pair, Table

_MOST_NAMES = 100


class SoleWeights(Table):
    """How much each objective counts in the design that is written, as a share of what the spec's own values give."""

    acceleration: Number | None = None
    """Of the foot's largest angular acceleration; 1 where left out."""
    moment: Number | None = None
    """Of the ankle's largest moment; 0 where left out."""


class SoleDesignSpec(Table):
    """A roll of the foot under a hip that moves evenly, from flat on the ground on, while the thigh swings to where it has to be."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"thigh", "knee"})

    leg: StrictStr
    curve: Literal["toe"] = "toe"
    hip: Pair
    """Where the hip is as the roll begins, from the ground below the ankle (m)."""
    velocity: Pair
    """Of the hip (m/s)."""
    duration: Number
    """Of the roll (s)."""
    thigh: Number | None = None
    """The thigh's angle as the roll ends, from forward (rad)."""
    thigh_deg: Number | None = None
    """The same in degrees."""
    thigh_rate: Number | None = None
    """Its rate then (rad/s); 0 where left out."""
    thigh_acceleration: Number | None = None
    """Its acceleration then (rad/s^2); 0 where left out."""
    load: Pair
    """Of the body on the hip (N)."""
    vary: tuple[StrictStr, ...] | None = Field(default=None, max_length=_MOST_NAMES)
    """Parameters that may take other values within their bounds; all with bounds where left out."""
    flat: Pair | None = None
    """Least and largest length of the flat part (m)."""
    used: Pair | None = None
    """Least and largest parameter of the curve as the roll ends."""
    curvature: Pair | None = None
    """Least and largest curvature of the part of the curve that is used (1/m)."""
    reach: Number | None = None
    """Largest distance from hip to ankle, in lengths of the straight leg."""
    knee: Number | None = None
    """Least angle by which the knee is bent (rad)."""
    knee_deg: Number | None = None
    """The same in degrees."""
    weights: SoleWeights = SoleWeights()
    instants: StrictInt = Field(default=41, ge=5, le=2000)
    """At which all this is looked at."""
    starts: StrictInt = Field(default=6, ge=1, le=10_000)
    """Random starts of the search, besides the spec's own values."""
    front: StrictInt = Field(default=7, ge=2, le=200)
    """Designs between the best of each objective, ends included, that are told."""

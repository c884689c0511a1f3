"""The tables of gaits: when each leg supports, how far and how high feet go."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, StrictBool, StrictStr, Tag

from walkgen.spec.table import Number, Table, Triple

_MOST_LEGS = 100
_MOST_GAITS = 100
_MOST_EVENTS = 1000
ONLY = ""
"""Name of the gait of a spec that has one and does not name it."""


def _factor_kind(value: Any) -> str:
    return "factor:each" if isinstance(value, Mapping) else "factor:all"


DutyFactor = Annotated[
    Annotated[Number, Tag("factor:all")] | Annotated[dict[StrictStr, Number], Tag("factor:each")], Discriminator(_factor_kind)
]


def _stance_kind(value: Any) -> str:
    return "stance:same" if isinstance(value, str) else "stance:own"


Stance = Annotated[
    Annotated[StrictStr, Tag("stance:same")] | Annotated[dict[StrictStr, Triple], Field(max_length=_MOST_LEGS), Tag("stance:own")],
    Discriminator(_stance_kind),
]


class EventSpec(Table):
    """A leg is lifted or placed."""

    at: Number
    """When (s)."""
    leg: StrictStr
    does: Literal["lift", "place"]


class GaitSpec(Table):
    """A gait of all legs, periodic but for a list of events; its numbers are fixed when code is generated."""

    kind: Literal["wave", "tripod", "crawl", "trot", "follow_the_leader", "overlapping", "free", "events"]
    period: Number | None = None
    """How long a cycle lasts (s); of every kind but events."""
    left: tuple[StrictStr, ...] | None = Field(default=None, max_length=_MOST_LEGS)
    """Legs on the left, from the front; of every kind but free and events."""
    right: tuple[StrictStr, ...] | None = Field(default=None, max_length=_MOST_LEGS)
    """Legs on the right, each beside one on the left."""
    duty_factor: DutyFactor | None = None
    """Share of the period in which a leg supports, between 0 and 1; of a free gait one for each leg, or one for all."""
    phase: dict[StrictStr, Number] | None = Field(default=None, max_length=_MOST_LEGS)
    """free: when each leg is placed, in periods."""
    events: tuple[EventSpec, ...] | None = Field(default=None, max_length=_MOST_EVENTS)
    """events: what happens, in order of time; what the last ones leave lasts for ever."""
    lifted: tuple[StrictStr, ...] | None = Field(default=None, max_length=_MOST_LEGS)
    """events: legs in transfer before the first one."""
    pitch: Number | None = None
    """follow_the_leader: distance of neighbouring legs' strokes (m)."""
    pitch_mm: Number | None = None
    stride: Number | None = None
    """How far the robot travels along x in a period, or by all events (m); on the spot where left out."""
    stride_mm: Number | None = None
    lift: Number | None = None
    """How far a foot rises over the higher of its two footholds, half way (m)."""
    lift_mm: Number | None = None
    heel_off: Number | None = None
    """Of legs with curved soles: the share of its support after which a foot rolls over its toe, from 0 to 1; 0.5 where left out."""
    stance: Stance | None = None
    """Where each foot is in the middle of its support, in the first platform's frame (m); or the name of a gait that says so."""
    static: StrictBool | None = None
    """Whether three legs, or a sole, support at every instant, which is then checked; of every kind but trot where left out."""
    body: Literal["level", "waved", "swinging"] = "level"
    """What the platform does before a leg lifts: nothing, shifts sideways, or turns about the line of that leg's neighbours."""
    margin: Number | None = None
    """waved, swinging: the static stability margin wanted before a leg lifts (m)."""
    margin_mm: Number | None = None


def _gaits_kind(value: Any) -> str:
    if isinstance(value, GaitSpec) or not isinstance(value, Mapping):
        return "gait:one"
    named = bool(value) and all(isinstance(entry, Mapping | GaitSpec) for entry in value.values())
    return "gait:named" if named and not value.keys() & GaitSpec.model_fields.keys() else "gait:one"


Gaits = Annotated[
    Annotated[GaitSpec, Tag("gait:one")] | Annotated[dict[StrictStr, GaitSpec], Field(max_length=_MOST_GAITS), Tag("gait:named")],
    Discriminator(_gaits_kind),
]
TAGS = frozenset({"factor:all", "factor:each", "stance:same", "stance:own", "gait:one", "gait:named"})
"""Parts of pydantic's error places that are no keys."""

"""The tables of static balancing: what relieves which joints, over which ranges and under which load, and what may be varied for it."""

from typing import Literal

from pydantic import Field, StrictInt, StrictStr

from walkgen.spec.scalar import Scalar, degrees, div, exact
from walkgen.spec.table import Number, Pair, Table, Triple, snapped

_MOST_NAMES = 100
_MOST_ROWS = 1000
Ranges = dict[str, tuple[Scalar, Scalar]]
"""Least and largest value of joints, by their names (rad or m)."""


class RangeWeights(Table):
    """How much the mean square of what is left counts."""

    support: Number | None = None
    """Under load; 1 where left out."""
    transfer: Number | None = None
    """Without load; 1 where left out."""


class CamMasses(Table):
    """Of what a cam moves, and of its spring, lumped at its ends (kg); 0 where left out."""

    spring_at_link: Number | None = None
    """cam_on_link: the spring's end on the link."""
    spring_at_follower: Number | None = None
    """The spring's end on the follower."""
    follower: Number | None = None
    roller: Number | None = None


class CamWeights(Table):
    """How much what a search makes small counts; 1 where left out."""

    pressure: Number | None = None
    """The mean square of the pressure angle's tangent."""
    force: Number | None = None
    """The mean square of the force on the roller, as a share of the largest moment without cam at the hip's distance `start`."""


class CamSpec(Table):
    """A cam with a roller, which a spring presses on it; lengths in m."""

    start: Number
    """From the hip to the roller's centre, where the joint has the least value of its range."""
    roller: Number
    """The roller's radius."""
    stiffness: Number
    """Of the spring (N/m)."""
    free_length: Number
    """Where it begins to stretch."""
    initial_tension: Number | None = None
    """What stretches it at all (N); 0 where left out."""
    arm: Number | None = None
    """cam_on_link: from the hip to the spring's end on the link, along its x."""
    anchor: Number | None = None
    """cam_on_frame: from the hip up to the spring's end on the frame."""
    reach: Number
    """From the roller's centre to the spring's end on the follower: down the guide (cam_on_link), out along the link (cam_on_frame)."""
    centre: Number | None = None
    """cam_on_frame: from the roller's centre outwards to the follower's centre of mass; 0 where left out."""
    masses: CamMasses = CamMasses()
    most_pressure_deg: Number | None = None
    """The largest pressure angle that a search may leave; any where left out."""
    weights: CamWeights = CamWeights()
    """Of a search: parameters with bounds in this table are varied."""
    points: StrictInt = Field(default=1801, ge=5, le=100_001)
    """Of the profile, ends included."""


class BalanceSpec(Table):
    """What holds a leg's weight, and what it carries, without its drives: springs or a cam."""

    device: Literal["two_springs", "total", "cam_on_link", "cam_on_frame"]
    """two_springs: at one joint; total: at two joints or more, whose moments do not depend on each other; a cam at one joint."""
    leg: StrictStr
    load: Number
    """What the foot carries while it supports (kg)."""
    support: dict[StrictStr, Pair] | None = Field(default=None, max_length=_MOST_NAMES)
    """By the names of the relieved joints, where they are while the foot supports (rad or m)."""
    support_deg: dict[StrictStr, Pair] | None = Field(default=None, max_length=_MOST_NAMES)
    """The same in degrees."""
    support_mm: dict[StrictStr, Pair] | None = Field(default=None, max_length=_MOST_NAMES)
    """The same in mm."""
    transfer: dict[StrictStr, Pair] | None = Field(default=None, max_length=_MOST_NAMES)
    """Where they are while it is carried forward."""
    transfer_deg: dict[StrictStr, Pair] | None = Field(default=None, max_length=_MOST_NAMES)
    """The same in degrees."""
    transfer_mm: dict[StrictStr, Pair] | None = Field(default=None, max_length=_MOST_NAMES)
    """The same in mm."""
    held: dict[StrictStr, Number] | None = Field(default=None, max_length=_MOST_NAMES)
    """Values of the leg's other joints; 0 where left out (rad or m)."""
    held_deg: dict[StrictStr, Number] | None = Field(default=None, max_length=_MOST_NAMES)
    """The same in degrees."""
    held_mm: dict[StrictStr, Number] | None = Field(default=None, max_length=_MOST_NAMES)
    """The same in mm."""
    vary: tuple[StrictStr, ...] | None = Field(default=None, max_length=_MOST_NAMES)
    """Parameters that may take other values within their bounds; all with bounds where left out."""
    stretch: Pair | None = None
    """Least and largest length of every spring, in free lengths; [1.02, 1.9] where left out."""
    boxes: dict[StrictStr, tuple[Triple, Triple]] = Field(default_factory=dict, max_length=_MOST_NAMES)
    """By link, two corners of the box in which springs may be hooked on there, in the link's axes (m)."""
    catalogue: tuple[dict[StrictStr, Number], ...] = Field(default=(), max_length=_MOST_ROWS)
    """Springs that can be bought: of each what parameters called SPRING_KEY are worth when SPRING is one of these."""
    energy_per_mass: Number | None = None
    """What a kilogram of a spring stores (J/kg): parameters called SPRING_mass are then found with the springs."""
    weights: RangeWeights = RangeWeights()
    cam: CamSpec | None = None
    """Of a balance by a cam."""
    nodes: StrictInt = Field(default=12, ge=2, le=200)
    """Gauss nodes of every range."""
    starts: StrictInt | None = Field(default=None, ge=1, le=10_000)
    """Random starts of the search, besides the spec's own values; 24 of springs, 8 of a cam where left out."""

    @property
    def supported(self) -> Ranges:
        """`support` in SI."""
        return self._ranges("support")

    @property
    def transferred(self) -> Ranges:
        """`transfer` in SI."""
        return self._ranges("transfer")

    @property
    def others(self) -> dict[str, Scalar]:
        """`held` in SI."""
        plain = {name: snapped(value) for name, value in (self.held or {}).items()}
        turned = {name: degrees(value) for name, value in (self.held_deg or {}).items()}
        return plain | turned | {name: div(value, exact(1000)) for name, value in (self.held_mm or {}).items()}

    def _ranges(self, key: str) -> Ranges:
        plain: Ranges = {name: (snapped(low), snapped(high)) for name, (low, high) in (getattr(self, key) or {}).items()}
        turned: Ranges = {name: (degrees(low), degrees(high)) for name, (low, high) in (getattr(self, f"{key}_deg") or {}).items()}
        thousand = exact(1000)
        slid: Ranges = {name: (div(low, thousand), div(high, thousand)) for name, (low, high) in (getattr(self, f"{key}_mm") or {}).items()}
        return plain | turned | slid

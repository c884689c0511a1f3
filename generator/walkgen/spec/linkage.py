"""The tables of a leg that is a planar linkage: rigid links with named points, joined by pins, sliders and cylinders."""

from typing import ClassVar

from pydantic import Field, StrictBool, StrictStr

from walkgen.spec.joint_tables import Friction, Rotor
from walkgen.spec.scalar import Scalar, degrees
from walkgen.spec.table import Number, Pair, Table

FRAME = "frame"
"""Name of the link that does not move in the linkage's plane."""
_MOST_ENDS = 64


class PlanarLinkSpec(Table):
    """A rigid link, described in axes of its own."""

    points: dict[StrictStr, Pair] = Field(default_factory=dict, max_length=_MOST_ENDS)
    """Named points (m)."""
    mass: Number | None = None
    """kg"""
    com: Pair | None = None
    """Centre of mass (m)."""
    inertia: Number | None = None
    """About the centre of mass, normal to the plane (kg m^2)."""
    section: StrictStr | None = None
    """Name of the cross-section, in [sections]: the link bends and stretches between its two pairs that are farthest apart."""


class PinFriction(Friction):
    """In a pin, against the turning; what it carries rubs on the bolt: mu * radius * force."""

    mu: Number | None = None
    """Coefficient of friction between bolt and eye."""
    radius: Number | None = None
    """Of the bolt (m)."""


class SliderFriction(Friction):
    """In a slider, against the sliding; what it carries across its guide rubs there: mu * force."""

    mu: Number | None = None
    """Coefficient of friction on the guide."""


class ActuatorSpec(Table):
    """What a driven pair can do."""

    limits: Pair | None = None
    """Least and largest q (rad or m)."""
    max_speed: Number | None = None
    """rad/s or m/s"""
    max_effort: Number | None = None
    """N m or N"""
    friction: Friction | None = None
    rotor: Rotor | None = None


class PairSpec(ActuatorSpec):
    """What pins, sliders and cylinders have in common: a pair that may be driven."""

    driven: StrictBool = False
    """Whether an actuator moves it; its value is then one of the leg's q."""


class PinSpec(PairSpec):
    """A revolute pair between points of two links or more; driven, q is the second link's angle to the first."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"limits"})

    name: StrictStr | None = None
    """The last joined point's name where left out."""
    joins: tuple[StrictStr, ...] = Field(max_length=_MOST_ENDS)
    """Points, each as link.point; n of them count n - 1 pairs."""
    friction: PinFriction | None = None
    """Of every further link's turning against the first."""
    limits_deg: Pair | None = None


class Guide(Table):
    """A straight guide that is part of a link."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"angle"})

    link: StrictStr
    point: Pair
    """Where q is 0, in the link's axes (m)."""
    angle: Number | None = None
    """Direction of growing q in the link's axes (rad)."""
    angle_deg: Number | None = None


class SliderSpec(PairSpec):
    """A prismatic pair: a point of one link on a guide of another, without relative rotation; q is the way along the guide."""

    name: StrictStr
    link: StrictStr
    """The sliding point, as link.point."""
    guide: Guide
    friction: SliderFriction | None = None
    limits_mm: Pair | None = None


class EndMasses(Table):
    """Mass of a cylinder, lumped at its ends."""

    at_first: Number | None = None
    """kg"""
    at_second: Number | None = None
    """kg"""


class CylinderSpec(PairSpec):
    """A linear actuator or guide pinned between two points; q is its length."""

    name: StrictStr
    between: tuple[StrictStr, StrictStr]
    """Two points, each as link.point."""
    masses: EndMasses = EndMasses()
    section: StrictStr | None = None
    """Name of the cross-section, in [sections]: of a driven one, which stretches by E and A."""
    limits_mm: Pair | None = None


class StartSpec(Table):
    """Where triads are assembled, and how: of all assemblies that there are at `drives` the one nearest to the hints."""

    drives: tuple[Number, ...] | None = None
    """Values of the drives, in the order of q (rad or m); the middles of their limits, or near, where left out."""
    drives_deg: tuple[Number, ...] | None = None
    """The same in degrees."""
    drives_mm: tuple[Number, ...] | None = None
    """The same in mm."""
    points: dict[StrictStr, Pair] = Field(default_factory=dict, max_length=_MOST_ENDS)
    """About where points, each as link.point, lie in the frame's axes (m)."""
    angles: dict[StrictStr, Number] | None = Field(default=None, max_length=_MOST_ENDS)
    """About the angles of links to the frame (rad)."""
    angles_deg: dict[StrictStr, Number] | None = Field(default=None, max_length=_MOST_ENDS)
    """The same in degrees."""

    @property
    def turned(self) -> dict[str, Scalar]:
        """Angles of links (rad)."""
        return {**(self.angles or {}), **{link: degrees(angle) for link, angle in (self.angles_deg or {}).items()}}

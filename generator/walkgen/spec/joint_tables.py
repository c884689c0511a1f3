"""The tables of a spec that describe one joint: where it stands, what it moves, what moves it."""

from typing import ClassVar, Literal

from pydantic import StrictBool, StrictStr

from walkgen.spec.table import Number, Pair, Six, Table, Triple

Kind = Literal["revolute", "prismatic"]


class Pose(Table):
    """A fixed pose: xyz in the parent frame, rpy = Rz(yaw) Ry(pitch) Rx(roll); what is left out is zero."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"rpy"})

    xyz: Triple | None = None
    """Position (m)."""
    xyz_mm: Triple | None = None
    """Position (mm)."""
    rpy: Triple | None = None
    """Roll, pitch, yaw (rad)."""
    rpy_deg: Triple | None = None
    """Roll, pitch, yaw (degrees)."""


class LinkageEnd(Pose):
    """Where the joints after a linkage begin: xyz and rpy in the axes of a link at one of its points, z the plane's normal."""

    point: StrictStr | None = None
    """The point, as link.point; that of a short form's foot where left out."""


class Link(Table):
    """The rigid body that a joint moves, in the frame after the joint's row."""

    mass: Number | None = None
    """kg"""
    com: Triple | None = None
    """Centre of mass (m)."""
    com_mm: Triple | None = None
    """Centre of mass (mm)."""
    inertia: Six | None = None
    """ixx, iyy, izz, ixy, ixz, iyz about the centre of mass (kg m^2)."""
    section: StrictStr | None = None
    """Name of the cross-section, in [sections]."""
    allow_unphysical: StrictBool = False
    """Accept an inertia that no real body has."""


class Friction(Table):
    """In a joint, against its motion: viscous * qd + coulomb * sign(qd), 0 at rest."""

    viscous: Number | None = None
    """N m s/rad, or N s/m"""
    coulomb: Number | None = None
    """N m or N"""


class Rotor(Table):
    """What turns with a joint's motor: the joint feels gear^2 * inertia."""

    inertia: Number
    """About the motor's axis (kg m^2)."""
    gear: Number | None = None
    """Turns of the motor for a turn of the joint (rad for a metre where the joint slides); 1 where left out."""


class JointRow(Table):
    """One joint: a DH row (a, alpha, d, theta), or a fixed origin (xyz, rpy) and an axis."""

    ANGLES: ClassVar[frozenset[str]] = frozenset({"alpha", "theta", "rpy"})

    name: StrictStr
    type: Kind
    """Revolute: q adds to theta (rad); prismatic: q adds to d (m)."""
    a: Number | None = None
    """DH length along x (m)."""
    a_mm: Number | None = None
    alpha: Number | None = None
    """DH twist about x (rad)."""
    alpha_deg: Number | None = None
    d: Number | None = None
    """DH offset along z (m)."""
    d_mm: Number | None = None
    theta: Number | None = None
    """DH angle about z (rad); 0 where left out."""
    theta_deg: Number | None = None
    xyz: Triple | None = None
    """Origin of the joint in the frame before it (m)."""
    xyz_mm: Triple | None = None
    rpy: Triple | None = None
    """Orientation of the joint in the frame before it (rad)."""
    rpy_deg: Triple | None = None
    axis: Triple | None = None
    """Direction of the joint in its own frame; its length does not matter."""
    limits: Pair | None = None
    """Least and largest q (rad or m)."""
    limits_deg: Pair | None = None
    limits_mm: Pair | None = None
    max_speed: Number | None = None
    """rad/s or m/s"""
    max_speed_deg: Number | None = None
    max_speed_mm: Number | None = None
    max_effort: Number | None = None
    """N m or N"""
    link: Link | None = None
    friction: Friction | None = None
    rotor: Rotor | None = None

    def is_angle(self, key: str) -> bool:
        """Limits are angles where the joint turns."""
        return key in self.ANGLES or (key == "limits" and self.type == "revolute")

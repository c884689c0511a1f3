"""The tables of a curved sole: a flat part between two generatrices, and the curves on which the foot rolls over toe and heel."""

from typing import ClassVar

from pydantic import Field

from walkgen.spec.table import Number, Pair, Table

_MOST_POINTS = 24
_MOST_COEFFICIENTS = 16


class DirectrixSpec(Table):
    """A plane curve from an edge of the flat part on, in the foot frame: x away from the ankle, y forward (m).

    Given by one of: expressions `x` and `y` in lambda, a polynomial, an ellipse, points.
    """

    x: Number | None = None
    """An expression in lambda: how far the curve is from the ankle along the foot's x (m)."""
    y: Number | None = None
    """An expression in lambda: how far it is forward of the ankle (m)."""
    polynomial: tuple[Number, ...] | None = Field(default=None, min_length=1, max_length=_MOST_COEFFICIENTS)
    """[c2, c3, ...]: x = depth - c2 lambda^2 - c3 lambda^3 - ..., y = edge + lambda (toe) or edge - lambda (heel), lambda in m."""
    ellipse: Pair | None = None
    """Semi-axes along y and along x (m): a quarter of an ellipse that begins at the edge, lambda is its eccentric angle (rad)."""
    points: tuple[Pair, ...] | None = Field(default=None, min_length=1, max_length=_MOST_POINTS)
    """Points [x, y] (m) after the edge, joined by a quintic spline with four continuous derivatives that begins along the flat part."""
    start: Number | None = None
    """Of expressions, lambda at the edge of the flat part; 0 where left out."""
    end: Number | None = None
    """lambda where the curve ends; of an ellipse a quarter turn where left out, of points none is given."""
    end_deg: Number | None = None
    """The same in degrees, where lambda is an angle."""


class CurvedSoleSpec(Table):
    """A cylindrical sole that rolls without slipping: its section lies in the plane of the foot frame's x and y.

    The leg ends in three parallel revolute joints: hip, knee, ankle. Flat on the ground, x points down and y forward.
    """

    depth: Number | None = None
    """x of the flat part (m)."""
    depth_mm: Number | None = None
    flat: Pair | None = None
    """y of its rear and its front edge (m)."""
    flat_mm: Pair | None = None
    width: Number | None = None
    """Length of the generatrices (m); the foot touches the ground in a point of the plane where left out."""
    width_mm: Number | None = None
    toe: DirectrixSpec | None = None
    """The curve in front of the flat part."""
    heel: DirectrixSpec | None = None
    """The curve behind it."""
    slope: Number | None = None
    """By how much the ground rises forward, in the leg's plane (rad); 0 where left out: level ground, across gravity."""
    slope_deg: Number | None = None

    ANGLES: ClassVar[frozenset[str]] = frozenset({"slope"})


FORMS = ("x", "polynomial", "ellipse", "points")
"""Keys of the ways to give a curve; `y` goes with `x`."""
CURVES = ("toe", "heel")

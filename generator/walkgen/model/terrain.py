"""The ground: patches of surface given by expressions, planes and height maps, and which way is up."""

from dataclasses import dataclass, field
from decimal import Decimal

from walkgen.spec.scalar import Scalar, Vector

Interval = tuple[Scalar, Scalar]


@dataclass(frozen=True)
class Explicit:
    """z = height(x, y); the names x and y in it are coordinates."""

    height: Scalar


@dataclass(frozen=True)
class Implicit:
    """f(x, y, z) = 0; the names x, y and z in it are coordinates."""

    f: Scalar


@dataclass(frozen=True)
class Parametric:
    """(x, y, z)(u, v); the names u and v in them are coordinates."""

    position: Vector


@dataclass(frozen=True)
class Plane:
    """The plane through a point (m), with a normal of any length."""

    point: Vector
    normal: Vector


@dataclass(frozen=True)
class HeightMap:
    """Heights (m) on a square grid, row after row: y grows from row to row, x from column to column, `spacing` (m) apart.

    The first is at `corner`. Between the points the surface is bilinear, or bicubic with continuous slopes.
    """

    rows: int
    columns: int
    heights: tuple[Decimal, ...] = field(hash=False, repr=False)  # a mechanism is a key of caches, and this is long
    corner: tuple[Scalar, Scalar]
    spacing: Scalar
    bicubic: bool


Surface = Explicit | Implicit | Parametric | Plane | HeightMap


@dataclass(frozen=True)
class Patch:
    """A surface where both coordinates are in `domain`: x and y, or u and v if it is parametric; None is everywhere.

    `mu` is the coefficient of friction, None where unknown; `kn` and `kt` are stiffnesses (N/m), None where rigid.
    """

    name: str
    surface: Surface
    domain: tuple[Interval | None, Interval | None]
    mu: Scalar | None
    kn: Scalar | None
    kt: Scalar | None


@dataclass(frozen=True)
class Terrain:
    """Patches in the world frame, the first whose domain holds a point counts; `up` is against gravity, of any length."""

    patches: tuple[Patch, ...]
    up: Vector

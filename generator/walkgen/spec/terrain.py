"""The tables of the ground a robot walks on: patches, each a surface over its domain."""

from typing import Literal

from pydantic import StrictStr

from walkgen.spec.table import Number, Pair, Table, Triple

COORDINATES = ("x", "y", "z", "u", "v")
"""Names that expressions of surfaces may use besides parameters."""


class Domain(Table):
    """Where a terrain patch holds: x and y (m), of a parametric surface u and v; everywhere where left out."""

    x: Pair | None = None
    y: Pair | None = None
    u: Pair | None = None
    v: Pair | None = None


class TerrainPatch(Table):
    """A piece of ground; the first whose domain holds the point counts."""

    name: StrictStr
    surface: Literal["explicit", "implicit", "parametric", "plane", "heightmap"]
    height: Number | None = None
    """explicit: height as an expression in x and y (m)."""
    f: Number | None = None
    """implicit: an expression in x, y, z that is 0 on the surface."""
    x: Number | None = None
    """parametric: expressions in u and v (m)."""
    y: Number | None = None
    z: Number | None = None
    point: Triple | None = None
    """plane: one of its points (m)."""
    normal: Triple | None = None
    """plane: its normal."""
    file: StrictStr | None = None
    """heightmap: file beside the spec, a row of numbers (m) a line, y growing from line to line, x from column to column."""
    spacing: Number | None = None
    """heightmap: distance of its points (m)."""
    interpolation: Literal["bilinear", "bicubic"] | None = None
    """heightmap: between its points; bicubic (slopes are continuous) where left out."""
    domain: Domain | None = None
    mu: Number | None = None
    """Coefficient of friction."""
    kn: Number | None = None
    """Stiffness along the normal (N/m); rigid where left out."""
    kt: Number | None = None
    """Stiffness across the normal (N/m)."""

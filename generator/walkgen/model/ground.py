"""From the spec's terrain tables to the Terrain: parameters resolved, height maps read."""

from pathlib import Path

from walkgen.model.terrain import Explicit, HeightMap, Implicit, Interval, Parametric, Patch, Plane, Surface, Terrain
from walkgen.model.values import Values
from walkgen.spec.heightmap import read_heights
from walkgen.spec.scalar import ZERO, Scalar, exact, mul, neg
from walkgen.spec.scalar import add as plus
from walkgen.spec.schema import RobotSpec
from walkgen.spec.terrain import TerrainPatch


def ground(spec: RobotSpec, folder: Path, values: Values) -> Terrain | None:
    """The ground that the spec describes, None if it describes none.

    Args:
        spec: validated.
        folder: where its height maps are.
        values: of its parameters.
    """
    if not spec.terrain:
        return None
    x, y, z = values.vector(spec.robot.si("gravity"))
    return Terrain(tuple(_patch(patch, folder, values) for patch in spec.terrain), (neg(x), neg(y), neg(z)))


def _patch(patch: TerrainPatch, folder: Path, values: Values) -> Patch:
    surface = _surface(patch, folder, values)
    return Patch(patch.name, surface, _domain(patch, surface, values), *(values.optional(n) for n in (patch.mu, patch.kn, patch.kt)))


def _surface(patch: TerrainPatch, folder: Path, values: Values) -> Surface:
    if patch.surface == "explicit":
        return Explicit(values.resolve(patch.height))
    if patch.surface == "implicit":
        return Implicit(values.resolve(patch.f))
    if patch.surface == "plane":
        return Plane(values.vector(patch.point), values.vector(patch.normal))
    if patch.surface == "heightmap":
        return _height_map(patch, folder, values)
    return Parametric((values.resolve(patch.x), values.resolve(patch.y), values.resolve(patch.z)))


def _height_map(patch: TerrainPatch, folder: Path, values: Values) -> HeightMap:
    grid = read_heights(folder, patch.file or "")
    corner = (_lower(patch, "x", values), _lower(patch, "y", values))
    spacing, bicubic = values.resolve(patch.spacing), patch.interpolation != "bilinear"
    return HeightMap(grid.rows, grid.columns, grid.heights, corner, spacing, bicubic)


def _lower(patch: TerrainPatch, key: str, values: Values) -> Scalar:
    pair = values.pair(getattr(patch.domain, key, None))
    return pair[0] if pair else ZERO


def _domain(patch: TerrainPatch, surface: Surface, values: Values) -> tuple[Interval | None, Interval | None]:
    """The spec's intervals; a height map without them holds wherever it has points."""
    first, second = ("u", "v") if isinstance(surface, Parametric) else ("x", "y")
    given = tuple(values.pair(getattr(patch.domain, key, None)) for key in (first, second))
    if not isinstance(surface, HeightMap):
        return given[0], given[1]
    reach = tuple(
        (low, plus(low, mul(exact(points - 1), surface.spacing)))
        for low, points in zip(surface.corner, (surface.columns, surface.rows), strict=True)
    )
    return given[0] or reach[0], given[1] or reach[1]

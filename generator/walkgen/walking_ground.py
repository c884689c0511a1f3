"""The ground that `walkgen gait --terrain` names: level, a slope, a height map, or a height written in x and y."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from walkgen.errors import Problem, SpecError
from walkgen.gait.ground import Grid, Ground, Relief, Slope
from walkgen.spec.heightmap import HeightMapError, read_heights
from walkgen.spec.problems import shown
from walkgen.spec.scalar import ExpressionError, Scalar, evaluate, names, parse

TERRAINS = "flat, slope:DEGREES, map:FILE:SPACING[:X:Y], or a height (m) in x and y, such as 0.05*sin(3*x)"
"""What it understands."""
_STEEPEST = 80.0


def terrain_of(text: str) -> Ground | None:
    """The ground of `--terrain`, one of `TERRAINS`; None for the spec's own.

    Raises:
        SpecError: none of these.
    """
    if text in {"", "spec"}:
        return None
    if text == "flat":
        return Slope()
    kind, _, value = text.partition(":")
    if kind == "map":
        return _map(value)
    return _slope(value) if kind == "slope" else _relief(text)


def _map(text: str) -> Grid:
    """FILE:SPACING, with its middle over the origin, or FILE:SPACING:X:Y with the first number there."""
    name, *numbers = text.split(":")
    try:
        spacing, *corner = map(float, numbers)
        fine = len(corner) in {0, 2} and spacing > 0.0 and all(map(math.isfinite, (spacing, *corner)))
    except ValueError:
        fine = False
    if not fine:
        cure = "map:FILE:SPACING, spacing in m; or map:FILE:SPACING:X:Y with the place of the first number"
        raise SpecError(Problem("WG613", f'"map:{shown(text)}" is no height map', cure))
    file = Path(name)
    try:
        grid = read_heights(file.parent, file.name)
    except HeightMapError as error:
        cure = "give lines of numbers (m), each with as many; y grows from line to line, x from column to column"
        raise SpecError(Problem("WG613", f'"{shown(name)}" is no height map: {shown(str(error), 200)}', cure)) from None
    x, y = corner or (-0.5 * spacing * (grid.columns - 1), -0.5 * spacing * (grid.rows - 1))
    return Grid(np.array(grid.heights, float).reshape(grid.rows, grid.columns), spacing, (x, y))


def _slope(text: str) -> Slope:
    try:
        angle = float(text)
    except ValueError:
        angle = math.nan
    if not abs(angle) <= _STEEPEST:
        raise SpecError(
            Problem("WG613", f'"slope:{shown(text)}" is no slope', f"slope:DEGREES, up to {_STEEPEST:g} either way; such as slope:15")
        )
    return Slope(math.radians(angle))


def _relief(text: str) -> Relief:
    try:
        height = parse(text)
    except ExpressionError as error:
        raise SpecError(Problem("WG613", f"--terrain: {error}", TERRAINS)) from None
    unknown = sorted(names(height) - {"x", "y"})
    if unknown:
        raise SpecError(Problem("WG613", f'--terrain: "{shown(unknown[0])}" is not known; a height is written in x and y', TERRAINS))
    return Relief(_function(height))


def _function(height: Scalar) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    return lambda x, y: evaluate(height, _Arrays, {"x": x, "y": y})


class _Arrays:
    """What `evaluate` needs, on arrays."""

    mpf = float
    pi = math.pi
    sqrt = staticmethod(np.sqrt)
    sin = staticmethod(np.sin)
    cos = staticmethod(np.cos)
    tan = staticmethod(np.tan)
    atan2 = staticmethod(np.arctan2)
    hypot = staticmethod(np.hypot)

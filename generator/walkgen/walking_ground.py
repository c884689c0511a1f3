"""The ground that `walkgen gait --terrain` names: level, a slope, or a height written in x and y."""

import math
from collections.abc import Callable

import numpy as np

from walkgen.errors import Problem, SpecError
from walkgen.gait.ground import Ground, Relief, Slope
from walkgen.spec.problems import shown
from walkgen.spec.scalar import ExpressionError, Scalar, evaluate, names, parse

TERRAINS = "flat, slope:DEGREES, or a height (m) in x and y, such as 0.05*sin(3*x)"
"""What it understands."""
_STEEPEST = 80.0


def terrain_of(text: str) -> Ground | None:
    """The ground of `--terrain`: flat, slope:DEGREES, or a height in x and y; None for the spec's own.

    Raises:
        SpecError: none of these.
    """
    if text in {"", "spec"}:
        return None
    if text == "flat":
        return Slope()
    kind, _, value = text.partition(":")
    return _slope(value) if kind == "slope" else _relief(text)


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

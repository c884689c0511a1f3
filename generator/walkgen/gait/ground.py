"""The ground that a walk goes over: heights and normals; a slope, a function, a height map, or what the robot's spec describes."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from walkgen.runtime.robot import Terrain
from walkgen.runtime.solves.heightmap import heightmap

_NEARBY = 1e-5
_EDGE = 1e-9
"""Spacings; a point so far beyond a map's edge is on it."""


class Ground(Protocol):
    """Height over x and y in the world, z up; NaN where there is no ground."""

    def height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Heights [...] (m) at x [...] and y [...] (m)."""

    def normal(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unit normals [...,3], upwards."""

    def friction(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Coefficients of friction [...]; NaN where unknown."""


@dataclass(frozen=True)
class Slope:
    """A plane through the origin that rises by `angle` (rad) along x; level where it is left out."""

    angle: float = 0.0

    def height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Heights [...] (m) at x [...] and y [...] (m)."""
        return math.tan(self.angle) * x + 0.0 * y

    def normal(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unit normals [...,3], upwards."""
        return np.broadcast_to([-math.sin(self.angle), 0.0, math.cos(self.angle)], (*np.broadcast(x, y).shape, 3))

    def friction(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unknown."""
        return np.full(np.broadcast(x, y).shape, math.nan)


@dataclass(frozen=True)
class Relief:
    """z = f(x, y); f takes and gives arrays."""

    function: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Heights [...] (m) at x [...] and y [...] (m); NaN where the function has no value."""
        with np.errstate(all="ignore"):
            z = np.asarray(self.function(x, y), float) + 0.0 * (x + y)
        return np.where(np.isfinite(z), z, np.nan)

    def normal(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unit normals [...,3], upwards, from heights 10 um to either side."""
        slopes = (self.height(x + _NEARBY, y) - self.height(x - _NEARBY, y), self.height(x, y + _NEARBY) - self.height(x, y - _NEARBY))
        normal = np.stack([-slopes[0] / (2 * _NEARBY), -slopes[1] / (2 * _NEARBY), np.ones_like(slopes[0])], axis=-1)
        unit: np.ndarray = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        return unit

    def friction(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unknown."""
        return np.full(np.broadcast(x, y).shape, math.nan)


@dataclass(frozen=True, eq=False)
class Grid:
    """Heights on a square grid, with continuous slopes between them (bicubic, Catmull-Rom); no ground off the map.

    Attributes:
        heights: [rows, columns] (m), two at least of each: x grows from column to column, y from row to row.
        spacing: m.
        corner: x and y of the first one (m).
    """

    heights: np.ndarray
    spacing: float
    corner: tuple[float, float]

    def height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Heights [...] (m) at x [...] and y [...] (m); NaN off the map."""
        return self._jet(x, y)[..., 0]

    def normal(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unit normals [...,3], upwards."""
        jet = self._jet(x, y)
        normal = np.stack([-jet[..., 1], -jet[..., 2], np.ones_like(jet[..., 0])], axis=-1)
        unit: np.ndarray = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        return unit

    def friction(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unknown."""
        return np.full(np.broadcast(x, y).shape, math.nan)

    def _jet(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Height and its derivatives by x and y first [...,6]."""
        rows, columns = self.heights.shape
        p = np.stack([*np.broadcast_arrays(x, y), np.zeros(np.broadcast(x, y).shape)], axis=-1)
        jet = heightmap(self.heights, rows, columns, True, np.array([*self.corner, self.spacing]), p)
        place = (p[..., :2] - self.corner) / self.spacing
        inside = ((place >= -_EDGE) & (place <= np.array([columns - 1, rows - 1]) + _EDGE)).all(axis=-1, keepdims=True)
        return np.where(inside, jet, np.nan)


@dataclass(frozen=True)
class Described:
    """The ground of a spec: `Described(robot.terrain)`."""

    terrain: Terrain

    def height(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Heights [...] (m) at x [...] and y [...] (m); NaN off every patch."""
        found: np.ndarray = self.terrain.height(np.stack([x, y, np.zeros_like(x)], axis=-1))
        return found

    def normal(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Unit normals [...,3], upwards."""
        found: np.ndarray = self.terrain.normal(np.stack([x, y, np.zeros_like(x)], axis=-1))
        return found

    def friction(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Coefficients of friction [...]; NaN where a patch gives none, and of ground that was built without `ground`."""
        if not hasattr(self.terrain, "ground"):
            return np.full(np.broadcast(x, y).shape, math.nan)
        found: np.ndarray = self.terrain.ground(np.stack([x, y, np.zeros_like(x)], axis=-1))[0]
        return found

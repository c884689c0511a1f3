"""Stances whose forces are compared, with no cone active and with some, and their matrices for solvers of quadratic programs."""

from dataclasses import dataclass

import numpy as np

SEED = 7
Array = np.ndarray


@dataclass(frozen=True)
class Stances:
    """Rows: points, normals [rows,k,3], mu [rows,k], wrench [rows,6] of unit load."""

    points: Array
    normals: Array
    mu: Array
    wrench: Array

    def __getitem__(self, rows: Array) -> "Stances":
        return Stances(*(value[rows] for value in vars(self).values()))


def draw(rows: int, k: int, friction: tuple[float, float], tilt: float, seed: int = SEED) -> Stances:
    """Feet around the origin, normals up to `tilt` from the vertical in the mean, the centre of mass over the feet."""
    generator = np.random.default_rng((seed, k))
    angle = 2.0 * np.pi * (np.arange(k) + generator.uniform(-0.3, 0.3, (rows, k))) / k
    radius = generator.uniform(0.25, 0.45, (rows, k))
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), generator.normal(0.0, 0.03, (rows, k))], -1)
    normals = np.array([0.0, 0.0, 1.0]) + generator.normal(0.0, tilt, (rows, k, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    force = np.array([0.0, 0.0, -1.0]) + generator.normal(0.0, 0.15, (rows, 3))
    centre = np.array([0.0, 0.0, 0.35]) + generator.normal(0.0, 0.05, (rows, 3))
    wrench = np.concatenate([force, np.cross(centre, force)], -1)
    return Stances(points, normals, generator.uniform(*friction, (rows, k)), wrench)


def pyramids(stances: Stances) -> tuple[Array, Array, Array]:
    """A [rows,6+4k,3k], lower, upper [rows,6+4k]: balance, then four sides a foot."""
    rows, k = stances.mu.shape
    n = stances.normals
    axis = np.where(np.abs(n[..., :1]) > 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    along = axis - (n * axis).sum(-1, keepdims=True) * n
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    aside = np.cross(n, along)
    A = np.zeros((rows, 6 + 4 * k, 3 * k))
    for foot in range(k):
        place = slice(3 * foot, 3 * foot + 3)
        A[:, :3, place] = np.eye(3)
        A[:, 3:6, place] = np.stack([np.cross(stances.points[:, foot], np.eye(3)[j]) for j in range(3)], -1)
        reach = stances.mu[:, foot, None] * np.sqrt(0.5) * n[:, foot]
        for side, direction in enumerate((along, aside, -along, -aside)):
            A[:, 6 + 4 * foot + side, place] = direction[:, foot] - reach
    upper = np.concatenate([-stances.wrench, np.zeros((rows, 4 * k))], 1)
    lower = np.concatenate([-stances.wrench, np.full((rows, 4 * k), -1e30)], 1)
    return A, lower, upper

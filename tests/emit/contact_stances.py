"""Random stances: slopes and mixed normals, feet that slide or bear nothing, loads at and beyond the edge of what can be carried."""

import numpy as np
from contact_library import Stances


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_stances(seed: int, rows: int, k: int, rough: float = 0.4) -> Stances:
    """Feet about the origin below a centre of mass, on a slope, with normals that differ by `rough` in half of the stances.

    Some carry the load within their cones, some slide or bear nothing, many tip over or slide away.
    """
    generator = np.random.default_rng(seed)
    angle = 2.0 * np.pi * (np.arange(k) + generator.uniform(-0.4, 0.4, (rows, k))) / k
    radius = generator.uniform(0.15, 0.5, (rows, k))
    height = generator.normal(0.0, 0.06, (rows, k))
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], -1)
    vertical = np.array([0.0, 0.0, 1.0])
    up = _unit(vertical + generator.normal(0.0, 0.25, (rows, 1, 3)) * [1.0, 1.0, 0.0])
    normals = _unit(up + rough * generator.normal(0.0, 0.5, (rows, k, 3)) * generator.integers(0, 2, (rows, 1, 1)))
    mu = generator.uniform(0.1, 1.1, (rows, k))
    force = -300.0 * vertical + 300.0 * generator.uniform(0.0, 0.6, (rows, 1)) * generator.normal(0.0, 1.0, (rows, 3))
    centre = generator.normal(0.0, 0.12, (rows, 3)) + 0.35 * vertical
    moment = np.cross(centre, force) + generator.normal(0.0, 6.0, (rows, 3))
    return Stances(points, normals, mu, np.concatenate([force, moment], -1), np.ones((rows, k)), np.full((rows, k), np.inf))


def grasp(points):
    """G [...,6,3k]: forces of the feet to force and moment about the origin."""
    points = np.asarray(points)
    blocks = np.zeros((*points.shape[:-1], 6, 3))
    blocks[..., :3, :] = np.eye(3)
    for axis in range(3):
        blocks[..., 3:, axis] = np.cross(points, np.eye(3)[axis])
    return np.moveaxis(blocks, -3, -2).reshape((*points.shape[:-2], 6, 3 * points.shape[-2]))

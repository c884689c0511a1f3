"""A tripod in a spherical bowl of radius 1: where it may stand and where it stops, from its balance."""

import numpy as np
from scipy.optimize import fsolve

from walkgen.runtime.solves.settle import Robot

LIMITS = {0.2: 0.332412403062, 0.1: 0.168356085593}
"""Tilt, rad, by friction; foot 0 is raised."""
NORMAL_FORCES = np.array([35.572468992130, 281.897298449295, 281.897298449295])
"""At the limit with friction 0.2, N."""
WEIGHT = np.array([0.0, 0.0, -60 * 9.81])
_AZIMUTH = 2 * np.pi * np.arange(3) / 3
_FEET = np.stack([0.3 * np.cos(_AZIMUTH), 0.3 * np.sin(_AZIMUTH), np.zeros(3)], axis=1)


def bowl(mu: float, wrench=(0.0,) * 6) -> Robot:
    def ground(points):
        distance = np.linalg.norm(points, axis=-1, keepdims=True)
        return np.concatenate([1.0 - distance, -points / distance, np.full_like(distance, mu)], axis=-1)

    return Robot(_FEET, np.array([0.0, 0.0, 0.35]), WEIGHT, np.array(wrench), ground)


def tilted(angle: float) -> np.ndarray:
    """The pose of the tripod turned about the bowl's centre so that foot 0 is higher."""
    c, s = np.cos(angle), np.sin(angle)
    pose = np.eye(4)
    pose[:3, :3] = [[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]]
    pose[:3, 3] = pose[:3, :3] @ [0.0, 0.0, -np.sqrt(1 - 0.09)]
    return pose


def stance(angle: float):
    """Points, normals and load."""
    pose = tilted(angle)
    points = _FEET @ pose[:3, :3].T + pose[:3, 3]
    at = pose[:3, :3] @ [0.0, 0.0, 0.35] + pose[:3, 3]
    return points, -points, np.concatenate([WEIGHT, np.cross(at, WEIGHT)])


def tilt(pose) -> float:
    return float(np.arctan2(pose[2, 0], pose[0, 0]))


def limit(mu: float) -> tuple[float, np.ndarray]:
    """The tilt at which all friction is used by turning about the level axis through the centre, and normal forces: three equations."""

    def lacking(x):
        points, normals, load = stance(x[0])
        V = np.cross([0.0, 1.0, 0.0], points)  # lowers foot 0
        f = np.array([x[1], x[2], x[2]])[:, None] * (normals - mu * V / np.linalg.norm(V, axis=1)[:, None])
        wrench = np.concatenate([f.sum(axis=0), np.cross(points, f).sum(axis=0)]) + load
        return [wrench[0], wrench[2], wrench[4]]

    x = fsolve(lacking, [mu * 1.6, 100.0, 250.0], xtol=1e-13)
    return x[0], np.array([x[1], x[2], x[2]])

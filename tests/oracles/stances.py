"""Random stances on slopes and in bowls, and loads on them, for tests of contact forces."""

import numpy as np

GRAVITY = 9.81

# O10: a tripod on a plane
O10_POINTS = np.array([[0.30, 0.0, 0.0], [-0.2, 0.25, 0.0], [-0.15, -0.28, 0.0]])
O10_CENTRE_OF_MASS = np.array([0.02, 0.03, 0.30])
O10_NORMAL_FORCES = np.array([348.6499724960401, 143.2329924592835, 67.90890053600377])
O10_FRICTION = 0.32809786048976614
O10_AXIS = np.array([-0.18287015561434, 2.70775496746280])


def incline_load(angle: float, extra=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)) -> np.ndarray:
    """Gravity of 60 kg at O10's centre of mass on an incline seen level, and more."""
    weight = 60 * GRAVITY * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    return np.concatenate([weight, np.cross(O10_CENTRE_OF_MASS, weight)]) + extra


O10_LOAD = incline_load(np.deg2rad(18), (0.0, 20.0, 0.0, 0.0, 0.0, 6.0))


def random_stance(rng, k: int, slope: float = 0.3):
    """Feet [k, 3], each on its own slope, and a load below which most stances stand."""
    angle = 2 * np.pi * (np.arange(k) + rng.uniform(-0.3, 0.3, k)) / k
    points = np.stack([rng.uniform(0.2, 0.5) * np.cos(angle), rng.uniform(0.2, 0.5) * np.sin(angle), rng.uniform(-0.05, 0.05, k)], axis=1)
    normals = unit(np.array([0.0, 0.0, 1.0]) + slope * rng.uniform(-1, 1, (k, 3)))
    force = np.array([*rng.uniform(-150, 150, 2), -rng.uniform(200, 600)])
    at = np.array([*rng.uniform(-0.1, 0.1, 2), rng.uniform(0.2, 0.4)])
    return points, normals, np.concatenate([force, np.cross(at, force) + rng.uniform(-5, 5, 3)])


def random_rotation(rng) -> np.ndarray:
    Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
    Q = Q * np.sign(np.diag(R))
    return Q * np.linalg.det(Q)


def unit(vectors) -> np.ndarray:
    return np.asarray(vectors) / np.linalg.norm(vectors, axis=-1, keepdims=True)


def moved(points, normals, wrench, R, shift):
    """The same stance seen from another frame."""
    force, moment = R @ wrench[:3], R @ wrench[3:]
    return points @ R.T + shift, normals @ R.T, np.concatenate([force, moment + np.cross(shift, force)])

"""Random gaits and trajectories that tests of gaits share."""

import numpy as np

from walkgen.gait.pattern import Gait
from walkgen.gait.trajectory import Trajectory


def random_gait(seed: int) -> Gait:
    """One to eight legs with their own duty factors."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 9))
    duty, phase = rng.uniform(0.05, 0.95, count), rng.uniform(-2, 2, count)
    return Gait(tuple(f"leg{n}" for n in range(count)), tuple(duty), tuple(phase), rng.uniform(0.2, 5.0), rng.uniform(-0.5, 0.5))


def random_trajectory(seed: int) -> Trajectory:
    """A random gait with feet about a platform."""
    rng = np.random.default_rng(1000 + seed)
    gait = random_gait(seed)
    return Trajectory(gait, tuple(map(tuple, rng.uniform(-1, 1, (len(gait.legs), 3)))), rng.uniform(0.02, 0.3))

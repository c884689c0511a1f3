"""What follows from the Jacobian of a path of many joints: the reference of walkgen_columns.h."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Reals = NDArray[np.float64]


def second_derivatives(J: ArrayLike, axes: ArrayLike, n: int) -> Reals:
    """How a path's Jacobian changes with its joints: a joint turns the columns of those behind it about its axis.

    Args:
        J: how the foot moves with each joint, base to foot [..., 3, n].
        axes: how it turns [..., 3, n]; zero where a joint slides.
        n: number of joints.

    Returns:
        H [..., 3, n, n], d2p / dq_i dq_j.
    """
    before, behind = np.minimum.outer(np.arange(n), np.arange(n)), np.maximum.outer(np.arange(n), np.arange(n))
    return np.cross(np.asarray(axes, float)[..., before], np.asarray(J, float)[..., behind], axis=-3)


def rest_acceleration(J: ArrayLike, axes: ArrayLike, qd: ArrayLike, a: ArrayLike, n: int) -> Reals:
    """What a wanted acceleration of the foot leaves for the joints' accelerations at these rates.

    Args:
        J: how the foot moves with each joint, base to foot [..., 3, n].
        axes: how it turns [..., 3, n].
        qd: joint rates [..., n].
        a: the foot's acceleration [..., 3].
        n: number of joints.

    Returns:
        a - Jdot qd [..., 3].
    """
    rates = np.asarray(qd, float)[..., None, :]
    spins, flows = np.asarray(axes, float) * rates, np.asarray(J, float) * rates
    through = np.cumsum(spins[..., :n], axis=-1)
    rest: Reals = np.asarray(a, float) - np.sum(np.cross(2.0 * through - spins, flows, axis=-2), axis=-1)
    return rest

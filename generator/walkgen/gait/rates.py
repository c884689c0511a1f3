"""Joint rates and accelerations of a walk: the feet's Jacobian and its rate, solved leg by leg for all instants at once."""

import numpy as np

from walkgen.gait.chains import Bending, joints
from walkgen.gait.driven import is_driven
from walkgen.runtime.robot import Leg, Robot, Route

_SMALL = 1e-10
_BLOCK = 1024
"""Instants whose Jacobians fit in the cache."""


def rates(robot: Robot, q: np.ndarray, bending: Bending, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """qd and qdd [t,nq] of feet that move so relative to the first platform.

    Args:
        robot: with `foot_jacobians` and `foot_bias_acceleration`.
        q: joint values [t,nq].
        bending: of the chains, and of legs with a path of their own.
        velocity: of the feet in the first platform's frame [t,k,3] (m/s).
        acceleration: of the feet there [t,k,3] (m/s^2).
    """
    qd, qdd = bending.qd.copy(), bending.qdd.copy()
    for start in range(0, len(q), _BLOCK):
        rows = slice(start, start + _BLOCK)
        _fill(robot, q[rows], (qd[rows], qdd[rows]), velocity[rows], acceleration[rows])
    return qd, qdd


def _fill(robot: Robot, q: np.ndarray, rate: tuple[np.ndarray, np.ndarray], velocity: np.ndarray, acceleration: np.ndarray) -> None:
    """The legs' parts of qd and qdd, in place; those of the chains are there already."""
    (qd, qdd), chains = rate, joints(robot)
    jacobians = robot.foot_jacobians(q)
    for foot, leg in enumerate(robot.legs.values()):
        if is_driven(leg):
            continue
        inverse = _inverse(jacobians[:, foot, :, leg.slice])
        carried = jacobians[:, foot][..., chains]
        qd[:, leg.slice] = _times(inverse, velocity[:, foot] - _times(carried, qd[:, chains]))
        rest = acceleration[:, foot] - _times(carried, qdd[:, chains]) - _bias(robot, leg, q, qd)
        qdd[:, leg.slice] = _times(inverse, rest)


def _bias(robot: Robot, leg: Leg, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
    """What the foot accelerates by at constant rates (m/s^2)."""
    owner: Leg | Route = robot.routes.get(leg.name, leg)
    own = robot.routes[leg.name].indices if leg.name in robot.routes else np.arange(leg.slice.start, leg.slice.stop)
    found: np.ndarray = owner.foot_bias_acceleration(q[:, own], qd[:, own])[:, :3]
    return found


def _inverse(jacobian: np.ndarray) -> np.ndarray:
    """J^+ [t,n,3]: by cofactors where J is square and regular; NaN where it has a NaN."""
    finite = np.isfinite(jacobian).all(axis=(1, 2))
    inverse = np.full((len(jacobian), jacobian.shape[2], 3), np.nan)
    if jacobian.shape[2] == 3:
        a, b, c = jacobian.transpose(1, 0, 2)
        cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
        determinant = (cofactors[..., 0] * a).sum(axis=-1)
        regular = finite & (np.abs(determinant) > _SMALL * np.abs(jacobian).sum(axis=(1, 2)) ** 3)
        inverse[regular] = cofactors[regular] / determinant[regular, None, None]
        finite &= ~regular
    inverse[finite] = np.linalg.pinv(jacobian[finite], rcond=_SMALL)
    return inverse


def _times(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    product: np.ndarray = (matrix @ vector[..., None])[..., 0]
    return product

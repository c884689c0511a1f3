"""Joint rates and accelerations of a walk: the feet's Jacobian and its rate, solved leg by leg for all instants at once."""

import numpy as np

from walkgen.gait.chains import Bending, joints
from walkgen.gait.planned import is_planned
from walkgen.runtime.robot import Leg, Robot, Route

_SMALL = 1e-10
_BLOCK = 1024
"""Instants whose Jacobians fit in the cache."""


def rates(robot: Robot, q: np.ndarray, bending: Bending, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """qd and qdd [t,nq] of feet that move so relative to the first platform.

    Args:
        robot: with `foot_jacobians` and `foot_bias_acceleration`.
        q: joint values [t,nq].
        bending: of the chains, and of legs that are planned by their joints.
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
    bent = qd[:, chains].T, qdd[:, chains].T
    jacobians = robot.foot_jacobians(q)
    for foot, leg in enumerate(robot.legs.values()):
        if is_planned(leg):
            continue
        inverse = _inverse(_last(jacobians[:, foot, :, leg.slice]))
        carried = _last(jacobians[:, foot][..., chains])
        qd[:, leg.slice] = _times(inverse, velocity[:, foot].T - _times(carried, bent[0])).T
        rest = acceleration[:, foot].T - _times(carried, bent[1]) - _bias(robot, leg, q, qd).T
        qdd[:, leg.slice] = _times(inverse, rest).T


def _last(matrices: np.ndarray) -> np.ndarray:
    """Matrices [t,m,n] with the instants last [m,n,t], where sums of products run along memory."""
    return np.ascontiguousarray(matrices.transpose(1, 2, 0))


def _bias(robot: Robot, leg: Leg, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
    """What the foot accelerates by at constant rates (m/s^2)."""
    owner: Leg | Route = robot.routes.get(leg.name, leg)
    own = robot.routes[leg.name].indices if leg.name in robot.routes else np.arange(leg.slice.start, leg.slice.stop)
    found: np.ndarray = owner.foot_bias_acceleration(q[:, own], qd[:, own])[:, :3]
    return found


def _inverse(jacobian: np.ndarray) -> np.ndarray:
    """J^+ [n,3,t] of J [3,n,t]: by cofactors where J is square and regular; NaN where it has a NaN."""
    finite = np.isfinite(jacobian).all(axis=(0, 1))
    if jacobian.shape[1] != 3:
        return _pseudoinverse(jacobian, np.full((jacobian.shape[1], 3, len(finite)), np.nan), finite)
    cofactors = np.array([[_cofactor(jacobian, i, j) for i in range(3)] for j in range(3)])
    determinant = (jacobian[0] * cofactors[:, 0]).sum(axis=0)
    regular = finite & (np.abs(determinant) > _SMALL * np.abs(jacobian).sum(axis=(0, 1)) ** 3)
    inverse: np.ndarray = cofactors / np.where(regular, determinant, np.nan)
    return inverse if regular.all() else _pseudoinverse(jacobian, inverse, finite & ~regular)


def _cofactor(matrix: np.ndarray, i: int, j: int) -> np.ndarray:
    """Of matrix[i, j] [t]."""
    rows, columns = ((i + 1) % 3, (i + 2) % 3), ((j + 1) % 3, (j + 2) % 3)
    cofactor: np.ndarray = (
        matrix[rows[0], columns[0]] * matrix[rows[1], columns[1]] - matrix[rows[0], columns[1]] * matrix[rows[1], columns[0]]
    )
    return cofactor


def _pseudoinverse(jacobian: np.ndarray, inverse: np.ndarray, where: np.ndarray) -> np.ndarray:
    """`inverse` [n,3,t] with that of J [3,n,t] at some instants."""
    inverse[..., where] = np.linalg.pinv(jacobian[..., where].transpose(2, 0, 1), rcond=_SMALL).transpose(1, 2, 0)
    return inverse


def _times(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """[m,t] of [m,n,t] and [n,t]."""
    product: np.ndarray = (matrix * vector).sum(axis=1)
    return product

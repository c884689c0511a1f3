"""What a walk costs: the power of all joints, split into what carries the weight, what moves the masses and what friction takes."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from walkgen.gait.stance_margins import standing
from walkgen.runtime.robot import Robot
from walkgen.signature import STATUSES

_OK, _INFEASIBLE = STATUSES.index("OK"), STATUSES.index("INFEASIBLE")


class Contact(NamedTuple):
    """Feet in the world [t,k,3] (m), the ground's normals there [t,k,3], whether each supports [t,k], coefficients of friction [t,k]."""

    points: np.ndarray
    normals: np.ndarray
    support: np.ndarray
    mu: np.ndarray


@dataclass(frozen=True)
class Power:
    """Of every joint at every instant [t,nq] (W), positive where the drive works; NaN where the feet cannot carry the load.

    Attributes:
        weight: of torques that hold the robot at rest.
        inertia: what motion adds to them, friction apart.
        friction: of torques that overcome the friction of the pairs, the part that changes its sign with all velocities.
        torque: all of it (N m, N).
        overcome: whether no forces within the friction cones carry the load [t], which is proved.
    """

    weight: np.ndarray
    inertia: np.ndarray
    friction: np.ndarray
    torque: np.ndarray
    overcome: np.ndarray

    @property
    def total(self) -> np.ndarray:
        """All three [t,nq] (W)."""
        total: np.ndarray = self.weight + self.inertia + self.friction
        return total


def power(robot: Robot, pose: np.ndarray, q: np.ndarray, rates: tuple[np.ndarray, np.ndarray], contact: Contact) -> Power:
    """Of a walk, its load spread over the supporting feet by least squares within their friction cones.

    Args:
        robot: with `floating_inverse_dynamics`, `demanded_wrench` and `contact_forces`.
        pose: world_T_platform [t,4,4].
        q: joint values [t,nq].
        rates: v and a of the robot [t,6+nq] each, base first, in the base's axes.
        contact: of the feet.
    """
    v, a = rates
    none = np.zeros_like(v)
    moving, overcome = _carried(robot, (pose, q, v, a), contact)
    resting, _ = _carried(robot, (pose, q, none, none), contact)
    torque = robot.floating_inverse_dynamics(pose, q, v, a, moving)[:, 6:]
    backward = robot.floating_inverse_dynamics(pose, q, -v, a, moving)[:, 6:]
    weight = robot.floating_inverse_dynamics(pose, q, none, none, resting)[:, 6:]
    friction, qd = 0.5 * (torque - backward), v[:, 6:]
    return Power(weight * qd, (torque - friction - weight) * qd, friction * qd, torque, overcome)


def _carried(robot: Robot, state: tuple[np.ndarray, ...], contact: Contact) -> tuple[np.ndarray, np.ndarray]:
    """The ground's forces on all feet [t,k,3] (N), 0 on lifted ones, and where there are none."""
    forces, overcome = np.zeros_like(contact.points), np.zeros(len(contact.points), bool)
    wrench = robot.demanded_wrench(*state)
    known = np.isfinite(wrench).all(axis=-1)
    for every, legs in standing(contact.support):
        forces[every] = np.nan
        rows = every[known[every] & np.isfinite(contact.points[np.ix_(every, legs)]).all(axis=(1, 2))]
        if not legs.size or not rows.size:
            continue
        forces[rows] = 0.0
        place = np.ix_(rows, legs)
        found, status, *_ = robot.contact_forces(contact.points[place], contact.normals[place], contact.mu[place], wrench[rows])
        overcome[rows] = status == _INFEASIBLE
        forces[place] = np.where((status == _OK)[:, None, None], found, np.nan)
    return forces, overcome

"""What a walk costs: the power of all joints, split into what carries the weight, what moves the masses and what friction takes."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from walkgen.gait.standing import Standing
from walkgen.runtime.robot import Leg, Robot, Route
from walkgen.signature import STATUSES

_OK, _INFEASIBLE = STATUSES.index("OK"), STATUSES.index("INFEASIBLE")


class Contact(NamedTuple):
    """What the robot stands on, coefficients of friction there [t,p], and the feet [t,k,3] (m)."""

    standing: Standing
    mu: np.ndarray
    feet: np.ndarray


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
    """Of a walk, its load spread over the supporting points by least squares within their friction cones.

    Args:
        robot: with `floating_inverse_dynamics`, `demanded_wrench` and `contact_forces`, and `foot_spatial_jacobian` of legs on soles.
        pose: world_T_platform [t,4,4].
        q: joint values [t,nq].
        rates: v and a of the robot [t,6+nq] each, base first, in the base's axes.
        contact: of the feet.
    """
    v, a = rates
    none = np.zeros_like(v)
    moving, overcome = _carried(robot, (pose, q, v, a), contact)
    resting, _ = _carried(robot, (pose, q, none, none), contact)
    torque = _efforts(robot, (pose, q, v, a), moving, contact)
    backward = _efforts(robot, (pose, q, -v, a), moving, contact)
    weight = _efforts(robot, (pose, q, none, none), resting, contact)
    friction, qd = 0.5 * (torque - backward), v[:, 6:]
    return Power(weight * qd, (torque - friction - weight) * qd, friction * qd, torque, overcome)


def _carried(robot: Robot, state: tuple[np.ndarray, ...], contact: Contact) -> tuple[np.ndarray, np.ndarray]:
    """The ground's forces on all points [t,p,3] (N), 0 on lifted ones, and where there are none."""
    points = contact.standing.points
    forces, overcome = np.zeros_like(points), np.zeros(len(points), bool)
    wrench = robot.demanded_wrench(*state)
    known = np.isfinite(wrench).all(axis=-1)
    for every, numbers in contact.standing.together():
        forces[every] = np.nan
        rows = every[known[every] & np.isfinite(points[np.ix_(every, numbers)]).all(axis=(1, 2))]
        if not numbers.size or not rows.size:
            continue
        forces[rows] = 0.0
        place = np.ix_(rows, numbers)
        found, status, *_ = robot.contact_forces(points[place], contact.standing.normals[place], contact.mu[place], wrench[rows])
        overcome[rows] = status == _INFEASIBLE
        forces[place] = np.where((status == _OK)[:, None, None], found, np.nan)
    return forces, overcome


def _efforts(robot: Robot, state: tuple[np.ndarray, ...], forces: np.ndarray, contact: Contact) -> np.ndarray:
    """Of all joints [t,nq]: forces on a sole's corners act on its foot point, and turn the foot besides."""
    pose, q, _, _ = state
    standing, feet = contact.standing, contact.feet
    summed = standing.by_leg(forces, feet.shape[1])
    found: np.ndarray = robot.floating_inverse_dynamics(*state, summed)[:, 6:].copy()
    if standing.points.shape == feet.shape:
        return found
    turned = standing.by_leg(np.cross(standing.points - feet[:, standing.leg], forces), feet.shape[1]) @ pose[:, :3, :3]
    for foot, leg in enumerate(robot.legs.values()):
        owner: Leg | Route = robot.routes.get(leg.name, leg)
        own = robot.routes[leg.name].indices if leg.name in robot.routes else np.arange(leg.slice.start, leg.slice.stop)
        if "foot_spatial_jacobian" in owner.functions:
            found[:, own] -= np.einsum("tin,ti->tn", owner.foot_spatial_jacobian(q[:, own])[:, 3:], turned[:, foot])
    return found

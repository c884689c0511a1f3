"""How a walk is carried: what the robot stands on, its load with inertia, the margins of its stability, the power that it takes."""

from dataclasses import dataclass

import numpy as np

from walkgen.gait.ground import Ground
from walkgen.gait.motion import Motion
from walkgen.gait.power import Contact, Power, power
from walkgen.gait.stance_margins import Margins, margins
from walkgen.gait.standing import Standing, standing
from walkgen.runtime.robot import Robot

_USUAL_MU = 0.7


@dataclass(frozen=True)
class Moving:
    """A robot at every instant: motion of its first platform, q, qd and qdd [t,nq], feet in the world [t,k,3] (m), which support [t,k]."""

    robot: Robot
    motion: Motion
    q: np.ndarray
    rates: tuple[np.ndarray, np.ndarray]
    feet: np.ndarray
    support: np.ndarray

    @property
    def state(self) -> tuple[np.ndarray, ...]:
        """Pose, q, v and a of the robot, these in its base's axes."""
        motion, (qd, qdd) = self.motion, self.rates
        linear, turning = _inward(motion, motion.velocity), _inward(motion, motion.turning)
        acceleration = _inward(motion, motion.acceleration) - np.cross(turning, linear)
        v = np.concatenate([linear, turning, qd], axis=1)
        a = np.concatenate([acceleration, _inward(motion, motion.turning_acceleration), qdd], axis=1)
        return motion.pose, self.q, v, a


def carried(moving: Moving, com: np.ndarray, ground: Ground, heading: float, mu: float | None) -> tuple[Standing, Margins, Power | None]:
    """What it stands on; margins, NaN of a robot without mass or where a foot has no place; power where it was built with what that takes.

    Args:
        moving: the robot.
        com: its centre of mass [t,3] (m).
        ground: that it walks over.
        heading: of the course (rad).
        mu: coefficient of friction; the ground's where left out.
    """
    robot, feet = moving.robot, moving.feet
    normals = ground.normal(feet[..., 0], feet[..., 1])
    stands = standing(robot, moving.motion, moving.q, feet, normals, moving.support)
    state = moving.state if hasattr(robot, "demanded_wrench") else None
    load = np.full((len(com), 6), np.nan) if state is None else robot.demanded_wrench(*state)
    stable = _margins(stands, robot, com, load, np.array([np.cos(heading), np.sin(heading), 0.0]))
    if state is None or not all(hasattr(robot, name) for name in ("floating_inverse_dynamics", "contact_forces")):
        return stands, stable, None
    contact = Contact(stands, _friction(ground, feet, mu)[:, stands.leg], feet)
    pose, q, v, a = state
    return stands, stable, power(robot, pose, q, (v, a), contact)


def _margins(stands: Standing, robot: Robot, com: np.ndarray, load: np.ndarray, way: np.ndarray) -> Margins:
    if hasattr(robot, "stability_margins"):
        return margins(robot, stands, com, load, way)
    none = np.full((len(com), 2), np.nan)
    return Margins(none[:, 0], none, none[:, 0], none[:, 0])


def _friction(ground: Ground, point: np.ndarray, mu: float | None) -> np.ndarray:
    """Coefficients under feet [t,k,3]: as asked for, else the ground's, else the usual one."""
    if mu is not None:
        return np.full(point.shape[:-1], mu)
    known = ground.friction(point[..., 0], point[..., 1])
    return np.where(np.isfinite(known), known, _USUAL_MU)


def _inward(motion: Motion, vector: np.ndarray) -> np.ndarray:
    return motion.inward(vector[:, None])[:, 0]

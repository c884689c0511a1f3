"""Motions of stiff bodies in time, with velocities and accelerations, and how they add up."""

from typing import NamedTuple

import numpy as np


class Motion(NamedTuple):
    """Of a body in the world at every instant: rotation [t,3,3], position [t,3] (m), their rates and accelerations in the world's axes.

    `turning` is the angular velocity (rad/s), `velocity` that of the body's origin (m/s).
    """

    rotation: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    turning: np.ndarray
    acceleration: np.ndarray
    turning_acceleration: np.ndarray

    @property
    def pose(self) -> np.ndarray:
        """world_T_body [t,4,4]."""
        pose = np.zeros((len(self.position), 4, 4))
        pose[:, :3, :3], pose[:, :3, 3], pose[:, 3, 3] = self.rotation, self.position, 1.0
        return pose

    def inward(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors [t,k,3] of the world in the body's axes."""
        turned: np.ndarray = vectors @ self.rotation
        return turned

    def outward(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors [t,k,3] of the body in the world's axes."""
        turned: np.ndarray = vectors @ self.rotation.transpose(0, 2, 1)
        return turned

    def seen(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points of the world [t,k,3] as the body sees them: position, velocity and acceleration relative to it, in its axes."""
        turning, spin = self.turning[:, None], self.turning_acceleration[:, None]
        away = position - self.position[:, None]
        relative = velocity - self.velocity[:, None] - np.cross(turning, away)
        left = acceleration - self.acceleration[:, None] - np.cross(spin, away) - np.cross(turning, np.cross(turning, away))
        return self.inward(away), self.inward(relative), self.inward(left - 2.0 * np.cross(turning, relative))


def composed(outer: Motion, inner: Motion) -> Motion:
    """The motion of what `inner` moves in a frame that `outer` moves."""
    away, carried = _turned(outer.rotation, inner.position), _turned(outer.rotation, inner.velocity)
    turning = _turned(outer.rotation, inner.turning)
    velocity = outer.velocity + np.cross(outer.turning, away) + carried
    acceleration = outer.acceleration + np.cross(outer.turning_acceleration, away) + np.cross(outer.turning, np.cross(outer.turning, away))
    acceleration += 2.0 * np.cross(outer.turning, carried) + _turned(outer.rotation, inner.acceleration)
    spin = outer.turning_acceleration + _turned(outer.rotation, inner.turning_acceleration) + np.cross(outer.turning, turning)
    return Motion(outer.rotation @ inner.rotation, outer.position + away, velocity, outer.turning + turning, acceleration, spin)


def shifting(shift: np.ndarray, rate: np.ndarray, second: np.ndarray) -> Motion:
    """A motion without rotation: shift [t,3] with its derivatives."""
    rotation, none = np.broadcast_to(np.eye(3), (len(shift), 3, 3)), np.zeros_like(shift)
    return Motion(rotation, shift, rate, none, second, none)


def turning_about(point: np.ndarray, axis: np.ndarray, angle: np.ndarray, rate: np.ndarray, second: np.ndarray) -> Motion:
    """A rotation about lines at rest: through `point` [t,3] (m) along unit vectors `axis` [t,3], by `angle` [t] (rad)."""
    none = np.zeros_like(point)
    about = Motion(_rotation(axis, angle), none, none, rate[:, None] * axis, none, second[:, None] * axis)
    return composed(shifting(point, none, none), composed(about, shifting(-point, none, none)))


def _rotation(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Rotation matrices [t,3,3] about unit vectors [t,3] by angles [t] (Rodrigues)."""
    x, y, z = axis.T
    zero = np.zeros_like(x)
    K = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)
    angle = angle[:, None, None]
    rotation: np.ndarray = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
    return rotation


def _turned(rotation: np.ndarray, vector: np.ndarray) -> np.ndarray:
    turned: np.ndarray = (rotation @ vector[..., None])[..., 0]
    return turned

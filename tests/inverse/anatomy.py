"""The geometry of a yaw-pitch-pitch leg by turning points about its axes: the walker's frames at q = 0 and no line of walkgen's."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from oracles.walker import MIRROR, WalkerLimb

Array = np.ndarray


def turn(axis: Array, angle: Array, vector: Array) -> Array:
    """Rodrigues: rows of vectors turned about a unit axis by rows of angles."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return vector * c + np.cross(axis, vector) * s + axis * (np.sum(vector * axis, axis=-1)[..., None] * (1 - c))


@dataclass(frozen=True)
class Anatomy:
    """A leg at q = 0 as the walker has it: joint axes, a point on each, the foot. Everything else follows by turning these.

    `axes` are positive for growing q; `own` are those of the design, without the user's signs and before any reflection.
    """

    limb: WalkerLimb

    @cached_property
    def _zero(self) -> tuple[Array, Array, Array]:
        flip = MIRROR if self.limb.mirrored else np.eye(4)
        pose, axes, points = self.limb.mount, [], []
        for joint in self.limb.joints:
            place = flip @ pose @ joint.before
            axis = place[:3, :3] @ np.asarray(joint.axis) / np.linalg.norm(joint.axis) * joint.sign
            axes.append(-axis if self.limb.mirrored else axis)
            points.append(place[:3, 3])
            pose = pose @ joint.transform(0.0)
        return np.array(axes), np.array(points), self.limb.position(np.zeros(3))

    @property
    def axes(self) -> Array:
        return self._zero[0]

    @property
    def points(self) -> Array:
        return self._zero[1]

    def foot(self, q: Array) -> Array:
        """[..., 3]"""
        return self._chain(q)[-1]

    def _chain(self, q: Array) -> list[Array]:
        """Points on axes 2 and 3, and the foot, for rows of q."""
        q = np.asarray(q, dtype=float)
        points = [np.broadcast_to(point, q.shape) for point in (*self._zero[1], self._zero[2])]
        for joint in (2, 1, 0):
            axis, pivot = self.axes[joint], self.points[joint]
            points = [pivot + turn(axis, q[..., joint], p - pivot) if index > joint else p for index, p in enumerate(points)]
        return points[1:]

    def jacobian(self, q: Array) -> Array:
        """[..., 3, 3]"""
        hip, knee, foot = self._chain(q)
        second = self.pitch_axis(q)
        third = second * np.sign(self.axes[1] @ self.axes[2])
        first = np.broadcast_to(self.axes[0], foot.shape)
        return np.stack([np.cross(first, foot - self.points[0]), np.cross(second, foot - hip), np.cross(third, foot - knee)], axis=-1)

    def pitch_axis(self, q: Array) -> Array:
        """Direction of axis 2, [..., 3]."""
        q = np.asarray(q, dtype=float)
        return turn(self.axes[0], q[..., 0], np.broadcast_to(self.axes[1], q.shape))

    def sides(self, q: Array) -> tuple[Array, Array]:
        """Where the foot lies along the leg plane, counted from axis 1 (rho), and to which side the shank turns from the thigh (knee)."""
        hip, knee, foot = self._chain(q)
        yaw, pitch = self._design_axes(q)
        rho = np.sum(np.cross(yaw, pitch) * (foot - self.points[0]), axis=-1)
        bend = np.sum(pitch * np.cross(knee - hip, foot - knee), axis=-1)
        return rho, bend

    def _design_axes(self, q: Array) -> tuple[Array, Array]:
        """Axes 1 and 2 as the derivation takes them: a user's signs do not turn them; reflection turns axis 2 round with the knee."""
        user = [joint.sign for joint in self.limb.joints]
        first, second = self.axes[0] * user[0], self.pitch_axis(q) * user[1]
        return (-first if self.limb.mirrored else first), second

    @cached_property
    def lengths(self) -> tuple[float, float, float, float]:
        """a1, thigh, shank, w: the hip's signed distance from axis 1, the bones' lengths across axis 2, the plane's offset."""
        yaw, pitch = self._design_axes(np.zeros(3))
        hip, knee, foot = self._chain(np.zeros(3))
        forward = np.cross(yaw, pitch)
        thigh, shank = (np.linalg.norm(np.cross(pitch, bone)) for bone in (knee - hip, foot - knee))
        return float(forward @ (hip - self.points[0])), float(thigh), float(shank), float(pitch @ (foot - self.points[0]))

    @property
    def reach(self) -> float:
        return float(sum(abs(length) for length in self.lengths))

    def around(self, p: Array) -> tuple[Array, Array]:
        """Distance from axis 1 and height over the hip, of rows of points."""
        hip = self.points[1]
        offset = np.asarray(p) - self.points[0]
        height = np.sum((np.asarray(p) - hip) * self.axes[0], axis=-1)
        across = np.linalg.norm(np.cross(self.axes[0], offset), axis=-1)
        return across, height

    def point(self, across: Array | float, height: Array | float, azimuth: Array | float = 0.7) -> Array:
        """Targets with these distances from axis 1 and heights over the hip, [..., 3]."""
        across, height, azimuth = (value[..., None] for value in np.broadcast_arrays(across, height, azimuth))
        axis = self.axes[0]
        aside = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
        aside /= np.linalg.norm(aside)
        base = self.points[0] + axis * (axis @ (self.points[1] - self.points[0]))
        return base + axis * height + turn(axis, azimuth[..., 0], aside) * across


def turned(q: Array, reference: Array) -> Array:
    """Angles' differences, modulo full turns."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(q) - np.asarray(reference)))))

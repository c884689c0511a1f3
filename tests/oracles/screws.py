"""Legs, arms and routes by turning and sliding points about their axes at q = 0: the walker's frames and no line of walkgen's, on rows."""

from dataclasses import dataclass, replace

import numpy as np

from oracles.walker import MIRROR, Walker, WalkerLimb

Array = np.ndarray


def turn(axis: Array, angle: Array, vector: Array) -> Array:
    """Rodrigues: rows of vectors turned about a unit axis by rows of angles; complex angles too."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return vector * c + np.cross(axis, vector) * s + axis * ((vector @ axis)[..., None] * (1 - c))


@dataclass(frozen=True)
class Screws:
    """Joints at q = 0: unit axes [n,3] positive for growing q, points on them [n,3], which of them turn [n], the foot's pose [4,4]."""

    axes: Array
    points: Array
    turning: Array
    tip: Array

    @property
    def n(self) -> int:
        return len(self.axes)

    @property
    def numbers(self) -> Array:
        """Axis and point a joint, then the foot [6n+3]."""
        return np.concatenate([np.hstack([self.axes, self.points]).ravel(), self.tip[:3, 3]])

    @property
    def sequence(self) -> int:
        """A leading binary 1, then a digit a joint: 0 turns, 1 slides."""
        return int("1" + "".join("01"[not turning] for turning in self.turning), 2)

    @property
    def reach(self) -> float:
        """The way from joint to joint to foot, and the first one's distance from the origin: what rounding goes with, m."""
        way = np.vstack([np.zeros(3), self.points, self.tip[:3, 3]])
        return float(np.sum(np.linalg.norm(np.diff(way, axis=0), axis=1)))

    def _moved(self, joint: int, q: Array, points: Array) -> Array:
        axis, centre = self.axes[joint], self.points[joint]
        return centre + turn(axis, q[..., joint], points - centre) if self.turning[joint] else points + axis * q[..., joint, None]

    def foot(self, q: Array) -> Array:
        """[..., 3]"""
        q = np.asarray(q)
        point = np.broadcast_to(self.tip[:3, 3], (*q.shape[:-1], 3))
        for joint in reversed(range(self.n)):
            point = self._moved(joint, q, point)
        return point

    def pose(self, q: Array) -> Array:
        """[..., 4, 4]"""
        q = np.asarray(q)
        foot = self.foot(q)
        columns = []
        for column in self.tip[:3, :3].T:
            vector = np.broadcast_to(column, (*q.shape[:-1], 3))
            for joint in reversed(range(self.n)):
                vector = turn(self.axes[joint], q[..., joint], vector) if self.turning[joint] else vector
            columns.append(vector)
        T = np.zeros((*q.shape[:-1], 4, 4), foot.dtype)
        T[..., :3, :] = np.stack([*columns, foot], axis=-1)
        T[..., 3, 3] = 1.0
        return T

    def jacobian(self, q: Array) -> Array:
        """Of the foot's position by complex steps, [..., 3, n]."""
        steps = 1e-30j * np.eye(self.n)
        return np.stack([self.foot(q + step).imag / 1e-30 for step in steps], axis=-1)

    def pose_jacobian(self, q: Array) -> Array:
        """Linear and angular, [..., 6, n]."""
        axes, spun = [], np.zeros_like(self.axes)
        for joint in range(self.n):
            vector = np.broadcast_to(self.axes[joint], (*np.shape(q)[:-1], 3))
            for other in reversed(range(joint)):
                vector = turn(self.axes[other], q[..., other], vector) if self.turning[other] else vector
            axes.append(vector if self.turning[joint] else np.broadcast_to(spun[joint], vector.shape))
        return np.concatenate([self.jacobian(q), np.stack(axes, axis=-1)], axis=-2)

    def apart(self, a: Array, b: Array) -> Array:
        """Greatest difference of joint values, turns taken off, [...]."""
        gap = np.asarray(a) - b
        return np.max(np.where(self.turning, np.abs(np.angle(np.exp(1j * gap))), np.abs(gap)), axis=-1)

    def random(self, generator: np.random.Generator, count: int, slide: float = 0.6) -> Array:
        """Poses [count, n]: any angle, slides up to `slide` either way."""
        most = np.where(self.turning, np.pi, slide)
        return generator.uniform(-most, most, (count, self.n))


def screws(limb: WalkerLimb) -> Screws:
    """A limb's joints in its platform's frame."""
    flip = MIRROR if limb.mirrored else np.eye(4)
    pose, axes, points = limb.mount, [], []
    for joint in limb.joints:
        place = flip @ pose @ joint.before
        axis = place[:3, :3] @ np.asarray(joint.axis) / np.linalg.norm(joint.axis) * joint.sign
        axes.append(-axis if limb.mirrored and joint.revolute else axis)
        points.append(place[:3, 3])
        pose = pose @ joint.transform(0.0)
    turning = np.array([joint.revolute for joint in limb.joints])
    return Screws(np.array(axes), np.array(points), turning, limb.pose(np.zeros(len(limb.joints))))


def route(robot: Walker, name: str) -> Screws:
    """Chains and leg from the root platform to a leg's foot; nothing on the way is mirrored but the leg."""
    leg = robot.leg(name)
    base, chains = leg.platform, []
    while base in robot.chains:
        chains.insert(0, robot.chains[base])
        base = robot.chains[base].platform
    parts, pose = [], np.eye(4)
    for limb in (*chains, leg):
        part = screws(limb)
        parts.append(replace(part, axes=part.axes @ pose[:3, :3].T, points=part.points @ pose[:3, :3].T + pose[:3, 3], tip=pose @ part.tip))
        pose = parts[-1].tip
    axes, points, turning = (np.concatenate([getattr(part, name) for part in parts]) for name in ("axes", "points", "turning"))
    return Screws(axes, points, turning, parts[-1].tip)

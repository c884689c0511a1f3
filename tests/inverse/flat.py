"""Flat poses of legs with curved soles, and where they touch level ground: from a spec's text, and no line of walkgen's."""

import tomllib
from dataclasses import dataclass, replace

import numpy as np

from oracles.screws import Array, Screws, screws, turn
from oracles.walker import MIRROR, Reader, WalkerLimb, translation


@dataclass(frozen=True)
class FlatFoot:
    """Hip, knee and ankle as designed, without the reflection of a mirrored leg, which is made at the end.

    `point` is where the flat foot touches the ground, in the foot frame; `down` is a unit vector in the platform's frame.
    """

    path: Screws
    point: Array
    down: Array
    flip: Array

    def random(self, generator: np.random.Generator, count: int) -> Array:
        """Joint values [count, 3]: any hip and knee, the ankle so that the foot is flat."""
        q = generator.uniform(-np.pi, np.pi, (count, 3)) * [1, 1, 0]
        forth, axis = self.path.pose(q)[:, :3, 0], self.path.axes[2]
        q[:, 2] = np.arctan2(np.cross(forth, self.down) @ axis, forth @ self.down)
        return q

    def foot(self, q: Array) -> Array:
        """The point that touches the ground [..., 3]."""
        return (self.path.pose(q) @ [*self.point, 1.0])[..., :3] * self.flip

    def tilt(self, q: Array) -> Array:
        """How far the sole is from flat [...]."""
        return np.linalg.norm(self.path.pose(q)[..., :3, 0] - self.down, axis=-1)

    def ahead(self, q: Array) -> Array:
        """Positive where the knee is in front of a standing leg, so that it is on the left of the way from hip to ankle [...]."""
        path, forward = self.path, np.cross(self.path.tip[:3, 2], self.down)
        knee, ankle = turn(path.axes[0], q[..., 0], path.points[1] - path.points[0]), self._ankle.foot(q[..., :2]) - path.points[0]
        return (knee @ forward) * (ankle @ self.down) - (ankle @ forward) * (knee @ self.down)

    @property
    def reach(self) -> float:
        """Of the ankle."""
        return self._ankle.reach

    def least(self, q: Array) -> Array:
        """The lesser singular value of hip and knee, which place the ankle [...]."""
        return np.linalg.svd(self._ankle.jacobian(q[..., :2]), compute_uv=False)[..., 1]

    @property
    def _ankle(self) -> Screws:
        path = self.path
        return Screws(path.axes[:2], path.points[:2], path.turning[:2], translation(path.points[2]))


def flat_foot(text: str, limb: WalkerLimb) -> FlatFoot:
    """A leg of a spec: its point lies below the ankle, or at the nearer edge of the flat part."""
    table = tomllib.loads(text)
    reader, path = Reader(table, {}), screws(replace(limb, mirrored=False))
    (design,) = table["leg_designs"].values()
    sole = design["curved_sole"]
    ankle = np.linalg.solve(path.tip, [*path.points[2], 1.0])
    point = np.array([reader.scalar(sole, "depth"), np.clip(ankle[1], *reader.vector(sole, "flat", 2)), 0.0])
    flip = np.diag(MIRROR)[:3] if limb.mirrored else np.ones(3)
    gravity = np.array(table["robot"]["gravity"]) * flip
    return FlatFoot(path, point, gravity / np.linalg.norm(gravity), flip)

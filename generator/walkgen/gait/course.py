"""The course of the first platform over the ground: as high and as inclined as the ground under its feet, at the gait's pace."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from walkgen.gait.ground import Ground
from walkgen.gait.motion import Motion
from walkgen.gait.spline import Spline

_KNOTS_PER_STRIDE = 8
_FITS = 8
_SETTLED = 1e-15
"""m, rad; nothing moves by more any longer."""
_AHEAD = 4
"""Strides that the course reaches beyond both ends, where footholds of the first and last supports are looked for."""


class Progress(NamedTuple):
    """How far along the course [t] (m), with its rate and acceleration."""

    distance: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray


@dataclass(frozen=True)
class Pace:
    """Steady at `speed` (m/s), or from rest to rest: `ramp` (s) at either end of `duration` (s), in which the speed follows a quintic."""

    speed: float
    duration: float
    ramp: float = 0.0

    def at(self, t: np.ndarray) -> Progress:
        """At times t [...] (s); continuous up to the acceleration, and at rest before the start and after the end where there is a ramp."""
        t = np.asarray(t, float)
        if not self.ramp:
            return Progress(self.speed * t, np.full(t.shape, self.speed), np.zeros(t.shape))
        begun, ended = self._rise(t), self._rise(t - (self.duration - self.ramp))
        return Progress(*(self.speed * (one - other) for one, other in zip(begun, ended, strict=True)))

    def _rise(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of a speed that rises from 0 to 1 within the ramp: distance, speed, acceleration."""
        u = np.clip(t / self.ramp, 0.0, 1.0)
        distance = self.ramp * u**4 * (2.5 - 3.0 * u + u**2) + np.maximum(t - self.ramp, 0.0)
        return distance, u**3 * (10.0 - 15.0 * u + 6.0 * u**2), 30.0 * (u * (1.0 - u)) ** 2 / self.ramp


@dataclass(frozen=True)
class Course:
    """A path with distance along it: straight ahead in the plan, height and inclination from the ground, smooth to the second derivative.

    `spline` gives x, y, z (m), roll and pitch (rad) by the distance; the yaw is `heading`.
    """

    spline: Spline
    heading: float

    def at(self, progress: Progress) -> Motion:
        """The platform's motion [t,...]."""
        value, slope, bend = self.spline.at(progress.distance)
        rate = slope * progress.speed[:, None]
        second = bend * progress.speed[:, None] ** 2 + slope * progress.acceleration[:, None]
        rotation, turning, spin = _inclined(self.heading, value[:, 3:], rate[:, 3:], second[:, 3:])
        return Motion(rotation, value[:, :3], rate[:, :3], turning, second[:, :3], spin)


def course(ground: Ground, stance: np.ndarray, stride: float, length: float, heading: float = 0.0) -> Course:
    """The course over a ground, from the origin.

    Args:
        ground: where it goes.
        stance: the feet in the middle of their support [k,3], in the platform's frame (m); the plane nearest to them stands on the ground.
        stride: m.
        length: m.
        heading: yaw (rad).
    """
    spacing = (abs(stride) or 1.0) / _KNOTS_PER_STRIDE
    back = _AHEAD * _KNOTS_PER_STRIDE
    ends = math.ceil(abs(length) / spacing) + back
    stance = _widened(stance, 0.25 * (abs(stride) or 1.0))
    knots = spacing * np.arange(-ends if length < 0 else -back, (back if length < 0 else ends) + 1)
    return Course(Spline(float(knots[0]), spacing, _settled(ground, stance, knots, heading)), heading)


def _widened(stance: np.ndarray, reach: float) -> np.ndarray:
    """Feet abreast say nothing of how the ground rises ahead: what is before and behind them does."""
    if np.ptp(stance[:, 0]) > _SETTLED:
        return stance
    ahead = np.array([reach, 0.0, 0.0])
    return np.concatenate([stance + ahead, stance - ahead])


def _settled(ground: Ground, stance: np.ndarray, knots: np.ndarray, heading: float) -> np.ndarray:
    """x, y, z, roll, pitch [m,5] at distances [m] with the feet's plane on the ground's.

    Repeated, since the feet move as the platform inclines.
    """
    poses, tilt = np.zeros((len(knots), 5)), _upright(_plane(stance[None]), 0.0)[0]
    low = _plane(stance[None])[0, 2]
    for _ in range(_FITS):
        before = poses.copy()
        ahead = _along(np.cos(poses[:, 4]), knots)
        poses[:, 0], poses[:, 1] = ahead * math.cos(heading), ahead * math.sin(heading)
        points = _feet(poses, stance, heading)
        points[..., 2] = ground.height(points[..., 0], points[..., 1])
        known = np.isfinite(points).all(axis=(1, 2))
        plane = _plane(points[known])
        rotation = _upright(plane, heading) @ tilt.T
        carried = low * rotation[:, :, 2]
        poses[known, 2] = plane[:, 2] + ((poses[known, :2] + carried[:, :2]) * plane[:, :2]).sum(axis=1) - carried[:, 2]
        poses[known, 3:] = _angles(rotation, heading)
        _continued(poses, known, knots)
        if np.abs(poses - before).max() < _SETTLED:
            break
    return poses


def _along(share: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """The plan's distance from the origin, of which a length makes the share [m] at every knot."""
    steps = 0.5 * (share[1:] + share[:-1]) * np.diff(knots)
    covered: np.ndarray = np.concatenate([[0.0], np.cumsum(steps)])
    covered -= np.interp(0.0, knots, covered)
    return covered


def _feet(poses: np.ndarray, stance: np.ndarray, heading: float) -> np.ndarray:
    none = np.zeros((len(poses), 2))
    points: np.ndarray = stance @ _inclined(heading, poses[:, 3:], none, none)[0].transpose(0, 2, 1)
    points[..., :2] += poses[:, None, :2]
    return points


def _continued(poses: np.ndarray, known: np.ndarray, knots: np.ndarray) -> None:
    """Where a foot has no ground the platform goes on as at the nearest knot that has: the foothold will say so."""
    if known.all() or not known.any():
        return
    there = np.flatnonzero(known)
    nearest = there[np.abs(knots[:, None] - knots[there]).argmin(axis=1)]
    poses[:, 2] = poses[nearest, 2] - np.sin(poses[nearest, 4]) * (knots - knots[nearest])
    poses[:, 3:] = poses[nearest, 3:]


def _plane(points: np.ndarray) -> np.ndarray:
    """a, b, c [m,3] of the planes z = a x + b y + c nearest to points [m,k,3] along z; level across where they stand on a line."""
    rows = np.concatenate([points[..., :2], np.ones_like(points[..., :1])], axis=-1)
    middle = rows.mean(axis=1, keepdims=True) * [1.0, 1.0, 0.0]
    a, b, c = (np.linalg.pinv(rows - middle, rcond=1e-9) @ points[..., 2:])[..., 0].T
    return np.stack([a, b, c - a * middle[:, 0, 0] - b * middle[:, 0, 1]], axis=-1)


def _upright(plane: np.ndarray, heading: float) -> np.ndarray:
    """Frames [m,3,3] with z normal to the planes and x in them, over the heading."""
    normal = np.stack([-plane[:, 0], -plane[:, 1], np.ones(len(plane))], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    c, s = math.cos(heading), math.sin(heading)
    rise = c * plane[:, 0] + s * plane[:, 1]
    along = np.stack([np.full_like(rise, c), np.full_like(rise, s), rise], axis=-1) / np.hypot(1.0, rise)[:, None]
    return np.stack([along, np.cross(normal, along), normal], axis=-1)


def _angles(rotation: np.ndarray, heading: float) -> np.ndarray:
    """Roll and pitch [m,2] of rotations whose yaw is the heading."""
    c, s = math.cos(heading), math.sin(heading)
    turned = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ rotation
    high = np.hypot(turned[:, 2, 1], turned[:, 2, 2])
    return np.stack([np.arctan2(turned[:, 2, 1], turned[:, 2, 2]), np.arctan2(-turned[:, 2, 0], high)], axis=-1)


def _inclined(heading: float, angles: np.ndarray, rate: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rz(heading) Ry(pitch) Rx(roll), its angular velocity and acceleration in the world; angles [t,2] are roll and pitch."""
    (cr, cp), (sr, sp) = np.cos(angles).T, np.sin(angles).T
    zero = np.zeros_like(cr)
    inclined = np.stack([cp, sp * sr, sp * cr, zero, cr, -sr, -sp, cp * sr, cp * cr], axis=-1).reshape(-1, 3, 3)
    rolling = np.stack([cp, zero, -sp], axis=-1)
    pitching = np.array([0.0, 1.0, 0.0])
    turning = rolling * rate[:, :1] + pitching * rate[:, 1:]
    crossing = np.stack([-sp, zero, -cp], axis=-1) * (rate[:, :1] * rate[:, 1:])
    spin = rolling * second[:, :1] + pitching * second[:, 1:] + crossing
    c, s = math.cos(heading), math.sin(heading)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return turn @ inclined, turning @ turn.T, spin @ turn.T

"""Where a yaw-pitch-pitch leg comes closest to a foot target out of its reach: the reference of walkgen_inverse.h."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Truths = NDArray[np.bool_]
Integers = NDArray[np.int32]

_UNREACHABLE = STATUSES.index("UNREACHABLE")
_SIGNS = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])  # (rho, knee) of the branches
_FARTHEST = 60  # binary exponent, leg of size 1, beyond which only a target's direction counts
_STEPS = 128


@dataclass(frozen=True)
class _Sheet:
    """Legs and targets mirrored to rho >= 0 and height >= 0, scaled to size about 1; arrays of one shape.

    The hip is at (centre, 0); the stretched and the folded leg reach `outer` and `inner` from it. `w` is the offset of the
    leg plane from axis 1, `radius` and `height` the target's distance from axis 1 and height.
    """

    centre: Reals
    outer: Reals
    inner: Reals
    w: Reals
    radius: Reals
    height: Reals


@dataclass(frozen=True)
class _Point:
    """Feet in the leg plane, and seen from the hip: distance `extent` in direction (cosine, sine), not normalised."""

    rho: Reals
    height: Reals
    extent: Reals
    cosine: Reals
    sine: Reals


def any_unreachable(status: ArrayLike) -> Truths:
    """Whether one of the statuses along the last axis is UNREACHABLE."""
    return np.asarray(np.any(np.asarray(status) == _UNREACHABLE, axis=-1))


def closest_yaw_pitch_pitch(geometry: ArrayLike, target: ArrayLike, q: ArrayLike, status: ArrayLike) -> tuple[Reals, Integers]:
    """Rows of q whose status is UNREACHABLE, replaced by the joint values that bring the foot closest on their sheet.

    Args:
        geometry: a1, a2, l3, w (m), then sign and zero (rad) of the three joints [..., 10].
        target: the foot's target in the leg's canonical frame [..., 3], m.
        q: joint values of the four branches [..., 4, 3], rad.
        status: their statuses [..., 4].

    Returns:
        q [..., 4, 3] with angles of the replaced rows in (-pi, pi], and status [..., 4] as it was.
    """
    rows = np.expand_dims(np.asarray(geometry, float), -2), np.expand_dims(np.asarray(target, float), -2)
    return _replaced(*rows, _SIGNS, np.asarray(q, float), np.asarray(status, np.int32))


def closest_yaw_pitch_pitch_branch(
    geometry: ArrayLike, target: ArrayLike, branch: ArrayLike, q: ArrayLike, status: ArrayLike
) -> tuple[Reals, Integers]:
    """The same for one branch: `branch` [...] in 0..3 (others leave q alone), q [..., 3], status [...]."""
    chosen = np.asarray(branch)
    known = (chosen >= 0) & (chosen <= len(_SIGNS) - 1)
    signs = _SIGNS[np.where(known, chosen, 0)]
    asked, kept = np.broadcast_arrays(np.asarray(status, np.int32), known)
    values, _ = _replaced(np.asarray(geometry, float), np.asarray(target, float), signs, np.asarray(q, float), np.where(kept, asked, 0))
    return values, np.array(np.broadcast_to(asked, values.shape[:-1]))


def _replaced(geometry: Reals, target: Reals, signs: Reals, q: Reals, status: Integers) -> tuple[Reals, Integers]:
    """Q with its unreachable rows replaced; all arguments have one item a row."""
    shape = np.broadcast_shapes(geometry.shape[:-1], target.shape[:-1], signs.shape[:-1], q.shape[:-1], status.shape)
    states = np.array(np.broadcast_to(status, shape), np.int32)
    values = np.array(np.broadcast_to(q, (*shape, 3)))
    rows = states == _UNREACHABLE
    legs, targets, branches = (np.broadcast_to(item, (*shape, item.shape[-1]))[rows] for item in (geometry, target, signs))
    values[rows] = _closest_joints(legs, targets, branches[:, 0], branches[:, 1])
    return values, states


def _closest_joints(geometry: Reals, target: Reals, sigma: Reals, knee_sign: Reals) -> Reals:
    """Joint values [m, 3] of the closest feet on the sheets of sign `sigma`, or on the other one where that is empty."""
    leg, foot = _scaled(geometry, target)
    a1, a2, l3, w = leg.T
    sigma = np.where(sigma * a1 + (a2 + l3) < 0.0, -sigma, sigma)
    offset = np.where(np.abs(w) < np.finfo(float).eps, 0.0, np.abs(w))  # less could not be told from the shoulder's rounding
    sheet = _Sheet(sigma * a1, a2 + l3, np.abs(a2 - l3), offset, np.hypot(foot[:, 0], foot[:, 1]), np.abs(foot[:, 2]))
    point = _closest(sheet)
    yaw = np.arctan2(target[:, 1], target[:, 0]) - np.arctan2(-w, sigma * point.rho)
    free = ((target[:, 0] == 0.0) & (target[:, 1] == 0.0)) | (point.rho + sheet.w <= 0.0)
    bent = np.sqrt(np.maximum((sheet.outer - point.extent) * (sheet.outer + point.extent), 0.0))
    straight = np.sqrt(np.maximum((point.extent - sheet.inner) * (point.extent + sheet.inner), 0.0))
    knee = knee_sign * 2.0 * np.arctan2(bent, straight)
    thigh = np.arctan2(np.where(target[:, 2] < 0.0, -point.sine, point.sine), sigma * point.cosine)
    thigh = thigh - np.arctan2(l3 * np.sin(knee), a2 + l3 * np.cos(knee))
    angles = np.stack([yaw, thigh, knee], axis=-1)
    joints = geometry[:, 4::2] * (angles - geometry[:, 5::2])
    loose = np.stack([free, point.extent <= 0.0, np.zeros_like(free)], axis=-1)
    return np.where(loose, 0.0, _wrapped(joints))


def _wrapped(angles: Reals) -> Reals:
    """The angles less full turns, in (-pi, pi], roundings included."""
    wrapped = angles - 2.0 * np.pi * np.ceil(angles / (2.0 * np.pi) - 0.5)
    return np.where(wrapped > np.pi, wrapped - 2.0 * np.pi, np.where(wrapped <= -np.pi, np.pi, wrapped))


def _scaled(geometry: Reals, target: Reals) -> tuple[Reals, Reals]:
    """Lengths [m, 4] and targets [m, 3] scaled by powers of 2: legs to size about 1, very far targets nearer."""
    _, size = np.frexp(np.max(np.abs(geometry[:, :4]), axis=-1, initial=0.0))
    _, distance = np.frexp(np.max(np.abs(target), axis=-1, initial=0.0))
    nearer = np.maximum(distance - size - _FARTHEST, 0)
    return np.ldexp(geometry[:, :4], -size[:, None]), np.ldexp(target, -(size + nearer)[:, None])


def _closest(sheet: _Sheet) -> _Point:
    """The points of the sheets closest to the targets: the target, the shoulder beside it, or a point of a circle."""
    rho = np.sqrt(np.maximum((sheet.radius - sheet.w) * (sheet.radius + sheet.w), 0.0))
    extent = np.hypot(rho - sheet.centre, sheet.height)
    inside = (extent >= sheet.inner) & (extent <= sheet.outer)
    best = _Point(rho, sheet.height, extent, rho - sheet.centre, sheet.height)
    outer, _ = _circle(sheet, sheet.outer)
    inner, exists = _circle(sheet, sheet.inner)
    circles = _chosen(exists & _closer(sheet, inner, outer), inner, outer)
    return _chosen(inside, best, circles)


def _circle(sheet: _Sheet, r: Reals) -> tuple[_Point, Truths]:
    """The closest points of the circles of radius r about the hip with rho >= 0, and whether there is one."""
    cut = np.abs(sheet.centre) < r
    end = np.arccos(np.clip(np.where(cut, -sheet.centre / np.where(cut, r, 1.0), np.where(sheet.centre < 0.0, 1.0, -1.0)), -1.0, 1.0))
    first, second = _turns(sheet, r, end)
    near = _on_circle(sheet, r, _minimum(sheet, r, np.zeros_like(r), first), end)
    wide = _on_circle(sheet, r, _minimum(sheet, r, second, end), end)
    return _chosen(_closer(sheet, wide, near), wide, near), sheet.centre >= -r


def _turns(sheet: _Sheet, r: Reals, end: Reals) -> tuple[Reals, Reals]:
    """Where K of walkgen_inverse.h turns: it rises with the angle up to the first and from the second, and falls between."""
    a = np.cbrt(sheet.height) ** 2
    b = np.cbrt(sheet.radius * r) ** 2 * np.cbrt(sheet.w) ** 4
    leading = b + a * r**2
    discriminant = b**2 + a * b * (r**2 - sheet.centre**2 - sheet.w**2) - (a * r * sheet.w) ** 2
    turning = (discriminant > 0.0) & (leading > 0.0)
    divisor = np.where(turning, leading, 1.0)
    middle, half = -a * sheet.centre * r / divisor, np.sqrt(np.where(turning, discriminant, 0.0)) / divisor
    right, left = (np.arccos(np.clip(root, -1.0, 1.0)) for root in (middle + half, middle - half))
    return np.where(turning, np.minimum(right, end), end), np.where(turning, np.minimum(left, end), end)


def _slope(sheet: _Sheet, r: Reals, angle: Reals) -> tuple[Reals, Reals]:
    """Half the derivative of the squared distance to the angle, over r, and its own derivative."""
    cosine, sine = np.cos(angle), np.sin(angle)
    rho = np.maximum(sheet.centre + r * cosine, 0.0)
    arm = np.hypot(rho, sheet.w)
    divisor = np.where(arm > 0.0, arm, 1.0)
    share = np.where(arm > 0.0, sheet.w / divisor, 0.0)
    pull = sheet.radius * np.where(arm > 0.0, rho / divisor, 1.0) - sheet.centre
    derivative = pull * cosine + sheet.height * sine - sheet.radius * share**2 / divisor * r * sine**2
    return pull * sine - sheet.height * cosine, derivative


def _minimum(sheet: _Sheet, r: Reals, low: Reals, high: Reals) -> Reals:
    """The angles in [low, high] of least distance, by Newton steps that a bracket guards; at most one sign change of the slope."""
    at_high, at_low = _slope(sheet, r, high)[0] <= 0.0, _slope(sheet, r, low)[0] >= 0.0
    fixed = np.where(at_high, high, low)
    angle = np.arctan2(sheet.height, sheet.radius - sheet.centre)
    angle = np.where((angle > low) & (angle < high), angle, low + 0.5 * (high - low))
    last = before = high - low
    moving: Truths = ~(at_high | at_low)
    for _ in range(_STEPS):
        if not moving.any():
            break
        slope, derivative = _slope(sheet, r, angle)
        low, high = np.where(slope < 0.0, angle, low), np.where(slope < 0.0, high, angle)
        step = slope / np.where(derivative == 0.0, np.finfo(float).tiny, derivative)
        newton = angle - step
        safe = (newton > low) & (newton < high) & (2.0 * np.abs(step) < before)
        following = np.where(safe, newton, np.where(slope == 0.0, angle, low + 0.5 * (high - low)))
        before, last = last, np.abs(following - angle)
        angle = np.where(moving, following, angle)
        moving = moving & (last > 0.5 * np.finfo(float).eps * angle)
    return np.where(at_high | at_low, fixed, angle)


def _on_circle(sheet: _Sheet, r: Reals, angle: Reals, end: Reals) -> _Point:
    cosine, sine = np.cos(angle), np.sin(angle)
    shoulder = (sheet.centre < r) & (angle >= end)
    return _Point(np.where(shoulder, 0.0, np.maximum(sheet.centre + r * cosine, 0.0)), r * sine, r, cosine, sine)


def _closer(sheet: _Sheet, a: _Point, b: _Point) -> Truths:
    """Whether a is closer to the target than b: a difference of squares, exact for near and for far targets."""
    arm_a, arm_b = np.hypot(a.rho, sheet.w), np.hypot(b.rho, sheet.w)
    across = (arm_a - arm_b) * ((arm_a - sheet.radius) + (arm_b - sheet.radius))
    along = (a.height - b.height) * ((a.height - sheet.height) + (b.height - sheet.height))
    return np.asarray(across + along < 0.0)


def _chosen(truth: Truths, a: _Point, b: _Point) -> _Point:
    """A where the truth holds, b elsewhere."""
    fields: list[tuple[Any, Any]] = [(a.rho, b.rho), (a.height, b.height), (a.extent, b.extent), (a.cosine, b.cosine), (a.sine, b.sine)]
    return _Point(*(np.where(truth, left, right) for left, right in fields))

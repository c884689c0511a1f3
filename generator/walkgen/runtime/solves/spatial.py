"""Vectors, and a foot moved by up to three joints given by their axes: what the general inverse iterates on; see walkgen_spatial.h."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]
Truths = NDArray[np.bool_]

_ITERATIONS = 60
_ROUNDOFF = float(2.0 * np.finfo(float).eps)


@dataclass(frozen=True)
class Chain:
    """Joints at q = 0, base to foot: unit `axes` [..., n, 3] through `points` [..., n, 3], and the `foot` [..., 3].

    `kinds` has a letter for every joint: R turns about its axis, P moves along it. Of three joints a function may have the foot instead,
    as `motion` gives it.
    """

    kinds: str
    axes: Reals
    points: Reals
    foot: Reals
    driven: "Callable[[Reals], tuple[Reals, Reals, Reals]] | None" = None

    def reversed(self, target: Reals) -> "Chain":
        """The chain that leads the target back to the foot by the same joint values, last joint first."""
        return Chain(self.kinds[::-1], -self.axes[..., ::-1, :], self.points[..., ::-1, :], target)

    def take(self, rows: NDArray[np.intp]) -> "Chain":
        """Some rows."""
        return Chain(self.kinds, self.axes[rows], self.points[rows], self.foot[rows])


def dot(a: Reals, b: Reals) -> Reals:
    """Over the last axis."""
    return np.asarray(np.sum(a * b, axis=-1))


def norm(a: Reals) -> Reals:
    """Over the last axis."""
    return np.asarray(np.sqrt(dot(a, a)))


def turned(axis: Reals, angle: Reals, vector: Reals) -> Reals:
    """Rodrigues: the vectors turned about unit axes."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return np.asarray(c * vector + s * np.cross(axis, vector) + (1.0 - c) * dot(axis, vector)[..., None] * axis)


def angle_about(axis: Reals, start: Reals, end: Reals) -> Reals:
    """The angle about a unit axis from one vector to another, 0 where one of them is along it."""
    sine = dot(axis, np.cross(start, end))
    cosine = dot(start, end) - dot(axis, start) * dot(axis, end)
    return np.arctan2(sine, cosine)


def across(axis: Reals) -> tuple[Reals, Reals]:
    """Two unit vectors across unit axes, right-handed with them."""
    least = np.argmin(np.abs(axis), axis=-1)
    first = np.cross(axis, np.eye(3)[least])
    first = first / norm(first)[..., None]
    return first, np.cross(axis, first)


def moved(chain: Chain, joint: int, q: Reals, point: Reals) -> Reals:
    """Where a joint takes a point."""
    axis, centre = chain.axes[..., joint, :], chain.points[..., joint, :]
    if chain.kinds[joint] == "P":
        return np.asarray(point + q[..., None] * axis)
    return np.asarray(centre + turned(axis, q, point - centre))


def foot_of(chain: Chain, q: Reals) -> Reals:
    """The foot at q [..., n]."""
    if chain.driven is not None:
        return chain.driven(q)[0]
    point = chain.foot
    for joint in range(len(chain.kinds) - 1, -1, -1):
        point = moved(chain, joint, q[..., joint], point)
    return point


def motion(chain: Chain, q: Reals) -> tuple[Reals, Reals, Reals]:
    """The foot [..., 3], its Jacobian [..., 3, n] and its second derivatives [..., 3, n, n] at q."""
    if chain.driven is not None:
        return chain.driven(q)
    n = len(chain.kinds)
    foot = chain.foot
    directions: list[Reals] = []
    columns: list[Reals] = []
    for joint in range(n - 1, -1, -1):  # everything so far moves with this joint
        axis, value = chain.axes[..., joint, :], q[..., joint]
        foot = moved(chain, joint, value, foot)
        if chain.kinds[joint] == "R":
            directions = [turned(axis, value, direction) for direction in directions]
            columns = [turned(axis, value, column) for column in columns]
        directions.insert(0, np.broadcast_to(axis, foot.shape))
        arm = foot - chain.points[..., joint, :]
        columns.insert(0, np.asarray(np.cross(axis, arm)) if chain.kinds[joint] == "R" else directions[0])
    second = np.zeros((*foot.shape, n, n))
    for i in range(n):
        for j in range(i, n):
            if chain.kinds[i] == "R":
                second[..., i, j] = second[..., j, i] = np.cross(directions[i], columns[j])
    return foot, np.stack(columns, axis=-1), second


def nearest(chain: Chain, target: Reals, q: Reals, fixed: int = -1) -> tuple[Reals, Reals]:
    """q brought to a local minimum of the foot's distance to the target, and that distance.

    Newton on the equations while that helps, then on half the squared distance with the eigenvalues of its matrix made positive, damped as
    far as the distance needs it to fall. `fixed` is a joint that stays, -1 for none; 3 for none too, but q does not leave its
    neighbourhood by Newton's long steps.
    """
    n = len(chain.kinds)
    if n == 3 and fixed < 0:
        q = _sharpened(chain, target, q)
    held = np.arange(n) == fixed
    foot, jacobian, second = motion(chain, q)
    away = foot - target
    damping = np.zeros(away.shape[:-1])
    active = np.ones(away.shape[:-1], bool)
    for _ in range(_ITERATIONS):
        gauss = np.einsum("...ki,...kj->...ij", jacobian, jacobian)
        curved = gauss + np.einsum("...k,...kij->...ij", away, second)
        gradient = np.einsum("...ki,...k->...i", jacobian, away)
        step = _step(curved, gradient, damping, held)
        after, jacobian_after, second_after = motion(chain, q - step)
        better = (norm(after - target) < norm(away)) & active
        q = np.where(better[..., None], q - step, q)
        away = np.where(better[..., None], after - target, away)
        jacobian = np.where(better[..., None, None], jacobian_after, jacobian)
        second = np.where(better[..., None, None, None], second_after, second)
        trace = np.trace(gauss, axis1=-2, axis2=-1)
        damping = np.where(better, np.where(damping < 1e-5 * trace, 0.0, 0.01 * damping), np.maximum(100.0 * damping, 1e-6 * trace))
        active = active & (norm(away) > _ROUNDOFF) & (better | ((np.max(np.abs(step), axis=-1) > _ROUNDOFF) & (damping < 1e6 * trace)))
        if not active.any():
            break
    return q, norm(away)


def _sharpened(chain: Chain, target: Reals, q: Reals) -> Reals:
    """Up to five steps of Newton on the foot's position, each only if it brings the foot nearer."""
    for _ in range(5):
        foot, jacobian, _ = motion(chain, q)
        a, b, c = np.moveaxis(jacobian, -1, 0)
        minors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-2)
        determinant = dot(a, minors[..., 0, :])[..., None]
        regular = np.abs(determinant) > 1e-300
        step = np.where(regular, np.einsum("...ij,...j->...i", minors, foot - target) / np.where(regular, determinant, 1.0), 0.0)
        better = norm(foot_of(chain, q - step) - target) < norm(foot - target)
        if not better.any():
            break
        q = np.where(better[..., None], q - step, q)
    return q


def _step(matrix: Reals, gradient: Reals, damping: Reals, held: Truths) -> Reals:
    """(matrix + shift)^-1 gradient with a shift that makes it positive, and the damping."""
    free = ~held
    matrix = np.where(free[:, None] & free, matrix, np.where(held[:, None] & held & np.eye(len(held), dtype=bool), 1.0, 0.0))
    values, vectors = np.linalg.eigh(matrix)
    floor = 1e-14 * np.max(np.abs(values), axis=-1, keepdims=True)
    divisor = np.maximum(np.abs(values), floor) + damping[..., None]
    along = np.einsum("...ji,...j->...i", vectors, np.where(held, 0.0, gradient))
    step = np.einsum("...ij,...j->...i", vectors, along / np.where(divisor > 0.0, divisor, 1.0))
    longest = np.max(np.abs(step), axis=-1, keepdims=True)
    return np.asarray(step * np.minimum(1.0, 1.0 / np.maximum(longest, 1e-300)))

"""All joint values that reach a target, by Newton from a grid of starts: what closed forms are compared with."""

from itertools import product

import numpy as np

from oracles.screws import Screws

Array = np.ndarray
_ANGLES, _SLIDES = np.linspace(-np.pi, np.pi, 10, endpoint=False) + 0.123, np.linspace(-1.2, 1.2, 7) + 0.05
_STEPS = 30


def multistart(path: Screws, p: Array) -> tuple[Array, Array]:
    """Joint values [starts, targets, n] where Newton ended, and how far the foot is from the targets [starts, targets].

    Starts are a grid over all joints but the first, which begins where it brings the foot nearest.
    """
    rest = np.array(list(product(*(_ANGLES if turning else _SLIDES for turning in path.turning[1:]))))
    q = np.zeros((len(rest), len(p), path.n))
    q[..., 1:] = rest[:, None]
    q[..., 0] = _aligned(path, q, p)
    for _ in range(_STEPS):
        step = _newton(path.jacobian(q), path.foot(q) - p)
        q = q - step * np.minimum(1.0, 0.5 / (np.max(np.abs(step), axis=-1, keepdims=True) + 1e-300))
    return q, np.linalg.norm(path.foot(q) - p, axis=-1)


def _aligned(path: Screws, q: Array, p: Array) -> Array:
    """The first joint's value that brings the foot nearest to its target."""
    axis, centre = path.axes[0], path.points[0]
    foot, away = path.foot(q) - centre, p - centre
    if not path.turning[0]:
        return (away - foot) @ axis
    quarter = np.cross(axis, foot)
    return np.arctan2(np.sum(quarter * away, axis=-1), np.sum(foot * away, axis=-1) - (foot @ axis) * (away @ axis))


def _newton(J: Array, gap: Array) -> Array:
    """J^+ gap for one to three columns, by the normal equations of fewer than three and the adjugate of three."""
    if J.shape[-1] < 3:
        return np.einsum("...ij,...j->...i", np.linalg.pinv(J, rcond=1e-12), gap)
    a, b, c = np.moveaxis(J, -1, 0)
    minors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-2)
    determinant = np.sum(a * minors[..., 0, :], axis=-1, keepdims=True)
    damped = determinant + np.copysign(1e-12, determinant)  # steps stay finite at singular poses
    return np.einsum("...ij,...j->...i", minors, gap) / damped

"""The theory's two springs of one link (7.2, 7.4) searched another way: differential evolution over the springs' shapes alone.

A spring's moment is linear in c = initial tension - stiffness free length, so that for given levers, anchors and angles the best pair of
c within what tensions, free lengths and stretch allow is a convex problem of two unknowns, solved exactly.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import differential_evolution

G, STIFFNESS, LOAD, ARM = 9.80665, 9000.0, 60.0, 0.40
SUPPORT, TRANSFER = np.deg2rad([-50, -10]), np.deg2rad([30, 60])
NODES = 12
_STRETCH = (1.02, 1.9)


def gauss(span, nodes=NODES):
    x, weight = np.polynomial.legendre.leggauss(nodes)
    return span.mean() + np.ptp(span) / 2 * x, weight / 2


def even(points):
    """Places at which lengths are limited, with both ends of each range."""
    return np.concatenate([np.linspace(*SUPPORT, points), np.linspace(*TRANSFER, points)])


def at_nodes(nodes):
    """The same without the ends: Gauss nodes alone."""
    return np.concatenate([gauss(span, nodes)[0] for span in (SUPPORT, TRANSFER)])


@dataclass(frozen=True)
class Reduced:
    """Bounds of lever and anchor, of tension and of free length; where lengths are limited."""

    lever: tuple[float, float]
    anchor: tuple[float, float]
    tension: tuple[float, float]
    free: tuple[float, float]
    limited: np.ndarray

    def best(self, seeds):
        """Root of the sum of both ranges' mean squares (N m), and the shapes (lever, anchor, angle) of both springs."""
        bounds = [self.lever, self.anchor, (-np.pi, np.pi)] * 2
        more = {"maxiter": 300, "tol": 1e-12, "vectorized": True, "updating": "deferred", "polish": False}
        answers = [differential_evolution(self.costs, bounds, rng=seed, mutation=(0.4, 0.9), recombination=0.9, **more) for seed in seeds]
        least = min(answers, key=lambda answer: answer.fun)
        return float(np.sqrt(least.fun)), least.x

    def costs(self, shapes):
        """Mean squares of many shapes [6, n]; a million and more where no free length suits the stretch."""
        lever, anchor, angle = (shapes.reshape(2, 3, -1)[:, row, :, None] for row in range(3))
        lengths = _lengths(lever, anchor, angle, self.limited)
        shortest = np.maximum(lengths.max(-1) / _STRETCH[1], self.free[0])
        longest = np.minimum(lengths.min(-1) / _STRETCH[0], self.free[1])
        gap = np.maximum(shortest - longest, 0.0).sum(0)
        low = self.tension[0] - STIFFNESS * np.maximum(longest, shortest)
        return np.where(gap > 0, 1e6 * (1 + gap), _least(*_linear(lever, anchor, angle), low, self.tension[1] - STIFFNESS * shortest))


def _lengths(lever, anchor, angle, phi):
    return np.sqrt(lever**2 + anchor**2 - 2 * lever * anchor * np.cos(angle - phi))


def _linear(lever, anchor, angle):
    """Moments without c, and per c of each spring, with the root of the weights [n, m] and [2, n, m]."""
    (first, one), (second, other) = gauss(SUPPORT), gauss(TRANSFER)
    phi, root = np.concatenate([first, second]), np.sqrt(np.concatenate([one, other]))
    load = np.where(phi < 0.3, LOAD, 0.0)
    sine, product = np.sin(angle - phi), lever * anchor
    known = G * (load * ARM - 4.0 * 0.18) * np.cos(phi) + (product * STIFFNESS * sine - 0.3 * G * lever * np.cos(phi)).sum(0)
    return known * root, product * sine / _lengths(lever, anchor, angle, phi) * root


def _least(known, slopes, low, high):
    """Of |known + slopes c|^2 with low <= c <= high [2, n]: inside, or on one of the four edges."""
    (a, c), b = (slopes**2).sum(-1), (slopes[0] * slopes[1]).sum(-1)
    u, v = -(slopes * known).sum(-1)

    def at(first, second):
        return ((known + first[:, None] * slopes[0] + second[:, None] * slopes[1]) ** 2).sum(-1)

    with np.errstate(all="ignore"):
        inner = np.stack([(u * c - v * b), (v * a - u * b)]) / (a * c - b**2)
        found = [np.where(((inner >= low) & (inner <= high)).all(0), at(*inner), np.inf)]
        for edge in (low, high):
            found.append(at(edge[0], np.clip((v - b * edge[0]) / c, low[1], high[1])))
            found.append(at(np.clip((u - b * edge[1]) / a, low[0], high[0]), edge[1]))
    return np.nan_to_num(np.min(found, axis=0), nan=1e6, posinf=1e6)

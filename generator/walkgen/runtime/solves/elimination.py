"""Poses of a three-joint leg that reach a target, by elimination down to one joint: candidates for the general inverse.

Let x be the foot moved by joints 2 and 3 alone, g by joint 3 alone, seen from axis 2. What joint 1 cannot change of x is known from the
target, what joint 2 cannot change of it from g. Both leave a plane vector y (x across axis 2; across axis 1 where joint 2 slides) with

    M y = k(q3),    |y|^2 = r^2(q3),    M constant;  k = c + w . g + e |g|^2,  r^2 = r0^2 + (|g|^2 - (z2 . g)^2 where joint 2 turns)

With the singular values s1 >= |s2| of M and y, k along its singular directions, y = (k1 / s1, y2) and

    F(q3) = k2^2 - s2^2 (r^2 - (k1 / s1)^2) = 0,    y2 = k2 / s2

is a quartic in tan(q3 / 2), a quadratic in a sliding q3. Where s2 = 0 (axes that meet or are parallel) it is the square of k2 = 0, which is
then solved instead, and y2 takes both signs; where s2 is small both are solved, for neither alone would be well conditioned.
Three turning joints: Pieper 1968.
"""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.quartic import SPLIT, roots_within, scaled
from walkgen.runtime.solves.spatial import Chain, Reals, across, angle_about, dot, moved, norm

_TOUCHING = 1e-9
_NONE = 1e-13
_SMALL = 1e-2
_FARTHEST = 1e12
_SAMPLES = np.arange(5) * (2.0 * np.pi / 5.0)


@dataclass(frozen=True)
class Elimination:
    """Chains and targets [rows, 1, ...], the terms of k [rows, 1, 2(, 3)], s1, s2 and r0^2 [rows, 1], directions of y [rows, 1, 2, 3]."""

    chain: Chain
    target: Reals
    c: Reals
    w: Reals
    e: Reals
    s1: Reals
    s2: Reals
    y: Reals
    r0: Reals

    def terms(self, q3: Reals) -> tuple[Reals, Reals, Reals]:
        """g - o2 [rows, m, 3], k [rows, m, 2] and r^2 [rows, m] at q3 [rows, m]."""
        g = moved(self.chain, 2, q3, self.chain.foot) - self.chain.points[..., 1, :]
        square = dot(g, g)
        k = self.c + dot(self.w, g[..., None, :]) + self.e * square[..., None]
        turning = self.chain.kinds[1] == "R"
        return g, k, self.r0 + (square - dot(self.chain.axes[..., 1, :], g) ** 2 if turning else 0.0)

    def equations(self, q3: Reals) -> tuple[Reals, Reals]:
        """F and k2 [rows, m]; where axes 1 and 2 are one, nothing is left of y but its length."""
        _, k, square = self.terms(q3)
        free = self.s1 < _NONE
        first = k[..., 0] / np.where(free, 1.0, self.s1)
        F = k[..., 1] ** 2 - self.s2**2 * (square - first**2)
        return np.where(free, dot(k, k), F), k[..., 1]

    def poses(self, q3: Reals, sign: float) -> Reals:
        """q [rows, m, 3] with this sign of y2, or with y2 = k2 / s2 where that is well conditioned."""
        g, k, square = self.terms(q3)
        free = self.s1 < _NONE
        length = np.sqrt(np.maximum(square, 0.0))
        first = np.where(free, length, k[..., 0] / np.where(free, 1.0, self.s1))
        root = sign * np.sqrt(np.maximum(square - first**2, 0.0))
        sharp = np.abs(self.s2) >= _SMALL
        second = np.where(sharp, k[..., 1] / np.where(sharp, self.s2, 1.0), root)
        y = first[..., None] * self.y[..., 0, :] + second[..., None] * self.y[..., 1, :]
        return np.stack([*self._first_joints(g, y), q3], axis=-1)

    def _first_joints(self, g: Reals, y: Reals) -> tuple[Reals, Reals]:
        (z1, z2), (o1, o2) = (np.moveaxis(item[..., :2, :], -2, 0) for item in (self.chain.axes, self.chain.points))
        away = self.target - o1
        if self.chain.kinds[1] == "R":
            x, q2 = o2 + y + dot(z2, g)[..., None] * z2, angle_about(z2, g, y)
        else:
            x = o1 + y + dot(z1, away)[..., None] * z1
            q2 = dot(z2, x - g - o2)
        q1 = angle_about(z1, x - o1, away) if self.chain.kinds[0] == "R" else dot(z1, self.target - x)
        return q1, q2


def eliminate(chain: Chain, target: Reals) -> Elimination:
    """Set the equations up for chains [rows] and targets [rows, 3]; joints 1 and 2 do not both slide."""
    chain = Chain(chain.kinds, chain.axes[:, None], chain.points[:, None], chain.foot[:, None])
    p = target[:, None]
    (z1, z2), (o1, o2) = (np.moveaxis(item[..., :2, :], -2, 0) for item in (chain.axes, chain.points))
    away, e = p - o1, np.zeros((*p.shape[:-1], 2))
    r0 = np.zeros(p.shape[:-1])
    normal = z2
    if chain.kinds[1] == "P":
        rows, normal = np.stack(across(z2), axis=-2), z1
        height = dot(z1, away)
        c = dot(rows, (o2 - o1)[..., None, :]) - height[..., None] * dot(rows, z1[..., None, :])
        w, r0 = rows, dot(away, away) - height**2
    elif chain.kinds[0] == "P":
        rows = np.stack(across(z1), axis=-2)
        c = dot(rows, (p - o2)[..., None, :])
        w = -dot(rows, z2[..., None, :])[..., None] * z2[..., None, :]
    else:
        rows = np.stack([z1, o2 - o1], axis=-2)
        c = np.stack([dot(z1, p - o2), 0.5 * (dot(away, away) - dot(o2 - o1, o2 - o1))], axis=-1)
        w = -dot(rows, z2[..., None, :])[..., None] * z2[..., None, :]
        e = e - np.array([0.0, 0.5])
    matrix = rows - dot(rows, normal[..., None, :])[..., None] * normal[..., None, :]
    turn = _orthogonalizing(matrix[..., 0, :], matrix[..., 1, :])
    matrix, w = (np.einsum("...ij,...jk->...ik", turn, item) for item in (matrix, w))
    c, e = (np.einsum("...ij,...j->...i", turn, item) for item in (c, e))
    s1 = norm(matrix[..., 0, :])
    first = np.where((s1 < _NONE)[..., None], across(normal)[0], matrix[..., 0, :] / np.where(s1 < _NONE, 1.0, s1)[..., None])
    second = np.cross(normal, first)
    return Elimination(chain, p, c, w, e, s1, dot(matrix[..., 1, :], second), np.stack([first, second], axis=-2), r0)


def _orthogonalizing(a: Reals, b: Reals) -> Reals:
    """The rotation [..., 2, 2] of a pair of vectors that makes them orthogonal, the longer one first."""
    angle = 0.5 * np.arctan2(2.0 * dot(a, b), dot(a, a) - dot(b, b))
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, s], axis=-1), np.stack([-s, c], axis=-1)], axis=-2)


def candidates(chain: Chain, target: Reals) -> Reals:
    """q [rows, m, 3] near every pose that reaches the target, and others; NaN rows are none."""
    system = eliminate(chain, target)
    F, k2 = (_roots(system, index) for index in (0, 1))
    small, none = np.abs(system.s2) < _SMALL, np.abs(system.s2) < _NONE
    F = np.where(none & (system.s1 >= _NONE), np.nan, F)
    k2 = np.where(small & (system.s1 >= _NONE), k2, np.nan)
    q3 = np.concatenate([F, k2], axis=-1)
    plus, minus = system.poses(q3, 1.0), system.poses(q3, -1.0)
    return np.concatenate([plus, np.where(small[..., None], minus, np.nan)], axis=-2)


def _roots(system: Elimination, index: int) -> Reals:
    """Zeros q3 [rows, m] of one of the two equations, touching ones included; 0 too where it vanishes everywhere."""
    rows = system.target.shape[0]
    if system.chain.kinds[2] == "P":
        below, middle, above = np.moveaxis(system.equations(np.broadcast_to([-1.0, 0.0, 1.0], (rows, 3)))[index], -1, 0)
        zero = np.zeros(rows)
        polynomial = np.stack([middle, 0.5 * (above - below), 0.5 * (above + below) - middle, zero, zero], axis=-1)
        found = np.tan(0.5 * _real_roots(polynomial))
        found = np.where(np.abs(found) < _FARTHEST, found, np.nan)
    else:
        values = system.equations(np.broadcast_to(_SAMPLES, (rows, 5)))[index]
        polynomial = _half_tangent(values)
        found = _real_roots(polynomial)
    vanishing = np.max(np.abs(polynomial), axis=-1) < _TOUCHING
    return np.concatenate([found, np.where(vanishing, 0.0, np.nan)[:, None]], axis=-1)


def _half_tangent(values: Reals) -> Reals:
    """The polynomial in t = tan(q3/2) that is (1 + t^2)^2 times a trigonometric one of degree 2 with these values at 0, 72, .. degrees."""
    mean = np.mean(values, axis=-1)
    c1, s1, c2, s2 = (0.4 * values @ function(order * _SAMPLES) for order in (1, 2) for function in (np.cos, np.sin))
    return np.stack([mean + c1 + c2, 2.0 * s1 + 4.0 * s2, 2.0 * mean - 6.0 * c2, 2.0 * s1 - 4.0 * s2, mean - c1 + c2], axis=-1)


def _real_roots(polynomial: Reals) -> Reals:
    """2 atan of the real roots, the one at infinity included, [rows, 8]; NaN where there is none."""
    polynomial = scaled(polynomial)
    inner = roots_within(polynomial, SPLIT, _TOUCHING)
    outer = roots_within(polynomial[..., ::-1], 1.0 / SPLIT, _TOUCHING)
    return np.concatenate([2.0 * np.arctan(inner), 2.0 * np.arctan2(1.0, outer)], axis=-1)

"""What a robot that adapts to the terrain minimises, with exact derivatives; the reference of walkgen_adapt_criterion.h.

    Phi = w_lim sum_j ((q_j - mid_j) / half_j)^2 + sum over child platforms: w_n (1 - z . n) + w_h (n . (o - mean of its targets) - h)^2

The chain joints c are free, every leg follows: dq_leg/dc = B = -J_leg^-1 J_c, the closed form of the null space N = [1; B]. With
lambda = J_leg^-T dPhi/dq_leg the legs' own curvature is -sum_ik (lambda . d2p/dq_i dq_k) N_i N_k, so no third tensor is formed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from walkgen.runtime.solves.adapt_legs import Leg
from walkgen.runtime.solves.tree import Motion, Reals, Tree, columns


@dataclass(frozen=True)
class Criterion:
    """Weights w_lim, w_n, w_h and the height h; limits' `middle` and `half` [nq], `counted` where both limits are finite and apart.

    `normals` [m, 3] are unit vectors, `means` [m, 3] each platform's mean target and `standing` [m] whether it has feet;
    `led` [k]: whether chain joints that may move lead a leg.
    """

    tree: Tree
    weights: Reals
    middle: Reals
    half: Reals
    counted: NDArray[np.bool_]
    normals: Reals
    means: Reals
    standing: NDArray[np.bool_]
    led: tuple[bool, ...]

    def value(self, at: Motion, q: Reals) -> float:
        """Phi where the tree stands."""
        limit, level, height, wanted = self.weights
        share = np.where(self.counted, (q - self.middle) / self.half, 0.0)
        total = float(limit * np.sum(share**2))
        for m in range(1, len(self.tree.carriers)):
            tilt = at.turned(self.tree.carriers[m], self.tree.rotations[m][:, 2]) - self.normals[m]
            total += 0.5 * level * float(tilt @ tilt)
            if self.standing[m]:
                excess = self._height(at, m) - wanted
                total += height * excess * excess  # in this order 0 wins over what overflows
        return total

    def _height(self, at: Motion, m: int) -> float:
        return float(self.normals[m] @ (at.moved(self.tree.carriers[m], self.tree.origins[m]) - self.means[m]))


@dataclass(frozen=True)
class Derivatives:
    """Of Phi by the chain joints: gradient [nc], Hessian [nc, nc], its diagonal less curvature [nc], sizes of the gradient's parts [nc]."""

    gradient: Reals
    hessian: Reals
    diagonal: Reals
    size: Reals


def derivatives(criterion: Criterion, at: Motion, legs: Sequence[Leg], q: Reals) -> Derivatives:
    """Exact first and second derivatives; no leg that chains move stands in a singular pose."""
    tree, limit = criterion.tree, criterion.weights[0]
    chains = list(tree.chains)
    pull = np.where(criterion.counted, 2.0 * limit * (q - criterion.middle) / criterion.half**2, 0.0)
    curve = np.where(criterion.counted, 2.0 * limit / criterion.half**2, 0.0)
    gradient, hessian, diagonal, size = pull[chains], np.diag(curve[chains]), curve[chains], np.abs(pull[chains])
    place = {joint: index for index, joint in enumerate(chains)}
    for foot, leg in enumerate(tree.legs):
        path = tree.path(tree.bases[foot])
        if not criterion.led[foot]:
            continue
        own = [place[joint] for joint in path]
        part = _leg_part(criterion, at, foot, legs[foot], q[list(leg)], pull[list(leg)], curve[list(leg)])
        gradient[own] += part.gradient
        hessian[np.ix_(own, own)] += part.hessian
        diagonal[own] += part.diagonal
        size[own] += part.size
    for m in range(1, len(tree.carriers)):
        path = tree.path(tree.carriers[m])
        if not path:
            continue
        own = [place[joint] for joint in path]
        part = _platform_part(criterion, at, m, path)
        gradient[own] += part.gradient
        hessian[np.ix_(own, own)] += part.hessian
        diagonal[own] += part.diagonal
        size[own] += part.size
    return Derivatives(gradient, hessian, diagonal, size)


def null_space(tree: Tree, at: Motion, foot: int) -> tuple[Reals, Reals, Reals]:
    """How a leg follows its chain joints [3, path], its Jacobian [3, 3] and that of the chain joints on its path [3, path]."""
    path, leg = tree.path(tree.bases[foot]), tree.legs[foot]
    point = at.moved(leg[-1], tree.feet[foot])
    own, carried = columns(tree, at, leg, point), columns(tree, at, path, point)
    return np.asarray(-np.linalg.solve(own, carried)), own, carried


def _leg_part(criterion: Criterion, at: Motion, foot: int, leg: Leg, q: Reals, pull: Reals, curve: Reals) -> Derivatives:
    tree = criterion.tree
    follow, own, carried = null_space(tree, at, foot)
    joints = (*tree.path(tree.bases[foot]), *tree.legs[foot])
    null = np.vstack([np.eye(carried.shape[1]), follow])
    force = np.asarray(np.linalg.solve(own.T, pull))
    bent = _second(tree, at, joints, np.hstack([carried, own]), force)
    if leg.driven is not None:
        force = force if leg.base < 0 else at.rotations[leg.base].T @ force
        bent[-3:, -3:] += np.einsum("k,kij->ij", force, leg.driven.foot(q)[2])
    hessian = follow.T @ (curve[:, None] * follow) - null.T @ bent @ null
    return Derivatives(follow.T @ pull, hessian, curve @ follow**2, np.abs(follow.T) @ np.abs(pull))


def _second(tree: Tree, at: Motion, joints: tuple[int, ...], moving: Reals, force: Reals) -> Reals:
    """A vector times the second derivatives of a point or direction that joints move by the columns `moving`; symmetric."""
    axes = np.where(tree.slides[list(joints), None], 0.0, at.axes[list(joints)])
    upper = np.triu(np.einsum("k,aik->ai", force, np.cross(axes[:, None], moving.T[None])))
    return np.asarray(upper + np.triu(upper, 1).T)


def _platform_part(criterion: Criterion, at: Motion, m: int, path: tuple[int, ...]) -> Derivatives:
    tree, normal = criterion.tree, criterion.normals[m]
    _, level, height, wanted = criterion.weights
    z = at.turned(tree.carriers[m], tree.rotations[m][:, 2])
    turning = np.where(tree.slides[list(path), None], 0.0, np.cross(at.axes[list(path)], z)).T
    slope = normal @ turning
    gradient, hessian = -level * slope, -level * _second(tree, at, path, turning, normal)
    diagonal, size = level * np.sum(turning**2, axis=0), level * np.abs(slope)
    if criterion.standing[m]:
        shift = columns(tree, at, path, at.moved(tree.carriers[m], tree.origins[m]))
        rise, excess = normal @ shift, float(normal @ (at.moved(tree.carriers[m], tree.origins[m]) - criterion.means[m])) - wanted
        gradient = gradient + 2.0 * height * excess * rise
        hessian = hessian + 2.0 * height * (np.outer(rise, rise) + excess * _second(tree, at, path, shift, normal))
        diagonal = diagonal + 2.0 * height * rise**2
        size = size + 2.0 * height * np.abs(excess * rise)
    return Derivatives(gradient, hessian, diagonal, size)

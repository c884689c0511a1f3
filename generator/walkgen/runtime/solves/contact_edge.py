"""Forces near the edge of what feet can carry, or a proof: the reference of walkgen_contact_edge.h and walkgen_contact_corner.h."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from walkgen.runtime.solves.friction_margins import scaled
from walkgen.runtime.solves.friction_needed import Problem, problem_of, reach
from walkgen.runtime.solves.rows import Integers, Reals

_EPSILON = float(np.finfo(float).eps)
_TURNS = 250


class Edge(NamedTuple):
    """Forces [k,3] (N) that carry the load where any do, and a certificate [6] that none does where none do; neither is verified."""

    f: Reals
    certificate: Reals


def at_edge(points: Reals, normals: Reals, mu: Reals, wrench: Reals) -> Edge:
    """With round cones: at the greatest normal force s that all feet can have above what their friction needs.

    Args:
        points: [k,3], m.
        normals: [k,3], unit.
        mu: [k].
        wrench: [6], the load on the robot.
    """
    problem = problem_of(points, normals, wrench)
    _, x, y = reach(scaled(problem, mu), 1.0)
    N = np.maximum(x[::3], 0.0)
    T = mu[:, None] * x.reshape(-1, 3)[:, 1:]
    T *= np.minimum(1.0, mu * N / np.maximum(np.hypot(*T.T), 1e-300))[:, None]
    f = problem.stance.force * np.einsum("kj,kji->ki", np.column_stack([N, T]), problem.frames)

    def least(h: Reals) -> Reals:
        N = np.sum(h * normals, axis=1)
        return np.asarray(N - mu * np.linalg.norm(h - N[:, None] * normals, axis=1))

    return Edge(f, _proof(problem, problem.kept @ y, least, normals, wrench))


def at_corner(points: Reals, normals: Reals, mu: Reals, wrench: Reals, facets: int) -> Edge:
    """With pyramids: by the simplex method, over sums of their edges and of what is missing.

    Args:
        points: as `at_edge` takes them, like the others.
        normals: [k,3].
        mu: [k].
        wrench: [6].
        facets: of each pyramid.
    """
    problem = problem_of(points, normals, wrench)
    stance, k = problem.stance, len(points)
    edges = _edges(normals, mu, facets)
    columns = np.einsum("ikj,kfj->ikf", stance.grasp.reshape(6, k, 3), edges).reshape(6, k * facets)
    b = -problem.kept @ (problem.kept.T @ stance.load)
    factors, y = _simplex(columns, b)
    f = stance.force * np.einsum("kf,kfj->kj", factors.reshape(k, facets), edges)
    return Edge(f, _proof(problem, -y, lambda h: np.min(np.einsum("kfj,kj->kf", edges, h), axis=1), normals, wrench))


def _proof(problem: Problem, y: Reals, least: Callable[[Reals], Reals], normals: Reals, wrench: Reals) -> Reals:
    """The certificate of multipliers y [6], with as much of a motion away from the ground as makes up for rounding.

    `least` gives the least products with forces of unit normal part.
    """
    grasp = problem.stance.grasp
    away = np.linalg.lstsq(grasp.T, normals.ravel(), rcond=None)[0]
    room, lack = (least((grasp.T @ item).reshape(-1, 3)).min() for item in (away, y))
    twist = problem.twist(y + 2.0 * max(-lack, 0.0) / room * away if room > 0.0 else y)
    gain = float(twist @ wrench)
    return twist / gain if gain > 0.0 else np.full(6, np.nan)


def _edges(normals: Reals, mu: Reals, facets: int) -> Reals:
    """Forces along the pyramids' edges with a normal part of 1 [k,facets,3]; the first side looks along the frame's first axis."""
    axis = np.where(np.abs(normals[:, :1]) > 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    along = axis - np.sum(axis * normals, axis=1, keepdims=True) * normals
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    turn = 2.0 * np.pi / facets * (np.arange(facets) + 0.5)
    ways = np.cos(turn)[:, None] * along[:, None] + np.sin(turn)[:, None] * np.cross(normals, along)[:, None]
    return np.asarray(normals[:, None] + mu[:, None, None] * ways)


@dataclass(frozen=True)
class _Corner:
    """Six columns `basis` and their factors x; `parts` are their numbers, -1 for a part of b; multipliers y."""

    basis: Reals
    parts: Integers
    x: Reals
    y: Reals

    def factors(self, count: int) -> Reals:
        """Of all columns."""
        found, used = np.zeros(count), self.parts >= 0
        np.add.at(found, self.parts[used], np.maximum(self.x[used], 0.0))
        return found


def _simplex(columns: Reals, b: Reals) -> tuple[Reals, Reals]:
    """Factors >= 0 of the columns that leave least of b missing, and multipliers by which all columns lose beyond rounding."""
    start = _Corner(np.where(b < 0.0, -1.0, 1.0) * np.eye(6), np.full(6, -1), np.abs(b), np.zeros(6))
    found = _walk(columns, b, start, 0.0)
    further = _walk(columns, b, found, 64.0 * _EPSILON * (1.0 + float(np.linalg.norm(found.y))))
    return found.factors(columns.shape[1]), further.y


def _walk(columns: Reals, b: Reals, corner: _Corner, spare: float) -> _Corner:
    """From corner to corner until nothing is missing, or all columns lose at least `spare`; y: what a unit of b costs."""
    basis, parts, x, y = corner.basis.copy(), corner.parts.copy(), corner.x, corner.y
    sizes = np.linalg.norm(columns, axis=0)
    for turn in range(_TURNS):
        y = np.asarray(np.linalg.solve(basis.T, np.where(parts < 0, 1.0, -spare)), float)
        gains = spare + y @ columns - 8.0 * _EPSILON * np.linalg.norm(y) * sizes
        best = int(np.argmax(gains if turn < _TURNS // 2 else gains > 0.0))
        if np.abs(x[parts < 0]).sum() <= _EPSILON or not gains[best] > 0.0:
            break
        share = np.asarray(np.linalg.solve(basis, columns[:, best]), float)
        leaving = _leaving(x, share)
        if leaving < 0:
            break
        basis[:, leaving], parts[leaving] = columns[:, best], best
        x = np.asarray(np.linalg.solve(basis, b), float)
    return _Corner(basis, parts, x, y)


def _leaving(x: Reals, share: Reals) -> int:
    """Which column leaves for one that the others make up by `share`: of those that vanish first, the one of the largest share."""
    falls = share > 64.0 * _EPSILON * np.abs(share).max()
    if not falls.any():
        return -1
    far = np.min((np.maximum(x[falls], 0.0) + 8.0 * _EPSILON) / share[falls])
    return int(np.argmax(np.where(falls & (x <= far * share), share, -np.inf)))

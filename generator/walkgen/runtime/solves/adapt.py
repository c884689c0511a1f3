"""A modular robot adapted to the terrain: chain joints that minimise a criterion, legs by their inverse; the reference of walkgen_adapt.h.

The chain joints move in their limits by Newton with exact derivatives, damped (Levenberg, Marquardt) until the criterion falls; a step
that leaves a leg without a pose is one that did not. Where the start does not let every foot reach its target, the chains first reduce
what is missing; after that, and where the descent ends early, other starts are tried, always the same ones.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.adapt_approach import approached
from walkgen.runtime.solves.adapt_criterion import Criterion
from walkgen.runtime.solves.adapt_descent import descended
from walkgen.runtime.solves.adapt_legs import Driven, leg_of
from walkgen.runtime.solves.adapt_stand import Problem, Stand
from walkgen.runtime.solves.tree import Integers, Reals, Tree, broadcast_rows, limits_fit, middle_and_spans, read_tree
from walkgen.signature import STATUSES

_OK, _UNREACHABLE, _BAD_INPUT, _NO_CONVERGENCE = (STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "NO_CONVERGENCE"))
_FLAT = 1e-10
_STARTS = 8
_GOLDEN = 0.6180339887498949

DrivenLeg = tuple[Any, ...]
"""Its motion, rows and pose somewhere, each with what it takes after its point; how many rows; its platform; () of a leg of axes."""


def adapt(
    geometry: ArrayLike,
    topology: ArrayLike,
    limits: ArrayLike,
    targets: ArrayLike,
    normal: ArrayLike,
    start: ArrayLike,
    weights: ArrayLike,
    nq: int,
    feet: int,
    platforms: int,
    driven: Sequence[DrivenLeg] = (),
) -> tuple[Reals, Integers, Reals]:
    """Joint values that put every foot on its target and minimise the criterion of adapt_criterion.py within the chains' limits.

    Args:
        geometry: axes and points of joints, feet, rotations and origins of platforms at q = 0, from the root [..., 6 nq + 3 k + 12 m].
        topology: every joint's parent, every joint's kind, every foot's last joint, every platform's last joint [..., 2 nq + k + m].
        limits: lower and upper value of every joint [..., nq, 2]; infinite where there is none.
        targets: where the feet stand [..., k, 3], m, root platform's frame.
        normal: the terrain's normal at every platform [..., m, 3]; (0, 0, 0) for that of the targets' least-squares plane.
        start: joint values to begin with [..., nq]; the middle of the limits where not finite. Legs take the pose nearest to it.
        weights: w_lim, w_n, w_h and the height h of platforms over their feet [..., 4].
        nq: number of joints.
        feet: k.
        platforms: m.
        driven: of the legs that functions describe instead of axes; empty where none is.

    Returns:
        q [..., nq], status [...], Phi [...]: OK where Phi is stationary; UNREACHABLE and closest where no tried pose of the chains has all
        feet on their targets; NO_CONVERGENCE where the descent ended early; BAD_INPUT with NaN, also where the functions have no foot.
    """
    data = next((leg[0][1:] for leg in driven if leg), ())
    inputs = [np.asarray(item, float) for item in (geometry, topology, limits, targets, normal, start, weights, *data)]
    shape, rows = broadcast_rows(inputs, (1, 1, 2, 2, 2, 1, 1, *(1 for _ in data)))
    q, status, cost = np.full((*shape, nq), np.nan), np.full(shape, _BAD_INPUT, np.int32), np.full(shape, np.nan)
    for place in np.ndindex(shape):
        if (answer := _answer([row[place] for row in rows], nq, feet, platforms, driven)) is not None:
            q[place], status[place], cost[place] = answer
    return q, status, cost


def _answer(row: Sequence[Reals], nq: int, feet: int, platforms: int, driven: Sequence[DrivenLeg]) -> tuple[Reals, int, float] | None:
    """Of one row, None where its input is bad."""
    numbers, links, bounds, aims, normals, first, weigh, *data = row
    tree = read_tree(numbers, links, nq, feet, platforms)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # what is no number ends as BAD_INPUT
        if tree is None:
            return None
        described = [_described(tree, leg, data) if leg else None for leg in driven or [()] * feet]
        problem = _problem(tree, described, bounds, aims, normals, first, weigh)
        return None if problem is None else _solved(problem)


def _described(tree: Tree, leg: DrivenLeg, data: Sequence[Reals]) -> Driven:
    """The leg's functions with what they take in this row."""
    motion, rows, somewhere = (partial(_called, function, data) for function, *_ in leg[:3])
    return Driven(motion, rows, somewhere, tree.rotations[leg[4]], tree.origins[leg[4]])


def _called(function: Callable[..., Any], data: Sequence[Reals], point: Reals) -> Any:
    return function(point, *data)


def _problem(
    tree: Tree, driven: Sequence[Driven | None], limits: Reals, targets: Reals, normal: Reals, start: Reals, weights: Reals
) -> Problem | None:
    """None where an input is no number, a lower limit lies above its upper one, or a weight is negative."""
    given = np.concatenate([targets.ravel(), normal.ravel(), weights])
    if not (np.isfinite(given).all() and (weights[:3] >= 0.0).all() and limits_fit(limits)):
        return None
    middle, spans, counted = middle_and_spans(tree, limits)
    standing = np.array([m in tree.homes for m in range(len(tree.carriers))])
    homes = np.array(tree.homes, int)
    means = np.array([targets[homes == m].mean(axis=0) if standing[m] else np.zeros(3) for m in range(len(standing))])
    free = limits[:, 0] < limits[:, 1]
    led = tuple(bool(free[list(tree.path(base))].any()) for base in tree.bases)
    criterion = Criterion(tree, weights, middle, spans, counted, _normals(normal, targets), means, standing, led)
    legs = tuple(leg_of(tree, foot, spans, own) for foot, own in enumerate(driven))
    reference = np.where(np.isfinite(start), start, middle)
    return Problem(criterion, legs, targets, limits[:, 0], limits[:, 1], spans, reference)


def _normals(normal: Reals, targets: Reals) -> Reals:
    """Unit vectors; (0, 0, 0) becomes the normal of the targets' plane."""
    size = np.max(np.abs(normal), axis=-1, keepdims=True)
    scaled = np.where(size > 0.0, normal / np.where(size > 0.0, size, 1.0), plane_normal(targets))
    return np.asarray(scaled / np.linalg.norm(scaled, axis=-1, keepdims=True))


def plane_normal(points: Reals) -> Reals:
    """The unit normal of the plane with the least squared distances, upwards; z for fewer than 3 points or points on a line."""
    if len(points) < 3:
        return np.array([0.0, 0.0, 1.0])
    size = np.max(np.abs(points))
    away = (points - points.mean(axis=0)) / (size or 1.0)
    values, vectors = np.linalg.eigh(away.T @ away)
    if not values[1] > _FLAT * values[2]:
        return np.array([0.0, 0.0, 1.0])
    return np.asarray(vectors[:, 0] if vectors[2, 0] >= 0.0 else -vectors[:, 0])


def _solved(problem: Problem) -> tuple[Reals, int, float] | None:
    """q, status and Phi; None where they are not finite."""
    best: tuple[int, float, Stand] | None = None
    for q in _starts(problem):
        stand = approached(problem, q)
        if stand is None:
            continue
        if stand.regular(problem):
            stand, stationary = descended(problem, stand)
            rank, size = (0, 0.0) if stationary else (1, stand.cost)
        else:
            rank, size = (1, np.inf) if stand.missed == 0.0 else (2, stand.missed)
        if best is None or (rank, size) < best[:2]:
            best = rank, size, stand
        if rank == 0:
            break
    if best is None or not (np.isfinite(best[2].q).all() and np.isfinite(best[2].cost)):
        return None
    fixed = any(pose.gap.any() for led, pose in zip(problem.criterion.led, best[2].legs, strict=True) if not led)
    return best[2].q, _UNREACHABLE if fixed else (_OK, _NO_CONVERGENCE, _UNREACHABLE)[best[0]], best[2].cost


def _starts(problem: Problem) -> Iterator[Reals]:
    """Where the chains start: as given, in the middle, twice nearby, then all over their ranges; the same points every time."""
    chains = list(problem.tree.chains)
    first = problem.clamped(problem.reference)
    yield first
    middle = np.where(np.isin(np.arange(len(first)), chains), problem.criterion.middle, problem.reference)
    if (middle[chains] != first[chains]).any():
        yield problem.clamped(middle)
    for turn in range(2, _STARTS):
        base, radius = (first, 0.1) if turn < 4 else (middle, 0.8)
        q = base.copy()
        for index, joint in enumerate(chains):
            share = 0.5 + turn * (index + 1) * _GOLDEN
            q[joint] += radius * problem.spans[joint] * (2.0 * (share - np.floor(share)) - 1.0)
        yield problem.clamped(q)

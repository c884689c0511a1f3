"""Chain joints that bring feet to their targets, or as near as their limits let them: the reference of walkgen_adapt_approach.h.

Gauss-Newton on the distances of the legs' closest poses, damped (Levenberg, Marquardt) until they fall.
"""

import numpy as np

from walkgen.runtime.solves.adapt_solve import cholesky
from walkgen.runtime.solves.adapt_stand import Problem, Stand, stand_at
from walkgen.runtime.solves.tree import Reals, columns

_APPROACHES, _DRIVEN_APPROACHES = 15, 60
_MARGIN = 0.01


def approached(problem: Problem, q: Reals) -> Stand | None:
    """A stand from these chain joints on in which every led foot reaches its target, or one that misses no more than the first.

    None where a leg's pose is no number.
    """
    best, damping, worse = stand_at(problem, q), 1e-2, 0
    for _ in range(_DRIVEN_APPROACHES if any(leg.driven for leg in problem.legs) else _APPROACHES):
        if best is None or best.missed == 0.0 or worse == _APPROACHES:
            break
        other = stand_at(problem, problem.clamped(best.q + _step(problem, best, damping)))
        if other is not None and other.missed < best.missed:
            best, damping, worse = other, 0.25 * damping, 0
        else:
            damping, worse = 4.0 * damping, worse + 1
    return best


def _step(problem: Problem, stand: Stand, damping: float) -> Reals:
    """Of the chains, to bring missing feet to their targets and a little beyond, but not beyond limits [nq]."""
    chains = list(problem.tree.chains)
    matrix, rhs = _equations(problem, stand)
    q, lower, upper = stand.q[chains], problem.lower[chains], problem.upper[chains]
    free = ~(((q <= lower) & (rhs < 0.0)) | ((q >= upper) & (rhs > 0.0)))
    shares = cholesky(np.where(np.outer(free, free), matrix, 0.0) + damping * np.eye(len(chains)), np.where(free, rhs, 0.0))
    step = np.zeros(len(stand.q))
    step[chains] = 0.0 if shares is None else problem.spans[chains] * shares
    return step


def _equations(problem: Problem, stand: Stand) -> tuple[Reals, Reals]:
    """Of the step in the joints' units: a distance's gradient is gap . J_c / |gap|; sideways the closest pose follows, as on a sphere."""
    tree, chains = problem.tree, list(problem.tree.chains)
    matrix, rhs = np.zeros((len(chains), len(chains))), np.zeros(len(chains))
    for foot, (leg, pose) in enumerate(zip(problem.legs, stand.legs, strict=True)):
        distance = float(np.linalg.norm(pose.gap))
        if not problem.criterion.led[foot] or distance == 0.0:
            continue
        path, share = tree.path(leg.base), distance / (distance + leg.reach)
        point = stand.at.moved(leg.joints[-1], tree.feet[foot])
        shifts = columns(tree, stand.at, path, point) * problem.spans[list(path)] / leg.reach
        row, own = pose.gap / distance @ shifts, [chains.index(joint) for joint in path]
        matrix[np.ix_(own, own)] += share * shifts.T @ shifts + (1.0 - share) * np.outer(row, row)
        rhs[own] -= row * (distance / leg.reach + _MARGIN)
    return matrix, rhs

"""Newton's descent of `adapt` on its chain joints: exact derivatives, damping, limits; the reference of walkgen_adapt_descent.h."""

import numpy as np
from numpy.typing import NDArray

from walkgen.runtime.solves.adapt_criterion import Derivatives, derivatives
from walkgen.runtime.solves.adapt_solve import ROUNDINGS, cholesky
from walkgen.runtime.solves.adapt_stand import Problem, Stand, stand_at

_STATIONARY = 1e-10
_STEPS = 100
_TRIES = 24
_POLISHES = 4
_STALLS = 8
_GAIN = 1e-4


def descended(problem: Problem, stand: Stand) -> tuple[Stand, bool]:
    """The stand that the descent from a regular one ends in, and whether Phi is stationary there.

    Stationary: what is left of the gradient by the chain joints that their limits do not hold is at most 1e-10, or its rounding. A few
    steps more are taken while they make it smaller. Steps that gain little where Phi becomes steeper lead to a leg's singular pose: after a
    few the descent ends.
    """
    best, least, stationary, damping, polishes, stalls = stand, np.inf, False, 0.0, 0, 0
    for _ in range(_STEPS):
        slope = derivatives(problem.criterion, stand.at, problem.legs, stand.q)
        free = _free(problem, stand, slope)
        size = float(np.linalg.norm(slope.gradient[free]))
        steeper = not size < least
        if stationary and steeper:
            break
        best, least = stand, size
        if size <= max(_STATIONARY, ROUNDINGS * float(np.max(slope.size, initial=0.0))):
            stationary, polishes = True, polishes + 1
        if size == 0.0 or polishes > _POLISHES:
            break
        after, damping = _lower(problem, stand, slope, free, damping)
        if after is None:
            break
        stalls = stalls + 1 if steeper and stand.cost - after.cost < _GAIN * stand.cost else 0
        if stalls > _STALLS:
            break
        stand = after
    return best, stationary


def _free(problem: Problem, stand: Stand, slope: Derivatives) -> NDArray[np.bool_]:
    """Which chain joints may move [nc]: not those whose limit the descent pushes against."""
    chains = list(problem.tree.chains)
    q, lower, upper = stand.q[chains], problem.lower[chains], problem.upper[chains]
    held = ((q <= lower) & (slope.gradient > 0.0)) | ((q >= upper) & (slope.gradient < 0.0))
    return (lower < upper) & ~held


def _lower(problem: Problem, stand: Stand, slope: Derivatives, free: NDArray[np.bool_], damping: float) -> tuple[Stand | None, float]:
    """A stand with less Phi, or None where no step finds one, and the damping for the next."""
    chains = np.array(problem.tree.chains, int)[free]
    gradient, hessian, scale = slope.gradient[free], slope.hessian[np.ix_(free, free)], slope.diagonal[free]
    scale = np.maximum(scale, 1e-3 * np.max(scale))
    scale = np.where(scale > 0.0, scale, 1.0)
    slack = ROUNDINGS * stand.cost
    for _ in range(_TRIES):
        step = cholesky(hessian + damping * np.diag(scale), -gradient)
        if step is not None:
            q = stand.q.copy()
            q[chains] += step / max(1.0, float(np.max(np.abs(step) / problem.spans[chains])))
            q[chains] = problem.clamped(q)[chains]
            moved = q[chains] - stand.q[chains]
            expected = -float(gradient @ moved + 0.5 * moved @ hessian @ moved)
            after = stand_at(problem, q, stand)
            if after is not None and stand.cost - after.cost >= 1e-4 * max(expected, 0.0) - slack:
                well = stand.cost - after.cost >= 0.75 * expected - slack
                return after, (0.1 * damping if damping > 1e-5 else 0.0) if well else max(4.0 * damping, 1e-3)
        damping = max(10.0 * damping, 1e-3)
    return None, damping

"""Joint rates of a modular robot whose feet move as asked, nearest to wanted rates: the reference of walkgen_adapt_velocity.h."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.adapt_solve import cholesky
from walkgen.runtime.solves.damped import damped_inverse_3
from walkgen.runtime.solves.tree import (
    Integers,
    Reals,
    Tree,
    broadcast_rows,
    columns,
    limits_fit,
    middle_and_spans,
    motion,
    read_tree,
)
from walkgen.signature import STATUSES

_OK, _BAD_INPUT, _SINGULAR = (STATUSES.index(name) for name in ("OK", "BAD_INPUT", "SINGULAR"))


def adapt_velocity(
    geometry: ArrayLike,
    topology: ArrayLike,
    limits: ArrayLike,
    q: ArrayLike,
    xd: ArrayLike,
    qd0: ArrayLike,
    epsilon: ArrayLike,
    lambda_max: ArrayLike,
    nq: int,
    feet: int,
    platforms: int,
) -> tuple[Reals, Integers]:
    """Rates qd with J qd = xd and the least |qd - qd0| weighted by 1 / half^2, half a joint's range (pi or 1 m where it has none).

    The chain joints' rates cd are free, every leg follows: qd = qd_p + N cd, (N^T W N) cd = N^T W (qd0 - qd_p). Legs are inverted as
    damped_inverse_3 does. A chain joint whose limits are equal stands still.

    Args:
        geometry: as `adapt` takes it [..., 6 nq + 3 k + 12 m].
        topology: as `adapt` takes it [..., 2 nq + k + m].
        limits: lower and upper value of every joint [..., nq, 2]; infinite where there is none.
        q: joint values [..., nq].
        xd: velocities of the feet [..., k, 3], m/s, root platform's frame.
        qd0: wanted rates [..., nq].
        epsilon: the least singular value of a leg's Jacobian that is not damped [...].
        lambda_max: damping where a leg is singular [...].
        nq: number of joints.
        feet: k.
        platforms: m.

    Returns:
        qd [..., nq] and status [...]: OK; SINGULAR where a leg is damped, whose foot is then slower than asked; BAD_INPUT with NaN.
    """
    inputs = [np.asarray(item, float) for item in (geometry, topology, limits, q, xd, qd0, epsilon, lambda_max)]
    shape, rows = broadcast_rows(inputs, (1, 1, 2, 1, 2, 1, 0, 0))
    rates, status = np.empty((*shape, nq)), np.empty(shape, np.int32)
    for place in np.ndindex(shape):
        rates[place], status[place] = _answer([row[place] for row in rows], nq, feet, platforms)
    return rates, status


def _answer(row: Sequence[Reals], nq: int, feet: int, platforms: int) -> tuple[Reals, int]:
    """Of one row, BAD_INPUT with NaN where its input is bad or what comes out is no number."""
    numbers, links, bounds, values, speeds, wanted, least, most = row
    tree = read_tree(numbers, links, nq, feet, platforms)
    given = np.concatenate([values, speeds.ravel(), wanted])
    if tree is None or not (np.isfinite(given).all() and limits_fit(bounds)):
        return np.full(nq, np.nan), _BAD_INPUT
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # what is no number ends as BAD_INPUT
        found, state = _resolved(tree, bounds, values, speeds, wanted, (float(least), float(most)))
    return (found, state) if state != _BAD_INPUT and np.isfinite(found).all() else (np.full(nq, np.nan), _BAD_INPUT)


def _resolved(tree: Tree, limits: Reals, q: Reals, xd: Reals, qd0: Reals, damping: tuple[float, float]) -> tuple[Reals, int]:
    """The rates of one row, and its status."""
    at, chains = motion(tree, q), list(tree.chains)
    weight = middle_and_spans(tree, limits)[1] ** -2.0
    matrix, rhs = np.diag(weight[chains]), weight[chains] * qd0[chains]
    least, nulls, state = np.zeros(len(q)), {}, _OK
    for foot, leg in enumerate(tree.legs):
        path, point = tree.path(tree.bases[foot]), at.moved(leg[-1], tree.feet[foot])
        asked = np.column_stack([xd[foot], columns(tree, at, path, point)]).T
        found, states = damped_inverse_3(columns(tree, at, leg, point), asked, *damping)
        state = max(state, int(states.max()), key=(_OK, _SINGULAR, _BAD_INPUT).index)
        own, joints = [chains.index(joint) for joint in path], list(leg)
        least[joints], nulls[leg] = found[0], (own, -found[1:].T)
        matrix[np.ix_(own, own)] += nulls[leg][1].T @ (weight[joints, None] * nulls[leg][1])
        rhs[own] += nulls[leg][1].T @ (weight[joints] * (qd0[joints] - found[0]))
    if state == _BAD_INPUT:
        return least, state
    free = np.flatnonzero(limits[chains, 0] < limits[chains, 1])
    solved = cholesky(matrix[np.ix_(free, free)], rhs[free])
    if solved is None:
        return least, _BAD_INPUT
    rates = np.zeros(len(chains))
    rates[free] = solved
    least[chains] = rates
    for leg, (own, null) in nulls.items():
        least[list(leg)] += null @ rates[own]
    return least, state

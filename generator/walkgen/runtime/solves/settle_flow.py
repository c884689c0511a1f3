"""The velocity with which a tripod slides on a terrain, slowly enough for inertia not to count: the reference of walkgen_settle_flow.h."""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.stance import Reals, Stance

_SLOW = 1e-11
_STILL = 1e-7
_UNSEEN = 0.01 * np.finfo(float).eps
"""Of a cost near 1: what falls less is not seen to fall."""


@dataclass(frozen=True)
class Pose:
    """A pose [4, 4] with the stance there: normals [3, 3], friction [3], heights [3]."""

    pose: Reals
    stance: Stance
    normals: Reals
    mu: Reals
    gap: Reals


@dataclass(frozen=True)
class Slide:
    """A pose with the twist of its flow, whose fastest foot goes 1, zeros at rest; and the normal forces [3]."""

    here: Pose
    twist: Reals
    N: Reals

    @property
    def lifts(self) -> bool:
        """Whether a foot would have to pull."""
        return bool(self.N.min() < -_STILL)


def press(here: Pose) -> Reals:
    """Wrenches of unit normal forces, by columns."""
    return np.stack([here.stance.grasp[:, 3 * i : 3 * i + 3] @ here.normals[i] for i in range(3)], axis=1)


def flow(here: Pose) -> Slide:
    """Friction and normal forces found in turns."""
    columns = press(here)
    free = np.linalg.svd(columns.T)[2][3:].T
    carry = here.stance.grasp.T @ free
    N = _solved(columns, -here.stance.load)
    tau = np.zeros(3)
    slow = 0.1
    for _ in range(40):
        most = here.mu * np.maximum(N, 0.0)
        while slow > _SLOW:
            tau = _least(carry, most, free.T @ here.stance.load, tau, slow)
            slow = max(0.1 * slow, _SLOW)
        tau = _least(carry, most, free.T @ here.stance.load, tau, slow)
        V = (carry @ tau).reshape(3, 3)
        T = -(most / np.sqrt(np.sum(V**2, axis=1) + slow**2) + 1.0)[:, None] * V
        before = N
        N = _solved(columns, -here.stance.load - here.stance.grasp @ T.ravel())
        if np.abs(N - before).max() <= 1e-11:
            break
    fastest = float(np.linalg.norm(V, axis=1).max())
    return Slide(here, free @ tau / fastest if fastest > _STILL else np.zeros(6), N)


def _solved(columns: Reals, wrench: Reals) -> Reals:
    """Normal forces nearest to a wrench."""
    return np.asarray(np.linalg.lstsq(columns, wrench, rcond=None)[0], float)


def _least(carry: Reals, most: Reals, power: Reals, tau: Reals, slow: float) -> Reals:
    """tau of the least -power . tau + sum most sqrt(|V|^2 + slow^2) + sum |V|^2 / 2: Newton with halved steps."""

    def cost(tau: Reals) -> float:
        squares = np.sum((carry @ tau).reshape(3, 3) ** 2, axis=1)
        return float(most @ np.sqrt(squares + slow**2) + 0.5 * squares.sum() - power @ tau)

    for _ in range(50):
        V = (carry @ tau).reshape(3, 3)
        length = np.sqrt(np.sum(V**2, axis=1) + slow**2)
        share = (most / length + 1.0).repeat(3)
        along = np.stack([carry[3 * i : 3 * i + 3].T @ V[i] / length[i] for i in range(3)])
        slope = carry.T @ (share * V.ravel()) - power
        if np.linalg.norm(slope) <= 1e-11:
            break
        change = -np.linalg.solve(carry.T @ (share[:, None] * carry) - along.T @ ((most / length)[:, None] * along), slope)
        falls, factor = -slope @ change, 1.0
        while cost(tau + factor * change) > cost(tau):
            factor *= 0.5
            if factor * falls <= _UNSEEN:
                return tau
        tau = tau + factor * change
    return tau

"""Whether any forces in the feet's cones carry a load, whatever the legs; the reference of walkgen_contact_carried.h."""

import numpy as np

from walkgen.runtime.solves.contact_elastic import Stand
from walkgen.runtime.solves.rows import Reals

_SIGNIFICANT = 1e-10


def carried_lack(stand: Stand) -> float:
    """The size of what no forces carry of the load w: what stays of t while alpha shrinks in the least of

    |t|^2 / 2 - w t + sum |projection of -(G' t)_i on its cone|^2 / 2 alpha.
    """
    t, sizes = stand.w.copy(), [0.0, 0.0]
    for alpha in 0.1 ** np.arange(1, 9):
        t = _descended(stand, t, float(alpha))
        sizes.append(float(np.linalg.norm(t)))
    lasting = sizes[-1] > _SIGNIFICANT * np.linalg.norm(stand.w) and sizes[-1] > 0.5 * sizes[-2]
    return sizes[-1] if lasting else 0.0


def _descended(stand: Stand, t: Reals, alpha: float) -> Reals:
    """Newton's steps with a line search."""
    value, slope, curvature = _value(stand, t, alpha)
    for _ in range(40):
        step = -np.linalg.solve(curvature, slope)
        share = 1.0
        after = _value(stand, t + step, alpha)
        while not after[0] < value + 1e-4 * share * (slope @ step) and share > 1e-9:
            share *= 0.5
            after = _value(stand, t + share * step, alpha)
        if not after[0] < value:
            return t
        t, (value, slope, curvature) = t + share * step, after
    return t


def _value(stand: Stand, t: Reals, alpha: float) -> tuple[float, Reals, Reals]:
    """The value, its slope and its curvature."""
    pull = -(stand.grasp.T @ t).reshape(-1, 3)
    into, slopes = zip(*(_projected(n, mu, v) for n, mu, v in zip(stand.n, stand.mu, pull, strict=True)), strict=True)
    H = np.zeros((3 * len(into), 3 * len(into)))
    for foot, part in enumerate(slopes):
        H[3 * foot : 3 * foot + 3, 3 * foot : 3 * foot + 3] = part
    forces = np.concatenate(into)
    value = float(0.5 * t @ t - stand.w @ t + forces @ forces / (2.0 * alpha))
    return value, t - stand.w - stand.grasp @ forces / alpha, np.eye(6) + stand.grasp @ H @ stand.grasp.T / alpha


def _projected(n: Reals, mu: float, v: Reals) -> tuple[Reals, Reals]:
    """v on the cone of friction, and the projection's slope."""
    N = float(n @ v)
    T = v - N * n
    size = float(np.linalg.norm(T))
    flat = np.eye(3) - np.outer(n, n)
    if np.isinf(mu):
        return (v, np.eye(3)) if N > 0.0 else (T, flat)
    if size <= mu * N:
        return v, np.eye(3)
    along = (N + mu * size) / (1.0 + mu * mu)
    if along <= 0.0:
        return np.zeros(3), np.zeros((3, 3))
    t = T / size if size > 0.0 else T
    edge = n + mu * t
    round_ = along * mu / size * (flat - np.outer(t, t)) if size > 0.0 else np.zeros((3, 3))
    return along * edge, np.outer(edge, edge) / (1.0 + mu * mu) + round_

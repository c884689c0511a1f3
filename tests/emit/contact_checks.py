"""What forces and certificates must fulfil, written down without the solver's formulas: in NumPy for rows, in mpmath for one stance."""

import mpmath
import numpy as np
from scipy.linalg import null_space
from scipy.optimize import minimize

from contact_stances import grasp

LOAD_OF_PROOF = 1e-7
"""A certificate excludes forces up to the load over this."""


def loads(stances):
    """The size of every stance's load: of its force, or of its moment over the size of the stance."""
    arms = np.linalg.norm(stances.points - stances.points.mean(-2, keepdims=True), axis=-1).max(-1)
    moment = stances.wrench[:, 3:] - np.cross(stances.points.mean(-2), stances.wrench[:, :3])
    return np.maximum(np.linalg.norm(stances.wrench[:, :3], axis=-1), np.linalg.norm(moment, axis=-1) / np.maximum(arms, 1e-300))


def imbalance(stances, f):
    """|G f + wrench| about the centre, moments over the size of the stance, of the load."""
    centre = stances.points.mean(-2)
    arms = stances.points - centre[:, None]
    size = np.maximum(np.linalg.norm(arms, axis=-1).max(-1), 1e-300)
    force = f.sum(-2) + stances.wrench[:, :3]
    moment = np.cross(arms, f).sum(-2) + stances.wrench[:, 3:] - np.cross(centre, stances.wrench[:, :3])
    return np.maximum(np.linalg.norm(force, axis=-1), np.linalg.norm(moment, axis=-1) / size) / loads(stances)


def _sides(stances, facets):
    """Outward directions of the polygons' sides [rows,k,facets,3], the first along the frame's first axis as seen along the normal."""
    n = stances.normals
    axis = np.where(np.abs(n[..., :1]) > 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    along = axis - (n * axis).sum(-1, keepdims=True) * n
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    turn = 2.0 * np.pi / facets * np.arange(facets)[:, None]
    return np.cos(turn) * along[..., None, :] + np.sin(turn) * np.cross(n, along)[..., None, :]


def outside(stances, f, facets=0):
    """How far forces are outside of their cones and bounds, of the load; negative inside."""
    N = (stances.normals * f).sum(-1)
    if facets:
        T = np.einsum("rkfj,rkj->rkf", _sides(stances, facets), f).max(-1) / np.cos(np.pi / facets)
    else:
        T = np.linalg.norm(f - N[..., None] * stances.normals, axis=-1)
    return np.max([T - stances.mu * N, N - stances.n_max, -N], 0).max(-1) / loads(stances)


def optimality(stances, found):
    """Of OK stances with round cones, the worst of the conditions of the least force: stationarity and signs of multipliers.

    NaN where the bearing feet leave multipliers open.
    """
    rows, k = stances.mu.shape
    G, worst = grasp(stances.points), np.full(rows, np.nan)
    for row in range(rows):
        f, n, mu, state = found.f[row], stances.normals[row], stances.mu[row], found.state[row]
        size = loads(stances)[row] * stances.weight[row].max()
        columns, bears = [G[row].T], np.repeat(state != 2, 3)
        signed = 0
        for foot in range(k):
            N = n[foot] @ f[foot]
            T = f[foot] - N * n[foot]
            inward = {"slides": mu[foot] * n[foot] - T / max(np.linalg.norm(T), 1e-300), "bound": -n[foot]}
            for name, active in (("slides", state[foot] == 1), ("bound", stances.n_max[row, foot] <= N * (1.0 + 1e-9))):
                if active and state[foot] != 2:
                    columns.append(np.where(np.arange(3 * k) // 3 == foot, np.tile(inward[name], k), 0.0)[:, None])
                    signed += 1
        matrix, right = np.hstack(columns)[bears], (np.repeat(stances.weight[row], 3) * f.ravel())[bears]
        if np.linalg.matrix_rank(matrix, 1e-9) < matrix.shape[1]:
            continue
        multipliers = np.linalg.lstsq(matrix, right, rcond=None)[0]
        z = (G[row].T @ multipliers[:6]).reshape(k, 3)
        N = (z * n).sum(-1)
        pull = (N + mu * np.linalg.norm(z - N[:, None] * n, axis=-1))[state == 2]
        parts = [np.abs(matrix @ multipliers - right).max(), -multipliers[6:].min(initial=0.0), pull.max(initial=0.0)]
        worst[row] = max(parts) / size
    return worst


def refutation(stances, found, facets=0):
    """Negative where a certificate proves that no forces carry the load, of the sizes that a proof is asked for."""
    z = np.einsum("rij,ri->rj", grasp(stances.points), found.certificate).reshape(*stances.mu.shape, 3)
    N = (z * stances.normals).sum(-1)
    if facets:
        corners = _sides(stances, facets) + np.roll(_sides(stances, facets), 1, -2)
        corners /= np.linalg.norm(corners, axis=-1, keepdims=True)
        T = -np.einsum("rkfj,rkj->rkf", corners, z).min(-1)
    else:
        T = np.linalg.norm(z - N[..., None] * stances.normals, axis=-1)
    least = N - stances.mu * T
    bounded = np.isfinite(stances.n_max)
    gain = (stances.wrench * found.certificate).sum(-1) + np.where(
        bounded, np.minimum(least, 0.0) * np.where(bounded, stances.n_max, 0.0), 0.0
    ).sum(-1)
    free = np.where(bounded, 0.0, least).min(-1) * loads(stances)
    return np.where((gain > 0.0), -free - LOAD_OF_PROOF, np.inf)


def distance_from_cones(stance):
    """The least distance of balanced forces of one stance from its round cones, sought among all of them by L-BFGS."""
    G, n, mu = grasp(stance.points), stance.normals, stance.mu
    start, free = -np.linalg.pinv(G) @ stance.wrench, null_space(G)

    def off(x):
        f = (start + free @ x).reshape(-1, 3)
        N = (f * n).sum(-1)
        T = f - N[:, None] * n
        size = np.linalg.norm(T, axis=-1)
        inside = size <= mu * N
        along = np.maximum(N + mu * size, 0.0) / (1.0 + mu**2)
        edge = along[:, None] * (n + (mu / np.maximum(size, 1e-300))[:, None] * T)
        return np.where(inside[:, None], 0.0, f - edge).ravel()

    def half_square(x):
        rest = off(x)
        return 0.5 * rest @ rest, free.T @ rest

    options = {"maxiter": 5000, "ftol": 1e-15, "gtol": 1e-9 * np.linalg.norm(stance.wrench)}
    return np.sqrt(2.0 * minimize(half_square, np.zeros(free.shape[1]), jac=True, method="L-BFGS-B", options=options).fun)


def _exact_directions(n, facets, half):
    """Of a polygon's sides, or with `half` a step on of its corners, in the digits at hand."""
    axis = [mpmath.mpf(i == (1 if abs(n[0]) > 0.9 else 0)) for i in range(3)]
    along = [a - sum(b * c for b, c in zip(axis, n, strict=True)) * d for a, d in zip(axis, n, strict=True)]
    size = mpmath.sqrt(sum(a**2 for a in along))
    along = [a / size for a in along]
    aside = [n[(i + 1) % 3] * along[(i + 2) % 3] - n[(i + 2) % 3] * along[(i + 1) % 3] for i in range(3)]
    for side in range(facets):
        turn = 2 * mpmath.pi * (side + half) / facets
        yield [mpmath.cos(turn) * a + mpmath.sin(turn) * b for a, b in zip(along, aside, strict=True)]


def _exact_tangent(z, n, N):
    return mpmath.sqrt(sum((a - N * b) ** 2 for a, b in zip(z, n, strict=True)))


def _exact_width(z, n, facets, half):
    return max(sum(a * b for a, b in zip(z, way, strict=True)) for way in _exact_directions(n, facets, half))


def exactly_refuted(stance, certificate, facets=0):
    """In 50 digits, for one stance without bounds: a certificate's product with the load, with forces in cones or pyramids at least; its
    size.
    """
    with mpmath.workdps(50):
        c = [mpmath.mpf(float(value)) for value in certificate]
        size, least = mpmath.mpf(float(loads(stance)[0])), mpmath.inf
        for p, n, mu in zip(stance.points[0], stance.normals[0], stance.mu[0], strict=True):
            z = [c[i] + c[3 + (i + 1) % 3] * mpmath.mpf(p[(i + 2) % 3]) - c[3 + (i + 2) % 3] * mpmath.mpf(p[(i + 1) % 3]) for i in range(3)]
            normal = [mpmath.mpf(value) for value in n]
            N = sum(a * b for a, b in zip(z, normal, strict=True))
            half = mpmath.mpf(1) / 2
            T = _exact_width([-a for a in z], normal, facets, half) if facets else _exact_tangent(z, normal, N)
            least = min(least, (N - mpmath.mpf(mu) * T) * size)
        entries = mpmath.sqrt(sum(value**2 for value in c)) * size
        return float(sum(a * mpmath.mpf(b) for a, b in zip(c, stance.wrench[0], strict=True))), float(least), float(entries)


def exactly_carried(stance, f, facets=0):
    """In 50 digits, for one stance: what forces lack of the load, and how far they are outside of their cones or pyramids."""
    with mpmath.workdps(50):
        rest = [mpmath.mpf(value) for value in stance.wrench[0]]
        over = -mpmath.inf
        for p, n, mu, force in zip(stance.points[0], stance.normals[0], stance.mu[0], f, strict=True):
            point, normal, part = ([mpmath.mpf(float(value)) for value in vector] for vector in (p, n, force))
            for i in range(3):
                rest[i] += part[i]
                rest[3 + i] += point[(i + 1) % 3] * part[(i + 2) % 3] - point[(i + 2) % 3] * part[(i + 1) % 3]
            N = sum(a * b for a, b in zip(part, normal, strict=True))
            T = _exact_width(part, normal, facets, 0) / mpmath.cos(mpmath.pi / facets) if facets else _exact_tangent(part, normal, N)
            over = max(over, T - mpmath.mpf(mu) * N)
        return float(mpmath.sqrt(sum(value**2 for value in rest))), float(over)

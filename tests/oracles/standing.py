"""What a stance of sliding and lifted feet must fulfil, judged without walkgen; and all states of few feet tried one by one."""

from itertools import product

import numpy as np
from scipy.optimize import fsolve

from oracles.beam_frame import grasp, spread

STICK, SLIDE, FREE = range(3)


def broken(stance, f, state, displacement) -> float:
    """The largest breach, as a share of the load: balance, pulling, leaving the cone; sticking feet that move, lifted ones that are not,
    sliding ones that press in or are not rubbed against their way (displacements by the load's size times C's).
    """
    points, normals, mu, wrench, C, e = stance.given
    load = max(np.max(np.abs(wrench)), np.max(np.abs(e)) / np.max(np.abs(C)))
    yields = load * np.max(np.abs(C))
    G = grasp(points)
    u = (C @ f.ravel() + e.ravel() + G.T @ displacement).reshape(-1, 3)
    worst = [np.max(np.abs(G @ f.ravel() + wrench)) / load]
    for force, n, friction, kind, way in zip(f, normals, mu, state, u, strict=True):
        N, gap = force @ n, way @ n
        T, slip = force - N * n, way - gap * n
        worst += [-N / load, 0.0 if np.isinf(friction) else (np.linalg.norm(T) - friction * N) / load]
        if kind == STICK:
            worst.append(np.linalg.norm(way) / yields)
        elif kind == FREE:
            worst += [np.linalg.norm(force) / load, -gap / yields]
        else:
            size = np.linalg.norm(slip)
            worst += [abs(gap) / yields, np.linalg.norm(T * size + friction * N * slip) / (load * yields)]
    return float(max(worst))


def all_stands(stance, tries=6):
    """Forces of every stand found: each state of all feet, slides' directions by root finding from where sticking feet are pushed.

    Where fewer than six forces are unknown, the balance alone decides where feet slide, and the linear systems here are singular: such
    stands are not seen.
    """
    rng, found, k = np.random.default_rng(0), [], len(stance.mu)
    stuck = spread(stance.points, stance.compliance, stance.wrench, stance.misfit)[0]
    likely = np.array([np.arctan2(f @ _basis(n)[1], f @ _basis(n)[0]) for f, n in zip(stuck, stance.normals, strict=True)])
    for state in product((STICK, SLIDE, FREE), repeat=k):
        sliding = [i for i in range(k) if state[i] == SLIDE]
        for attempt in range(tries if sliding else 1):
            try:
                start = likely[sliding] + (attempt > 0) * rng.normal(size=len(sliding))
                angles = fsolve(_turned, start, (stance, state), xtol=1e-12) if sliding else []
                f, delta, _ = _linear(stance, state, angles)
            except np.linalg.LinAlgError:
                continue
            if broken(stance, f, state, delta) <= 1e-6 and not any(np.max(np.abs(f - other)) < 1e-2 for other in found):
                found.append(f)
    return found


def _basis(n):
    a = np.cross(n, [1.0, 0.0, 0.0] if abs(n[0]) < 0.7 else [0.0, 1.0, 0.0])
    a /= np.linalg.norm(a)
    return a, np.cross(n, a)


def _linear(stance, state, angles):
    """Forces and motion where sliding feet's friction points along given angles; displacements across those."""
    points, normals, mu, wrench, C, e = stance.given
    k, scale = len(mu), np.max(np.abs(C))
    G, angles = grasp(points), iter(angles)
    U = np.hstack([C, scale * G.T]) / scale
    system, right, across = np.zeros((3 * k + 6, 3 * k + 6)), np.zeros(3 * k + 6), []
    system[3 * k :, : 3 * k], right[3 * k :] = G, -wrench
    for i in range(k):
        own = slice(3 * i, 3 * i + 3)
        if state[i] == STICK:
            system[own], right[own] = U[own], -e[i] / scale
        elif state[i] == FREE:
            system[own, own] = np.eye(3)
        else:
            (a, b), angle = _basis(normals[i]), next(angles)
            t = np.cos(angle) * a + np.sin(angle) * b
            across.append((i, np.cross(normals[i], t)))
            system[3 * i], right[3 * i] = normals[i] @ U[own], -normals[i] @ e[i] / scale
            system[3 * i + 1, own], system[3 * i + 2, own] = across[-1][1], t - mu[i] * normals[i]
    x = np.linalg.solve(system, right)
    u = (U @ x + e.ravel() / scale).reshape(-1, 3)
    return x[: 3 * k].reshape(k, 3), scale * x[3 * k :], [u[i] @ q for i, q in across]


def _turned(angles, stance, state):
    return np.array(_linear(stance, state, angles)[2]) / np.max(np.abs(stance.wrench))

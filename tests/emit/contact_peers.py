"""Clarabel and HiGHS on the question whether feet can carry a load, as second opinions on the contact forces."""

import clarabel
import numpy as np
from contact_checks import loads
from scipy.optimize import linprog
from scipy.sparse import csc_matrix

from contact_stances import grasp

CARRIED, REFUTED, UNDECIDED = "carried", "refuted", "undecided"
_WORDS = {"Solved": CARRIED, "PrimalInfeasible": REFUTED}


def _scaled(stance):
    """Grasp map about the centre and the load over its size, of one stance."""
    centre = stance.points[0].mean(0)
    force, moment = stance.wrench[0, :3], stance.wrench[0, 3:] - np.cross(centre, stance.wrench[0, :3])
    return grasp(stance.points[0] - centre), np.concatenate([force, moment]) / loads(stance)[0]


def clarabel_settings():
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = settings.tol_infeas_abs = settings.tol_infeas_rel = 1e-10
    return settings


def by_clarabel(stance, settings):
    """The verdict on one stance with round cones, and the forces of least squares where it has them."""
    G, load = _scaled(stance)
    k = stance.mu.shape[1]
    rows, cones = [G], [clarabel.ZeroConeT(6)]
    for foot in range(k):
        n = stance.normals[0, foot]
        t = np.linalg.svd(n[None])[2][1:]
        block = np.zeros((3, 3 * k))
        block[:, 3 * foot : 3 * foot + 3] = -np.vstack([stance.mu[0, foot] * n, t])
        rows.append(block)
        cones.append(clarabel.SecondOrderConeT(3))
    right = np.concatenate([-load, np.zeros(3 * k)])
    P, A = csc_matrix(2.0 * np.eye(3 * k)), csc_matrix(np.vstack(rows))
    found = clarabel.DefaultSolver(P, np.zeros(3 * k), A, right, cones, settings).solve()
    return _WORDS.get(str(found.status), UNDECIDED), np.array(found.x).reshape(k, 3) * loads(stance)[0]


def by_highs(stance, facets):
    """The verdict on one stance with pyramids: the first edge half a side from the frame's first axis as seen along the normal."""
    G, load = _scaled(stance)
    edges = []
    for n, mu in zip(stance.normals[0], stance.mu[0], strict=True):
        axis = np.eye(3)[1 if abs(n[0]) > 0.9 else 0]
        along = axis - (axis @ n) * n
        along /= np.linalg.norm(along)
        turn = 2.0 * np.pi / facets * (np.arange(facets) + 0.5)[:, None]
        edges.append(n + mu * (np.cos(turn) * along + np.sin(turn) * np.cross(n, along)))
    rays = np.concatenate([G[:, 3 * foot : 3 * foot + 3] @ edge.T for foot, edge in enumerate(edges)], 1)
    found = linprog(np.ones(rays.shape[1]), A_eq=rays, b_eq=-load, method="highs", options={"primal_feasibility_tolerance": 1e-10})
    return {0: CARRIED, 2: REFUTED}.get(found.status, UNDECIDED)

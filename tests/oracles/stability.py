"""What static stability is, by other means: published numbers, hulls of scipy, rotations step by step, cone and linear programs."""

import clarabel
import numpy as np
from scipy import sparse
from scipy.optimize import linprog, minimize_scalar
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

# O15: four feet at different heights
O15_POINTS = np.array([[0.4, 0.3, 0.05], [-0.35, 0.32, -0.04], [-0.38, -0.3, 0.02], [0.42, -0.28, 0.10]])
O15_COM = np.array([0.05, 0.04, 0.45])
O15_STATIC = 0.26923762141370366
O15_LONGITUDINAL = np.array([0.3589655172413793, 0.41354838709677416])
O15_HEIGHTS = np.array([0.07559142149873388, 0.1568276935541038, 0.12109401869363268, 0.14281625335848636])
"""Of the edges 0-1, 1-2, 2-3, 3-0."""
O15_ENERGY = 44.493110694154765
"""Of 60 kg, J."""


def random_stand(rng, k: int):
    """Feet [k, 3] around a centre, at different heights, and a centre of mass above or beside them."""
    angle = 2.0 * np.pi * (np.arange(k) + rng.uniform(-0.4, 0.4, k)) / k
    radius = rng.uniform(0.1, 0.5, k)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(-0.1, 0.1, k)], axis=1)
    return points + rng.uniform(-0.3, 0.3, 3), np.append(rng.uniform(-0.2, 0.2, 2), rng.uniform(0.2, 0.6)) + points.mean(axis=0)


def hull_margin(points, com) -> float:
    """Signed distance in the plane from scipy's hull: the least over its lines inside, to its sides outside."""
    flat = points[:, :2]
    hull = ConvexHull(flat)
    beyond = hull.equations[:, :2] @ com[:2] + hull.equations[:, 2]
    if beyond.max() <= 0.0:
        return -float(beyond.max())
    sides = flat[hull.simplices]
    way = sides[:, 1] - sides[:, 0]
    share = np.clip(np.sum((com[:2] - sides[:, 0]) * way, axis=1) / np.sum(way**2, axis=1), 0.0, 1.0)
    return -float(np.linalg.norm(sides[:, 0] + share[:, None] * way - com[:2], axis=1).min())


def rise(first, second, com) -> float:
    """How much higher the centre of mass must go while it turns about the line from foot to foot until it is highest."""
    axis = (second - first) / np.linalg.norm(second - first)

    def lower(angle):
        return -(Rotation.from_rotvec(angle * axis).apply(com - first))[2]

    start = min(np.linspace(-np.pi, np.pi, 25), key=lower)
    found = minimize_scalar(lower, bounds=(start - 0.3, start + 0.3), method="bounded", options={"xatol": 1e-12})
    return -float(found.fun) - float(com[2] - first[2])


def frames(normals):
    """A normal and two tangents [k, 3, 3] by rows."""
    first = np.cross(normals, np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([normals, first, np.cross(normals, first)], axis=1)


def wrenches(points, normals):
    """Wrenches about the origin of unit forces along normals and tangents [6, 3k]."""
    directions = frames(normals).reshape(-1, 3)
    return np.concatenate([directions, np.cross(points.repeat(3, axis=0), directions)], axis=1).T


def cone_most(points, normals, mu, load, plane, u) -> float:
    """The most of u . y for which the feet carry load + plane y (plane [6, 2]) within their cones: Clarabel."""
    k = len(points)
    A = np.concatenate([wrenches(points, normals), plane], axis=1)
    cones = np.zeros((3 * k, 3 * k + 2))
    for foot in range(k):
        cones[3 * foot : 3 * foot + 3, 3 * foot : 3 * foot + 3] = np.diag([-mu[foot], -1.0, -1.0])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    size = np.concatenate([np.zeros(3 * k), -np.asarray(u)])
    matrix, right = sparse.csc_matrix(np.concatenate([A, cones])), np.concatenate([-load, np.zeros(3 * k)])
    kinds = [clarabel.ZeroConeT(6), *[clarabel.SecondOrderConeT(3)] * k]
    answer = clarabel.DefaultSolver(sparse.csc_matrix((3 * k + 2, 3 * k + 2)), size, matrix, right, kinds, settings).solve()
    return -float(answer.obj_val)


def pyramid_most(points, normals, mu, load, plane, u, facets, *, outer: bool) -> float:
    """The same with pyramids inside or around the cones: a linear program (HiGHS)."""
    angle = 2 * np.pi * np.arange(facets) / facets
    A = wrenches(points, normals)
    columns = []
    for foot in range(len(points)):
        width = mu[foot] / np.cos(np.pi / facets) if outer else mu[foot]
        columns.append(A[:, 3 * foot : 3 * foot + 1] + width * A[:, 3 * foot + 1 : 3 * foot + 3] @ np.array([np.cos(angle), np.sin(angle)]))
    whole = np.concatenate([*columns, plane], axis=1)
    cost = np.concatenate([np.zeros(whole.shape[1] - 2), -np.asarray(u)])
    bounds = [(0, None)] * (whole.shape[1] - 2) + [(None, None)] * 2
    found = linprog(cost, A_eq=whole, b_eq=-load, bounds=bounds, method="highs")
    assert found.status == 0, found.message
    return -float(found.fun)


def weight_plane():
    """Load of a unit weight above the origin, and by how much it changes with the centre of mass along x and y [6, 2]."""
    return np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0]), np.array([[0, 0], [0, 0], [0, 0], [0, -1.0], [1.0, 0], [0, 0]])


def push_plane(com, point, weight):
    """Load of a weight, and of unit forces along x and y at a point [6, 2]."""
    force = np.array([0.0, 0.0, -weight])
    pushes = [np.concatenate([axis, np.cross(point, axis)]) for axis in np.eye(3)[:2]]
    return np.concatenate([force, np.cross(com, force)]), np.array(pushes).T

"""A surface through heights on a square grid, and its point nearest to another; the reference of walkgen_heightmap.h.

Written the other way round than the C: heights beyond the edges are made up first, slopes at the points are a table, cells are Hermite's.
"""

import numpy as np

from walkgen.signature import STATUSES

_OK, _BAD_INPUT, _NO_CONVERGENCE = (STATUSES.index(name) for name in ("OK", "BAD_INPUT", "NO_CONVERGENCE"))
_STEPS = 60
_SLACK = 1e-9
_CONVEX = 1e-4
_HERMITE = np.array([[1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]], dtype=float)
"""Powers of t (rows: value and slope at the start, value and slope at the end)."""
_LINEAR = np.array([[1, -1, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]], dtype=float)


def heightmap(heights: np.ndarray, rows: int, columns: int, bicubic: int, grid: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Height and its derivatives x, y, xx, xy, yy over p: [..., 6].

    Args:
        heights: [rows * columns], m.
        rows: of the grid, along y.
        columns: of the grid, along x.
        bicubic: whether slopes are continuous; else bilinear.
        grid: x and y of the first height, spacing [..., 3], m.
        p: points [..., 3], m.
    """
    grid, p = np.broadcast_arrays(np.asarray(grid, float), np.asarray(p, float))
    spacing = grid[..., 2]
    with np.errstate(all="ignore"):
        place = (p[..., :2] - grid[..., :2]) / spacing[..., None]
    fine = np.isfinite(place).all(-1) & (spacing > 0)
    place = np.where(fine[..., None], place, 0.0)
    corners = _corners(np.reshape(heights, (rows, columns)))
    cell = np.clip(np.floor(place), 0, [columns - 2, rows - 2]).astype(int)
    patch = _patches(corners, cell)
    basis = _HERMITE if bicubic else _LINEAR
    x, y = (_powers(place[..., axis] - cell[..., axis]) @ basis.T for axis in (0, 1))
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    jet = np.stack([np.einsum("...i,...ij,...j->...", y[..., j, :], patch, x[..., i, :]) for i, j in orders], -1)
    scale = spacing[..., None] ** np.array([0, 1, 1, 2, 2, 2])
    return np.where(fine[..., None], jet / np.where(fine[..., None], scale, 1.0), np.nan)


def _corners(heights: np.ndarray) -> np.ndarray:
    """Value, slope along x, slope along y and mixed slope at every point: [rows, columns, 2 (y), 2 (x)], in spacings."""
    along_x = _slopes(heights)
    along_y = _slopes(heights.T).T
    both = _slopes(along_x.T).T
    return np.stack([np.stack([heights, along_x], -1), np.stack([along_y, both], -1)], -2)


def _slopes(values: np.ndarray) -> np.ndarray:
    """Central differences along the last axis, of a parabola at the ends."""
    if values.shape[-1] == 2:
        return np.repeat(values[:, 1:] - values[:, :1], 2, -1)
    before = 3 * values[:, :1] - 3 * values[:, 1:2] + values[:, 2:3]
    after = 3 * values[:, -1:] - 3 * values[:, -2:-1] + values[:, -3:-2]
    wide = np.concatenate([before, values, after], -1)
    central: np.ndarray = (wide[:, 2:] - wide[:, :-2]) / 2
    return central


def _patches(corners: np.ndarray, cell: np.ndarray) -> np.ndarray:
    """What Hermite's polynomials multiply: [..., 4 (y: value, slope at the start, at the end), 4 (x)]."""
    column, row = cell[..., 0], cell[..., 1]
    ends = [[corners[row + i, column + j] for j in (0, 1)] for i in (0, 1)]
    return np.concatenate([np.concatenate(line, -1) for line in ends], -2)


def _powers(t: np.ndarray) -> np.ndarray:
    """1, t, t^2, t^3 and their first and second derivatives: [..., 3, 4]."""
    one, nil = np.ones_like(t), np.zeros_like(t)
    return np.stack(
        [np.stack([one, t, t**2, t**3], -1), np.stack([nil, one, 2 * t, 3 * t**2], -1), np.stack([nil, nil, 2 * one, 6 * t], -1)], -2
    )


def heightmap_project(
    heights: np.ndarray, rows: int, columns: int, bicubic: int, grid: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The point of the surface nearest to p that descent from under p reaches [..., 3], and a status [...].

    Arguments are those of `heightmap`. OK; NO_CONVERGENCE where the distance still changes (at a crease of a bilinear map);
    BAD_INPUT and NaN where p is not finite.
    """
    grid, p = np.broadcast_arrays(np.asarray(grid, float), np.asarray(p, float))
    found = [_descend((heights, rows, columns, bicubic), *pair) for pair in zip(grid.reshape(-1, 3), p.reshape(-1, 3), strict=True)]
    feet, states = (np.array([one[part] for one in found]) for part in (0, 1))
    return feet.reshape(p.shape), states.astype(np.int32).reshape(p.shape[:-1])


def _descend(surface: tuple[np.ndarray, int, int, int], grid: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, int]:
    """Levenberg's damped Newton steps on half the squared distance, for one point."""
    foot, jet = _over(surface, grid, p[:2])
    if not np.isfinite(foot).all() or not np.isfinite(p).all():
        return np.full(3, np.nan), _BAD_INPUT
    damping = 1e-3
    for _ in range(_STEPS):
        gradient, metric, second = _derivatives(foot, jet, p)
        close = _is_small(gradient, metric, p, jet)
        step = np.linalg.solve(_convex(metric, second) + damping * np.diag(np.diag(metric)), -gradient)
        ahead, slopes = _over(surface, grid, foot[:2] + step)
        now = ((foot - p) ** 2).sum()
        if ((ahead - p) ** 2).sum() <= now + 8 * np.finfo(float).eps * now:
            foot, jet, damping = ahead, slopes, damping / 8
        else:
            damping = 8 * damping if damping > 1e-3 else 1e-2
        if close:
            break
    gradient, metric, _ = _derivatives(foot, jet, p)
    return foot, _OK if _is_small(gradient, metric, p, jet) else _NO_CONVERGENCE


def _over(surface: tuple[np.ndarray, int, int, int], grid: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    jet = heightmap(*surface, grid, np.array([*at, 0.0]))
    return np.array([*at, jet[0]]), jet


def _derivatives(foot: np.ndarray, jet: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gradient of half the squared distance over (x, y), first fundamental form, Hessian."""
    away = foot - p
    tangents = np.array([[1.0, 0.0, jet[1]], [0.0, 1.0, jet[2]]])
    metric = tangents @ tangents.T
    return tangents @ away, metric, metric + away[2] * np.array([[jet[3], jet[4]], [jet[4], jet[5]]])


def _convex(metric: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The Hessian where it is safely positive, else Gauss and Newton's."""
    diagonal = np.diag(second)
    return second if (diagonal > 0).all() and np.linalg.det(second) > _CONVEX * diagonal.prod() else metric


def _is_small(gradient: np.ndarray, metric: np.ndarray, p: np.ndarray, jet: np.ndarray) -> bool:
    size = 1 + np.abs(p).sum() + abs(jet[0])
    return bool((gradient**2 / np.diag(metric)).sum() <= (_SLACK * size) ** 2)

"""How far a target is from a leg's workspace: by cutting the leg plane into ever smaller cells, without derivatives or closed forms."""

import numpy as np
from anatomy import Anatomy

Array = np.ndarray
RINGS, SECTORS, LEVELS, KEPT = 24, 256, 20, 100


def least_distances(anatomy: Anatomy, p: Array, sheet: int) -> Array:
    """Distances [n] of targets [n,3] to the feet with this sign of rho (0: either); inf where there is none.

    A foot lies at distance hypot(rho, w) from axis 1 and at height h, with rho = a1 + r cos(angle), h = r sin(angle) and r between
    the folded and the stretched leg. Cells of (r, angle) are quartered and the most promising kept. Corners lie on both edges, so
    that the least sample is off by the square of the last cell's size, except where a sheet ends within a cell.
    """
    across, height = (values[:, None] for values in anatomy.around(p))
    a1, thigh, shank, w = anatomy.lengths
    shortest, longest = abs(thigh - shank), thigh + shank

    def distance(r: Array, angle: Array) -> Array:
        rho = a1 + r * np.cos(angle)
        found = np.hypot(np.hypot(rho, w) - across, r * np.sin(angle) - height)
        return np.where(rho * sheet >= 0, found, np.inf)

    extent, sector = (longest - shortest) / RINGS, 2 * np.pi / SECTORS
    grid = np.meshgrid(shortest + extent * np.arange(RINGS), sector * np.arange(SECTORS))
    r, angle = (np.broadcast_to(values.ravel(), (len(p), values.size)) for values in grid)
    best = np.full(len(p), np.inf)
    for _ in range(LEVELS):
        corners = [distance(r + i * extent, angle + j * sector) for i in (0, 1) for j in (0, 1)]
        promise = np.min(corners, axis=0)
        best = np.minimum(best, np.min(promise, axis=1))
        kept = np.argpartition(promise, KEPT, axis=1)[:, :KEPT]
        r, angle = np.take_along_axis(r, kept, 1), np.take_along_axis(angle, kept, 1)
        extent, sector = extent / 2, sector / 2
        r = np.concatenate([r, r + extent, r, r + extent], axis=1)
        angle = np.concatenate([angle, angle, angle + sector, angle + sector], axis=1)
    return best

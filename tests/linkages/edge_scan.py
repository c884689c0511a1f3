"""How close a leg of two drives comes to a target, by scans: within the drives' limits, and along the edges of what assembles."""

import numpy as np

CUTS, ROUNDS = 60, 16


class EdgeScan:
    """Of one leg and its limits [2, 2]; edges are found by bisection between drives that assemble and drives that do not."""

    def __init__(self, leg, limits, dense):
        self._leg, self._limits, self._dense = leg, limits, dense
        lines = [np.linspace(*limits[1 - axis], dense) for axis in (0, 1)]
        self._edges = [self._across(axis, lines[axis], limits[axis], dense) for axis in (0, 1)]
        self._grid = np.stack(np.meshgrid(*[np.linspace(*limit, dense) for limit in limits], indexing="ij"), -1).reshape(-1, 2)

    def closest(self, target):
        """The least distance."""
        found = [self._on_the_edge(target, axis) for axis in (0, 1)] + [self._inside(target)]
        return min(found)

    def _gap(self, q, target):
        gap = np.linalg.norm(self._leg.foot_position(q) - target, axis=-1)
        return np.where(np.isfinite(gap), gap, np.inf)

    def _drives(self, axis, values, others):
        q = np.empty((len(values), 2))
        q[:, axis], q[:, 1 - axis] = values, others
        return q

    def _across(self, axis, others, limits, dense):
        """Edges where one drive moves and the other has some values: the last drives that assemble."""
        ticks = np.linspace(*limits, dense)
        q = self._drives(axis, np.tile(ticks, len(others)), np.repeat(others, dense))
        there = np.isfinite(self._leg.foot_position(q)).all(-1).reshape(len(others), dense)
        row, place = np.nonzero(there[:, 1:] != there[:, :-1])
        first = there[row, place]
        inside, outside = np.where(first, ticks[place], ticks[place + 1]), np.where(first, ticks[place + 1], ticks[place])
        for _ in range(CUTS):
            middle = (inside + outside) / 2
            fine = np.isfinite(self._leg.foot_position(self._drives(axis, middle, others[row]))).all(-1)
            inside, outside = np.where(fine, middle, inside), np.where(fine, outside, middle)
        return self._drives(axis, inside, others[row])

    def _apart(self, points, gap, count):
        """The closest of points that are not next to each other."""
        chosen = []
        for place in np.argsort(gap)[:2000]:
            away = [np.abs((points[place] - points[other]) / np.ptp(self._limits, axis=1)).max() for other in chosen]
            if np.isfinite(gap[place]) and min(away, default=1) > 0.05:
                chosen.append(place)
            if len(chosen) == count:
                break
        return chosen

    def _on_the_edge(self, target, axis):
        points, other, width = self._edges[axis], 1 - axis, np.ptp(self._limits, axis=1)
        gap, best = self._gap(points, target), np.inf
        for start in self._apart(points, gap, 3):
            at, least, half = points[start], gap[start], 2 * width / self._dense
            for _ in range(ROUNDS):
                others = np.clip(np.linspace(at[other] - half[other], at[other] + half[other], 15), *self._limits[other])
                near = np.clip([at[axis] - 20 * half[axis], at[axis] + 20 * half[axis]], *self._limits[axis])
                found = self._across(axis, others, near, 40)
                gaps = self._gap(found, target)
                if len(gaps) and gaps.min() < least:
                    at, least = found[gaps.argmin()], gaps.min()
                half = half / 3
            best = min(best, least)
        return best

    def _inside(self, target):
        """Within the limits, their sides included, by finer and finer grids."""
        gap, best = self._gap(self._grid, target), np.inf
        for start in self._apart(self._grid, gap, 3):
            at, least, half = self._grid[start], gap[start], 2 * np.ptp(self._limits, axis=1) / self._dense
            for _ in range(2 * ROUNDS):
                low, high = (np.clip(at + sign * half, *self._limits.T) for sign in (-1, 1))
                finer = np.stack(np.meshgrid(*np.linspace(low, high, 15).T, indexing="ij"), -1).reshape(-1, 2)
                gaps = self._gap(finer, target)
                if gaps.min() < least:
                    at, least = finer[gaps.argmin()], gaps.min()
                half = half / 2
            best = min(best, least)
        return best

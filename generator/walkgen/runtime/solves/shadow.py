"""Which mixtures of two wrenches feet can carry on top of a load, a convex region of a plane: the reference of walkgen_shadow.h.

Every direction gives a point of the region's border and a line that it does not cross (Bretl and Lall 2008).
"""

from dataclasses import dataclass, field

import numpy as np

from walkgen.runtime.solves.friction_needed import Carrying, frame_of, greatest
from walkgen.runtime.solves.stance import INFEASIBLE, NO_CONVERGENCE, OK, SINGULAR, Reals, Stance

MOST_DIRECTIONS = 64
_PROBES = 128
_STEEP = 1e-7
_NONE = 1e-10
_SHARP = 1e-11
_FAIR = 1e-7
_FAR = 1e3
_SPARE = 1e-4
_SAME = 1e-12
_ROUND = 2e-3
Seen = tuple[Reals, Reals, float, bool]
"""A direction, the point farthest in it, how far that is, and whether it is open."""


@dataclass
class Shadow:
    """The mixtures of two wrenches that feet can carry on top of a load: directions, the points farthest in them, how far these are, and
    whether they are open: limited only by normal forces of 1e3 loads in sum, by which feet press against each other.

    Attributes:
        columns: wrenches of the feet's forces in a basis of those that they can give [rank, 3k].
        load: in that basis [rank].
        plane: the two wrenches in it, by columns [rank, 2].
    """

    columns: Reals
    load: Reals
    plane: Reals
    known: list[Seen] = field(default_factory=list)

    def spare(self, count: int) -> float | None:
        """The greatest normal force that every foot can have above what its friction needs, with `count` wrenches free."""
        rows = _complement(self.plane[:, :count])
        lift = self.columns[:, ::3].sum(axis=1)
        s, _, _, closed = greatest(Carrying(rows @ self.columns, -rows @ self.load), rows @ lift, 1.0)
        return s if closed or s > 1.0 else None

    def look(self, u: Reals) -> bool:
        """One more direction: whether it tells anything."""
        if len(self.known) == MOST_DIRECTIONS or any(abs(turn(u, v)) <= _SAME and u @ v > 0.0 for v, *_ in self.known):
            return False
        found = self.probe(u)
        if found is None:
            return False
        self.known.append(found)
        self.known.sort(key=lambda item: float(np.arctan2(item[0][1], item[0][0])) % (2.0 * np.pi))
        return True

    def probe(self, u: Reals) -> Seen | None:
        """What a direction tells, None where no answer was found."""
        across = np.array([-u[1], u[0]])
        gone, sought = self.plane @ across, self.plane @ u
        rows, forces = _complement(gone[:, None]), self.columns.shape[1]
        bound = np.concatenate([np.where(np.arange(forces) % 3 == 0, 1.0 / _FAR, 0.0), [1.0, 0.0, 0.0]])
        columns = np.concatenate([np.concatenate([rows @ self.columns, np.zeros((len(rows), 3))], axis=1), bound[None]])
        s, x, _, closed = greatest(Carrying(columns, np.append(-rows @ self.load, 1.0)), np.append(rows @ sought, 0.0), np.inf)
        if not closed:
            return None
        aside = float(gone @ (-self.load - s * sought - self.columns @ x[:forces]) / (gone @ gone))
        return u, s * u + aside * across, s, bool(x[forces] < _SPARE)

    def margin(self, start: Reals) -> tuple[float, Reals, int]:
        """Signed distance of a point from the region's border, the way out and a status."""
        for _ in range(MOST_DIRECTIONS + 1):
            least, toward = _way_out(np.array([item[1] for item in self.known]), start)
            best = min(self.known, key=lambda seen: _bound(seen, start))
            sharp = _bound(best, start) - least <= _SHARP * (1.0 + abs(least))
            if sharp or not self.look(toward):
                break
        if not _bound(best, start) - least <= _FAIR * (1.0 + abs(least)) + _ROUND * abs(_bound(best, start)):
            return np.nan, np.full(2, np.nan), NO_CONVERGENCE
        best = best if sharp else self._lowest(start, best)
        return (np.inf, np.zeros(2), OK) if best[3] else (_bound(best, start), best[0], OK)

    def _lowest(self, start: Reals, best: Seen) -> Seen:
        """The direction of the least bound, also between two known ones where bounds fall and rise again: by the normal of their points."""
        spent = 0
        for here, there in zip(self.known, (*self.known[1:], self.known[0]), strict=True):
            before, after = here, there
            while spent < _PROBES and _slope(before, start) < -_FAIR and _slope(after, start) > _FAIR:
                normal, length = normal_of(before[1], after[1])
                lower = length > _SHARP and normal @ (before[1] - start) < _bound(best, start) - _SHARP
                found = self.probe(normal) if lower else None
                if found is None:
                    break
                spent += 1
                best = min(best, found, key=lambda seen: _bound(seen, start))
                before, after = (found, after) if _slope(found, start) < 0.0 else (before, found)
        return best

    def refine(self, tolerance: float) -> float:
        """The polygon of points brought within a distance of the region: how far it may be."""
        for _ in range(MOST_DIRECTIONS + 1):
            largest, normal = max((self._gap(side) for side in range(len(self.known))), key=lambda gap: gap[0])
            if largest <= tolerance or not self.look(normal):
                break
        return np.inf if any(is_open for *_, is_open in self.known) else largest

    def _gap(self, side: int) -> tuple[float, Reals]:
        (u, a, *_), (v, b, *_) = self.known[side], self.known[(side + 1) % len(self.known)]
        normal, length = normal_of(a, b)
        before, after = turn(u, normal), turn(normal, v)
        return (length * before * after / turn(u, v) if min(before, after) > 0.0 else 0.0), normal


def _bound(seen: Seen, start: Reals) -> float:
    """How far a point is from the line that the region does not cross."""
    return float(seen[2] - seen[0] @ start)


def _slope(seen: Seen, start: Reals) -> float:
    """Of the bound, by the direction's angle."""
    return turn(seen[0], seen[1] - start)


def shadow_of(stance: Stance, normals: Reals, mu: Reals, plane: Reals, free: int) -> Shadow | int:
    """The region by four directions, of two wrenches [2, 6] in the stance's units, `free` of which may be any, or why there is none."""
    frames = np.array([frame_of(normal) for normal in normals])
    columns = np.concatenate([stance.grasp[:, 3 * i : 3 * i + 3] @ frames[i].T for i in range(len(normals))], axis=1)
    size = np.stack([np.ones_like(mu), mu, mu], axis=-1).ravel()
    U, singular, _ = np.linalg.svd(columns * (size > 0.0))
    kept = U[:, : np.count_nonzero(singular > _STEEP)]
    if np.linalg.norm(stance.load - kept @ (kept.T @ stance.load)) > _NONE:
        return INFEASIBLE
    if np.linalg.norm(plane - plane @ kept @ kept.T) > _NONE:
        return SINGULAR
    shadow = Shadow(kept.T @ (columns * size), kept.T @ stance.load, kept.T @ plane.T)
    spare = shadow.spare(free)
    if spare is None or spare < -_NONE:
        return NO_CONVERGENCE if spare is None else INFEASIBLE
    if not all(shadow.look(np.array(u)) for u in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))):
        return NO_CONVERGENCE if spare > _NONE else SINGULAR
    points = [point for _, point, *_ in shadow.known]
    area = sum(turn(a, b) for a, b in zip(points, (*points[1:], points[0]), strict=True))
    return SINGULAR if spare <= _NONE and area <= _NONE else shadow


def _complement(vectors: Reals) -> Reals:
    """An orthonormal basis, by rows, of what is across the columns [n, c]."""
    return np.asarray(np.linalg.qr(vectors, mode="complete")[0][:, vectors.shape[1] :].T)


def _way_out(polygon: Reals, start: Reals) -> tuple[float, Reals]:
    """How far it is from a point out of a polygon [n, 2], negative from outside, and the unit vector that way."""
    sides = [(a, *normal_of(a, b), b) for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)]
    insides = [(float(normal @ (a - start)), normal) for a, normal, length, _ in sides if length > _SHARP]
    least, normal = min(insides, key=lambda pair: pair[0]) if insides else (-np.inf, np.array([1.0, 0.0]))
    if least >= 0.0:
        return least, normal
    away = min((start - nearest(a, b, start) for a, _, _, b in sides), key=lambda way: float(np.linalg.norm(way)))
    far = float(np.linalg.norm(away))
    return -far, away / far if far > _SHARP else normal


def nearest(a: Reals, b: Reals, point: Reals) -> Reals:
    """The point of a side [2] that is nearest."""
    square = float((b - a) @ (b - a))
    share = np.clip((point - a) @ (b - a) / square, 0.0, 1.0) if square > 0.0 else 0.0
    return np.asarray(a + share * (b - a))


def normal_of(a: Reals, b: Reals) -> tuple[Reals, float]:
    """The outward normal of a polygon's side, and its length."""
    way = b - a
    length = float(np.hypot(*way))
    return (np.array([way[1], -way[0]]) / length if length > 0.0 else np.zeros(2)), length


def turn(a: Reals, b: Reals) -> float:
    """a x b of two vectors [2]."""
    return float(a[0] * b[1] - a[1] * b[0])

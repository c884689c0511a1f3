"""Legs that follow their platform: each foot stays at its target while chain joints move; the reference of walkgen_adapt_legs.h.

A leg is continued by Newton from its last pose; where that does not reach the target to rounding, or leads far away, the closed form
(of a leg that functions describe, one of them) gives all poses, of which the nearest on the same sheet (sign of det J) counts.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.inverse_general import inverse_general
from walkgen.runtime.solves.spatial import Chain, Reals, dot, motion, nearest
from walkgen.runtime.solves.tree import Integers, Motion, Tree
from walkgen.signature import STATUSES

_OK, _BAD_INPUT, _SINGULAR, _INFEASIBLE = (STATUSES.index(name) for name in ("OK", "BAD_INPUT", "SINGULAR", "INFEASIBLE"))
_STEPS = 8
_NEARBY = 0.5
_REGULAR = 1e-9
_ROUNDINGS = 64.0 * float(np.finfo(float).eps)


@dataclass(frozen=True)
class Driven:
    """A leg that functions describe instead of its axes, in the frame of its platform.

    `motion` gives the foot, its Jacobian and second derivatives [..., 39] at q [..., 3]; `rows` the poses [n, 3] and their statuses [n] at
    a target with a seed [6]; `somewhere` one pose, for where none of those is known. `rotation` and `origin`: the frame at q = 0.
    """

    motion: Callable[[Reals], Reals]
    rows: Callable[[Reals], tuple[Reals, Integers]]
    somewhere: Callable[[Reals], tuple[Reals, Integers]]
    rotation: Reals
    origin: Reals

    def foot(self, q: Reals) -> tuple[Reals, Reals, Reals]:
        """As `spatial.motion`; NaN and no derivatives where there is no foot."""
        values = self.motion(q)
        fine = np.isfinite(values).all(axis=-1, keepdims=True)
        values = np.where(fine, values, 0.0)
        foot, bends = values[..., :3, None], values[..., 12:].reshape(*values.shape[:-1], 3, 9)
        turned = [self.rotation @ part for part in (foot, values[..., 3:12].reshape(*bends.shape[:-1], 3), bends)]
        return np.where(fine, self.origin + turned[0][..., 0], np.nan), turned[1], turned[2].reshape(*bends.shape[:-1], 3, 3)

    def poses(self, target: Reals, seed: Reals, *, somewhere: bool = False) -> tuple[Reals, Integers]:
        """At a target, turned back to q = 0."""
        aim = np.concatenate([self.rotation.T @ (target - self.origin), seed])
        return (self.somewhere if somewhere else self.rows)(aim)


@dataclass(frozen=True)
class Leg:
    """A foot's last three joints at q = 0, and how their poses are compared.

    `sequence` as inverse_general takes it; `base`: the joint that carries the leg; `reach`: the longest lever of a turning joint, or 1;
    `spans` [3]: the unit of each joint's distance; `driven`: what describes it instead of axes.
    """

    chain: Chain
    geometry: Reals
    sequence: int
    joints: tuple[int, int, int]
    base: int
    reach: float
    spans: Reals
    driven: Driven | None = None


@dataclass(frozen=True)
class LegPose:
    """Joint values [3]; how far the foot is from its target (root platform's axes) [3]; the sign of det J, 0 near singular poses."""

    q: Reals
    gap: Reals
    sheet: int


def leg_of(tree: Tree, foot: int, spans: Reals, driven: Driven | None = None) -> Leg:
    """The leg of a foot; `spans` [nq] holds the unit of every joint's distance."""
    joints = list(tree.legs[foot])
    kinds = "".join("R" if tree.turns[joint] else "P" for joint in joints)
    levers = np.linalg.norm(np.cross(tree.axes[joints], tree.feet[foot] - tree.points[joints]), axis=-1)
    longest = float(np.max(np.where(tree.turns[joints], levers, 0.0)))
    chain = Chain(kinds, tree.axes[joints], tree.points[joints], tree.feet[foot], driven.foot if driven else None)
    own = tree.leg_geometry(foot), tree.sequence(foot), tree.legs[foot], tree.bases[foot], longest or 1.0, spans[joints]
    return Leg(chain, *own, driven)


def closed(leg: Leg, at: Motion, target: Reals, reference: Reals) -> LegPose | None:
    """The pose of the closed form nearest to a reference: one that reaches the target, a regular one first; None where q is no number."""
    aim = at.moved_back(leg.base, target)
    rows, status = _rows(leg, aim, reference)
    if (status == _BAD_INPUT).any():
        return None
    reaching = (status == _OK) | (status == _SINGULAR)
    if leg.driven and not reaching.any():
        q = _nearby(leg, leg.driven, aim, reference, rows)
        if q is None:
            return None
        rows, reaching = q[None], np.array([_there(leg, aim, float(np.linalg.norm(motion(leg.chain, q)[0] - aim)))])
    poses = [_pose(leg, at, target, _unwound(leg, row, reference)) for row in rows[reaching if reaching.any() else slice(None)]]
    regular = [pose for pose in poses if pose.sheet != 0]
    best = min(regular or poses, key=lambda pose: _distance(leg, pose.q, reference))
    return LegPose(best.q, np.zeros(3), best.sheet) if reaching.any() else best


def _rows(leg: Leg, aim: Reals, seed: Reals) -> tuple[Reals, Integers]:
    """All poses at a target, turned back to q = 0; near a seed where they are not all known.

    Where a leg's drives stand in a dead point they hold no foot there, and the pose is INFEASIBLE.
    """
    if leg.driven is None:
        return inverse_general(leg.geometry, aim, leg.sequence)
    rows, status = leg.driven.poses(aim, seed)
    there = np.linalg.norm(motion(leg.chain, rows)[0] - aim, axis=-1) <= _REGULAR * leg.reach
    return rows, np.where(((status == _OK) | (status == _SINGULAR)) & ~there, _INFEASIBLE, status)


def _nearby(leg: Leg, driven: Driven, aim: Reals, reference: Reals, rows: Reals) -> Reals | None:
    """A pose that comes as close as any nearby, from that of the rows and of the reference, or of somewhere else, that is closest."""
    tried = np.array([reference, *(_unwound(leg, row, reference) for row in rows)])
    gaps = np.linalg.norm(motion(leg.chain, tried)[0] - aim, axis=-1)
    if not np.isfinite(gaps).any():
        tried = _unwound(leg, driven.poses(aim, reference, somewhere=True)[0], reference)
        gaps = np.linalg.norm(motion(leg.chain, tried)[0] - aim, axis=-1)
    if not np.isfinite(gaps).any():
        return None
    return nearest(leg.chain, aim, tried[np.nanargmin(gaps)], 3)[0]


def _there(leg: Leg, aim: Reals, gap: float) -> bool:
    """Down to rounding."""
    return bool(gap <= _ROUNDINGS * (np.sum(np.abs(leg.chain.foot)) + np.sum(np.abs(aim))))


def followed(leg: Leg, at: Motion, target: Reals, last: LegPose) -> LegPose | None:
    """The pose that continues the last one; None where the target is out of reach on its sheet."""
    aim = at.moved_back(leg.base, target)
    q, reached = _newton(leg, aim, last.q)
    units = np.array([leg.reach if kind == "P" else 1.0 for kind in leg.chain.kinds])
    if reached and np.max(np.abs(q - last.q) / units) <= _NEARBY and _sheet(leg, motion(leg.chain, q)[1]) == last.sheet:
        return LegPose(q, np.zeros(3), last.sheet)
    rows, status = _rows(leg, aim, last.q)
    values = [_unwound(leg, row, last.q) for row, state in zip(rows, status, strict=True) if state == _OK]
    values = [value for value in values if _sheet(leg, motion(leg.chain, value)[1]) == last.sheet]
    if not values:
        return None
    return LegPose(min(values, key=lambda value: _distance(leg, value, last.q)), np.zeros(3), last.sheet)


def _newton(leg: Leg, aim: Reals, q: Reals) -> tuple[Reals, bool]:
    """Newton on the foot's position as long as the gap halves; whether it is down to rounding."""
    foot, jacobian, _ = motion(leg.chain, q)
    gap = np.linalg.norm(foot - aim)
    for _ in range(_STEPS):
        determinant, minors = _cramer(jacobian)
        if gap == 0.0 or not abs(determinant) > 0.0:
            break
        tried = q - minors @ (foot - aim) / determinant
        foot_after, jacobian_after, _ = motion(leg.chain, tried)
        left = np.linalg.norm(foot_after - aim)
        if not left < gap:
            break
        slow = left > 0.5 * gap
        q, foot, jacobian, gap = tried, foot_after, jacobian_after, left
        if slow:
            break
    return q, _there(leg, aim, float(gap))


def _cramer(jacobian: Reals) -> tuple[float, Reals]:
    a, b, c = jacobian.T
    minors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    return float(dot(a, minors[0])), minors


def _sheet(leg: Leg, jacobian: Reals) -> int:
    """The sign of det J, 0 where it is small against the leg's reach."""
    units = np.array([1.0 if kind == "P" else leg.reach for kind in leg.chain.kinds])
    determinant, _ = _cramer(jacobian / units)
    return 0 if not abs(determinant) > _REGULAR else 1 if determinant > 0.0 else -1


def _pose(leg: Leg, at: Motion, target: Reals, q: Reals) -> LegPose:
    foot, jacobian, _ = motion(leg.chain, q)
    return LegPose(q, at.moved(leg.base, foot) - target, _sheet(leg, jacobian))


def _unwound(leg: Leg, q: Reals, reference: Reals) -> Reals:
    """Turning joints by full turns as near to the reference as they come."""
    turning = np.array([kind == "R" for kind in leg.chain.kinds])
    return np.where(turning, q - 2.0 * np.pi * np.round((q - reference) / (2.0 * np.pi)), q)


def _distance(leg: Leg, q: Reals, reference: Reals) -> float:
    share = (q - reference) / leg.spans
    return float(share @ share)

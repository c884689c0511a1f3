"""All joint values of any leg of one to three joints that reach a foot position: the reference of walkgen_inverse_general.h."""

from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.runtime.solves.elimination import candidates
from walkgen.runtime.solves.spatial import Chain, Reals, angle_about, dot, foot_of, motion, moved, nearest, norm
from walkgen.signature import STATUSES

Integers = NDArray[np.int32]

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR, _DUPLICATE = (
    STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "DUPLICATE")
)
_TOLERANCE = 1e-12
_SAME = 1e-7
_RANK = 1e-6
_TURNS = np.arange(12) * (2.0 * np.pi / 12.0)
_SLIDES = np.array([-1.0, 0.0, 1.0])
_STARTS = 10
_NUDGES = 0.1, 0.03, 0.009
_SLOTS = {"RRR": 4, "RRP": 4, "RPR": 4, "PRR": 4, "RPP": 2, "PRP": 2, "PPR": 2, "RR": 2, "RP": 2, "PR": 2}  # others have one


def kinds_of(sequence: int) -> str:
    """The joints' letters: binary digits after the leading 1, base to foot, 0 for R and 1 for P."""
    return "".join("RP"[int(digit)] for digit in f"{sequence:b}"[1:])


def slots_of(kinds: str) -> int:
    """How many branches a leg with these joints has at most."""
    return _SLOTS.get(kinds, 1)


def inverse_general(geometry: ArrayLike, p: ArrayLike, sequence: int) -> tuple[Reals, Integers]:
    """All solutions, sorted by their joint values.

    Args:
        geometry: for every joint its unit axis, positive for growing q, and a point on it at q = 0, then the foot at q = 0 [..., 6 n + 3].
        p: the foot's target [..., 3], m.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides (RRR is 8).

    Returns:
        q [..., b, n] and status [..., b]: OK; SINGULAR where q is not isolated (a free joint is 0); DUPLICATE where it repeats the slot
        before; UNREACHABLE where no solution is left: the first one again, or the closest q of all where there is none; BAD_INPUT with NaN.
    """
    kinds = kinds_of(sequence)
    numbers, targets = np.asarray(geometry, float), np.asarray(p, float)
    shape = np.broadcast_shapes(numbers.shape[:-1], targets.shape[:-1])
    numbers, targets = (np.broadcast_to(item, (*shape, item.shape[-1])).reshape(-1, item.shape[-1]) for item in (numbers, targets))
    n, slots = len(kinds), slots_of(kinds)
    q, status = np.full((len(targets), slots, n), np.nan), np.full((len(targets), slots), _BAD_INPUT, np.int32)
    fine = np.isfinite(numbers).all(axis=-1) & np.isfinite(targets).all(axis=-1)
    if fine.any():
        q[fine], status[fine] = _solved(kinds, numbers[fine], targets[fine])
    finite = np.isfinite(q).all(axis=-1)
    q, status = np.where(finite[..., None], q, np.nan), np.where(finite, status, _BAD_INPUT).astype(np.int32)
    return q.reshape(*shape, slots, n), status.reshape(*shape, slots)


def inverse_general_branch(geometry: ArrayLike, p: ArrayLike, sequence: int, branch: ArrayLike) -> tuple[Reals, Integers]:
    """One row by its index [...]: q [..., n] and status [...]; another index is BAD_INPUT."""
    rows, states = inverse_general(geometry, p, sequence)
    index = np.asarray(branch)
    known = (index >= 0) & (index < states.shape[-1])
    shape = np.broadcast_shapes(states.shape[:-1], index.shape)
    place = np.broadcast_to(np.where(known, index, 0), shape)[..., None]
    q = np.take_along_axis(np.broadcast_to(rows, (*shape, *rows.shape[-2:])), place[..., None], axis=-2)[..., 0, :]
    status = np.take_along_axis(np.broadcast_to(states, (*shape, states.shape[-1])), place, axis=-1)[..., 0]
    return np.where(known[..., None], q, np.nan), np.where(known, status, _BAD_INPUT).astype(np.int32)


def _solved(kinds: str, numbers: Reals, targets: Reals) -> tuple[Reals, Integers]:
    chain, target, size, tolerance = _canonical(kinds, numbers, targets)
    poses, gaps = _polished(chain, target, _candidates(chain, target))
    q, status = np.empty((len(target), slots_of(kinds), len(kinds))), np.empty((len(target), slots_of(kinds)), np.int32)
    for row in range(len(target)):
        one, aim, limit = chain.take(np.array([row])), target[row : row + 1], float(tolerance[row])
        found, gap = poses[row], gaps[row]
        if not np.any(gap <= limit):
            more = _polished(one, aim, _grid(one, aim))
            found, gap = (np.concatenate([old, new[0]]) for old, new in zip((found, gap), more, strict=True))
        exact = bool(np.min(gap) <= limit)
        order = np.argsort(gap, kind="stable")  # best first: of poses that are one, the sharpest is kept
        found, gap = found[order], gap[order]
        q[row], status[row] = _slots(one, aim, found[gap <= (limit if exact else gap[0] + 0.01 * limit)], exact, limit)
    sliding = np.array([kind == "P" for kind in kinds])
    return np.where(sliding, np.ldexp(q, size[:, None, None]), q), status


def _canonical(kinds: str, numbers: Reals, targets: Reals) -> tuple[Chain, Reals, NDArray[np.int32], Reals]:
    """The chain seen from its first point, points slid along their axes next to each other, scaled to size about 1; 1e-12 of the reach.

    A target very far from a leg without sliding joints comes nearer: only its direction counts.
    """
    n = len(kinds)
    parts = numbers[:, : 6 * n].reshape(-1, n, 2, 3)
    axes, base = parts[:, :, 0], parts[:, :1, 1]
    points, foot, target = parts[:, :, 1] - base, numbers[:, 6 * n :] - base[:, 0], targets - base[:, 0]
    lengths = np.concatenate([points.reshape(len(foot), -1), foot, target * ("P" in kinds)], axis=-1)
    _, size = np.frexp(np.max(np.abs(lengths), axis=-1))
    far = np.maximum(np.frexp(np.max(np.abs(target), axis=-1))[1] - size - 20, 0)
    points, foot, target = np.ldexp(points, -size[:, None, None]), np.ldexp(foot, -size[:, None]), np.ldexp(target, -(size + far)[:, None])
    beyond, reach = foot, norm(target) * ("P" in kinds)
    for joint in range(n - 1, -1, -1):
        slid = points[:, joint] + dot(axes[:, joint], beyond - points[:, joint])[:, None] * axes[:, joint]
        points[:, joint] = slid if kinds[joint] == "R" else beyond
        reach = reach + norm(beyond - points[:, joint])
        beyond = points[:, joint]
    return Chain(kinds, axes, points, foot), target, size, _TOLERANCE * reach


def _candidates(chain: Chain, target: Reals) -> Reals:
    if len(chain.kinds) < 3 or chain.kinds == "PPP":
        return _grid(chain, target)
    if chain.kinds in ("PPR", "RRP"):
        return candidates(chain.reversed(target), chain.foot)[..., ::-1]
    return candidates(chain, target)


def _polished(chain: Chain, target: Reals, starts: Reals) -> tuple[Reals, Reals]:
    """Nearest of all starts [rows, m, n] that are numbers; NaN and infinite distance for the others."""
    rows, places = np.nonzero(np.isfinite(starts).all(axis=-1))
    q, gap = np.full(starts.shape, np.nan), np.full(starts.shape[:2], np.inf)
    if rows.size:
        q[rows, places], gap[rows, places] = nearest(chain.take(rows), target[rows], starts[rows, places])
    return q, gap


def _grid(chain: Chain, target: Reals) -> Reals:
    """The best of a regular grid over all joints but the first, which follows: [rows, m, n]."""
    choices = [_TURNS if kind == "R" else _SLIDES for kind in chain.kinds[1:]]
    values = np.array(list(product(*choices)))
    rest = np.broadcast_to(values, (len(target), *values.shape))
    wide = Chain(chain.kinds, chain.axes[:, None], chain.points[:, None], chain.foot[:, None])
    x = np.broadcast_to(wide.foot, (*rest.shape[:2], 3))
    for joint in range(len(chain.kinds) - 1, 0, -1):
        x = moved(wide, joint, rest[..., joint - 1], x)
    axis, centre = wide.axes[..., 0, :], wide.points[..., 0, :]
    away = target[:, None] - centre
    first = angle_about(axis, x - centre, away) if chain.kinds[0] == "R" else dot(axis, target[:, None] - x)
    starts = np.concatenate([first[..., None], rest], axis=-1)
    gap = norm(foot_of(wide, starts) - target[:, None])
    best = np.argsort(gap, axis=-1, kind="stable")[:, :_STARTS]
    return np.take_along_axis(starts, best[..., None], axis=1)


def _slots(chain: Chain, target: Reals, found: Reals, exact: bool, tolerance: float) -> tuple[Reals, Integers]:
    """The rows of one target from its poses [m, n], which are exact or else the closest."""
    slots = slots_of(chain.kinds)
    rows: list[tuple[Reals, int]] = []
    for pose in _distinct(chain.kinds, _wrapped(chain.kinds, found)):
        q, status = _settled(chain, target, pose, tolerance) if exact else (pose, _UNREACHABLE)
        if all(np.max(np.abs(_difference(chain.kinds, q, other))) > _SAME for other, _ in rows):
            rows.append((q, status))
    rows.sort(key=lambda row: tuple(np.round(row[0], 9)))
    doubled: list[tuple[Reals, int]] = []
    for q, status in rows:
        double = status == _DUPLICATE
        doubled.append((q, _OK if double else status))
        if double and len(rows) < slots:
            doubled.append((q, _DUPLICATE))
    kept = doubled[:slots]
    kept += [(kept[0][0], _UNREACHABLE)] * (slots - len(kept))
    return np.array([q for q, _ in kept]), np.array([status for _, status in kept], np.int32)


def _settled(chain: Chain, target: Reals, q: Reals, tolerance: float) -> tuple[Reals, int]:
    """A pose with OK, with DUPLICATE where two solutions meet in it, or with SINGULAR and its free joint at 0 where it is not isolated."""
    _, jacobian, _ = motion(chain, q[None])
    _, values, across_pose = np.linalg.svd(jacobian[0])
    n = len(chain.kinds)
    if values[-1] > _RANK * values[0]:
        return q, _OK
    free = across_pose[n - 1]
    if not any(_moves(chain, target, q, nudge * free / np.max(np.abs(free)), tolerance) for nudge in _NUDGES):
        return q, _DUPLICATE
    joint = int(np.argmax(np.abs(free) > 0.5 * np.max(np.abs(free))))
    fixed = np.where(np.arange(n) == joint, 0.0, q)
    still, gap = nearest(chain, target, fixed[None], joint)
    return (_wrapped(chain.kinds, still[0]) if gap[0] <= tolerance else q), _SINGULAR


def _moves(chain: Chain, target: Reals, q: Reals, step: Reals, tolerance: float) -> bool:
    """Whether q, moved by a step that keeps the foot nearly at rest, stays away from q when the foot is brought back."""
    aside, gap = nearest(chain, target, (q + step)[None], 3)
    size = np.max(np.abs(step))
    return bool(gap[0] <= tolerance and 0.1 * size <= np.max(np.abs(aside[0] - q)) <= 3.0 * size)


def _distinct(kinds: str, poses: Reals) -> list[Reals]:
    kept: list[Reals] = []
    for pose in poses:
        if all(np.max(np.abs(_difference(kinds, pose, other))) > _SAME for other in kept):
            kept.append(pose)
    return kept


def _difference(kinds: str, a: Reals, b: Reals) -> Reals:
    turning = np.array([kind == "R" for kind in kinds])
    gap = a - b
    return np.where(turning, gap - 2.0 * np.pi * np.round(gap / (2.0 * np.pi)), gap)


def _wrapped(kinds: str, q: Reals) -> Reals:
    """Angles in (-pi, pi]."""
    turning = np.array([kind == "R" for kind in kinds])
    wrapped = q - 2.0 * np.pi * np.ceil(q / (2.0 * np.pi) - 0.5)
    wrapped = np.where(wrapped > np.pi, wrapped - 2.0 * np.pi, np.where(wrapped <= -np.pi, np.pi, wrapped))
    return np.where(turning, wrapped, q)

"""A whole robot as a tree of joints: how its platforms, feet and axes move; the reference of walkgen_tree.h."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]

MOST_JOINTS, MOST_FEET, MOST_PLATFORMS, MOST_CHAIN_JOINTS = 96, 16, 16, 32
_LEG = 3


@dataclass(frozen=True)
class Tree:
    """Joints at q = 0 in the root platform's frame, and what hangs on what; -1 is the root platform.

    `axes` and `points` [nq, 3]; `slides`, `turns` and `parents` [nq]; `feet` [k, 3]; `rotations` [m, 3, 3] and `origins` [m, 3]; `order`:
    parents first; `legs`: every foot's last three joints; `bases`: the joint that carries each leg; `chains`: all other joints, in the
    order of q; `carriers`: the joint that carries each platform; `homes`: the platform that each foot belongs to, the nearest on its path.
    Joints of a leg that is no chain of axes slide in the columns of its foot's Jacobian, and those whose q is an angle turn as well.
    """

    axes: Reals
    points: Reals
    slides: NDArray[np.bool_]
    turns: NDArray[np.bool_]
    parents: tuple[int, ...]
    feet: Reals
    rotations: Reals
    origins: Reals
    order: tuple[int, ...]
    legs: tuple[tuple[int, int, int], ...]
    bases: tuple[int, ...]
    chains: tuple[int, ...]
    carriers: tuple[int, ...]
    homes: tuple[int, ...]

    def path(self, joint: int) -> tuple[int, ...]:
        """The joints that move what hangs on a joint, that joint last."""
        joints: list[int] = []
        while joint >= 0:
            joints.append(joint)
            joint = self.parents[joint]
        return tuple(reversed(joints))

    def sequence(self, foot: int) -> int:
        """A leg's joints: 1, then a binary digit a joint, 1 where it slides."""
        return int("1" + "".join("0" if self.turns[joint] else "1" for joint in self.legs[foot]), 2)

    def leg_geometry(self, foot: int) -> Reals:
        """Axis and point of a leg's joints, then the foot, at q = 0 [21]."""
        joints = list(self.legs[foot])
        return np.concatenate([np.hstack([self.axes[joints], self.points[joints]]).ravel(), self.feet[foot]])


@dataclass(frozen=True)
class Motion:
    """Where q takes the tree: what joint j carries is turned and shifted by `rotations[j]`, `shifts[j]`; its axis and a point on it."""

    rotations: Reals
    shifts: Reals
    axes: Reals
    points: Reals

    def moved(self, joint: int, point: Reals) -> Reals:
        """A point that a joint carries, given at q = 0."""
        return point if joint < 0 else np.asarray(self.rotations[joint] @ point + self.shifts[joint])

    def turned(self, joint: int, vector: Reals) -> Reals:
        """A direction that a joint carries, given at q = 0."""
        return vector if joint < 0 else np.asarray(self.rotations[joint] @ vector)

    def moved_back(self, joint: int, point: Reals) -> Reals:
        """The point that a joint takes here."""
        return point if joint < 0 else np.asarray(self.rotations[joint].T @ (point - self.shifts[joint]))


def read_tree(geometry: ArrayLike, topology: ArrayLike, nq: int, feet: int, platforms: int) -> Tree | None:
    """The tree of these numbers, or None where they are none: not finite, a cycle, legs that share joints or carry more than a foot."""
    numbers, links = np.asarray(geometry, float), np.asarray(topology, np.int64)
    if not (_counts_fit(nq, feet, platforms) and np.isfinite(numbers).all()):
        return None
    parents, kinds = links[:nq].tolist(), links[nq : 2 * nq]
    last, carriers = links[2 * nq : 2 * nq + feet].tolist(), links[2 * nq + feet : 2 * nq + feet + platforms].tolist()
    order = _order(parents, nq)
    if order is None or not set(kinds.tolist()) <= {0, 1, 2} or any(not -1 <= joint < nq for joint in (*last, *carriers)):
        return None
    legs = _legs(parents, last)
    if legs is None:
        return None
    taken = {joint for leg in legs for joint in leg}
    chains = tuple(joint for joint in range(nq) if joint not in taken)
    bases = tuple(parents[leg[0]] for leg in legs)
    foreign = any(parents[joint] in taken or kinds[joint] > 1 for joint in chains) or any(joint in taken for joint in (*bases, *carriers))
    if foreign or len(chains) > MOST_CHAIN_JOINTS:
        return None
    parts, rest = numbers[: 6 * nq].reshape(nq, 2, 3), numbers[6 * nq :]
    frames = rest[3 * feet :].reshape(platforms, 12)
    return Tree(
        axes=parts[:, 0],
        points=parts[:, 1],
        slides=kinds > 0,
        turns=kinds != 1,
        parents=tuple(parents),
        feet=rest[: 3 * feet].reshape(feet, 3),
        rotations=frames[:, :9].reshape(platforms, 3, 3),
        origins=frames[:, 9:],
        order=order,
        legs=legs,
        bases=bases,
        chains=chains,
        carriers=tuple(carriers),
        homes=tuple(_home(parents, carriers, base) for base in bases),
    )


def middle_and_spans(tree: Tree, limits: Reals) -> tuple[Reals, Reals, NDArray[np.bool_]]:
    """What limits [nq, 2] say of every joint.

    Returns:
        the middle [nq], where a limit is missing the value in the range nearest to 0; half the range [nq], or pi and 1 m where it has none
        or it is empty; whether it has one [nq].
    """
    lower, upper = limits[:, 0], limits[:, 1]
    bounded = np.isfinite(lower) & np.isfinite(upper)
    counted = bounded & (upper > lower)
    low, high = np.where(bounded, lower, 0.0), np.where(bounded, upper, 0.0)
    middle = np.where(bounded, 0.5 * low + 0.5 * high, np.minimum(np.maximum(0.0, lower), upper))
    return middle, np.where(counted, 0.5 * high - 0.5 * low, np.where(tree.turns, np.pi, 1.0)), counted


def limits_fit(limits: Reals) -> bool:
    """Whether every lower limit lies at or below its upper one, with a number between them."""
    lower, upper = limits[:, 0], limits[:, 1]
    return bool(((lower <= upper) & (lower < np.inf) & (upper > -np.inf)).all())


def broadcast_rows(arrays: Sequence[Reals], ranks: Sequence[int]) -> tuple[tuple[int, ...], list[Reals]]:
    """The common shape of the leading dimensions, and the arrays in it; `ranks` are the numbers of trailing ones."""
    pairs = list(zip(arrays, ranks, strict=True))
    shape = np.broadcast_shapes(*(array.shape[: array.ndim - rank] for array, rank in pairs))
    return shape, [np.broadcast_to(array, (*shape, *array.shape[array.ndim - rank :])) for array, rank in pairs]


def _counts_fit(nq: int, feet: int, platforms: int) -> bool:
    return 0 <= nq <= MOST_JOINTS and 0 <= feet <= MOST_FEET and 1 <= platforms <= MOST_PLATFORMS


def _order(parents: list[int], nq: int) -> tuple[int, ...] | None:
    """All joints, parents first; None where a parent is no joint or the joints form a cycle."""
    order: list[int] = []
    placed = [False] * nq
    if any(not -1 <= parent < nq for parent in parents):
        return None
    for _ in range(nq):
        for joint in range(nq):
            if not placed[joint] and (parents[joint] < 0 or placed[parents[joint]]):
                placed[joint] = True
                order.append(joint)
        if len(order) == nq:
            break
    return tuple(order) if len(order) == nq else None


def _legs(parents: list[int], last: list[int]) -> tuple[tuple[int, int, int], ...] | None:
    """Every foot's last three joints; None where there are fewer, or a joint is in two legs."""
    legs: list[tuple[int, int, int]] = []
    for joint in last:
        middle = parents[joint] if joint >= 0 else -1
        first = parents[middle] if middle >= 0 else -1
        if first < 0:
            return None
        legs.append((first, middle, joint))
    return tuple(legs) if len({joint for leg in legs for joint in leg}) == _LEG * len(legs) else None


def _home(parents: list[int], carriers: list[int], base: int) -> int:
    """The platform nearest to a leg's base on the way to the root, the first of equals; -1 where there is none."""
    while base >= 0 and base not in carriers:
        base = parents[base]
    return carriers.index(base) if base in carriers else -1


def motion(tree: Tree, q: Reals) -> Motion:
    """The tree at q [nq]."""
    nq = len(q)
    rotations, shifts, axes, points = np.empty((nq, 3, 3)), np.empty((nq, 3)), np.empty((nq, 3)), np.empty((nq, 3))
    for joint in tree.order:
        parent, axis, point = tree.parents[joint], tree.axes[joint], tree.points[joint]
        turn = np.eye(3) if parent < 0 else rotations[parent]
        shift = np.zeros(3) if parent < 0 else shifts[parent]
        axes[joint], points[joint] = turn @ axis, turn @ point + shift
        if tree.slides[joint]:
            rotations[joint], shifts[joint] = turn, shift + q[joint] * axes[joint]
        else:
            rotations[joint] = turn @ _rotation(axis, float(q[joint]))
            shifts[joint] = points[joint] - rotations[joint] @ point
    return Motion(rotations, shifts, axes, points)


def _rotation(axis: Reals, angle: float) -> Reals:
    """Rodrigues' matrix."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = axis
    return np.asarray(c * np.eye(3) + s * np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) + (1.0 - c) * np.outer(axis, axis))


def columns(tree: Tree, at: Motion, joints: tuple[int, ...], point: Reals) -> Reals:
    """How joints move a point that they all carry [3, joints]."""
    chosen = list(joints)
    axes = at.axes[chosen]
    swept = np.cross(axes, point - at.points[chosen])
    return np.asarray(np.where(tree.slides[chosen, None], axes, swept).T)

"""A robot whose feet stand on their targets while its chain joints move: what `adapt` compares; the reference of walkgen_adapt_stand.h."""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.adapt_criterion import Criterion
from walkgen.runtime.solves.adapt_legs import Leg, LegPose, closed, followed
from walkgen.runtime.solves.tree import Motion, Reals, Tree, motion


@dataclass(frozen=True)
class Problem:
    """One row's task: the criterion, the legs, the feet's `targets` [k, 3], the limits [nq], `spans` [nq] (half a range, or pi, or 1 m).

    `reference` [nq] is what legs stay near to, and where the chains start.
    """

    criterion: Criterion
    legs: tuple[Leg, ...]
    targets: Reals
    lower: Reals
    upper: Reals
    spans: Reals
    reference: Reals

    @property
    def tree(self) -> Tree:
        """The robot."""
        return self.criterion.tree

    def clamped(self, q: Reals) -> Reals:
        """Within the limits."""
        return np.minimum(np.maximum(q, self.lower), self.upper)


@dataclass(frozen=True)
class Stand:
    """Joint values [nq], the motion and the legs' poses there, Phi, and what led legs miss: the sum of their squared gaps."""

    q: Reals
    at: Motion
    legs: tuple[LegPose, ...]
    cost: float
    missed: float

    def regular(self, problem: Problem) -> bool:
        """Whether every led leg reaches its target and has an inverse of its Jacobian."""
        return self.missed == 0.0 and all(pose.sheet != 0 for led, pose in zip(problem.criterion.led, self.legs, strict=True) if led)


def stand_at(problem: Problem, q: Reals, last: Stand | None = None) -> Stand | None:
    """The legs where the chains stand: continued from the last stand, or nearest to the reference; None where they cannot follow."""
    q, at = q.copy(), motion(problem.tree, q)
    poses: list[LegPose] = []
    for foot, leg in enumerate(problem.legs):
        target = problem.targets[foot]
        if last is None:
            pose = closed(leg, at, target, problem.reference[list(leg.joints)])
        else:
            pose = followed(leg, at, target, last.legs[foot]) if problem.criterion.led[foot] else last.legs[foot]
        if pose is None:
            return None
        poses.append(pose)
        q[list(leg.joints)] = pose.q
    at = _moved(problem, q)
    missed = sum(float(pose.gap @ pose.gap) for led, pose in zip(problem.criterion.led, poses, strict=True) if led)
    return Stand(q, at, tuple(poses), problem.criterion.value(at, q), missed)


def _moved(problem: Problem, q: Reals) -> Motion:
    """The tree at q; feet of driven legs are moved as their functions say."""
    tree, at = problem.tree, motion(problem.tree, q)
    for foot, leg in enumerate(problem.legs):
        if leg.driven is not None:
            own = list(leg.joints)
            place, jacobian, _ = leg.driven.foot(q[own])
            at.axes[own] = np.array([at.turned(leg.base, column) for column in jacobian.T])
            at.shifts[own[-1]] = at.moved(leg.base, place) - at.turned(own[-1], tree.feet[foot])
    return at

"""What the robot stands on at every instant of a walk: the feet that support it, or the corners of their soles."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from walkgen.gait.motion import Motion
from walkgen.runtime.robot import Robot
from walkgen.runtime.solves.contact import MAX_FEET

_TOUCHING = 1e-6
"""How far from the ground's plane through its foot a corner may be (m), for the sole to lie on it."""


class Standing(NamedTuple):
    """Points in the world [t,p,3] (m), the ground's normals there [t,p,3], the number of each one's leg [p], which support [t,p]."""

    points: np.ndarray
    normals: np.ndarray
    leg: np.ndarray
    support: np.ndarray

    def together(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Instants with the same supporting points, and the numbers of these."""
        codes = self.support @ (1 << np.arange(self.support.shape[1]))
        for code in np.unique(codes):
            rows = np.flatnonzero(codes == code)
            yield rows, np.flatnonzero(self.support[rows[0]])

    def by_leg(self, values: np.ndarray, legs: int) -> np.ndarray:
        """Sums over the points of each leg [t,k,3] of values [t,p,3]."""
        return np.stack([values[:, self.leg == leg].sum(axis=1) for leg in range(legs)], axis=1)


def standing(robot: Robot, motion: Motion, q: np.ndarray, feet: np.ndarray, normals: np.ndarray, support: np.ndarray) -> Standing:
    """Of a walk: soles count with their corners where they lie on the ground, else with their foot point.

    A sole that rolls touches the ground on a line, whose ends it has twice.

    Args:
        robot: with `contact_points` where its soles are to count.
        motion: of the first platform.
        q: joint values [t,nq].
        feet: in the world [t,k,3] (m).
        normals: of the ground there [t,k,3].
        support: whether each supports [t,k].
    """
    counts = _corners(robot)
    if max(counts) == 1:
        return Standing(feet, normals, np.arange(feet.shape[1]), support)
    leg = np.repeat(np.arange(len(counts)), counts)
    points = motion.position[:, None] + motion.outward(robot.contact_points(q))
    away = np.abs(np.einsum("tpi,tpi->tp", points - feet[:, leg], normals[:, leg]))
    tilted = np.stack([(away[:, leg == number] > _TOUCHING).any(axis=1) for number in range(len(counts))], axis=1)
    return Standing(np.where(tilted[:, leg, None], feet[:, leg], points), normals[:, leg], leg, support[:, leg])


def crowd(robot: Robot, support: np.ndarray, times: np.ndarray) -> str:
    """What there is to say of a walk in which more points support the robot at once than contact forces have room for; else nothing.

    Args:
        robot: that walks.
        support: which legs support [t,k].
        times: when [t] (s).
    """
    counts = support @ np.array(_corners(robot))
    row = int(np.argmax(counts))
    if counts[row] <= MAX_FEET:
        return ""
    return (
        f"{int(support[row].sum())} feet stand on {counts[row]} corners at t = {times[row]:.4g} s; contact forces have room for {MAX_FEET}"
    )


def _corners(robot: Robot) -> list[int]:
    """How many points each leg stands on."""
    if not hasattr(robot, "contact_points"):
        return [1] * len(robot.legs)
    legs = robot.legs.values()
    return [len(leg.sole_points(np.zeros(len(leg.joints)))) if "sole_points" in leg.functions else 1 for leg in legs]

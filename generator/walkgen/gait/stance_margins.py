"""The stability margins at every instant of a walk, over whichever feet support then."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from walkgen.runtime.robot import Robot


class Margins(NamedTuple):
    """Static (m), longitudinal ahead and back [t,2] (m), and the height (m) to lift the robot by to tip it [t]; NaN where there is none."""

    static: np.ndarray
    longitudinal: np.ndarray
    height: np.ndarray


def standing(support: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Instants with the same supporting legs, and these legs; support [t,k]."""
    codes = support @ (1 << np.arange(support.shape[1]))
    for code in np.unique(codes):
        rows = np.flatnonzero(codes == code)
        yield rows, np.flatnonzero(support[rows[0]])


def margins(robot: Robot, feet: np.ndarray, support: np.ndarray, com: np.ndarray, direction: np.ndarray) -> Margins:
    """Of the supporting feet's polygon; static is minus infinity in the air, NaN where a foot or the centre of mass has no place.

    Args:
        robot: with `stability_margins`.
        feet: [t,k,3] in the world (m).
        support: whether each supports [t,k].
        com: centre of mass [t,3] (m).
        direction: of travel [3].
    """
    found = Margins(np.full(len(feet), -np.inf), np.full((len(feet), 2), np.nan), np.full(len(feet), np.nan))
    known = np.isfinite(feet).all(axis=(1, 2)) & np.isfinite(com).all(axis=1)
    found.static[~known] = np.nan
    for all_rows, legs in standing(support):
        rows = all_rows[known[all_rows]]
        if legs.size and rows.size:
            result = robot.stability_margins(feet[np.ix_(rows, legs)], com[rows], direction)
            found.static[rows] = result.static_margin
            found.longitudinal[rows] = result.longitudinal_margin
            found.height[rows] = result.energy_height
    return found

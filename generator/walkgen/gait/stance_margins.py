"""The stability margins at every instant of a walk, over whichever feet support then."""

from typing import NamedTuple

import numpy as np

from walkgen.gait.standing import Standing
from walkgen.runtime.robot import Robot


class Margins(NamedTuple):
    """Of stability at every instant; NaN where there is none.

    Attributes:
        static: how far the centre of mass is inside the support polygon, seen along gravity [t] (m).
        longitudinal: how far it can go ahead and back [t,2] (m).
        height: by how much it must rise for the robot to tip [t] (m).
        dynamic: how far inside the zero moment point of the load is, inertia included, on the plane of the supporting points' mean
            place and normal [t] (m).
    """

    static: np.ndarray
    longitudinal: np.ndarray
    height: np.ndarray
    dynamic: np.ndarray


def margins(robot: Robot, standing: Standing, com: np.ndarray, load: np.ndarray, direction: np.ndarray) -> Margins:
    """Of the supporting points' polygon; minus infinity in the air, NaN where a foot or the centre of mass has no place.

    Args:
        robot: with `stability_margins`.
        standing: what it stands on.
        com: centre of mass [t,3] (m).
        load: on the robot, about the world's origin: force, moment [t,6]; NaN where it is not known.
        direction: of travel [3].
    """
    points, count = standing.points, len(com)
    found = Margins(np.full(count, -np.inf), np.full((count, 2), np.nan), np.full(count, np.nan), np.full(count, -np.inf))
    placed = np.isfinite(points).all(axis=(1, 2))
    known, loaded = placed & np.isfinite(com).all(axis=1), placed & np.isfinite(load).all(axis=1)
    found.static[~known], found.dynamic[~loaded] = np.nan, np.nan
    for all_rows, numbers in standing.together():
        rows = all_rows[known[all_rows]]
        if numbers.size and rows.size:
            result = robot.stability_margins(points[np.ix_(rows, numbers)], com[rows], direction)
            found.static[rows] = result.static_margin
            found.longitudinal[rows] = result.longitudinal_margin
            found.height[rows] = result.energy_height
        rows = all_rows[loaded[all_rows]]
        if numbers.size and rows.size:
            place = np.ix_(rows, numbers)
            point, normal = _zero_moment(load[rows], points[place], standing.normals[place])
            result = robot.stability_margins(points[place], point, direction, gravity=-normal)
            found.dynamic[rows] = np.where((load[rows, :3] * normal).sum(axis=1) < 0.0, result.static_margin, -np.inf)
    return found


def _zero_moment(load: np.ndarray, points: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where the load [t,6] has no moment but about the normal [t,3], and that normal: on the points' mean plane."""
    middle, normal = points.mean(axis=1), normals.mean(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    force, moment = load[:, :3], load[:, 3:]
    pressing = (force * normal).sum(axis=1, keepdims=True)
    along = np.cross(normal, moment - np.cross(middle, force))
    point: np.ndarray = middle + np.divide(along, pressing, out=np.zeros_like(along), where=pressing < 0.0)
    return point, normal

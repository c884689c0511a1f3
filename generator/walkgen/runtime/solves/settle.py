"""The stable pose that a tripod slides to on a terrain, and the path: the reference of walkgen_settle.h."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.friction_needed import stances
from walkgen.runtime.solves.settle_flow import Pose, Slide, flow, press
from walkgen.runtime.solves.stance import (
    BAD_INPUT,
    INFEASIBLE,
    NO_CONVERGENCE,
    OK,
    SINGULAR,
    Integers,
    Reals,
    are_feet,
    are_unit,
    stance_of,
)

Ground = Callable[[Reals], Reals]
Callback = tuple[Any, ...]
"""A function of points, and what else it takes: the runtime parameters, where the robot has any."""

_LEAST = 1e-7


@dataclass(frozen=True)
class Robot:
    """A rigid tripod on its ground.

    Attributes:
        feet: in the platform's frame [3, 3], m.
        centre_of_mass: in the platform's frame [3], m.
        weight: a force in the world [3], N.
        wrench: a constant load in the world about its origin [6].
        ground: of points [3, 3] the height over the surface along the normal, the unit normal and the coefficient of friction [3, 5].
    """

    feet: Reals
    centre_of_mass: Reals
    weight: Reals
    wrench: Reals
    ground: Ground


@dataclass(frozen=True)
class Settled:
    """The path [n, 4, 4] of world_T_platform from the start to the stable pose, its last; normal forces there [3], N; and the status."""

    path: Reals
    normal_forces: Reals
    status: int


def settle(
    points: ArrayLike,
    feet: ArrayLike,
    centre_of_mass: ArrayLike,
    weight: ArrayLike,
    wrench: ArrayLike,
    start: ArrayLike,
    callback: Callback,
    step: ArrayLike,
    most_steps: ArrayLike,
    poses: int,
) -> tuple[Reals, Reals, Reals, Integers, Integers]:
    """The stable poses that robots on three of their feet settle to.

    Args:
        points: all feet in the platform's frame [..., k, 3], m.
        feet: the numbers of the three that stand [..., 3].
        centre_of_mass: in the platform's frame [..., 3], m.
        weight: a force in the world [..., 3], N.
        wrench: a constant load in the world about its origin [..., 6].
        start: world_T_platform [..., 4, 4].
        callback: the ground's function of a point and what it takes after it: height over the surface, normal, friction [5].
        step: how far the fastest foot goes in a step [...], m.
        most_steps: how many steps at most [...].
        poses: rows of the paths.

    Returns:
        The last pose [..., 4, 4]; normal forces [..., 3]; path [..., poses, 4, 4], beyond its end the last pose; steps [...]; status [...].
    """
    function, *data = callback
    shape, given = stances(
        (points, feet, centre_of_mass, weight, wrench, start, step, most_steps, *data), (2, 1, 1, 1, 1, 2, 0, 0, *(1 for _ in data))
    )
    rows = [_row(function, *(item[index] for item in given)) for index in np.ndindex(shape)]
    path = np.array([_padded(row.path, poses) for row in rows]).reshape(*shape, poses, 4, 4)
    pose = np.array([_padded(row.path, len(row.path) or 1)[-1] for row in rows]).reshape(*shape, 4, 4)
    forces = np.array([row.normal_forces for row in rows]).reshape(*shape, 3)
    steps = np.array([max(len(row.path) - 1, 0) for row in rows], np.int32).reshape(shape)
    return pose, forces, path, steps, np.array([row.status for row in rows], np.int32).reshape(shape)


def _row(function: Callable[..., Reals], points: Reals, feet: Reals, *rest: Reals) -> Settled:
    centre_of_mass, weight, wrench, start, step, most_steps, *data = rest
    if not ((feet >= 0) & (feet < len(points))).all():
        return _nothing(BAD_INPUT)
    robot = Robot(points[feet.astype(int)], centre_of_mass, weight, wrench, lambda at: function(at, *data))
    return settled(robot, start, float(step), int(most_steps))


def _padded(path: Reals, poses: int) -> Reals:
    """The first poses; beyond the path's end its last."""
    last = path[-1:] if len(path) else np.full((1, 4, 4), np.nan)
    return np.concatenate([path[:poses], last.repeat(max(poses - len(path), 0), axis=0)])


def _nothing(status: int) -> Settled:
    return Settled(np.empty((0, 4, 4)), np.full(3, np.nan), status)


def settled(robot: Robot, start: ArrayLike, step: float, most_steps: int) -> Settled:
    """One robot's way from the start.

    Sliding without inertia, by the twist that makes -load . t + sum mu N |V| + c / 2 sum |V|^2 least for the normal forces N that
    balance it; steps by the midpoint rule in which the fastest foot goes `step` (m, at most a fifth of the feet's root mean square distance
    from their centre), halved where the robot would stick or slide back. OK; INFEASIBLE where a foot lifts off; NO_CONVERGENCE after
    most_steps; SINGULAR or BAD_INPUT with an empty path.
    """
    pose = np.asarray(start, float)
    if not are_feet(robot.feet, pose, robot.centre_of_mass, robot.weight, robot.wrench) or not 0.0 < step < np.inf or most_steps < 0:
        return _nothing(BAD_INPUT)
    here = _touching(robot, pose)
    if here is None:
        return _nothing(BAD_INPUT if not np.linalg.matrix_rank(robot.feet - robot.feet.mean(axis=0), tol=1e-12) < 2 else SINGULAR)
    return _followed(robot, flow(here), min(step / here.stance.length, 0.2), most_steps)


def _followed(robot: Robot, slide: Slide, far: float, most_steps: int) -> Settled:
    path, status = [slide.here.pose], NO_CONVERGENCE
    if slide.lifts or not slide.twist.any():
        status, most_steps = INFEASIBLE if slide.lifts else OK, 0
    while len(path) <= most_steps:
        found = _step(robot, slide, far)
        if isinstance(found, Slide):
            slide = found
            path.append(slide.here.pose)
            continue
        far *= 0.5
        if far < _LEAST:
            status = found
            break
    return Settled(np.array(path), slide.N * slide.here.stance.force, status)


def _step(robot: Robot, slide: Slide, far: float) -> Slide | int:
    """One step by the midpoint rule; or why there is none: OK where it would stick or slide back, INFEASIBLE where a foot lifts off."""
    middle = _slid(robot, slide.here, 0.5 * far * slide.twist)
    if middle is None or not middle.twist.any() or middle.twist @ slide.twist <= 0.0:
        return INFEASIBLE if middle is None else OK
    end = _slid(robot, slide.here, far * middle.twist)
    if end is None:
        return INFEASIBLE
    return end if end.twist @ middle.twist > 0.0 else OK


def _slid(robot: Robot, here: Pose, twist: Reals) -> Slide | None:
    """The pose after a twist with its flow; None where a foot lifts off or leaves the ground."""
    there = _touching(robot, _moved(here, twist))
    slide = flow(there) if there is not None else None
    return None if slide is None or slide.lifts else slide


def _read(robot: Robot, pose: Reals) -> Pose:
    points = robot.feet @ pose[:3, :3].T + pose[:3, 3]
    surfaces = robot.ground(points)
    at = pose[:3, :3] @ robot.centre_of_mass + pose[:3, 3]
    load = np.concatenate([robot.weight, np.cross(at, robot.weight)]) + robot.wrench
    return Pose(pose, stance_of(points, load), surfaces[:, 1:4], surfaces[:, 4], surfaces[:, 0])


def _moved(here: Pose, twist: Reals) -> Reals:
    """The pose after a twist about the feet's centre in the stance's units."""
    angle = float(np.linalg.norm(twist[3:]))
    x, y, z = twist[3:] / angle if angle > 0.0 else twist[3:]
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    pose = here.pose.copy()
    pose[:3, :3] = turn @ pose[:3, :3]
    pose[:3, 3] = here.stance.centre + turn @ (pose[:3, 3] - here.stance.centre) + here.stance.length * twist[:3]
    return pose


def _touching(robot: Robot, pose: Reals) -> Pose | None:
    """The pose with its feet put on the surface by the least twists."""
    for _ in range(20):
        here = _read(robot, pose)
        fine = np.isfinite(here.stance.blur) and np.isfinite(here.gap).all() and are_unit(here.normals) and (here.mu >= 0.0).all()
        if not fine or np.linalg.matrix_rank(press(here), tol=here.stance.blur) < 3:
            return None
        if np.abs(here.gap).max() <= 1e-13 * here.stance.length:
            return here
        pose = _moved(here, np.linalg.pinv(press(here).T) @ (-here.gap / here.stance.length))
    return here if np.abs(here.gap).max() <= 1e-9 * here.stance.length else None

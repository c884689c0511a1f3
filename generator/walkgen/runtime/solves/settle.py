"""The stable pose that a tripod slides to on a terrain: the reference of walkgen_settle.h, by Euler's steps."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, SINGULAR, Reals, Stance, are_feet, are_unit, stance_of

Ground = Callable[[Reals], tuple[float, Reals, float]]

_SLOW = 1e-11
_STILL = 1e-7
_LEAST = 1e-7


@dataclass(frozen=True)
class Robot:
    """A rigid tripod on its ground.

    Attributes:
        feet: in the platform's frame [3, 3], m.
        centre_of_mass: in the platform's frame [3], m.
        weight: a force in the world [3], N.
        wrench: a constant load in the world about its origin [6].
        ground: of a point [3] the height over the surface along the normal, the unit normal [3] and the coefficient of friction.
    """

    feet: Reals
    centre_of_mass: Reals
    weight: Reals
    wrench: Reals
    ground: Ground


@dataclass(frozen=True)
class _Pose:
    """A pose [4, 4] with the stance there: normals [3, 3], friction [3], heights [3]."""

    pose: Reals
    stance: Stance
    normals: Reals
    mu: Reals
    gap: Reals


def settle(robot: Robot, start: ArrayLike, step: float, most_steps: int) -> tuple[Reals, Reals, int]:
    """The path [n, 4, 4] of world_T_platform from the start to the stable pose, its last; normal forces there [3]; and the status.

    Sliding without inertia, by the twist that makes -load . t + sum mu N |V| + c / 2 sum |V|^2 least for the normal forces N that
    balance it; steps by which the fastest foot goes `step` (m, at most a fifth of the feet's root mean square distance from their centre),
    halved where the robot would stick or slide back. OK; INFEASIBLE where a foot lifts off; NO_CONVERGENCE after most_steps; SINGULAR or
    BAD_INPUT with an empty path.
    """
    nothing = np.empty((0, 4, 4)), np.full(3, np.nan)
    pose = np.asarray(start, float)
    if not are_feet(robot.feet, pose, robot.centre_of_mass, robot.weight, robot.wrench) or not step > 0.0:
        return *nothing, BAD_INPUT
    here = _touching(robot, pose)
    if here is None:
        return *nothing, BAD_INPUT if not np.linalg.matrix_rank(robot.feet - robot.feet.mean(axis=0), tol=1e-12) < 2 else SINGULAR
    far = min(step / here.stance.length, 0.2)
    twist, N = _flow(here)
    path = [here.pose]
    while N.min() >= -_STILL and twist.any():
        if len(path) > most_steps:
            return np.array(path), N * here.stance.force, NO_CONVERGENCE
        there = _touching(robot, _moved(here, far * twist))
        onward, pressed = _flow(there) if there is not None else (0.0 * twist, -np.ones(3))
        if onward @ twist > 0.0 and pressed.min() >= -_STILL and there is not None:
            here, twist, N = there, onward, pressed
            path.append(here.pose)
        elif far < _LEAST:
            return np.array(path), N * here.stance.force, OK if pressed.min() >= -_STILL else INFEASIBLE
        else:
            far *= 0.5
    return np.array(path), N * here.stance.force, OK if N.min() >= -_STILL else INFEASIBLE


def _read(robot: Robot, pose: Reals) -> _Pose:
    points = robot.feet @ pose[:3, :3].T + pose[:3, 3]
    gap, normals, mu = (np.array([robot.ground(point)[i] for point in points]) for i in range(3))
    at = pose[:3, :3] @ robot.centre_of_mass + pose[:3, 3]
    return _Pose(pose, stance_of(points, np.concatenate([robot.weight, np.cross(at, robot.weight)]) + robot.wrench), normals, mu, gap)


def _press(here: _Pose) -> Reals:
    """Wrenches of unit normal forces, by columns."""
    return np.stack([here.stance.grasp[:, 3 * i : 3 * i + 3] @ here.normals[i] for i in range(3)], axis=1)


def _moved(here: _Pose, twist: Reals) -> Reals:
    """The pose after a twist about the feet's centre in the stance's units."""
    angle = float(np.linalg.norm(twist[3:]))
    x, y, z = twist[3:] / angle if angle > 0.0 else twist[3:]
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    pose = here.pose.copy()
    pose[:3, :3] = turn @ pose[:3, :3]
    pose[:3, 3] = here.stance.centre + turn @ (pose[:3, 3] - here.stance.centre) + here.stance.length * twist[:3]
    return pose


def _touching(robot: Robot, pose: Reals) -> _Pose | None:
    """The pose with its feet put on the surface by the least twists."""
    for _ in range(20):
        here = _read(robot, pose)
        fine = np.isfinite(here.stance.blur) and np.isfinite(here.gap).all() and are_unit(here.normals) and (here.mu >= 0.0).all()
        if not fine or np.linalg.matrix_rank(_press(here), tol=here.stance.blur) < 3:
            return None
        if np.abs(here.gap).max() <= 1e-13 * here.stance.length:
            return here
        pose = _moved(here, np.linalg.pinv(_press(here).T) @ (-here.gap / here.stance.length))
    return here if np.abs(here.gap).max() <= 1e-9 * here.stance.length else None


def _flow(here: _Pose) -> tuple[Reals, Reals]:
    """The twist of the flow, its fastest foot of speed 1, or zeros at rest; the normal forces."""
    press = _press(here)
    free = np.linalg.svd(press.T)[2][3:].T
    carry = here.stance.grasp.T @ free
    N = _solved(press, -here.stance.load)
    tau = np.zeros(3)
    slow = 0.1
    for _ in range(40):
        most = here.mu * np.maximum(N, 0.0)
        while slow > _SLOW:
            tau = _least(carry, most, free.T @ here.stance.load, tau, slow)
            slow = max(0.1 * slow, _SLOW)
        tau = _least(carry, most, free.T @ here.stance.load, tau, slow)
        V = (carry @ tau).reshape(3, 3)
        T = -(most / np.sqrt(np.sum(V**2, axis=1) + slow**2) + 1.0)[:, None] * V
        before = N
        N = _solved(press, -here.stance.load - here.stance.grasp @ T.ravel())
        if np.abs(N - before).max() <= 1e-11:
            break
    fastest = float(np.linalg.norm(V, axis=1).max())
    return free @ tau / fastest if fastest > _STILL else np.zeros(6), N


def _solved(press: Reals, wrench: Reals) -> Reals:
    """Normal forces nearest to a wrench."""
    return np.asarray(np.linalg.lstsq(press, wrench, rcond=None)[0], float)


def _least(carry: Reals, most: Reals, power: Reals, tau: Reals, slow: float) -> Reals:
    """tau of the least -power . tau + sum most sqrt(|V|^2 + slow^2) + sum |V|^2 / 2: Newton with halved steps."""

    def cost(tau: Reals) -> float:
        squares = np.sum((carry @ tau).reshape(3, 3) ** 2, axis=1)
        return float(most @ np.sqrt(squares + slow**2) + 0.5 * squares.sum() - power @ tau)

    for _ in range(50):
        V = (carry @ tau).reshape(3, 3)
        length = np.sqrt(np.sum(V**2, axis=1) + slow**2)
        share = (most / length + 1.0).repeat(3)
        along = np.stack([carry[3 * i : 3 * i + 3].T @ V[i] / length[i] for i in range(3)])
        slope = carry.T @ (share * V.ravel()) - power
        if np.linalg.norm(slope) <= 1e-11:
            break
        change = -np.linalg.solve(carry.T @ (share[:, None] * carry) - along.T @ ((most / length)[:, None] * along), slope)
        factor = 1.0
        while cost(tau + factor * change) > cost(tau) and factor > 1e-12:
            factor *= 0.5
        if factor <= 1e-12:
            break
        tau = tau + factor * change
    return tau

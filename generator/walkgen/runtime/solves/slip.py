"""How a tripod of given pose begins to slip: the reference of walkgen_slip.h, by Newton from many directions of slip."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.runtime.solves.stance import (
    BAD_INPUT,
    INFEASIBLE,
    NO_CONVERGENCE,
    OK,
    SINGULAR,
    Integers,
    Reals,
    Stance,
    are_feet,
    are_unit,
    stance_of,
)

_FAIR = 1e-11
_SMALL = 1e-9
_STARTS = 24
_Slip = tuple[Reals, Reals, float, Reals]


class Slip(NamedTuple):
    """Normal forces [..., 3], N; forces [..., 3, 3], N; the twist [..., 6] (velocity of the frame's origin, angular velocity) of length 1;
    mu [...]; a point and the direction of the twist's axis [..., 6]; pitch [...], m/rad; status [...].
    """

    normal_forces: Reals
    f: Reals
    twist: Reals
    mu: Reals
    axis: Reals
    pitch: Reals
    status: Integers


def slip(points: ArrayLike, normals: ArrayLike, wrench: ArrayLike) -> Slip:
    """The slip that is about to begin: all feet slide along the ground by one twist, against friction mu N.

    sum N (n - mu V / |V|) [1; p x] + wrench = 0 with n . V = 0; or one foot stays where it is, with less friction.

    Args:
        points: the feet [..., 3, 3], m.
        normals: the ground's at the feet, unit vectors towards the robot [..., 3, 3].
        wrench: the load on the robot [..., 6]: force, N, and moment about the frame's origin, Nm.

    Returns:
        Status OK; SINGULAR for a translation, which has no axis (NaN, pitch infinite), without load along the ground (mu 0, twist NaN), or
        with NaN for feet on a line; INFEASIBLE, NO_CONVERGENCE or BAD_INPUT with NaN.
    """
    feet, directions, load = (np.asarray(item, float) for item in (points, normals, wrench))
    shape = np.broadcast_shapes(feet.shape[:-2], directions.shape[:-2], load.shape[:-1])
    given = [np.broadcast_to(item, (*shape, *item.shape[item.ndim - rank :])) for item, rank in ((feet, 2), (directions, 2), (load, 1))]
    rows = [_row(*(item[index] for item in given)) for index in np.ndindex(shape)]
    mu, N, f, twist = (np.array([row[i] for row in rows]) for i in range(4))
    turns = [_axis(row[3]) for row in rows]
    axis, pitch = np.array([turn[0] for turn in turns]).reshape(*shape, 6), np.array([turn[1] for turn in turns]).reshape(shape)
    status = np.array([row[4] for row in rows], np.int32).reshape(shape)
    return Slip(N.reshape(*shape, 3), f.reshape(*shape, 3, 3), twist.reshape(*shape, 6), mu.reshape(shape), axis, pitch, status)


def _axis(twist: Reals) -> tuple[Reals, float]:
    """A point of a twist's axis and its direction, and advance over turn."""
    square = twist[3:] @ twist[3:]
    if not np.linalg.norm(twist[3:]) > _SMALL * np.linalg.norm(twist):
        return np.full(6, np.nan), np.inf if np.isfinite(square) else np.nan
    return np.concatenate([np.cross(twist[3:], twist[:3]) / square, twist[3:] / np.sqrt(square)]), float(twist[:3] @ twist[3:] / square)


def _row(points: Reals, normals: Reals, wrench: Reals) -> tuple[float, Reals, Reals, Reals, int]:
    nothing = np.full(3, np.nan), np.full((3, 3), np.nan), np.full(6, np.nan)
    if points.shape != (3, 3) or not are_feet(points, normals, wrench) or not are_unit(normals):
        return np.nan, *nothing, BAD_INPUT
    stance = stance_of(points, wrench)
    press = np.stack([stance.grasp[:, 3 * i : 3 * i + 3] @ normals[i] for i in range(3)], axis=1)
    if not np.isfinite(stance.blur) or np.linalg.matrix_rank(press, tol=stance.blur) < 3:
        return np.nan, *nothing, SINGULAR
    free = np.linalg.svd(press.T)[2][3:].T
    N = np.linalg.lstsq(press, -stance.load, rcond=None)[0]
    if np.linalg.norm(free.T @ stance.load) <= 1e-12:
        carried = bool(N.min() >= -_SMALL)
        return (
            (0.0, N * stance.force, N[:, None] * normals * stance.force, nothing[2], SINGULAR)
            if carried
            else (np.nan, *nothing, INFEASIBLE)
        )
    for found in (*_sliding(stance, normals, free, N), *_turning(stance, normals, free, N)):
        return _told(found, stance, normals)
    return np.nan, *nothing, INFEASIBLE if N.min() < -_SMALL else NO_CONVERGENCE


def _sliding(stance: Stance, normals: Reals, free: Reals, start: Reals) -> Iterator[_Slip]:
    """Slips of all feet, from directions spread over the sphere."""

    def lacking(x: NDArray[np.complex128]) -> NDArray[np.complex128]:
        V = (stance.grasp.T @ (free @ x[3:6])).reshape(3, 3)
        units = V / np.sqrt(np.sum(V**2, axis=1))[:, None]
        f = x[:3, None] * (normals - x[6] * units)
        return np.asarray(np.append(stance.grasp @ f.ravel() + stance.load, x[3:6] @ x[3:6] - 1.0), complex)

    for i in range(_STARTS):
        height, angle = 1.0 - (2.0 * i + 1.0) / _STARTS, i * np.pi * (3.0 - np.sqrt(5.0))
        tau = np.array([np.sqrt(1.0 - height**2) * np.cos(angle), np.sqrt(1.0 - height**2) * np.sin(angle), height])
        tau *= np.sign(tau @ (free.T @ stance.load)) or 1.0
        x = _newton(lacking, np.concatenate([np.maximum(start, 0.1), tau, [0.3]]))
        if x is not None and x[:3].min() > -_SMALL and x[6] > 0.0 and x[3:6] @ (free.T @ stance.load) > 0.0:
            V = (stance.grasp.T @ (free @ x[3:6])).reshape(3, 3)
            yield x[:3], -x[6] * x[:3, None] * V / np.linalg.norm(V, axis=1)[:, None], float(x[6]), free @ x[3:6]


def _turning(stance: Stance, normals: Reals, free: Reals, start: Reals) -> Iterator[_Slip]:
    """Slips about a foot that stays."""
    for held in range(3):
        twist = free @ np.linalg.svd(stance.grasp[:, 3 * held : 3 * held + 3].T @ free)[2][2]
        twist *= np.sign(twist @ stance.load) or 1.0
        V = (stance.grasp.T @ twist).reshape(3, 3)
        units = np.divide(V, np.linalg.norm(V, axis=1)[:, None], out=np.zeros((3, 3)), where=np.arange(3)[:, None] != held)
        first, second = np.linalg.svd(normals[held][None])[2][1:]

        def friction(x: Reals, units: Reals = units, held: int = held, across: tuple[Reals, Reals] = (first, second)) -> Reals:
            T: Reals = -x[5] * x[:3, None] * units
            T[held] = x[3] * across[0] + x[4] * across[1]
            return T

        x = _newton(
            lambda x, friction=friction: stance.grasp @ (x[:3, None] * normals + friction(x)).ravel() + stance.load,
            np.concatenate([np.maximum(start, 0.1), [0.0, 0.0, 0.3]]),
        )
        if x is not None and x[:3].min() > -_SMALL and x[5] > 0.0:
            T = friction(x)
            if np.linalg.norm(T[held]) <= x[5] * x[held] + _SMALL:
                yield x[:3], T, float(x[5]), twist


def _newton(lacking: Callable[..., NDArray[np.complex128]], x: Reals) -> Reals | None:
    """A root by Newton, derivatives by complex steps."""
    for _ in range(40):
        rest = lacking(x.astype(complex)).real
        if not np.isfinite(rest).all():
            return None
        if np.abs(rest).max() <= 1e-15:
            break
        slopes = np.stack([lacking(x + 1e-30j * axis).imag / 1e-30 for axis in np.eye(len(x))], axis=1)
        x = x - np.linalg.lstsq(slopes, rest, rcond=1e-14)[0]
    return x if np.abs(lacking(x.astype(complex)).real).max() <= _FAIR else None


def _told(found: _Slip, stance: Stance, normals: Reals) -> tuple[float, Reals, Reals, Reals, int]:
    """The slip in the frame and the units given."""
    N, T, mu, twist = found
    turning = bool(np.linalg.norm(twist[3:]) > _SMALL * np.linalg.norm(twist))
    turn = twist[3:] / stance.length if turning else np.zeros(3)
    outside = np.concatenate([twist[:3] - np.cross(turn, stance.centre), turn])
    f = stance.force * (N[:, None] * normals + T)
    return mu, stance.force * N, f, outside / np.linalg.norm(outside), OK if turning else SINGULAR

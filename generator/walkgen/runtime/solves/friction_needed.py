"""The least friction with which feet carry a load: the reference of walkgen_friction_needed.h."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, Integers, Reals, Stance, are_feet, are_unit, stance_of

_STEEP = 1e-7
_NONE = 1e-10
_ENOUGH = 4.0


@dataclass(frozen=True)
class Carrying:
    """The problem: forces columns @ x = b with x_i - (s, 0, 0) in the cone |tangential| <= mu normal, s as great as possible.

    Attributes:
        columns: wrenches of the feet's unit forces along normal and two tangents [rows, 3k].
        b: the wrench that they must give [rows].
    """

    columns: Reals
    b: Reals


class Friction(NamedTuple):
    """mu [...]; forces that carry the load with it [..., k, 3], N; the twist [..., 6] of the slip with less; status [...]."""

    mu: Reals
    f: Reals
    twist: Reals
    status: Integers


def friction_needed(points: ArrayLike, normals: ArrayLike, wrench: ArrayLike) -> Friction:
    """The least coefficient of friction, common to all feet, with which they carry the load.

    The root of s(mu), the greatest normal force that every foot can have above what its friction needs, N - |T| / mu; an
    interior-point method in Nesterov and Todd's scaling (1997) gives s.

    Args:
        points: the feet [..., k, 3], m.
        normals: the ground's at the feet, unit vectors towards the robot [..., k, 3].
        wrench: the load on the robot [..., 6]: force, N, and moment about the frame's origin, Nm.

    Returns:
        Status OK: the twist moves feet away from the ground by V . n >= mu |V - n V . n|, the fastest by 1, while the load gains nothing;
        INFEASIBLE: mu infinite, f NaN, and the twist proves it, wrench . twist = 1 while no foot moves but away from the ground;
        NO_CONVERGENCE or BAD_INPUT with NaN.
    """
    shape, given = stances((points, normals, wrench), (2, 2, 1))
    rows = [_row(*(item[index] for item in given)) for index in np.ndindex(shape)]
    mu, f, twist, status = (np.array([row[i] for row in rows]) for i in range(4))
    whole = (*shape, *given[0].shape[-2:])
    return Friction(mu.reshape(shape), f.reshape(whole), twist.reshape(*shape, 6), status.reshape(shape).astype(np.int32))


def stances(inputs: Sequence[ArrayLike], ranks: Sequence[int]) -> tuple[tuple[int, ...], list[Reals]]:
    """The common leading shape, and the inputs with it."""
    items = [np.asarray(item, float) for item in inputs]
    shape = np.broadcast_shapes(*(item.shape[: item.ndim - rank] for item, rank in zip(items, ranks, strict=True)))
    return shape, [np.broadcast_to(item, (*shape, *item.shape[item.ndim - rank :])) for item, rank in zip(items, ranks, strict=True)]


@dataclass(frozen=True)
class Problem:
    """A stance with its equations reduced to the wrenches that feet can give: `kept` [6, rank] spans them."""

    stance: Stance
    frames: Reals
    kept: Reals
    carrying: Carrying
    outside: Reals

    def helpless(self) -> Reals | None:
        """A twist that moves no foot but away from the ground while the load gains: no friction helps; None where there is none."""
        if np.linalg.norm(self.outside) > _NONE:
            return self.outside
        columns = self.carrying.columns
        normal = np.arange(columns.shape[1]) % 3 == 0
        U, singular, _ = np.linalg.svd(columns[:, ~normal])
        across = U[:, np.count_nonzero(singular > _STEEP) :].T
        if len(across) == 0:
            return None
        s, _, y = reach(Carrying(np.where(normal, across @ columns, 0.0), across @ self.carrying.b), 1.0)
        return self.kept @ across.T @ y if s < -_NONE else None

    def twist(self, y: Reals) -> Reals:
        """Of multipliers of the six components: velocity of the frame's origin, angular velocity."""
        turn = y[3:] / self.stance.length
        return np.concatenate([y[:3] - np.cross(turn, self.stance.centre), turn])


def problem_of(points: Reals, normals: Reals, wrench: Reals) -> Problem:
    """The problem of a stance; its unknowns are along the frames [k, 3, 3] (normal, two tangents, by rows)."""
    stance = stance_of(points, wrench)
    frames = np.array([frame_of(normal) for normal in normals])
    columns = np.concatenate([stance.grasp[:, 3 * i : 3 * i + 3] @ frames[i].T for i in range(len(points))], axis=1)
    U, singular, _ = np.linalg.svd(columns)
    kept = U[:, : np.count_nonzero(singular > _STEEP)]
    outside = stance.load - kept @ (kept.T @ stance.load)
    return Problem(stance, frames, kept, Carrying(kept.T @ columns, -kept.T @ stance.load), outside)


def frame_of(normal: Reals) -> Reals:
    """A normal and two tangents, by rows."""
    basis = np.linalg.svd(normal[None])[2]
    return np.stack([normal, basis[1], basis[2]])


def _row(points: Reals, normals: Reals, wrench: Reals) -> tuple[float, Reals, Reals, int]:
    nothing, still = np.full(points.shape, np.nan), np.full(6, np.nan)
    if not are_feet(points, normals, wrench) or not are_unit(normals):
        return np.nan, nothing, still, BAD_INPUT
    problem = problem_of(points, normals, wrench)
    proof = problem.helpless()
    if proof is not None:
        twist = problem.twist(proof)
        return np.inf, nothing, twist / (wrench @ twist), INFEASIBLE
    mu = needed(problem.carrying)
    if mu is None:
        return np.nan, nothing, still, NO_CONVERGENCE
    _, x, y = reach(problem.carrying, mu)
    twist = problem.twist(problem.kept @ y)
    fastest = np.linalg.norm(twist[:3] + np.cross(twist[3:], points), axis=-1).max()
    f = problem.stance.force * np.einsum("ij,ijk->ik", x.reshape(-1, 3), problem.frames)
    return mu, f, twist / fastest if mu > 0.0 else 0.0 * twist, OK


def needed(problem: Carrying) -> float | None:
    """The root of s; None where it is far."""
    low, high = 0.0, 0.5
    while reach(problem, high)[0] < 0.0:
        low, high = high, 8.0 * high
        if high > 1.0 / _STEEP:
            return None
    return _root(problem, low, high)


def _root(problem: Carrying, low: float, high: float) -> float:
    """The root of s between two coefficients: chords in 1 / mu, over which s is nearly straight, and halves where they do not help."""
    below, above = -np.inf, reach(problem, high)[0]
    for turn in range(100):
        share = below / (below - above) if turn % 4 and np.isfinite(below) else 0.5
        mu = 1.0 / ((1.0 - share) / low + share / high) if low > 0.0 else 0.2 * high
        s = reach(problem, mu)[0]
        if s >= 0.0:
            high, above = mu, s
        else:
            low, below = mu, s
        if abs(s) <= 1e-13 or high < 1e-12 or high - low <= 1e-13 * high:
            break
    return mu if high >= 1e-12 else 0.0


def reach(problem: Carrying, mu: float) -> tuple[float, Reals, Reals]:
    """The greatest s, or one above 4, forces x of it without it, and multipliers y."""
    normal = np.arange(problem.columns.shape[1]) % 3 == 0
    size = np.where(normal, 1.0, mu)
    found = greatest(Carrying(problem.columns * size, problem.b), problem.columns[:, normal].sum(axis=1), _ENOUGH)
    return found.s, size * found.x + found.s * normal, found.y


class Greatest(NamedTuple):
    """The greatest s of columns x + s sought = b with x in cones |tangential| <= normal, or one that is enough; x, multipliers y of the
    equations, and whether it is the greatest to 1e-9.
    """

    s: float
    x: Reals
    y: Reals
    closed: bool


def greatest(problem: Carrying, sought: Reals, enough: float) -> Greatest:
    """By a primal-dual interior-point method."""
    columns, normal = problem.columns, np.arange(problem.columns.shape[1]) % 3 == 0
    x, z = np.where(normal, 1.0, 0.0), np.where(normal, 1.0, 0.0)
    y, s, gap, lacking = np.zeros(len(problem.b)), 0.0, np.inf, np.inf
    for _ in range(60):
        primal, dual, last = problem.b - columns @ x - s * sought, columns.T @ y - z, 1.0 - sought @ y
        gap, lacking = float(x @ z), max(np.abs(primal).max(), np.abs(dual).max(), abs(last))
        if (gap <= 1e-14 and lacking <= 1e-13) or (s > enough and np.abs(primal).max() <= 1e-9):
            break
        V = _scaling(x, z)
        Q, R = np.linalg.qr(V @ columns.T)
        even, mean = V @ z, 3.0 * gap / len(x)
        target = np.zeros(len(x))
        for turn in range(2):
            g = target - even - V @ dual
            h = Q.T @ g - np.linalg.solve(R.T, primal)
            u = np.linalg.solve(R.T, sought)
            ds = min((last - u @ h) / (u @ u), 10.0 * (1.0 + abs(s)))
            h += ds * u
            dx, dy = V @ (g - Q @ h), np.linalg.solve(R, h)
            dz = columns.T @ dy + dual
            if turn == 0:
                share = 1.0 - min(1.0, _room(x, dx), _room(z, dz))
                missed = _divided(even, _product(g - Q @ h, -even - (g - Q @ h)))
                target = max(share**3, 1e-6) * mean * _divided(even, np.where(normal, 1.0, 0.0)) - missed
        along, across = min(1.0, 0.98 * _room(x, dx)), min(1.0, 0.98 * _room(z, dz))
        if not (_size(x + along * dx).min() > 0.0 and _size(z + across * dz).min() > 0.0):
            break
        x, s, z, y = x + along * dx, s + along * float(ds), z + across * dz, y + across * dy
    return Greatest(s, x, y, max(gap, lacking) <= 1e-9)


def _size(x: Reals) -> Reals:
    """normal^2 - |tangential|^2 of every cone."""
    across = np.hypot(x[1::3], x[2::3])
    return (x[::3] - across) * (x[::3] + across)


def _scaling(x: Reals, z: Reals) -> Reals:
    """Nesterov and Todd's V of all cones, V z = V^-1 x."""
    signs = np.tile([1.0, -1.0, -1.0], len(x) // 3)
    of_x, of_z = (np.sqrt(_size(item)).repeat(3) for item in (x, z))
    inner = (x / of_x * z / of_z).reshape(-1, 3).sum(axis=1).repeat(3)
    w = (x / of_x + signs * z / of_z) / np.sqrt(2.0 * (1.0 + inner))
    w[::3] += 1.0
    w /= np.sqrt(2.0 * w[::3]).repeat(3)
    V = np.diag(-signs)
    for i in range(0, len(x), 3):
        V[i : i + 3, i : i + 3] += 2.0 * np.outer(w[i : i + 3], w[i : i + 3])
    return np.sqrt(of_x / of_z)[:, None] * V


def _product(a: Reals, b: Reals) -> Reals:
    """The cones' product of vectors."""
    product = a[::3].repeat(3) * b + b[::3].repeat(3) * a
    product[::3] = (a * b).reshape(-1, 3).sum(axis=1)
    return product


def _divided(a: Reals, b: Reals) -> Reals:
    """u with the product a u = b."""
    u = np.empty_like(b)
    u[::3] = (a[::3] * b[::3] - a[1::3] * b[1::3] - a[2::3] * b[2::3]) / _size(a)
    for i in (1, 2):
        u[i::3] = (b[i::3] - a[i::3] * u[::3]) / a[::3]
    return u


def _room(x: Reals, d: Reals) -> float:
    """How far x + room d stays in the cones."""
    square = d[::3] ** 2 - d[1::3] ** 2 - d[2::3] ** 2
    mixed = x[::3] * d[::3] - x[1::3] * d[1::3] - x[2::3] * d[2::3]
    below = np.sqrt(np.maximum(mixed**2 - square * _size(x), 0.0)) - mixed
    return float(np.min(np.where(below > 0.0, _size(x) / np.where(below > 0.0, below, 1.0), 1e9)))

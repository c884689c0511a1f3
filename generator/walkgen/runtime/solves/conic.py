"""Least squares over cones of three numbers and half-spaces, many at once, by an interior point method that also proves infeasibility.

Minimise x'Px / 2 under A x = b, G x <= h and, with `round`, hypot(x_3i+1, x_3i+2) <= x_3i for every i. The homogeneous embedding of this
problem always has a solution: x / tau, or, where tau vanishes, multipliers that no x fits. Nesterov-Todd scaling, Mehrotra's corrector.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[Any]]
_STEPS = 60
_ENOUGH = 1e-15
_J = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True)
class Program:
    """Rows of programs: P [rows,n,n], A [rows,e,n], b [rows,e], G [rows,l,n], h [rows,l]; `round`: whether x has round cones."""

    P: Array
    A: Array
    b: Array
    G: Array
    h: Array
    round: bool


@dataclass(frozen=True)
class Point:
    """Of the embedding: x, multipliers y of A, slacks and multipliers s, z of G and of the cones (u, w [rows,n/3,3]), tau, kappa."""

    x: Array
    y: Array
    s: Array
    z: Array
    u: Array
    w: Array
    tau: Array
    kappa: Array

    def moved(self, step: "Point", length: Array) -> "Point":
        """By a length of its own for every row."""
        mine, others = vars(self), vars(step)
        return Point(**{name: mine[name] + length.reshape(-1, *[1] * (mine[name].ndim - 1)) * others[name] for name in mine})


@dataclass(frozen=True)
class _Scaling:
    """Nesterov and Todd's: u = W l, w = W^-1 l; the matrices of every cone."""

    W: Array
    inverse: Array
    point: Array


def solve(program: Program) -> Point:
    """The embedding's solution as far as it converges: the feasible programs' is x / tau."""
    rows, size = program.b.shape[0], program.P.shape[-1]
    cones, one = size // 3 if program.round else 0, np.ones(rows)
    apex = np.broadcast_to([1.0, 0.0, 0.0], (rows, cones, 3))
    slack = np.ones_like(program.h)
    point = Point(np.zeros((rows, size)), np.zeros_like(program.b), slack, slack, apex, apex, one, one)
    open_rows = np.ones(rows, bool)
    for _ in range(_STEPS):
        with np.errstate(all="ignore"):
            step = _step(program, point)
            length = 0.99 * _longest(point, step)
            after = point.moved(step, np.where(open_rows & np.isfinite(length), length, 0.0))
            open_rows &= np.isfinite(length) & (_gap(after) < 2.0 * _gap(point)) & (length > 1e-7)
        point = Point(
            **{name: np.where(open_rows.reshape(-1, *[1] * (new.ndim - 1)), new, vars(point)[name]) for name, new in vars(after).items()}
        )
        open_rows &= _gap(point) > _ENOUGH * np.maximum(point.tau, point.kappa) ** 2
        if not open_rows.any():
            break
    return point


def _gap(point: Point) -> Array:
    """Mean product of slacks and multipliers."""
    pairs = (point.s * point.z).sum(-1) + (point.u * point.w).sum((-1, -2)) + point.tau * point.kappa
    return np.asarray(pairs / (point.s.shape[-1] + point.u.shape[-2] + 1))


def _step(program: Program, point: Point) -> Point:
    """Mehrotra's: the direction towards the solution, and the one that corrects it and keeps to the middle."""
    scaling, mean = _scaling(point), _gap(point)
    zero = np.zeros_like(point.s), np.zeros_like(point.u), np.zeros_like(point.tau)
    affine = _direction(program, point, scaling, zero, zero, np.zeros_like(mean))
    centring = (1.0 - np.clip(_longest(point, affine), 0.0, 1.0)) ** 3
    target = centring * mean
    round_target = target[:, None, None] * np.array([1.0, 0.0, 0.0])
    inner, outer = (np.einsum("rcij,rcj->rci", matrix, part) for matrix, part in ((scaling.inverse, affine.u), (scaling.W, affine.w)))
    middle = np.broadcast_to(target[:, None], point.s.shape), np.broadcast_to(round_target, point.u.shape), target
    products = affine.s * affine.z, _product(inner, outer), affine.tau * affine.kappa
    return _direction(program, point, scaling, middle, products, centring)


def _direction(
    program: Program, point: Point, scaling: _Scaling, middle: tuple[Array, ...], products: tuple[Array, ...], kept: Array
) -> Point:
    """Newton's: residuals shrink to the share `kept`, products of slacks and multipliers go to `middle`."""
    share = 1.0 - kept
    fall = middle[0] - products[0] - point.s * point.z
    bend = middle[1] - products[1] - _product(scaling.point, scaling.point)
    turn = np.einsum("rcij,rcj->rci", scaling.inverse, _quotient(scaling.point, bend))
    residuals = _residuals(program, point)
    rest = tuple(share[:, None] * part for part in residuals[:3])
    wanted = _inner(program, point, scaling, rest, fall, turn, share[:, None, None] * (_thirds(point.x, point.u) - point.u))
    tangent = _inner(program, point, scaling, (0.0 * rest[0], program.b, program.h), 0.0 * fall, 0.0 * turn, 0.0 * turn)
    xi = point.x / point.tau[:, None]
    slope = 2.0 * np.einsum("rij,rj->ri", program.P, xi)
    steepness = np.einsum("ri,ri->r", slope, xi) / 2.0
    final = middle[2] - products[2] - point.tau * point.kappa
    known, per_tau = (_dot(slope, part[0]) + _dot(program.b, part[1]) + _dot(program.h, part[2]) for part in (wanted, tangent))
    tau = (-share * residuals[3] - final / point.tau - known) / (per_tau - steepness - point.kappa / point.tau)
    x, y, z = (first + tau[:, None] * second for first, second in zip(wanted, tangent, strict=True))
    u = _thirds(x, point.u) + share[:, None, None] * (_thirds(point.x, point.u) - point.u)
    w = turn - np.einsum("rcij,rcj->rci", scaling.inverse @ scaling.inverse, u)
    return Point(x, y, (fall - point.s * z) / point.z, z, u, w, tau, (final - point.kappa * tau) / point.tau)


def _residuals(program: Program, point: Point) -> tuple[Array, Array, Array, Array]:
    """What the rows of P, A, G and tau lack."""
    Px = np.einsum("rij,rj->ri", program.P, point.x)
    down = -Px - np.einsum("rei,re->ri", program.A, point.y) - np.einsum("rli,rl->ri", program.G, point.z)
    down[:, : 3 * point.w.shape[1]] += point.w.reshape(len(point.w), -1)
    balance = point.tau[:, None] * program.b - np.einsum("rei,ri->re", program.A, point.x)
    room = point.tau[:, None] * program.h - np.einsum("rli,ri->rl", program.G, point.x) - point.s
    end = point.kappa + _dot(point.x, Px) / point.tau + _dot(program.b, point.y) + _dot(program.h, point.z)
    return down, balance, room, end


def _inner(
    program: Program, point: Point, scaling: _Scaling, rest: tuple[Array, ...], fall: Array, turn: Array, apart: Array
) -> tuple[Array, Array, Array]:
    """dx, dy, dz of the linear system without tau; slacks are eliminated."""
    stiffness, rows = point.z / point.s, len(point.tau)
    size, balances = program.P.shape[-1], program.b.shape[-1]
    squares = scaling.inverse @ scaling.inverse
    matrix = np.zeros((rows, size + balances, size + balances))
    matrix[:, :size, :size] = program.P + np.einsum("rli,rl,rlj->rij", program.G, stiffness, program.G)
    for cone in range(squares.shape[1]):
        place = slice(3 * cone, 3 * cone + 3)
        matrix[:, place, place] += squares[:, cone]
    matrix[:, size:, :size] = program.A
    matrix[:, :size, size:] = np.swapaxes(program.A, 1, 2)
    pushed = stiffness * (fall / point.z - rest[2])
    right = rest[0] - np.einsum("rli,rl->ri", program.G, pushed)
    right[:, : 3 * turn.shape[1]] += (turn - np.einsum("rcij,rcj->rci", squares, apart)).reshape(rows, -1)
    found = _solved(matrix, np.concatenate([right, rest[1]], -1))
    x = found[:, :size]
    return x, found[:, size:], stiffness * np.einsum("rli,ri->rl", program.G, x) + pushed


def _solved(matrix: Array, right: Array) -> Array:
    """Symmetrically scaled, refined once."""
    scale = 1.0 / np.sqrt(np.maximum(np.abs(matrix).max(-1), 1e-300))
    scaled = matrix * scale[:, :, None] * scale[:, None, :]
    lean = scaled + 1e-15 * np.eye(matrix.shape[-1])
    first = np.linalg.solve(lean, (right * scale)[..., None])
    second = first + np.linalg.solve(lean, (right * scale)[..., None] - scaled @ first)
    return np.asarray(second[..., 0] * scale)


def _scaling(point: Point) -> _Scaling:
    sizes = [np.sqrt(np.maximum((part * _J * part).sum(-1), 1e-300)) for part in (point.u, point.w)]
    u, w = point.u / sizes[0][..., None], point.w / sizes[1][..., None]
    middle = (u + _J * w) / (2.0 * np.sqrt((1.0 + (u * w).sum(-1)) / 2.0))[..., None]
    stretch = np.sqrt(sizes[0] / sizes[1])[..., None, None]
    W, inverse = stretch * _boost(middle), _boost(_J * middle) / stretch
    return _Scaling(W, inverse, np.einsum("rcij,rcj->rci", W, point.w))


def _boost(middle: Array) -> Array:
    """The symmetric matrix of determinant 1 that takes the apex' axis to `middle`."""
    found = np.zeros((*middle.shape, 3))
    found[..., 0, :] = found[..., :, 0] = middle
    aside = middle[..., 1:]
    found[..., 1:, 1:] = np.eye(2) + aside[..., :, None] * aside[..., None, :] / (1.0 + middle[..., :1, None])
    return found


def _product(a: Array, b: Array) -> Array:
    """Jordan's of the cone's algebra."""
    return np.concatenate([(a * b).sum(-1, keepdims=True), a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:]], -1)


def _quotient(a: Array, b: Array) -> Array:
    """The c with a * c = b."""
    size = (a * _J * a).sum(-1, keepdims=True)
    first = (b * _J * a).sum(-1, keepdims=True) / size
    return np.concatenate([first, (b[..., 1:] - first * a[..., 1:]) / a[..., :1]], -1)


def _longest(point: Point, step: Point) -> Array:
    """How far slacks and multipliers stay inside, at most 1."""
    found = np.ones(len(point.tau))
    pairs = [(point.s, step.s), (point.z, step.z), (point.tau[:, None], step.tau[:, None]), (point.kappa[:, None], step.kappa[:, None])]
    for here, change in pairs:
        found = np.minimum(found, np.where(change < 0.0, -here / np.where(change < 0.0, change, 1.0), np.inf).min(-1, initial=np.inf))
    for here, change in ((point.u, step.u), (point.w, step.w)):
        found = np.minimum(found, _cone_length(here, change).min(-1, initial=np.inf))
    return found


def _cone_length(here: Array, change: Array) -> Array:
    """The least positive root of the boundary's quadratic equation."""
    a, b, c = ((p * _J * q).sum(-1) for p, q in ((change, change), (here, change), (here, here)))
    below = np.sqrt(np.maximum(b * b - a * c, 0.0)) - b  # the roots are real: where they seem not to be they are one, along the axis
    return np.where(below > 0.0, c / np.where(below > 0.0, below, 1.0), np.inf)


def _thirds(x: Array, like: Array) -> Array:
    """x by cones; nothing where there are none."""
    return np.asarray(x[:, : 3 * like.shape[1]].reshape(like.shape))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("ri,ri->r", a, b))

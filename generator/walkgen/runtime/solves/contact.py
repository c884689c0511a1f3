"""Least forces with which feet carry a load within their friction cones: the reference of walkgen_contact.h and its limited form."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.conic import Array, Point, Program, solve
from walkgen.runtime.solves.contact_edge import at_corner, at_edge
from walkgen.runtime.solves.contact_program import Scales, Stance, build, sharpened
from walkgen.signature import STATUSES

MAX_FEET = 16
MAX_FACETS = 1024
STICK, SLIDE, FREE = range(3)
_OK, _BAD_INPUT, _NO_CONVERGENCE, _INFEASIBLE = (STATUSES.index(name) for name in ("OK", "BAD_INPUT", "NO_CONVERGENCE", "INFEASIBLE"))
_ARRAYS = ("points", "normals", "mu", "wrench", "weight", "n_max", "torque_rows", "limits")
_UNIT = 1e-9
_FAIR = 1e-10
_EDGE = 1e-9


class Contact(NamedTuple):
    """Forces f [...,k,3], status [...], state [...,k] (0 stick, 1 slide, 2 free), certificate [...,6], violation [...], and
    the limits' multipliers.
    """

    f: Array
    status: Array
    state: Array
    certificate: Array
    violation: Array
    multipliers: Array


def contact_least_squares(
    points: ArrayLike,
    normals: ArrayLike,
    mu: ArrayLike,
    wrench: ArrayLike,
    weight: ArrayLike = 1.0,
    n_max: ArrayLike = np.inf,
    facets: ArrayLike = 0,
) -> tuple[Array, Array, Array, Array, Array]:
    """Forces f_i of the ground with sum (f_i, p_i x f_i) + wrench = 0 in their cones, of least sum of weight_i |f_i|^2.

    Args:
        points: of contact [..., k, 3], m.
        normals: unit vectors out of the ground [..., k, 3].
        mu: coefficients of friction [..., k].
        wrench: load on the robot [..., 6]: force, moment about the origin.
        weight: above 0 [..., k].
        n_max: the greatest normal forces [..., k], N.
        facets: 0 for circular cones, else the number of sides (3 to 1024) of the pyramids inside them.

    Returns:
        f, status, state, certificate, violation of `Contact`; NaN forces unless OK.
        INFEASIBLE: certificate . wrench = 1 and certificate . (f, p x f) >= 0 for all forces in cones (with n_max:
        above -1). BAD_INPUT: NaN. NO_CONVERGENCE: neither forces nor certificate verified.
    """
    none = np.zeros((0, 1, 3)), np.zeros(0)
    return contact_limited(points, normals, mu, wrench, weight, n_max, facets, *none)[:5]


def contact_limited(
    points: ArrayLike,
    normals: ArrayLike,
    mu: ArrayLike,
    wrench: ArrayLike,
    weight: ArrayLike,
    n_max: ArrayLike,
    facets: ArrayLike,
    torque_rows: ArrayLike,
    torque_limits: ArrayLike,
) -> Contact:
    """The same forces with sum_i torque_rows[r,i] . f_i <= torque_limits[r], e.g. a leg's rows of -J^T for the least torques.

    Args:
        points: as `contact_least_squares` takes them, like the others.
        normals: [..., k, 3].
        mu: [..., k].
        wrench: [..., 6].
        weight: [..., k].
        n_max: [..., k].
        facets: 0 or 3 to 1024.
        torque_rows: [..., rows, k, 3], m.
        torque_limits: [..., rows], N m.

    Returns:
        As `contact_least_squares`; multipliers [..., rows] >= 0 of the certificate: certificate . wrench - multipliers . limits is 1,
        and certificate . (f, p x f) + multipliers . rows f >= 0 for all forces in cones (with n_max: above -1).
    """
    stance, sides, shape = _read(points, normals, mu, wrench, weight, n_max, facets, torque_rows, torque_limits)
    feet, rows = stance.mu.shape[1], stance.limits.shape[1]
    found = _blank(len(sides), feet, rows)
    for kind in np.unique(sides):
        alike = Stance(**_taken(stance, np.arange(len(sides))), facets=int(kind))
        fine = np.flatnonzero(_fine(alike) & (sides == kind))
        for chosen in np.array_split(fine, max(1, len(fine) // 200)):
            if len(chosen):
                for whole, part in zip(found, _solved(Stance(**_taken(alike, chosen), facets=int(kind))), strict=True):
                    whole[chosen] = part
    return Contact(*(value.reshape((*shape, *value.shape[1:])) for value in found))


def _taken(stance: Stance, rows: Array) -> dict[str, Array]:
    return {name: getattr(stance, name)[rows] for name in _ARRAYS}


def _read(*arguments: ArrayLike) -> tuple[Stance, Array, tuple[int, ...]]:
    """Broadcast, with one leading dimension; the facets of every row; the leading shape."""
    points, normals, mu, wrench, weight, n_max, facets, torque_rows, limits = (np.asarray(item) for item in arguments)
    k = points.shape[-2]
    inner = [(k, 3), (k, 3), (k,), (6,), (k,), (k,), (limits.shape[-1], k, 3), (limits.shape[-1],)]
    values = [points, normals, mu, wrench, weight, n_max, torque_rows, limits]
    values = [np.broadcast_to(item, np.broadcast_shapes(item.shape, part)) for item, part in zip(values, inner, strict=True)]
    shape = np.broadcast_shapes(facets.shape, *(item.shape[: item.ndim - len(part)] for item, part in zip(values, inner, strict=True)))
    rows = math.prod(shape)
    flat = [np.array(np.broadcast_to(item, (*shape, *part)), float).reshape(rows, *part) for item, part in zip(values, inner, strict=True)]
    mine = dict(zip(_ARRAYS, flat, strict=True))
    none = mine["limits"] == np.inf  # a limit that never binds is that of no row
    mine["limits"][none], mine["torque_rows"][none] = 1.0, 0.0
    return Stance(**mine, facets=0), np.broadcast_to(facets, shape).ravel(), shape


def _fine(stance: Stance) -> Array:
    """Which stances are ones."""
    rows, k = stance.mu.shape
    if not 1 <= k <= MAX_FEET or not (stance.facets == 0 or 3 <= stance.facets <= MAX_FACETS):
        return np.zeros(rows, bool)
    with np.errstate(all="ignore"):
        finite = [np.isfinite(item).reshape(rows, -1).all(-1) for item in (stance.points, stance.wrench, stance.weight, stance.torque_rows)]
        unit = np.abs((stance.normals**2).sum(-1) - 1.0) <= 2.0 * _UNIT
        feet = unit & (stance.mu >= 0.0) & (stance.mu <= 1.0 / _UNIT) & (stance.weight > 0.0) & (stance.n_max >= 0.0)
        limits = stance.limits > -np.inf
    return np.asarray(np.all(finite, 0) & feet.all(-1) & limits.all(-1))


def _blank(rows: int, k: int, limits: int) -> Contact:
    """Of bad inputs."""
    vectors = [np.full((rows, *size), np.nan) for size in ((k, 3), (6,), (), (limits,))]
    status, state = np.full(rows, _BAD_INPUT, np.int32), np.full((rows, k), FREE, np.int32)
    return Contact(vectors[0], status, state, *vectors[1:])


def _solved(stance: Stance) -> Contact:
    """Of good inputs: forces that were verified, else certificates that were, else NO_CONVERGENCE."""
    rows, k = stance.mu.shape
    program, scales = build(stance)
    found = _blank(rows, k, stance.limits.shape[1])
    found.status[:] = _NO_CONVERGENCE
    for part in (found.certificate, found.violation, found.multipliers):
        part[:] = 0.0
    _unbearable(scales, program, found)
    point = solve(program)
    with np.errstate(all="ignore"):
        _refuse(stance, scales, program, point, found)
        coarse = point.x / point.tau[:, None]
        for x in (sharpened(program, point, stance.facets), coarse):
            _accept(stance, scales, program, x, coarse, found)
        _decide(stance, scales, program, found)
    return found


def _decide(stance: Stance, scales: Scales, program: Program, found: Contact) -> None:
    """Near the edge of what can be carried, for feet without bounds and limits: any forces that carry the load, or a proof."""
    bound = np.isfinite(stance.n_max).any(-1) | np.any(stance.torque_rows != 0.0, axis=(-1, -2, -3))
    near = ~bound & (found.status == _NO_CONVERGENCE)
    x = np.full(program.A[:, 0].shape, np.nan)
    for row in np.flatnonzero(near):
        given = stance.points[row], stance.normals[row], stance.mu[row], stance.wrench[row]
        edge = at_corner(*given, stance.facets) if stance.facets else at_edge(*given)
        x[row] = (np.linalg.pinv(scales.bases[row]) @ edge.f[..., None]).ravel() / scales.force[row]
        found.certificate[row] = edge.certificate
    _accept(stance, scales, program, x, x, found)
    costs = _costs(stance, found)
    least = _least_product(stance, np.einsum("rkij,rki->rkj", scales.bases, costs) * scales.force[:, None, None]).min(-1)
    proven = near & (found.status == _NO_CONVERGENCE) & (least >= -_EDGE)
    found.status[proven] = _INFEASIBLE
    found.violation[proven] = 1.0 / _sizes(costs)[proven]
    found.certificate[found.status != _INFEASIBLE] = 0.0


def _unbearable(scales: Scales, program: Program, found: Contact) -> None:
    """Load components that no force of these feet has."""
    noise = 4096.0 * np.finfo(float).eps * (1.0 + np.linalg.norm(scales.centre, axis=-1) / scales.length)
    over = np.where(scales.lost, np.abs(program.b), 0.0)
    worst = over.argmax(-1)
    rows = np.flatnonzero(over.max(-1) > noise)
    y = np.zeros_like(program.b)
    y[rows, worst[rows]] = -1.0 / program.b[rows, worst[rows]]
    found.certificate[rows] = _certificate(scales, y)[rows]
    found.violation[rows] = np.inf
    found.status[rows] = _INFEASIBLE
    program.b[scales.lost] = 0.0


def _certificate(scales: Scales, y: Array) -> Array:
    """Multipliers of the scaled balance in the inputs' frame and units."""
    turned = np.einsum("rij,rj->ri", scales.axes, y)
    moment = turned[:, 3:] / scales.length[:, None]
    return np.concatenate([turned[:, :3] - np.cross(moment, scales.centre), moment], -1) / scales.force[:, None]


def _refuse(stance: Stance, scales: Scales, program: Program, point: Point, found: Contact) -> None:
    """Where tau vanishes, multipliers are verified: y . A f + multipliers . rows f at least that of n_max for all f in cones."""
    k, sides = stance.mu.shape[1], stance.facets * stance.mu.shape[1]
    torque, bounds = point.z[:, k + sides :], point.z[:, :k]
    gain = -(program.b * point.y).sum(-1) - (program.h[:, k + sides :] * torque).sum(-1)
    y, multipliers = point.y / gain[:, None], torque / gain[:, None]
    cost = np.einsum("rei,re->ri", program.A, y) + np.einsum("rti,rt->ri", program.G[:, k + sides :], multipliers)
    least = _least_product(stance, cost.reshape(len(y), k, 3))
    top = stance.n_max / scales.force[:, None] / np.linalg.norm(scales.bases[..., 0], axis=-1)
    lost = np.where(np.isfinite(top) & (bounds > 0.0), np.maximum(-least, 0.0) * np.where(np.isfinite(top), top, 0.0), 0.0).sum(-1)
    exact = np.where(np.isfinite(top), 0.0, np.minimum(least, 0.0)).min(-1)
    proven = (
        (gain > 0.0) & (exact >= -_EDGE) & (lost < 1.0) & (point.tau < 1e-6 * np.maximum(point.kappa, 1.0)) & (found.status != _INFEASIBLE)
    )
    found.status[proven] = _INFEASIBLE
    found.certificate[proven] = _certificate(scales, y)[proven]
    found.multipliers[proven] = (multipliers / scales.row_sizes / (scales.force * scales.length)[:, None])[proven]
    found.violation[proven] = ((1.0 - lost) / _sizes(_costs(stance, found)))[proven]


def _costs(stance: Stance, found: Contact) -> Array:
    """What certificates multiply the feet's forces by [rows,k,3]."""
    turn = np.broadcast_to(found.certificate[:, None, 3:], stance.points.shape)
    turned = found.certificate[:, None, :3] + np.cross(turn, stance.points)
    return np.asarray(turned + np.einsum("rtki,rt->rki", stance.torque_rows, found.multipliers))


def _sizes(costs: Array) -> Array:
    """Forces that are nearer to the cones than 1 over this do not carry the load."""
    return np.asarray(np.sqrt((costs**2).sum((-1, -2))))


def _least_product(stance: Stance, cost: Array) -> Array:
    """Of vectors' products with forces of x_0 = 1 in the cones: the least."""
    aside = np.hypot(cost[..., 1], cost[..., 2])
    if stance.facets:
        angle = 2.0 * np.pi / stance.facets * (np.arange(stance.facets) + 0.5)
        aside = np.max([-cost[..., 1] * np.cos(turn) - cost[..., 2] * np.sin(turn) for turn in angle], 0)
    return np.asarray(cost[..., 0] - aside)


def _accept(stance: Stance, scales: Scales, program: Program, x: Array, coarse: Array, found: Contact) -> None:
    """Forces that balance and lie in their cones, near those of the interior point; the feet's states."""
    k = stance.mu.shape[1]
    size = np.maximum(1.0, np.abs(coarse).max(-1))
    lacking = np.linalg.norm(program.b - np.einsum("rei,ri->re", program.A, x), axis=-1)
    parts = x.reshape(len(x), k, 3)
    depth = parts[..., 0] - _reach(stance, parts)
    over = (np.einsum("rli,ri->rl", program.G, x) - program.h).max(-1, initial=-np.inf)
    rounding = np.minimum(10.0 * _FAIR, 2.0 * np.finfo(float).eps * size)  # large forces cannot balance better
    fits = (depth.min(-1) >= -_FAIR) & (over <= _FAIR) & (lacking <= np.maximum(_FAIR, rounding))
    fits &= (np.abs(x - coarse).max(-1) <= 1e-3 * size) & (found.status == _NO_CONVERGENCE)
    bears = parts[..., 0] > _EDGE * size[:, None]
    slides = (depth <= _EDGE * size[:, None]) | (stance.mu == 0.0)
    state = np.where(bears, np.where(slides, SLIDE, STICK), FREE)
    f = np.einsum("rkij,rkj->rki", scales.bases, parts) * scales.force[:, None, None]
    found.f[fits], found.state[fits], found.status[fits] = f[fits], state[fits], _OK
    found.violation[fits] = (lacking * scales.force)[fits]


def _reach(stance: Stance, parts: Array) -> Array:
    """How much of x_0 a foot's tangential part needs."""
    if stance.facets == 0:
        return np.asarray(np.hypot(parts[..., 1], parts[..., 2]))
    turn = 2.0 * np.pi / stance.facets * np.arange(stance.facets)
    reach = np.max([parts[..., 1] * np.cos(angle) + parts[..., 2] * np.sin(angle) for angle in turn], 0)
    return np.asarray(reach / np.cos(np.pi / stance.facets))

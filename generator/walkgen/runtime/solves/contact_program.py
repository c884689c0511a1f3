"""The contact forces as a program over cones: scaled, feet's axes inside, and its solution made sharp by Newton on the active set."""

from dataclasses import dataclass

import numpy as np

from walkgen.runtime.solves.conic import Array, Point, Program

_LOST = 64.0 * np.finfo(float).eps
_LEAN = 1e-13
_NOTHING = 1e-9


@dataclass(frozen=True)
class Stance:
    """Rows of stances: arrays as `least_squares` takes them, one leading dimension, with the limits' rows [rows,t,k,3], [rows,t]."""

    points: Array
    normals: Array
    mu: Array
    wrench: Array
    weight: Array
    n_max: Array
    torque_rows: Array
    limits: Array
    facets: int


@dataclass(frozen=True)
class Scales:
    """Units of force and length [rows], the feet's centre [rows,3], and what x is made of: f_i = bases_i x_i [rows,k,3,3]."""

    force: Array
    length: Array
    centre: Array
    bases: Array
    axes: Array
    lost: Array
    row_sizes: Array


def build(stance: Stance) -> tuple[Program, Scales]:
    """Forces over the load's size, lengths over the stance's, moments about the centre, balances in the principal axes of A A'."""
    rows, k = stance.mu.shape
    ease = 1.0 / stance.weight
    ease /= ease.max(-1, keepdims=True)
    centre = np.einsum("rk,rkj->rj", ease, stance.points) / ease.sum(-1)[:, None]
    arms = stance.points - centre[:, None]
    blur = _LOST * np.abs(stance.points).max((-1, -2))
    spread = np.abs(arms).max((-1, -2))
    length = np.where(spread > blur, spread, np.maximum(np.abs(stance.points).max((-1, -2)), 1e-300))
    wanted = -stance.wrench
    wanted = np.concatenate([wanted[:, :3], (wanted[:, 3:] - np.cross(centre, wanted[:, :3])) / length[:, None]], -1)
    sizes = np.concatenate([wanted, stance.limits / length[:, None]], -1)
    force = np.maximum(np.abs(sizes).max(-1), 1e-300)
    bases = _bases(stance)
    A = np.concatenate([bases, _crossed(arms / length[:, None, None], bases)], -2)
    A = np.moveaxis(A, 1, 2).reshape(rows, 6, 3 * k)
    axes, lost = _balances(A, np.maximum(1.0, np.linalg.norm(centre, axis=-1) / length))
    G, h, row_sizes = _half_spaces(stance, bases, force, length)
    P = np.zeros((rows, 3 * k, 3 * k))
    heavy = stance.weight / stance.weight.max(-1, keepdims=True)
    for foot in range(k):
        block = slice(3 * foot, 3 * foot + 3)
        P[:, block, block] = heavy[:, foot, None, None] * np.swapaxes(bases[:, foot], -1, -2) @ bases[:, foot]
    kept = ~lost[:, :, None]
    b = np.einsum("rij,ri->rj", axes, wanted / force[:, None])
    program = Program(P, np.swapaxes(axes, 1, 2) @ A * kept, b, G, h, stance.facets == 0)
    return program, Scales(force, length, centre, bases, axes, lost, row_sizes)


def _bases(stance: Stance) -> Array:
    """Columns: along the normal, and the tangents as far as friction reaches, by 1 / sqrt(1 + mu^2)."""
    n = stance.normals
    axis = np.where(np.abs(n[..., :1]) > 0.9, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    first = axis - (axis * n).sum(-1, keepdims=True) * n
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    cosine = 1.0 / np.sqrt(1.0 + stance.mu**2)
    sine = stance.mu * cosine
    return np.stack([cosine[..., None] * n, sine[..., None] * first, sine[..., None] * np.cross(n, first)], -1)


def _crossed(arms: Array, bases: Array) -> Array:
    return np.cross(arms[..., None], bases, axisa=-2, axisb=-2, axisc=-2)


def _balances(A: Array, far: Array) -> tuple[Array, Array]:
    """Axes of A A' [rows,6,6] (columns) and which of them no force moves [rows,6]."""
    axes, sizes, _ = np.linalg.svd(A, full_matrices=False) if A.shape[-1] >= A.shape[-2] else _wide(A)
    return axes, sizes <= _LOST * far[:, None] * sizes[:, :1]


def _wide(A: Array) -> tuple[Array, Array, Array]:
    padded = np.concatenate([A, np.zeros((*A.shape[:-1], 6 - A.shape[-1]))], -1)
    axes, sizes, others = np.linalg.svd(padded)
    return axes, sizes, others


def _half_spaces(stance: Stance, bases: Array, force: Array, length: Array) -> tuple[Array, Array, Array]:
    """G x <= h of bounded normal forces, of the polygons' sides and of the limits, every row of size 1; the limits' rows' sizes."""
    rows, k = stance.mu.shape
    cosine = np.linalg.norm(bases[..., 0], axis=-1)
    top = stance.n_max / force[:, None]
    bounded = np.isfinite(top)
    size = np.where(bounded, np.maximum(cosine, top), 1.0)
    bounds = np.zeros((rows, k, 3 * k))
    bounds[:, np.arange(k), 3 * np.arange(k)] = np.where(bounded, cosine / size, 0.0)
    parts, ends = [bounds], [np.where(bounded, top / size, 1.0)]
    if stance.facets:
        angle = 2.0 * np.pi / stance.facets * np.arange(stance.facets)
        side = np.stack([np.full(stance.facets, -np.cos(np.pi / stance.facets)), np.cos(angle), np.sin(angle)], -1)
        sides = np.einsum("kl,fi->kfli", np.eye(k), side).reshape(k * stance.facets, 3 * k)
        parts.append(np.broadcast_to(sides, (rows, *sides.shape)))
        ends.append(np.zeros((rows, len(sides))))
    torque = np.einsum("rtkj,rkji->rtki", stance.torque_rows, bases).reshape(rows, stance.limits.shape[1], 3 * k) / length[:, None, None]
    limit = stance.limits / (force * length)[:, None]
    sizes = np.maximum(np.abs(torque).max(-1), np.abs(np.where(np.isfinite(limit), limit, 0.0)))
    idle = (sizes == 0.0) | np.isposinf(limit)
    sizes = np.where(idle, 1.0, sizes)
    parts.append(np.where(idle[..., None], 0.0, torque / sizes[..., None]))
    ends.append(np.where(idle, 1.0, limit / sizes))
    return np.concatenate(parts, 1), np.concatenate(ends, 1), sizes


@dataclass(frozen=True)
class _Active:
    """Which cones' apexes and surfaces and which half-spaces (their indices `chosen` of G) hold x."""

    apex: Array
    surface: Array
    chosen: Array
    tight: Array


def sharpened(program: Program, point: Point, sides: int) -> Array:
    """x of the feasible programs, by Newton's method on the conditions of the active set that the interior point tells.

    `sides` of a foot's polygon, 0 for round cones.
    """
    tau = point.tau[:, None]
    x, y, z = point.x / tau, point.y / tau, point.z / tau
    active = _active(program, point, sides)
    z = np.where(active.tight, np.take_along_axis(z, active.chosen, 1), 0.0)
    pull = np.where(active.surface, point.w[..., 0] / np.maximum(point.u[..., 0], 1e-300), 0.0)
    lean = _LEAN * np.diag(np.repeat([1.0, -1.0], [x.shape[1], y.shape[1] + z.shape[1] + pull.shape[1]]))
    for _ in range(5):
        matrix, rest = _conditions(program, active, (x, y, z, pull))
        with np.errstate(all="ignore"):
            usable = np.asarray(np.isfinite(matrix).all((-1, -2)) & np.isfinite(rest).all(-1))
        matrix, rest = np.where(usable[:, None, None], matrix + lean, np.eye(rest.shape[1])), np.where(usable[:, None], rest, 0.0)
        step = np.linalg.solve(matrix, rest[..., None])[..., 0]
        cuts = np.cumsum([x.shape[1], y.shape[1], z.shape[1]])
        x, y, z, pull = (now + change for now, change in zip((x, y, z, pull), np.split(step, cuts, axis=1), strict=True))
    return x


def _active(program: Program, point: Point, sides: int) -> _Active:
    rows, k = point.x.shape[0], point.x.shape[1] // 3
    normal = np.asarray(point.x.reshape(rows, k, 3)[..., 0])
    apex = np.asarray(normal <= _NOTHING * np.abs(normal).max(-1, keepdims=True))
    surface = np.zeros((rows, point.w.shape[1]), bool)
    if program.round:
        room, push = (part[..., 0] - np.hypot(part[..., 1], part[..., 2]) for part in (point.u, point.w))
        apex = np.asarray(point.u[..., 0] < push)
        surface = (point.w[..., 0] >= room) & ~apex
    idle = np.zeros(point.s.shape, bool)
    idle[:, k : k + k * sides] = np.repeat(apex, sides, axis=1)
    excess = np.where(idle, np.inf, point.s - point.z)
    chosen = np.argsort(excess, axis=1)[:, : 4 * k]
    return _Active(apex, surface, chosen, np.take_along_axis(excess < 0.0, chosen, 1))


def _conditions(program: Program, active: _Active, at: tuple[Array, Array, Array, Array]) -> tuple[Array, Array]:
    """The matrix and minus the residuals of stationarity, balance, half-spaces and cones' surfaces."""
    x, y, z, pull = at
    rows, size = x.shape
    G, h = np.take_along_axis(program.G, active.chosen[..., None], 1), np.take_along_axis(program.h, active.chosen, 1)
    cones = pull.shape[1]
    normal = np.zeros((rows, cones, size))
    bend = np.zeros((rows, size, size))
    for cone in range(cones):
        place = slice(3 * cone, 3 * cone + 3)
        normal[:, cone, place] = x[:, place] * [-1.0, 1.0, 1.0]
        bend[:, place, place] = pull[:, cone, None, None] * np.diag([-1.0, 1.0, 1.0])
    level = 0.5 * (normal * x[:, None]).sum(-1)
    columns = np.concatenate([program.A, G, normal], 1)
    total = size + columns.shape[1]
    matrix, rest = np.zeros((rows, total, total)), np.zeros((rows, total))
    matrix[:, :size, :size] = program.P + bend
    matrix[:, :size, size:] = np.swapaxes(columns, 1, 2)
    matrix[:, size:, :size] = columns
    multipliers = np.concatenate([y, z, pull], 1)
    rest[:, :size] = -np.einsum("rij,rj->ri", program.P, x) - np.einsum("rli,rl->ri", columns, multipliers)
    values = [program.b - np.einsum("rei,ri->re", program.A, x), h - np.einsum("rli,ri->rl", G, x), -level]
    rest[:, size:] = np.concatenate(values, 1)
    held = np.concatenate([np.repeat(active.apex, 3, axis=1), np.zeros_like(y, bool), ~active.tight, ~active.surface], 1)
    whole = np.concatenate([x, y, z, pull], 1)
    return np.where(held[:, :, None], np.eye(total), matrix), np.where(held, -whole, rest)

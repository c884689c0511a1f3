"""The point of a patch's surface nearest to another: bounded damped Newton steps from the surface over the point."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.model.terrain import Explicit, HeightMap, Implicit, Parametric, Patch, Plane
from walkgen.signature import Port
from walkgen.symbolic.choices import at_most, both, chosen, less
from walkgen.symbolic.damping import FIRST, stepped, taken
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Finite, Function, Same, Step
from walkgen.symbolic.jets import Jet, ratio
from walkgen.symbolic.locate import Search, map_data
from walkgen.symbolic.ports import parameter_ports, signature
from walkgen.symbolic.surfaces import POINT, Surfaces, located_port
from walkgen.symbolic.tape import Tape, Vec, dot, minus, scaled, symbols_of

_STEPS = 40
_CONVEX = sympy.Rational(1, 10**4)
Chart = Explicit | Parametric


@dataclass(frozen=True)
class Foot:
    """A nearest point (m): whether it is in the patch's domain, whether the distance is stationary there, whether it has a normal."""

    point: Vec
    inside: sympy.Basic
    close: sympy.Basic
    regular: sympy.Basic


def near_ports(patch: Patch) -> tuple[Port, ...]:
    """What is iterated: x, y, z, multiplier; u, v, damping; of a height map the foot and the routine's status; of a plane nothing."""
    name = f"near_{patch.name}"
    if isinstance(patch.surface, HeightMap):
        return Port(name, (3,), "m"), Port(f"state_{patch.name}", kind="integer")
    if isinstance(patch.surface, Plane):
        return ()
    return (Port(name, (4 if isinstance(patch.surface, Implicit) else 3,)),)


def descent(mechanism: Mechanism, owner: str, patch: Patch, found: Search) -> Search:
    """The steps that fill `near_ports` from `p` and what was located, after those that locate it, which are `found`."""
    surface = patch.surface
    if isinstance(surface, Plane):
        return found
    if isinstance(surface, HeightMap):
        return _mapped(mechanism, owner, patch, surface, found)
    parameters = parameter_symbols(mechanism)
    start, step = Surfaces(Tape(), parameters), Surfaces(Tape(), parameters)
    (near,) = near_ports(patch)
    located = [port for port in (located_port(patch),) if port]
    sheet_z = start.sheet(patch).z
    if isinstance(surface, Implicit):
        begin, outputs = [*start.point[:2], sheet_z, sympy.S.Zero], _constrained(step, patch, surface, symbols_of(near))
    else:
        at = start.point[:2] if isinstance(surface, Explicit) else symbols_of(located[0])
        begin, outputs = [*at, FIRST], _damped(step, patch, surface, symbols_of(near))
    steps = (
        _step(mechanism, owner, patch, "near", start.tape, [POINT, *located], near, begin),
        _step(mechanism, owner, patch, "nearer", step.tape, [POINT, near], near, outputs, _STEPS),
    )
    return Search((*found.locals, near), (*found.steps, *steps), found.tables)


def _step(
    mechanism: Mechanism,
    owner: str,
    patch: Patch,
    word: str,
    tape: Tape,
    inputs: Sequence[Port],
    near: Port,
    outputs: Sequence[sympy.Expr],
    repeat: int = 1,
) -> Step:
    words = signature(mechanism, owner, f"{patch.name}_{word}", inputs, [Port(f"{near.name}_next", near.shape)], "", "")
    function: Function = tape.function(words, outputs)
    given = (*(port.name for port in inputs), *(port.name for port in parameter_ports(mechanism)))
    return Step(function, (*given, near.name), repeat=repeat)


def _mapped(mechanism: Mechanism, owner: str, patch: Patch, surface: HeightMap, found: Search) -> Search:
    table, grid, _ = map_data(mechanism, owner, patch, surface)
    near, state = near_ports(patch)
    numbers = (table.name, surface.rows, surface.columns, int(surface.bicubic))
    step = Step("wg_heightmap_project", (*numbers, grid.name, POINT.name, near.name, state.name))
    return Search((*found.locals, near, state), (*found.steps, step), found.tables)


def foot(surfaces: Surfaces, patch: Patch) -> Foot:
    """The nearest point, from what the steps left."""
    surface = patch.surface
    symbols = [symbol for port in near_ports(patch) for symbol in symbols_of(port)]
    if isinstance(surface, Plane):
        return _plane_foot(surfaces, patch, surface)
    if isinstance(surface, HeightMap):
        point = (symbols[0], symbols[1], symbols[2])
        return Foot(point, surfaces.over(patch, *point[:2]), Same(symbols[3], 0), Finite(symbols[2]))
    if isinstance(surface, Implicit):
        return _implicit_foot(surfaces, patch, surface, symbols)
    return _chart_foot(surfaces, patch, surface, symbols)


def _plane_foot(surfaces: Surfaces, patch: Patch, surface: Plane) -> Foot:
    """p - n (n (p - P)) / n^2."""
    point, normal = surfaces.vector("through", surface.point), surfaces.vector("across_plane", surface.normal)
    share = surfaces.tape.let("share", dot(normal, minus(surfaces.point, point)) / dot(normal, normal))
    there = surfaces.tape.vector(f"{patch.name}_foot", minus(surfaces.point, scaled(share, normal)))
    return Foot(there, surfaces.over(patch, *there[:2]), Finite(share), Finite(share))


def _chart(surfaces: Surfaces, patch: Patch, surface: Chart, u: sympy.Expr, v: sympy.Expr) -> tuple[Jet, Jet, Jet]:
    """x, y, z over (u, v); an explicit surface is its own chart."""
    if isinstance(surface, Parametric):
        return surfaces.parametric(patch.name, surface, u, v)
    one, nil = sympy.S.One, sympy.S.Zero
    flat = ((nil, nil), (nil, nil))
    return Jet(u, (one, nil), flat), Jet(v, (nil, one), flat), surfaces.explicit(patch.name, surface, u, v)


@dataclass(frozen=True)
class _Slope:
    """Half the squared distance over (u, v): value twice, gradient, first fundamental form and Hessian (uu, uv, vv)."""

    square: sympy.Expr
    gradient: tuple[sympy.Expr, sympy.Expr]
    metric: tuple[sympy.Expr, sympy.Expr, sympy.Expr]
    hessian: tuple[sympy.Expr, sympy.Expr, sympy.Expr]


def _slope(surfaces: Surfaces, r: tuple[Jet, Jet, Jet]) -> _Slope:
    tape = surfaces.tape
    away = tape.vector("away", [jet.value - at for jet, at in zip(r, surfaces.point, strict=True)])
    first = [[jet.first[a] for jet in r] for a in (0, 1)]
    pairs = ((0, 0), (0, 1), (1, 1))
    metric = [tape.let(f"metric_{'uv'[a]}{'uv'[b]}", dot(first[a], first[b])) for a, b in pairs]
    bent = [tape.let(f"bent_{'uv'[a]}{'uv'[b]}", metric[k] + dot(away, [jet.second[a][b] for jet in r])) for k, (a, b) in enumerate(pairs)]
    gradient = [tape.let(f"gradient_{'uv'[a]}", dot(first[a], away)) for a in (0, 1)]
    square = tape.let("square", dot(away, away))
    return _Slope(square, (gradient[0], gradient[1]), (metric[0], metric[1], metric[2]), (bent[0], bent[1], bent[2]))


def _damped(surfaces: Surfaces, patch: Patch, surface: Chart, near: Sequence[sympy.Expr]) -> list[sympy.Expr]:
    """A step, taken where it does not lead away; Gauss and Newton's where the distance is not convex; damped more after one not taken."""
    tape, (u, v, _) = surfaces.tape, near
    slope = _slope(surfaces, _chart(surfaces, patch, surface, u, v))
    uu, uv, vv = slope.hessian
    area = tape.let("area", uu * vv - uv**2)
    convex = both(both(less(0, uu), less(0, vv)), less(_CONVEX * uu * vv, area))
    choices = zip(("uu", "uv", "vv"), slope.hessian, slope.metric, strict=True)
    uu, uv, vv = (tape.let(f"curve_{word}", chosen(convex, here, other)) for word, here, other in choices)
    u2, v2 = stepped(tape, near, (uu, uv, vv), (slope.metric[0], slope.metric[2]), slope.gradient)
    ahead = _chart(surfaces, patch, surface, u2, v2)
    square = tape.let("square_ahead", sympy.Add(*((jet.value - at) ** 2 for jet, at in zip(ahead, surfaces.point, strict=True))))
    return taken(tape, near, (u2, v2), (slope.square, square), surfaces.roundoff())


def _chart_foot(surfaces: Surfaces, patch: Patch, surface: Chart, near: Sequence[sympy.Expr]) -> Foot:
    r = _chart(surfaces, patch, surface, near[0], near[1])
    slope = _slope(surfaces, r)
    point = (r[0].value, r[1].value, r[2].value)
    slack = surfaces.tape.let("slack", surfaces.tolerance() * _size(surfaces, point))
    share = sympy.Add(
        *(ratio(entry**2, square, near[0]) for entry, square in zip(slope.gradient, (slope.metric[0], slope.metric[2]), strict=True))
    )
    regular = less(0, slope.metric[0] * slope.metric[2] - slope.metric[1] ** 2)
    return Foot(point, surfaces.over(patch, near[0], near[1]), at_most(share, slack**2), regular)


def _size(surfaces: Surfaces, point: Sequence[sympy.Expr]) -> sympy.Expr:
    return 1 + sympy.Add(*(abs(entry) for entry in (*surfaces.point, *point)))


def _constrained(surfaces: Surfaces, patch: Patch, surface: Implicit, near: Sequence[sympy.Expr]) -> list[sympy.Expr]:
    """Newton's step for x - p + m grad f = 0, f = 0 in x and m; without the bending of f where its matrix is not positive."""
    tape = surfaces.tape
    x, multiplier = (near[0], near[1], near[2]), near[3]
    f = surfaces.implicit(patch.name, surface, x)
    matrix = [[tape.let(f"m{i}{j}", int(i == j) + multiplier * f.second[i][j]) for j in range(3)] for i in range(3)]
    inverse = _inverse_where_positive(tape, matrix)
    away = minus(x, surfaces.point)
    gradient = (f.first[0], f.first[1], f.first[2])
    along, back = (tape.vector(name, [dot(row, vector) for row in inverse]) for name, vector in (("along", gradient), ("back", away)))
    wanted = tape.let("multiplier", ratio(f.value - dot(gradient, back), dot(gradient, along), x[0]))
    step = tape.vector("step", [-b - wanted * a for a, b in zip(along, back, strict=True)])
    return [*(entry + part for entry, part in zip(x, step, strict=True)), wanted]


def _inverse_where_positive(tape: Tape, m: Sequence[Sequence[sympy.Expr]]) -> list[list[sympy.Expr]]:
    """The inverse of a positive definite symmetric matrix, the identity for another."""
    minor = tape.let("minor", m[0][0] * m[1][1] - m[0][1] ** 2)
    others = ((1, 2), (0, 2), (0, 1))
    cofactors = [
        [(-1) ** (i + j) * (m[a][c] * m[b][d] - m[a][d] * m[b][c]) for j in range(3) for (a, b), (c, d) in [(others[i], others[j])]]
        for i in range(3)
    ]
    named = [[tape.let(f"cofactor{i}{j}", cofactors[i][j]) for j in range(3)] for i in range(3)]
    det = tape.let("det", dot(m[0], named[0]))
    positive = both(both(less(0, m[0][0]), less(0, minor)), less(_CONVEX * m[2][2] * minor, det))
    return [
        [tape.let(f"inverse{i}{j}", chosen(positive, ratio(named[i][j], det, m[0][0]), sympy.Integer(i == j))) for j in range(3)]
        for i in range(3)
    ]


def _implicit_foot(surfaces: Surfaces, patch: Patch, surface: Implicit, near: Sequence[sympy.Expr]) -> Foot:
    """On the surface, and p along its normal."""
    tape, point = surfaces.tape, (near[0], near[1], near[2])
    f = surfaces.implicit(patch.name, surface, point)
    gradient = (f.first[0], f.first[1], f.first[2])
    square = tape.let("gradient2", dot(gradient, gradient))
    away = tape.vector("away", minus(point, surfaces.point))
    share = tape.let("share", ratio(dot(away, gradient), square, point[0]))
    side = tape.vector("side", minus(away, scaled(share, gradient)))
    slack = tape.let("slack", surfaces.tolerance() * _size(surfaces, point))
    close = both(at_most(dot(side, side), slack**2), at_most(ratio(f.value**2, square, point[0]), slack**2))
    return Foot(point, surfaces.over(patch, *point[:2]), close, less(0, square))

"""Finding where a patch lies over a point: bounded Newton steps along the vertical or in (u, v), height maps by their routine."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.model.terrain import HeightMap, Implicit, Parametric, Patch
from walkgen.signature import Port, Table
from walkgen.symbolic.choices import both, chosen, same
from walkgen.symbolic.damping import FIRST, stepped, taken
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Finite, Function, Less, LessEqual, Opposite, Select, Step
from walkgen.symbolic.jets import ratio
from walkgen.symbolic.ports import parameter_ports, signature
from walkgen.symbolic.surfaces import POINT, Surfaces, located_port
from walkgen.symbolic.tape import Tape, symbols_of

_VERTICAL_STEPS = 32
_PLANAR_STEPS = 32
_SHARE = sympy.Rational(9, 10)
_SHEETS = 4
"""Searches of a parametric surface: one in each quarter of its domain."""


@dataclass(frozen=True)
class Search:
    """What is computed before a patch is known at a point."""

    locals: tuple[Port, ...] = ()
    steps: tuple[Step, ...] = ()
    tables: tuple[Table, ...] = ()


def search(mechanism: Mechanism, owner: str, patch: Patch) -> Search:
    """The steps that fill the patch's `located_port` from `p`."""
    if isinstance(patch.surface, Implicit):
        return _vertical(_Writer(mechanism, owner, patch), patch.surface)
    if isinstance(patch.surface, Parametric):
        return _planar(_Writer(mechanism, owner, patch), patch.surface)
    return _mapped(_Writer(mechanism, owner, patch), patch.surface) if isinstance(patch.surface, HeightMap) else Search()


def joined(searches: Sequence[Search]) -> Search:
    """Several searches, one after the other."""
    return Search(*(tuple(entry for one in searches for entry in getattr(one, part)) for part in ("locals", "steps", "tables")))


class _Writer:
    """Makes the Functions of one patch's search."""

    def __init__(self, mechanism: Mechanism, owner: str, patch: Patch) -> None:
        self.mechanism, self.owner, self.patch = mechanism, owner, patch
        self.parameters = parameter_symbols(mechanism)
        self.given = tuple(port.name for port in parameter_ports(mechanism))

    @property
    def at(self) -> Port:
        """Where the patch is."""
        port = located_port(self.patch)
        assert port is not None
        return port

    def surfaces(self) -> Surfaces:
        """A new tape."""
        return Surfaces(Tape(), self.parameters)

    def step(self, word: str, tape: Tape, inputs: Sequence[Port], output: Port, outputs: Sequence[sympy.Expr], repeat: int = 1) -> Step:
        """A call of a Function `<patch>_<word>` on locals of the ports' names."""
        written = Port(f"{output.name}_next", output.shape, output.unit)
        words = signature(self.mechanism, self.owner, f"{self.patch.name}_{word}", inputs, [written], "", "")
        function: Function = tape.function(words, outputs)
        return Step(function, (*(port.name for port in inputs), *self.given, output.name), repeat=repeat)


def _vertical(writer: _Writer, surface: Implicit) -> Search:
    """Newton along the vertical from p's own height."""
    begin, surfaces = writer.surfaces(), writer.surfaces()
    x, y, _ = surfaces.point
    (z,) = symbols_of(writer.at)
    tape = surfaces.tape
    f = surfaces.implicit(writer.patch.name, surface, (x, y, z))
    newton = tape.let("newton", ratio(-f.value, f.first[2], x))
    onwards = chosen(same(f.value, 0), 0, 1)  # where f does not change along the vertical, 1 m up
    wanted = tape.let("wanted", Select(Finite(newton), newton, onwards))
    most = tape.let("most", 1 + abs(z))
    steps = (
        writer.step("start", begin.tape, [POINT], writer.at, [begin.point[2]]),
        writer.step("step", tape, [POINT, writer.at], writer.at, [z + _clamped(wanted, -most, most)], _VERTICAL_STEPS),
    )
    return Search((writer.at,), steps)


def _clamped(value: sympy.Expr, low: sympy.Expr, high: sympy.Expr) -> sympy.Expr:
    return Select(Less(value, low), low, Select(Less(high, value), high, value))


def _planar(writer: _Writer, surface: Parametric) -> Search:
    """Damped steps in (u, v) from the nearest of nine points in each quarter of the domain; of what is found, the nearest to p's height."""
    name = writer.patch.name
    found = Port(f"sheets_{name}", (_SHEETS, 3))
    begin, newton, choice = writer.surfaces(), writer.surfaces(), writer.surfaces()
    uv = symbols_of(found)
    starts = [entry for quarter in product((0, 1), repeat=2) for entry in _start(begin, writer, surface, quarter)]
    moved = [entry for sheet in range(_SHEETS) for entry in _newton(newton, writer, surface, uv[3 * sheet : 3 * sheet + 3])]
    steps = (
        writer.step("start", begin.tape, [POINT], found, starts),
        writer.step("step", newton.tape, [POINT, found], found, moved, _PLANAR_STEPS),
        writer.step("choice", choice.tape, [POINT, found], writer.at, _choice(choice, writer, surface, uv)),
    )
    return Search((found, writer.at), steps)


def _start(surfaces: Surfaces, writer: _Writer, surface: Parametric, quarter: tuple[int, ...]) -> tuple[sympy.Expr, ...]:
    """Of the quarter's nine points the one that is nearest in x and y; the damping to begin with."""
    ends = [_ends(writer, axis) for axis in (0, 1)]
    best: tuple[sympy.Expr, sympy.Expr] | None = None
    least = sympy.oo
    for place in product((0, 1, 2), repeat=2):
        shares = [sympy.Rational(6 * side + 2 * spot + 1, 12) for side, spot in zip(quarter, place, strict=True)]
        u, v = (
            surfaces.tape.let("uv"[axis], low + share * (high - low))
            for axis, ((low, high), share) in enumerate(zip(ends, shares, strict=True))
        )
        x, y, _ = surfaces.places(writer.patch.name, surface, u, v)
        away = surfaces.tape.let("away", (x - surfaces.point[0]) ** 2 + (y - surfaces.point[1]) ** 2)
        nearer = Less(away, least)
        best = (u, v) if best is None else (Select(nearer, u, best[0]), Select(nearer, v, best[1]))
        least = away if least == sympy.oo else surfaces.tape.let("least", Select(nearer, away, least))
        best = (surfaces.tape.let("u", best[0]), surfaces.tape.let("v", best[1]))
    assert best is not None
    return *best, FIRST


def _ends(writer: _Writer, axis: int) -> tuple[sympy.Expr, sympy.Expr]:
    interval = writer.patch.domain[axis]
    assert interval is not None
    low, high = (expression(end, writer.parameters) for end in interval)
    return low, high


def _newton(surfaces: Surfaces, writer: _Writer, surface: Parametric, at: Sequence[sympy.Expr]) -> list[sympy.Expr]:
    """One step towards (x, y) of the point, kept in the domain."""
    tape, spot = surfaces.tape, surfaces.point[:2]
    x, y, _ = surfaces.parametric(writer.patch.name, surface, at[0], at[1])
    miss = [tape.let(f"miss_{axis}", jet.value - place) for axis, jet, place in zip("xy", (x, y), spot, strict=True)]
    uu, uv, vv = (
        tape.let(f"metric_{'uv'[a]}{'uv'[b]}", x.first[a] * x.first[b] + y.first[a] * y.first[b]) for a, b in ((0, 0), (0, 1), (1, 1))
    )
    gradient = [tape.let(f"gradient_{'uv'[a]}", miss[0] * x.first[a] + miss[1] * y.first[a]) for a in (0, 1)]
    tried = stepped(tape, at, (uu, uv, vv), (uu, vv), gradient)
    ahead = [tape.let(f"ahead_{'uv'[a]}", _inside(at[a], tried[a], *_ends(writer, a))) for a in (0, 1)]
    there = surfaces.places(writer.patch.name, surface, *ahead)[:2]
    squares = (miss[0] ** 2 + miss[1] ** 2, sympy.Add(*((new - place) ** 2 for new, place in zip(there, spot, strict=True))))
    return taken(tape, at, ahead, (tape.let("square", squares[0]), tape.let("square_ahead", squares[1])), surfaces.roundoff())


def _inside(place: sympy.Expr, tried: sympy.Expr, low: sympy.Expr, high: sympy.Expr) -> sympy.Expr:
    """What is tried, or nine tenths of the way to the end that lies before it: at an end itself the surface may fold."""
    down, up = (place + _SHARE * (end - place) for end in (low, high))
    return Select(Less(tried, low), down, Select(Less(high, tried), up, tried))


def _choice(surfaces: Surfaces, writer: _Writer, surface: Parametric, uv: Sequence[sympy.Expr]) -> tuple[sympy.Expr, sympy.Expr]:
    """Of the sheets that lie over the point the one nearest to its height."""
    tape, (px, py, pz) = surfaces.tape, surfaces.point
    u, v = uv[0], uv[1]
    least = sympy.oo
    for sheet in range(_SHEETS):
        here = (uv[3 * sheet], uv[3 * sheet + 1])
        x, y, z = surfaces.places(writer.patch.name, surface, *here)
        close = LessEqual(abs(x - px) + abs(y - py), surfaces.tolerance() * (1 + abs(x) + abs(y)))
        away = tape.let("away", Select(close, abs(z - pz), sympy.oo))
        nearer = both(close, Opposite(LessEqual(least, away)))
        u, v = (tape.let(word, Select(nearer, new, old)) for word, new, old in zip("uv", here, (u, v), strict=True))
        least = away if least == sympy.oo else tape.let("least", Select(nearer, away, least))
    return u, v


def _mapped(writer: _Writer, surface: HeightMap) -> Search:
    """Height and derivatives, by the support routine."""
    table, grid, described = map_data(writer.mechanism, writer.owner, writer.patch, surface)
    numbers = (table.name, surface.rows, surface.columns, int(surface.bicubic))
    return Search((grid, writer.at), (described, Step("wg_heightmap", (*numbers, grid.name, POINT.name, writer.at.name))), (table,))


def map_data(mechanism: Mechanism, owner: str, patch: Patch, surface: HeightMap) -> tuple[Table, Port, Step]:
    """The heights; the local that holds corner and spacing, and what fills it."""
    writer = _Writer(mechanism, owner, patch)
    grid = Port(f"grid_{patch.name}", (3,), "m")
    table = Table(f"{mechanism.name}_{owner}_{patch.name}_heights", surface.heights, surface.columns)
    numbers = [expression(entry, writer.parameters) for entry in (*surface.corner, surface.spacing)]
    return table, grid, writer.step("grid", Tape(), [], grid, numbers)

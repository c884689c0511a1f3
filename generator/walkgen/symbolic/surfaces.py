"""Surfaces of the ground at a point: height, normal and bending from first and second derivatives (theory 4.1)."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.terrain import Explicit, HeightMap, Implicit, Interval, Parametric, Patch, Plane
from walkgen.signature import Port
from walkgen.spec.scalar import Vector
from walkgen.symbolic.frames import Parameters, expression
from walkgen.symbolic.function import Both, Epsilon, Finite, Less, LessEqual, Same, Select
from walkgen.symbolic.jets import Jet, Jets, ratio
from walkgen.symbolic.tape import Tape, Vec, cross, dot, symbols_of

POINT = Port("p", (3,), "m")
JET_SIZE = 6
_TOLERANCE = sympy.Rational(1, 10**9)
Symmetric = tuple[sympy.Expr, sympy.Expr, sympy.Expr, sympy.Expr, sympy.Expr, sympy.Expr]
"""xx, xy, xz, yy, yz, zz of a symmetric matrix."""


@dataclass(frozen=True)
class Sheet:
    """A patch over a point: whether it holds there, its height (m), a normal of any length and its bending (1/m).

    `bending` W gives the second fundamental form a' W b of tangent vectors for the unit normal along `normal`.
    """

    held: sympy.Basic
    z: sympy.Expr
    normal: Vec
    bending: Symmetric


def located_port(patch: Patch) -> Port | None:
    """What has to be found before the patch is known at a point: z; u and v; height and derivatives; nothing."""
    if isinstance(patch.surface, Implicit):
        return Port(f"at_{patch.name}", (1,), "m")
    if isinstance(patch.surface, Parametric):
        return Port(f"at_{patch.name}", (2,))
    return Port(f"at_{patch.name}", (JET_SIZE,), "m, 1, 1/m") if isinstance(patch.surface, HeightMap) else None


class Surfaces:
    """Patches on one tape at the point p and at what was located for them."""

    def __init__(self, tape: Tape, parameters: Parameters) -> None:
        self.tape, self._parameters = tape, parameters
        self.point: Vec = symbols_of(POINT)

    def sheet(self, patch: Patch) -> Sheet:
        """The patch over the point."""
        surface = patch.surface
        located = symbols_of(port) if (port := located_port(patch)) else ()
        if isinstance(surface, Plane):
            return self._plane(patch, surface)
        if isinstance(surface, Explicit):
            return self._graph(patch, self.explicit(patch.name, surface))
        if isinstance(surface, HeightMap):
            z, zx, zy, zxx, zxy, zyy = located
            return self._graph(patch, Jet(z, (zx, zy), ((zxx, zxy), (zxy, zyy))))
        if isinstance(surface, Implicit):
            return self._implicit(patch, surface, located[0])
        return self._parametric(patch, surface, located)

    def vector(self, name: str, vector: Vector) -> Vec:
        """A vector of the spec."""
        x, y, z = (expression(entry, self._parameters) for entry in vector)
        return self.tape.vector(name, (x, y, z))

    def within(self, value: sympy.Expr, interval: Interval | None) -> sympy.Basic:
        """Whether a coordinate is inside; anything finite without an interval."""
        if interval is None:
            return Finite(value)
        low, high = (expression(end, self._parameters) for end in interval)
        return Both(LessEqual(low, value), LessEqual(value, high))

    def over(self, patch: Patch, x: sympy.Expr, y: sympy.Expr) -> sympy.Basic:
        """Whether both coordinates are in the patch's domain."""
        return Both(self.within(x, patch.domain[0]), self.within(y, patch.domain[1]))

    def tolerance(self) -> sympy.Expr:
        """What counts as nothing beside 1 in a search: 1e-9, or what rounding leaves of it in single precision."""
        roundoff = self.roundoff()
        return self.tape.let("tolerance", Select(Less(_TOLERANCE, roundoff), roundoff, _TOLERANCE))

    def roundoff(self) -> sympy.Expr:
        """What rounding makes of 1."""
        return self.tape.let("roundoff", 64 * Epsilon())

    def explicit(self, name: str, surface: Explicit, x: sympy.Expr | None = None, y: sympy.Expr | None = None) -> Jet:
        """z and its derivatives at (x, y), those of the point where not given."""
        at = {"x": self.point[0] if x is None else x, "y": self.point[1] if y is None else y}
        return Jets(self.tape, name, at, self._parameters).of(surface.height)

    def implicit(self, name: str, surface: Implicit, at: Vec) -> Jet:
        """f and its derivatives."""
        return Jets(self.tape, f"{name}_f", dict(zip("xyz", at, strict=True)), self._parameters).of(surface.f)

    def parametric(self, name: str, surface: Parametric, u: sympy.Expr, v: sympy.Expr) -> tuple[Jet, Jet, Jet]:
        """x, y and z with their derivatives."""
        at = {"u": u, "v": v}
        x, y, z = (
            Jets(self.tape, f"{name}_{axis}", at, self._parameters).of(entry) for axis, entry in zip("xyz", surface.position, strict=True)
        )
        return x, y, z

    def places(self, name: str, surface: Parametric, u: sympy.Expr, v: sympy.Expr) -> Vec:
        """x, y and z without derivatives."""
        known = {**self._parameters, "u": u, "v": v}
        return self.tape.vector(name, [expression(entry, known) for entry in surface.position])

    def _plane(self, patch: Patch, surface: Plane) -> Sheet:
        point, normal = self.vector(f"{patch.name}_point", surface.point), self.vector(f"{patch.name}_normal", surface.normal)
        x, y, _ = self.point
        drop = normal[0] * (x - point[0]) + normal[1] * (y - point[1])
        z = sympy.nan if normal[2] == 0 else self.tape.let(patch.name, point[2] - drop / normal[2])
        if not normal[2].is_number:
            z = Select(Same(normal[2], 0), sympy.nan, z)
        return Sheet(self.over(patch, x, y), z, normal, (sympy.S.Zero,) * 6)

    def _graph(self, patch: Patch, z: Jet) -> Sheet:
        """z - f(x, y) = 0 (theory 4.1: (-f_x, -f_y, 1))."""
        normal = (-z.first[0], -z.first[1], sympy.S.One)
        flat = sympy.S.Zero
        length = self._length(patch, normal)
        bending = (z.second[0][0] / length, z.second[0][1] / length, flat, z.second[1][1] / length, flat, flat)
        return Sheet(self.over(patch, *self.point[:2]), z.value, normal, bending)

    def _implicit(self, patch: Patch, surface: Implicit, z: sympy.Expr) -> Sheet:
        """The gradient is a normal; along a curve of the surface n r'' = -t' H t / |gradient|."""
        x, y, _ = self.point
        f = self.implicit(patch.name, surface, (x, y, z))
        normal = (f.first[0], f.first[1], f.first[2])
        length = self._length(patch, normal)
        rest = self.tape.let(f"{patch.name}_rest", ratio(f.value, f.first[2], x))
        found = LessEqual(abs(rest), self.tolerance() * (1 + abs(z)))
        bending = tuple(-f.second[i][j] / length for i in range(3) for j in range(i, 3))
        return Sheet(Both(self.over(patch, x, y), found), z, normal, bending)

    def _parametric(self, patch: Patch, surface: Parametric, located: Sequence[sympy.Expr]) -> Sheet:
        """r_u x r_v is a normal; the second derivatives along it, on the dual basis."""
        x, y, z = self.parametric(patch.name, surface, *located)
        normal = self.normal(patch, (x, y, z))
        gap = abs(x.value - self.point[0]) + abs(y.value - self.point[1])
        close = LessEqual(self.tape.let(f"{patch.name}_gap", gap), self.tolerance() * (1 + abs(x.value) + abs(y.value)))
        return Sheet(Both(self.over(patch, *located), close), z.value, normal, self._dual(patch, (x, y, z), normal))

    def normal(self, patch: Patch, r: tuple[Jet, Jet, Jet]) -> Vec:
        """(A, B, C) = r_u x r_v."""
        along_u, along_v = ((r[0].first[i], r[1].first[i], r[2].first[i]) for i in (0, 1))
        return self.tape.vector(f"{patch.name}_normal", cross(along_u, along_v))

    def _dual(self, patch: Patch, r: tuple[Jet, Jet, Jet], normal: Vec) -> Symmetric:
        """The sum of (r_ab n) r^a r^b', where r^a r_b is 1 for a = b and 0 else."""
        length = self._length(patch, normal)
        along_u, along_v = ((r[0].first[i], r[1].first[i], r[2].first[i]) for i in (0, 1))
        dual = [
            self.tape.vector(f"{patch.name}_dual_{name}", [entry / length**2 for entry in vector])
            for name, vector in (("u", cross(along_v, normal)), ("v", cross(normal, along_u)))
        ]
        second = [[dot(normal, [jet.second[a][b] for jet in r]) / length for b in (0, 1)] for a in (0, 1)]
        bends = [[self.tape.let(f"{patch.name}_bend_{'uv'[a]}{'uv'[b]}", second[a][b]) for b in (0, 1)] for a in (0, 1)]
        entries = [sum(bends[a][b] * dual[a][i] * dual[b][j] for a in (0, 1) for b in (0, 1)) for i in range(3) for j in range(i, 3)]
        return tuple(entries)

    def _length(self, patch: Patch, normal: Vec) -> sympy.Expr:
        """NaN of a surface that is nowhere regular: nothing is divided by it then."""
        square = dot(normal, normal)
        return self.tape.let(f"{patch.name}_length", sympy.sqrt(-1 - self.point[0] ** 2 if square == 0 else square))

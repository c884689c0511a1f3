"""The functions of the ground at a point: height, normal, tangents, curvature, friction and stiffness of the first patch that holds it."""

from collections.abc import Callable, Sequence
from functools import cached_property

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.model.terrain import Terrain
from walkgen.signature import STATUSES, Port, Signature
from walkgen.symbolic.branches import BAD_INPUT, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import both, chosen, finite, indicator, same
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Derivation, Less, Select, Solve, Step
from walkgen.symbolic.locate import Search, joined, search
from walkgen.symbolic.ports import signature
from walkgen.symbolic.project import descent, foot, near_ports
from walkgen.symbolic.surfaces import POINT, Sheet, Surfaces, Symmetric, located_port
from walkgen.symbolic.tape import Tape, Vec, dot, scaled

OWNER = "terrain"
_NO_CONVERGENCE = sympy.Integer(STATUSES.index("NO_CONVERGENCE"))
_SOURCE = "theory 4.1: (A, B, C) = r_u x r_v, grad F, (-f_x, -f_y, 1)"
_SPRINGS = "theory 4.3: C = n n'/kn + (1 - n n')/kt"
_PROPERTIES = {"mu": sympy.nan, "kn": sympy.oo, "kt": sympy.oo}
"""Of a patch, with what stands where the spec says nothing."""
_DUFF = "Duff et al., Building an orthonormal basis, revisited, JCGT 2017"
_FIRST = "the first patch whose domain holds the point counts"


class TerrainFunctions:
    """Functions of a point p [3] in the world frame; they share one tape.

    The vertical is the world's z axis; up, against gravity, only turns the normals.
    """

    def __init__(self, mechanism: Mechanism, terrain: Terrain) -> None:
        self._mechanism, self._terrain = mechanism, terrain
        self._parameters = parameter_symbols(mechanism)
        self._surfaces = Surfaces(Tape(), self._parameters)
        self._tape = self._surfaces.tape

    @cached_property
    def _sheets(self) -> tuple[Sheet, ...]:
        return tuple(self._surfaces.sheet(patch) for patch in self._terrain.patches)

    @cached_property
    def _searches(self) -> tuple[Search, ...]:
        return tuple(search(self._mechanism, OWNER, patch) for patch in self._terrain.patches)

    def function(self, name: str) -> Derivation:
        """The function of this name."""
        return _BUILDERS[name](self)

    def _chosen(self, values: Sequence[sympy.Expr], otherwise: sympy.Expr = sympy.nan) -> sympy.Expr:
        """The value of the first patch that holds the point."""
        for sheet, value in zip(reversed(self._sheets), reversed(values), strict=True):
            otherwise = Select(sheet.held, value, otherwise)
        return otherwise

    @cached_property
    def _normal(self) -> tuple[Vec, sympy.Expr]:
        """The unit normal, and the sign that turned the surface's own."""
        raw = self._tape.vector("across", [self._chosen([sheet.normal[axis] for sheet in self._sheets]) for axis in range(3)])
        up = self._surfaces.vector("up", self._terrain.up)
        rise = dot(raw, up)
        sign = sympy.S.One if rise == 0 else self._tape.let("sign", Select(Less(rise, 0), -1, 1))  # without gravity no way is up
        length = self._tape.let("length", sympy.sqrt(dot(raw, raw)))
        return self._tape.vector("normal", [sign * entry / length for entry in raw]), sign

    @cached_property
    def _basis(self) -> tuple[Vec, Vec]:
        """Tangents t1, t2 with t1 x t2 = n, that turn into x and y where n is z."""
        (x, y, z), _ = self._normal
        side = self._tape.let("side", Select(Less(z, 0), -1, 1))
        a = self._tape.let("turn", -1 / (side + z))
        b = self._tape.let("twist", x * y * a)
        return (1 + side * x**2 * a, side * b, -side * x), (b, side + y**2 * a, -y)

    def height(self) -> Derivation:
        """z."""
        doc = f"Height of the ground at the point's x and y: {_FIRST}; NaN off every patch."
        return self._function("height", [Port("z", (), "m")], [self._chosen([sheet.z for sheet in self._sheets])], doc)

    def normal(self) -> Derivation:
        """n [3]."""
        doc = "Unit normal of the ground at the point's x and y, turned against gravity; NaN off every patch and where there is none."
        return self._function("normal", [Port("n", (3,))], self._normal[0], doc)

    def tangents(self) -> Derivation:
        """[2,3]."""
        doc = "Unit tangents t1, t2 (rows) of the ground at the point's x and y, with t1 x t2 = n; x and y of the world on level ground."
        first, second = self._basis
        return self._function("tangents", [Port("t", (2, 3))], [*first, *second], doc, _DUFF)

    def curvature(self) -> Derivation:
        """[2,2]."""
        doc = (
            "Second fundamental form of the ground in the basis of `tangents`, positive where the ground bends towards its normal "
            "(a hollow); its eigenvalues are the principal curvatures."
        )
        bending = [self._chosen([sheet.bending[entry] for sheet in self._sheets]) for entry in range(6)]
        named = [
            self._tape.let(f"bending_{axes}", entry) for axes, entry in zip(("xx", "xy", "xz", "yy", "yz", "zz"), bending, strict=True)
        ]
        _, sign = self._normal
        first, second = (self._tape.vector(f"t{number}", t) for number, t in enumerate(self._basis, 1))
        applied = [scaled(sign, _applied(named, t)) for t in (first, second)]  # type: ignore[arg-type]
        mixed = self._tape.let("mixed", dot(first, applied[1]))
        outputs = [dot(first, applied[0]), mixed, mixed, dot(second, applied[1])]
        return self._function("curvature", [Port("curvature", (2, 2), "1/m")], outputs, doc)

    def ground(self) -> Derivation:
        """mu, kn, kt."""
        doc = (
            "Coefficient of friction (NaN where the spec gives none) and stiffnesses along the normal and across it (infinite where rigid)."
        )
        outputs = [self._chosen(self._values(name)) for name in _PROPERTIES]
        ports = [Port("mu"), Port("kn", (), "N/m"), Port("kt", (), "N/m")]
        return self._function("ground", ports, outputs, doc, _SPRINGS)

    def compliance(self) -> Derivation:
        """C [3,3]."""
        doc = (
            "How far the ground at the point's x and y yields for a unit force on it, in the world's axes: 0 where it is rigid, NaN off "
            "every patch and where there is no normal. In series with a leg's compliance: their sum is what contact_forces takes."
        )
        n, _ = self._normal
        along, across = (self._tape.let(f"per_{name}", self._chosen([1 / value for value in self._values(name)])) for name in ("kn", "kt"))
        outputs = [along * a * b + across * (int(i == j) - a * b) for i, a in enumerate(n) for j, b in enumerate(n)]
        return self._function("compliance", [Port("C", (3, 3), "m/N")], outputs, doc, _SPRINGS)

    def _values(self, name: str) -> list[sympy.Expr]:
        """One of `_PROPERTIES` of every patch."""
        given = [getattr(patch, name) for patch in self._terrain.patches]
        return [_PROPERTIES[name] if value is None else expression(value, self._parameters) for value in given]

    def surface(self) -> Solve:
        """What a solve asks of the ground at a foot [5]."""
        doc = "Height over the surface along the normal, to first order; the unit normal; the coefficient of friction."
        (x, y, z), _ = self._normal
        gap = self._tape.let("gap", z * (self._surfaces.point[2] - self._chosen([sheet.z for sheet in self._sheets])))
        outputs = [gap, x, y, z, self._chosen(self._values("mu"))]
        return self._located(self._words("surface", [Port("surface", (5,), "m and 1")], doc, _SOURCE), outputs, joined(self._searches), ())

    def patch(self) -> Derivation:
        """The index."""
        names = ", ".join(f"{index} {patch.name}" for index, patch in enumerate(self._terrain.patches))
        doc = f"Which patch the point's x and y are on ({names}): {_FIRST}; -1 off every patch."
        outputs = [self._chosen([sympy.Integer(index) for index in range(len(self._sheets))], sympy.Integer(-1))]
        return self._function("patch", [Port("index", kind="integer")], outputs, doc, "")

    def project(self) -> Derivation:
        """foot [3] and a status."""
        doc = (
            "The point nearest to p on the surface of the patch that p's x and y are on, as far as descent from the surface over p finds "
            "it: p minus it is normal to the surface. UNREACHABLE where it lies beyond the patch's domain (foot is then the point over p) "
            "or p is off every patch (NaN); SINGULAR where the surface has no normal at the foot."
        )
        x, y, z = self._surfaces.point
        feet = [foot(self._surfaces, patch) for patch in self._terrain.patches]
        count = len(self._sheets)
        over = (self._chosen([x] * count), self._chosen([y] * count), self._chosen([sheet.z for sheet in self._sheets]))
        nearest = self._tape.vector("nearest", [self._chosen([one.point[axis] for one in feet]) for axis in range(3)])
        inside, close, regular = (self._flag(part, [getattr(one, part) for one in feet]) for part in ("inside", "close", "regular"))
        known = _all_finite((x, y, z))
        points = [Select(known, chosen(inside, there, here), sympy.nan) for there, here in zip(nearest, over, strict=True)]
        found = chosen(both(close, _all_finite(nearest)), OK, _NO_CONVERGENCE)
        status = Select(known, chosen(inside, chosen(regular, found, SINGULAR), UNREACHABLE), BAD_INPUT)
        ports = [Port("foot", (3,), "m"), Port("status", kind="integer")]
        pairs = zip(self._terrain.patches, self._searches, strict=True)
        steps = joined([descent(self._mechanism, OWNER, patch, located) for patch, located in pairs])
        near = [port for patch in self._terrain.patches for port in near_ports(patch)]
        return self._solve(self._words("project", ports, doc, _SOURCE), [*points, status], steps, near)

    def _flag(self, name: str, truths: Sequence[sympy.Basic]) -> sympy.Basic:
        """Whether the first patch that holds the point has this; not where no patch does."""
        return same(self._tape.let(name, self._chosen([indicator(truth) for truth in truths], sympy.S.Zero)), 1)

    def _function(self, name: str, ports: Sequence[Port], outputs: Sequence[sympy.Expr], doc: str, source: str = _SOURCE) -> Derivation:
        return self._solve(self._words(name, ports, doc, source), outputs, joined(self._searches), ())

    def _words(self, name: str, ports: Sequence[Port], doc: str, source: str) -> Signature:
        return signature(self._mechanism, OWNER, name, [POINT], ports, doc, source)

    def _solve(self, words: Signature, outputs: Sequence[sympy.Expr], found: Search, near: Sequence[Port]) -> Derivation:
        """A Function of the point alone, or one of what was found for it before."""
        return self._located(words, outputs, found, near) if found.steps else self._tape.function(words, outputs)

    def _located(self, words: Signature, outputs: Sequence[sympy.Expr], found: Search, near: Sequence[Port]) -> Solve:
        """A search, and a Function of what it found."""
        located = [port for patch in self._terrain.patches if (port := located_port(patch))]
        inner = signature(self._mechanism, OWNER, f"{words.name}_at", [POINT, *located, *near], words.outputs, "", "")
        arguments = (*(port.name for port in inner.inputs), *(port.name for port in words.outputs))
        return Solve(words, found.locals, (*found.steps, Step(self._tape.function(inner, outputs), arguments)), tables=found.tables)


def _all_finite(vector: Vec) -> sympy.Basic:
    x, y, z = (finite(entry) for entry in vector)
    return both(both(x, y), z)


def _applied(matrix: Symmetric, vector: Vec) -> Vec:
    """Symmetric matrix times vector."""
    xx, xy, xz, yy, yz, zz = matrix
    x, y, z = (dot(row, vector) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    return (x, y, z)


_BUILDERS: dict[str, Callable[[TerrainFunctions], Derivation]] = {
    "height": TerrainFunctions.height,
    "normal": TerrainFunctions.normal,
    "tangents": TerrainFunctions.tangents,
    "curvature": TerrainFunctions.curvature,
    "ground": TerrainFunctions.ground,
    "compliance": TerrainFunctions.compliance,
    "patch": TerrainFunctions.patch,
    "project": TerrainFunctions.project,
}

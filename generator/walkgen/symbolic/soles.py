"""Where legs touch the ground: the foot point, or the corners of a rectangular sole about it, and the pressure under one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain

import sympy

from walkgen.model.mechanism import CORNERS, Limb, Mechanism, Sole
from walkgen.signature import Port
from walkgen.symbolic.driven import DrivenKinematics, kinematics_of
from walkgen.symbolic.frames import Parameters, expression, frame_of, parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, dot, minus, plus, scaled, symbols_of, times

ORDER = "the corners (+,+), (-,+), (-,-), (+,-) in the sole's x and y"
_SOLE = "the sole's x runs along its length, y along its width, z away from the ground"
EQ_CORNERS = "eq. (1) with p_n at the corner"
CONTACTS = (
    f"Where the robot touches the ground, in the first platform's frame, legs in file order: of a leg with a sole {ORDER}, else the foot."
)
_UP = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Footing:
    """What a leg stands on, in the base's axes: the foot point, contact points as seen from it, and the sole's normal with its pad.

    `pad` is how far a corner yields (m/N) along the normal and across it.
    """

    foot: Vec
    levers: tuple[Vec, ...] = (ZERO_VECTOR,)
    normal: Vec = ZERO_VECTOR
    pad: tuple[sympy.Expr, sympy.Expr] = (sympy.S.Zero, sympy.S.Zero)

    def points(self, tape: Tape) -> tuple[Vec, ...]:
        """The contact points."""
        return tuple(self.foot if lever == ZERO_VECTOR else tape.vector("contact", plus(self.foot, lever)) for lever in self.levers)


def footing(leg: Limb, kinematics: Kinematics | DrivenKinematics) -> Footing:
    """Of a leg at the end of a path; without a sole, its foot point."""
    sole, tape, parameters = leg.sole, kinematics.tape, kinematics.parameters
    if sole is None:
        return Footing(kinematics.position)
    x, y, z = _axes(sole, kinematics)
    half = [expression(size, parameters) / 2 for size in (sole.length, sole.width)]
    along, aside = (tape.vector(name, scaled(size, axis)) for name, size, axis in zip(("ahead", "aside"), half, (x, y), strict=True))
    diagonals = [tape.vector("corner", combine(along, aside)) for combine in (plus, minus)]
    levers = tuple(scaled(sympy.Integer(first), diagonals[0 if first == second else 1]) for first, second in CORNERS)
    return Footing(kinematics.position, levers, z, _pad(sole, parameters, tape))


def _axes(sole: Sole, kinematics: Kinematics | DrivenKinematics) -> Columns:
    turn = frame_of(sole.turn, kinematics.parameters).rotation
    if turn == IDENTITY:
        return kinematics.rotation
    columns = zip("xyz", turn, strict=True)
    x, y, z = (kinematics.tape.vector(f"sole_{name}", times(kinematics.rotation, column)) for name, column in columns)
    return (x, y, z)


def _pad(sole: Sole, parameters: Parameters, tape: Tape) -> tuple[sympy.Expr, sympy.Expr]:
    along, across = (tape.let("pad", 1 / expression(size, parameters)) if size else sympy.S.Zero for size in (sole.kn, sole.kt))
    return along, across


class SoleFunctions:
    """Functions of a leg that stands on a sole; they share one tape."""

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        self._mechanism, self._leg, self._tape = mechanism, leg, Tape()
        self._q = joint_port("q", leg.joints)
        self._parameters = parameter_symbols(mechanism)

    def functions(self) -> dict[str, Callable[[], Function]]:
        """None of a leg that stands on its foot point."""
        if self._leg.sole is None:
            return {}
        return {"sole_points": self.sole_points, "sole_normal": self.sole_normal, "ground_pressure": self.ground_pressure}

    def _footing(self) -> Footing:
        return footing(self._leg, kinematics_of((self._leg,), symbols_of(self._q), self._parameters, self._tape))

    def sole_points(self) -> Function:
        """[4,3]."""
        corners = list(chain.from_iterable(self._footing().points(self._tape)))
        doc = f"Corners of the sole in the platform's frame, once round: {ORDER}; {_SOLE}."
        return self._function("sole_points", (self._q,), (Port("p", (len(CORNERS), 3), "m"),), corners, doc, EQ_CORNERS)

    def sole_normal(self) -> Function:
        """[3]."""
        doc = "Unit normal of the sole, away from the ground, in the platform's axes: its z."
        return self._function("sole_normal", (self._q,), (Port("n", (3,)),), self._footing().normal, doc, EQ_CORNERS)

    def ground_pressure(self) -> Function:
        """Mean pressure and its centre, out of the corners' forces in any one frame."""
        assert self._leg.sole is not None
        forces, normal = Port("f", (len(CORNERS), 3), "N"), Port("normal", (3,), default=_UP)
        values, up = symbols_of(forces), symbols_of(normal)
        normals = [self._tape.let("N", dot(values[3 * corner : 3 * corner + 3], up)) for corner in range(len(CORNERS))]
        total = self._tape.let("total", sympy.Add(*normals))
        length, width = (expression(size, self._parameters) for size in (self._leg.sole.length, self._leg.sole.width))
        weighted = [sympy.Add(*(corner[axis] * N for corner, N in zip(CORNERS, normals, strict=True))) for axis in range(2)]
        centre = [size / 2 * part / total for size, part in zip((length, width), weighted, strict=True)]
        outputs = (Port("pressure", (), "Pa"), Port("centre", (2,), "m"))
        doc = (
            "Mean pressure under the sole and the centre of pressure along its x and y, NaN where nothing presses: f are the ground's "
            "forces on the corners in the order of sole_points, normal the unit normal away from the ground, both in any one frame."
        )
        found = [total / (length * width), *centre]
        return self._function("ground_pressure", (forces, normal), outputs, found, doc, "sum N / (length width), sum N c / sum N")

    def _function(
        self, name: str, inputs: Sequence[Port], outputs: Sequence[Port], found: Sequence[sympy.Expr], doc: str, source: str
    ) -> Function:
        return self._tape.function(signature(self._mechanism, self._leg.name, name, inputs, outputs, doc, source), found)

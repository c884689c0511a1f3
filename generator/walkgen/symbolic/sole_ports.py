"""What functions of curved soles take and give, and their arithmetic of plane vectors."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rolling_leg import Planar, RollingLeg, rolling_leg
from walkgen.symbolic.tape import Tape, symbols_of

HIP_MOTION = Port("hip", (3, 2), "m, m/s, m/s^2")
HIP = Port("hip", (2,), "m")
THIGH_MOTION = Port("thigh", (3,), "rad, rad/s, rad/s^2")
THIGH = Port("thigh", (), "rad")
MOTION = Port("angles", (3, 3), "rad, rad/s, rad/s^2")
ANGLES = Port("angles", (3,), "rad")
ANKLE_X = Port("ankle_x", (), "m")
EDGE = Port("edge", (), "m")
CONTACT = Port("contact")
KNEE = Port("knee", kind="integer", default=(1.0,))
CONTACT_POINT = Port("contact_point", (2,), "m")
ANKLE = Port("ankle", (2,), "m")
PHASE = Port("phase", kind="integer")
STATUS = Port("status", kind="integer")
DOWN = -sympy.pi / 2
"""The foot's angle where it stands flat."""
PLANE = "in the leg's plane, X forward along the level ground, Y up"
ROWS = "rows: value, rate, acceleration; columns: thigh, shank, foot, from X"
Exprs = Sequence[sympy.Expr]


def cross(a: Planar, b: Planar) -> sympy.Expr:
    """a x b."""
    return a[0] * b[1] - a[1] * b[0]


def inner(a: Planar, b: Planar) -> sympy.Expr:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1]


def named(tape: Tape, name: str, vector: Planar) -> Planar:
    """Both components under a name."""
    return tape.let(f"{name}_x", vector[0]), tape.let(f"{name}_y", vector[1])


@dataclass(frozen=True)
class SoleLeg:
    """A leg with a curved sole and the robot that it belongs to: what all of its functions begin with."""

    mechanism: Mechanism
    limb: Limb
    leg: RollingLeg

    @classmethod
    def of(cls, mechanism: Mechanism, limb: Limb) -> "SoleLeg":
        """The leg's geometry and masses."""
        return cls(mechanism, limb, rolling_leg(mechanism, limb))

    @property
    def height(self) -> sympy.Expr:
        """Of a flat foot's ankle over the ground (m)."""
        return self.leg.foot[0] + expression(self.leg.sole.depth, parameter_symbols(self.mechanism))

    def edge(self, which: str) -> sympy.Expr:
        """Y of an edge of the flat part in the foot's axes, from the ankle: where it is ahead of a flat foot's ankle (m)."""
        own = self.leg.sole.front if which == "toe" else self.leg.sole.rear
        return self.leg.foot[1] + expression(own, parameter_symbols(self.mechanism))

    def knee(self, tape: Tape, hip: Planar, angle: sympy.Expr) -> tuple[Planar, Planar]:
        """Its place for the thigh's angle, and the unit vector along the thigh."""
        along = (tape.let("cos_thigh", sympy.cos(angle)), tape.let("sin_thigh", sympy.sin(angle)))
        return named(tape, "knee", (hip[0] + self.leg.thigh * along[0], hip[1] + self.leg.thigh * along[1])), along

    def function(
        self, tape: Tape, name: str, inputs: Sequence[Port], outputs: Sequence[Port], found: Exprs, doc: str = "", source: str = ""
    ) -> Function:
        """A function of the leg; what is on the tape must not be called like an input."""
        symbols = {symbol for symbol, _ in tape.lines}
        assert not any(symbol in symbols for port in inputs for symbol in symbols_of(port)), name
        return tape.function(signature(self.mechanism, self.limb.name, name, inputs, outputs, doc, source), found)

"""A yaw-pitch-pitch leg in its canonical form: axis 1 = z, foot at (rho cos t + w sin t, rho sin t - w cos t, s1 + h).

rho = a1 + a2 cos(phi) + l3 cos(phi + gamma) and h = a2 sin(phi) + l3 sin(phi + gamma) hold for every leg whose first
axis is perpendicular to two parallel ones (theory: Fig. 7 leg with general offsets), however it was described.
"""

from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Limb
from walkgen.symbolic.frames import Parameters
from walkgen.symbolic.screws import screws
from walkgen.symbolic.tape import Tape, Vec, constant, cross, dot, minus, plus, scaled


@dataclass(frozen=True)
class Geometry:
    """Lengths (m), the canonical frame (columns X, Y, K and origin, in the platform's frame) and the angles' zeros.

    Joint values are q1 = sign1 * t, q2 = sign2 * (phi - zero2), q3 = sign3 * (gamma - zero3).
    """

    a1: sympy.Expr
    a2: sympy.Expr
    l3: sympy.Expr
    w: sympy.Expr
    axes: tuple[Vec, Vec, Vec]
    origin: Vec
    sign1: int
    sign2: int
    zero2: sympy.Expr
    sign3: int
    zero3: sympy.Expr

    def numbers(self) -> tuple[sympy.Expr, ...]:
        """The ten numbers of the closest-point routine: a1, a2, l3, w, then sign and zero of each angle."""
        first, second, third = (sympy.Integer(sign) for sign in (self.sign1, self.sign2, self.sign3))
        return (self.a1, self.a2, self.l3, self.w, first, sympy.S.Zero, second, self.zero2, third, self.zero3)


def geometry(leg: Limb, parameters: Parameters, tape: Tape) -> Geometry:
    """Read the canonical form off the joint axes at q = 0; constants fold, runtime parameters stay."""
    path = screws((leg,), parameters, tape)
    sign1, sign2 = leg.senses[:2] or (1, 1)
    axis1, axis2 = (scaled(sympy.Integer(sign), screw.axis) for sign, screw in ((sign1, path.joints[0]), (sign2, path.joints[1])))
    point1, point2, point3 = (screw.point for screw in path.joints)
    forward = tape.vector("forward", cross(axis1, axis2))
    sideways = tape.vector("sideways", cross(axis1, forward))
    foot = path.tip.origin
    hip, thigh, shank = (
        tape.vector(name, minus(b, a)) for name, a, b in (("hip", point1, point2), ("thigh", point2, point3), ("shank", point3, foot))
    )
    lift = tape.let("hip_height", dot(hip, axis1))
    length2, angle2 = _polar(thigh, forward, axis1, tape, "thigh")
    length3, angle3 = _polar(shank, forward, axis1, tape, "shank")
    return Geometry(
        a1=tape.let("a1", dot(hip, forward)),
        a2=length2,
        l3=length3,
        w=tape.let("w", dot(plus(plus(hip, thigh), shank), axis2)),
        axes=(forward, sideways, axis1),
        origin=tape.vector("shoulder", plus(point1, scaled(lift, axis1))),
        sign1=sign1,
        sign2=sign2,
        zero2=angle2,
        sign3=_parallel(axis2, path.joints[2].axis, parameters),
        zero3=tape.let("knee_zero", angle3 - angle2),
    )


def _polar(vector: Vec, forward: Vec, up: Vec, tape: Tape, name: str) -> tuple[sympy.Expr, sympy.Expr]:
    x, y = tape.let(f"{name}_forward", dot(vector, forward)), tape.let(f"{name}_up", dot(vector, up))
    length = tape.let(f"{name}_length", sympy.sqrt(x**2 + y**2))
    angle = sympy.S.Zero if y == 0 and x.is_positive else sympy.atan2(y, x)
    return length, tape.let(f"{name}_angle", angle)


def _parallel(axis: Vec, other: Vec, parameters: Parameters) -> int:
    """+1 or -1: whether two parallel axes point the same way (runtime parameters do not turn one round)."""
    some = {symbol: sympy.Rational(7, 11) for symbol in parameters.values()}
    return 1 if constant(sympy.sympify(dot(axis, other)).subs(some)) > 0 else -1

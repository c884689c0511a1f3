"""Poses in a plane, by position and the cosine and sine of the angle, so that placing a linkage takes no trigonometric function."""

from dataclasses import dataclass

import sympy

from walkgen.symbolic.function import Angle
from walkgen.symbolic.tape import Tape, constant

Planar = tuple[sympy.Expr, sympy.Expr]
"""A vector in the plane."""

_ZERO, _ONE = sympy.S.Zero, sympy.S.One


def turned(rotor: Planar, vector: Planar) -> Planar:
    """The vector turned by the rotor's angle: a product of complex numbers."""
    return (rotor[0] * vector[0] - rotor[1] * vector[1], rotor[1] * vector[0] + rotor[0] * vector[1])


def conjugate(rotor: Planar) -> Planar:
    """The opposite angle."""
    return (rotor[0], -rotor[1])


def difference(a: Planar, b: Planar) -> Planar:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1])


def sum_of(a: Planar, b: Planar) -> Planar:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1])


def stretched(factor: sympy.Expr, a: Planar) -> Planar:
    """factor * a."""
    return (factor * a[0], factor * a[1])


def square(a: Planar) -> sympy.Expr:
    """|a|^2."""
    return a[0] ** 2 + a[1] ** 2


def inner(a: Planar, b: Planar) -> sympy.Expr:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1]


def outer(a: Planar, b: Planar) -> sympy.Expr:
    """a x b, the component normal to the plane."""
    return a[0] * b[1] - a[1] * b[0]


def angle_of(rotor: Planar) -> sympy.Expr:
    """Its angle in (-pi, pi]."""
    cosine, sine = rotor
    return constant(sympy.atan2(sine, cosine)) if cosine.is_number and sine.is_number else Angle(sine, cosine)


def named(tape: Tape, name: str, vector: Planar) -> Planar:
    """The components under `name_x`, `name_y`."""
    return (tape.let(f"{name}_x", vector[0]), tape.let(f"{name}_y", vector[1]))


@dataclass(frozen=True)
class PlanarPose:
    """Origin, and rotor (cosine, sine) of the angle, in the axes of another body."""

    origin: Planar = (_ZERO, _ZERO)
    rotor: Planar = (_ONE, _ZERO)

    def point(self, point: Planar) -> Planar:
        """A point of the body."""
        return sum_of(self.origin, turned(self.rotor, point))

    def __mul__(self, other: "PlanarPose") -> "PlanarPose":
        return PlanarPose(self.point(other.origin), turned(self.rotor, other.rotor))

    def inverse(self) -> "PlanarPose":
        """The other body in this one's axes."""
        back = conjugate(self.rotor)
        return PlanarPose(stretched(-_ONE, turned(back, self.origin)), back)

    def named(self, tape: Tape, name: str) -> "PlanarPose":
        """Short expressions."""
        cosine, sine = tape.let(f"{name}_cos", self.rotor[0]), tape.let(f"{name}_sin", self.rotor[1])
        return PlanarPose(named(tape, name, self.origin), (cosine, sine))

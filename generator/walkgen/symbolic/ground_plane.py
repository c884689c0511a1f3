"""The plane that a curved sole stands on: across gravity, or rising forward by the sole's slope, as the leg's platform sees it."""

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.symbolic.frames import cosine_sine, expression, parameter_symbols
from walkgen.symbolic.planar import Planar
from walkgen.symbolic.tape import Columns, Vec, dot

FLAT = sympy.Rational(1, 10**9)
"""A foot turned by less (rad) stands flat."""


def upward(mechanism: Mechanism) -> Vec:
    """Unit vector against gravity; z without it."""
    gravity = [expression(entry, parameter_symbols(mechanism)) for entry in mechanism.gravity]
    if not any(entry != 0 for entry in gravity):
        return (sympy.S.Zero, sympy.S.Zero, sympy.S.One)
    size = gravity_size(mechanism)
    x, y, z = (-entry / size for entry in gravity)
    return (x, y, z)


def gravity_size(mechanism: Mechanism) -> sympy.Expr:
    """m/s^2."""
    parts = [expression(entry, parameter_symbols(mechanism)) for entry in mechanism.gravity]
    own = [part for part in parts if part != 0]
    return abs(own[0]) if len(own) == 1 and own[0].is_number else sympy.sqrt(sympy.Add(*(part**2 for part in own)))


def slope_of(mechanism: Mechanism, leg: Limb) -> sympy.Expr:
    """By how much the ground rises forward (rad)."""
    assert leg.curved_sole is not None
    return expression(leg.curved_sole.slope, parameter_symbols(mechanism))


def foot_rotor(mechanism: Mechanism, leg: Limb, rotation: Columns) -> Planar:
    """Cos and sin of the foot's angle from the ground, which is -pi/2 where it stands flat; `rotation` is the foot's on the leg's platform.

    So they are the ground's normal, too: how far it points forward and along the foot's x.
    """
    assert leg.curved_sole is not None
    up = upward(mechanism)
    down, ahead = (dot(column, up) for column in rotation[:2])
    ahead = leg.curved_sole.side * ahead
    cosine, sine = cosine_sine(slope_of(mechanism, leg))
    return (ahead, down) if sine == 0 else (cosine * ahead + sine * down, cosine * down - sine * ahead)

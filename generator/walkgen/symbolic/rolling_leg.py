"""A leg with a curved sole in its own plane: lengths of thigh and shank, angles of its links by q, what they weigh (chapter section 8).

The plane's X is forward along the ground, Y across it, up where that is level; angles are counted from X towards Y. Links have x along
them: from hip to knee, from knee to ankle; the foot's axes are the foot frame's x and y, seen from the ankle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import sympy

from walkgen.model.curved_sole import CurvedSole
from walkgen.model.mechanism import Joint, Limb, Mechanism, Motion
from walkgen.symbolic.frames import Frame, Parameters, cosine_sine, expression, frame_of, parameter_symbols
from walkgen.symbolic.ground_plane import gravity_size, slope_of, upward
from walkgen.symbolic.path import yaw_of
from walkgen.symbolic.tape import DIGITS, Vec, constant, dot, times

LINKS = ("thigh", "shank", "foot")
_CLOSE = sympy.Float("1e-30", DIGITS)
Planar = tuple[sympy.Expr, sympy.Expr]


@dataclass(frozen=True)
class LinkMass:
    """Mass (kg), centre of mass in the link's axes (m), inertia about it (kg m^2)."""

    mass: sympy.Expr
    com: Planar
    inertia: sympy.Expr


@dataclass(frozen=True)
class RollingLeg:
    """`thigh` and `shank` are lengths (m), `foot` is the foot frame's origin from the ankle in its own axes (m); `weight` is
    what a mass at rest is held up with (m/s^2): against gravity.

    The angle of link i is `signs` times q of the joints up to it, summed, plus `zeros[i]`.
    """

    sole: CurvedSole
    thigh: sympy.Expr
    shank: sympy.Expr
    foot: Planar
    signs: tuple[int, int, int]
    zeros: tuple[sympy.Expr, sympy.Expr, sympy.Expr]
    masses: tuple[LinkMass, LinkMass, LinkMass]
    weight: Planar

    def angles(self, q: Sequence[sympy.Expr]) -> tuple[sympy.Expr, ...]:
        """Of thigh, shank and foot from X (rad), for the q of hip, knee and ankle."""
        turned = [sign * value for sign, value in zip(self.signs, q, strict=True)]
        return tuple(sympy.Add(*turned[: count + 1]) + zero for count, zero in enumerate(self.zeros))

    def joints(self, angles: Sequence[sympy.Expr]) -> tuple[sympy.Expr, ...]:
        """q for the links' angles."""
        plain = [angle - zero for angle, zero in zip(angles, self.zeros, strict=True)]
        steps = (plain[0], plain[1] - plain[0], plain[2] - plain[1])
        return tuple(sign * step for sign, step in zip(self.signs, steps, strict=True))


@dataclass(frozen=True)
class _Section:
    """From one joint's motion on to the next joint's, or to the foot frame."""

    joint: Joint
    frame: Frame
    yaw: sympy.Expr
    flip: int


def rolling_leg(mechanism: Mechanism, leg: Limb) -> RollingLeg:
    """Of a leg whose last three axes are parallel and across gravity, see `hindrance`."""
    sole, parameters = leg.curved_sole, parameter_symbols(mechanism)
    assert sole is not None
    sections = _sections(leg, parameters)
    side = sole.side * sections[0].flip * sections[1].flip * sections[2].flip
    angle, flip = -_level(mechanism, leg, side) - side * slope_of(mechanism, leg), 1
    lengths, signs, zeros, masses = list[sympy.Expr](), list[int](), list[sympy.Expr](), list[LinkMass]()
    for number, section in enumerate(sections):
        length, tilt = _polar(section.frame, parameters)
        own = tilt if number < len(LINKS) - 1 else section.yaw
        angle += flip * expression(section.joint.zero, parameters)
        signs.append(side * flip * section.joint.sign)
        zeros.append(_folded(side * (angle + flip * own)))
        masses.append(_mass(section.joint, parameters, own, side * flip))
        lengths.append(length)
        angle, flip = angle + flip * section.yaw, flip * section.flip
    (first, second, third), (one, two, three), (a, b, c) = signs, zeros, masses
    foot = _foot(sections[-1].frame, sole.side)
    return RollingLeg(sole, lengths[0], lengths[1], foot, (first, second, third), (one, two, three), (a, b, c), _weight(mechanism, leg))


@dataclass(frozen=True)
class GroundFrame:
    """In the axes of the platform of a leg, joints before the hip at q = 0: where the hip is (m), the ground's directions under it.

    `aside` is the hip's axis, along which the foot point is at `shift` (m). `pivot` is a point of the axis of a joint before the hip, and
    `turn` whether its q turns about the ground's normal or against it; 0 without one.
    """

    hip: Vec
    forward: Vec
    normal: Vec
    aside: Vec
    shift: sympy.Expr
    pivot: Vec
    turn: sympy.Expr


def ground_frame(mechanism: Mechanism, leg: Limb) -> GroundFrame:
    """Of a leg of hip, knee and ankle with a curved sole, and of one with a joint before these that turns about the ground's normal."""
    parameters, sole = parameter_symbols(mechanism), leg.curved_sole
    assert sole is not None
    base = frame_of((*_before_hip(leg), *leg.joints[-3].before), parameters)
    first, second, third = _sections(leg, parameters)
    side = sole.side * first.flip * second.flip * third.flip
    x, y, _ = _up(mechanism, leg)
    cosine, sine = cosine_sine(slope_of(mechanism, leg))
    forward = (side * (cosine * y) + sine * x, -side * (cosine * x) + sine * y, sympy.S.Zero)
    normal = (cosine * x - side * (sine * y), cosine * y + side * (sine * x), sympy.S.Zero)
    shifts = [section.frame.origin[2] for section in (first, second, third)]
    shift = shifts[0] + first.flip * (shifts[1] + second.flip * shifts[2])
    upright, pivot, turn = times(base.rotation, normal), base.origin, sympy.S.Zero
    if len(leg.joints) > len(LINKS):
        axis = frame_of((*leg.mount, *leg.joints[0].before), parameters)
        pivot, turn = axis.origin, _folded(leg.joints[0].sign * dot(axis.rotation[2], upright))
    return GroundFrame(base.origin, times(base.rotation, forward), upright, base.rotation[2], shift, pivot, turn)


def hindrance(mechanism: Mechanism, leg: Limb) -> str:
    """What keeps a leg from rolling on its curved sole; empty where nothing does."""
    frames = _frames(leg, parameter_symbols(mechanism))
    for (one, other), frame in zip((("hip", "knee"), ("knee", "ankle"), ("ankle", "foot frame")), frames, strict=True):
        if yaw_of(frame.rotation) is None:
            return f"the axes of {one} and {other} are not parallel"
    up = _up(mechanism, leg)
    if not up[2].is_number or abs(constant(up[2])) > _CLOSE:
        return "the hip's axis is not level"
    return ""


def _frames(leg: Limb, parameters: Parameters) -> tuple[Frame, Frame, Frame]:
    hip, knee, ankle = leg.joints[-3:]
    first, second, third = (
        frame_of(way, parameters) for way in (hip.after + knee.before, knee.after + ankle.before, ankle.after + leg.tip)
    )
    return first, second, third


def _sections(leg: Limb, parameters: Parameters) -> tuple[_Section, ...]:
    found = []
    for joint, frame in zip(leg.joints[-3:], _frames(leg, parameters), strict=True):
        yaw = yaw_of(frame.rotation)
        assert yaw is not None, joint.name
        found.append(_Section(joint, frame, yaw, int(frame.rotation[2][2])))
    return tuple(found)


def _up(mechanism: Mechanism, leg: Limb) -> Vec:
    """Against gravity (without it, the platform's z) in the axes before the hip's motion, other joints at q = 0."""
    rotation = frame_of((*_before_hip(leg), *leg.joints[-3].before), parameter_symbols(mechanism)).rotation
    x, y, z = (_folded(dot(column, upward(mechanism))) for column in rotation)
    return (x, y, z)


def _before_hip(leg: Limb) -> list[Motion]:
    """From the platform to what the hip's own way begins with, other joints at q = 0."""
    way: list[Motion] = list(leg.mount)
    for joint in leg.joints[:-3]:
        kind: Literal["rotate", "translate"] = "rotate" if joint.kind == "revolute" else "translate"
        way += [*joint.before, Motion(kind, 2, joint.zero), *joint.after]
    return way


def _level(mechanism: Mechanism, leg: Limb, side: int) -> sympy.Expr:
    """The angle of the plane's X in the axes before the hip's motion: X is Y x normal, the normal `side` times z."""
    up = _up(mechanism, leg)
    return _folded(sympy.atan2(-side * up[0], side * up[1]))


def _folded(number: sympy.Expr) -> sympy.Expr:
    """Exact multiples of pi/12 stay exact."""
    if not number.is_number:
        return number
    twelfths = (12 * number / sympy.pi).evalf(DIGITS)
    nearest = sympy.Integer(int(sympy.floor(twelfths + sympy.Rational(1, 2))))
    return nearest * sympy.pi / 12 if abs(twelfths - nearest) < _CLOSE else constant(number)


def _polar(frame: Frame, parameters: Parameters) -> tuple[sympy.Expr, sympy.Expr]:
    """Length and direction of the way to the next joint."""
    x, y, _ = frame.origin
    some = {symbol: sympy.Rational(7, 11) for symbol in parameters.values()}
    if y == 0:
        ahead = bool(sympy.sympify(x).subs(some) >= 0)
        return (x, sympy.S.Zero) if ahead else (-x, sympy.pi)
    return sympy.sqrt(x**2 + y**2), sympy.atan2(y, x)


def _foot(frame: Frame, side: int) -> Planar:
    """The foot frame's origin in its own axes."""
    x, y, _ = (sympy.Add(*(a * b for a, b in zip(column, frame.origin, strict=True))) for column in frame.rotation)
    return x, side * y


def _mass(joint: Joint, parameters: Parameters, tilt: sympy.Expr, turn: int) -> LinkMass:
    """In the link's axes, which are turned by `tilt` from those that move with the joint, and reflected where `turn` is -1."""
    if joint.body is None:
        return LinkMass(sympy.S.Zero, (sympy.S.Zero, sympy.S.Zero), sympy.S.Zero)
    frame = frame_of(joint.after, parameters)
    com = [expression(entry, parameters) for entry in joint.body.com]
    x, y, _ = (frame.origin[row] + sympy.Add(*(frame.rotation[column][row] * com[column] for column in range(3))) for row in range(3))
    cosine, sine = cosine_sine(tilt)
    place = (cosine * x + sine * y, turn * (cosine * y - sine * x))
    return LinkMass(expression(joint.body.mass, parameters), place, expression(joint.body.inertia[2], parameters))


def _weight(mechanism: Mechanism, leg: Limb) -> Planar:
    """Across level ground; forward, too, where the ground rises forward."""
    size, (cosine, sine) = gravity_size(mechanism), cosine_sine(slope_of(mechanism, leg))
    return sine * size, cosine * size

"""The curve that the foot of a leg with one drive follows, where the joint before the linkage does not count.

Where that joint puts the foot nearest to a target does not depend on the drive's neighbours: what is left is the distance of two curves'
points in the half plane of radius and height (a turning joint), across the joint (a sliding one), or in space (none), a function of the
drive alone.
"""

from collections.abc import Sequence
from functools import cached_property

import sympy

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.spec.scalar import ZERO
from walkgen.symbolic.choices import less
from walkgen.symbolic.closure import forward_placing
from walkgen.symbolic.frames import Frame, expression, frame_of, parameter_symbols
from walkgen.symbolic.function import Angle, Function, Select
from walkgen.symbolic.planar_motion import Coordinate, PlanarMotion
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rows import TARGET
from walkgen.symbolic.screws import limits_of
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tape import Tape, Vec, dot, minus, plus, scaled, symbols_of

Exprs = Sequence[sympy.Expr]
AIM, BOUNDS = Port("aim", (3,), "m"), Port("bounds", (2,))
_SEAM = sympy.Rational(1, 7)
"""Where the turn of a turning drive begins beyond -pi: linkages are often special where cranks and ground are in line."""
_ON_AXIS = sympy.Rational(1, 10**24)
_ZERO = sympy.S.Zero


class Curve:
    """Of one leg.

    Args:
        mechanism: the robot.
        leg: one whose linkage has one drive.
        linkage: its own.
    """

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        self.mechanism, self.leg, self.linkage = mechanism, leg, linkage
        self.parameters, self.joint = parameter_symbols(mechanism), leg.serial[0] if leg.serial else None

    @cached_property
    def aim(self) -> Function:
        """The target where the joint does not count, and between which drives to look."""
        tape = Tape()
        aim = self.seen(self.target(tape), tape)
        words = signature(self.mechanism, self.leg.name, "curve_aim", [TARGET], [AIM, BOUNDS], "", "")
        return tape.function(words, [*aim, *self.bounds()])

    def profiled(self, drive: sympy.Symbol, tape: Tape) -> tuple[Vec, Exprs]:
        """The foot where the joint does not count, and its slopes by the drive."""
        at = self.planar(drive, tape)
        motion = PlanarMotion(tape, [drive], [Coordinate("foot_x", at[0]), Coordinate("foot_y", at[1])])
        foot, axes = tape.vector("foot", self.hung(at)), self.hinge[1].rotation
        (along_x,), (along_y,) = motion.slopes
        speed = tape.vector("speed", plus(scaled(along_x, axes[0]), scaled(along_y, axes[1])))
        return self.seen(foot, tape), self.speed(foot, speed, tape)

    def planar(self, drive: sympy.Expr, tape: Tape) -> tuple[sympy.Expr, sympy.Expr]:
        """The foot in the linkage's plane."""
        placing = forward_placing(self.leg, [drive], self.parameters, tape)
        x, y = placing.point(self.linkage.foot[0], placing.planar(self.linkage.foot[1]))
        return tape.let("foot_x", x), tape.let("foot_y", y)

    @cached_property
    def hinge(self) -> tuple[Frame, Frame]:
        """Where the joint is, its z axis the joint's, and the plane seen from there with the joint at rest."""
        mount, plane = frame_of(self.leg.mount, self.parameters), frame_of(self.leg.tip, self.parameters)
        if self.joint is None:
            return mount, plane
        return mount * frame_of(self.joint.before, self.parameters), frame_of(self.joint.after, self.parameters) * plane

    def hung(self, at: Exprs) -> Vec:
        """A point of the plane, seen from the joint at rest."""
        plane = self.hinge[1]
        return plus(plane.origin, plus(scaled(at[0], plane.rotation[0]), scaled(at[1], plane.rotation[1])))

    def target(self, tape: Tape) -> Vec:
        """From the joint."""
        x, y, z = symbols_of(TARGET)
        base = self.hinge[0]
        away = minus((x, y, z), base.origin)
        u, v, w = (dot(column, away) for column in base.rotation)
        return tape.vector("target", (u, v, w))

    def seen(self, point: Vec, tape: Tape) -> Vec:
        """What the joint cannot change of a point."""
        x, y, z = point
        if self.joint is None:
            return point
        if self.joint.kind == "prismatic":
            return (x, y, _ZERO)
        return (tape.let("radius", sympy.sqrt(x**2 + y**2)), z, _ZERO)

    def speed(self, point: Vec, speed: Vec, tape: Tape) -> Exprs:
        """Of what `seen` gives."""
        if self.joint is None:
            return speed
        if self.joint.kind == "prismatic":
            return (speed[0], speed[1], _ZERO)
        radius = tape.let("radius", sympy.sqrt(point[0] ** 2 + point[1] ** 2))
        outwards = tape.let("outwards", (point[0] * speed[0] + point[1] * speed[1]) / radius)
        return (Select(less(_ZERO, radius), outwards, tape.let("out", sympy.sqrt(speed[0] ** 2 + speed[1] ** 2))), speed[2], _ZERO)

    def bounds(self) -> Exprs:
        """Between which drives to look."""
        return drive_bounds(self.mechanism, self.leg)

    def carried(self, at: Exprs, target: Vec, tape: Tape) -> tuple[Exprs, sympy.Basic]:
        """The joint's value, none without a joint, and whether any value will do."""
        joint = self.joint
        if joint is None:
            return (), sympy.false
        zero, foot = expression(joint.zero, self.parameters), tape.vector("foot", self.hung(at))
        if joint.kind == "prismatic":
            return (tape.let("slide", joint.sign * (target[2] - foot[2] - zero)),), sympy.false
        sine = tape.let("turn_sine", foot[0] * target[1] - foot[1] * target[0])
        cosine = tape.let("turn_cosine", foot[0] * target[0] + foot[1] * target[1])
        size = tape.let("turn_size", target[0] ** 2 + target[1] ** 2)
        free = less(size, _ON_AXIS)
        turn = tape.let("turn", joint.sign * (tape.let("turned", Select(free, 0, Angle(sine, cosine))) - zero))
        if joint.zero != ZERO:
            turn = tape.let("turn_wrapped", Angle(sympy.sin(turn), sympy.cos(turn)))
        return (turn,), free


def drive_bounds(mechanism: Mechanism, leg: Limb) -> Exprs:
    """Of a linkage's one drive: a turn, about the start of triads, or the limits and half of their width beyond them."""
    drive, linkage = leg.drives[0], leg.linkage
    assert linkage is not None
    if drive.kind == "revolute":
        seam = sympy.Rational(str(found_start(mechanism, leg).drives[0])) if linkage.forward.triads else _SEAM
        return (seam - sympy.pi, seam + sympy.pi)
    low, high = limits_of(drive, parameter_symbols(mechanism))
    least, most = (3 * low - high) / 2, (3 * high - low) / 2
    return (Select(less(least, 0), 0, least) if linkage.structure.bars else least, most)

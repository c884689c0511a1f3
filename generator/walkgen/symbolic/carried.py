"""A leg of one drive and two joints with the drive held: what the two joints do about a target, and what is left to the drive.

Seen from the first joint the foot is h(q2) = c + u cos q2 + v sin q2, or c + w q2 where the second slides; the first joint takes any foot
to the target that is as high along its axis and as far from it (one that slides: at the same place across it). One of these two equations
gives the second joint, on two sides, the other one is left.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.model.carried import joint_pair, solved_first
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import defaults
from walkgen.signature import Port
from walkgen.spec.scalar import ZERO
from walkgen.symbolic.choices import less
from walkgen.symbolic.closure import forward_placing
from walkgen.symbolic.frames import Frame, expression, frame_of, parameter_symbols
from walkgen.symbolic.function import Angle, Function, Indicator, Select
from walkgen.symbolic.ports import signature
from walkgen.symbolic.tangents import tangents
from walkgen.symbolic.tape import Tape, Vec, dot, minus, plus, scaled, symbols_of, times

Exprs = Sequence[sympy.Expr]
POINT = Port("point", (5,))
"""The drive, the side, the target."""
PROFILE = Port("profile", (9,))
"""What is left (m), the margin of the second joint's sides, their slopes by the drive, a size, whether the first joint is free, q."""
_ON_AXIS = sympy.Rational(1, 10**24)
_LEVEL, _AWAY = 0, 1
_ONE, _ZERO = sympy.S.One, sympy.S.Zero


_Met = tuple[sympy.Expr, Vec, sympy.Expr, sympy.Expr]
"""The second joint's angle or way, the foot there, what is left of the equations, the margin of its sides."""


@dataclass(frozen=True)
class _Circle:
    """The foot at a second joint that turns: c + u cos + v sin."""

    centre: Vec
    cosine: Vec
    sine: Vec


class Carried:
    """Of one leg.

    Args:
        mechanism: the robot.
        leg: one whose linkage has one drive, with two joints before it or after it.
        linkage: its own.
    """

    def __init__(self, mechanism: Mechanism, leg: Limb, linkage: Linkage) -> None:
        self._mechanism, self._leg, self._linkage = mechanism, leg, linkage
        self._parameters, (self._first, self._second) = parameter_symbols(mechanism), joint_pair(leg)

    @property
    def sides(self) -> int:
        """On how many the second joint can be."""
        return 1 if self._first.kind == self._second.kind == "prismatic" else 2

    @cached_property
    def profile(self) -> Function:
        """Of a point, as the routine calls it."""
        tape, (drive, side, *target) = Tape(), symbols_of(POINT)
        before, between, beyond = self._segments(drive, tape)
        away = minus((target[0], target[1], target[2]), before.origin)
        aim = tape.vector("aim", [dot(column, away) for column in before.rotation])
        second, foot, left, margin = self._met(between, beyond.origin, aim, side, tape)
        told = tape.let("left", left), margin
        slopes = [row[0] for row in tangents(tape, told, [("drive", drive)])]
        first, free = self._carried(foot, aim, tape)
        size = sympy.Add(*(abs(entry) for entry in (*foot, *aim)))
        pair = [self._told(self._first, first, tape), self._told(self._second, second, tape)]
        turning = self._leg.drives[0].kind == "revolute"
        pair.insert(len(self._leg.serial), Select(less(sympy.pi, drive), drive - 2 * sympy.pi, drive) if turning else drive)
        words = signature(self._mechanism, self._leg.name, "carried_profile", [POINT], [PROFILE], "", "")
        return tape.function(words, [*told, *slopes, size, Indicator(free) if free != sympy.false else _ZERO, *pair])

    # ---- frames

    def _segments(self, drive: sympy.Expr, tape: Tape) -> tuple[Frame, Frame, Frame]:
        """Before the first joint, between the two, beyond the second."""
        segments = [frame_of(self._leg.mount, self._parameters)]
        for joint in (*self._leg.serial, None, *self._leg.distal):
            if joint is None:
                segments[-1] = self._on(segments[-1], frame_of(self._leg.tip, self._parameters), tape)
                segments[-1] = self._on(segments[-1], self._link(drive, tape), tape)
            else:
                segments[-1] = self._on(segments[-1], frame_of(joint.before, self._parameters), tape)
                segments.append(frame_of(joint.after, self._parameters))
        before, between, beyond = segments
        return before, between, self._on(beyond, frame_of(self._leg.foot, self._parameters), tape)

    @staticmethod
    def _on(frame: Frame, other: Frame, tape: Tape) -> Frame:
        """One on the other, by names."""
        product = frame * other
        x, y, z = (tape.vector("axis", column) for column in product.rotation)
        return Frame((x, y, z), tape.vector("origin", product.origin))

    def _link(self, drive: sympy.Expr, tape: Tape) -> Frame:
        """The linkage's end in its plane."""
        placing = forward_placing(self._leg, [drive], self._parameters, tape)
        body, point = self._linkage.foot
        x, y = placing.point(body, placing.planar(point))
        cosine, sine = placing.pose(body).rotor
        return Frame(((cosine, sine, _ZERO), (-sine, cosine, _ZERO), (_ZERO, _ZERO, _ONE)), tape.vector("end", (x, y, _ZERO)))

    # ---- the second joint

    def _met(self, between: Frame, lever: Vec, aim: Vec, side: sympy.Expr, tape: Tape) -> _Met:
        """What the second joint does."""
        if self._second.kind == "revolute":
            return self._turned(between, lever, aim, side, tape)
        start, axis = tape.vector("start", plus(between.origin, times(between.rotation, lever))), between.rotation[2]
        way, margin = self._slid(start, axis, aim, side, tape)
        foot = tape.vector("foot", plus(start, scaled(way, axis)))
        if self._first.kind == "revolute":
            return way, foot, self._aside(foot, aim, tape), margin
        return way, foot, axis[0] * (foot[1] - aim[1]) - axis[1] * (foot[0] - aim[0]), margin

    @staticmethod
    def _aside(foot: Vec, aim: Vec, tape: Tape) -> sympy.Expr:
        """How far a foot that is as far away as the target is from it on the sphere, by the sine of the angle between their circles."""
        radius, other = (tape.let("radius", sympy.sqrt(x**2 + y**2)) for x, y, _ in (foot, aim))
        return (radius * aim[2] - foot[2] * other) / tape.let("distance", sympy.sqrt(dot(aim, aim)))

    def _slid(self, start: Vec, axis: Vec, aim: Vec, side: sympy.Expr, tape: Tape) -> tuple[sympy.Expr, sympy.Expr]:
        """As far from the first joint as the target, or as near to it across that joint as can be."""
        if self._first.kind == "prismatic":
            across = tape.let("across", axis[0] ** 2 + axis[1] ** 2)
            return tape.let("way", (axis[0] * (aim[0] - start[0]) + axis[1] * (aim[1] - start[1])) / across), across
        ahead = tape.let("ahead", -dot(start, axis))
        inside = tape.let("inside", ahead**2 - dot(start, start) + dot(aim, aim))
        return tape.let("way", ahead + side * sympy.sqrt(inside)), inside

    def _turned(self, between: Frame, lever: Vec, aim: Vec, side: sympy.Expr, tape: Tape) -> _Met:
        """As high as the target, and what is left of the distance, or the other way round."""
        x, y, z = between.rotation
        circle = _Circle(
            tape.vector("centre", plus(between.origin, scaled(lever[2], z))),
            tape.vector("across", plus(scaled(lever[0], x), scaled(lever[1], y))),
            tape.vector("along", plus(scaled(lever[0], y), scaled(-lever[1], x))),
        )
        row = solved_first(self._leg, defaults(self._mechanism))
        a, b, d = (tape.let(f"factor_{letter}", entry) for letter, entry in zip("abd", self._equation(row, circle, aim, tape), strict=True))
        size = tape.let("factors", a**2 + b**2)
        inside = tape.let("inside", size - d**2)
        root = tape.let("root", side * sympy.sqrt(inside))
        cosine, sine = tape.let("cosine", (a * d - b * root) / size), tape.let("sine", (b * d + a * root) / size)
        foot = tape.vector("foot", plus(circle.centre, plus(scaled(cosine, circle.cosine), scaled(sine, circle.sine))))
        return Angle(sine, cosine), foot, self._left(row, foot, aim, tape), inside

    def _equation(self, row: int, circle: _Circle, aim: Vec, tape: Tape) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
        """a cos + b sin = d."""
        c, u, v = circle.centre, circle.cosine, circle.sine
        if self._first.kind == "prismatic":
            return u[row], v[row], aim[row] - c[row]
        if row == _LEVEL:
            return u[2], v[2], aim[2] - c[2]
        squares = tape.let("squares", dot(aim, aim) - dot(c, c) - dot(u, u))
        return dot(c, u), dot(c, v), squares / 2

    def _left(self, row: int, foot: Vec, aim: Vec, tape: Tape) -> sympy.Expr:
        """Of the other equation."""
        if self._first.kind == "prismatic":
            return foot[1 - row] - aim[1 - row]
        if row == _AWAY:
            return foot[2] - aim[2]
        radius, other = (tape.let("radius", sympy.sqrt(x**2 + y**2)) for x, y, _ in (foot, aim))
        return radius - other

    # ---- the first joint

    def _carried(self, foot: Vec, aim: Vec, tape: Tape) -> tuple[sympy.Expr, sympy.Basic]:
        """Its angle or way, and whether any will do."""
        if self._first.kind == "prismatic":
            return aim[2] - foot[2], sympy.false
        free = less(tape.let("off_axis", aim[0] ** 2 + aim[1] ** 2), _ON_AXIS)
        sine, cosine = foot[0] * aim[1] - foot[1] * aim[0], foot[0] * aim[0] + foot[1] * aim[1]
        return Select(free, 0, Angle(tape.let("turn_sine", sine), tape.let("turn_cosine", cosine))), free

    def _told(self, joint: Joint, motion: sympy.Expr, tape: Tape) -> sympy.Expr:
        """As q."""
        value = tape.let("told", joint.sign * (tape.let("motion", motion) - expression(joint.zero, self._parameters)))
        if joint.kind == "prismatic" or joint.zero == ZERO:
            return value
        return tape.let("wrapped", Angle(sympy.sin(value), sympy.cos(value)))

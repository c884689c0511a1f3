"""Kinematics of a leg whose foot stands flat on the ground, and the angles of its links (theory 8.1 and 8.2)."""

from collections.abc import Callable
from dataclasses import dataclass

import sympy

from walkgen.signature import Port
from walkgen.symbolic.branches import BAD_INPUT, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import at_most, either, less
from walkgen.symbolic.function import Angle, Function, Opposite, Same, Select
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.rolling_leg import Planar
from walkgen.symbolic.settled import Case, settled
from walkgen.symbolic.sole_ports import (
    ANGLES,
    ANKLE_X,
    DOWN,
    HIP,
    HIP_MOTION,
    KNEE,
    MOTION,
    PLANE,
    ROWS,
    STATUS,
    THIGH,
    Exprs,
    SoleLeg,
    cross,
    inner,
    named,
)
from walkgen.symbolic.tape import Tape, symbols_of

_SLACK = sympy.Rational(1, 10**12)
STRAIGHT = sympy.Rational(1, 10**9)
"""The sine of an angle between links that counts as none."""


@dataclass(frozen=True)
class Triangle:
    """Of hip, knee and ankle: unit vectors along thigh and shank, their angles, and where there is none."""

    thigh: Planar
    shank: Planar
    angles: Planar
    cases: tuple[Case, ...]


class FlatStance:
    """Functions of one leg."""

    def __init__(self, own: SoleLeg) -> None:
        self._own = own

    def functions(self) -> dict[str, Callable[[], Function]]:
        """By name."""
        return {
            "link_angles": self.link_angles,
            "joint_angles": self.joint_angles,
            "flat_ankle": self.flat_ankle,
            "flat_position": self.flat_position,
            "flat_motion": self.flat_motion,
        }

    def link_angles(self) -> Function:
        """[3]."""
        q = joint_port("q", self._own.limb.joints)
        doc = f"Angles of thigh, shank and foot {PLANE}; a foot that stands flat is at -pi/2."
        return self._own.function(Tape(), "link_angles", [q], [ANGLES], self._own.leg.angles(symbols_of(q)[-3:]), doc, "theory 8.1")

    def joint_angles(self) -> Function:
        """[3]."""
        found = self._own.leg.joints(symbols_of(ANGLES))
        doc = "q of hip, knee and ankle for the angles of thigh, shank and foot."
        return self._own.function(Tape(), "joint_angles", [ANGLES], [Port("q", (3,), "rad")], found, doc, "theory 8.1")

    def flat_ankle(self) -> Function:
        """Given the thigh's angle."""
        tape, own, shank = Tape(), self._own, Port("shank", kind="integer", default=(-1.0,))
        hip, (angle,), (side,) = symbols_of(HIP), symbols_of(THIGH), symbols_of(shank)
        knee, _ = own.knee(tape, (hip[0], hip[1]), angle)
        rise = tape.let("shank_sine", (own.height - knee[1]) / own.leg.shank)
        square = tape.let("shank_cosine2", (1 - rise) * (1 + rise))
        cosine = tape.let("shank_cosine", side * sympy.sqrt(tape.let("clear", Select(less(0, square), square, 0))))
        cases = ((Opposite(Same(side**2, 1)), BAD_INPUT), (less(1 + _SLACK, abs(rise)), UNREACHABLE))
        outputs = [angle, Angle(rise, cosine), DOWN, knee[0] + own.leg.shank * cosine]
        doc = (
            f"The flat foot's ankle for a thigh's angle, {PLANE}; shank: 1 where the ankle is ahead of the knee, -1 where it is behind. "
            "UNREACHABLE: the knee is too high or too low."
        )
        found = settled(tape, (*hip, angle, side), cases, outputs)
        return own.function(tape, "flat_ankle", [HIP, THIGH, shank], [ANGLES, ANKLE_X, STATUS], found, doc, "eq. (24), errata 8.2, 8.3")

    def flat_position(self) -> Function:
        """Given the ankle."""
        tape, hip, (ankle,), (knee,) = Tape(), symbols_of(HIP), symbols_of(ANKLE_X), symbols_of(KNEE)
        triangle = self._triangle(tape, (hip[0], hip[1]), ankle, knee)
        found = settled(tape, (*hip, ankle, knee), triangle.cases, [*triangle.angles, DOWN])
        doc = (
            f"Angles of thigh, shank and the flat foot under a hip, {PLANE}; knee: 1 where the thigh is turned on from the line "
            "between hip and ankle, -1 back. UNREACHABLE: the ankle is too far or too near; SINGULAR: it is at the hip."
        )
        return self._own.function(tape, "flat_position", [HIP, ANKLE_X, KNEE], [ANGLES, STATUS], found, doc, "theory 8.2")

    def flat_motion(self) -> Function:
        """With rates and accelerations."""
        tape, hip, (ankle,), (knee,) = Tape(), symbols_of(HIP_MOTION), symbols_of(ANKLE_X), symbols_of(KNEE)
        outputs, cases = self.moving(tape, hip, ankle, knee)
        doc = (
            f"Angles of thigh, shank and the flat foot under a hip that moves, {PLANE}; {ROWS}. knee as in flat_position. UNREACHABLE: the "
            "ankle is too far or too near; SINGULAR: the knee is straight or the leg is folded."
        )
        found = settled(tape, (*hip, ankle, knee), cases, outputs)
        return self._own.function(tape, "flat_motion", [HIP_MOTION, ANKLE_X, KNEE], [MOTION, STATUS], found, doc, "theory 8.2")

    def moving(self, tape: Tape, hip: Exprs, ankle: sympy.Expr, knee: sympy.Expr) -> tuple[list[sympy.Expr], tuple[Case, ...]]:
        """Angles, rates and accelerations [9]: [AB n1 | BC n2] times the rates is what the hip does, turned round."""
        leg, triangle = self._own.leg, self._triangle(tape, (hip[0], hip[1]), ankle, knee)
        sine = tape.let("knee_sine", cross(triangle.thigh, triangle.shank))

        def solved(word: str, right: Planar) -> Planar:
            first = tape.let(f"thigh_{word}", inner(right, triangle.shank) / (leg.thigh * sine))
            return first, tape.let(f"shank_{word}", -inner(right, triangle.thigh) / (leg.shank * sine))

        rates = solved("rate", (-hip[2], -hip[3]))
        pulls = named(tape, "pull", (leg.thigh * rates[0] ** 2, leg.shank * rates[1] ** 2))
        right_x, right_y = (pulls[0] * triangle.thigh[axis] + pulls[1] * triangle.shank[axis] - hip[4 + axis] for axis in (0, 1))
        accelerations = solved("acceleration", named(tape, "right", (right_x, right_y)))
        outputs = [*triangle.angles, DOWN, *rates, sympy.S.Zero, *accelerations, sympy.S.Zero]
        return outputs, (*triangle.cases, (at_most(abs(sine), STRAIGHT), SINGULAR))

    def _triangle(self, tape: Tape, hip: Planar, ankle: sympy.Expr, knee: sympy.Expr) -> Triangle:
        """By its area, which keeps its digits next to a straight knee."""
        a, b = self._own.leg.thigh, self._own.leg.shank
        x, y = named(tape, "away", (ankle - hip[0], self._own.height - hip[1]))
        square = tape.let("distance2", x**2 + y**2)
        distance = tape.let("distance", sympy.sqrt(square))
        longest, least = tape.let("longest", a + b), tape.let("least", abs(a - b))
        area = tape.let("area", (longest + distance) * (longest - distance) * (distance + least) * (distance - least))
        sine = tape.let("sine", knee * sympy.sqrt(Select(less(0, area), area, 0)))
        cosine = tape.let("cosine", a**2 - b**2 + square)
        along = named(tape, "along", ((x * cosine - y * sine) / (2 * square), (y * cosine + x * sine) / (2 * square)))
        rest = named(tape, "rest", (x - along[0], y - along[1]))
        cases = (
            (Opposite(Same(knee**2, 1)), BAD_INPUT),
            (at_most(distance, _SLACK * longest), SINGULAR),
            (either(less(longest * (1 + _SLACK), distance), less(distance, least - _SLACK * longest)), UNREACHABLE),
        )
        units = named(tape, "thigh", (along[0] / a, along[1] / a)), named(tape, "shank", (rest[0] / b, rest[1] / b))
        return Triangle(*units, (Angle(along[1], along[0]), Angle(rest[1], rest[0])), cases)

"""What a leg stands on, posed: its foot point, or the corners of its sole about that, of a rolling one the ends of where it touches."""

from dataclasses import dataclass

import sympy

from walkgen.model.curved_sole import CurvedSole
from walkgen.model.mechanism import CORNERS, Limb, Mechanism, Sole
from walkgen.symbolic.choices import at_most
from walkgen.symbolic.driven import DrivenKinematics
from walkgen.symbolic.frames import Parameters, expression, frame_of
from walkgen.symbolic.function import Select
from walkgen.symbolic.ground_plane import FLAT, foot_rotor
from walkgen.symbolic.path import Kinematics, path_of, touch_port
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, minus, plus, scaled, symbols_of, times


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


def footing(mechanism: Mechanism, leg: Limb, kinematics: Kinematics | DrivenKinematics) -> Footing:
    """Of a leg at the end of a path; without a sole, its foot point."""
    if leg.curved_sole is not None:
        assert isinstance(kinematics, Kinematics)
        return _rolling(mechanism, leg, leg.curved_sole, kinematics)
    return Footing(kinematics.position) if leg.sole is None else _rectangle(leg.sole, kinematics)


def _rectangle(sole: Sole, kinematics: Kinematics | DrivenKinematics) -> Footing:
    tape, parameters = kinematics.tape, kinematics.parameters
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


def _rolling(mechanism: Mechanism, leg: Limb, sole: CurvedSole, kinematics: Kinematics) -> Footing:
    """Front and rear edge of the flat part where that lies on the ground; where the foot rolls both are the line on which it does."""
    tape, parameters, side = kinematics.tape, kinematics.parameters, sole.side
    own = Kinematics(path_of((leg,), kinematics.path.q[-len(leg.joints) :], parameters), tape)
    forward, down = (tape.let("normal_in_foot", part) for part in foot_rotor(mechanism, leg, own.rotation))
    x, y, z = kinematics.rotation
    flat, (_, touch) = at_most(abs(forward), FLAT), symbols_of(touch_port(leg))
    front, rear = (
        tape.vector("edge", scaled(tape.let("to_edge", Select(flat, side * expression(edge, parameters) - touch, 0)), y))
        for edge in (sole.front, sole.rear)
    )
    normal = tape.vector("ground_normal", plus(scaled(down, x), scaled(side * forward, y)))
    if sole.width is None:
        return Footing(kinematics.position, (front, rear), normal)
    aside = tape.vector("aside", scaled(expression(sole.width, parameters) / 2, z))
    levers = (plus(front, aside), plus(rear, aside), minus(rear, aside), minus(front, aside))
    return Footing(kinematics.position, tuple(tape.vector("corner", lever) for lever in levers), normal)

"""The inverse of a leg of hip, knee and ankle with a curved sole: joint values that put the foot flat, its point on a target."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.branches import BAD_INPUT, DUPLICATE, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import at_most, both, chosen, either, less
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Angle, Finite, Function, Residue, Select
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rolling_leg import GroundFrame, Planar, ground_frame
from walkgen.symbolic.sole_ports import DOWN, SoleLeg, named
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, symbols_of

_SLACK = sympy.Rational(1, 10**12)
"""Of the leg's reach; a target so far outside is reached."""
FLAT_SOURCE = "theory 8.2: the flat foot's ankle under the hip, cosine rule"


@dataclass(frozen=True)
class _Plane:
    """A way to bring the leg's plane to the target: q before the hip, how far the target is ahead of the hip there and beside the plane.

    `open` is whether any q there would do, `twice` whether it is the way before once more.
    """

    q: tuple[sympy.Expr, ...]
    ahead: sympy.Expr
    beside: sympy.Expr
    open: sympy.Basic
    twice: sympy.Basic


@dataclass(frozen=True)
class _Ankle:
    """From the hip: its direction, how far it is and how far the leg brings it."""

    towards: Planar
    distance: sympy.Expr
    reached: sympy.Expr


def flat_branches(mechanism: Mechanism, leg: Limb, place: Port, outputs: Sequence[Port]) -> Function:
    """Both knees of every way for a target `place` [3]: q [b,n] and status [b]; unreachable rows hold what brings the flat foot closest.

    A leg of hip, knee and ankle has one way, a joint before the hip another one backward.
    """
    own, tape, target = SoleLeg.of(mechanism, leg), Tape(), symbols_of(place)
    x, y, z = target
    planes, above = _planes(own, tape, (x, y, z))
    taint = tape.let("taint", sympy.Add(*(Residue(entry) for entry in target)))
    values: list[sympy.Expr] = []
    states: list[sympy.Expr] = []
    for plane in planes:
        rows, status, straight = _knees(own, tape, plane, above)
        status = tape.let("status", Select(Finite(taint), chosen(plane.twice, _doubled(status), status), BAD_INPUT))
        values += [value + taint for row in rows for value in (*plane.q, *row)]
        states += [status, Select(straight, _doubled(status), status)]
    return tape.function(signature(mechanism, leg.name, "inverse_flat", [place], outputs, "", FLAT_SOURCE), [*values, *states])


def flat_distance(mechanism: Mechanism, leg: Limb, place: Port, output: Port) -> Function:
    """How far from the target `place` [3] the foot point is at every branch."""
    own, tape, target = SoleLeg.of(mechanism, leg), Tape(), symbols_of(place)
    x, y, z = target
    planes, above = _planes(own, tape, (x, y, z))
    taint = tape.let("taint", sympy.Add(*(Residue(entry) for entry in target)))
    missed = []
    for plane in planes:
        ankle = _ankle(own, tape, plane.ahead, above)
        missed += 2 * [tape.let("missed", sympy.sqrt((ankle.distance - ankle.reached) ** 2 + plane.beside**2)) + taint]
    doc = "Distance from p of the flat foot at every branch of inverse: 0 where it reaches, NaN for a bad input."
    return tape.function(signature(mechanism, leg.name, "inverse_distance", [place], [output], doc, FLAT_SOURCE), missed)


def _doubled(status: sympy.Expr) -> sympy.Expr:
    """Of a row that another one equals."""
    return Select(at_most(abs(status), 0), DUPLICATE, status)


def _knees(own: SoleLeg, tape: Tape, plane: _Plane, above: sympy.Expr) -> tuple[list[list[sympy.Expr]], sympy.Expr, sympy.Basic]:
    """q of hip, knee and ankle for both knees, their status, and whether they are one."""
    a, b = own.leg.thigh, own.leg.shank
    longest, least = tape.let("longest", a + b), tape.let("least", abs(a - b))
    ankle = _ankle(own, tape, plane.ahead, above)
    by_distance = (ankle.reached**2 + a**2 - b**2) / (2 * a * ankle.reached)
    cosine = tape.let("cosine", Select(less(0, ankle.reached), by_distance, 0))
    square = tape.let("sine2", (1 - cosine) * (1 + cosine))
    sine = tape.let("sine", sympy.sqrt(tape.let("clear", Select(less(0, square), square, 0))))
    slack = _SLACK * longest
    folded = both(at_most(ankle.distance, slack), at_most(least, slack))
    status: sympy.Expr = Select(either(folded, plane.open), SINGULAR, OK)
    away = either(less(longest + slack, ankle.distance), less(ankle.distance, least - slack))
    status = Select(either(away, less(slack, abs(plane.beside))), UNREACHABLE, status)
    return [_row(own, tape, ankle, cosine, knee * sine) for knee in (1, -1)], status, at_most(sine, 0)


def _planes(own: SoleLeg, tape: Tape, target: Vec) -> tuple[tuple[_Plane, ...], sympy.Expr]:
    """The ways, and how far the ankle of a flat foot on the target is above the hip."""
    frame = ground_frame(own.mechanism, own.limb)
    away = tape.vector("away", minus(target, frame.hip))
    above, below = tape.let("above", dot(away, frame.normal) + own.height), _below(own)
    if frame.turn == 0:
        ahead = tape.let("ahead", dot(away, frame.forward) - below)
        beside = tape.let("beside", dot(away, frame.aside) - frame.shift)
        return (_Plane((), ahead, beside, sympy.false, sympy.false),), above
    return _turned(own, tape, frame, target, below), above


def _turned(own: SoleLeg, tape: Tape, frame: GroundFrame, target: Vec, below: sympy.Expr) -> tuple[_Plane, ...]:
    """Ahead and behind the axis that turns the plane, which is as far from it as before."""
    left = cross(frame.normal, frame.forward)
    hip, place = (tape.vector(name, minus(point, frame.pivot)) for name, point in (("arm", frame.hip), ("lever", target)))
    x, y = tape.let("lever_x", dot(place, frame.forward)), tape.let("lever_y", dot(place, left))
    off = tape.let("off", dot(hip, left) + dot(frame.aside, left) * frame.shift)
    start = tape.let("start", dot(hip, frame.forward))
    larger = tape.let("larger", Select(less(abs(x), abs(y)), abs(y), abs(x)))
    scale = tape.let("scale", Select(less(0, larger), larger, 1))  # so that no square overflows
    (x, y), share = named(tape, "lever", (x / scale, y / scale)), tape.let("share", off / scale)
    square = tape.let("lever2", x**2 + y**2)
    clear = tape.let("clear2", square - share**2)
    depth = tape.let("depth", sympy.sqrt(Select(less(0, clear), clear, 0)))
    size = tape.let("size", scale * sympy.sqrt(square))
    nowhere = at_most(size, _SLACK * (own.leg.thigh + own.leg.shank))
    beside = tape.let("beside", Select(less(0, clear), 0, abs(off) - size))
    planes = []
    for way in (1, -1):
        cosine, sine = named(tape, "turn", (x * way * depth + y * share, y * way * depth - x * share))
        q = tape.let("yaw", Select(nowhere, 0, Angle(frame.turn * sine, cosine)))
        twice = at_most(depth, 0) if way < 0 else sympy.false
        planes.append(_Plane((q,), tape.let("ahead", way * scale * depth - start - below), beside, nowhere, twice))
    return tuple(planes)


def _ankle(own: SoleLeg, tape: Tape, ahead: sympy.Expr, above: sympy.Expr) -> _Ankle:
    a, b = own.leg.thigh, own.leg.shank
    longest, least = tape.let("longest", a + b), tape.let("least", abs(a - b))
    distance = tape.let("distance", sympy.sqrt(tape.let("distance2", ahead**2 + above**2)))
    clear = less(_SLACK * longest, distance)
    towards = named(tape, "towards", (Select(clear, ahead / distance, 0), Select(clear, above / distance, -1)))
    reached = tape.let("reached", Select(less(longest, distance), longest, Select(less(distance, least), least, distance)))
    return _Ankle(towards, distance, reached)


def _below(own: SoleLeg) -> sympy.Expr:
    """How far the flat foot's point is ahead of the ankle: 0 where that is over the flat part, else its nearer edge."""
    parameters, sole = parameter_symbols(own.mechanism), own.leg.sole
    rear, front = (own.leg.foot[1] + expression(edge, parameters) for edge in (sole.rear, sole.front))
    return Select(less(0, rear), rear, Select(less(front, 0), front, 0))


def _row(own: SoleLeg, tape: Tape, ankle: _Ankle, cosine: sympy.Expr, sine: sympy.Expr) -> list[sympy.Expr]:
    """q in (-pi, pi]."""
    (x, y), (a, b) = ankle.towards, (own.leg.thigh, own.leg.shank)
    thigh = named(tape, "thigh", (x * cosine - y * sine, y * cosine + x * sine))
    shank = named(tape, "shank", ((ankle.reached * x - a * thigh[0]) / b, (ankle.reached * y - a * thigh[1]) / b))
    angles = [tape.let("link", Angle(thigh[1], thigh[0])), tape.let("link", Angle(shank[1], shank[0])), DOWN]
    turned = [tape.let("turned", value) for value in own.leg.joints(angles)]
    return [tape.let("joint", Angle(sympy.sin(value), sympy.cos(value))) for value in turned]

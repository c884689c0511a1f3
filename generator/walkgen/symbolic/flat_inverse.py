"""The inverse of a leg of hip, knee and ankle with a curved sole: joint values that put the foot flat, its point on a target."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.branches import BAD_INPUT, DUPLICATE, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import at_most, both, either, less
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Angle, Finite, Function, Residue, Select
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rolling_leg import Planar, ground_frame
from walkgen.symbolic.sole_ports import DOWN, SoleLeg, named
from walkgen.symbolic.tape import Tape, Vec, dot, minus, symbols_of

_SLACK = sympy.Rational(1, 10**12)
"""Of the leg's reach; a target so far outside is reached."""
FLAT_SOURCE = "theory 8.2: the flat foot's ankle under the hip, cosine rule"


@dataclass(frozen=True)
class _Ankle:
    """From the hip: its direction, how far it is and how far the leg brings it, how far the target is beside the leg's plane."""

    towards: Planar
    distance: sympy.Expr
    reached: sympy.Expr
    beside: sympy.Expr


def flat_branches(mechanism: Mechanism, leg: Limb, place: Port, outputs: Sequence[Port]) -> Function:
    """Both knees for a target `place` [3]: q [2,3] and status [2]; unreachable rows hold what brings the flat foot closest."""
    own, tape, target = SoleLeg.of(mechanism, leg), Tape(), symbols_of(place)
    x, y, z = target
    a, b = own.leg.thigh, own.leg.shank
    longest, least = tape.let("longest", a + b), tape.let("least", abs(a - b))
    ankle = _ankle(own, tape, (x, y, z), longest, least)
    by_distance = (ankle.reached**2 + a**2 - b**2) / (2 * a * ankle.reached)
    cosine = tape.let("cosine", Select(less(0, ankle.reached), by_distance, 0))
    square = tape.let("sine2", (1 - cosine) * (1 + cosine))
    sine = tape.let("sine", sympy.sqrt(tape.let("clear", Select(less(0, square), square, 0))))
    slack = _SLACK * longest
    status: sympy.Expr = Select(both(at_most(ankle.distance, slack), at_most(least, slack)), SINGULAR, OK)
    away = either(less(longest + slack, ankle.distance), less(ankle.distance, least - slack))
    status = Select(either(away, less(slack, abs(ankle.beside))), UNREACHABLE, status)
    taint = tape.let("taint", sympy.Add(*(Residue(entry) for entry in target)))
    status = tape.let("status", Select(Finite(taint), status, BAD_INPUT))
    values: list[sympy.Expr] = []
    for knee in (1, -1):
        values += [value + taint for value in _row(own, tape, ankle, cosine, knee * sine)]
    twice = Select(both(at_most(sine, 0), at_most(abs(status), 0)), DUPLICATE, status)
    return tape.function(signature(mechanism, leg.name, "inverse_flat", [place], outputs, "", FLAT_SOURCE), [*values, status, twice])


def _ankle(own: SoleLeg, tape: Tape, target: Vec, longest: sympy.Expr, least: sympy.Expr) -> _Ankle:
    frame = ground_frame(own.mechanism, own.limb)
    away = tape.vector("away", minus(target, frame.hip))
    ahead = tape.let("ahead", dot(away, frame.forward) - _below(own))
    above = tape.let("above", dot(away, frame.normal) + own.height)
    distance = tape.let("distance", sympy.sqrt(tape.let("distance2", ahead**2 + above**2)))
    clear = less(_SLACK * longest, distance)
    towards = named(tape, "towards", (Select(clear, ahead / distance, 0), Select(clear, above / distance, -1)))
    reached = tape.let("reached", Select(less(longest, distance), longest, Select(less(distance, least), least, distance)))
    return _Ankle(towards, distance, reached, tape.let("beside", dot(away, frame.aside) - frame.shift))


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

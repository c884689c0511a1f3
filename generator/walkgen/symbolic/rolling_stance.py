"""Kinematics of a leg whose foot rolls over toe or heel without slipping (theory 8.3)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy

from walkgen.signature import Port
from walkgen.spec.directrix import AHEAD
from walkgen.symbolic.branches import OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import at_most, both, less
from walkgen.symbolic.directrix import Directrix
from walkgen.symbolic.first_root import FirstRoot, whole
from walkgen.symbolic.flat_stance import STRAIGHT
from walkgen.symbolic.function import Angle, Derivation, Function, Opposite, Same, Select, Solve
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rolling_leg import Planar
from walkgen.symbolic.settled import settled
from walkgen.symbolic.sole_ports import (
    ANGLES,
    ANKLE,
    ANKLE_X,
    CONTACT,
    CONTACT_POINT,
    DOWN,
    EDGE,
    HIP,
    HIP_MOTION,
    MOTION,
    PHASE,
    PLANE,
    ROWS,
    STATUS,
    THIGH,
    THIGH_MOTION,
    Exprs,
    SoleLeg,
    inner,
    named,
)
from walkgen.symbolic.tape import Tape, symbols_of

_PHASES = (
    "phase: 0 flat, 1 on the toe, -1 on the heel; contact: the curve's parameter, its start where flat; contact_point: below the ankle "
    "where flat"
)


@dataclass(frozen=True)
class RollingMotion:
    """A leg in motion whose foot rolls: what `<curve>_motion` gives, the curve, and where the shank points to the contact point."""

    curve: Directrix
    contact: Exprs
    angles: Exprs
    point: Planar
    ankle: Exprs
    margins: Planar
    still: sympy.Basic


class RollingStance:
    """Functions of one leg."""

    def __init__(self, own: SoleLeg) -> None:
        self._own = own
        self._curves = tuple(own.leg.sole.curves())

    def functions(self) -> dict[str, Callable[[], Derivation]]:
        """By name."""
        found: dict[str, Callable[[], Derivation]] = {"stance_position": self.stance_position, "hip_position": self.hip_position}
        for which in self._curves:
            found[f"{which}_rolling"] = lambda which=which: self.rolling(which)  # type: ignore[misc]
            found[f"{which}_motion"] = lambda which=which: self.motion(which)  # type: ignore[misc]
        return found

    def rolling(self, which: str) -> Function:
        """What a contact parameter says of the foot."""
        tape, (contact,), (edge,) = Tape(), symbols_of(CONTACT), symbols_of(EDGE)
        curve = self.curve(which, contact, tape)
        outputs = [
            *(curve.angle, curve.turning, curve.turning_rate),
            *(curve.rolled, curve.speed, curve.stretching),
            *curve.contact_point(edge),
            *(*curve.ankle(edge), *curve.ankle_slope, *curve.ankle_bend),
        ]
        ports = [Port("foot_angle", (3,), "rad"), Port("arc_length", (3,), "m"), CONTACT_POINT, Port("ankle", (3, 2), "m")]
        doc = (
            f"The foot that rolls over its {which}, by the parameter of the curve where it touches the ground, {PLANE}; edge: where the "
            "flat part's edge touched it. Angle, arc length and ankle with their first and second derivatives by the parameter."
        )
        return self._own.function(tape, f"{which}_rolling", [CONTACT, EDGE], ports, outputs, doc, "theory 8.3, errata 8.4 to 8.7")

    def motion(self, which: str) -> Solve:
        """Given hip, thigh and where the edge touched the ground."""
        root = self.far(which)
        last = self._moved(which, root)
        doc = (
            f"The leg whose foot rolls over its {which} without slipping, by the motions of hip and thigh, {PLANE}; {ROWS}; "
            "edge: where the flat part's edge touched the ground. contact: the curve's parameter; margins: how far it is from the flat "
            "part and from the curve's end, so that the phase ends where one comes to 0. UNREACHABLE: the foot would roll on its flat part "
            "or beyond the curve; SINGULAR: the shank points to where the foot touches the ground."
        )
        inputs = [HIP_MOTION, THIGH_MOTION, EDGE]
        return self._solve(f"{which}_motion", inputs, last, [self._given_hip(which, root)], [root], doc, "theory 8.3, errata 8.5, 8.8")

    def stance_position(self) -> Solve:
        """In the phase in which the leg can be."""
        roots = [self.far(which) for which in self._curves]
        given = [self._given_thigh(which, root) for which, root in zip(self._curves, roots, strict=True)]
        doc = (
            f"The leg over a foot that stood flat with its ankle at ankle_x and may have rolled since, by hip and thigh's angle, {PLANE}. "
            f"{_PHASES}. UNREACHABLE: no shank's length leads from the knee to a foot that touches the ground within its curves."
        )
        return self._solve(
            "stance_position", [HIP, THIGH, ANKLE_X], self._stood(roots), given, roots, doc, "theory 8.3: first |C - B| = BC"
        )

    def hip_position(self) -> Solve:
        """The way back: the hip for angles of the links."""
        roots = [self.along(which, f"{which}_tangency") for which in self._curves]
        given = [self._given_foot(root) for root in roots]
        doc = (
            f"The hip over a foot that stood flat with its ankle at ankle_x and has rolled to its angle, by the links' angles, {PLANE}. "
            f"{_PHASES}. UNREACHABLE: the foot would roll beyond its curves."
        )
        last = self._hung(roots)
        return self._solve("hip_position", [ANGLES, ANKLE_X], last, given, roots, doc, "theory 8.3: x3' sin phi3 + y3' cos phi3 = 0")

    def _solve(
        self,
        name: str,
        inputs: Sequence[Port],
        last: Function,
        given: Sequence[Function],
        roots: Sequence[FirstRoot],
        doc: str,
        source: str,
    ) -> Solve:
        """Roots, then what follows from them."""
        words = signature(self._own.mechanism, self._own.limb.name, name, inputs, last.signature.outputs, doc, source)
        starts = [whole(function) for function in given]
        steps, repeated = (
            tuple(step for start, own in zip(starts, found, strict=True) for step in (start, *own))
            for found in ([root.steps() for root in roots], [root.repeated() for root in roots])
        )
        moving = bool(self._own.mechanism.parameters)
        slopes = tuple(root.slopes(start) for start, root in zip(given, roots, strict=True)) if moving else ()
        form = Solve(words, tuple(port for root in roots for port in root.repeated_locals), (*repeated, whole(last)), slopes=slopes)
        places = tuple(port for root in roots for port in root.locals)
        return Solve(words, places, (*steps, whole(last)), form, callbacks=tuple(root.callback for root in roots), slopes=slopes)

    # ---- unknowns

    def curve(self, which: str, at: sympy.Expr, tape: Tape) -> Directrix:
        """On the tape, at a parameter."""
        return Directrix(self._own.mechanism, self._own.leg, which, at, tape)

    def _bounds(self, which: str) -> Callable[[Tape], Planar]:
        return lambda tape: self.curve(which, sympy.S.Zero, tape).bounds

    def far(self, which: str) -> FirstRoot:
        """The contact parameter at which the ankle is as far from the knee as the shank is long: given knee and edge."""

        def residual(tape: Tape, at: sympy.Expr, given: Exprs) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
            curve, (knee_x, knee_y, edge) = self.curve(which, at, tape), given
            ankle = curve.ankle(edge)
            away = named(tape, "away", (ankle[0] - knee_x, ankle[1] - knee_y))
            square, own = tape.let("away2", inner(away, away)), self._own.leg.shank**2
            return (square - own) / 2, inner(away, curve.ankle_slope), (square + own) / 2

        return FirstRoot(self._own.mechanism, self._own.limb.name, which, 3, residual, self._bounds(which))

    def along(self, which: str, name: str) -> FirstRoot:
        """The contact parameter at which the curve lies along the ground: given cos and sin of the foot's angle."""

        def residual(tape: Tape, at: sympy.Expr, given: Exprs) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
            return self.curve(which, at, tape).tangency(given[0], given[1])

        return FirstRoot(self._own.mechanism, self._own.limb.name, name, 2, residual, self._bounds(which))

    def _given_hip(self, which: str, root: FirstRoot) -> Function:
        tape, hip, thigh, (edge,) = Tape(), symbols_of(HIP_MOTION), symbols_of(THIGH_MOTION), symbols_of(EDGE)
        knee, _ = self._own.knee(tape, (hip[0], hip[1]), thigh[0])
        return self._own.function(tape, f"{which}_knee", [HIP_MOTION, THIGH_MOTION, EDGE], [root.given], [*knee, edge])

    def _given_thigh(self, which: str, root: FirstRoot) -> Function:
        tape, (x, y), (thigh,), (ankle,) = Tape(), symbols_of(HIP), symbols_of(THIGH), symbols_of(ANKLE_X)
        knee, _ = self._own.knee(tape, (x, y), thigh)
        return self._own.function(tape, f"{which}_stance_knee", [HIP, THIGH, ANKLE_X], [root.given], [*knee, ankle + self._own.edge(which)])

    def _given_foot(self, root: FirstRoot) -> Function:
        tape, (_, _, foot) = Tape(), symbols_of(ANGLES)
        return self._own.function(tape, f"{root.name}_rotor", [ANGLES], [root.given], [sympy.cos(foot), sympy.sin(foot)])

    # ---- what follows from them

    def _moved(self, which: str, root: FirstRoot) -> Function:
        """The motion at the contact parameter that was found."""
        tape, (contact,), (found,) = Tape(), symbols_of(root.root), symbols_of(root.status)
        hip, thigh, (edge,) = symbols_of(HIP_MOTION), symbols_of(THIGH_MOTION), symbols_of(EDGE)
        moving = self.moving(tape, which, contact, hip, thigh, edge)
        cases = ((less(0, found), found), (moving.still, SINGULAR))
        ports = [
            Port("contact", (3,), "1, 1/s, 1/s^2"),
            MOTION,
            CONTACT_POINT,
            Port("ankle", (3, 2), "m, m/s, m/s^2"),
            Port("margins", (2,)),
            STATUS,
        ]
        outputs = [*moving.contact, *moving.angles, *moving.point, *moving.ankle, *moving.margins]
        inputs = [root.root, root.status, HIP_MOTION, THIGH_MOTION, EDGE]
        return self._own.function(tape, f"{which}_moved", inputs, ports, settled(tape, (*hip, *thigh, edge), cases, outputs))

    def moving(self, tape: Tape, which: str, contact: sympy.Expr, hip: Exprs, thigh: Exprs, edge: sympy.Expr) -> "RollingMotion":
        """The motion at a contact parameter: [BC n2 | -C'] (phi2', lambda') = -B', and its derivative."""
        (angle, rate, acceleration), own, curve = thigh, self._own.leg, self.curve(which, contact, tape)
        knee, (cosine, sine) = self._own.knee(tape, (hip[0], hip[1]), angle)
        swing, pull = named(tape, "swing", (own.thigh * rate, own.thigh * rate**2))
        knee_rate = named(tape, "knee_rate", (hip[2] - swing * sine, hip[3] + swing * cosine))
        push = tape.let("push", own.thigh * acceleration)
        knee_acceleration = named(tape, "knee_acceleration", (hip[4] - push * sine - pull * cosine, hip[5] + push * cosine - pull * sine))
        ankle, slope = curve.ankle(edge), curve.ankle_slope
        shank = named(tape, "shank", ((ankle[0] - knee[0]) / own.shank, (ankle[1] - knee[1]) / own.shank))
        across = (-shank[1], shank[0])
        reach = tape.let("reach", inner(shank, slope))
        roll = tape.let("roll", inner(shank, knee_rate) / reach)
        flow = named(tape, "flow", (slope[0] * roll, slope[1] * roll))
        turn = tape.let("shank_rate", (inner(across, flow) - inner(across, knee_rate)) / own.shank)
        bend = named(tape, "drift", (curve.ankle_bend[0] * roll**2, curve.ankle_bend[1] * roll**2))
        gap = tape.let("gap", inner(shank, knee_acceleration) - own.shank * turn**2 - inner(shank, bend))
        rolls = tape.let("roll_acceleration", gap / reach)
        ankle_acceleration = named(tape, "ankle_acceleration", (slope[0] * rolls + bend[0], slope[1] * rolls + bend[1]))
        turns = tape.let("shank_turns", (inner(across, ankle_acceleration) - inner(across, knee_acceleration)) / own.shank)
        foot = [curve.angle, curve.turning * roll, tape.let("foot_turns", curve.turning_rate * roll**2 + curve.turning * rolls)]
        start, end = curve.bounds
        return RollingMotion(
            curve,
            (contact, roll, rolls),
            (angle, Angle(shank[1], shank[0]), foot[0], rate, turn, foot[1], acceleration, turns, foot[2]),
            curve.contact_point(edge),
            (*ankle, *flow, *ankle_acceleration),
            (contact - start, end - contact),
            at_most(reach**2, STRAIGHT**2 * inner(slope, slope)),
        )

    def _stood(self, roots: Sequence[FirstRoot]) -> Function:
        """The phase whose root there is."""
        tape, (x, y), (thigh,), (ankle_x,) = Tape(), symbols_of(HIP), symbols_of(THIGH), symbols_of(ANKLE_X)
        knee, _ = self._own.knee(tape, (x, y), thigh)
        phase, contact, (foot, *places), status = self._chosen(tape, roots, ankle_x)
        away = named(tape, "away", (places[0] - knee[0], places[1] - knee[1]))
        found = settled(tape, (x, y, thigh, ankle_x), [(less(0, status), status)], [contact, thigh, Angle(away[1], away[0]), foot, *places])
        outputs = [PHASE, CONTACT, ANGLES, ANKLE, CONTACT_POINT, STATUS]
        inputs = [*self._found(roots), HIP, THIGH, ANKLE_X]
        return self._own.function(tape, "stood", inputs, outputs, [phase, *found])

    def _hung(self, roots: Sequence[FirstRoot]) -> Function:
        """From the ankle up."""
        tape, (thigh, shank, foot), (ankle_x,) = Tape(), symbols_of(ANGLES), symbols_of(ANKLE_X)
        phase, contact, (_, *places), status = self._chosen(tape, roots, ankle_x)
        lengths = self._own.leg.thigh, self._own.leg.shank
        hip = [
            places[axis] - sympy.Add(*(length * turn(angle) for length, angle in zip(lengths, (thigh, shank), strict=True)))
            for axis, turn in enumerate((sympy.cos, sympy.sin))
        ]
        found = settled(tape, (thigh, shank, foot, ankle_x), [(less(0, status), status)], [*hip, contact, *places])
        outputs = [HIP, PHASE, CONTACT, ANKLE, CONTACT_POINT, STATUS]
        return self._own.function(tape, "hung", [*self._found(roots), ANGLES, ANKLE_X], outputs, [*found[:2], phase, *found[2:]])

    def _found(self, roots: Sequence[FirstRoot]) -> list[Port]:
        return [port for root in roots for port in (root.root, root.status)]

    def _chosen(
        self, tape: Tape, roots: Sequence[FirstRoot], ankle_x: sympy.Expr
    ) -> tuple[sympy.Expr, sympy.Expr, list[sympy.Expr], sympy.Expr]:
        """Phase, contact, then foot's angle, ankle and contact point of the first curve that the foot rolls on, and a status."""
        phase: sympy.Expr = sympy.S.Zero
        first = self.curve(self._curves[0], symbols_of(roots[0].root)[0], tape)
        contact = first.bounds[0]
        values: list[sympy.Expr] = [DOWN, ankle_x, self._own.height, ankle_x, sympy.S.Zero]
        status: sympy.Expr = sympy.S.Zero
        for which, root in reversed(tuple(zip(self._curves, roots, strict=True))):
            (at,), (state,) = symbols_of(root.root), symbols_of(root.status)
            curve, edge = self.curve(which, at, tape), tape.let("edge", ankle_x + self._own.edge(which))
            rolls = both(Same(state, OK), less(curve.bounds[0], at))
            own = [curve.angle, *curve.ankle(edge), *curve.contact_point(edge)]
            phase = tape.let("phase", Select(rolls, AHEAD[which], phase))
            contact = tape.let("contact", Select(rolls, at, contact))
            values = [tape.let("chosen", Select(rolls, new, old)) for new, old in zip(own, values, strict=True)]
            status = state if status == 0 else tape.let("status", self._better(state, status))
        return phase, contact, values, status

    def _better(self, state: sympy.Expr, other: sympy.Expr) -> sympy.Expr:
        """OK if one is, else what is not merely out of reach."""
        worse = Select(Opposite(Same(state, UNREACHABLE)), state, other)
        return Select(Same(state, OK), OK, Select(Same(other, OK), OK, worse))

"""The inverse of a coupler curve without routines: steps of Gauss and Newton from a seed's drive."""

from dataclasses import replace
from functools import cached_property

import sympy

from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import BAD_INPUT, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import less
from walkgen.symbolic.curve import AIM, BOUNDS, Curve
from walkgen.symbolic.function import Angle, Finite, Function, LessEqual, Residue, Select, Solve, Step
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rows import TARGET, parameters_of
from walkgen.symbolic.tape import Tape, dot, symbols_of

_STATUS, _NEAR = Port("status", kind="integer"), Port("near", (1,))
_REPEATS, _STRIDE, _MET = 40, sympy.Rational(1, 32), sympy.Rational(1, 10**20)


class CurveSteps(Curve):
    """Of one leg."""

    def near(self, words: Signature) -> Solve:
        """The root that steps of Gauss and Newton come to from the seed's drive, for targets without routines."""
        given = parameters_of(self.mechanism)
        steps = (
            Step(self.aim, ("p", *given, "aim", "bounds")),
            Step(self._seeded, ("q_seed", "near")),
            Step(self._nearer, ("aim", "bounds", "near", *given, "near"), repeat=_REPEATS),
            Step(self._arrived, ("p", "aim", "near", *given, "q", "status")),
        )
        return Solve(words, (AIM, BOUNDS, _NEAR), steps)

    @cached_property
    def _seeded(self) -> Function:
        """The seed's drive."""
        seed = joint_port("q_seed", self.leg.joints)
        words = Signature(self.mechanism.name, self.leg.name, "curve_seeded", (seed,), (_NEAR,))
        return Tape().function(words, symbols_of(seed)[-1:])

    @cached_property
    def _nearer(self) -> Function:
        """A step of Gauss and Newton, at most a part of the bounds."""
        tape, (drive,), aim, (low, high) = Tape(), symbols_of(_NEAR), symbols_of(AIM), symbols_of(BOUNDS)
        at, along = self.profiled(drive, tape)
        gap = [here - there for here, there in zip(at, aim, strict=True)]
        square, most = tape.let("square", dot(along, along)), tape.let("most", (high - low) * _STRIDE)
        step = tape.let("step", Select(less(0, square), -dot(gap, along) / square, 0))
        bounded = Select(less(most, step), most, Select(less(step, -most), -most, step))
        words = signature(self.mechanism, self.leg.name, "curve_nearer", [AIM, BOUNDS, _NEAR], [replace(_NEAR, name="next")], "", "")
        return tape.function(words, [drive + bounded])

    @cached_property
    def _arrived(self) -> Function:
        """Joint values there, and whether the foot is on the target."""
        tape, (drive,), aim = Tape(), symbols_of(_NEAR), symbols_of(AIM)
        at = self.planar(drive, tape)
        seen, target = self.seen(tape.vector("foot", self.hung(at)), tape), self.target(tape)
        gap = [here - there for here, there in zip(seen, aim, strict=True)]
        size = tape.let("size", dot(seen, seen) + dot(aim, aim))
        values, free = self.carried(at, target, tape)
        turning = self.leg.joints[-1].kind == "revolute"
        own = tape.let("own", Angle(sympy.sin(drive), sympy.cos(drive)) if turning else drive)
        there = LessEqual(tape.let("missed", dot(gap, gap)), _MET * size)
        taint = tape.let("taint", sympy.Add(*(Residue(entry) for entry in symbols_of(TARGET))))
        reached = Select(there, Select(free, SINGULAR, OK) if free != sympy.false else OK, UNREACHABLE)
        outputs = [joint_port("q", self.leg.joints), _STATUS]
        words = signature(self.mechanism, self.leg.name, "curve_arrived", [TARGET, AIM, _NEAR], outputs, "", "")
        return tape.function(words, [*values, own, Select(Finite(taint), reached, BAD_INPUT)])

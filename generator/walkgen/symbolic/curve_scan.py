"""The rows of a coupler curve without a routine: samples, steps from those that are nearest, for targets that have no routines.

As walkgen_curve.h finds them: a root lies beside a sample that is no farther from the target than its neighbours and than the curve goes on
in two steps. Samples, and places that Gauss and Newton's steps have led to, are read off in binary digits, which have no slopes; the steps
from there have, those of the implicit function.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import BAD_INPUT, OK, UNREACHABLE
from walkgen.symbolic.choices import both, chosen, less, same
from walkgen.symbolic.curve import AIM, BOUNDS, Curve
from walkgen.symbolic.function import Finite, Function, Indicator, Less, LessEqual, Residue, Same, Select, Step
from walkgen.symbolic.ports import signature
from walkgen.symbolic.rows import parameters_of
from walkgen.symbolic.tape import Tape, dot, symbols_of

_SAMPLES, _PLACES, _STEPS, _HALVINGS, _DIGITS = 256, 12, 24, 60, 44
_FAR = sympy.Integer(10) ** 30
_MET, _SAME = sympy.Rational(1, 10**24), sympy.Rational(1, 10**9)
_LEAST = sympy.Rational(1, 10**4)
"""Of a sample's step: what is left for the last two steps."""
_HEAD = 8
"""Of a scan: index, how many places, size, least square and where, the last two squares and the speed between them."""


@dataclass(frozen=True)
class _Point:
    """Of the curve: squared distance from the aim, half its slope, squared speed, size of what it is of; far where there is none."""

    square: sympy.Expr
    slope: sympy.Expr
    speed: sympy.Expr
    size: sympy.Expr
    there: sympy.Basic


class CurveScan(Curve):
    """Of one leg."""

    @cached_property
    def locals(self) -> tuple[Port, ...]:
        """What the steps need besides aim, bounds, drives and states."""
        return (self._scan, *self._near, *self._settled, self._closest)

    def steps(self, slots: int) -> tuple[Step, ...]:
        """From aim and bounds to drives and states of so many rows."""
        given, common = parameters_of(self.mechanism), ("aim", "bounds")
        yielded = [
            Step(self._begin, (self._scan.name,)),
            Step(self._sample, (*common, self._scan.name, *given, self._scan.name), repeat=_SAMPLES + 2),
            Step(self._spread, (*common, self._scan.name, *(port.name for port in (*self._near, self._closest)))),
            Step(self._halve, (*common, self._closest.name, *given, self._closest.name), repeat=_HALVINGS),
        ]
        for near, settled in zip(self._near, self._settled, strict=True):
            yielded.append(Step(self._nearer, (*common, near.name, *given, near.name), repeat=_STEPS))
            yielded.append(Step(self._settle, (*common, self._scan.name, near.name, *given, settled.name)))
        names = (self._scan.name, *(port.name for port in self._settled), self._closest.name)
        return (*yielded, Step(self._gather(slots), ("aim", *names, "drives", "states")))

    # ---- ports

    @property
    def _scan(self) -> Port:
        return Port("scan", (_HEAD + _PLACES,))

    @property
    def _near(self) -> tuple[Port, ...]:
        """Of every place the last drive with a foot, the next to be tried, the sample."""
        return tuple(Port(f"near_{number}", (3,)) for number in range(1, _PLACES + 1))

    @property
    def _settled(self) -> tuple[Port, ...]:
        """Of every place the drive, and whether the curve meets the aim there."""
        return tuple(Port(f"settled_{number}", (2,)) for number in range(1, _PLACES + 1))

    @property
    def _closest(self) -> Port:
        """A bracket, the sample in it, the nearest drive so far and its square."""
        return Port("closest", (5,))

    # ---- kernels

    def _function(self, name: str, inputs: Sequence[Port], output: Port, tape: Tape, values: Sequence[sympy.Expr]) -> Function:
        words = signature(self.mechanism, self.leg.name, f"curve_{name}", inputs, [Port(f"{name}_out", output.shape)], "", "")
        return tape.function(words, values)

    def _words(self, name: str, inputs: tuple[Port, ...], outputs: tuple[Port, ...]) -> Signature:
        """Of what no runtime parameter has a part in."""
        return Signature(self.mechanism.name, self.leg.name, f"curve_{name}", inputs, outputs)

    def _at(self, drive: sympy.Expr, tape: Tape) -> _Point:
        at, along = self.profiled(tape.let("drive", drive), tape)
        gap = [here - there for here, there in zip(at, symbols_of(AIM), strict=True)]
        square, slope, speed = (
            tape.let(name, dot(*rows)) for name, rows in (("gap2", (gap, gap)), ("slope", (gap, along)), ("speed", (along, along)))
        )
        size = dot(at, at) + dot(symbols_of(AIM), symbols_of(AIM))
        return _Point(square, slope, speed, size, Finite(tape.let("all", square + slope + speed)))

    @property
    def _turning(self) -> bool:
        return self.leg.joints[-1].kind == "revolute"

    def _range(self) -> tuple[sympy.Expr, sympy.Expr]:
        """The first drive, and the step of the samples; a turning drive's begin where its values do, so that they are in order."""
        low, high = symbols_of(BOUNDS)
        return (-sympy.pi if self._turning else low), (high - low) / _SAMPLES

    def _placed(self, index: sympy.Expr) -> sympy.Expr:
        low, step = self._range()
        return low + (index + sympy.Rational(1, 2)) * step

    @cached_property
    def _begin(self) -> Function:
        values = [-1, 0, 0, _FAR, 0, _FAR, _FAR, 0, *([0] * _PLACES)]
        return Tape().function(self._words("begin", (), (self._scan,)), [sympy.Integer(value) for value in values])

    @cached_property
    def _sample(self) -> Function:
        """The next sample; whether the one before it is a place."""
        tape, state = Tape(), symbols_of(self._scan)
        index, count, size, least, where, before, last, speed = state[:_HEAD]
        here = self._at(self._placed(index), tape)
        inside = both(LessEqual(0, index), LessEqual(index, _SAMPLES - 1))
        there = here.there if self._turning else both(here.there, inside)
        square, own = tape.let("square", Select(there, here.square, _FAR)), tape.let("own", Select(there, here.speed, 0))
        most = tape.let("most", Select(Less(own, speed), speed, own))
        lowest = both(LessEqual(last, before), both(Less(last, square), LessEqual(last, 4 * self._range()[1] ** 2 * most)))
        place = tape.let("place", Indicator(both(lowest, both(LessEqual(1, index), LessEqual(index, _SAMPLES)))))
        places = [Select(both(Less(0, place), Same(count, number)), index - 1, entry) for number, entry in enumerate(state[_HEAD:])]
        nearer = both(Less(square, least), inside)
        values = [index + 1, count + place, Select(both(there, Less(size, here.size)), here.size, size)]
        values += [Select(nearer, square, least), Select(nearer, index, where), last, square, own]
        return self._function("sample", [AIM, BOUNDS, self._scan], self._scan, tape, [*values, *places])

    @cached_property
    def _spread(self) -> Function:
        """Where steps begin."""
        tape, state, (_, step) = Tape(), symbols_of(self._scan), self._range()
        count, where = state[1], state[4]
        values: list[sympy.Expr] = []
        for number, entry in enumerate(state[_HEAD:]):
            sample = tape.let("sample", self._placed(Select(Less(number, count), entry, where)))
            values += [sample, sample, sample]
        best = tape.let("best", self._placed(where))
        values += [best - step, best + step, best, best, _FAR]
        ports = [Port(f"{port.name}_out", port.shape) for port in (*self._near, self._closest)]
        return tape.function(self._words("spread", (AIM, BOUNDS, self._scan), tuple(ports)), values)

    @cached_property
    def _halve(self) -> Function:
        """Half of a bracket of the least distance; where the curve ends in it, the end."""
        tape, (low, high, sample, good, square) = Tape(), symbols_of(self._closest)
        middle = tape.let("middle", (low + high) / 2)
        here = self._at(middle, tape)
        bounded = sympy.true if self._turning else both(LessEqual(symbols_of(BOUNDS)[0], middle), LessEqual(middle, symbols_of(BOUNDS)[1]))
        there = here.there if bounded is sympy.true else both(here.there, bounded)
        beyond = tape.let("beyond", Select(there, Indicator(Less(0, here.slope)), Indicator(Less(sample, middle))))
        nearer = both(there, Less(here.square, square))
        values = [Select(Less(0, beyond), low, middle), Select(Less(0, beyond), middle, high), sample]
        values += [Select(nearer, middle, good), Select(nearer, here.square, square)]
        return self._function("halve", [AIM, BOUNDS, self._closest], self._closest, tape, values)

    @cached_property
    def _nearer(self) -> Function:
        """A step of Gauss and Newton from where there is a foot, half of the last one where there is none."""
        tape, (good, tried, sample), step = Tape(), symbols_of(self._near[0]), self._range()[1]
        here = self._at(tried, tape)
        newton = tape.let("newton", self._bounded(here, step, tape))
        values = [Select(here.there, tried, good), Select(here.there, tried + newton, (good + tried) / 2), sample]
        return self._function("nearer_place", [AIM, BOUNDS, self._near[0]], self._near[0], tape, values)

    @staticmethod
    def _bounded(here: _Point, most: sympy.Expr, tape: Tape) -> sympy.Expr:
        """Gauss and Newton's step, at most so long."""
        step = tape.let("step", Select(less(0, here.speed), -here.slope / here.speed, 0))
        return Select(Less(most, step), most, Select(Less(step, -most), -most, step))

    @cached_property
    def _settle(self) -> Function:
        """Read off in digits, then two steps more, which have slopes; whether the curve meets the aim."""
        tape, (good, _, sample), size = Tape(), symbols_of(self._near[0]), symbols_of(self._scan)[2]
        step = self._range()[1]
        drive = self._digits(good, sample - 2 * step, 4 * step, tape)
        for _ in range(2):
            drive = tape.let("drive", drive + self._bounded(self._at(drive, tape), _LEAST * step, tape))
        here = self._at(drive, tape)
        close = both(LessEqual(drive - sample, step), LessEqual(sample - drive, step))
        met = both(close, LessEqual(here.square, _MET * Select(Less(here.size, size), size, here.size)))
        inputs = [AIM, BOUNDS, self._scan, self._near[0]]
        return self._function("settle", inputs, self._settled[0], tape, [drive, Indicator(met)])

    @staticmethod
    def _digits(value: sympy.Expr, low: sympy.Expr, width: sympy.Expr, tape: Tape) -> sympy.Expr:
        """The value to 44 binary digits of the width: comparisons have no slopes."""
        rest, read = tape.let("rest", (value - low) / width), sympy.S.Zero
        for number in range(1, _DIGITS + 1):
            part = sympy.Rational(1, 2**number)
            digit = tape.let("digit", Indicator(LessEqual(part, rest)))
            rest, read = tape.let("rest", rest - part * digit), tape.let("read", read + part * digit)
        return low + width * read

    def _gather(self, slots: int) -> Function:
        """Rows in order of the drives, each once."""
        tape, state, aim = Tape(), symbols_of(self._scan), symbols_of(AIM)
        kept: sympy.Expr = sympy.S.Zero
        last: sympy.Expr = -_FAR
        rows: list[sympy.Expr] = [sympy.S.Zero] * slots
        for number, port in enumerate(self._settled):
            drive, met = symbols_of(port)
            fresh = both(Less(number, state[1]), both(Less(0, met), Less(_SAME, drive - last)))
            own = tape.let("own", Indicator(fresh))
            rows = [chosen(both(Less(0, own), same(kept, slot)), drive, row) for slot, row in enumerate(rows)]
            rows = [tape.let("row", row) for row in rows]
            last, kept = tape.let("last", Select(Less(0, own), drive, last)), tape.let("kept", kept + own)
        good, square = symbols_of(self._closest)[3:]
        nothing = tape.let("nothing", sympy.sqrt(-1 - good**2))
        closest = tape.let("closest", Select(Less(square, _FAR), good, nothing))
        taint = tape.let("taint", sympy.Add(*(Residue(entry) for entry in aim)))
        rest = tape.let("rest", Select(Less(0, kept), rows[0], closest))
        drives = [self._wrapped(Select(Less(slot, kept), row, rest)) + taint for slot, row in enumerate(rows)]
        states = [Select(Finite(taint), Select(Less(slot, kept), OK, UNREACHABLE), BAD_INPUT) for slot in range(slots)]
        ports = (Port("drives", (slots,)), Port("states", (slots,), kind="integer"))
        return tape.function(self._words("gather", (AIM, self._scan, *self._settled, self._closest), ports), [*drives, *states])

    def _wrapped(self, drive: sympy.Expr) -> sympy.Expr:
        """In (-pi, pi]."""
        return Select(Less(sympy.pi, drive), drive - 2 * sympy.pi, drive) if self._turning else drive

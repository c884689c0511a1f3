"""The first root of a function of one unknown as steps of a Solve: by the routine, and for targets without routines by repeated steps."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port
from walkgen.symbolic.branches import BAD_INPUT, OK, SINGULAR, UNREACHABLE
from walkgen.symbolic.choices import at_most, both, chosen, either, less
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Finite, Function, Less, LessEqual, Same, Select, Solve, Step
from walkgen.symbolic.ports import signature
from walkgen.symbolic.tangents import tangents_along
from walkgen.symbolic.tape import Tape, symbols_of

Residual = Callable[[Tape, sympy.Expr, Sequence[sympy.Expr]], tuple[sympy.Expr, sympy.Expr, sympy.Expr]]
"""On a tape, of the unknown and of what is given: value, slope, size."""
Bounds = Callable[[Tape], tuple[sympy.Expr, sympy.Expr]]
_REPEATS = 48
_NOTHING = sympy.Rational(1, 10**12)


def whole(function: Function) -> Step:
    """A function as a step whose arguments are called like its ports."""
    ports = (*function.signature.inputs, *function.signature.outputs)
    return Step(function, tuple(port.name for port in ports))


def nothing(anything: sympy.Expr) -> sympy.Expr:
    """NaN, as a value that programs can be compared by."""
    return sympy.sqrt(-1 - anything**2)


def _replayed(tape: Tape, function: Function) -> list[sympy.Expr]:
    """The function's outputs, on another tape."""
    known: dict[sympy.Basic, sympy.Basic] = {}
    for symbol, definition in function.intermediates:
        known[symbol] = tape.let(symbol.name, definition.xreplace(known))
    return [output.xreplace(known) for output in function.outputs]


@dataclass(frozen=True)
class FirstRoot:
    """An unknown of a leg, called `name`, between bounds that depend on runtime parameters alone, given some numbers [count]."""

    mechanism: Mechanism
    owner: str
    name: str
    count: int
    residual: Residual
    bounds: Bounds

    # ---- ports

    @property
    def given(self) -> Port:
        """What is given."""
        return Port(f"{self.name}_given", (self.count,))

    @property
    def ends(self) -> Port:
        """The bounds."""
        return Port(f"{self.name}_bounds", (2,))

    @property
    def root(self) -> Port:
        """What is found."""
        return Port(f"{self.name}_root")

    @property
    def status(self) -> Port:
        """Whether it was."""
        return Port(f"{self.name}_status", kind="integer")

    @property
    def _state(self) -> Port:
        """Unknown, bracket, sign at the start."""
        return Port(f"{self.name}_state", (4,))

    @property
    def locals(self) -> tuple[Port, ...]:
        """Of the steps by the routine."""
        return (self.given, self.ends, self.root, self.status)

    @property
    def repeated_locals(self) -> tuple[Port, ...]:
        """Of the repeated steps."""
        return (*self.locals, self._state)

    # ---- steps

    def steps(self) -> tuple[Step, ...]:
        """From `given` on, by the routine."""
        arguments = (self.count, self.given.name, self.ends.name, self.callback.signature.full_name, self.root.name, self.status.name)
        return (whole(self._bounded), Step("wg_first_root", arguments))

    def repeated(self) -> tuple[Step, ...]:
        """The same without a routine."""
        nearer = whole(self._nearer)
        again = replace(nearer, arguments=(*nearer.arguments[:-1], self._state.name), repeat=_REPEATS)
        return (whole(self._bounded), whole(self._begin), again, whole(self._finish))

    def slopes(self, start: Function) -> Step:
        """How the root moves with the runtime parameters where `start` gives what is given: -(df/dp) / (df/droot)."""
        tape, (root,), (status,) = Tape(), symbols_of(self.root), symbols_of(self.status)
        value, slope, _ = self.residual(tape, root, _replayed(tape, start))
        moves = []
        for name, symbol in parameter_symbols(self.mechanism).items():
            (moved,) = tangents_along(tape, [value], name, {symbol: sympy.S.One})
            moves.append(Select(Same(status, OK), -moved / slope, 0))
        inputs = [port for port in start.signature.inputs if port.name != "param"]
        port = Port(f"{self.root.name}_d_param", (len(moves),))
        words = signature(self.mechanism, self.owner, f"{start.signature.name}_moves", [*inputs, self.root, self.status], [port], "", "")
        return whole(tape.function(words, moves))

    @cached_property
    def callback(self) -> Solve:
        """The residual as the routine calls it: of a point, the unknown first."""
        tape, point = Tape(), Port("point", (self.count + 1,))
        unknown, *given = symbols_of(point)
        words = signature(self.mechanism, self.owner, f"{self.name}_residual_at", [point], [Port("residual", (3,))], "", "")
        function = tape.function(words, self.residual(tape, unknown, given))
        return Solve(replace(words, name=f"{self.name}_residual"), (), (whole(function),))

    @cached_property
    def _bounded(self) -> Function:
        tape = Tape()
        return self._function("ends", [], [self.ends], tape, self.bounds(tape))

    def _function(self, word: str, inputs: Sequence[Port], outputs: Sequence[Port], tape: Tape, found: Sequence[sympy.Expr]) -> Function:
        return tape.function(signature(self.mechanism, self.owner, f"{self.name}_{word}", inputs, outputs, "", ""), found)

    @cached_property
    def _begin(self) -> Function:
        tape, (low, high) = Tape(), symbols_of(self.ends)
        value, _, _ = self.residual(tape, low, symbols_of(self.given))
        sign = Select(Less(0, value), 1, -1)
        return self._function("begin", [self.given, self.ends], [self._state], tape, [low, low, high, sign])

    @cached_property
    def _nearer(self) -> Function:
        """A step of Newton's inside the bracket, or half of that."""
        tape, (low, high), (at, before, behind, sign) = Tape(), symbols_of(self.ends), symbols_of(self._state)
        value, slope, _ = self.residual(tape, at, symbols_of(self.given))
        here = both(less(0, sign * value), less(sign * slope, 0))
        before, behind = tape.let("before", chosen(here, at, before)), tape.let("behind", chosen(here, behind, at))
        newton = tape.let("newton", at - value / slope)
        slack = tape.let("slack", _NOTHING * (high - low))
        inside = both(at_most(before - slack, newton), at_most(newton, behind + slack))
        step = chosen(inside, newton, (before + behind) / 2)
        outputs = [Port(f"{self._state.name}_next", self._state.shape)]
        return self._function("nearer", [self.given, self.ends, self._state], outputs, tape, [step, before, behind, sign])

    @cached_property
    def _finish(self) -> Function:
        """Clamped to the bounds; NaN where there is no root."""
        tape, (low, high), (at, _, behind, sign) = Tape(), symbols_of(self.ends), symbols_of(self._state)
        given = symbols_of(self.given)
        value, slope, size = self.residual(tape, at, given)
        first, first_slope, first_size = self.residual(tape, low, given)
        began = LessEqual(abs(first), _NOTHING * first_size)
        met = both(at_most(abs(value), _NOTHING * size), less(sign * slope, 0))
        inside = both(at_most(low - _NOTHING * (high - low), at), at_most(at, high + _NOTHING * (high - low)))
        there = either(began, both(met, inside))
        missed = Select(both(less(sign * first_slope, 0), Less(behind, high)), SINGULAR, UNREACHABLE)
        status = tape.let("status", Select(Finite(first), Select(there, OK, missed), BAD_INPUT))
        clamped = chosen(began, low, Select(Less(at, low), low, Select(Less(high, at), high, at)))
        root = Select(LessEqual(status, 0), clamped, nothing(first))
        return self._function("finish", [self.given, self.ends, self._state], [self.root, self.status], tape, [root, status])

"""The way of a linkage with triads from its start without a routine: so many Newton steps, for targets that have none.

As walkgen_triads.h goes it: a part of the way further, two Newton steps there, the second at most half as long; what leads astray is tried
again with a quarter of the part. At the end of the way all steps are Newton's, so that the derivatives are those of the implicit function.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import BAD_INPUT, OK, UNREACHABLE
from walkgen.symbolic.choices import both, less
from walkgen.symbolic.closure import Closing
from walkgen.symbolic.closure_steps import determinants, newton_step
from walkgen.symbolic.function import Both, Either, Finite, Function, Indicator, Less, LessEqual, Opposite, Residue, Same, Select, Step
from walkgen.symbolic.tape import Tape, symbols_of

Exprs = Sequence[sympy.Expr]

_REPEATS = 256
"""A way without obstacles takes 128 of them."""
_PARTS = 64
_SHORT = sympy.Rational(1, 16)
"""Of a step, squared."""
_NOTHING = sympy.Rational(1, 10**20)
"""Of one that rounding leaves, squared."""
_TINY = sympy.Rational(1, 10**40)
_CLOSED = sympy.Rational(1, 10**24)
"""Of the residuals' squares."""
_LEAST, _MOST = sympy.Rational(2, 5), sympy.Rational(5, 2)
"""How much a determinant may change in a step, as in walkgen_triads.h."""


@dataclass(frozen=True)
class Way:
    """Of a linkage.

    Attributes:
        robot: its name.
        leg: its name.
        name: what kernels' names begin with.
        aim: where the way goes: all of a point but the unknowns.
        count: how many unknowns there are, two a triad.
        closing: the closure at what is given, for unknowns.
    """

    robot: str
    leg: str
    name: str
    aim: Port
    count: int
    closing: Callable[[Exprs, Sequence[sympy.Symbol], Tape], Closing]

    @property
    def start(self) -> Port:
        """A point where the linkage is assembled."""
        return Port("start", (self.aim.size + self.count,), self.aim.unit)

    @property
    def state(self) -> Port:
        """The way gone, the next part of it, the square of the first step of a part, 0 before it; the unknowns after the last part, and as
        they are tried; the determinants met last.
        """
        return Port("state", (3 + 2 * self.count + self.count // 2,))

    @property
    def gone(self) -> tuple[sympy.Symbol, tuple[sympy.Symbol, ...]]:
        """Of a state the way gone, and the unknowns there."""
        symbols = symbols_of(self.state)
        return symbols[0], symbols[3 : 3 + self.count]

    def at(self, part: sympy.Expr, tape: Tape) -> list[sympy.Expr]:
        """A part of the way from the start to the aim."""
        ends = zip(symbols_of(self.start)[: self.aim.size], symbols_of(self.aim), strict=True)
        return [tape.let("at", first + part * (last - first)) for first, last in ends]

    def steps(self, aim: str, start: str, state: str) -> tuple[Step, Step]:
        """From the start all the way to the aim, as far as it leads; ports by their names."""
        return Step(self.begin, (start, state)), Step(self.advance, (aim, start, state, state), repeat=_REPEATS)

    def verdict(self, found: Closing, tape: Tape) -> tuple[sympy.Basic, sympy.Expr, sympy.Expr]:
        """Whether the end of the way closes the linkage, by how much it does not (of residuals the squares), the status.

        Args:
            found: the closure at the aim, for the unknowns at the way's end.
            tape: where the intermediates go.
        """
        missed = tape.let("missed", sympy.Add(*(residual**2 for residual in found.residuals)))
        closes = both(less(missed, _CLOSED), LessEqual(1, self.gone[0]))
        taint = tape.let("taint", sympy.Add(*(Residue(symbol) for symbol in symbols_of(self.aim))))
        return closes, missed, Select(Finite(taint), Select(closes, OK, UNREACHABLE), BAD_INPUT)

    def words(self, name: str, inputs: tuple[Port, ...], outputs: tuple[Port, ...]) -> Signature:
        """Of a kernel."""
        return Signature(self.robot, self.leg, f"{self.name}_{name}", inputs, outputs, "", "")

    @cached_property
    def begin(self) -> Function:
        """start -> the state there."""
        tape, symbols = Tape(), symbols_of(self.start)
        unknowns = symbols[self.aim.size :]
        found = determinants(self.closing(symbols[: self.aim.size], unknowns, tape))
        values = [sympy.S.Zero, sympy.Rational(1, _PARTS), sympy.S.Zero, *unknowns, *unknowns, *found]
        return tape.function(self.words("begin", (self.start,), (self.state,)), values)

    @cached_property
    def advance(self) -> Function:
        """aim, start, state -> the next state: after the first or the second Newton step of a part, or back with a quarter of it."""
        tape, (gone, part, square, *rest) = Tape(), symbols_of(self.state)
        known, tried, before = rest[: self.count], rest[self.count : 2 * self.count], rest[2 * self.count :]
        ahead, longer, most = tape.let("ahead", gone + part), tape.let("longer", 2 * part), sympy.Rational(1, _PARTS)
        further = tape.let("further", Select(less(ahead, 1), ahead, 1))
        found = self.closing(self.at(further, tape), tried, tape)
        steps, now = newton_step(found), determinants(found)
        own, first = tape.let("own", sympy.Add(*(step**2 for step in steps))), Same(square, 0)
        fine: sympy.Basic = Either(Less(4 * own, square), Less(own, _NOTHING))
        for ratio in (tape.let("ratio", new / old) for new, old in zip(now, before, strict=True)):
            fine = Both(fine, Both(Less(_LEAST, ratio), Less(ratio, _MOST)))
        waits = Less(0, tape.let("waits", Indicator(Both(first, Less(own, _SHORT)))))
        taken = Less(0, tape.let("taken", Indicator(Both(Opposite(first), fine))))
        after = [tape.let("after", value + step) for value, step in zip(tried, steps, strict=True)]
        nexts = [
            Select(taken, further, gone),
            Select(taken, Select(Less(longer, most), longer, most), Select(waits, part, part / 4)),
            Select(waits, own + _TINY, 0),
            *(Select(taken, new, old) for new, old in zip(after, known, strict=True)),
            *(Select(Either(taken, waits), new, old) for new, old in zip(after, known, strict=True)),
            *(Select(taken, new, old) for new, old in zip(now, before, strict=True)),
        ]
        return tape.function(self.words("advance", (self.aim, self.start, self.state), (Port("next", self.state.shape),)), nexts)

"""The way of a held linkage from its start to a place of the foot without a routine: so many Newton steps, for targets that have none.

As walkgen_triads.h goes it: a part of the way further, two Newton steps there, the second at most half as long; what leads astray is tried
again with a quarter of the part. At the end of the way all steps are Newton's, so that the derivatives are those of the implicit function.
"""

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from functools import cache

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import BAD_INPUT, OK, UNREACHABLE
from walkgen.symbolic.choices import both, less
from walkgen.symbolic.closure_steps import determinants, newton_step
from walkgen.symbolic.function import Both, Either, Finite, Function, Indicator, Less, LessEqual, Opposite, Residue, Same, Select, Step
from walkgen.symbolic.held_closure import UNKNOWNS, held_closing_at, held_port
from walkgen.symbolic.tape import Tape, symbols_of

_REPEATS = 256
"""A way without obstacles takes 128 of them."""
STATE = Port("state", (4 + 2 * UNKNOWNS.size,))
"""The way gone, the next part of it, the determinant met last, the square of the first step of a part, 0 before it; the unknowns after the
last part, and as they are tried."""
_AIM, _START = "aim", "start"
_PARTS = 64
_SHORT = sympy.Rational(1, 16)
"""Of a step, squared."""
_NOTHING = sympy.Rational(1, 10**20)
"""Of one that rounding leaves, squared."""
_TINY = sympy.Rational(1, 10**40)
_LEAST, _MOST = sympy.Rational(2, 5), sympy.Rational(5, 2)
"""How much the determinant may change in a step, as in walkgen_triads.h."""
_CLOSED = sympy.Rational(1, 10**24)
"""Of the residuals' squares."""


def ports(mechanism: Mechanism, leg: Limb, number: int) -> tuple[Port, Port]:
    """Where a row starts from, and its state."""
    return replace(start_port(mechanism, leg), name=f"start_{number}"), replace(STATE, name=f"way_{number}")


def followed(mechanism: Mechanism, leg: Limb, number: int, point: Sequence[Decimal], names: Sequence[str]) -> tuple[Step, ...]:
    """The steps of a row.

    Args:
        mechanism: the robot.
        leg: one whose linkage has a triad once its foot is held.
        number: the row's.
        point: where it starts from.
        names: of the aim, then of what is reached, the unknowns there and the status.
    """
    (begins, way), (aim, *arrival) = ports(mechanism, leg, number), names
    start, state = begins.name, way.name
    words = Signature(mechanism.name, leg.name, f"held_start_{number}", (), (begins,))
    return (
        Step(Tape().function(words, [sympy.Rational(str(entry)) for entry in point]), (start,)),
        Step(begin(mechanism, leg), (start, state)),
        Step(advance(mechanism, leg), (aim, start, state, state), repeat=_REPEATS),
        Step(finish(mechanism, leg), (aim, start, state, *arrival)),
    )


def start_port(mechanism: Mechanism, leg: Limb) -> Port:
    """A point where the held linkage is assembled."""
    return Port(_START, (held_port(mechanism, leg).size + UNKNOWNS.size,), "rad, m or as declared")


@cache
def begin(mechanism: Mechanism, leg: Limb) -> Function:
    """start -> the state there."""
    port, tape = start_port(mechanism, leg), Tape()
    symbols = symbols_of(port)
    unknowns = symbols[-UNKNOWNS.size :]
    (determinant,) = determinants(held_closing_at(mechanism, leg, symbols[: -UNKNOWNS.size], unknowns, tape))
    words = Signature(mechanism.name, leg.name, "held_begin", (port,), (STATE,), "", "")
    return tape.function(words, [sympy.S.Zero, sympy.Rational(1, _PARTS), determinant, sympy.S.Zero, *unknowns, *unknowns])


@cache
def advance(mechanism: Mechanism, leg: Limb) -> Function:
    """aim, start, state -> the next state: after the first or the second Newton step of a part, or back with a quarter of it."""
    aim, port, tape = _aim(mechanism, leg), start_port(mechanism, leg), Tape()
    gone, part, before, square, *both_of_them = symbols_of(STATE)
    known, tried = both_of_them[: UNKNOWNS.size], both_of_them[UNKNOWNS.size :]
    ahead, longer = tape.let("ahead", gone + part), tape.let("longer", 2 * part)
    further = tape.let("further", Select(less(ahead, 1), ahead, 1))
    found = held_closing_at(mechanism, leg, _on_the_way(mechanism, leg, further, tape), tried, tape)
    steps, (determinant,) = newton_step(found), determinants(found)
    own, ratio = tape.let("own", sympy.Add(*(step**2 for step in steps))), tape.let("ratio", determinant / before)
    shrinks, calm = Either(Less(4 * own, square), Less(own, _NOTHING)), Both(Less(_LEAST, ratio), Less(ratio, _MOST))
    first, after = Same(square, 0), [tape.let("after", value + step) for value, step in zip(tried, steps, strict=True)]
    waits = tape.let("waits", Indicator(Both(first, Less(own, _SHORT))))
    taken = tape.let("taken", Indicator(Both(Opposite(first), Both(shrinks, calm))))
    there, further_on = Less(0, taken), Less(0, waits)
    most = sympy.Rational(1, _PARTS)
    nexts = [
        Select(there, further, gone),
        Select(there, Select(Less(longer, most), longer, most), Select(further_on, part, part / 4)),
        Select(there, determinant, before),
        Select(further_on, own + _TINY, 0),
        *(Select(there, value, old) for value, old in zip(after, known, strict=True)),
        *(Select(Less(0, taken + waits), value, old) for value, old in zip(after, known, strict=True)),
    ]
    words = Signature(mechanism.name, leg.name, "held_advance", (aim, port, STATE), (Port("next", STATE.shape),), "", "")
    return tape.function(words, nexts)


def _on_the_way(mechanism: Mechanism, leg: Limb, part: sympy.Expr, tape: Tape) -> list[sympy.Expr]:
    """A part of the way from the start to the aim."""
    begins, aims = symbols_of(start_port(mechanism, leg))[: -UNKNOWNS.size], symbols_of(_aim(mechanism, leg))
    return [tape.let("at", first + part * (last - first)) for first, last in zip(begins, aims, strict=True)]


@cache
def finish(mechanism: Mechanism, leg: Limb) -> Function:
    """aim, start, state -> where the foot gets to, the unknowns there, the status: OK or UNREACHABLE."""
    aim, port, tape = _aim(mechanism, leg), start_port(mechanism, leg), Tape()
    gone, *_ = symbols_of(STATE)
    unknowns = symbols_of(STATE)[4 : 4 + UNKNOWNS.size]
    wanted, whole = symbols_of(aim), LessEqual(1, gone)
    reached = [
        tape.let("reached", Select(whole, last, there)) for there, last in zip(_on_the_way(mechanism, leg, gone, tape), wanted, strict=True)
    ]
    found = held_closing_at(mechanism, leg, reached, unknowns, tape)
    missed = tape.let("missed", sympy.Add(*(residual**2 for residual in found.residuals)))
    taint = tape.let("taint", sympy.Add(*(Residue(symbol) for symbol in wanted)))
    status = Select(Finite(taint), Select(both(whole, less(missed, _CLOSED)), OK, UNREACHABLE), BAD_INPUT)
    outputs = (Port("reached", aim.shape), UNKNOWNS, Port("status", kind="integer"))
    words = Signature(mechanism.name, leg.name, "held_finish", (aim, port, STATE), outputs, "", "")
    return tape.function(words, [*reached, *unknowns, status])


def _aim(mechanism: Mechanism, leg: Limb) -> Port:
    return Port(_AIM, held_port(mechanism, leg).shape, "m or as declared")

"""The way of a held linkage from its start to a place of the foot without a routine, for targets that have none."""

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from functools import cache, partial

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.branches import BAD_INPUT, OK, UNREACHABLE
from walkgen.symbolic.choices import both, less
from walkgen.symbolic.function import Finite, Function, LessEqual, Residue, Select, Step
from walkgen.symbolic.held_closure import UNKNOWNS, held_closing_at, held_port
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.way_steps import REPEATS, Way

_CLOSED = sympy.Rational(1, 10**24)
"""Of the residuals' squares."""


def ports(mechanism: Mechanism, leg: Limb, number: int) -> tuple[Port, Port]:
    """Where a row starts from, and its state."""
    way = _way(mechanism, leg)
    return replace(way.start, name=f"start_{number}"), replace(way.state, name=f"way_{number}")


def followed(mechanism: Mechanism, leg: Limb, number: int, point: Sequence[Decimal], names: Sequence[str]) -> tuple[Step, ...]:
    """The steps of a row.

    Args:
        mechanism: the robot.
        leg: one whose linkage has a triad once its foot is held.
        number: the row's.
        point: where it starts from.
        names: of the aim, then of what is reached, the unknowns there and the status.
    """
    (begins, state), (aim, *arrival) = ports(mechanism, leg, number), names
    words = _way(mechanism, leg).words(f"start_{number}", (), (begins,))
    return (
        Step(Tape().function(words, [sympy.Rational(str(entry)) for entry in point]), (begins.name,)),
        Step(_begin(mechanism, leg), (begins.name, state.name)),
        Step(_advance(mechanism, leg), (aim, begins.name, state.name, state.name), repeat=REPEATS),
        Step(_finish(mechanism, leg), (aim, begins.name, state.name, *arrival)),
    )


@cache
def _way(mechanism: Mechanism, leg: Limb) -> Way:
    aim = Port("aim", held_port(mechanism, leg).shape, "m or as declared")
    return Way(mechanism.name, leg.name, "held", aim, UNKNOWNS.size, partial(held_closing_at, mechanism, leg))


@cache
def _begin(mechanism: Mechanism, leg: Limb) -> Function:
    return _way(mechanism, leg).begin()


@cache
def _advance(mechanism: Mechanism, leg: Limb) -> Function:
    return _way(mechanism, leg).advance()


@cache
def _finish(mechanism: Mechanism, leg: Limb) -> Function:
    """aim, start, state -> where the foot gets to, the unknowns there, the status: OK or UNREACHABLE."""
    way, tape = _way(mechanism, leg), Tape()
    (gone, unknowns), wanted = way.gone, symbols_of(way.aim)
    whole = LessEqual(1, gone)
    reached = [tape.let("reached", Select(whole, last, there)) for there, last in zip(way.at(gone, tape), wanted, strict=True)]
    found = held_closing_at(mechanism, leg, reached, unknowns, tape)
    missed = tape.let("missed", sympy.Add(*(residual**2 for residual in found.residuals)))
    taint = tape.let("taint", sympy.Add(*(Residue(symbol) for symbol in wanted)))
    status = Select(Finite(taint), Select(both(whole, less(missed, _CLOSED)), OK, UNREACHABLE), BAD_INPUT)
    outputs = (Port("reached", way.aim.shape), UNKNOWNS, Port("status", kind="integer"))
    return tape.function(way.words("finish", (way.aim, way.start, way.state), outputs), [*reached, *unknowns, status])

"""The way of a held linkage from its start to a place of the foot without a routine, for targets that have none."""

from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from functools import cache, partial

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.function import Function, LessEqual, Select, Step
from walkgen.symbolic.held_closure import UNKNOWNS, held_closing_at, held_port
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.way_steps import Way


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
        *_way(mechanism, leg).steps(aim, begins.name, state.name),
        Step(_finish(mechanism, leg), (aim, begins.name, state.name, *arrival)),
    )


@cache
def _way(mechanism: Mechanism, leg: Limb) -> Way:
    aim = Port("aim", held_port(mechanism, leg).shape, "m or as declared")
    return Way(mechanism.name, leg.name, "held", aim, UNKNOWNS.size, partial(held_closing_at, mechanism, leg))


@cache
def _finish(mechanism: Mechanism, leg: Limb) -> Function:
    """aim, start, state -> where the foot gets to, the unknowns there, the status: OK or UNREACHABLE."""
    way, tape = _way(mechanism, leg), Tape()
    (gone, unknowns), wanted = way.gone, symbols_of(way.aim)
    reached = [tape.let("reached", Select(LessEqual(1, gone), last, there)) for there, last in zip(way.at(gone, tape), wanted, strict=True)]
    found = held_closing_at(mechanism, leg, reached, unknowns, tape)
    *_, status = way.verdict(found, tape)
    outputs = (Port("reached", way.aim.shape), UNKNOWNS, Port("status", kind="integer"))
    return tape.function(way.words("finish", (way.aim, way.start, way.state), outputs), [*reached, *unknowns, status])

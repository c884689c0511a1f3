"""The closure of a linkage's triads for its drives without a routine, for targets that have none."""

from functools import cache, partial

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.closure import assembled_port, closing_at, point_port, unknowns_port
from walkgen.symbolic.function import Function, Select, Step
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.way_steps import Way


def way_ports(mechanism: Mechanism, leg: Limb) -> tuple[Port, Port]:
    """Where the leg starts from, and its state."""
    way = _way(mechanism, leg)
    return Port(f"{leg.name}_start", way.start.shape, way.start.unit), Port(f"{leg.name}_state", way.state.shape)


def closed_by_steps(mechanism: Mechanism, leg: Limb, given: str) -> tuple[Step, ...]:
    """From drives and parameters, a port of that name, to the unknowns, NaN unless they close the linkage in the start's assembly."""
    begins, state = (port.name for port in way_ports(mechanism, leg))
    return (
        Step(_started(mechanism, leg), (begins,)),
        *_way(mechanism, leg).steps(given, begins, state),
        Step(_finish(mechanism, leg), (given, state, unknowns_port(leg).name, assembled_port(leg).name)),
    )


@cache
def _way(mechanism: Mechanism, leg: Limb) -> Way:
    count = unknowns_port(leg).size
    given = Port("given", (point_port(mechanism, leg).size - count,), "rad, m or as declared")
    return Way(mechanism.name, leg.name, "closure", given, count, partial(closing_at, mechanism, leg))


def _started(mechanism: Mechanism, leg: Limb) -> Function:
    start, way = found_start(mechanism, leg), _way(mechanism, leg)
    point = (*start.drives, *start.parameters, *start.unknowns)
    return Tape().function(way.words("start", (), (way.start,)), [sympy.Rational(str(entry)) for entry in point])


@cache
def _finish(mechanism: Mechanism, leg: Limb) -> Function:
    """given, state -> the unknowns and the status."""
    way, tape = _way(mechanism, leg), Tape()
    _, unknowns = way.gone
    found = closing_at(mechanism, leg, symbols_of(way.aim), unknowns, tape)
    closes, missed, status = way.verdict(found, tape)
    nothing = tape.let("nothing", sympy.sqrt(-1 - missed**2))  # NaN
    words = way.words("finish", (way.aim, way.state), (unknowns_port(leg), assembled_port(leg)))
    return tape.function(words, [*(Select(closes, unknown, nothing) for unknown in unknowns), status])

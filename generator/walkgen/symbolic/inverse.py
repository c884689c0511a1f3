"""The closed-form inverse of yaw-pitch-pitch legs: four branches at once, or one by its index (theory 3.2, Fig. 7 leg)."""

from dataclasses import replace

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import Branches
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function, Solve, Step
from walkgen.symbolic.geometry import geometry
from walkgen.symbolic.ports import parameter_ports, signature
from walkgen.symbolic.tape import Tape, symbols_of

_TARGET = Port("p", (3,), "m")
_CANONICAL = Port("target", (3,), "m")
_GEOMETRY = Port("geometry", (10,), "m and rad")
_SOURCE = "theory of the Fig. 7 leg: rho, theta_1, theta_3, theta_2 in closed form"


def inverse(mechanism: Mechanism, leg: Limb) -> Solve:
    """All four branches (rho, knee) = (+,+), (+,-), (-,+), (-,-), with a status each; the closest point off the fast path."""
    words = signature(
        mechanism,
        leg.name,
        "inverse",
        [_TARGET],
        [Port("q", (4, 3), "rad"), Port("status", (4,), kind="integer")],
        "All joint values that reach p, a row a branch; unreachable rows hold the closest configuration.",
        _SOURCE,
    )
    branches = Branches(mechanism, leg, symbols_of(_TARGET))
    rows = branches.all_rows()
    values = [value for row, _ in rows for value in row]
    statuses = [status for _, status in rows]
    fast = branches.tape.function(_kernel(words, "inverse_branches"), [*values, *statuses, *branches.target])
    closed = branches.tape.function(words, [*values, *statuses])
    return _refined(mechanism, leg, words, fast, "wg_closest_yaw_pitch_pitch", closed)


def inverse_branch(mechanism: Mechanism, leg: Limb) -> Solve:
    """One branch by its index 0..3; another index is BAD_INPUT."""
    index = Port("branch", kind="integer")
    words = signature(
        mechanism,
        leg.name,
        "inverse_branch",
        [_TARGET, index],
        [Port("q", (3,), "rad"), Port("status", kind="integer")],
        "The joint values of one branch that reach p.",
        _SOURCE,
    )
    branches = Branches(mechanism, leg, symbols_of(_TARGET), symbols_of(index)[0])
    row, status = branches.one_row()
    fast = branches.tape.function(_kernel(words, "inverse_one"), [*row, status, *branches.target])
    closed = branches.tape.function(words, [*row, status])
    return _refined(mechanism, leg, words, fast, "wg_closest_yaw_pitch_pitch_branch", closed)


def _kernel(words: Signature, name: str) -> Signature:
    """The same map as a static kernel that also gives the canonical target."""
    return replace(words, name=name, outputs=(*words.outputs, _CANONICAL))


def _refined(mechanism: Mechanism, leg: Limb, words: Signature, fast: Function, routine: str, closed: Function) -> Solve:
    """The fast branches, then the closest point where a row is unreachable."""
    parameters = tuple(port.name for port in parameter_ports(mechanism))
    inputs = tuple(port.name for port in words.inputs)
    selector = inputs[1 : len(inputs) - len(parameters)]
    count = max(1, words.outputs[1].size) if words.outputs[1].shape else 1
    guard = ("wg_any_unreachable", ("status", count))
    return Solve(
        words,
        (_CANONICAL, _GEOMETRY),
        (
            Step(fast, (*inputs, "q", "status", "target")),
            Step(_geometry_function(mechanism, leg), (*parameters, "geometry"), guard),
            Step(routine, ("geometry", "target", *selector, "q", "status"), guard),
        ),
        closed,
    )


def _geometry_function(mechanism: Mechanism, leg: Limb) -> Function:
    tape = Tape()
    numbers = geometry(leg, parameter_symbols(mechanism), tape).numbers()
    words = signature(mechanism, leg.name, "inverse_geometry", [], [_GEOMETRY], "Canonical lengths and angle zeros.", _SOURCE)
    return tape.function(words, numbers)

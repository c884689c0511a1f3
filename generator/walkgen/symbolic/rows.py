"""What fills the rows of all inverse branches of a leg, with support routines and without: the part that many functions begin with."""

from dataclasses import dataclass, replace
from functools import cache

from walkgen.model.classify import FLAT_SOLE, YAW_PITCH_PITCH, InverseClass, inverse_class
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import Branches
from walkgen.symbolic.flat_inverse import FLAT_SOURCE, flat_branches
from walkgen.symbolic.forward import Route
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function, Solve, Step
from walkgen.symbolic.general import general_rows
from walkgen.symbolic.geometry import geometry
from walkgen.symbolic.ports import joint_unit, parameter_ports, signature
from walkgen.symbolic.screws import geometry_port, geometry_step, screws, sequence_of
from walkgen.symbolic.tape import Tape, symbols_of

TARGET = Port("p", (3,), "m")
CANONICAL = Port("target", (3,), "m")
NUMBERS = Port("geometry", (10,), "m and rad")
YAW_SOURCE = "theory of the Fig. 7 leg: rho, theta_1, theta_3, theta_2 in closed form"
GENERAL_SOURCE = "Pieper 1968: the joints' equations eliminated to one polynomial of degree at most 4"


@dataclass(frozen=True)
class Rows:
    """What computes all branches: `steps` with support routines, `closed` without; the first two of `ports` are the results."""

    ports: tuple[Port, ...]
    steps: tuple[Step, ...]
    closed: tuple[Step, ...]

    def closed_form(self, words: Signature, *then: Step) -> Solve:
        """The closed steps and what follows on them."""
        return Solve(words, self.ports[:2] if then else (), (*self.closed, *then))


def branch_rows(mechanism: Mechanism, leg: Limb, rows: str = "rows", states: str = "states") -> Rows:
    """What fills `rows` [b,n] and `states` [b] from the target `p`."""
    found = inverse_class(mechanism, leg)
    results = row_ports(leg, found, rows, states)
    if found.name == YAW_PITCH_PITCH:
        return _yaw_rows(mechanism, leg, results)
    if found.name == FLAT_SOLE:
        flat = flat_branches(mechanism, leg, TARGET, row_ports(leg, found, "q", "status"))
        step = Step(flat, ("p", *parameters_of(mechanism), rows, states))
        return Rows(results, (step,), (step,))
    steps = (
        geometry_step(mechanism, Route(leg.name, (leg,))),
        Step("wg_inverse_general", ("geometry", "p", sequence_of(leg.joints), rows, states)),
    )
    closed = Step(_general_closed(mechanism, leg, found), ("p", *parameters_of(mechanism), rows, states))
    return Rows((*results, geometry_port(leg.joints)), steps, (closed,))


def row_ports(leg: Limb, found: InverseClass, rows: str, states: str) -> tuple[Port, Port]:
    """q [b,n] and status [b] of all branches, under these names."""
    count = len(found.branch_names)
    return Port(rows, (count, len(leg.joints)), joint_unit(leg.joints)), Port(states, (count,), kind="integer")


def source_of(found: InverseClass) -> str:
    """Where the class's solution comes from."""
    return {YAW_PITCH_PITCH: YAW_SOURCE, FLAT_SOLE: FLAT_SOURCE}.get(found.name, GENERAL_SOURCE)


def parameters_of(mechanism: Mechanism) -> tuple[str, ...]:
    """`param`, where the robot has runtime parameters."""
    return tuple(port.name for port in parameter_ports(mechanism))


def _yaw_rows(mechanism: Mechanism, leg: Limb, results: tuple[Port, Port]) -> Rows:
    """The fast branches, then the closest point where a row is unreachable."""
    rows, states = results
    fast, closed = _yaw_kernels(mechanism, leg)
    inputs = ("p", *parameters_of(mechanism))
    steps = (
        Step(fast, (*inputs, rows.name, states.name, "target")),
        *closest(mechanism, leg, "wg_closest_yaw_pitch_pitch", (rows.name, states.name), states.size),
    )
    return Rows((*results, CANONICAL, NUMBERS), steps, (Step(closed, (*inputs, rows.name, states.name)),))


@cache
def _yaw_kernels(mechanism: Mechanism, leg: Limb) -> tuple[Function, Function]:
    """All rows, with the canonical target and without it."""
    branches = Branches(mechanism, leg, symbols_of(TARGET))
    found = branches.all_rows()
    values = [*(value for row, _ in found for value in row), *(status for _, status in found)]
    outputs = row_ports(leg, inverse_class(mechanism, leg), "q", "status")
    words = signature(mechanism, leg.name, "inverse_branches", [TARGET], [*outputs, CANONICAL], "", YAW_SOURCE)
    fast = branches.tape.function(words, [*values, *branches.target])
    return fast, branches.tape.function(replace(words, name="inverse_closed", outputs=outputs), values)


def closest(mechanism: Mechanism, leg: Limb, routine: str, arguments: tuple[str, ...], count: int) -> tuple[Step, Step]:
    """The closest point, off the fast path."""
    guard = ("wg_any_unreachable", (arguments[-1], count))
    numbers = Step(_geometry_function(mechanism, leg), (*parameters_of(mechanism), "geometry"), guard)
    return numbers, Step(routine, ("geometry", "target", *arguments), guard)


def _geometry_function(mechanism: Mechanism, leg: Limb) -> Function:
    tape = Tape()
    numbers = geometry(leg, parameter_symbols(mechanism), tape).numbers()
    words = signature(mechanism, leg.name, "inverse_geometry", [], [NUMBERS], "Canonical lengths and angle zeros.", YAW_SOURCE)
    return tape.function(words, numbers)


@cache
def _general_closed(mechanism: Mechanism, leg: Limb, found: InverseClass) -> Function:
    """The elimination as straight-line code."""
    tape = Tape()
    path = screws((leg,), parameter_symbols(mechanism), tape)
    numbers = [number for screw in path.joints for number in screw.numbers]
    x, y, z = symbols_of(TARGET)
    rows = general_rows([*numbers, *path.tip.origin], (x, y, z), sequence_of(leg.joints), tape)
    words = signature(mechanism, leg.name, "inverse_closed", [TARGET], row_ports(leg, found, "q", "status"), "", GENERAL_SOURCE)
    return tape.function(words, [*(value for row, _ in rows for value in row), *(status for _, status in rows)])

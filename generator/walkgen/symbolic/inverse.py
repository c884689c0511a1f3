"""The position inverse of a leg of one to three joints: all branches, or one by its index."""

from dataclasses import replace

from walkgen.model.classify import FLAT_SOLE, YAW_PITCH_PITCH, inverse_class
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import Branches
from walkgen.symbolic.forward import Route
from walkgen.symbolic.function import Solve, Step
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rows import CANONICAL, NUMBERS, TARGET, branch_rows, closest, row_ports, source_of
from walkgen.symbolic.screws import geometry_port, geometry_step, sequence_of
from walkgen.symbolic.selection import ONE_BRANCH, by_index
from walkgen.symbolic.tape import symbols_of

STATUS = Port("status", kind="integer")


def inverse(mechanism: Mechanism, leg: Limb) -> Solve:
    """All branches in their fixed order, with a status each; unreachable rows hold the closest configuration."""
    found = inverse_class(mechanism, leg)
    doc = "All joint values that reach p, a row a branch; unreachable rows hold the closest configuration."
    words = signature(mechanism, leg.name, "inverse", [TARGET], row_ports(leg, found, "q", "status"), doc, source_of(found))
    rows = branch_rows(mechanism, leg, "q", "status")
    return Solve(words, rows.ports[2:], rows.steps, rows.closed_form(words))


def inverse_branch(mechanism: Mechanism, leg: Limb) -> Solve:
    """One branch by its index; another index is BAD_INPUT."""
    index = Port("branch", kind="integer")
    found = inverse_class(mechanism, leg)
    words = signature(
        mechanism, leg.name, "inverse_branch", [TARGET, index], [joint_port("q", leg.joints), STATUS], ONE_BRANCH, source_of(found)
    )
    if found.name == YAW_PITCH_PITCH:
        return _one_branch(mechanism, leg, words, index)
    if found.name == FLAT_SOLE:
        rows = branch_rows(mechanism, leg)
        chosen = Step(by_index(mechanism, leg, len(found.branch_names)), ("rows", "states", "branch", "q", "status"))
        return Solve(words, rows.ports, (*rows.steps, chosen), rows.closed_form(words, chosen))
    arguments = ("geometry", "p", sequence_of(leg.joints), "branch", "q", "status")
    steps = (geometry_step(mechanism, Route(leg.name, (leg,))), Step("wg_inverse_general_branch", arguments))
    rows = branch_rows(mechanism, leg)
    chosen = Step(by_index(mechanism, leg, len(found.branch_names)), ("rows", "states", "branch", "q", "status"))
    return Solve(words, (geometry_port(leg.joints),), steps, rows.closed_form(words, chosen))


def _one_branch(mechanism: Mechanism, leg: Limb, words: Signature, index: Port) -> Solve:
    branches = Branches(mechanism, leg, symbols_of(TARGET), symbols_of(index)[0])
    row, status = branches.one_row()
    kernel = replace(words, name="inverse_one", outputs=(*words.outputs, CANONICAL))
    fast = branches.tape.function(kernel, [*row, status, *branches.target])
    inputs = tuple(port.name for port in words.inputs)
    steps = (
        Step(fast, (*inputs, "q", "status", "target")),
        *closest(mechanism, leg, "wg_closest_yaw_pitch_pitch_branch", ("branch", "q", "status"), 1),
    )
    return Solve(words, (CANONICAL, NUMBERS), steps, branches.tape.function(words, [*row, status]))

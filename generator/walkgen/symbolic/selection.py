"""One row chosen among those of all branches, as straight-line code for targets that have no support routines."""

from collections.abc import Sequence
from dataclasses import dataclass

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import STATUSES, Port, Signature
from walkgen.symbolic.function import (
    Angle,
    Both,
    Either,
    Finite,
    Function,
    Indicator,
    Less,
    LessEqual,
    Residue,
    Same,
    Select,
)
from walkgen.symbolic.ports import joint_port, joint_unit
from walkgen.symbolic.tape import Tape, symbols_of

_STATUS = Port("status", kind="integer")
_OK, _UNREACHABLE, _BAD_INPUT, _DUPLICATE, _INFEASIBLE = (
    sympy.Integer(STATUSES.index(name)) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "DUPLICATE", "INFEASIBLE")
)

ONE_BRANCH = "The joint values of one branch that reach p."
NEAREST_BRANCH = "The joint values that reach p and are nearest to q_seed (sum of squares, turns taken off); no branch has to be chosen."
"""What functions that choose a row say of themselves."""

Row = tuple[Sequence[sympy.Expr], sympy.Expr]
"""Joint values and a status."""


def by_index(mechanism: Mechanism, leg: Limb, slots: int) -> Function:
    """rows [b,n], states [b], branch -> the row and its status; another index is BAD_INPUT with NaN."""
    index = Port("branch", kind="integer")
    branch = symbols_of(index)[0]
    tape = Tape()
    known = Both(LessEqual(0, branch), Less(branch, slots))
    stray = tape.let("stray", Select(known, 0, sympy.sqrt(-1 - branch**2)))  # NaN for an unknown branch
    (values, status), *others = _rows(leg.joints, slots)
    for number, (row, state) in enumerate(others, start=1):
        here = Same(branch, number)
        values = [tape.let("chosen", Select(here, mine, other)) for mine, other in zip(row, values, strict=True)]
        status = tape.let("state", Select(here, state, status))
    outputs = [*(value + stray for value in values), Select(known, status, _BAD_INPUT)]
    return tape.function(_words(mechanism, leg, slots, "row_by_index", index), outputs)


def nearest(mechanism: Mechanism, leg: Limb, slots: int) -> Function:
    """rows [b,n], states [b], q_seed [n] -> the row nearest to the seed among those that reach, else among the others."""
    port = joint_port("q_seed", leg.joints)
    seed = symbols_of(port)
    tape = Tape()
    candidates = [_candidate(row, seed, leg.joints, tape, leg.linkage is not None) for row in _rows(leg.joints, slots)]
    best = candidates[0]
    for other in candidates[1:]:
        best = _better(best, other, tape)
    taint = tape.let("taint", sympy.Add(*(Residue(value) for value in seed)))
    reached = Select(Same(best.state, _DUPLICATE), _OK, best.state)
    outputs = [*(value + taint for value in best.values), Select(Finite(taint), reached, _BAD_INPUT)]
    return tape.function(_words(mechanism, leg, slots, "row_nearest", port), outputs)


@dataclass(frozen=True)
class _Candidate:
    """A row, whether it misses the target (1 or 0), and its squared distance from the seed."""

    values: Sequence[sympy.Expr]
    state: sympy.Expr
    misses: sympy.Expr
    apart: sympy.Expr


def _candidate(row: Row, seed: Sequence[sympy.Expr], joints: Sequence[Joint], tape: Tape, assembled: bool) -> _Candidate:
    values, state = row
    missed = Either(Same(state, _UNREACHABLE), Same(state, _BAD_INPUT))
    missed = Either(missed, Same(state, _INFEASIBLE)) if assembled else missed
    misses = tape.let("misses", Indicator(missed))
    apart = sympy.Add(*(_difference(*pair) ** 2 for pair in zip(values, seed, joints, strict=True)))
    return _Candidate(values, state, misses, tape.let("apart", apart))


def _difference(value: sympy.Expr, seed: sympy.Expr, joint: Joint) -> sympy.Expr:
    """Modulo full turns where the joint turns."""
    change = value - seed
    return change if joint.kind == "prismatic" else Angle(sympy.sin(change), sympy.cos(change))


def _better(best: _Candidate, other: _Candidate, tape: Tape) -> _Candidate:
    """The other where it misses less, or as much and is nearer."""
    nearer = Both(Same(other.misses, best.misses), Less(other.apart, best.apart))
    wins = tape.let("wins", Indicator(Either(Less(other.misses, best.misses), nearer)))
    chosen = Less(0, wins)
    values = [tape.let("nearest", Select(chosen, mine, old)) for mine, old in zip(other.values, best.values, strict=True)]
    state, misses, apart = (
        tape.let(name, Select(chosen, getattr(other, name), getattr(best, name))) for name in ("state", "misses", "apart")
    )
    return _Candidate(values, state, misses, apart)


def _rows(joints: Sequence[Joint], slots: int) -> list[Row]:
    """The symbols of all rows."""
    rows, states = (symbols_of(port) for port in _row_ports(joints, slots))
    count = len(joints)
    return [(rows[number * count : (number + 1) * count], states[number]) for number in range(slots)]


def _row_ports(joints: Sequence[Joint], slots: int) -> tuple[Port, Port]:
    return Port("rows", (slots, len(joints)), joint_unit(joints)), Port("states", (slots,), kind="integer")


def _words(mechanism: Mechanism, leg: Limb, slots: int, name: str, port: Port) -> Signature:
    """The same kernel serves all legs of these joints."""
    kinds = "".join(joint.kind[0] for joint in leg.joints) + ("_linkage" if leg.linkage else "")
    inputs = (*_row_ports(leg.joints, slots), port)
    return Signature(mechanism.name, "", f"{name}_{slots}_{kinds}", inputs, (joint_port("q", leg.joints), _STATUS))

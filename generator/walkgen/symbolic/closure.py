"""What closes a linkage's triads: their residuals at a point, which is the drives, the parameters that matter, and the unknowns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import sympy

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.spec.scalar import Scalar, names
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.tangents import partial_tangents
from walkgen.symbolic.tape import Tape, symbols_of

Exprs = Sequence[sympy.Expr]


def unknowns_port(leg: Limb) -> Port:
    """Two of every triad."""
    assert leg.linkage is not None
    return Port(f"{leg.name}_unknowns", (2 * len(leg.linkage.forward.triads),), "rad or sizes")


def assembled_port(leg: Limb) -> Port:
    """Whether they were found."""
    return Port(f"{leg.name}_assembled", kind="integer")


def drive_count(leg: Limb) -> int:
    """How many q the leg's linkage has."""
    assert leg.linkage is not None
    return leg.linkage.drive_count


def forward_placing(leg: Limb, drives: Exprs, parameters: Mapping[str, sympy.Expr], tape: Tape, unknowns: Exprs | None = None) -> Placing:
    """Every link for the drives' values: each dyad on the side that the spec says, triads by their unknowns."""
    linkage = leg.linkage
    assert linkage is not None
    driven, order = linkage.driven, linkage.forward
    values = dict(zip(driven, drives, strict=False))
    bars = dict(zip(sorted(linkage.structure.bars), drives[len(driven) :], strict=True))
    signs = {group.name: linkage.side(group) for group in order.dyads}
    own = symbols_of(unknowns_port(leg)) if unknowns is None else unknowns
    return Placing(linkage, order, tape, values, bars, signs, parameters, unknowns=own)


def point_parameters(mechanism: Mechanism, leg: Limb) -> dict[str, sympy.Symbol]:
    """The runtime parameters that the linkage's dimensions rest on, by name."""
    assert leg.linkage is not None
    used = set().union(*(names(scalar) for scalar in _dimensions(leg.linkage)))
    return {name: symbol for name, symbol in parameter_symbols(mechanism).items() if name in used}


def _dimensions(linkage: Linkage) -> list[Scalar]:
    return [*linkage.angles, *linkage.foot[1], *(entry for ends in linkage.points for end in ends if end is not None for entry in end)]


@dataclass(frozen=True)
class Closing:
    """A linkage's closure on a tape, for what is given and the unknowns: its residuals and their slopes by these, row by row."""

    tape: Tape
    given: tuple[sympy.Expr, ...]
    unknowns: tuple[sympy.Symbol, ...]
    placing: Placing
    residuals: tuple[sympy.Expr, ...]
    slopes: tuple[tuple[sympy.Expr, ...], ...]


def closing_at(mechanism: Mechanism, leg: Limb, given: Exprs, unknowns: Sequence[sympy.Symbol], tape: Tape) -> Closing:
    """The closure for drives and parameters, in the order of a point, and unknowns."""
    count = drive_count(leg)
    parameters = dict(zip(point_parameters(mechanism, leg), given[count:], strict=True))
    placing = forward_placing(leg, given[:count], parameters, tape, unknowns)
    return closing_of(placing, given, unknowns)


def closing_of(placing: Placing, given: Exprs, unknowns: Sequence[sympy.Symbol]) -> Closing:
    """Of a linkage that is placed."""
    tape = placing.tape
    residuals = tuple(residual for closure in tape.closures for residual in closure.residuals)
    slopes = partial_tangents(tape, residuals, [(f"u{number}", unknown) for number, unknown in enumerate(unknowns)])
    rows = tuple(tuple(tape.let("slope", entry) for entry in row) for row in slopes)
    return Closing(tape, tuple(given), tuple(unknowns), placing, residuals, rows)


def point_port(mechanism: Mechanism, leg: Limb) -> Port:
    """Drives, parameters, unknowns."""
    return Port("point", (drive_count(leg) + len(point_parameters(mechanism, leg)) + unknowns_port(leg).size,), "rad, m or as declared")


def closure_function(found: Closing, words: Signature) -> Function:
    """point -> residuals, then their slopes by the unknowns, under the words' name."""
    count = len(found.unknowns)
    outputs = [*found.residuals, *(entry for row in found.slopes for entry in row)]
    return found.tape.function(replace(words, outputs=(Port("closure", (count + count**2,)),)), outputs)


@cache
def driven_closure(mechanism: Mechanism, leg: Limb) -> Function:
    """point -> residuals, then their slopes by the unknowns."""
    count, symbols = unknowns_port(leg).size, symbols_of(point_port(mechanism, leg))
    found = closing_at(mechanism, leg, symbols[:-count], symbols[-count:], Tape())
    return closure_function(found, Signature(mechanism.name, leg.name, "closure_at", (point_port(mechanism, leg),), ()))

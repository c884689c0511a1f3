"""The closure of a linkage whose foot is held: what its triad needs there, and where it is continued from.

The point of a held linkage is the foot's place in the plane, the parameters that matter, the signs of the dyads' sides, then the unknowns.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from itertools import islice, product
from typing import Any

import sympy

from walkgen.errors import Problem, UnsupportedMechanism
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT
from walkgen.signature import Port, Signature
from walkgen.spec.assur import SIDES
from walkgen.symbolic.assembly_modes import AssemblyModes
from walkgen.symbolic.closure import Closing, closing_of, closure_function, point_parameters
from walkgen.symbolic.function import Function
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.starts import Starts, rounded
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.tape_values import tape_values, value

UNKNOWNS = Port("unknowns", (2,), "rad or sizes")
_CANDIDATES, _PLACES = 9, 6

Signs = tuple[int, ...]


@dataclass(frozen=True)
class HeldStart:
    """Where the foot is held (m), parameters that matter, and for every choice of the dyads' sides the unknowns of all modes."""

    foot: tuple[Decimal, Decimal]
    parameters: tuple[Decimal, ...]
    modes: dict[Signs, tuple[tuple[Decimal, ...], ...]]

    def point(self, signs: Signs, mode: int) -> tuple[Decimal, ...]:
        """To continue from."""
        return (*self.foot, *self.parameters, *map(Decimal, signs), *self.modes[signs][mode])


def sided(linkage: Linkage) -> tuple[str, ...]:
    """Names of the dyads that have two sides where the foot is held."""
    return tuple(group.name for group in linkage.inverse.dyads if SIDES[group.kind])


def held_port(mechanism: Mechanism, leg: Limb) -> Port:
    """What the foot and the sides give: all of a point but the unknowns."""
    assert leg.linkage is not None
    return Port("held", (2 + len(point_parameters(mechanism, leg)) + len(sided(leg.linkage)),), "m or as declared")


def held_closing(mechanism: Mechanism, leg: Limb) -> Closing:
    """Of a point, on a tape of its own."""
    symbols = symbols_of(Port("point", (held_port(mechanism, leg).size + UNKNOWNS.size,)))
    return held_closing_at(mechanism, leg, symbols[: -UNKNOWNS.size], symbols[-UNKNOWNS.size :], Tape())


def held_closing_at(mechanism: Mechanism, leg: Limb, given: Sequence[sympy.Expr], unknowns: Sequence[sympy.Symbol], tape: Tape) -> Closing:
    """For the foot's place, parameters and signs, in the order of a point, and unknowns."""
    linkage, names = leg.linkage, point_parameters(mechanism, leg)
    assert linkage is not None
    parameters = dict(zip(names, given[2 : 2 + len(names)], strict=True))
    signs = dict(zip(sided(linkage), given[2 + len(names) :], strict=True))
    placing = Placing(linkage, linkage.inverse, tape, {}, {}, signs, parameters, (given[0], given[1]), unknowns=unknowns)
    return closing_of(placing, given, unknowns)


@cache
def held_closure(mechanism: Mechanism, leg: Limb) -> Function:
    """point -> residuals, then their slopes by the unknowns."""
    found = held_closing(mechanism, leg)
    point = Port("point", (len(found.given) + len(found.unknowns),), "rad, m or as declared")
    return closure_function(found, Signature(mechanism.name, leg.name, "held_closure_at", (point,), ()))


@cache
def held_start(mechanism: Mechanism, leg: Limb) -> HeldStart:
    """Of a few places of the foot the one where the linkage assembles in most ways.

    Raises:
        UnsupportedMechanism: with no drives of several that were tried it assembles (WG189).
    """
    tried = list(islice(_starts(mechanism, leg), _CANDIDATES))
    if not tried:
        message = f"leg {leg.name}: no drives are found for which the linkage assembles, to start the inverse from"
        raise UnsupportedMechanism(Problem("WG189", message, "give the drives limits within which it assembles"))
    return max(tried, key=lambda start: sum(map(len, start.modes.values())))


def _starts(mechanism: Mechanism, leg: Limb) -> Iterator[HeldStart]:
    assert leg.linkage is not None
    starts, closing = Starts(mechanism, leg), held_closing(mechanism, leg)
    modes, choices = AssemblyModes(closing), list(product((1, -1), repeat=len(sided(leg.linkage))))
    for drives in starts.candidates():
        foot = _foot(starts, leg.linkage, drives)
        if foot is None:
            continue
        found: dict[Signs, tuple[tuple[Decimal, ...], ...]] = {}
        for signs in choices:
            given = (*map(CONTEXT.mpf, map(str, foot)), *starts.parameters, *map(CONTEXT.mpf, signs))
            own = modes.at([float(number) for number in given])
            found[signs] = tuple(rounded(modes.exact(given, mode.unknowns)) for mode in own)
        if any(found.values()):
            yield HeldStart(foot, rounded(starts.parameters), found)


def _foot(starts: Starts, linkage: Linkage, drives: Sequence[Any]) -> tuple[Decimal, Decimal] | None:
    """In the plane, to a few digits; None where the drives assemble nothing."""
    given = (*drives, *starts.parameters)
    modes = starts.modes.at([float(number) for number in given])
    if not modes:
        return None
    closing, placing = starts.closing, starts.closing.placing
    numbers = (*given, *map(CONTEXT.mpf, modes[0].unknowns))
    known = tape_values(closing.tape, dict(zip((*closing.given, *closing.unknowns), numbers, strict=True)))
    x, y = (value(sympy.sympify(entry), known) for entry in placing.point(linkage.foot[0], placing.planar(linkage.foot[1])))
    return Decimal(CONTEXT.nstr(x, _PLACES)), Decimal(CONTEXT.nstr(y, _PLACES))

"""The configuration that triads are continued from: every assembly mode at the start's drive values, and the one that the spec means.

This is done once, when code is generated: the start's hints choose one of all modes, 50 digits make it exact.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from itertools import product
from typing import Any

from walkgen.errors import Problem, UnsupportedMechanism
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.scalar import evaluate
from walkgen.symbolic.assembly_modes import AssemblyMode, AssemblyModes, Hint
from walkgen.symbolic.closure import closing_at, point_parameters, point_port, unknowns_port
from walkgen.symbolic.tape import Tape, symbols_of

_DIGITS = 20
_FRACTIONS = (0.5, 0.375, 0.625, 0.25, 0.75, 0.125, 0.875, 0.0, 1.0)
_TURNS = (0, 3, -3, 6, -6, 1, -1, 2, -2, 4, -4, 5, -5)
"""Sixths of half a turn."""
_STRETCHES = (1.0, 0.8, 1.25, 0.6, 1.5, 0.4, 2.0)
_MOST_CANDIDATES = 40


@dataclass(frozen=True)
class FoundStart:
    """Drives, parameters that matter and unknowns, 20 digits; all modes, the chosen first."""

    drives: tuple[Decimal, ...]
    parameters: tuple[Decimal, ...]
    unknowns: tuple[Decimal, ...]
    modes: tuple[AssemblyMode, ...]


def found_start(mechanism: Mechanism, leg: Limb) -> FoundStart:
    """Of a leg whose linkage has triads.

    Raises:
        UnsupportedMechanism: no assembly is found (WG189).
    """
    found = start_of(mechanism, leg)
    if found is None:
        triads = ", ".join(triad.name for triad in leg.linkage.forward.triads) if leg.linkage else ""
        message = f"leg {leg.name}: the triad {triads} has no assembly at the start"
        raise UnsupportedMechanism(Problem("WG189", message, "mend the lengths that it joins, or give start other drives"))
    return found


@cache
def start_of(mechanism: Mechanism, leg: Limb) -> FoundStart | None:
    """The same, None where no assembly is found."""
    starts = Starts(mechanism, leg)
    for drives in starts.candidates():
        given = (*drives, *starts.parameters)
        modes = starts.modes.at([float(number) for number in given])
        if modes:
            unknowns = starts.modes.exact(given, modes[0].unknowns)
            return FoundStart(rounded(drives), rounded(starts.parameters), rounded(unknowns), tuple(modes))
    return None


def rounded(numbers: Any) -> tuple[Decimal, ...]:
    """To the digits that are printed."""
    return tuple(Decimal(CONTEXT.nstr(number, _DIGITS)) for number in numbers)


class Starts:
    """Where a linkage may start from.

    Args:
        mechanism: the robot.
        leg: one whose linkage may have triads.

    Attributes:
        parameters: values of the runtime parameters that matter.
        modes: all ways in which it assembles, for drives and parameters.
    """

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        assert leg.linkage is not None
        self._leg, self._linkage, self._values = leg, leg.linkage, defaults(mechanism)
        self.names = tuple(point_parameters(mechanism, leg))
        self.parameters = [self._values[name] for name in self.names]
        symbols, given = symbols_of(point_port(mechanism, leg)), point_port(mechanism, leg).size - unknowns_port(leg).size
        self.closing = closing_at(mechanism, leg, symbols[:given], symbols[given:], Tape())
        self.modes = AssemblyModes(self.closing, list(self._hinted()))

    def _hinted(self) -> Iterator[Hint]:
        size, planar = float(self._number(self._linkage.size)), self.closing.placing.planar
        for body, point, at in self._linkage.start.points:
            yield Hint(body, planar(point), tuple(float(self._number(entry)) for entry in at), size)
        for body, angle in self._linkage.start.angles:
            yield Hint(body, None, (float(self._number(angle)),), size)

    def _number(self, scalar: Any) -> Any:
        return evaluate(scalar, CONTEXT, self._values)

    def candidates(self) -> Iterator[tuple[Any, ...]]:
        """Values of the drives to start from: the spec's, else the middles of their limits and places around."""
        if self._linkage.start.drives:
            yield tuple(self._number(drive) for drive in self._linkage.start.drives)
            return
        options = [self._options(joint) for joint in self._leg.drives]
        ranked = sorted(product(*(range(len(own)) for own in options)), key=lambda places: (sum(places), places))
        for places in ranked[:_MOST_CANDIDATES]:
            yield tuple(own[place] for own, place in zip(options, places, strict=True))

    def _options(self, joint: Joint) -> list[Any]:
        if joint.limits is not None:
            low, high = (self._number(limit) for limit in joint.limits)
            return [low + (high - low) * CONTEXT.mpf(fraction) for fraction in _FRACTIONS]
        if joint.kind == "revolute":
            return [CONTEXT.pi * sixths / 6 for sixths in _TURNS]
        return [self._number(self._linkage.size) * CONTEXT.mpf(str(stretch)) for stretch in _STRETCHES]

"""Random motions of a leg with a linkage or a cam, to 50 digits: joints and drives move freely, the links as they must."""

import random
from collections.abc import Mapping, Sequence
from typing import Any

import sympy

from walkgen.model.drive_ranges import drive_ranges
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT
from walkgen.symbolic.closure import unknowns_port
from walkgen.symbolic.minimal import Motions, Values
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tangents import partial_tangents
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.tape_values import lines_behind, value

_TRIES, _STEPS = 500, 40
_GRAIN, _EXACT = 1000, CONTEXT.mpf(10) ** -46


class NoPostureError(Exception):
    """No drives were found for which the linkage assembles."""


def driven_motions(mechanism: Mechanism, leg: Limb, spread: Spread) -> Motions:
    """Of the links of the leg's tree; triads are closed in any way that Newton's method comes to from the start.

    Raises:
        NoPostureError: when called: none of many values of the drives has a posture.
    """
    linkage = leg.linkage
    closing = _Closure(mechanism, leg, spread.tape) if linkage and linkage.forward.triads else None
    symbols = symbols_of(joint_port("q", leg.joints))
    turns: list[tuple[Any, Any]] = [(-2, 2) for _ in leg.serial]
    ranges = turns + (drive_ranges(mechanism, leg, linkage) if linkage else []) + [(-2, 2) for _ in leg.distal]
    lines = lines_behind(spread.tape, [*spread.values, *(slope for row in spread.slopes for slope in row.values())])

    def motions(known: Values, generator: random.Random) -> list[tuple[Any, Any]]:
        for _ in range(_TRIES):
            q = [low + (high - low) * generator.randrange(1, _GRAIN) / _GRAIN for low, high in ranges]
            rates = [CONTEXT.mpf(generator.randrange(-2 * _GRAIN, 2 * _GRAIN)) / _GRAIN for _ in ranges]
            given = {**known, **dict(zip(symbols, q, strict=True))}
            closed = closing.closed(given) if closing else given
            found = _evaluated(lines, closed) if closed else None
            if found is not None:
                return [(value(at, found), _rate(row, rates, found)) for at, row in zip(spread.values, spread.slopes, strict=True)]
        raise NoPostureError

    return motions


class _Closure:
    """What closes the triads of a leg whose links are on a tape."""

    def __init__(self, mechanism: Mechanism, leg: Limb, tape: Tape) -> None:
        own, self._start = tape.fork(), found_start(mechanism, leg).unknowns
        self._unknowns = symbols_of(unknowns_port(leg))
        self._residuals = [residual for closure in own.closures for residual in closure.residuals]
        slopes = partial_tangents(own, self._residuals, [(f"u{number}", unknown) for number, unknown in enumerate(self._unknowns)])
        self._slopes = [[own.let("slope", entry) for entry in row] for row in slopes]
        self._lines = lines_behind(own, [*self._residuals, *(entry for row in self._slopes for entry in row)])

    def closed(self, given: dict[sympy.Symbol, Any]) -> dict[sympy.Symbol, Any] | None:
        """The values with the unknowns', to 50 digits; None where Newton's method does not converge."""
        u = [CONTEXT.mpf(str(unknown)) for unknown in self._start]
        for _ in range(_STEPS):
            known = _evaluated(self._lines, {**given, **dict(zip(self._unknowns, u, strict=True))})
            if known is None:
                return None
            slopes = CONTEXT.matrix([[value(entry, known) for entry in row] for row in self._slopes])
            try:
                step = CONTEXT.lu_solve(slopes, CONTEXT.matrix([value(residual, known) for residual in self._residuals]))
            except ZeroDivisionError:
                return None
            size = CONTEXT.norm(step)
            u = [unknown - change / max(1, 2 * size) for unknown, change in zip(u, step, strict=True)]
            if size < _EXACT:
                return {**given, **dict(zip(self._unknowns, u, strict=True))}
        return None


def _rate(row: Mapping[int, sympy.Expr], rates: Sequence[Any], known: Values) -> Any:
    return sum(value(slope, known) * rates[index] for index, slope in row.items())


def _evaluated(lines: Sequence[tuple[sympy.Symbol, sympy.Expr]], known: dict[sympy.Symbol, Any]) -> Values | None:
    """Every line's value; None where one is not real: a dyad cannot close."""
    for symbol, definition in lines:
        if symbol not in known:
            known[symbol] = value(definition, known)
            if isinstance(known[symbol], CONTEXT.mpc):
                return None
    return known

"""A tape's values in 50 digits where triads are closed: their unknowns by Newton's method, from the start."""

from collections.abc import Sequence
from typing import Any

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT
from walkgen.symbolic.closure import unknowns_port
from walkgen.symbolic.minimal import Values
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tangents import partial_tangents
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.tape_values import lines_behind, value

_STEPS, _EXACT = 40, CONTEXT.mpf(10) ** -46


class TapeClosure:
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
            known = evaluated(self._lines, {**given, **dict(zip(self._unknowns, u, strict=True))})
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


def evaluated(lines: Sequence[tuple[sympy.Symbol, sympy.Expr]], known: dict[sympy.Symbol, Any]) -> Values | None:
    """Every line's value; None where one is not real: a dyad cannot close, or its pins coincide."""
    for symbol, definition in lines:
        if symbol not in known:
            try:
                known[symbol] = value(definition, known)
            except ZeroDivisionError:
                return None
            if isinstance(known[symbol], CONTEXT.mpc):
                return None
    return known

"""What the closure of triads says of its unknowns: Newton's step, its determinants, how the unknowns move with the runtime parameters."""

from collections.abc import Sequence
from functools import cache

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.closure import Closing, closing_at, drive_count, point_parameters, point_port, unknowns_port
from walkgen.symbolic.function import Function
from walkgen.symbolic.tangents import partial_tangents
from walkgen.symbolic.tape import Tape, symbols_of

Exprs = Sequence[sympy.Expr]


@cache
def unknown_slopes(mechanism: Mechanism, leg: Limb) -> Function:
    """How the unknowns move with the runtime parameters: -(dr/du)^-1 dr/dp."""
    given, unknowns, tape = _given(mechanism, leg), unknowns_port(leg), Tape()
    symbols, used = symbols_of(given), list(point_parameters(mechanism, leg))
    found = closing_at(mechanism, leg, symbols, symbols_of(unknowns), tape)
    named = list(zip(used, symbols[drive_count(leg) :], strict=True))
    columns = zip(*partial_tangents(tape, found.residuals, named), strict=True)
    by_name = dict(zip(used, (answers(found, column) for column in columns), strict=True))
    nothing = [sympy.S.Zero] * unknowns.size
    rows = zip(*(by_name.get(parameter.name, nothing) for parameter in mechanism.parameters), strict=True)
    port = Port(f"{unknowns.name}_d_param", (unknowns.size, len(mechanism.parameters)))
    words = Signature(mechanism.name, leg.name, "closure_slopes", (given, unknowns), (port,))
    return tape.function(words, [entry for row in rows for entry in row])


def newton_step(found: Closing) -> list[sympy.Expr]:
    """-(dr/du)^-1 r."""
    return answers(found, found.residuals)


def answers(found: Closing, changes: Exprs) -> list[sympy.Expr]:
    """How the unknowns answer changes of the residuals, triad after triad: no residual rests on the unknowns of later ones."""
    steps: list[sympy.Expr] = []
    for start, determinant in zip(range(0, len(changes), 2), determinants(found), strict=True):
        rests = []
        for row in (start, start + 1):
            moved = [slope * step for slope, step in zip(found.slopes[row], steps, strict=False)]
            rests.append(found.tape.let("rest", sympy.Add(changes[row], *moved)))
        (a, b), (c, d) = (found.slopes[row][start : start + 2] for row in (start, start + 1))
        steps.append(found.tape.let("newton", (b * rests[1] - d * rests[0]) / determinant))
        steps.append(found.tape.let("newton", (c * rests[0] - a * rests[1]) / determinant))
    return steps


def determinants(found: Closing) -> list[sympy.Expr]:
    """Of every triad's slopes: 0 at its dead points."""
    values = []
    for start in range(0, len(found.residuals), 2):
        (a, b), (c, d) = (found.slopes[row][start : start + 2] for row in (start, start + 1))
        values.append(found.tape.let("determinant", a * d - b * c))
    return values


def _given(mechanism: Mechanism, leg: Limb) -> Port:
    return Port("given", (point_port(mechanism, leg).size - unknowns_port(leg).size,), "rad, m or as declared")

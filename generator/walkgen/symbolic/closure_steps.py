"""The closure of triads without a routine: a fixed number of Newton steps on the way from the start to the drives."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.branches import BAD_INPUT, OK, UNREACHABLE
from walkgen.symbolic.choices import both, indicator, less
from walkgen.symbolic.closure import Closing, assembled_port, closing_at, drive_count, point_parameters, point_port, unknowns_port
from walkgen.symbolic.function import Finite, Function, Residue, Select
from walkgen.symbolic.starts import found_start
from walkgen.symbolic.tangents import partial_tangents
from walkgen.symbolic.tape import Tape, symbols_of

Exprs = Sequence[sympy.Expr]
_PARTS = 64
_CLOSED = sympy.Rational(1, 10**24)
"""Of the residuals' squares."""
_SHORT = sympy.Rational(1, 16)
"""Of a step, squared."""


def begin(mechanism: Mechanism, leg: Limb) -> Function:
    """The way gone, 0; whether it is whole, 1; and the unknowns at the start."""
    start = found_start(mechanism, leg)
    given, state = _given(mechanism, leg), _state(leg)
    values = [sympy.S.Zero, sympy.S.One, *(sympy.Rational(str(unknown)) for unknown in start.unknowns)]
    return Tape().function(Signature(mechanism.name, leg.name, "closure_begin", (given,), (state,), "", ""), values)


@cache
def advance(mechanism: Mechanism, leg: Limb) -> Function:
    """A part of the way, and a Newton step there; the way is whole while steps are short and no determinant changes its sign."""
    given, state, tape = _given(mechanism, leg), _state(leg), Tape()
    way, whole, *unknowns = symbols_of(state)
    start = found_start(mechanism, leg)
    further = tape.let("further", way + sympy.Rational(1, _PARTS))
    gone = tape.let("gone", Select(less(further, 1), further, 1))
    from_start = [sympy.Rational(str(number)) for number in (*start.drives, *start.parameters)]
    at = [tape.let("at", first + gone * (last - first)) for first, last in zip(from_start, symbols_of(given), strict=True)]
    found = closing_at(mechanism, leg, at, unknowns, tape)
    steps = newton_step(found)
    fine = both(_in_sense(found, start.senses), less(sympy.Add(*(step**2 for step in steps)), _SHORT))
    words = Signature(mechanism.name, leg.name, "closure_advance", (given, state), (replace(state, name="next"),), "", "")
    return tape.function(words, [gone, whole * indicator(fine), *(unknown + step for unknown, step in zip(unknowns, steps, strict=True))])


@cache
def finish(mechanism: Mechanism, leg: Limb) -> Function:
    """The unknowns, NaN unless they close the linkage in the start's assembly, and the status."""
    given, state, tape = _given(mechanism, leg), _state(leg), Tape()
    _, whole, *unknowns = symbols_of(state)
    found = closing_at(mechanism, leg, symbols_of(given), unknowns, tape)
    missed = tape.let("missed", sympy.Add(*(residual**2 for residual in found.residuals)))
    closes = both(less(missed, _CLOSED), both(less(0, whole), _in_sense(found, found_start(mechanism, leg).senses)))
    taint = tape.let("taint", sympy.Add(*(Residue(symbol) for symbol in symbols_of(given))))
    status = Select(Finite(taint), Select(closes, OK, UNREACHABLE), BAD_INPUT)
    nothing = tape.let("nothing", sympy.sqrt(-1 - missed**2))  # NaN
    outputs = (unknowns_port(leg), assembled_port(leg))
    words = Signature(mechanism.name, leg.name, "closure_finish", (given, state), outputs, "", "")
    return tape.function(words, [*(Select(closes, unknown, nothing) for unknown in unknowns), status])


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


def _in_sense(found: Closing, senses: Sequence[int]) -> sympy.Basic:
    """Whether every determinant has the sign that it has at the start."""
    same: sympy.Basic = sympy.true
    for determinant, sense in zip(determinants(found), senses, strict=True):
        same = both(same, less(0, sense * determinant))
    return same


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


def _state(leg: Limb) -> Port:
    return Port(f"{leg.name}_state", (2 + unknowns_port(leg).size,))

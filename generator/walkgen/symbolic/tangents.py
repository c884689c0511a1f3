"""Forward differentiation of what is on a tape: every line's partial derivatives once, then a tangent for every variable."""

from collections.abc import Sequence

import sympy

from walkgen.symbolic.tape import Tape


def tangents(tape: Tape, outputs: Sequence[sympy.Expr], variables: Sequence[tuple[str, sympy.Symbol]]) -> list[list[sympy.Expr]]:
    """Derivatives of the outputs (rows) by the variables (columns), written on the tape after what is there.

    Args:
        tape: holds the lines that the outputs use; sums, products, powers, sines and cosines.
        outputs: expressions in the tape's names and its inputs.
        variables: inputs, each with the name that its tangents end in.
    """
    lines = [(symbol, definition, _partials(definition, tape)) for symbol, definition in _needed(tape, outputs)]
    ends = [_partials(output, tape) for output in outputs]
    columns = []
    for label, variable in variables:
        known: dict[sympy.Symbol, sympy.Expr] = {variable: sympy.S.One}
        for symbol, _, partials in lines:
            slope = _chained(partials, known)
            if slope != 0:
                known[symbol] = tape.let(f"{symbol}_d_{label}", slope)
        columns.append([_chained(partials, known) for partials in ends])
    return [list(row) for row in zip(*columns, strict=True)]


def _needed(tape: Tape, outputs: Sequence[sympy.Expr]) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    used = {symbol for output in outputs for symbol in output.free_symbols}
    kept = []
    for symbol, definition in reversed(tape.lines):
        if symbol in used:
            used |= definition.free_symbols
            kept.append((symbol, definition))
    return kept[::-1]


def _partials(expression: sympy.Expr, tape: Tape) -> dict[sympy.Symbol, sympy.Expr]:
    """By every symbol; sines and cosines by the names that they have."""
    if isinstance(expression, sympy.sin | sympy.cos):
        (angle,) = expression.args
        slope = sympy.cos(angle) if isinstance(expression, sympy.sin) else -sympy.sin(angle)
        outer = tape.let(f"slope_{angle}", slope)
        return {symbol: outer * inner for symbol, inner in _partials(angle, tape).items()}
    return {symbol: expression.diff(symbol) for symbol in sorted(expression.free_symbols, key=str)}


def _chained(partials: dict[sympy.Symbol, sympy.Expr], known: dict[sympy.Symbol, sympy.Expr]) -> sympy.Expr:
    return sympy.Add(*(partial * known[symbol] for symbol, partial in partials.items() if symbol in known))

"""Forward differentiation of what is on a tape: every line's partial derivatives once, then a tangent for every variable.

Inputs that a closure makes functions of others move with them, by the theorem of implicit functions: du = -(dr/du)^-1 dr.
"""

from collections.abc import Iterator, Sequence

import sympy

from walkgen.symbolic.function import Angle, Less, Residue, Select
from walkgen.symbolic.tape import Closure, Tape

Known = dict[sympy.Symbol, sympy.Expr]


def tangents(tape: Tape, outputs: Sequence[sympy.Expr], variables: Sequence[tuple[str, sympy.Symbol]]) -> list[list[sympy.Expr]]:
    """Derivatives of the outputs (rows) by the variables (columns), written on the tape after what is there.

    Args:
        tape: holds the lines that the outputs use; sums, products, powers, sines, cosines and sizes.
        outputs: expressions in the tape's names and its inputs.
        variables: inputs, each with the name that its tangents end in.
    """
    forward, closures = _Forward(tape, outputs), [_Implicit(tape, closure) for closure in _used(tape, outputs)]
    columns = [forward.column(label, _moving(closures, label, variable)) for label, variable in variables]
    return [list(row) for row in zip(*columns, strict=True)]


def partial_tangents(tape: Tape, outputs: Sequence[sympy.Expr], variables: Sequence[tuple[str, sympy.Symbol]]) -> list[list[sympy.Expr]]:
    """The same, but every input moves on its own."""
    forward = _Forward(tape, outputs)
    return [list(row) for row in zip(*(forward.column(label, {variable: sympy.S.One}) for label, variable in variables), strict=True)]


def tangents_along(tape: Tape, outputs: Sequence[sympy.Expr], label: str, moving: Known) -> list[sympy.Expr]:
    """Tangents of the outputs where inputs move as said; their names end in the label."""
    return _Forward(tape, outputs).column(label, moving)


class _Forward:
    """Lines that some outputs need, with their partial derivatives."""

    def __init__(self, tape: Tape, outputs: Sequence[sympy.Expr]) -> None:
        self._tape = tape
        self._lines = [(symbol, _partials(definition, tape)) for symbol, definition in _needed(tape, outputs)]
        self._ends = [_partials(output, tape) for output in outputs]

    def column(self, label: str, moving: Known) -> list[sympy.Expr]:
        """Tangents of the outputs where inputs move as said."""
        known = dict(moving)
        for symbol, partials in self._lines:
            slope = _chained(partials, known)
            if slope != 0:
                known[symbol] = self._tape.let(f"{symbol}_d_{label}", slope)
        return [_chained(partials, known) for partials in self._ends]


def _used(tape: Tape, outputs: Sequence[sympy.Expr]) -> list[Closure]:
    """The closures whose unknowns the outputs rest on, in order."""
    found: list[Closure] = []
    wanted = list(outputs)
    for closure in reversed(tape.closures):
        if not _inputs(tape, wanted).isdisjoint(closure.unknowns):
            found.append(closure)
            wanted += closure.residuals
    return found[::-1]


def _inputs(tape: Tape, outputs: Sequence[sympy.Expr]) -> set[sympy.Basic]:
    definitions = [definition for _, definition in _needed(tape, outputs)]
    return set().union(*(expression.free_symbols for expression in (*outputs, *definitions)))


def _moving(closures: Sequence["_Implicit"], label: str, variable: sympy.Symbol) -> Known:
    """The variable, and what it moves of the closures' unknowns."""
    known = {variable: sympy.S.One}
    for closure in closures:
        known |= dict(closure.moved(label, known))
    return known


class _Implicit:
    """A closure of two unknowns, with the slopes of its residuals by them."""

    def __init__(self, tape: Tape, closure: Closure) -> None:
        self._tape, self._unknowns, self._forward = tape, closure.unknowns, _Forward(tape, closure.residuals)
        named = [(str(unknown), unknown) for unknown in closure.unknowns]
        (a, b), (c, d) = ([tape.let("closure_slope", entry) for entry in row] for row in partial_tangents(tape, closure.residuals, named))
        self._slopes, self._determinant = (a, b, c, d), tape.let("closure_determinant", a * d - b * c)

    def moved(self, label: str, known: Known) -> Iterator[tuple[sympy.Symbol, sympy.Expr]]:
        """Slopes of the unknowns by Cramer's rule; none where the residuals do not move."""
        own = [self._tape.let("residual_slope", slope) for slope in self._forward.column(label, known)]
        if not any(own):
            return
        a, b, c, d = self._slopes
        for unknown, slope in zip(self._unknowns, (b * own[1] - d * own[0], c * own[0] - a * own[1]), strict=True):
            yield unknown, self._tape.let(f"{unknown}_d_{label}", slope / self._determinant)


def _needed(tape: Tape, outputs: Sequence[sympy.Expr]) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    used = {symbol for output in outputs for symbol in output.free_symbols}
    kept = []
    for symbol, definition in reversed(tape.lines):
        if symbol in used:
            used |= definition.free_symbols
            kept.append((symbol, definition))
    return kept[::-1]


def _partials(expression: sympy.Expr, tape: Tape) -> dict[sympy.Symbol, sympy.Expr]:
    """By every symbol; sines and cosines by the names that they have; sizes by signs, since symbols here are real."""
    if isinstance(expression, sympy.Abs):
        (inside,) = expression.args
        sign = tape.let("sign", Select(Less(inside, 0), -1, 1))
        return {symbol: sign * inner for symbol, inner in _partials(inside, tape).items()}
    if isinstance(expression, sympy.sin | sympy.cos):
        (angle,) = expression.args
        slope = sympy.cos(angle) if isinstance(expression, sympy.sin) else -sympy.sin(angle)
        outer = tape.let(f"slope_{angle}", slope)
        return {symbol: outer * inner for symbol, inner in _partials(angle, tape).items()}
    if isinstance(expression, Select):
        condition, then, otherwise = expression.args
        ways = [_partials(sympy.sympify(way), tape) for way in (then, otherwise)]
        return {
            symbol: _either(condition, *(way.get(symbol, sympy.S.Zero) for way in ways)) for symbol in dict.fromkeys([*ways[0], *ways[1]])
        }
    if expression.has(Select, Residue, Angle) and not expression.is_Symbol:
        return _through(expression, tape)
    return {symbol: expression.diff(symbol) for symbol in sorted(expression.free_symbols, key=str)}


def _either(condition: sympy.Basic, then: sympy.Expr, otherwise: sympy.Expr) -> sympy.Expr:
    return then if then == otherwise else Select(condition, then, otherwise)


def _through(expression: sympy.Expr, tape: Tape) -> dict[sympy.Symbol, sympy.Expr]:
    """Of an expression around choices: these under names of their own; what only tells whether a number is finite does not move."""
    if isinstance(expression, Residue):
        return {}
    if isinstance(expression, Angle):
        y, x = (tape.let("side", part) for part in expression.args)
        return _merged([(x / (x**2 + y**2), y), (-y / (x**2 + y**2), x)], tape)
    parts = {part: sympy.Dummy() for part in expression.atoms(Select, Residue, Angle)}
    outer = expression.xreplace(parts)
    slopes = [(outer.diff(dummy).xreplace({d: p for p, d in parts.items()}), part) for part, dummy in parts.items()]
    plain = [(outer.diff(symbol).xreplace({d: p for p, d in parts.items()}), symbol) for symbol in outer.free_symbols - set(parts.values())]
    return _merged([*slopes, *sorted(plain, key=lambda term: str(term[1]))], tape)


def _merged(terms: Sequence[tuple[sympy.Expr, sympy.Expr]], tape: Tape) -> dict[sympy.Symbol, sympy.Expr]:
    """Partials of a sum of outer slopes times inner ones."""
    found: dict[sympy.Symbol, sympy.Expr] = {}
    for outer, inside in terms:
        own = {inside: sympy.S.One} if inside.is_Symbol else _partials(inside, tape)
        for symbol, inner in own.items():
            found[symbol] = found.get(symbol, sympy.S.Zero) + outer * inner
    return found


def _chained(partials: dict[sympy.Symbol, sympy.Expr], known: Known) -> sympy.Expr:
    return sympy.Add(*(partial * known[symbol] for symbol, partial in partials.items() if symbol in known))

"""3x3 systems as straight-line code that takes apart what exact zeros take apart, for several right sides."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy

from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, plus

Pivot = tuple[int, int]


@dataclass(frozen=True)
class Factored:
    """det M, and what gives M^-1 b where it is not 0."""

    determinant: sympy.Expr
    solve: Callable[[Vec], Vec]


def factored(columns: Sequence[Vec], tape: Tape) -> Factored | None:
    """M by its columns; None where M is singular whatever its symbols are.

    A row or column with one number alone is solved for its own, the other two by Cramer's rule, which is accurate for two; a full M by
    Cramer's rule and one refinement, which makes it as good as pivoted elimination.
    """
    for row in range(3):
        if len(places := [column for column in range(3) if columns[column][row] != 0]) == 1:
            return _apart(columns, (row, places[0]), tape, by_row=True)
    for column in range(3):
        if len(places := [row for row in range(3) if columns[column][row] != 0]) == 1:
            return _apart(columns, (places[0], column), tape, by_row=False)
    return _full(columns, tape)


def _full(columns: Sequence[Vec], tape: Tape) -> Factored | None:
    a, b, c = columns
    rows = [tape.vector("minor", cross(*pair)) for pair in ((b, c), (c, a), (a, b))]
    determinant = tape.let("det", dot(a, rows[0]))
    if determinant == 0:
        return None
    inverse = tape.let("inverse_det", 1 / determinant)

    def cramer(right: Vec) -> Vec:
        x, y, z = (tape.let("solution", dot(row, right) * inverse) for row in rows)
        return (x, y, z)

    def solve(right: Vec) -> Vec:
        first = cramer(right)
        x, y, z = (dot([column[row] for column in columns], first) for row in range(3))
        return tape.vector("refined", plus(first, cramer(tape.vector("residual", minus(right, (x, y, z))))))

    return Factored(determinant, solve)


def _apart(matrix: Sequence[Vec], pivot: Pivot, tape: Tape, *, by_row: bool) -> Factored | None:
    """The pivot is alone in its row and solved for first, or in its column and solved for last."""
    row, column = pivot
    rows, columns = _others(row), _others(column)
    (a, c), (b, d) = ([matrix[other][place] for place in rows] for other in columns)
    minor, own = tape.let("det", a * d - b * c), matrix[column][row]
    if minor == 0:
        return None
    inverse, reciprocal = tape.let("inverse_det", 1 / minor), tape.let("inverse_pivot", 1 / own)

    def pair(first: sympy.Expr, second: sympy.Expr) -> list[sympy.Expr]:
        above = tape.let("solution", d * first - b * second), tape.let("solution", a * second - c * first)
        return [tape.let("rate", part * inverse) for part in above]

    def solve(right: Vec) -> Vec:
        if by_row:
            alone = tape.let("rate", right[row] * reciprocal)
            others = pair(*(tape.let("rest", right[place] - matrix[column][place] * alone) for place in rows))
        else:
            others = pair(*(right[place] for place in rows))
            along = dot([matrix[other][row] for other in columns], others)
            alone = tape.let("rate", tape.let("rest", right[row] - along) * reciprocal)
        values = {column: alone} | dict(zip(columns, others, strict=True))
        return (values[0], values[1], values[2])

    return Factored(tape.let("det3", (-1) ** (row + column) * own * minor), solve)


def _others(index: int) -> tuple[int, int]:
    first, second = (other for other in range(3) if other != index)
    return first, second

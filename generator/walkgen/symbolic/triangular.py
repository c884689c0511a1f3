"""Symmetric linear equations solved in a straight line: L' D L from the last row up, no roots and no pivoting."""

from collections.abc import Mapping, Sequence

import sympy

from walkgen.symbolic.tape import Tape

Entries = Mapping[tuple[int, int], sympy.Expr]


class SingularMatrixError(ValueError):
    """A pivot is 0 whatever the inputs."""


def solved(matrix: Entries, right: Sequence[sympy.Expr], tape: Tape) -> tuple[sympy.Expr, ...]:
    """x of matrix * x = right.

    Starting from the last row leaves alone what is zero in a mass matrix of branching paths (Featherstone 2005), and the last
    pivots are constants there.

    Args:
        matrix: symmetric, by row and column; missing entries are 0.
        right: the right-hand side.
        tape: for the intermediates.

    Raises:
        SingularMatrixError: a pivot is known to be 0.
    """
    count = len(right)
    work = {(row, column): matrix.get((row, column), sympy.S.Zero) for row in range(count) for column in range(row + 1)}
    factors: dict[tuple[int, int], sympy.Expr] = {}
    for pivot in reversed(range(count)):
        _eliminate(pivot, work, factors, tape)
    return _substituted(work, factors, right, tape)


def _eliminate(pivot: int, work: dict[tuple[int, int], sympy.Expr], factors: dict[tuple[int, int], sympy.Expr], tape: Tape) -> None:
    """Take the pivot's row and column out of what is left above it."""
    if work[pivot, pivot] == 0:
        raise SingularMatrixError
    reciprocal = tape.let(f"reciprocal_{pivot}", 1 / work[pivot, pivot])
    for row in reversed(range(pivot)):
        factors[pivot, row] = tape.let(f"L_{pivot}_{row}", work[pivot, row] * reciprocal)
        for column in range(row + 1):
            work[row, column] = tape.let(f"D_{row}_{column}", work[row, column] - factors[pivot, row] * work[pivot, column])
    work[pivot, pivot] = reciprocal


def _substituted(work: Entries, factors: Entries, right: Sequence[sympy.Expr], tape: Tape) -> tuple[sympy.Expr, ...]:
    """Both triangles in turn; `work` holds the pivots' reciprocals."""
    count = len(right)
    halfway = list(right)
    for pivot in reversed(range(count)):
        halfway[pivot] = tape.let(f"halfway_{pivot}", halfway[pivot])
        for row in range(pivot):
            halfway[row] = halfway[row] - factors[pivot, row] * halfway[pivot]
    found: list[sympy.Expr] = []
    for row in range(count):
        known = sympy.Add(*(factors[row, column] * found[column] for column in range(row)))
        found.append(tape.let(f"solution_{row}", halfway[row] * work[row, row] - known))
    return tuple(found)

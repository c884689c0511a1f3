"""Small linear systems as straight-line code."""

from collections.abc import Sequence

import sympy

from walkgen.symbolic.tape import Tape


def solve_symmetric(matrix: Sequence[Sequence[sympy.Expr]], right: Sequence[sympy.Expr], tape: Tape) -> list[sympy.Expr]:
    """x with M x = b for a symmetric M whose leading minors are not 0, by L D L' without square roots.

    Args:
        matrix: M [n][n]; its lower triangle is read.
        right: b [n].
        tape: where the intermediates go.
    """
    size = len(right)
    lower: list[list[sympy.Expr]] = []
    pivots: list[sympy.Expr] = []
    for i in range(size):
        row: list[sympy.Expr] = []
        scaled: list[sympy.Expr] = []
        for j in range(i):
            value = matrix[i][j] - sympy.Add(*(scaled[k] * lower[j][k] for k in range(j)))
            scaled.append(tape.let("scaled", value))
            row.append(tape.let("factor", scaled[j] / pivots[j]))
        lower.append(row)
        pivots.append(tape.let("pivot", matrix[i][i] - sympy.Add(*(row[k] * scaled[k] for k in range(i)))))
    forward: list[sympy.Expr] = []
    for i in range(size):
        forward.append(tape.let("forward", right[i] - sympy.Add(*(lower[i][k] * forward[k] for k in range(i)))))
    found: list[sympy.Expr] = [sympy.S.Zero] * size
    for i in reversed(range(size)):
        rest = sympy.Add(*(lower[k][i] * found[k] for k in range(i + 1, size)))
        found[i] = tape.let("solution", forward[i] / pivots[i] - rest)
    return found

"""Levenberg's damped steps in two unknowns (u, v): taken where they do not lead away, shorter after one that was not taken."""

from collections.abc import Sequence

import sympy

from walkgen.symbolic.choices import at_most, chosen, less
from walkgen.symbolic.jets import ratio
from walkgen.symbolic.tape import Tape

FIRST = sympy.Rational(1, 1000)
"""The damping to begin with."""

Entries = tuple[sympy.Expr, sympy.Expr, sympy.Expr]
"""uu, uv, vv of a symmetric matrix."""


def stepped(
    tape: Tape, at: Sequence[sympy.Expr], matrix: Entries, scale: tuple[sympy.Expr, sympy.Expr], gradient: Sequence[sympy.Expr]
) -> tuple[sympy.Expr, sympy.Expr]:
    """at - (matrix + damping diag(scale))^-1 gradient, where `at` is u, v and the damping."""
    u, v, damping = at
    gu, gv = gradient
    uu, uv, vv = tape.let("stiff_uu", matrix[0] + damping * scale[0]), matrix[1], tape.let("stiff_vv", matrix[2] + damping * scale[1])
    det = tape.let("det", uu * vv - uv**2)
    return tape.let("next_u", u + ratio(uv * gv - vv * gu, det, u)), tape.let("next_v", v + ratio(uv * gu - uu * gv, det, v))


def taken(
    tape: Tape, at: Sequence[sympy.Expr], ahead: Sequence[sympy.Expr], squares: tuple[sympy.Expr, sympy.Expr], slack: sympy.Expr
) -> list[sympy.Expr]:
    """u, v and damping after the step to `ahead`.

    Args:
        tape: where the decision is written.
        at: u, v and damping before.
        ahead: u and v that are tried.
        squares: what is to become least, before and ahead; more by rounding is no more.
        slack: rounding of 1.
    """
    u, v, damping = at
    better = at_most(squares[1], tape.let("bound", squares[0] + slack * squares[0]))
    shorter = chosen(less(slack, damping), damping / 8, 0)
    longer = chosen(less(FIRST, damping), 8 * damping, 10 * FIRST)
    return [chosen(better, ahead[0], u), chosen(better, ahead[1], v), chosen(better, shorter, longer)]

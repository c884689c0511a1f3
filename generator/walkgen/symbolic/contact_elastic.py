"""How elastic legs share a load while every foot sticks, as one expression, for CasADi (theory 4.3)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import sympy

from walkgen.signature import STATUSES, Signature
from walkgen.symbolic.choices import at_most, both, chosen
from walkgen.symbolic.function import Finite, Function
from walkgen.symbolic.linear import solve_symmetric
from walkgen.symbolic.tape import Tape, Vec, cross, dot, minus, plus, scaled, symbols_of, times

_OK, _BAD_INPUT, _NO_CONVERGENCE = (sympy.Integer(STATUSES.index(name)) for name in ("OK", "BAD_INPUT", "NO_CONVERGENCE"))
_SLACK = sympy.Rational(1, 10**9)
Matrix = tuple[Vec, Vec, Vec]
"""A symmetric 3 x 3 matrix."""


def sticking(words: Signature, feet: Mapping[str, int]) -> Function:
    """f = -C^-1 (G' delta + e) with K delta = w - G C^-1 e, K = G C^-1 G': NO_CONVERGENCE where a foot would pull or slide.

    Args:
        words: of the function with any number of feet, with a compliance [k,3,3].
        feet: how many.
    """
    sized = replace(
        words, inputs=tuple(port.sized(feet) for port in words.inputs), outputs=tuple(port.sized(feet) for port in words.outputs)
    )
    values = {port.name: symbols_of(port) for port in sized.inputs}
    tape, count = Tape(), feet["k"]
    points, normals, misfits = ([_vector(values[name][3 * i :]) for i in range(count)] for name in ("points", "normals", "misfit"))
    stiffness = [_inverse(values["compliance"][9 * i : 9 * i + 9], tape) for i in range(count)]
    pulls = [tape.vector("pull", times(matrix, misfit)) for matrix, misfit in zip(stiffness, misfits, strict=True)]
    carried = [tape.let("carried", sympy.Add(*parts)) for parts in zip(*map(_wrench, points, pulls), strict=True)]
    right = [load - part for load, part in zip(values["wrench"], carried, strict=True)]
    delta = solve_symmetric(_whole(points, stiffness, tape), right, tape)
    moved = [plus(_vector(delta), cross(_vector(delta[3:]), point)) for point in points]
    forces = [
        tape.vector("f", scaled(sympy.Integer(-1), times(matrix, plus(move, misfit))))
        for matrix, move, misfit in zip(stiffness, moved, misfits, strict=True)
    ]
    lacking = [load + sympy.Add(*parts) for load, *parts in zip(values["wrench"], *map(_wrench, points, forces), strict=True)]
    held = [_held(force, normal, mu, tape) for force, normal, mu in zip(forces, normals, values["mu"], strict=True)]
    status = chosen(_all(held), _OK, _NO_CONVERGENCE)
    status = chosen(Finite(sympy.Add(*(part for force in forces for part in force))), status, _BAD_INPUT)
    states = [chosen(truth, 0, 1) for truth in held]
    violation = sympy.sqrt(sympy.Add(*(part**2 for part in lacking)))
    return tape.function(sized, [*(part for force in forces for part in force), status, *states, *delta, violation])


def _whole(points: Sequence[Vec], stiffness: Sequence[Matrix], tape: Tape) -> list[list[sympy.Expr]]:
    """K, lower triangle: the sum of [S, .; P x S, P x S x P']."""
    blocks = []
    for point, matrix in zip(points, stiffness, strict=True):
        columns = [tape.vector("lever", cross(point, row)) for row in matrix]
        rows = [_vector([column[i] for column in columns]) for i in range(3)]
        blocks.append([*([*row] for row in matrix), *([*row, *cross(point, row)] for row in rows)])
    return [[tape.let("K", sympy.Add(*(block[i][j] for block in blocks))) for j in range(i + 1)] for i in range(6)]


def _inverse(matrix: Sequence[sympy.Expr], tape: Tape) -> Matrix:
    """C^-1 of a symmetric 3 x 3 matrix, by its adjugate."""
    rows = [_vector(matrix[3 * i :]) for i in range(3)]
    minors = [tape.vector("minor", cross(rows[(i + 1) % 3], rows[(i + 2) % 3])) for i in range(3)]
    share = tape.let("share", 1 / dot(rows[0], minors[0]))
    first, second, third = (tape.vector("stiffness", scaled(share, minor)) for minor in minors)
    return first, second, third


def _wrench(point: Vec, force: Vec) -> tuple[sympy.Expr, ...]:
    return (*force, *cross(point, force))


def _held(force: Vec, normal: Vec, mu: sympy.Expr, tape: Tape) -> sympy.Basic:
    """Whether the force lies in the foot's cone."""
    push = tape.let("push", dot(force, normal))
    tangent = minus(force, scaled(push, normal))
    return both(at_most(0, push), at_most(dot(tangent, tangent), (1 + _SLACK) * (mu * push) ** 2))


def _all(truths: Sequence[sympy.Basic]) -> sympy.Basic:
    together = truths[0]
    for truth in truths[1:]:
        together = both(together, truth)
    return together


def _vector(values: Sequence[sympy.Expr]) -> Vec:
    return (values[0], values[1], values[2])

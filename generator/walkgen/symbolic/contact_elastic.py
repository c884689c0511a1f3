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
    turns = [tape.vector("pulled", cross(point, pull)) for point, pull in zip(points, pulls, strict=True)]
    carried = [tape.let("carried", sympy.Add(*(one[axis] for one in parts))) for parts in (pulls, turns) for axis in range(3)]
    right = [load - part for load, part in zip(values["wrench"], carried, strict=True)]
    delta = solve_symmetric(_whole(points, stiffness, tape), right, tape)
    moved = [tape.vector("moved", plus(_vector(delta), cross(_vector(delta[3:]), point))) for point in points]
    forces = [
        tape.vector("f", scaled(sympy.Integer(-1), times(matrix, plus(move, misfit))))
        for matrix, move, misfit in zip(stiffness, moved, misfits, strict=True)
    ]
    reactions = [tape.vector("turn", cross(point, force)) for point, force in zip(points, forces, strict=True)]
    sums = [sympy.Add(*(vector[axis] for vector in vectors)) for vectors in (forces, reactions) for axis in range(3)]
    lacking = [tape.let("lacking", load + part) for load, part in zip(values["wrench"], sums, strict=True)]
    held = [_held(force, normal, mu, tape) for force, normal, mu in zip(forces, normals, values["mu"], strict=True)]
    states = [tape.let("slides", chosen(truth, 0, 1)) for truth in held]
    status = chosen(at_most(sympy.Add(*states), 0), _OK, _NO_CONVERGENCE)
    given = [symbol for name in ("points", "normals", "wrench", "compliance", "misfit") for symbol in values[name]]
    total = tape.let("total", sympy.Add(*(tape.let("sum", sympy.Add(*given[i : i + 6])) for i in range(0, len(given), 6))))
    rough = tape.let("rough", sympy.Add(*(tape.let("rubs", chosen(at_most(0, mu), 1, 0)) for mu in values["mu"])))  # it may be infinite
    status = chosen(both(Finite(total), at_most(count, rough)), status, _BAD_INPUT)
    violation = sympy.sqrt(sympy.Add(*(part**2 for part in lacking)))
    return tape.function(sized, [*(part for force in forces for part in force), status, *states, *delta, violation])


def _whole(points: Sequence[Vec], stiffness: Sequence[Matrix], tape: Tape) -> list[list[sympy.Expr]]:
    """K, lower triangle: the sum of [S, .; P x S, P x S x P']."""
    blocks = []
    for point, matrix in zip(points, stiffness, strict=True):
        columns = [tape.vector("lever", cross(point, row)) for row in matrix]
        rows = [_vector([column[i] for column in columns]) for i in range(3)]
        corner = [tape.vector("corner", cross(point, row)) for row in rows]
        blocks.append([*([*row] for row in matrix), *([*row, *end] for row, end in zip(rows, corner, strict=True))])
    return [[tape.let("K", sympy.Add(*(block[i][j] for block in blocks))) for j in range(i + 1)] for i in range(6)]


def _inverse(matrix: Sequence[sympy.Expr], tape: Tape) -> Matrix:
    """C^-1 of a symmetric 3 x 3 matrix, by its adjugate."""
    rows = [_vector(matrix[3 * i :]) for i in range(3)]
    minors = [tape.vector("minor", cross(rows[(i + 1) % 3], rows[(i + 2) % 3])) for i in range(3)]
    share = tape.let("share", 1 / dot(rows[0], minors[0]))
    first, second, third = (tape.vector("stiffness", scaled(share, minor)) for minor in minors)
    return first, second, third


def _held(force: Vec, normal: Vec, mu: sympy.Expr, tape: Tape) -> sympy.Basic:
    """Whether the force lies in the foot's cone."""
    push = tape.let("push", dot(force, normal))
    tangent = tape.vector("tangent", minus(force, scaled(push, normal)))
    return both(at_most(0, push), at_most(tape.let("tangent2", dot(tangent, tangent)), (1 + _SLACK) * (mu * push) ** 2))


def _vector(values: Sequence[sympy.Expr]) -> Vec:
    return (values[0], values[1], values[2])

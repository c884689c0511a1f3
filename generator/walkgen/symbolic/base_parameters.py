"""The fewest inertial parameters of a leg: their values, and what a unit of each asks of the joints."""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

import sympy

from walkgen.model.mechanism import Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.symbolic.frames import Frame, parameter_symbols
from walkgen.symbolic.minimal import Motions, Parameter, minimal
from walkgen.symbolic.newton_euler import NewtonEuler
from walkgen.symbolic.regressor import Regressor
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.tape import DIGITS, Vec
from walkgen.symbolic.tape_values import tape_values
from walkgen.symbolic.tree import Tree

_STRETCHES = (Fraction(1), Fraction(13, 11), Fraction(7, 9))
_TURNING, _SLIDING = (1, 2, 5, 6, 7, 8, 9), (0, 1, 2, 3)
"""What giving back to the parent leaves: all but mass, mz and xx, or mass and first moment."""


def base_regressor(
    mechanism: Mechanism, motion: NewtonEuler, gravity: Vec, spread: Spread, candidates: Sequence[Parameter], motions: Motions
) -> tuple[list[tuple[sympy.Expr, ...]], list[sympy.Expr]]:
    """Regressor, rows by q, and values of the parameters that stay.

    Args:
        mechanism: for its runtime parameters.
        motion: of one leg.
        gravity: in the base's axes.
        spread: from q to the tree's coordinates.
        candidates: all parameters that may matter, base to tip.
        motions: how the links can move.
    """
    tree, tape = motion.turning.tree, motion.tape
    samples = [tape_values(tape, given) for given in _samples(mechanism)]
    builder, columns, values = Regressor(motion), [], []
    for combination in minimal(tree, gravity, candidates, samples, motions):
        index, number = combination.kept
        columns.append(builder.efforts(spread, index, number, Frame()))
        others = sympy.Add(*(_factor(factor) * _entry(tree, other) for other, factor in combination.others))
        values.append(tape.let(f"p_{tree.links[index].name}_{number}", _entry(tree, combination.kept) + others))
    return list(zip(*columns, strict=True)), values


def kept_by_regrouping(tree: Tree) -> list[Parameter]:
    """Of a tree that was regrouped without regard to its inertias' values."""
    return [(index, number) for index, link in enumerate(tree.links) for number in (_TURNING if link.revolute else _SLIDING)]


def _samples(mechanism: Mechanism) -> Iterator[dict[sympy.Symbol, Any]]:
    """Runtime parameters at and beside their defaults."""
    values, symbols = defaults(mechanism), parameter_symbols(mechanism)
    for stretch in _STRETCHES[: len(_STRETCHES) if values else 1]:
        yield {symbols[name]: value * stretch.numerator / stretch.denominator for name, value in values.items()}


def _entry(tree: Tree, parameter: Parameter) -> sympy.Expr:
    index, number = parameter
    inertia = tree.links[index].inertia
    entries: Sequence[sympy.Expr] = (inertia.mass, *inertia.moment, *inertia.tensor)
    return entries[number]


def _factor(number: Any) -> sympy.Expr:
    """A sampled factor; halves are meant exactly."""
    half = CONTEXT.nint(2 * number)
    if abs(2 * number - half) < CONTEXT.mpf(10) ** -30:
        return sympy.Rational(int(half), 2)
    return sympy.Float(CONTEXT.nstr(number, DIGITS), DIGITS)

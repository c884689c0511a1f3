"""Quintic splines through points of a plane: knots at the chords' lengths, the start's direction given, the end natural."""

from collections.abc import Sequence
from itertools import pairwise
from math import factorial, sqrt
from typing import NamedTuple

Pair = tuple[float, float]
DEGREE = 5
_COUNT = DEGREE + 1


class Segment(NamedTuple):
    """Between two knots: coefficients of x and y by powers of lambda - start, lowest first."""

    start: float
    end: float
    x: tuple[float, ...]
    y: tuple[float, ...]


def quintic(points: Sequence[Pair], direction: Pair) -> tuple[Segment, ...]:
    """The spline, four times continuously differentiable, whose first derivative at its first point is the unit `direction`.

    At the start the third derivative is 0, at the end the third and fourth are.

    Raises:
        ValueError: two points next to each other are one.
    """
    spans = [sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2) for a, b in pairwise(points)]
    if not all(span > 0.0 for span in spans):
        raise ValueError("two points next to each other are one")
    x, y = (_coefficients(spans, [point[axis] for point in points], direction[axis]) for axis in (0, 1))
    knots = [sum(spans[:count]) for count in range(len(spans) + 1)]
    return tuple(Segment(knots[k], knots[k + 1], x[k], y[k]) for k in range(len(spans)))


def _coefficients(spans: Sequence[float], values: Sequence[float], slope: float) -> list[tuple[float, ...]]:
    """Of every segment, from a linear system; each segment runs over [0, 1] there, so that its rows are of one size."""
    count = len(spans)
    rows: list[list[float]] = []
    right: list[float] = []

    def equation(terms: Sequence[tuple[int, Sequence[float]]], value: float) -> None:
        row = [0.0] * (_COUNT * count)
        for segment, entries in terms:
            row[_COUNT * segment : _COUNT * segment + _COUNT] = list(entries)
        rows.append(row)
        right.append(value)

    for k, span in enumerate(spans):
        equation([(k, _derivative(0, 0.0, 1.0))], values[k])
        equation([(k, _derivative(0, 1.0, 1.0))], values[k + 1])
        if k:
            for order in range(1, DEGREE):
                before, after = _derivative(order, 1.0, spans[k - 1] / span), _derivative(order, 0.0, 1.0)
                equation([(k - 1, before), (k, [-entry for entry in after])], 0.0)
    equation([(0, _derivative(1, 0.0, 1.0))], slope * spans[0])
    equation([(0, _derivative(3, 0.0, 1.0))], 0.0)
    equation([(count - 1, _derivative(3, 1.0, 1.0))], 0.0)
    equation([(count - 1, _derivative(4, 1.0, 1.0))], 0.0)
    solution = _solved(rows, right)
    own = (solution[_COUNT * k : _COUNT * k + _COUNT] for k in range(count))
    return [tuple(entry / span**power for power, entry in enumerate(part)) for part, span in zip(own, spans, strict=True)]


def _derivative(order: int, at: float, stretch: float) -> list[float]:
    """Of the powers over [0, 1], in units in which the next segment's own are: its length over this one's, to the order."""
    return [
        (factorial(power) / factorial(power - order)) * at ** (power - order) / stretch**order if power >= order else 0.0
        for power in range(_COUNT)
    ]


def _solved(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Elimination with the largest pivot of every column."""
    size = len(matrix)
    for k in range(size):
        best = max(range(k, size), key=lambda row: abs(matrix[row][k]))
        matrix[k], matrix[best], right[k], right[best] = matrix[best], matrix[k], right[best], right[k]
        for row in range(k + 1, size):
            if factor := matrix[row][k] / matrix[k][k]:
                matrix[row] = [a - factor * b for a, b in zip(matrix[row], matrix[k], strict=True)]
                right[row] -= factor * right[k]
    found = [0.0] * size
    for k in reversed(range(size)):
        found[k] = (right[k] - sum(matrix[k][j] * found[j] for j in range(k + 1, size))) / matrix[k][k]
    return found

"""Vectors and matrices as lists, over whatever numbers or expressions a peer brings."""

from collections.abc import Sequence
from typing import Any

Vector = list[Any]
Matrix = list[Vector]


def cross(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    return [x + y for x, y in zip(a, b, strict=True)]


def minus(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    return [x - y for x, y in zip(a, b, strict=True)]


def scaled(factor: Any, a: Sequence[Any]) -> Vector:
    return [factor * x for x in a]


def times(matrix: Matrix, vector: Sequence[Any]) -> Vector:
    return [dot(row, vector) for row in matrix]


def transposed(matrix: Matrix) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def product(left: Matrix, right: Matrix) -> Matrix:
    return transposed([times(left, column) for column in transposed(right)])


def outer(a: Sequence[Any], b: Sequence[Any]) -> Matrix:
    return [[x * y for y in b] for x in a]


def turned(axis: int, c: Any, s: Any) -> Matrix:
    """A turn about a coordinate axis."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found: Matrix = [[int(row == column) for column in range(3)] for row in range(3)]
    found[i][i], found[i][j], found[j][i], found[j][j] = c, -s, s, c
    return found

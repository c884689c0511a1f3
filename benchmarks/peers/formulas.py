"""The leg's formulas over any symbolic algebra, so that every peer is given exactly the same expressions to work on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

FORMS = ("dh", "closed")
"""`dh`: what a user writes from the DH rows, and the inverse as the text-book gives it; `closed`: simplified by hand beforehand."""

Vector = list[Any]


@dataclass(frozen=True)
class Algebra:
    """What a peer calls its functions, and how it writes an exact decimal number."""

    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    sqrt: Callable[[Any], Any]
    acos: Callable[[Any], Any]
    atan2: Callable[[Any, Any], Any]
    least: Callable[[Any, Any], Any]
    most: Callable[[Any, Any], Any]
    number: Callable[[str], Any]


def position(algebra: Algebra, q: Sequence[Any], form: str) -> Vector:
    """The foot [3] for the joint angles q [3]."""
    return _position_closed(algebra, q) if form == "closed" else _position_dh(algebra, q)


def _position_dh(algebra: Algebra, q: Sequence[Any]) -> Vector:
    """Classic DH matrices multiplied; the twists' sines and cosines are exact, as a careful user writes them."""
    rows = ((algebra.number("0"), 0, 1, algebra.number("0.12")), (algebra.number("0.35"), 1, 0, 0), (algebra.number("0.40"), 1, 0, 0))
    product: list[Vector] = [[int(i == j) for j in range(4)] for i in range(4)]
    for angle, (a, ca, sa, d) in zip(q, rows, strict=True):
        c, s = algebra.cos(angle), algebra.sin(angle)
        product = _times(product, [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
    return [row[3] for row in product[:3]]


def _times(left: list[Vector], right: list[Vector]) -> list[Vector]:
    return [[sum((row[k] * right[k][j] for k in range(1, 4)), row[0] * right[0][j]) for j in range(4)] for row in left]


def _position_closed(algebra: Algebra, q: Sequence[Any]) -> Vector:
    thigh, shank = algebra.number("0.35"), algebra.number("0.40")
    knee = q[1] + q[2]
    rho = thigh * algebra.cos(q[1]) + shank * algebra.cos(knee)
    height = algebra.number("0.12") + thigh * algebra.sin(q[1]) + shank * algebra.sin(knee)
    return [rho * algebra.cos(q[0]), rho * algebra.sin(q[0]), height]


def inverse_branch(algebra: Algebra, p: Sequence[Any], signs: Sequence[Any], form: str) -> Vector:
    """Joint angles [3] for the foot p [3] on the branch with these signs (rho, knee); clamped, without a status.

    rho = +-sqrt(x^2 + y^2) as the leg's plane holds axis 1; `closed` joins the hip's two atan2 into one, which also wraps it.
    """
    thigh, shank = algebra.number("0.35"), algebra.number("0.40")
    square, z = p[0] * p[0] + p[1] * p[1], p[2] - algebra.number("0.12")
    rho = signs[0] * algebra.sqrt(square)
    ratio = (square + z * z - thigh * thigh - shank * shank) / (2 * thigh * shank)
    cosine = algebra.most(algebra.number("-1"), algebra.least(algebra.number("1"), ratio))
    sine = signs[1] * algebra.sqrt(1 - cosine * cosine)
    along, across = thigh + shank * cosine, shank * sine
    yaw = algebra.atan2(signs[0] * p[1], signs[0] * p[0])
    if form == "closed":
        return [yaw, algebra.atan2(z * along - rho * across, rho * along + z * across), algebra.atan2(sine, cosine)]
    return [yaw, algebra.atan2(z, rho) - algebra.atan2(across, along), signs[1] * algebra.acos(cosine)]


def inverse(algebra: Algebra, p: Sequence[Any], form: str) -> Vector:
    """All four branches [12]."""
    signs = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    return [angle for pair in signs for angle in inverse_branch(algebra, p, pair, form)]

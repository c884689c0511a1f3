"""Arc lengths of directrices by Gauss's rule, with as few nodes as give all digits at the parameters' values."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from walkgen.model.mechanism import Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.directrix import Piece, series
from walkgen.spec.scalar import evaluate, names
from walkgen.spec.taylor import Field

_COUNTS = (1, 4, 6, 8, 10, 12, 14, 16, 20, 24, 32, 48)
_REFERENCE = 64
_WITH_PARAMETERS = 24
"""Nodes where a runtime parameter may change the curve."""
_EXACT = CONTEXT.mpf(10) ** -15
_NEWTON_STEPS = 8
_FIELD = Field(CONTEXT.mpf, +CONTEXT.pi, CONTEXT.sqrt, CONTEXT.sin, CONTEXT.cos, CONTEXT.atan2)


@lru_cache(maxsize=32)
def nodes(count: int) -> tuple[tuple[Any, Any], ...]:
    """Gauss's nodes in [-1, 1], the roots of Legendre's polynomial by Newton's method, with their weights."""
    return tuple(_node(count, number) for number in range(1, count + 1))


def _node(count: int, number: int) -> tuple[Any, Any]:
    place = (
        CONTEXT.cos(CONTEXT.pi * (number - CONTEXT.mpf(1) / 4) / (count + CONTEXT.mpf(1) / 2)) if 2 * number != count + 1 else CONTEXT.zero
    )
    for _ in range(_NEWTON_STEPS):
        value, slope = _legendre(count, place)
        place -= value / slope
    _, slope = _legendre(count, place)
    return place, 2 / ((1 - place**2) * slope**2)


def _legendre(count: int, place: Any) -> tuple[Any, Any]:
    """Legendre's polynomial and its slope, by the three-term recurrence."""
    before, here = CONTEXT.one, place
    for order in range(2, count + 1):
        before, here = here, ((2 * order - 1) * place * here - (order - 1) * before) / order
    return here, count * (place * here - before) / (place**2 - 1)


@lru_cache(maxsize=32)
def node_count(mechanism: Mechanism, pieces: tuple[Piece, ...]) -> int:
    """How many nodes each piece needs for a length from its start on to be right to 15 digits of the whole."""
    if any(names(scalar) - {"lambda"} for piece in pieces for scalar in (piece.x, piece.y, piece.start, piece.end)):
        return _WITH_PARAMETERS
    values = defaults(mechanism)
    return max(_enough(lambda at, piece=piece: _speed(piece, at, values), *_ends(piece, values)) for piece in pieces)  # type: ignore[misc]


def length(mechanism: Mechanism, piece: Piece) -> Any:
    """Of a whole piece, to the last digit but for a few."""
    values = defaults(mechanism)
    return _integral(lambda at: _speed(piece, at, values), *_ends(piece, values), _REFERENCE)


def _ends(piece: Piece, values: dict[str, Any]) -> tuple[Any, Any]:
    return evaluate(piece.start, CONTEXT, values), evaluate(piece.end, CONTEXT, values)


def _speed(piece: Piece, at: Any, values: dict[str, Any]) -> Any:
    x, y = series(piece, at, _FIELD, values, 1)
    return CONTEXT.hypot(x.c[1], y.c[1])


def _enough(speed: Callable[[Any], Any], start: Any, end: Any) -> int:
    whole = _integral(speed, start, end, _REFERENCE)
    near = (count for count in _COUNTS if abs(_integral(speed, start, end, count) - whole) <= _EXACT * whole)
    return next(near, _COUNTS[-1])


def _integral(speed: Callable[[Any], Any], start: Any, end: Any, count: int) -> Any:
    half, middle = (end - start) / 2, (end + start) / 2
    return half * sum(weight * speed(middle + half * place) for place, weight in nodes(count))

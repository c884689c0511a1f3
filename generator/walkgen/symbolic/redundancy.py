"""Joints of a leg that another joint makes superfluous everywhere: found at random poses, for no closed form survives them."""

import math
import random
from collections.abc import Sequence

from walkgen.symbolic.links import Screw
from walkgen.symbolic.tape import Vec

_NONE = 1e-9
_POSES = 3

_Point = tuple[float, float, float]


def superfluous(screws: Sequence[Screw], foot: Vec) -> tuple[int, ...]:
    """Indices of joints that may stay at 0: the leg reaches no less without them.

    A joint that never moves the foot; the first of two that always move it alike (axes that coincide, parallel slides); a slide in the
    plane or line of the others of a leg that only slides. Runtime parameters count as random numbers.
    """
    kept = list(range(len(screws)))
    while len(kept) > 1 and (index := _idle([screws[joint] for joint in kept], foot)) is not None:
        del kept[index]
    return tuple(joint for joint in range(len(screws)) if joint not in kept)


def _idle(screws: Sequence[Screw], foot: Vec) -> int | None:
    generator = random.Random(len(screws))  # noqa: S311 (poses, not secrets)
    samples = [_columns(screws, foot, [generator.uniform(-2, 2) for _ in screws]) for _ in range(_POSES)]
    joints = range(len(screws))
    for joint in joints:
        if all(_rank([columns[joint]]) == 0 for columns in samples):
            return joint
    for first in joints:
        if any(all(_rank([columns[first], columns[other]]) == 1 for columns in samples) for other in range(first + 1, len(screws))):
            return first
    sliding = all(screw.kind == "P" for screw in screws)
    return 0 if sliding and _rank(samples[0]) < len(screws) else None


def _columns(screws: Sequence[Screw], foot: Vec, q: Sequence[float]) -> list[_Point]:
    """How the foot moves with each joint, in the frame before the first."""
    point, columns = _numbers(foot), list[_Point]()
    for screw, value in zip(reversed(screws), reversed(q), strict=True):
        axis, centre = _numbers(screw.axis), _numbers(screw.point)
        if screw.kind == "P":
            point = _sum(point, axis, value)
            columns.insert(0, axis)
            continue
        columns = [_turned(axis, value, column) for column in columns]
        arm = _turned(axis, value, _sum(point, centre, -1.0))
        point = _sum(centre, arm, 1.0)
        columns.insert(0, _cross(axis, arm))
    return columns


def _numbers(vector: Vec) -> _Point:
    """The vector's value, each runtime parameter some number of its own."""
    found = []
    for item in vector:
        some = {symbol: random.Random(str(symbol)).uniform(0.3, 1.2) for symbol in item.free_symbols}  # noqa: S311
        found.append(complex(item.subs(some)).real)
    return found[0], found[1], found[2]


def _rank(columns: Sequence[_Point]) -> int:
    """By Gram and Schmidt, relative to 1."""
    basis: list[_Point] = []
    for column in columns:
        for direction in basis:
            column = _sum(column, direction, -_dot(column, direction))  # noqa: PLW2901
        length = math.sqrt(_dot(column, column))
        if length > _NONE:
            basis.append(_sum((0.0, 0.0, 0.0), column, 1 / length))
    return len(basis)


def _turned(axis: _Point, angle: float, vector: _Point) -> _Point:
    sideways = _cross(axis, vector)
    along = _sum((0.0, 0.0, 0.0), axis, _dot(axis, vector))
    return _sum(_sum(along, _sum(vector, along, -1.0), math.cos(angle)), sideways, math.sin(angle))


def _cross(a: _Point, b: _Point) -> _Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: _Point, b: _Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _sum(a: _Point, b: _Point, factor: float) -> _Point:
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]

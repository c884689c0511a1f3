"""Which inertial parameters of a leg matter, and how the others add to them: by the energies that a unit of each has.

Columns of energy are sampled at random states with 50 digits. A parameter whose energies are a combination of those of links
nearer to the base does the same to the joints (Gautier and Khalil 1990: energy functions).
"""

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from walkgen.model.walk import CONTEXT
from walkgen.symbolic.regressor import unit_inertia
from walkgen.symbolic.tape import IDENTITY, Columns, Vec
from walkgen.symbolic.tape_values import value
from walkgen.symbolic.tree import BASE, Link, Tree

_NEGLIGIBLE = CONTEXT.mpf(10) ** -30
_SPARE_SAMPLES = 4

Matrix = Any
"""An mpmath matrix."""
Values = Mapping[sympy.Symbol, Any]
Parameter = tuple[int, int]
"""Link and number of the parameter in `PARAMETERS`."""


@dataclass(frozen=True)
class Combination:
    """A parameter that stays, and what else counts with it: (parameter, factor)."""

    kept: Parameter
    others: tuple[tuple[Parameter, Any], ...]


Motions = Callable[[Values, random.Random], list[tuple[Any, Any]]]
"""A random value and rate of every link's joint, for the symbols' values."""


def minimal(
    tree: Tree, gravity: Vec, candidates: Sequence[Parameter], samples: Sequence[Mapping[sympy.Symbol, Any]], motions: Motions
) -> tuple[Combination, ...]:
    """The candidates that are independent, nearest to the base first, and the rest as parts of them.

    Args:
        tree: one leg's links; their inertias do not matter.
        gravity: in the base's axes.
        candidates: parameters in the links' frames, base to tip.
        samples: values of the symbols, once for every set of runtime parameters; a candidate is dropped only if it depends on the
            others by the same factors for all.
        motions: how the links can move.
    """
    found = [_dependences(_energies(tree, gravity, candidates, known, motions), len(candidates)) for known in samples]
    factors = {column: first for column, first in found[0].items() if all(_same(first, other.get(column)) for other in found[1:])}
    kept = [column for column in range(len(candidates)) if column not in factors]
    combinations = []
    for column in kept:
        others = [(candidates[other], row[column]) for other, row in factors.items() if abs(row.get(column, 0)) > _NEGLIGIBLE]
        combinations.append(Combination(candidates[column], tuple(others)))
    return tuple(combinations)


def free_motions(tree: Tree) -> Motions:
    """Of joints that move on their own."""

    def pair(generator: random.Random) -> tuple[Any, Any]:
        q, rate = (CONTEXT.mpf(generator.randrange(-2000, 2000)) / 1000 for _ in range(2))
        return q, rate

    return lambda _, generator: [pair(generator) for _ in tree.links]


def _same(one: dict[int, Any], other: dict[int, Any] | None) -> bool:
    return other is not None and all(abs(one.get(key, 0) - other.get(key, 0)) < _NEGLIGIBLE for key in one.keys() | other.keys())


# ---- energies of units -----------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _State:
    """A link's axes and origin in the base, spin and velocity of the origin in its own axes."""

    axes: list[list[Any]]
    origin: list[Any]
    spin: list[Any]
    velocity: list[Any]


def _energies(tree: Tree, gravity: Vec, candidates: Sequence[Parameter], known: Values, motions: Motions) -> list[list[Any]]:
    """Kinetic energies at random states, and differences of potential energy: a column a candidate."""
    generator = random.Random(len(candidates))  # noqa: S311 (states, not secrets)
    down = _numbers(gravity, known)
    rows: list[list[Any]] = []
    first: list[Any] = []
    for _ in range(len(candidates) + _SPARE_SAMPLES):
        states = _states(tree, known, motions(known, generator))
        rows.append([_kinetic(states[link], number) for link, number in candidates])
        potential = [_potential(states[link], number, down) for link, number in candidates]
        first = first or potential
        rows.append([here - there for here, there in zip(potential, first, strict=True)])
    return rows


def _states(tree: Tree, known: Values, motions: Sequence[tuple[Any, Any]]) -> list[_State]:
    still = [CONTEXT.mpf(0)] * 3
    base = _State([_numbers(axis, known) for axis in IDENTITY], still, still, still)
    found: list[_State] = []
    for link, motion in zip(tree.links, motions, strict=True):
        before = base if link.parent == BASE else found[link.parent]
        after = None if link.parent == BASE else tree.links[link.parent]
        found.append(_moved(link, after, before, motion, known))
    return found


def _moved(link: Link, parent: Link | None, before: _State, motion: tuple[Any, Any], known: Values) -> _State:
    """Past one joint; the link's axes follow its parent's turned by the difference of their offsets if they share a group."""
    turn: Columns = link.turn or IDENTITY
    turned = [_numbers(axis, known) for axis in turn]
    inherited = value(parent.offset, known) if parent and link.turn is None else CONTEXT.mpf(0)
    q, rate = (link.sense * amount for amount in motion)
    angle = value(link.offset, known) - inherited + (q if link.revolute else 0)
    cosine, sine = CONTEXT.cos(angle), CONTEXT.sin(angle)
    x, y, z = turned
    own = [[cosine * a + sine * b for a, b in zip(x, y, strict=True)], [cosine * b - sine * a for a, b in zip(x, y, strict=True)], z]
    lever = [way + (0 if link.revolute else q * along) for way, along in zip(_numbers(link.origin, known), z, strict=True)]
    swing = [a + b for a, b in zip(before.velocity, _cross(before.spin, lever), strict=True)]
    spin, velocity = ([_dot(axis, vector) for axis in own] for vector in (before.spin, swing))
    (spin if link.revolute else velocity)[2] += rate
    origin = [a + b for a, b in zip(before.origin, _outwards(before.axes, lever), strict=True)]
    return _State([_outwards(before.axes, axis) for axis in own], origin, spin, velocity)


def _kinetic(state: _State, number: int) -> Any:
    unit = unit_inertia(number)
    moment, columns = ([CONTEXT.mpf(int(entry)) for entry in entries] for entries in (unit.moment, unit.tensor))
    xx, yy, zz, xy, xz, yz = columns
    wx, wy, wz = state.spin
    turning = (xx * wx * wx + yy * wy * wy + zz * wz * wz) / 2 + xy * wx * wy + xz * wx * wz + yz * wy * wz
    return int(unit.mass) * _dot(state.velocity, state.velocity) / 2 + _dot(state.velocity, _cross(state.spin, moment)) + turning


def _potential(state: _State, number: int, down: list[Any]) -> Any:
    unit = unit_inertia(number)
    arm = _outwards(state.axes, [CONTEXT.mpf(int(entry)) for entry in unit.moment])
    return -int(unit.mass) * _dot(down, state.origin) - _dot(down, arm)


def _numbers(vector: Vec, known: Values) -> list[Any]:
    return [value(component, known) for component in vector]


def _dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def _outwards(axes: Sequence[Sequence[Any]], vector: Sequence[Any]) -> list[Any]:
    return [_dot([axis[row] for axis in axes], vector) for row in range(3)]


# ---- elimination ---------------------------------------------------------------------------------------------------------------------


def _dependences(rows: list[list[Any]], count: int) -> dict[int, dict[int, Any]]:
    """Columns that are combinations of earlier ones: by column, the factors of those."""
    pivots: list[int] = []
    found: dict[int, dict[int, Any]] = {}
    for column in range(count):
        start = len(pivots)
        best = max(range(start, len(rows)), key=lambda row: abs(rows[row][column]))
        if abs(rows[best][column]) < _NEGLIGIBLE:
            found[column] = {pivot: rows[index][column] for index, pivot in enumerate(pivots)}
            continue
        rows[start], rows[best] = rows[best], rows[start]
        _reduce(rows, start, column)
        pivots.append(column)
    return found


def _reduce(rows: list[list[Any]], pivot: int, column: int) -> None:
    """Gauss and Jordan: the pivot's row scaled to 1, its column cleared in all others; left of it the row is 0."""
    scale = rows[pivot][column]
    ahead = [entry / scale for entry in rows[pivot][column:]]
    rows[pivot][column:] = ahead
    for index, row in enumerate(rows):
        if index != pivot and row[column] != 0:
            factor = row[column]
            row[column:] = [entry - factor * one if one else entry for entry, one in zip(row[column:], ahead, strict=True)]

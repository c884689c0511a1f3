"""How much of its drives' limits a linkage assembles in, and how many freedoms it has there, on a grid before any code is written."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import atan2, pi

import numpy as np

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Program
from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.mobility import Loops, Mobility, loops_of
from walkgen.spec.scalar import evaluate
from walkgen.symbolic.assembly import assembled_poses

_MOST_POINTS = 441
"""21 for each of two drives."""
_FEWEST = 3
Drives = tuple[float, ...]


@dataclass(frozen=True)
class Failure:
    """A dyad that is the first that cannot close at `count` points, all between `low` and `high` of the drives."""

    dyad: str
    count: int
    low: Drives
    high: Drives


@dataclass(frozen=True)
class Assembly:
    """Of a linkage on a grid.

    Attributes:
        points: of the grid.
        assembled: at how many the linkage assembles.
        failing: what fails at the others, the most first.
        limited: whether the grid is over the drives' limits; else those without any were taken all around, or as far as the links are long.
        best: the drives where it is furthest from all dead points; None where it assembles nowhere.
        mobility: there, by rank; None where it has no pose.
    """

    points: int
    assembled: int
    failing: tuple[Failure, ...]
    limited: bool
    best: Drives | None
    mobility: Mobility | None


def assembly(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Assembly:
    """Of a leg's linkage, runtime parameters at their defaults."""
    values = defaults(mechanism)
    loops = loops_of(linkage.structure, linkage.points, linkage.angles, lambda scalar: float(evaluate(scalar, CONTEXT, values)))
    program = lower(assembled_poses(mechanism, leg, linkage), fma=False)
    assert loops is not None
    assert isinstance(program, Program)
    drives = leg.joints[len(leg.serial) :]
    spans = [_span(drive, linkage, loops.size, values) for drive in drives]
    param = {"param": [float(value) for value in values.values()]} if values else {}
    found = {q: interpret(program, {"q": list(q), **param}) for q in _grid(spans)}
    names = [group.name for group in linkage.forward.groups]
    failing = {q: _failing(outputs["margins"], names) for q, outputs in found.items()}
    closed = [q for q, name in failing.items() if not name]
    best = max(closed, key=lambda q: min(found[q]["margins"], default=0.0), default=None)
    mobility = _mobility(found[best]["poses"], best, loops) if best is not None else None
    return Assembly(len(found), len(closed), _failures(failing), all(drive.limits for drive in drives), best, mobility)


def _span(drive: Joint, linkage: Linkage, size: float, values: dict[str, float]) -> tuple[float, float]:
    """The drive's limits, else all around or the links' size."""
    if drive.limits is not None:
        low, high = (float(evaluate(limit, CONTEXT, values)) for limit in drive.limits)
        return low, high
    if drive.kind == "revolute":
        return -pi, pi
    bars = {linkage.structure.names[bar] for bar in linkage.structure.bars}
    return (0.0, 2 * size) if drive.name in bars else (-size, size)


def _grid(spans: Sequence[tuple[float, float]]) -> Iterator[Drives]:
    nodes = max(_FEWEST, round(_MOST_POINTS ** (1 / len(spans))))
    return product(*([low + (high - low) * step / (nodes - 1) for step in range(nodes)] for low, high in spans))


def _failing(margins: list[float], names: list[str]) -> str:
    """The first dyad that cannot close; empty where all do."""
    return next((name for name, margin in zip(names, margins, strict=True) if not margin >= 0), "")


def _failures(failing: dict[Drives, str]) -> tuple[Failure, ...]:
    places: dict[str, list[Drives]] = {}
    for q, name in failing.items():
        if name:
            places.setdefault(name, []).append(q)
    found = [Failure(name, len(where), *_box(where)) for name, where in places.items()]
    return tuple(sorted(found, key=lambda failure: -failure.count))


def _box(where: list[Drives]) -> tuple[Drives, Drives]:
    columns = list(zip(*where, strict=True))
    return tuple(map(min, columns)), tuple(map(max, columns))


def _mobility(poses: list[float], drives: Drives, loops: Loops) -> Mobility | None:
    """By x, y and angle of every body but the frame and lengths of driven cylinders; None where pins that coincide leave no pose."""
    rows = [poses[start : start + 4] for start in range(4, len(poses), 4)]
    placed = [entry for x, y, cosine, sine in rows for entry in (x, y, atan2(sine, cosine))]
    unknowns = np.array([*placed, *drives[len(drives) - len(loops.structure.bars) :]])
    return loops.mobility(unknowns) if np.isfinite(unknowns).all() else None

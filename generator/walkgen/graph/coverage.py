"""How much of its drives' limits a linkage assembles in, and how many freedoms it has there, on a grid before any code is written."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import atan2, pi

import numpy as np
from numpy.typing import NDArray

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.mobility import FreeLinkage, Mobility, free_linkage
from walkgen.spec.scalar import evaluate
from walkgen.symbolic.linkage_poses import CloseTriads, LinkagePoses
from walkgen.symbolic.starts import start_of

_MOST_POINTS = 441
"""21 for each of two drives."""
_FEWEST = 3
Drives = tuple[float, ...]


@dataclass(frozen=True)
class Failure:
    """A dyad or triad that is the first that cannot close at `count` points, all between `low` and `high` of the drives."""

    group: str
    count: int
    low: Drives
    high: Drives


@dataclass(frozen=True)
class Coverage:
    """Of a linkage on a grid.

    Attributes:
        points: of the grid.
        assembled: at how many the linkage assembles.
        failing: what fails at the others, the most first.
        limited: whether the grid is over the drives' limits; else those without any were taken all around, or as far as the links are long.
        bounded: whether the drives can go nowhere else: those without limits turn.
        best: the drives where it is furthest from all dead points; None where it assembles nowhere.
        mobility: there, by rank; None where it has no pose.
        startless: the triads, where they have no assembly to start from; then there is no grid.
    """

    points: int
    assembled: int
    failing: tuple[Failure, ...]
    limited: bool
    bounded: bool
    best: Drives | None
    mobility: Mobility | None
    startless: tuple[str, ...] = ()


def coverage(mechanism: Mechanism, leg: Limb, linkage: Linkage, close_triads: CloseTriads) -> Coverage:
    """Of a leg's linkage, runtime parameters at their defaults.

    Args:
        mechanism: the robot.
        leg: one of its legs.
        linkage: the leg's.
        close_triads: the solve of triads, `walkgen.runtime.solves.triads.close_triads`.
    """
    drives, triads = leg.drives, tuple(triad.name for triad in linkage.forward.triads)
    limited, bounded = all(drive.limits for drive in drives), all(drive.limits or drive.kind == "revolute" for drive in drives)
    start = start_of(mechanism, leg) if triads else None
    if triads and start is None:
        return Coverage(0, 0, (), limited, bounded, None, None, triads)
    values = defaults(mechanism)
    loops = free_linkage(linkage.structure, linkage.points, linkage.angles, lambda scalar: float(evaluate(scalar, CONTEXT, values)))
    assert loops is not None
    grid = list(_grid([_span(drive, linkage, loops.size, values) for drive in drives]))
    margins, poses = LinkagePoses(mechanism, leg, start, close_triads).at(np.array(grid))
    names = [group.name for group in linkage.forward.groups]
    failing = [_failing(row, names) for row in margins]
    closed = [place for place, name in enumerate(failing) if not name]
    best = max(closed, key=lambda place: min(margins[place], default=0.0), default=None)
    mobility = None if best is None else _mobility(poses[best], grid[best], loops)
    failures = _failures(dict(zip(grid, failing, strict=True)))
    return Coverage(len(grid), len(closed), failures, limited, bounded, None if best is None else grid[best], mobility)


def titled(linkage: Linkage, name: str) -> str:
    """A group of a linkage, with its kind."""
    return f"{'triad' if name in {triad.name for triad in linkage.forward.triads} else 'dyad'} {name}"


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


def _failing(margins: Sequence[float], names: Sequence[str]) -> str:
    """The first group that cannot close; empty where all do."""
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


def _mobility(poses: NDArray[np.float64], drives: Drives, loops: FreeLinkage) -> Mobility | None:
    """By x, y and angle of every body but the frame and lengths of driven cylinders; None where pins that coincide leave no pose."""
    placed = [entry for x, y, cosine, sine in poses[1:] for entry in (x, y, atan2(sine, cosine))]
    unknowns = np.array([*placed, *drives[len(drives) - len(loops.structure.bars) :]])
    return loops.mobility(unknowns) if np.isfinite(unknowns).all() else None

"""How much of its drives' limits a linkage assembles in: its groups' margins, evaluated on a grid before any code is written."""

from collections import Counter
from dataclasses import dataclass
from itertools import product

import numpy as np

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Program
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.scalar import evaluate
from walkgen.symbolic.assembly import Assemble, assembly_margins, margins_at
from walkgen.symbolic.starts import start_of

_MOST_POINTS = 441
"""21 for each of two drives."""
_FEWEST = 3


@dataclass(frozen=True)
class Coverage:
    """Points of the grid, at how many the linkage assembles, and at how many each group is the first that cannot close, the most first."""

    points: int
    assembled: int
    failing: tuple[tuple[str, int], ...]


def coverage(mechanism: Mechanism, leg: Limb, assemble: Assemble) -> Coverage | None:
    """Over the limits of the drives, runtime parameters at their defaults; None where there is no linkage or a drive has no limits, unless
    one of its triads assembles nowhere.

    Args:
        mechanism: the robot.
        leg: one of its legs.
        assemble: the solve of triads, `walkgen.runtime.solves.assembly.assemble`.
    """
    linkage = leg.linkage
    if linkage is None:
        return None
    triads = linkage.forward.triads
    start = start_of(mechanism, leg) if triads else None
    if triads and start is None:
        return Coverage(1, 0, ((triads[0].name, 1),))
    values = defaults(mechanism)
    limits = [joint.limits for joint in leg.joints[len(leg.serial) :]]
    spans = [tuple(float(evaluate(limit, CONTEXT, values)) for limit in pair) for pair in limits if pair is not None]
    if len(spans) < len(limits):
        return None
    nodes = max(_FEWEST, round(_MOST_POINTS ** (1 / len(spans))))
    points = list(product(*([low + (high - low) * step / (nodes - 1) for step in range(nodes)] for low, high in spans)))
    by_start = start and margins_at(mechanism, leg, start, np.array(points), assemble).tolist()
    margins = by_start or _margins(mechanism, leg, points)
    names = [group.name for group in linkage.forward.groups]
    failures = Counter(_failing(row, names) for row in margins)
    assembled = failures.pop("", 0)
    return Coverage(len(points), assembled, tuple(failures.most_common()))


def _margins(mechanism: Mechanism, leg: Limb, points: list[tuple[float, ...]]) -> list[list[float]]:
    """Of dyads alone."""
    program, values = lower(assembly_margins(mechanism, leg), fma=False), defaults(mechanism)
    assert isinstance(program, Program)
    param = {"param": [float(value) for value in values.values()]} if values else {}
    return [interpret(program, {"q": q, **param})["margins"] for q in points]


def _failing(margins: list[float], names: list[str]) -> str:
    """The first group that cannot close; empty where all do."""
    return next((name for name, margin in zip(names, margins, strict=True) if not margin >= 0), "")


def titled(leg: Limb, name: str) -> str:
    """A group of a leg's linkage, with its kind."""
    triads = [triad.name for triad in leg.linkage.forward.triads] if leg.linkage else []
    return f"{'triad' if name in triads else 'dyad'} {name}"

"""How much of its drives' limits a linkage assembles in: its dyads' margins, evaluated on a grid before any code is written."""

from collections import Counter
from dataclasses import dataclass
from itertools import product

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Program
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.scalar import evaluate
from walkgen.symbolic.assembly import assembly_margins

_MOST_POINTS = 441
"""21 for each of two drives."""
_FEWEST = 3


@dataclass(frozen=True)
class Coverage:
    """Points of the grid, at how many the linkage assembles, and at how many each dyad is the first that cannot close, the most first."""

    points: int
    assembled: int
    failing: tuple[tuple[str, int], ...]


def coverage(mechanism: Mechanism, leg: Limb) -> Coverage | None:
    """Over the limits of the drives, runtime parameters at their defaults; None where there is no linkage or a drive has no limits."""
    values = defaults(mechanism)
    limits = [joint.limits for joint in leg.joints[len(leg.serial) :]]
    spans = [tuple(float(evaluate(limit, CONTEXT, values)) for limit in pair) for pair in limits if pair is not None]
    if leg.linkage is None or len(spans) < len(limits):
        return None
    names = [group.name for group in leg.linkage.forward.groups]
    program = lower(assembly_margins(mechanism, leg, leg.linkage), fma=False)
    assert isinstance(program, Program)
    nodes = max(_FEWEST, round(_MOST_POINTS ** (1 / len(spans))))
    axes = [[low + (high - low) * step / (nodes - 1) for step in range(nodes)] for low, high in spans]
    param = {"param": [float(value) for value in values.values()]} if values else {}
    failures = Counter(_failing(interpret(program, {"q": q, **param})["margins"], names) for q in product(*axes))
    assembled = failures.pop("", 0)
    return Coverage(nodes ** len(spans), assembled, tuple(failures.most_common()))


def _failing(margins: list[float], names: list[str]) -> str:
    """The first dyad that cannot close; empty where all do."""
    return next((name for name, margin in zip(names, margins, strict=True) if margin < 0), "")

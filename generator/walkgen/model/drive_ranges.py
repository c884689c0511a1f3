"""Between which values the drives of a linkage are looked at where a few values have to stand for all."""

from typing import Any

from walkgen.model.linkage import Linkage
from walkgen.model.loops import DrivenLoops
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults, number


def drive_ranges(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> list[tuple[Any, Any]]:
    """The limits; without any a full turn, a way on a guide or a length of the linkage's size."""
    size, turning = reach(mechanism, linkage), len(linkage.driven)
    found = []
    for place, joint in enumerate(leg.drives):
        if joint.limits:
            low, high = (number(limit, mechanism) for limit in joint.limits)
        elif joint.kind == "revolute":
            low, high = -CONTEXT.pi, +CONTEXT.pi
        else:
            low, high = (-size / 2, size / 2) if place < turning else (size / 4, 5 * size / 4)
        found.append((low, high))
    return found


def reach(mechanism: Mechanism, linkage: Linkage) -> Any:
    """The largest coordinate of any point of any link (m)."""
    return CONTEXT.mpf(DrivenLoops(linkage, defaults(mechanism), [0] * linkage.drive_count).reach)

"""How many branches the position inverse of a leg has: it decides how many names a spec may give them."""

from collections.abc import Sequence
from itertools import product

from walkgen.spec.assur import SIDES, Order, Structure, order

BRANCHED_JOINTS = 3
"""Joints of a leg whose foot position leaves finitely many solutions, in general."""
MODES = 6
"""Assemblies of a triad, at most."""
CURVE_BRANCHES = tuple(f"root_{number}" for number in range(1, 9))
"""Of a leg whose foot follows a coupler curve."""
CARRIED_BRANCHES = tuple(f"root_{number}" for number in range(1, 17))
"""Of a leg whose foot follows a coupler curve that two joints carry."""


def branch_count(kinds: str) -> int:
    """How many isolated solutions a leg with these joints (R and P, base to foot) has at most; 0 for more than three joints."""
    turning = kinds.count("R")
    if len(kinds) > BRANCHED_JOINTS:
        return 0
    if len(kinds) == 1 or turning == 0:
        return 1
    return 4 if len(kinds) == BRANCHED_JOINTS and turning > 1 else 2


def follows_curve(structure: Structure, joints: int) -> bool:
    """Whether one drive leads the foot along a curve, which at most one joint before the linkage carries."""
    return structure.drive_count == 1 and joints <= 1


def carries_curve(structure: Structure, joints: int) -> bool:
    """Whether one drive leads the foot along a curve, which dyads alone make, and two joints, before the linkage or after it, carry it."""
    return structure.drive_count == 1 and joints == BRANCHED_JOINTS - 1 and not order(structure).triads


def linkage_hindrance(structure: Structure, foot: int, kinds: str, after: str = "") -> str:
    """What keeps a leg with a linkage from an inverse in closed form; empty where nothing does.

    Args:
        structure: a linkage that its drives place.
        foot: the link that bears the foot, or the joints after the linkage.
        kinds: joints before the linkage, R and P.
        after: those after it.
    """
    if after and (kinds or len(after) > 1):
        return f"joints before the linkage ({kinds or 'none'}) and after it ({after}): one after it and none before has a closed form"
    if kinds not in ("", "R"):
        return f"{len(kinds)} joints ({kinds}) before the linkage: one that turns, or none, has a closed form"
    if structure.drive_count != 2:
        return f"{structure.drive_count} drives do not place the foot in the plane: two do"
    if after and order(structure).triads:
        return f"a joint ({after}) follows a linkage with triads: rows have one or the other"
    return _back_hindrance(structure, order(structure.released(foot)), most=0 if after else 1)


def _back_hindrance(structure: Structure, back: Order, most: int) -> str:
    """What keeps a held foot from leading back to the drives, by groups of which `most` may be triads."""
    if len(back.triads) > most == 0:
        return f"with the foot held {back.triads[0].name} is part of a triad, which rows with a joint after the linkage have not"
    if len(back.triads) > 1:
        return f"with the foot held {back.triads[0].name} and {back.triads[1].name} are parts of two triads: rows have one at most"
    if len(back.clusters) > 1:
        stuck = " + ".join(sorted(structure.names[min(cluster)] for cluster in back.clusters))
        return f"with the foot held no dyad is left to place: {stuck} form a group of more than four links"
    return ""


def linkage_choices(structure: Structure, foot: int, joints: Sequence[str]) -> tuple[tuple[str, ...], ...]:
    """What a branch of the inverse chooses: the two ways of each joint before the linkage, the sides of the dyads back, a triad's mode."""
    back = order(structure.released(foot))
    sides = (tuple(f"{group.name}_{side}" for side in SIDES[group.kind]) for group in back.dyads if SIDES[group.kind])
    modes = (tuple(f"{triad.name}_{number}" for number in range(1, MODES + 1)) for triad in back.triads)
    return (*((f"{joint}_plus", f"{joint}_minus") for joint in joints), *sides, *modes)


def linkage_branches(choices: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Names of all branches in their order."""
    return tuple("_".join(choice) for choice in product(*choices)) if choices else ("only",)

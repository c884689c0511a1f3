"""How many branches the position inverse of a leg has: it decides how many names a spec may give them."""

from collections.abc import Sequence
from itertools import product

from walkgen.spec.assur import SIDES, Structure, order

BRANCHED_JOINTS = 3
"""Joints of a leg whose foot position leaves finitely many solutions, in general."""
CURVE_BRANCHES = tuple(f"root_{number}" for number in range(1, 9))
"""Of a leg whose foot follows a coupler curve."""


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


def linkage_hindrance(structure: Structure, foot: int, kinds: str) -> str:
    """What keeps a leg that ends in a linkage from an inverse in closed form; empty where nothing does.

    Args:
        structure: a linkage that its drives place.
        foot: the link that bears the foot.
        kinds: joints before the linkage, R and P.
    """
    if kinds not in ("", "R"):
        return f"{len(kinds)} joints ({kinds}) before the linkage: one that turns, or none, has a closed form"
    triads = order(structure).triads
    if triads:
        return f"the drives hold the triad {triads[0].name}: which of its assemblies a row has is not known"
    if structure.drive_count != 2:
        return f"{structure.drive_count} drives do not place the foot in the plane: two do"
    back = order(structure.released(foot))
    if back.triads:
        return f"with the foot held no dyad is left to place: {back.triads[0].name} is part of a triad"
    if len(back.clusters) > 1:
        stuck = " + ".join(sorted(structure.names[min(cluster)] for cluster in back.clusters))
        return f"with the foot held no dyad is left to place: {stuck} form a group of more than four links"
    return ""


def linkage_choices(structure: Structure, foot: int, joints: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """What a branch of the inverse chooses: the two ways of each joint before the linkage, then the sides of the dyads back."""
    groups = [group for group in order(structure.released(foot)).groups if SIDES[group.kind]]
    sides = ((f"{group.name}_{SIDES[group.kind][0]}", f"{group.name}_{SIDES[group.kind][1]}") for group in groups)
    return (*((f"{joint}_plus", f"{joint}_minus") for joint in joints), *sides)


def linkage_branches(choices: Sequence[tuple[str, str]]) -> tuple[str, ...]:
    """Names of all branches in their order."""
    return tuple("_".join(choice) for choice in product(*choices)) if choices else ("only",)

"""How many branches the position inverse of a leg has: it decides how many names a spec may give them."""

BRANCHED_JOINTS = 3
"""Joints of a leg whose foot position leaves finitely many solutions, in general."""


def branch_count(kinds: str) -> int:
    """How many isolated solutions a leg with these joints (R and P, base to foot) has at most; 0 for more than three joints."""
    turning = kinds.count("R")
    if len(kinds) > BRANCHED_JOINTS:
        return 0
    if len(kinds) == 1 or turning == 0:
        return 1
    return 4 if len(kinds) == BRANCHED_JOINTS and turning > 1 else 2

"""ssik: analytical inverse of six and seven joints; what it says to a leg is kept."""

from collections.abc import Iterable

import numpy as np
import ssik

from chains import Array
from peers.solver import UNSEEDED, Refuse, Solver, refusal
from problems import Problem

_SLOTS = 8
_ROWS = 512


def solvers(problem: Problem, refuse: Refuse) -> Iterable[Solver]:
    """All solutions of a pose."""
    if "P" in problem.chain.kinds:
        refuse("ssik", "not tried: Manipulator.from_dh says 'All joints revolute; the joint variable is the Z rotation.'")
        return
    lengths, twists, offsets, turns = map(np.array, zip(*problem.chain.rows, strict=True))
    assert not turns.any()
    words = refusal(lambda: ssik.Manipulator.from_dh(twists, lengths, offsets))
    if words:
        refuse("ssik", words)
        return
    arm, joints = ssik.Manipulator.from_dh(twists, lengths, offsets), len(turns)

    def solve(row: int, _: Array) -> Array:
        answers = arm.solve(problem.poses[row], respect_limits=False)
        return np.array([answer.q for answer in answers]).reshape(-1, joints)

    yield Solver("ssik", "all solutions", UNSEEDED, _SLOTS, solve=solve, rows=_ROWS)

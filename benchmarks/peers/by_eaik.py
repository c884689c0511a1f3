"""EAIK: the inverse of whole poses; for a leg's position it has to be given the rotation that only the answer knows."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from eaik.IK_DH import DhRobot

from chains import Array
from peers.solver import UNSEEDED, Refuse, Solver, refusal
from problems import Problem

_SLOTS = 8


def solvers(problem: Problem, refuse: Refuse) -> Iterable[Solver]:
    """The pose that the joint values made; for a position also the pose without turning. Least-squares answers do not count."""
    if "P" in problem.chain.kinds:
        refuse("EAIK", "not tried: DhRobot(dh_alpha, dh_a, dh_d) has no word for a sliding joint")
        return
    lengths, twists, offsets, turns = map(np.array, zip(*problem.chain.rows, strict=True))
    assert not turns.any()
    robot = DhRobot(twists, lengths, offsets)
    words = refusal(lambda: robot.IK(problem.poses[0]))
    if words:
        refuse("EAIK", words)
        return
    yield Solver("EAIK", "given the whole pose", UNSEEDED, _SLOTS, solve=_caller(robot.IK, problem.poses))
    if problem.posed:
        return
    refuse("EAIK, a position [3]", refusal(lambda: robot.IK(problem.targets[0])))
    level = np.tile(np.eye(4), (len(problem.targets), 1, 1))
    level[:, :3, 3] = problem.targets
    yield Solver("EAIK", "given the position", UNSEEDED, _SLOTS, solve=_caller(robot.IK, level))


def _caller(call: Callable[[Array], Any], poses: Array) -> Callable[[int, Array], Array]:
    def solve(row: int, _: Array) -> Array:
        answer = call(poses[row])
        rows = np.array(answer.Q).reshape(answer.num_solutions(), -1)
        return rows[~np.array(answer.is_LS, bool)] if len(rows) else rows

    return solve

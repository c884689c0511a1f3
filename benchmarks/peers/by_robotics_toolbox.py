"""Robotics Toolbox: Levenberg-Marquardt with a mask for position-only targets, in Python (ikine_LM) and in its C++ (ik_LM)."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import roboticstoolbox as rtb
from spatialmath import SE3

from chains import Array
from peers.solver import SEEDS, Refuse, Solver, refusal
from problems import Problem

_ROWS = 256
_TOLERANCES = {"its tolerance": 1e-6, "1e-9 m": 1e-19}
"""Of half the squared error: as it comes, and as exact as everyone else."""


def _link(kind: str, row: tuple[float, float, float, float]) -> Any:
    length, twist, offset, turn = row
    if kind == "R":
        return rtb.RevoluteDH(a=length, alpha=twist, d=offset, offset=turn)
    return rtb.PrismaticDH(a=length, alpha=twist, theta=turn, offset=offset, qlim=[0.0, 0.5])


def solvers(problem: Problem, refuse: Refuse) -> Iterable[Solver]:
    """Both solvers with both tolerances; a foot position is given as a pose without turning, masked."""
    robot = rtb.DHRobot([_link(kind, row) for kind, row in zip(problem.chain.kinds, problem.chain.rows, strict=True)])
    masks = {} if problem.posed else {"mask": [1, 1, 1, 0, 0, 0]}
    poses = problem.poses if problem.posed else np.array([SE3(*target).A for target in problem.targets])
    slow = "not measured: it accepts this arm, and its symbolic derivation takes tens of seconds"
    refuse("Robotics Toolbox ikine_analytic", slow if problem.posed else refusal(lambda: robot.ikine_analytic(poses[0])))
    for method in ("ikine_LM", "ik_LM"):
        for name, tolerance in _TOLERANCES.items():
            call = _caller(getattr(robot, method), poses, {**masks, "tol": tolerance})
            yield Solver("Robotics Toolbox", f"{method}, {name}", SEEDS, 1, solve=call, rows=_ROWS)


def _caller(method: Callable[..., Any], poses: Array, options: dict[str, Any]) -> Callable[[int, Array], Array]:
    def solve(row: int, seed: Array) -> Array:
        answer = method(poses[row], q0=seed, **options)
        return np.asarray(answer.q)[None] if answer.success else seed[None][:0]

    return solve

"""The damped Newton's method of newton.cpp on Pinocchio's Python bindings."""

from collections.abc import Callable, Iterable

import numpy as np
import pinocchio

from chains import Array, Chain
from peers.solver import SEEDS, Refuse, Solver
from problems import Problem

_MOST_STEPS, _CLOSE, _LEAST_DAMPING = 100, 1e-10, 1e-12
_ROWS = 512


def _placement(row: tuple[float, float, float, float]) -> pinocchio.SE3:
    length, twist, offset, turn = row
    along = pinocchio.SE3(pinocchio.utils.rotate("z", turn), np.array([0.0, 0.0, offset]))
    return along * pinocchio.SE3(pinocchio.utils.rotate("x", twist), np.array([length, 0.0, 0.0]))


def _model(chain: Chain) -> tuple[pinocchio.Model, int]:
    """The chain and its foot's frame."""
    model, last, before = pinocchio.Model(), 0, pinocchio.SE3.Identity()
    kinds = {"R": pinocchio.JointModelRZ, "P": pinocchio.JointModelPZ}
    for number, (kind, row) in enumerate(zip(chain.kinds, chain.rows, strict=True)):
        last = model.addJoint(last, kinds[kind](), before, f"joint{number}")
        before = _placement(row)
    return model, model.addFrame(pinocchio.Frame("foot", last, 0, before, pinocchio.FrameType.OP_FRAME))


def _linearised(problem: Problem) -> Callable[[int, Array], tuple[Array, Array]]:
    """Error and Jacobian of a target at q."""
    model, foot = _model(problem.chain)
    data = model.createData()
    frame = pinocchio.LOCAL if problem.posed else pinocchio.LOCAL_WORLD_ALIGNED
    wanted = [pinocchio.SE3(pose) for pose in problem.poses[:_ROWS]]

    def at(q: Array) -> tuple[pinocchio.SE3, Array]:
        pinocchio.computeJointJacobians(model, data, q)
        reached = pinocchio.updateFramePlacement(model, data, foot)
        return reached, pinocchio.getFrameJacobian(model, data, foot, frame)

    def position(row: int, q: Array) -> tuple[Array, Array]:
        reached, jacobian = at(q)
        return problem.targets[row] - reached.translation, jacobian[:3]

    def pose(row: int, q: Array) -> tuple[Array, Array]:
        reached, jacobian = at(q)
        missing = reached.actInv(wanted[row])
        return pinocchio.log6(missing).vector, pinocchio.Jlog6(missing.inverse()) @ jacobian

    return pose if problem.posed else position


def solvers(problem: Problem, _: Refuse) -> Iterable[Solver]:
    """Damped steps."""
    linearised, unit = _linearised(problem), np.eye(len(problem.chain.kinds))

    def solve(row: int, seed: Array) -> Array:
        q = seed.copy()
        for _ in range(_MOST_STEPS + 1):
            error, jacobian = linearised(row, q)
            square = error @ error
            if square <= _CLOSE**2:
                return q[None]
            q += np.linalg.solve(jacobian.T @ jacobian + (0.5 * square + _LEAST_DAMPING) * unit, jacobian.T @ error)
        return q[None][:0]

    yield Solver("Pinocchio", "damped Newton, Python", SEEDS, 1, solve=solve, rows=_ROWS)

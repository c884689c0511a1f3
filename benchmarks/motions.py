"""The functions of benchmarks/dynamics.py, the varied inputs of every contestant, and the right answers to them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np
import pinocchio

from leg import Array, Inputs, LegFunction, frames
from multibody import Robot, leg_robot, mero_robot, numbers

SEED = 20240307
TOLERANCE = 1e-9
"""Of the largest number of a function's answer, or of 1."""

Ports = tuple[tuple[str, int], ...]
Named = Mapping[str, Array]


@dataclass(frozen=True)
class DynamicFunction(LegFunction):
    """One measured function: its robot, names and sizes of its input ports, and those that Pinocchio takes the same motion in."""

    robot: str = ""
    inputs: Ports = ()
    native: Ports = ()


_LEG = (("q", 3), ("qd", 3))
_EFFORTS: Ports = (*_LEG, ("qdd", 3), ("f", 3))
_ACCELERATIONS: Ports = (*_LEG, ("tau", 3), ("f", 3))
_MERO = (("base_pose", 16), ("q", 24))
_NATIVE = (("configuration", 31), ("velocity", 30), ("acceleration", 30))
"""Position, quaternion and joints, depth first."""
_PUSH = ("push", 6)
"""The foot's force as a wrench in the last joint's axes."""
_RATES: Ports = (("q_bent", 3), ("v", 3), ("a", 3))
"""Poses where the foot can move in every direction."""

FUNCTIONS = (
    DynamicFunction("leg_inverse_dynamics", "3R leg, inverse dynamics", (3,), False, "leg", _EFFORTS, (*_EFFORTS[:3], _PUSH)),
    DynamicFunction("leg_mass_matrix", "3R leg, mass matrix", (9,), False, "leg", _LEG[:1], _LEG[:1]),
    DynamicFunction("leg_forward_dynamics", "3R leg, forward dynamics", (3,), False, "leg", _ACCELERATIONS, (*_ACCELERATIONS[:3], _PUSH)),
    DynamicFunction("leg_bias_acceleration", "3R leg, Jdot qd", (6,), False, "leg", _LEG, _LEG),
    DynamicFunction("leg_inverse_rates", "3R leg, inverse of velocity and acceleration", (6,), False, "leg", _RATES, _RATES),
    DynamicFunction(
        "mero_inverse_dynamics",
        "mero, inverse dynamics",
        (30,),
        False,
        "mero",
        (*_MERO, ("v", 30), ("a", 30), ("foot_forces", 18)),
        _NATIVE,
    ),
    DynamicFunction("mero_mass_matrix", "mero, mass matrix", (900,), False, "mero", _MERO, _NATIVE[:1]),
)


@dataclass(frozen=True)
class MotionRows(Inputs):
    """Inputs of one function; `q` is all ports side by side [rows,width], what single calls read."""

    sizes: tuple[int, ...] = ()

    def rows(self, function: LegFunction) -> Array:
        del function
        return self.q

    @cached_property
    def blocks(self) -> Array:
        """Port after port, each [rows,size]: what batches read."""
        return np.concatenate([port.ravel() for port in self.ports])

    @property
    def ports(self) -> list[Array]:
        return np.split(self.q, list(accumulate(self.sizes[:-1])), axis=1)


def draw(function: DynamicFunction, rows: int, native: bool = False) -> MotionRows:
    """Varied motions, the same for every run of the same size; foot forces of mero are zero, since Pinocchio is called without."""
    random = np.random.default_rng(SEED)
    makers = _LEG_PORTS if function.robot == "leg" else _MERO_PORTS
    drawn = {name: maker(random, rows) for name, maker in makers.items()}
    chosen = function.native if native else function.inputs
    if native:
        drawn |= {"push": _pushes(drawn)} if function.robot == "leg" else _depth_first(drawn)
    q = np.ascontiguousarray(np.hstack([drawn[name] for name, _ in chosen]))
    return MotionRows(q, np.zeros(rows, np.int32), tuple(size for _, size in chosen))


Maker = Callable[[np.random.Generator, int], Array]


def _spread(low: Any, high: Any, size: int) -> Maker:
    return lambda random, rows: random.uniform(low, high, (rows, size))


def _poses(random: np.random.Generator, rows: int) -> Array:
    """base_pose [rows,16]: any attitude."""
    found = np.broadcast_to(np.eye(4), (rows, 4, 4)).copy()
    quaternions = random.normal(size=(rows, 4))
    for pose, (w, x, y, z) in zip(found, quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True), strict=True):
        pose[:3, :3] = pinocchio.Quaternion(w, x, y, z).matrix()
    found[:, :3, 3] = random.uniform(-1, 1, (rows, 3))
    return found.reshape(rows, 16)


def _depth_first(drawn: Named) -> dict[str, Array]:
    """The same motions with a quaternion, joints depth first."""
    order = np.array(mero_robot().depth_first)
    poses = drawn["base_pose"].reshape(-1, 4, 4)
    quaternions = [pinocchio.Quaternion(np.ascontiguousarray(pose[:3, :3])).coeffs() for pose in poses]
    rates = {name: np.hstack([drawn[port][:, :6], drawn[port][:, 6 + order]]) for name, port in (("velocity", "v"), ("acceleration", "a"))}
    return {"configuration": np.hstack([poses[:, :3, 3], np.array(quaternions), drawn["q"][:, order]]), **rates}


def _pushes(drawn: Named) -> Array:
    """Force and moment about the last joint's origin, in its axes [rows,6]."""
    leg, found = leg_robot(), np.empty((len(drawn["q"]), 6))
    (foot,) = leg.feet
    for q, force, push in zip(drawn["q"], drawn["f"], found, strict=True):
        pinocchio.forwardKinematics(leg.model, leg.data, q)
        push[:3] = leg.data.oMi[foot.body + 1].rotation.T @ force
        push[3:] = np.cross(numbers(foot.place), push[:3])
    return found


_LEG_PORTS: dict[str, Maker] = {
    "q": _spread(*np.radians([[-60, -90, -150], [60, 90, 0]]), 3),
    "qd": _spread(-3, 3, 3),
    "qdd": _spread(-20, 20, 3),
    "tau": _spread(-20, 20, 3),
    "f": _spread(-50, 50, 3),
    "q_bent": _spread(*np.radians([[-60, 0, -110], [60, 60, -40]]), 3),
    "v": _spread(-1, 1, 3),
    "a": _spread(-5, 5, 3),
}
_MERO_PORTS: dict[str, Maker] = {
    "base_pose": _poses,
    "q": _spread(-0.7, 0.7, 24),
    "v": _spread(-2, 2, 30),
    "a": _spread(-10, 10, 30),
    "foot_forces": _spread(0, 0, 18),
}


def expected(function: DynamicFunction, rows: int) -> Array:
    """Right answers [rows,size]: Pinocchio's, from Python, joints in the order of q; of rates, those of leg.py's matrices."""
    inputs = draw(function, rows, native=True)
    named = (dict(zip(dict(function.native), row, strict=True)) for row in zip(*inputs.ports, strict=True))
    answer = _ANSWERS[function.name]
    return np.array([np.ravel(answer(row)) for row in named])


def places() -> tuple[int, ...]:
    """Where Pinocchio's components of mero's velocity are in walkgen's."""
    return (*range(6), *(6 + index for index in mero_robot().depth_first))


def _leg_efforts(row: Named) -> Array:
    leg = leg_robot()
    return np.array(pinocchio.rnea(leg.model, leg.data, row["q"], row["qd"], row["qdd"], _wrenches(row)))


def _leg_accelerations(row: Named) -> Array:
    leg = leg_robot()
    return np.array(pinocchio.aba(leg.model, leg.data, row["q"], row["qd"], row["tau"], _wrenches(row)))


def _jacobian(q: Array) -> tuple[Array, Array]:
    """The foot's columns [3,joint] and the axes [3,joint], in the base's axes, by leg.py's matrices."""
    chain = frames(q[None])[0]
    axes = chain[:3, :3, 2]
    return np.cross(axes, chain[3, :3, 3] - chain[:3, :3, 3]).T, axes.T


def _bias(q: Array, qd: Array) -> Array:
    """Linear and angular acceleration at constant rates: columns and axes as they are turned by the joints before them."""
    columns, axes = _jacobian(q)
    found = np.zeros(6)
    for joint in range(3):
        spin = axes[:, :joint] @ qd[:joint]
        found[3:] += np.cross(spin, axes[:, joint]) * qd[joint]
        found[:3] += 2 * np.cross(spin, columns[:, joint]) * qd[joint] + np.cross(axes[:, joint], columns[:, joint]) * qd[joint] ** 2
    return found


def _rates(row: Named) -> Array:
    q = row["q_bent"]
    columns, _ = _jacobian(q)
    qd = np.linalg.solve(columns, row["v"])
    return np.concatenate([qd, np.linalg.solve(columns, row["a"] - _bias(q, qd)[:3])])


def _wrenches(row: Named) -> Any:
    found = pinocchio.StdVec_Force([pinocchio.Force.Zero() for _ in range(leg_robot().model.njoints)])
    found[3] = pinocchio.Force(row["push"])
    return found


def _mero_efforts(row: Named) -> Array:
    mero, found = mero_robot(), np.empty(30)
    found[list(places())] = pinocchio.rnea(mero.model, mero.data, row["configuration"], row["velocity"], row["acceleration"])
    return found


def _mero_matrix(row: Named) -> Array:
    mero, found, order = mero_robot(), np.empty((30, 30)), list(places())
    found[np.ix_(order, order)] = _matrix(mero, row["configuration"])
    return found


def _matrix(of: Robot, q: Array) -> Array:
    upper = np.triu(pinocchio.crba(of.model, of.data, q))
    return upper + np.triu(upper, 1).T


_ANSWERS: dict[str, Callable[[Named], Array]] = {
    "leg_inverse_dynamics": _leg_efforts,
    "leg_mass_matrix": lambda row: _matrix(leg_robot(), row["q"]),
    "leg_forward_dynamics": _leg_accelerations,
    "leg_bias_acceleration": lambda row: _bias(row["q"], row["qd"]),
    "leg_inverse_rates": _rates,
    "mero_inverse_dynamics": _mero_efforts,
    "mero_mass_matrix": _mero_matrix,
}


def error(answer: Array, right: Array) -> float:
    """The largest difference, of the largest number of the answers or of 1."""
    scale = max(1.0, float(np.max(np.abs(right))))
    return float(np.max(np.abs(answer - right))) / scale if np.all(np.isfinite(answer)) else float("nan")

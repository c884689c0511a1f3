"""Forward kinematics of any path: what is computed from joint values, rates and accelerations, and by which equation."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import chain

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Argument, Port, Signature
from walkgen.symbolic.driven import DrivenKinematics, kinematics_of
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Derivation, Function, Solve, Step
from walkgen.symbolic.path import Kinematics, Path
from walkgen.symbolic.ports import joint_port, joint_unit, signature
from walkgen.symbolic.tape import Columns, Tape, Vec, dot, plus, symbols_of

Exprs = Sequence[sympy.Expr]
_POSE_TAIL = (sympy.S.Zero, sympy.S.Zero, sympy.S.Zero, sympy.S.One)


@dataclass(frozen=True)
class Motion:
    """What a builder works with: the path's kinematics and the symbols of the joint rates and accelerations."""

    kinematics: Kinematics | DrivenKinematics
    qd: Exprs
    qdd: Exprs
    force: Exprs


@dataclass(frozen=True)
class Entry:
    """One generated function of a path: its ports for a joint count, its builder, its words."""

    inputs: tuple[str, ...]
    outputs: Callable[[Sequence[Joint]], tuple[Port, ...]]
    build: Callable[[Motion], Exprs]
    doc: str
    source: str


def flat(matrix: Sequence[Vec]) -> tuple[sympy.Expr, ...]:
    """Row-major elements of a matrix given by columns."""
    return tuple(column[row] for row in range(3) for column in matrix)


def pose(columns: Columns, origin: Vec) -> tuple[sympy.Expr, ...]:
    """Row-major elements of an ordinary homogeneous matrix, the 1 last."""
    rows = ((*(column[row] for column in columns), origin[row]) for row in range(3))
    return (*chain.from_iterable(rows), *_POSE_TAIL)


def _spatial(motion: Motion) -> Exprs:
    return (*flat(motion.kinematics.jacobian), *flat(motion.kinematics.angular))


def _hessian(motion: Motion) -> Exprs:
    count = len(motion.qd)
    pairs = {(i, j): motion.kinematics.second(i, j) for i in range(count) for j in range(i, count)}
    return tuple(pairs[min(i, j), max(i, j)][row] for row in range(3) for i in range(count) for j in range(count))


def _rates(columns: Sequence[Vec], rates: Exprs) -> Vec:
    x, y, z = (dot([column[row] for column in columns], rates) for row in range(3))
    return (x, y, z)


def _acceleration(motion: Motion) -> Exprs:
    return plus(_rates(motion.kinematics.jacobian, motion.qdd), motion.kinematics.bias(motion.qd)[0])


def _frames(motion: Motion) -> Exprs:
    return tuple(chain.from_iterable(pose(columns, origin) for columns, origin in motion.kinematics.frames))


def _torque(motion: Motion) -> Exprs:
    return tuple(dot(column, motion.force) for column in motion.kinematics.jacobian)


def _port(name: str, unit: str, *shape: int) -> Callable[[Sequence[Joint]], tuple[Port, ...]]:
    """A port whose shape's -1 is the joint count, -2 the count of frames."""
    return lambda joints: (Port(name, tuple({-1: len(joints), -2: len(joints) + 1}.get(size, size) for size in shape), unit),)


def _per_joint(name: str, unit: str, *shape: int) -> Callable[[Sequence[Joint]], tuple[Port, ...]]:
    return lambda joints: _port(name, unit.replace("q", joint_unit(joints)), *shape)(joints)


_EQ_1 = "eq. (1): p = A_0 A_1 ... A_n p_n"
_EQ_J = "J_i = D_i p, D_i = (A_0 ... A_(i-1)) Q_i (A_0 ... A_(i-1))^-1"
_EQ_H = "H_ij = D_min(i,j) D_max(i,j) p"

FOOT: dict[str, Entry] = {
    "foot_position": Entry(("q",), _port("p", "m", 3), lambda m: m.kinematics.position, "Foot position.", _EQ_1),
    "foot_rotation": Entry(
        ("q",), _port("R", "1", 3, 3), lambda m: flat(m.kinematics.rotation), "Foot rotation: columns are the foot's axes.", _EQ_1
    ),
    "foot_pose": Entry(
        ("q",),
        _port("T", "1 and m", 4, 4),
        lambda m: pose(m.kinematics.rotation, m.kinematics.position),
        "Foot pose, homogeneous with the 1 last.",
        _EQ_1,
    ),
    "foot_jacobian": Entry(
        ("q",), _per_joint("J", "m/(q)", 3, -1), lambda m: flat(m.kinematics.jacobian), "Jacobian of the foot position.", _EQ_J
    ),
    "foot_position_jacobian": Entry(
        ("q",),
        lambda joints: (*_port("p", "m", 3)(joints), *_per_joint("J", "m/(q)", 3, -1)(joints)),
        lambda m: (*m.kinematics.position, *flat(m.kinematics.jacobian)),
        "Foot position and its Jacobian.",
        f"{_EQ_1}; {_EQ_J}",
    ),
    "foot_spatial_jacobian": Entry(
        ("q",),
        _per_joint("J", "m/(q) and rad/(q)", 6, -1),
        _spatial,
        "Rows linear then angular, at the foot point, platform axes (LOCAL_WORLD_ALIGNED; not Murray-Li-Sastry's spatial Jacobian).",
        _EQ_J,
    ),
    "foot_hessian": Entry(
        ("q",), _per_joint("H", "m/(q)^2", 3, -1, -1), _hessian, "Second derivatives d2p/dq_i dq_j of the foot position.", _EQ_H
    ),
    "foot_velocity": Entry(("q", "qd"), _port("v", "m/s", 3), lambda m: _rates(m.kinematics.jacobian, m.qd), "Foot velocity J qd.", _EQ_J),
    "foot_acceleration": Entry(("q", "qd", "qdd"), _port("a", "m/s^2", 3), _acceleration, "Foot acceleration J qdd + qd' H qd.", _EQ_H),
    "foot_bias_acceleration": Entry(
        ("q", "qd"),
        _port("a", "m/s^2 and rad/s^2", 6),
        lambda m: tuple(chain.from_iterable(m.kinematics.bias(m.qd))),
        "Jdot qd of the spatial Jacobian, linear then angular.",
        _EQ_H,
    ),
    "foot_torque": Entry(
        ("q", "f"), _port("tau", "N m or N", -1), _torque, "Joint torques J' f that a foot force f does work against.", "virtual work"
    ),
    "joint_frames": Entry(("q",), _port("T", "1 and m", -2, 4, 4), _frames, "The mount, then the frame that moves with each joint.", _EQ_1),
}

CHAIN: dict[str, Entry] = {
    "pose": Entry(
        ("q",),
        _port("T", "1 and m", 4, 4),
        lambda m: pose(m.kinematics.rotation, m.kinematics.position),
        "Child platform in its parent's frame.",
        "eqs. (5)-(7): B A_1 A_2 A_3 E",
    ),
    "jacobian": Entry(
        ("q",),
        _per_joint("J", "m/(q) and rad/(q)", 6, -1),
        _spatial,
        "Rows linear then angular, at the child's origin, in the parent's axes.",
        _EQ_J,
    ),
    "frames": Entry(
        ("q",), _port("T", "1 and m", -2, 4, 4), _frames, "The chain's root, then the frame that moves with each joint.", "eqs. (5)-(7)"
    ),
}


_ROLLING = " The foot is where its sole touches level ground, below the ankle where flat; slopes are those of the foot's point there."
"""Of legs with curved soles."""


@dataclass(frozen=True)
class Route:
    """A path by its owner's name: a leg, a chain, or the chains and the leg from the root platform to a foot."""

    owner: str
    limbs: tuple[Limb, ...]

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The path's joints from base to tip."""
        return tuple(joint for limb in self.limbs for joint in limb.joints)


SIDE = Port("side")
"""1, or -1 where what has it as a factor has the other sign."""


@dataclass(frozen=True)
class Sided:
    """A path that serves two routes, with factors `side` in it, and what that is for one of them."""

    path: Path
    side: Decimal


class PathFunctions:
    """Functions of one path; they share one tape, so what two of them need is derived once. Those of a `sided` one take its side."""

    def __init__(self, mechanism: Mechanism, route: Route, sided: Sided | None = None) -> None:
        self._mechanism, self._route, self._sided = mechanism, route, sided
        joints = route.joints
        self._ports = {
            "q": joint_port("q", joints),
            "qd": joint_port("qd", joints, "/s"),
            "qdd": joint_port("qdd", joints, "/s^2"),
            "f": Port("f", (3,), "N"),
        }
        symbols = {name: symbols_of(port) for name, port in self._ports.items()}
        self.tape = Tape()
        parameters = parameter_symbols(mechanism)
        kinematics = Kinematics(sided.path, self.tape) if sided else kinematics_of(route.limbs, symbols["q"], parameters, self.tape)
        self.motion = Motion(kinematics, symbols["qd"], symbols["qdd"], symbols["f"])

    @property
    def sides(self) -> tuple[Port, ...]:
        """Inputs of what is computed here that are none of the route's functions."""
        return (SIDE,) if self._sided else ()

    def arguments(self, ports: Iterable[Port]) -> tuple[Argument, ...]:
        """Of a step that calls what is computed here: ports by their names, the side by its value."""
        return tuple(self._sided.side if self._sided and port is SIDE else port.name for port in ports)

    def derivation(self, name: str, entry: Entry) -> Derivation:
        """One entry as a function of this path."""
        words = self.words(name, entry)
        if not self._sided:
            return self.function(name, entry)
        kernel = replace(words, inputs=(*words.inputs, SIDE))
        step = Step(self.tape.function(kernel, entry.build(self.motion)), self.arguments((*kernel.inputs, *kernel.outputs)))
        return Solve(words, (), (step,))

    def function(self, name: str, entry: Entry) -> Function:
        """One entry as a Function."""
        return self.tape.function(self.words(name, entry), entry.build(self.motion))

    def words(self, name: str, entry: Entry) -> Signature:
        """What the function of an entry takes and gives."""
        inputs = [self._ports[port] for port in entry.inputs]
        outputs = entry.outputs(self._route.joints)
        doc = entry.doc + (_ROLLING if self._route.limbs[-1].curved_sole and name != "joint_frames" else "")
        return signature(self._mechanism, self._route.owner, name, inputs, outputs, doc, entry.source)

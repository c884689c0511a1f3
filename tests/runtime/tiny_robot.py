"""A robot small enough to check by hand: Programs written op by op, emitted as `walkgen build` would."""

import sysconfig
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path, PurePosixPath

import pytest

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_files import c_sources
from walkgen.emit.casadi_printer import casadi_artifact
from walkgen.emit.manifest import manifest
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.emit.python_loops import python_sources
from walkgen.graph.program import Call, Code, Composite, Op, Program
from walkgen.model.mechanism import Joint, Limb, Mechanism, Motion, Parameter, Platform
from walkgen.signature import Port, Signature
from walkgen.spec.scalar import ONE, ZERO, Scalar, div, exact

needs_headers = pytest.mark.skipif(
    not Path(sysconfig.get_path("include"), "Python.h").exists(), reason="Python's headers are not installed"
)
COMPILED = (pytest.param("direct", marks=needs_headers), "ufunc")
BACKENDS = (*COMPILED, "numpy")
"""Values of WALKGEN_BACKEND that choose one way to call a function."""
QUARTER = div(exact(11), exact(7))
Q = Port("q", (3,), "rad")
STATUS = Port("status", (), "1", "integer")
PARAM = Port("param", (2,))


@dataclass
class Builder:
    """Collects the ops of one Program; its methods return the index of the op they add."""

    signature: Signature
    ops: list[Op] = field(default_factory=list)

    def __post_init__(self) -> None:
        for index, port in enumerate(self.signature.inputs):
            self.ops += [Op(Code.INPUT, element=(index, element)) for element in range(port.size)]

    def op(self, code: Code, *arguments: int) -> int:
        self.ops.append(Op(code, arguments))
        return len(self.ops) - 1

    def number(self, value: str) -> int:
        self.ops.append(Op(Code.CONSTANT, value=Decimal(value)))
        return len(self.ops) - 1

    def program(self, *outputs: int) -> Program:
        return Program(self.signature, tuple(self.ops), outputs)


@dataclass(frozen=True)
class Tiny:
    """What makes one variant of the robot different from another."""

    name: str = "tiny"
    parameters: bool = False
    float32: bool = False
    functions: tuple[str, ...] = ()

    @property
    def tail(self) -> tuple[Port, ...]:
        return (PARAM,) if self.parameters else ()

    def builder(self, owner: str, name: str, inputs: tuple[Port, ...], outputs: tuple[Port, ...]) -> Builder:
        return Builder(Signature(self.name, owner, name, (*inputs, *self.tail), outputs, f"The {name}.", "by hand"))


def foot_position(tiny: Tiny) -> Program:
    """p = (q0 + q1, q1 * q2, cos q2); with parameters p0 is scaled by param[0] and shifted by param[1]."""
    make = tiny.builder("left", "foot_position", (Q,), (Port("p", (3,), "m"),))
    first = make.op(Code.ADD, 0, 1)
    if tiny.parameters:
        first = make.op(Code.ADD, make.op(Code.MUL, first, 3), 4)
    return make.program(first, make.op(Code.MUL, 1, 2), make.op(Code.COS, 2))


def outer(tiny: Tiny) -> Program:
    """H[i, j, k] = q_i q_j + k on [3,3,2], under the name foot_hessian."""
    make = tiny.builder("left", "foot_hessian", (Q,), (Port("H", (3, 3, 2)),))
    products = [make.op(Code.MUL, i, j) for i in range(3) for j in range(3)]
    one = make.number("1")
    return make.program(*(index for product in products for index in (product, make.op(Code.ADD, product, one))))


def position_jacobian(tiny: Tiny) -> Program:
    """Two outputs: p = 2 q and J = q on the diagonal."""
    make = tiny.builder("left", "foot_position_jacobian", (Q,), (Port("p", (3,)), Port("J", (3, 3))))
    zero = make.number("0")
    doubled = [make.op(Code.ADD, i, i) for i in range(3)]
    return make.program(*doubled, *(i if i == j else zero for i in range(3) for j in range(3)))


def torque(tiny: Tiny) -> Program:
    """tau = J f with J [2,3] and f [3], and the scalar offset added: three inputs of different ranks."""
    inputs = (Port("J", (2, 3)), Port("f", (3,), "N"), Port("offset", (), "N m"))
    make = tiny.builder("left", "foot_torque", inputs, (Port("tau", (2,), "N m"),))
    sums = []
    for row in range(2):
        products = [make.op(Code.MUL, 3 * row + column, 6 + column) for column in range(3)]
        sums.append(make.op(Code.ADD, make.op(Code.ADD, make.op(Code.ADD, products[0], products[1]), products[2]), 9))
    return make.program(*sums)


def inverse_branch(tiny: Tiny) -> Program:
    """q = sqrt(p) + branch, status UNREACHABLE where p0 < 0 (the root is taken all the same), BAD_INPUT for branch < 0."""
    inputs = (Port("p", (3,), "m"), Port("branch", (), "1", "integer"))
    make = tiny.builder("left", "inverse_branch", inputs, (Q, STATUS))
    roots = [make.op(Code.ADD, make.op(Code.SQRT, index), 3) for index in range(3)]
    zero, one, two = (make.number(text) for text in "012")
    reach = make.op(Code.SELECT, make.op(Code.LESS, 0, zero), one, zero)
    return make.program(*roots, make.op(Code.SELECT, make.op(Code.LESS, 3, zero), two, reach))


def inverse(tiny: Tiny) -> Program:
    """q [2,3] = (p, -p), status [2] = (OK, UNREACHABLE)."""
    make = tiny.builder("left", "inverse", (Port("p", (3,), "m"),), (Port("q", (2, 3), "rad"), Port("status", (2,), "1", "integer")))
    flipped = [make.op(Code.NEG, index) for index in range(3)]
    return make.program(0, 1, 2, *flipped, make.number("0"), make.number("1"))


def energy(tiny: Tiny) -> Program:
    """Scalar to scalar."""
    make = tiny.builder("left", "potential_energy", (Port("height", (), "m"),), (Port("U", (), "J"),))
    return make.program(make.op(Code.MUL, 0, make.number("9.80665")))


def foot_positions(tiny: Tiny) -> Program:
    """The robot's own: feet [1,3] = q."""
    make = tiny.builder("", "foot_positions", (Q,), (Port("feet", (1, 3), "m"),))
    return make.program(0, 1, 2)


def rest_pose(tiny: Tiny) -> Program:
    """The robot's own, without an input unless there are parameters: platform_poses [1,4,4]."""
    make = tiny.builder("", "platform_poses", (), (Port("poses", (1, 4, 4)),))
    zero, one = make.number("0"), make.number("1")
    return make.program(*(one if row == column else zero for row in range(4) for column in range(4)))


def doubled(tiny: Tiny) -> Composite:
    """A Composite with a support routine and no closed form, so without CasADi: tau = 2 q, solved from 1 tau = 2 q."""
    signature = tiny.builder("left", "gravity_torque", (Q,), (Port("tau", (3,), "N m"),)).signature
    unit, right = Port("unit", (3, 3)), Port("right", (3,))
    make = Builder(Signature(tiny.name, "left", "double", (Q,), (unit, right)))
    twice = [make.op(Code.ADD, i, i) for i in range(3)]
    zero, one = make.number("0"), make.number("1")
    kernel = make.program(*(one if i % 4 == 0 else zero for i in range(9)), *twice)
    damping = (Decimal("0.01"), Decimal("0.01"))
    calls = (Call(kernel, ("q", "unit", "right")), Call("wg_damped_inverse_3", ("unit", "right", *damping, "tau", "state")))
    return Composite(signature, (unit, right, Port("state", kind="integer")), calls, ("walkgen_damped.h",))


_ALL: dict[str, Callable[[Tiny], Program | Composite]] = {
    "foot_position": foot_position,
    "foot_hessian": outer,
    "foot_position_jacobian": position_jacobian,
    "foot_torque": torque,
    "inverse_branch": inverse_branch,
    "inverse": inverse,
    "potential_energy": energy,
    "gravity_torque": doubled,
    "foot_positions": foot_positions,
    "platform_poses": rest_pose,
}


def _mechanism(tiny: Tiny) -> Mechanism:
    turn = (Motion("rotate", 0, QUARTER),)
    limits: tuple[tuple[Scalar, Scalar] | None, ...] = ((exact(-1), ONE), None, (exact(-2), exact(2)))
    joints = tuple(
        Joint(name, "revolute", (), 1, ZERO, (*turn, Motion("translate", 0, ONE)), limit, None, None, None, "", "")
        for name, limit in zip(("yaw", "pitch", "knee"), limits, strict=True)
    )
    parameters = (Parameter("scale", exact(2), "1", None), Parameter("shift", div(ONE, exact(2)), "m", (ZERO, ONE)))
    return Mechanism(
        name=tiny.name,
        description="A robot checked by hand",
        gravity=(ZERO, ZERO, exact(-9)),
        platforms=(Platform("body", None, None),),
        chains=(),
        legs=(Limb("left", 0, (), joints, ()),),
        parameters=parameters if tiny.parameters else (),
        sections=(),
    )


def code_of(tiny: Tiny) -> RobotCode:
    """The robot as the emitters take it."""
    names = tiny.functions or tuple(_ALL)
    return RobotCode(_mechanism(tiny), tuple(_ALL[name](tiny) for name in names), "0" * 64, float32=tiny.float32)


def artifacts(tiny: Tiny) -> Iterator[Artifact]:
    """Every file that the runtime reads."""
    code = code_of(tiny)
    sources = (*c_sources(code), *python_sources(code))
    yield from sources
    yield numpy_artifact(code)
    yield casadi_artifact(code)
    yield manifest(code, sources)


def write(tiny: Tiny, folder: Path) -> Path:
    """Write the robot into `folder`, which is made."""
    folder.mkdir(parents=True)
    for artifact in artifacts(tiny):
        (folder / PurePosixPath(artifact.path)).write_text(artifact.text, encoding="utf-8")
    return folder

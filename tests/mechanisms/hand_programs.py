"""Programs written by hand and robots around them: printers are tested on these before any robot exists."""

from collections.abc import Callable, Sequence
from decimal import Decimal
from math import atan2, copysign, cos, inf, isfinite, isnan, nan, sin, sqrt, tan
from pathlib import Path
from runpy import run_path

from walkgen.emit.artifact import Artifact, Body, RobotCode
from walkgen.graph.program import Code, Op, Program
from walkgen.model.mechanism import Mechanism
from walkgen.signature import Port, Signature
from walkgen.spec.scalar import exact

NUMBERS: dict[Code, tuple[int, Callable[..., float]]] = {
    Code.NEG: (1, lambda a: -a),
    Code.ADD: (2, lambda a, b: a + b),
    Code.SUB: (2, lambda a, b: a - b),
    Code.MUL: (2, lambda a, b: a * b),
    Code.DIV: (2, lambda a, b: a / b if b else nan if a == 0 or isnan(a) else copysign(inf, a) * copysign(1, b)),
    Code.FMA: (3, lambda a, b, c: a * b + c),
    Code.FMS: (3, lambda a, b, c: a * b - c),
    Code.FNMA: (3, lambda a, b, c: c - a * b),
    Code.SQRT: (1, lambda a: sqrt(a) if a >= 0 else nan),
    Code.SIN: (1, lambda a: sin(a) if isfinite(a) else nan),
    Code.COS: (1, lambda a: cos(a) if isfinite(a) else nan),
    Code.TAN: (1, lambda a: tan(a) if isfinite(a) else nan),
    Code.ATAN2: (2, atan2),
    Code.ABS: (1, abs),
    Code.MIN: (2, lambda a, b: a if a < b else b),
    Code.MAX: (2, lambda a, b: a if a > b else b),
    Code.EPSILON: (0, lambda: 2.0**-52),
}
"""What Python's own arithmetic says an operation is: its number of arguments and the function."""

TRUTHS: dict[Code, tuple[int, Callable[..., bool]]] = {
    Code.LESS: (2, lambda a, b: a < b),
    Code.LESS_EQUAL: (2, lambda a, b: a <= b),
    Code.EQUAL: (2, lambda a, b: a == b),
    Code.FINITE: (1, isfinite),
}

VALUES = (0.0, 0.37, -1.25, 2.0, 1e-3, -7.5)
ROWS = tuple((VALUES[i % 6], VALUES[(i // 2) % 6], VALUES[(i // 5 + i) % 6]) for i in range(30))
NAN_ROWS = ((nan, 1.0, 2.0), (1.0, nan, 2.0), (1.0, 2.0, nan), (inf, 1.0, -1.0), (1.0, -inf, 0.5))


def single(code: Code) -> Program:
    """Of x [3], y: one operation on its first elements."""
    count = NUMBERS[code][0]
    return made("single", (Port("x", (3,)),), (Port("y"),), (*inputs(3), Op(code, tuple(range(count)))), (3,))


def chosen(code: Code) -> Program:
    """Of x [3], y: 1 where the comparison of the first elements of x holds, else -1."""
    ops = (*inputs(3), constant(1), constant(-1), Op(code, tuple(range(TRUTHS[code][0]))), Op(Code.SELECT, (5, 3, 4)))
    return made("chosen", (Port("x", (3,)),), (Port("y"),), ops, (6,))


def logic(code: Code) -> Program:
    """Of x [3], y: (x0 < x1) and/or (x1 < x2), or not (x0 < x1), as 1 or 0."""
    arguments = (5,) if code is Code.NOT else (5, 6)
    comparisons = (Op(Code.LESS, (0, 1)), Op(Code.LESS, (1, 2)))
    ops = (*inputs(3), constant(1), constant(0), *comparisons, Op(code, arguments), Op(Code.INDICATOR, (7,)))
    return made("logic", (Port("x", (3,)),), (Port("y"),), ops, (8,))


LOGIC: dict[Code, Callable[[bool, bool], bool]] = {
    Code.AND: lambda a, b: a and b,
    Code.OR: lambda a, b: a or b,
    Code.NOT: lambda a, _: not a,
}


def shapes() -> Program:
    """Ports q [2], T [2,3], s -> p [2], M [2,2], H [2,2,2], status [2], e: every shape of port, elements told apart by their values."""
    ports = (Port("q", (2,), "rad"), Port("T", (2, 3), "m"), Port("s"))
    outputs = (Port("p", (2,)), Port("M", (2, 2)), Port("H", (2, 2, 2)), Port("status", (2,), kind="integer"), Port("e"))
    places = [(0, 0), (0, 1), *((1, i) for i in range(6)), (2, 0)]
    ops = [Op(Code.INPUT, element=place) for place in places] + [constant(index) for index in range(14)]
    ops += [Op(Code.MUL, (8, 9 + index)) for index in range(14)]
    scaled = range(23, 37)
    return made("shapes", ports, outputs, tuple(ops), (0, 1, 2, 4, 5, 7, *scaled[:8], 11, 9, 8))


def guarded_inverse() -> Program:
    """Of x and branch, y and status: 1/x, or NaN and status 2 where x is 0 or branch is not 1."""
    ports = (Port("x", unit="m"), Port("branch", kind="integer"))
    ops = (
        Op(Code.INPUT, element=(0, 0)),
        Op(Code.INPUT, element=(1, 0)),
        constant(0),
        constant(1),
        constant(2),
        Op(Code.CONSTANT, value=Decimal("NaN")),
        Op(Code.DIV, (3, 0), name="inverse of x"),
        Op(Code.EQUAL, (0, 2)),
        Op(Code.EQUAL, (1, 3)),
        Op(Code.NOT, (8,)),
        Op(Code.OR, (7, 9), name="bad"),
        Op(Code.SELECT, (10, 5, 6)),
        Op(Code.SELECT, (10, 4, 2)),
    )
    return made("guarded", ports, (Port("y"), Port("status", kind="integer")), ops, (11, 12))


def long_chain(length: int, outputs: int) -> Program:
    """Of x [2], y [outputs]: nested operations without a name, each on the one before."""
    ops = [*inputs(2), constant(Decimal("0.5"))]
    for index in range(length):
        ops.append(Op((Code.FMA, Code.SIN, Code.SUB)[index % 3], ((len(ops) - 1, 2, 0), (len(ops) - 1,), (len(ops) - 1, 1))[index % 3]))
    return made("long", (Port("x", (2,)),), (Port("y", (outputs,)),), tuple(ops), tuple(range(len(ops) - outputs, len(ops))))


def inputs(count: int) -> tuple[Op, ...]:
    """INPUT ops of one vector port."""
    return tuple(Op(Code.INPUT, element=(0, index)) for index in range(count))


def constant(value: int | Decimal) -> Op:
    """A CONSTANT op."""
    return Op(Code.CONSTANT, value=Decimal(value))


def made(name: str, ports: Sequence[Port], outputs: Sequence[Port], ops: Sequence[Op], found: Sequence[int]) -> Program:
    """A Program of the robot `toy`."""
    return Program(Signature("toy", "leg", name, tuple(ports), tuple(outputs), "By hand.", "eq. (0)"), tuple(ops), tuple(found))


def toy(*bodies: Body, description: str = "A toy") -> RobotCode:
    """A robot without limbs that has these functions."""
    mechanism = Mechanism("toy", description, (exact(0),) * 3, (), (), (), (), ())
    return RobotCode(mechanism, bodies, "0" * 64)


def run(artifact: Artifact, folder: Path) -> dict[str, object]:
    """Write the artifact and execute it; its global names."""
    path = folder / artifact.path
    path.write_text(artifact.text, encoding="utf-8")
    return run_path(str(path))

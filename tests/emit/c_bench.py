"""A workbench for tests of generated C: hand-made Programs, a robot to hang them on, and gcc through subprocess."""

import shutil
import subprocess
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path

import pytest

from walkgen.emit.artifact import Body, RobotCode
from walkgen.emit.c_files import c_sources
from walkgen.graph.program import Code, Op, Program
from walkgen.model.mechanism import Joint, Limb, Mechanism, Motion, Platform
from walkgen.signature import Port, Signature
from walkgen.spec.scalar import ZERO, exact

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror"
STRICT = ("-std=c99", *WARNINGS.split(), "-O2", "-ffp-contract=off")
CPLUSPLUS = ("-std=c++11", "-x", "c++", "-Wall", "-Wextra", "-Werror", "-O1")

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
needs_gplusplus = pytest.mark.skipif(shutil.which("g++") is None, reason="g++ is not installed")


class Builder:
    """Collects ops; every method returns the new op's index."""

    def __init__(self, *ports: Port) -> None:
        self.ports = ports
        self.ops = [Op(Code.INPUT, element=(place, index)) for place, port in enumerate(ports) for index in range(port.size)]

    def add(self, code: Code, *arguments: int, name: str = "") -> int:
        self.ops.append(Op(code, arguments, name=name))
        return len(self.ops) - 1

    def constant(self, text: str) -> int:
        self.ops.append(Op(Code.CONSTANT, value=Decimal(text)))
        return len(self.ops) - 1

    def program(self, name: str, outputs: Sequence[Port], values: Sequence[int], *, robot: str = "bot", doc: str = "") -> Program:
        return Program(Signature(robot, "leg", name, self.ports, tuple(outputs), doc), tuple(self.ops), tuple(values))


def mechanism(name: str = "bot", description: str = "", source_name: str = "") -> Mechanism:
    """One platform with one two-joint leg."""
    after = (Motion("translate", 0, exact(Decimal("0.3"))),)
    limits = (exact(-1), exact(2))
    joints = tuple(
        Joint(joint, "revolute", (), 1, ZERO, after, limits, exact(3), exact(40), None, "", source_name) for joint in ("hip", "knee")
    )
    leg = Limb("leg", 0, (), joints, ())
    return Mechanism(name, description, (ZERO, ZERO, exact(-10)), (Platform("base", None, None),), (), (leg,), (), ())


def code(*bodies: Body, robot: Mechanism | None = None, fma: bool = True, float32: bool = True) -> RobotCode:
    return RobotCode(robot or mechanism(), bodies, "0" * 64, fma=fma, float32=float32)


def write(folder: Path, robot: RobotCode) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for artifact in c_sources(robot):
        (folder / artifact.path).write_text(artifact.text)


def run(*command: str | Path) -> str:
    """Standard output; a failing command fails the test with what it printed."""
    done = subprocess.run([str(part) for part in command], check=False, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, f"{command[0]} failed:\n{done.stdout}\n{done.stderr}"
    return done.stdout


def compile_object(source: Path, *flags: str, compiler: str = "gcc") -> Path:
    target = source.with_suffix(".o")
    run(compiler, *flags, "-c", source, "-o", target)
    return target


def execute(folder: Path, main: str, sources: Sequence[str], *flags: str) -> list[str]:
    """Compile a main function with the sources and run it; its lines of output."""
    (folder / "main.c").write_text(main)
    flags = flags or STRICT
    run("gcc", *flags, "-I", folder, folder / "main.c", *(folder / source for source in sources), "-o", folder / "main", "-lm")
    return run(folder / "main").splitlines()


def undefined(path: Path) -> set[str]:
    """Symbols that an object needs from elsewhere."""
    return {line.split()[-1] for line in run("nm", "-u", path).splitlines() if line.strip()}


def defined(path: Path) -> set[str]:
    """Symbols that an object offers."""
    return {line.split()[-1] for line in run("nm", "-g", "--defined-only", path).splitlines() if line.strip()}

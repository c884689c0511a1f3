"""The architecture as code: read -> assemble -> derive -> lower -> emit -> compile, each stage's product a frozen noun."""

import hashlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.casadi_files import serialise
from walkgen.emit.emit import emit
from walkgen.emit.landing import BUILD_FOLDER, staged, stale_files
from walkgen.emit.manifest import operations, source_digest
from walkgen.errors import Problem, SpecError, ToolchainError
from walkgen.graph.assembly import Coverage, coverage, titled
from walkgen.graph.differentiate import derivative
from walkgen.graph.lower import lower
from walkgen.graph.passes import fused
from walkgen.graph.program import Composite, Program
from walkgen.graph.sharing import shared
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.runtime.solves.assembly import assemble as assemble_triads
from walkgen.spec.document import open_document
from walkgen.spec.positions import Positions
from walkgen.spec.read import read
from walkgen.spec.schema import RobotSpec
from walkgen.symbolic.derive import derive
from walkgen.symbolic.function import Derivation
from walkgen.toolchain import Library, build_library, find_library

Progress = Callable[[str], None]


@dataclass(frozen=True)
class BuildOptions:
    """What to write; empty targets mean the spec's."""

    targets: tuple[str, ...] = ()
    float32: bool = False
    fma: bool = True


@dataclass(frozen=True)
class BuildReport:
    """What a build made; `library` is empty where no compiler was found."""

    folder: Path
    files: tuple[str, ...]
    functions: int
    operations: int
    seconds: float
    library: str


def _silent(step: str) -> None:
    del step


def build(path: Path, out: Path, options: BuildOptions = BuildOptions(), progress: Progress = _silent) -> BuildReport:
    """Generate and compile the robot of a spec into `out/<robot>/`; the old output stays whole until the new one is.

    Raises:
        SpecError: the spec is not a robot.
        OutputError: a file in the way is not walkgen's.
        ToolchainError: the compiler refused the generated code.
    """
    start = time.perf_counter()
    code = generate(path, options, progress)
    artifacts = emit(code)
    folder = out / code.mechanism.name
    library = _compiled(artifacts, folder, code, progress)
    files = tuple(str(artifact.path) for artifact in artifacts)
    total = sum(operations(body) for body in code.functions)
    return BuildReport(folder, files, len(code.functions), total, time.perf_counter() - start, library)


def generate(path: Path, options: BuildOptions = BuildOptions(), progress: Progress = _silent) -> RobotCode:
    """Everything up to the printers: the robot's programs.

    Raises:
        SpecError: the spec is not a robot, or one whose linkage assembles nowhere.
    """
    progress("read")
    spec = read(path)
    mechanism = assemble(spec, path.parent)
    _refuse_apart(path, spec, mechanism)
    functions = shared(tuple(_bodies(spec, mechanism, options, progress)))
    targets = options.targets or tuple(spec.generate.targets)
    digest = _digest(path, spec)
    return RobotCode(mechanism, functions, digest, targets, options.fma, options.float32)


def _refuse_apart(path: Path, spec: RobotSpec, mechanism: Mechanism) -> None:
    """No linkage that assembles nowhere within the limits of its drives: its code would give nothing but NaN."""
    users = {leg.design: leg.name for leg in spec.legs if leg.design is not None}
    legs = {leg.name: leg for leg in mechanism.legs}
    problems = []
    for design, user in users.items():
        found = coverage_of(mechanism, legs[user])
        if found is not None and found.assembled == 0:
            place = Positions(open_document(path)).place(("leg_designs", design))
            problems.append(
                Problem("WG189", f"leg_designs.{design}: {_apart(found, legs[user])}", "mend the lengths that it joins, or limits", place)
            )
    if problems:
        raise SpecError(*problems)


def coverage_of(mechanism: Mechanism, leg: Limb) -> Coverage | None:
    """How much of its drives' limits a leg's linkage assembles in."""
    return coverage(mechanism, leg, assemble_triads)


def _apart(found: Coverage, leg: Limb) -> str:
    worst, count = found.failing[0]
    points = f"0 % of its drives' limits, at none of {found.points} points"
    return f"the linkage assembles in {points}; at {count} of them the {titled(leg, worst)} cannot close"


def _digest(path: Path, spec: RobotSpec) -> str:
    """sha256 of the spec, followed by its height maps."""
    maps = (path.parent / patch.file for patch in spec.terrain if patch.file is not None)
    return hashlib.sha256(b"".join(file.read_bytes() for file in (path, *maps))).hexdigest()


def _bodies(spec: RobotSpec, mechanism: Mechanism, options: BuildOptions, progress: Progress) -> Iterator[Program | Composite]:
    for derivation in derive(mechanism, _names(spec)):
        progress(derivation.signature.full_name)
        yield lower(derivation, options.fma)
        if spec.generate.derivatives and mechanism.parameters:
            plain = lower(derivation, fma=False)
            if isinstance(plain, Program):
                by_parameters = derivative(plain, "param")
                yield fused(by_parameters) if options.fma else by_parameters


def _names(spec: RobotSpec) -> tuple[str, ...]:
    return () if spec.generate.functions == "all" else tuple(spec.generate.functions)


def _compiled(artifacts: tuple[Artifact, ...], folder: Path, code: RobotCode, progress: Progress) -> str:
    """Files in place, library and CasADi files beside them; nothing is touched where all is up to date."""
    if not stale_files(artifacts, folder):
        return _finished(folder, artifacts, code, progress)
    with staged(artifacts, folder) as stage:
        return _finished(stage, artifacts, code, progress)


def _finished(folder: Path, artifacts: tuple[Artifact, ...], code: RobotCode, progress: Progress) -> str:
    """Compile and serialise inside the folder; the library's name."""
    sources = tuple(artifact for artifact in artifacts if artifact.in_library)
    library = _library(folder, code.mechanism.name, sources, progress) if sources else None
    if "casadi" in code.targets:
        progress("serialise")
        serialise(folder, library.path.parent if library else folder / BUILD_FOLDER)
    return library.path.name if library else ""


def _library(folder: Path, robot: str, sources: tuple[Artifact, ...], progress: Progress) -> Library | None:
    """The compiled library, made if need be; None where there is no compiler, since NumPy serves without one."""
    progress("compile")
    digest = source_digest(sources)
    try:
        return find_library(folder, robot, digest) or build_library(folder, robot, [str(source.path) for source in sources], digest)
    except ToolchainError as error:
        if any(problem.code != "WG401" for problem in error.problems):
            raise
        return None


def stale(path: Path, out: Path, options: BuildOptions = BuildOptions()) -> tuple[str, ...]:
    """Paths of committed files that a build would change."""
    code = generate(path, options)
    folder = out / code.mechanism.name
    return tuple(str(folder / name) for name in stale_files(emit(code), folder))


def spec_of(path: Path) -> RobotSpec:
    """The validated spec."""
    return read(path)


def mechanism_of(path: Path) -> Mechanism:
    """The robot, SI and exact."""
    return assemble(read(path), path.parent)


def functions_of(path: Path) -> tuple[Derivation, ...]:
    """The derivations of all functions that the spec asks for."""
    spec = read(path)
    return tuple(derive(assemble(spec, path.parent), _names(spec)))


def programs_of(path: Path) -> tuple[Program | Composite, ...]:
    """The programs of all functions that the spec asks for."""
    return generate(path).functions

"""The architecture as code: read -> assemble -> derive -> lower -> emit -> compile, each stage's product a frozen noun."""

import hashlib
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from walkgen.collector import uncollected
from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.casadi_files import built_functions, serialise
from walkgen.emit.emit import emit
from walkgen.emit.landing import BUILD_FOLDER, staged, stale_files
from walkgen.emit.manifest import operations, source_digest
from walkgen.errors import Problem, ToolchainError
from walkgen.examine import examined
from walkgen.graph.differentiate import composite_derivative, derivative
from walkgen.graph.lower import lower
from walkgen.graph.passes import fused
from walkgen.graph.program import Composite, Program
from walkgen.graph.sharing import shared
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Mechanism
from walkgen.processes import shared_out
from walkgen.spec.read import read
from walkgen.spec.schema import RobotSpec
from walkgen.symbolic.derive import Section, derive, sections
from walkgen.symbolic.function import Derivation
from walkgen.toolchain import Library, build_library, find_library

Progress = Callable[[str], None]


@dataclass(frozen=True)
class BuildOptions:
    """What to write; empty targets and functions mean the spec's."""

    targets: tuple[str, ...] = ()
    functions: tuple[str, ...] = ()
    float32: bool = False
    fma: bool = True
    planar: bool = False


@dataclass(frozen=True)
class BuildReport:
    """What a build made; `library` is empty where no compiler was found, `notices` are what a user should know of the robot."""

    folder: Path
    files: tuple[str, ...]
    functions: int
    operations: int
    seconds: float
    library: str
    notices: tuple[Problem, ...]


def _silent(step: str | Problem) -> None:
    del step


@uncollected()
def build(path: Path, out: Path, options: BuildOptions = BuildOptions(), progress: Progress = _silent) -> BuildReport:
    """Generate and compile the robot of a spec into `out/<robot>/`; the old output stays whole until the new one is.

    Raises:
        SpecError: the spec is not a robot.
        OutputError: a file in the way is not walkgen's.
        ToolchainError: the compiler refused the generated code.
    """
    start = time.perf_counter()
    notices: list[Problem] = []
    code = generate(path, options, progress, notices.append)
    artifacts = emit(code)
    folder = out / code.mechanism.name
    library = _compiled(artifacts, folder, code, progress)
    files = tuple(str(artifact.path) for artifact in artifacts)
    total = sum(operations(body) for body in code.functions)
    return BuildReport(folder, files, len(code.functions), total, time.perf_counter() - start, library, tuple(notices))


def generate(
    path: Path, options: BuildOptions = BuildOptions(), progress: Progress = _silent, notice: Callable[[Problem], None] = _silent
) -> RobotCode:
    """Everything up to the printers: the robot's programs; `notice` is told what a user should know of the robot.

    Raises:
        SpecError: the spec is not a robot, or one whose linkage assembles nowhere or at dead points alone.
    """
    progress("read")
    spec = read(path)
    mechanism = assemble(spec, path.parent)
    for found in examined(path, spec, mechanism):
        notice(found)
    functions = shared(_bodies(spec, mechanism, options, progress))
    targets = options.targets or tuple(spec.generate.targets)
    digest = _digest(path, spec)
    return RobotCode(mechanism, functions, digest, targets, options.fma, options.float32, options.planar)


def _digest(path: Path, spec: RobotSpec) -> str:
    """sha256 of the spec, followed by its height maps."""
    maps = (path.parent / patch.file for patch in spec.terrain if patch.file is not None)
    return hashlib.sha256(b"".join(file.read_bytes() for file in (path, *maps))).hexdigest()


def _bodies(spec: RobotSpec, mechanism: Mechanism, options: BuildOptions, progress: Progress) -> tuple[Program | Composite, ...]:
    """Programs of all functions; two processes share the sections."""
    told = _here(progress)
    derivatives = spec.generate.derivatives and bool(mechanism.parameters)
    derived = sections(mechanism, options.functions or _names(spec))
    found = shared_out([partial(_lowered, section, derivatives, options.fma, told) for section in derived])
    return tuple(body for bodies in found for body in bodies)


def _here(progress: Progress) -> Progress:
    """Progress that other processes keep to themselves."""
    here = os.getpid()
    return lambda step: progress(step) if os.getpid() == here else None


def _lowered(section: Section, derivatives: bool, fma: bool, progress: Progress) -> tuple[Program | Composite, ...]:
    found: list[Program | Composite] = []
    for derivation in section():
        progress(derivation.signature.full_name)
        body = lower(derivation, fma)
        by_parameters = _by_parameters(body, lower(derivation, fma=False), fma) if derivatives else None
        found += [body] if by_parameters is None else [body, by_parameters]
    return tuple(found)


def _by_parameters(body: Program | Composite, plain: Program | Composite, fma: bool) -> Program | Composite | None:
    """`<name>_d_param`; None of what iterates without telling its slopes."""
    if isinstance(body, Composite) and isinstance(plain, Composite):
        return composite_derivative(body, plain, "param", fma)
    if not isinstance(plain, Program):
        return None
    found = derivative(plain, "param")
    return fused(found) if fma else found


def _names(spec: RobotSpec) -> tuple[str, ...]:
    return () if spec.generate.functions == "all" else tuple(spec.generate.functions)


def _compiled(artifacts: tuple[Artifact, ...], folder: Path, code: RobotCode, progress: Progress) -> str:
    """Files in place, library and CasADi files beside them; nothing is touched where all is up to date."""
    if not stale_files(artifacts, folder):
        return _finished(folder, artifacts, code, progress)
    with staged(artifacts, folder) as stage:
        return _finished(stage, artifacts, code, progress)


def _finished(folder: Path, artifacts: tuple[Artifact, ...], code: RobotCode, progress: Progress) -> str:
    """Compile and serialise inside the folder; the library's name. CasADi builds its functions while compilers work."""
    sources = tuple(artifact for artifact in artifacts if artifact.in_library)
    with ThreadPoolExecutor(1) as beside:
        functions = beside.submit(built_functions, folder) if "casadi" in code.targets else None
        library = _library(folder, code.mechanism.name, sources, progress) if sources else None
    if functions:
        progress("serialise")
        serialise(functions.result(), library.path.parent if library else folder / BUILD_FOLDER)
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


def notices_of(path: Path, spec: RobotSpec) -> tuple[Problem, ...]:
    """What a user should know of a validated spec's robot.

    Raises:
        SpecError: as for `generate`.
    """
    return examined(path, spec, assemble(spec, path.parent))


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

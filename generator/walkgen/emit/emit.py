"""emit: a robot's programs become all of its files, text only, in a fixed order."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_files import build_files, c_sources
from walkgen.emit.casadi_printer import casadi_artifact
from walkgen.emit.manifest import manifest
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.emit.python_files import package_artifacts
from walkgen.emit.python_loops import python_sources
from walkgen.emit.selftest import selftest_artifact
from walkgen.processes import shared_out


def emit(code: RobotCode) -> tuple[Artifact, ...]:
    """Every committed file of the robot's folder, for the targets asked for; the library's sources first, the manifest last.

    Two processes share what has nothing to do with each other.
    """
    written = shared_out([partial(write, code) for target, write in _WRITERS if target in code.targets])
    library = tuple(artifact for artifacts in written for artifact in artifacts if artifact.in_library)
    beside = tuple(artifact for artifacts in written for artifact in artifacts if not artifact.in_library)
    return (*library, *beside, *package_artifacts(code), manifest(code, library))


def _of_library(artifacts: Iterable[Artifact]) -> tuple[Artifact, ...]:
    return tuple(replace(artifact, in_library=True) for artifact in artifacts)


_WRITERS: tuple[tuple[str, Callable[[RobotCode], tuple[Artifact, ...]]], ...] = (
    ("c", lambda code: _of_library(c_sources(code))),
    ("c", lambda code: (selftest_artifact(code), *build_files(code))),
    ("numpy", lambda code: (numpy_artifact(code),)),
    ("casadi", lambda code: (casadi_artifact(code),)),
    ("c", lambda code: _of_library(python_sources(code))),
)
"""By the target that asks for them."""

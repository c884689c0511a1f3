"""emit: a robot's programs become all of its files, text only, in a fixed order."""

from dataclasses import replace

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_files import build_files, c_sources
from walkgen.emit.casadi_printer import casadi_artifact
from walkgen.emit.manifest import manifest
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.emit.python_files import package_artifacts
from walkgen.emit.python_loops import python_sources
from walkgen.emit.selftest import selftest_artifact
from walkgen.processes import both


def emit(code: RobotCode) -> tuple[Artifact, ...]:
    """Every committed file of the robot's folder, for the targets asked for; the library's sources first, the manifest last.

    Two processes share what has nothing to do with each other.
    """
    library, beside = both(lambda: _library(code) if "c" in code.targets else (), _beside_the_library, code)
    return (*library, *beside, *package_artifacts(code), manifest(code, library))


def _beside_the_library(code: RobotCode) -> tuple[Artifact, ...]:
    embedding = (selftest_artifact(code), *build_files(code)) if "c" in code.targets else ()
    numpy = (numpy_artifact(code),) if "numpy" in code.targets else ()
    casadi = (casadi_artifact(code),) if "casadi" in code.targets else ()
    return (*embedding, *numpy, *casadi)


def _library(code: RobotCode) -> tuple[Artifact, ...]:
    return tuple(replace(artifact, in_library=True) for artifact in (*c_sources(code), *python_sources(code)))

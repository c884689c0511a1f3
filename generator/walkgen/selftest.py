"""Compiles and runs the self-test that lies beside a built robot, so that a user can trust it on this very machine."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from walkgen.errors import OutputError, Problem
from walkgen.toolchain import FLAGS, build_program

STRICT = (
    *("-std=c99", "-O1", "-g", "-ffp-contract=off", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"),
    *("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Werror"),
)
"""Every warning an error, every stray access or undefined operation the program's end."""


def run(folder: Path, flags: Sequence[str] = FLAGS) -> int:
    """Build and run the self-test; it prints what it compares to standard output.

    Args:
        folder: a built robot, such as generated/mero.
        flags: what to compile with: the library's own flags, or `STRICT`.

    Returns:
        0 if every value agrees, 1 otherwise.

    Raises:
        OutputError: the folder holds no built robot.
        ToolchainError: no C compiler, or it refused the sources.
    """
    robot = _robot(folder)
    with tempfile.TemporaryDirectory(prefix="walkgen-test-") as work:
        suffix = ".exe" if sys.platform == "win32" else ""
        program = build_program(folder.resolve(), (f"{robot}.c", f"{robot}_test.c"), Path(work) / f"{robot}_test{suffix}", flags)
        sys.stdout.flush()
        return int(subprocess.run((str(program),), check=False).returncode != 0)


def _robot(folder: Path) -> str:
    """The robot's name by its manifest; both C files are there."""
    try:
        name = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["robot"]
    except (OSError, ValueError, KeyError, TypeError):
        name = None
    if not isinstance(name, str) or not all((folder / f"{name}{end}").is_file() for end in (".c", "_test.c")):
        cure = "name a folder that `walkgen build` wrote with the target c, such as generated/mero"
        raise OutputError(Problem("WG520", f"{folder} holds no built robot with a self-test", cure))
    return name

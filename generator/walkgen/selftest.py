"""Compiles and runs the self-test that lies beside a built robot, so that a user can trust it on this very machine."""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from walkgen.errors import OutputError, Problem
from walkgen.toolchain import build_program


def run(folder: Path) -> int:
    """Build and run the self-test; it prints what it compares to standard output.

    Args:
        folder: a built robot, such as generated/mero.

    Returns:
        0 if every value agrees, 1 otherwise.

    Raises:
        OutputError: the folder holds no built robot.
        ToolchainError: no C compiler, or it refused the sources.
    """
    robot = _robot(folder)
    with tempfile.TemporaryDirectory(prefix="walkgen-test-") as work:
        suffix = ".exe" if sys.platform == "win32" else ""
        program = build_program(folder.resolve(), (f"{robot}.c", f"{robot}_test.c"), Path(work) / f"{robot}_test{suffix}")
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

"""C compilers: where they are looked for, which answers, and what one says; standard library only, because the runtime compiles too."""

import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from walkgen.errors import Problem, ToolchainError


@dataclass(frozen=True)
class Compiler:
    """A C compiler that runs: how it was asked for, the command, and the first line it says of itself."""

    label: str
    command: tuple[str, ...]
    version: str


def candidates() -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Where a compiler is looked for, in order: $CC alone when set, else cc, gcc, clang, the ziglang wheel."""
    chosen = shlex.split(os.environ.get("CC", ""))
    if chosen:
        return (("$CC", tuple(chosen)),)
    wheel = (("ziglang", (sys.executable, "-m", "ziglang", "cc")),) if importlib.util.find_spec("ziglang") else ()
    return (*((name, (name,)) for name in ("cc", "gcc", "clang")), *wheel)


def which() -> tuple[Compiler, ...]:
    """Every compiler that answers, in order of preference; the first is the one used."""
    return tuple(compiler for label, command in candidates() if (compiler := _probe(label, command)))


def find_compiler() -> Compiler:
    """The first compiler that answers.

    Raises:
        ToolchainError: WG401 when none does.
    """
    for label, command in candidates():
        compiler = _probe(label, command)
        if compiler:
            return compiler
    tried = ", ".join(shlex.join(command) if label == "$CC" else label for label, command in candidates())
    cure = "install gcc or clang, set CC to a C compiler, or: pip install 'walkgen[zig]'"
    raise ToolchainError(Problem("WG401", f"no C compiler answers (tried {tried})", cure))


def _probe(label: str, command: tuple[str, ...]) -> Compiler | None:
    program = shutil.which(command[0])
    if program is None:
        return None
    try:
        answer = _run((program, *command[1:], "--version"), Path.cwd(), seconds=60)
    except (OSError, subprocess.TimeoutExpired):
        return None
    lines = answer.stdout.strip().splitlines()
    return Compiler(label, (program, *command[1:]), lines[0]) if answer.returncode == 0 and lines else None


def insist(compiler: Compiler, command: Sequence[str], folder: Path) -> None:
    """Run the compiler's command in `folder`.

    Raises:
        ToolchainError: WG402 when it cannot be run or refuses.
    """
    try:
        answer = _run(command, folder)
    except OSError as error:
        message = f"{compiler.command[0]} cannot be run: {error.strerror}"
        raise ToolchainError(Problem("WG402", message, "walkgen doctor shows the compilers")) from error
    if answer.returncode != 0:
        said = (answer.stderr or answer.stdout).strip()[-4000:]
        message = f"{compiler.version} refused the sources in {folder}:\n$ {shlex.join(command)}\n{said}"
        raise ToolchainError(Problem("WG402", message, "walkgen doctor shows the compilers; CC=... chooses another"))


def _run(command: Sequence[str], folder: Path, seconds: float | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command in `folder` with English messages, its output kept."""
    environment = {**os.environ, "LC_ALL": "C"}
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, encoding="utf-8", errors="replace", timeout=seconds, check=False
    )

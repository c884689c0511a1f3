"""Compiles every contestant under every set of flags into libraries, and keeps the compiler's words where it refuses."""

import hashlib
import re
import subprocess
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from peers.source import HERE, Source

FOLDER = HERE.parent / "_build"
_LEVELS = (("-O2",), ("-O3",), ("-O3", "-march=native"))
FLAG_SETS = tuple((*level, *slp) for level, slp in product(_LEVELS, ((), ("-fno-tree-slp-vectorize",))))
MECHANICS = ("-fPIC", "-shared", "-fvisibility=hidden", "-fno-semantic-interposition")
"""What a contestant needs to be loaded and still be inlined within its own unit."""
COMMON = ("-fno-math-errno", "-fno-trapping-math", "-falign-functions=64")
"""Given to everyone: square roots as one instruction, selections without jumps, no luck of the placement; values stay the same."""
COMPILERS = {"c": ("gcc", "-std=gnu99"), "c++": ("g++", "-std=c++17", "-DNDEBUG")}
_PROCESSES = 2


@dataclass(frozen=True)
class Build:
    """A source under one set of flags: the library, or what the compiler said."""

    source: Source
    flags: tuple[str, ...]
    library: Path
    message: str = ""

    @property
    def label(self) -> str:
        return f"{self.source.form}; {' '.join(self.flags)}"


def compile_all(sources: Iterable[Source]) -> tuple[Build, ...]:
    """Every source under its own flags, or under every set; libraries of an earlier run are used again if nothing changed."""
    FOLDER.mkdir(exist_ok=True)
    jobs = [(source, flags) for source in sources for flags in ((source.flags,) if source.flags else FLAG_SETS)]
    with ThreadPoolExecutor(_PROCESSES) as pool:
        return tuple(pool.map(lambda job: compile_one(*job), jobs))


def compile_one(source: Source, flags: tuple[str, ...]) -> Build:
    """One library, named by the digest of the text, the adapters, the command and the compiler."""
    command = (*COMPILERS[source.language], *(() if source.flags else COMMON), *flags, *MECHANICS)
    digest = hashlib.sha256("\0".join((source.text, _adapters(), _version(command[0]), *command, *source.extra)).encode()).hexdigest()[:16]
    library = FOLDER / f"{digest}.so"
    if library.exists():
        return Build(source, flags, library)
    unit = FOLDER / f"{digest}.{'c' if source.language == 'c' else 'cpp'}"
    unit.write_text(source.text)
    includes = [f"-I{folder}" for folder in (*source.includes, HERE)]
    target = library.with_suffix(".part")
    call = [*command, *includes, str(unit), "-o", str(target), *source.extra, "-lm"]
    answer = subprocess.run(call, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        return Build(source, flags, library, first_words(answer.stderr))
    target.replace(library)
    return Build(source, flags, library)


def first_words(text: str) -> str:
    """The first lines that say error, without this machine's folders."""
    lines = [line for line in text.splitlines() if "error" in line.lower()] or text.strip().splitlines()[-3:]
    return re.sub(r"/\S*/", "", "\n".join(lines[:3]))[:600]


def _adapters() -> str:
    return "".join(path.read_text() for path in sorted(HERE.glob("*adapter.h")))


def _version(compiler: str) -> str:
    return subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]


def versions() -> dict[str, str]:
    """First line that each compiler says of itself."""
    return {command[0]: _version(command[0]) for command in COMPILERS.values()}

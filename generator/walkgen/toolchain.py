"""Makes a library or a program of generated sources; standard library only, because the runtime compiles too."""

import hashlib
import json
import os
import re
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from walkgen.compilers import Compiler, find_compiler, insist
from walkgen.errors import Problem, ToolchainError

_EFFORT = ("-O1", "-fstrict-aliasing", "-fipa-cp", "-foptimize-sibling-calls", "-freorder-blocks", "-fpeephole2")
"""Of gcc's -O2 what serves straight-line code without common subexpressions: two thirds of its time, code as fast within a twentieth."""
_IDLE = (
    *("-fno-tree-dse", "-fno-dse", "-fno-tree-slsr", "-fno-ssa-backprop"),
    *("-fno-forward-propagate", "-fno-rerun-cse-after-loop"),
)
"""Passes of gcc's -O1 that find next to nothing in such code, a tenth of its time; without them code is as fast."""
_VECTORS = ("-ftree-loop-vectorize", "-fvect-cost-model=very-cheap", "-fno-tree-slp-vectorize")
FLAGS = ("-std=c99", *_EFFORT, *_IDLE, *_VECTORS, "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")
"""The values of IEEE 754: only errno and exception flags are given up, so that sqrt is one instruction and choices need no jumps;
gcc's SLP vectoriser slows straight-line kernels."""
SHARED = ("-fPIC", "-DWALKGEN_NO_BATCHES")
"""Of a library, whose loops are NumPy's."""
_MODULE = ("-std=c11", "-O2", "-fPIC", "-shared", *(("-undefined", "dynamic_lookup") if sys.platform == "darwin" else ()))
_RECORD = "build.json"
_PROCESSES = 2


@dataclass(frozen=True)
class Library:
    """A compiled robot: the file, and the digest of the sources it came from."""

    path: Path
    digest: str


def platform_tag() -> str:
    """Operating system and processor, such as `linux-x86_64`; the first half of a build folder's name."""
    return re.sub(r"[^a-z0-9_]+", "-", sysconfig.get_platform().lower())


def library_name(robot: str) -> str:
    """File name of the robot's shared library on this system."""
    return {"win32": f"{robot}.dll", "darwin": f"lib{robot}.dylib"}.get(sys.platform, f"lib{robot}.so")


def source_digest(folder: Path, sources: Sequence[str]) -> str:
    """sha256, in hexadecimal, over each source's name, a NUL and its bytes, in this order.

    Raises:
        ToolchainError: WG403 when a source cannot be read.
    """
    digest = hashlib.sha256()
    for source in sources:
        try:
            digest.update(source.encode() + b"\0" + (folder / source).read_bytes())
        except OSError as error:
            raise ToolchainError(Problem("WG403", f"{folder / source} cannot be read: {error.strerror}", _rebuild(folder))) from error
    return digest.hexdigest()


def check_sources(folder: Path, sources: Sequence[str], digest: str) -> None:
    """Make sure that the sources on disk are those of the manifest.

    Raises:
        ToolchainError: WG403 when one is missing or differs.
    """
    if source_digest(folder, sources) != digest:
        raise ToolchainError(Problem("WG403", f"the sources in {folder} differ from its manifest.json", _rebuild(folder)))


def _rebuild(folder: Path) -> str:
    return f"build the robot again: walkgen build specs/{folder.name}.toml"


def find_library(folder: Path, robot: str, digest: str) -> Library | None:
    """The library built earlier from exactly these sources and flags, whole, for this platform; None when there is none."""
    for root in (folder / "_build", user_cache(robot)):
        for place in sorted(root.glob(f"{platform_tag()}-*")):
            if _is_whole(place, robot, digest):
                return Library(place / library_name(robot), digest)
    return None


def _is_whole(place: Path, robot: str, digest: str) -> bool:
    try:
        record = json.loads((place / _RECORD).read_text(encoding="utf-8"))
        content = (place / library_name(robot)).read_bytes()
    except (OSError, ValueError):
        return False
    return bool(record == _record(digest, hashlib.sha256(content).hexdigest()))


def _record(digest: str, library: str) -> dict[str, object]:
    return {"sources": digest, "flags": [*FLAGS, *SHARED], "library": library}


def build_library(folder: Path, robot: str, sources: Sequence[str], digest: str) -> Library:
    """Compile the robot's library into `_build/<platform>-<digest>/`, or the user's cache where the folder is read-only.

    Two processes may build at once: each works in a folder of its own and moves whole files into place.

    Args:
        folder: the robot's folder.
        robot: its name.
        sources: the manifest's sources; those that end in `.c` are compiled.
        digest: the manifest's digest of the sources.

    Raises:
        ToolchainError: WG401 no compiler, WG402 it refused the sources, WG403 the sources are not the manifest's.
    """
    folder = folder.resolve()  # the compiler runs inside it
    check_sources(folder, sources, digest)
    compiler = find_compiler()
    root = _build_root(folder, robot)
    place = root / f"{platform_tag()}-{_build_digest(compiler, digest)}"
    with tempfile.TemporaryDirectory(prefix=".tmp-", dir=root, ignore_cleanup_errors=True) as work:
        library = Path(work) / library_name(robot)
        _link(compiler, _compile(compiler, folder, sources, Path(work), (*FLAGS, *SHARED)), library, ("-shared",))
        _land(library, place, digest)
    _remove_stale(place)
    return Library(place / library.name, digest)


def _build_digest(compiler: Compiler, digest: str) -> str:
    text = "\0".join((digest, compiler.version, *FLAGS, *SHARED))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _build_root(folder: Path, robot: str) -> Path:
    """The first folder that takes files: beside the sources, the user's cache, a temporary folder of this process."""
    for root in (folder / "_build", user_cache(robot)):
        try:
            root.mkdir(mode=0o700 if root != folder / "_build" else 0o777, parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=root).close()
        except OSError:
            continue
        return root
    return Path(tempfile.mkdtemp(prefix="walkgen-"))


def user_cache(name: str) -> Path:
    """Where what is compiled for this user is kept, of a robot or under another name."""
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or "~/.cache"
    return Path(base).expanduser() / "walkgen" / name


def _land(library: Path, place: Path, digest: str) -> None:
    """Move library and record into place; the record goes last, so what it vouches for is there."""
    record = library.with_name(_RECORD)
    record.write_text(json.dumps(_record(digest, hashlib.sha256(library.read_bytes()).hexdigest())), encoding="utf-8")
    place.mkdir(exist_ok=True)
    for product in (library, record):
        try:
            product.replace(place / product.name)
        except PermissionError:  # Windows keeps a loaded library; an equal one already lies there
            if not (place / product.name).exists():
                raise


def _remove_stale(place: Path) -> None:
    """Remove older builds for this platform beside `place`, and only what carries our kind of name; a shared cache keeps them."""
    if place.parent.name != "_build":
        return
    ours = re.compile(re.escape(platform_tag()) + r"-[0-9a-f]{16}")
    for other in place.parent.iterdir():
        if other != place and ours.fullmatch(other.name) and not other.is_symlink():
            shutil.rmtree(other, ignore_errors=True)


def build_program(folder: Path, sources: Sequence[str], program: Path, flags: Sequence[str] = FLAGS) -> Path:
    """Compile and link a program, such as the robot's self-test, from sources that lie in `folder`.

    Raises:
        ToolchainError: WG401 no compiler, WG402 it refused the sources.
    """
    compiler = find_compiler()
    folder, program = folder.resolve(), program.resolve()
    with tempfile.TemporaryDirectory(prefix=".tmp-", dir=program.parent, ignore_cleanup_errors=True) as work:
        linked = Path(work) / program.name
        needed_again = tuple(flag for flag in flags if flag.startswith("-fsanitize"))
        _link(compiler, _compile(compiler, folder, sources, Path(work), flags), linked, needed_again)
        linked.replace(program)
    return program


def build_module(source: Path, name: str, tag: str, headers: Sequence[Path], root: Path) -> Path:
    """A Python extension of one source in `root`, compiled where it is not there yet.

    Args:
        source: its only source.
        name: the module's.
        tag: what it is made for beside the source, such as versions of Python and NumPy.
        headers: folders of what it includes.
        root: the folder that keeps it.

    Raises:
        ToolchainError: WG401 no compiler, WG402 it refused the source.
    """
    text = "\0".join((tag, *_MODULE)).encode()
    product = root / f"{name}-{platform_tag()}-{hashlib.sha256(text + source.read_bytes()).hexdigest()[:16]}.so"
    if product.exists():
        return product
    compiler = find_compiler()
    root.mkdir(mode=0o700, parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".tmp-", dir=root, ignore_cleanup_errors=True) as work:
        made = Path(work) / product.name
        insist(compiler, (*compiler.command, *_MODULE, *(f"-I{folder}" for folder in headers), str(source), "-o", str(made)), Path(work))
        made.replace(product)
    return product


def _compile(compiler: Compiler, folder: Path, sources: Sequence[str], work: Path, flags: Sequence[str]) -> tuple[Path, ...]:
    units = [unit for source in sources if source.endswith(".c") for unit in _units(folder, source, work)]
    suited = _suited(compiler, flags)
    commands = [(*compiler.command, *suited, *chosen, "-c", source, "-o", str(product)) for source, chosen, product in units]
    with ThreadPoolExecutor(_PROCESSES) as pool:
        tuple(pool.map(lambda command: insist(compiler, command, folder), commands))
    return tuple(product for _, _, product in units)


def _suited(compiler: Compiler, flags: Sequence[str]) -> tuple[str, ...]:
    """Clang leaves out too much at -O1, and does not know gcc's passes."""
    if "clang" not in compiler.version:
        return tuple(flags)
    return tuple("-O2" if flag == "-O1" else flag for flag in flags if flag not in _IDLE)


def _units(folder: Path, source: str, work: Path) -> Iterator[tuple[str, tuple[str, ...], Path]]:
    """The source, or each of the parts into which the generator divided a large one: flags that choose it, and its product."""
    stem = Path(source).stem
    parts = dict.fromkeys(re.findall(r"WALKGEN_PART == (\d+)", (folder / source).read_text(encoding="utf-8")))
    if not parts:
        yield source, (), work / f"{stem}.o"
    for part in parts:
        yield source, (f"-DWALKGEN_PART={part}",), work / f"{stem}_{part}.o"


def _link(compiler: Compiler, objects: Sequence[Path], product: Path, flags: Sequence[str]) -> None:
    mathematics = () if sys.platform == "win32" else ("-lm",)
    insist(compiler, (*compiler.command, *flags, *map(str, objects), "-o", str(product), *mathematics), product.parent)

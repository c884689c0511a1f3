"""What is installed and what is missing, without importing any of it."""

import platform
import re
import sysconfig
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from walkgen import __version__
from walkgen.compilers import which

_REQUIREMENT = re.compile(r"(?P<name>[A-Za-z0-9._-]+)(?P<range>[^;]*)(;.*extra == ['\"](?P<extra>\w+)['\"])?")


def findings() -> str:
    """One line for each part: itself, Python, C compilers, required and optional packages; for what is missing, the cure."""
    return "\n".join(
        (f"walkgen {__version__}, Python {platform.python_version()}, {platform.platform()}", *_compilers(), _headers(), *_packages())
    )


def _compilers() -> Iterator[str]:
    found = which()
    for index, compiler in enumerate(found):
        yield f"C compiler  {compiler.label}: {compiler.version}{'  (used)' if index == 0 else ''}"
    if not found:
        yield "C compiler  missing: generated robots run on NumPy; install gcc or clang, set CC, or: pip install 'walkgen[zig]'"


def _headers() -> str:
    if (Path(sysconfig.get_path("include")) / "Python.h").exists():
        return "Python headers  found: calls of one row go past NumPy's ufuncs"
    return "Python headers  missing: a call costs some microseconds more; install them, in Debian python3-dev"


def _packages() -> Iterator[str]:
    for requirement in requires("walkgen") or ():
        match = _REQUIREMENT.match(requirement)
        if match is None:
            continue
        extra = match["extra"] or ""
        label = f"extra {extra}" if extra else "required"
        try:
            yield f"{label}  {match['name']} {version(match['name'])}"
        except PackageNotFoundError:
            cure = f"pip install 'walkgen[{extra}]'" if extra else "pip install --force-reinstall walkgen"
            yield f"{label}  {match['name']}{match['range'].strip()} missing: {cure}"

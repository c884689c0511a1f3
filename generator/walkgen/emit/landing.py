"""Puts a robot's files in place all at once: built beside the folder, then exchanged with it in one step."""

import ctypes
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from walkgen.emit.artifact import Artifact
from walkgen.errors import OutputError, Problem

BUILD_FOLDER = "_build"
_BANNER = "walkgen"
_BANNER_BYTES = 4096
_EXCHANGE = 2  # RENAME_EXCHANGE of renameat2(2)
_HERE = -100  # AT_FDCWD


def stale_files(artifacts: tuple[Artifact, ...], folder: Path) -> tuple[str, ...]:
    """Names, below the folder, of generated files that are missing, differ, or are generated no more."""
    wanted = {str(artifact.path): artifact.text.encode() for artifact in artifacts}
    differing = [name for name, content in wanted.items() if not _holds(folder / name, content)]
    left = [str(path.relative_to(folder)) for path in _own_files(folder) if str(path.relative_to(folder)) not in wanted]
    return tuple(differing + left)


def _holds(path: Path, content: bytes) -> bool:
    return path.is_file() and path.read_bytes() == content


def _files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")) if folder.is_dir() else ():
        if path.is_file() and not {BUILD_FOLDER, "__pycache__"} & set(path.relative_to(folder).parts):
            yield path


def _own_files(folder: Path) -> Iterator[Path]:
    return (path for path in _files(folder) if _is_ours(path))


def _is_ours(path: Path) -> bool:
    with path.open("rb") as file:
        return _BANNER.encode() in file.read(_BANNER_BYTES)


@contextmanager
def staged(artifacts: tuple[Artifact, ...], folder: Path) -> Iterator[Path]:
    """A folder beside the final one with the new files and the user's own; it takes the final name when the block ends.

    Whatever stops the block, the old folder stays as it was.

    Args:
        artifacts: the new files.
        folder: the robot's folder.

    Raises:
        OutputError: WG301, a file to be written is not walkgen's; WG302, the folder cannot be written.
    """
    folder = folder.resolve()
    _refuse_foreign(artifacts, folder)
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    except OSError as error:
        raise OutputError(
            Problem("WG302", f"cannot write below {folder.parent}: {error.strerror}", "give another folder with -o")
        ) from error
    try:
        stage.chmod(0o755)
        _fill(stage, artifacts, folder)
        yield stage
        _exchange(stage, folder)
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _refuse_foreign(artifacts: tuple[Artifact, ...], folder: Path) -> None:
    if folder.exists() and not folder.is_dir():
        raise OutputError(Problem("WG302", f"{folder} is a file", "move it away, or give another folder with -o"))
    present = [folder / artifact.path for artifact in artifacts if (folder / artifact.path).is_file()]
    foreign = [path for path in present if not _is_ours(path)]
    if foreign:
        cure = "it carries no banner of walkgen, so it is yours: move it away, or give another folder with -o"
        raise OutputError(*(Problem("WG301", f"{path} would be overwritten", cure) for path in foreign))


def _fill(stage: Path, artifacts: tuple[Artifact, ...], folder: Path) -> None:
    for path in _files(folder):
        if not _is_ours(path):
            target = stage / path.relative_to(folder)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(path, target)
    for artifact in artifacts:
        (stage / artifact.path).write_bytes(artifact.text.encode())


def _exchange(stage: Path, folder: Path) -> None:
    """Swap the two names; where the system cannot, move the old folder aside first."""
    if not folder.exists():
        stage.rename(folder)
        return
    rename = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None) if os.name == "posix" else None
    if rename and rename(_HERE, os.fsencode(stage), _HERE, os.fsencode(folder), _EXCHANGE) == 0:
        return
    aside = Path(tempfile.mkdtemp(prefix=f".{folder.name}-old-", dir=folder.parent))
    folder.rename(aside / folder.name)
    stage.rename(folder)
    shutil.rmtree(aside, ignore_errors=True)

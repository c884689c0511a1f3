"""From a spec to a design, with what only designs need loaded when it is wanted; and its files."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from walkgen.errors import Problem, SpecError, ToolchainError
from walkgen.spec.problems import shown

if TYPE_CHECKING:
    from walkgen.design.cam_search import CamDesigned
    from walkgen.design.search import Designed
    from walkgen.design.sole_search import SoleDesigned

    Found = Designed | CamDesigned | SoleDesigned

SUFFIXES, CAM_SUFFIXES = (".html", ".png"), (".csv", ".svg", ".dxf")


def designed(path: Path, balance: str, sole: str | None, starts: int | None, seed: int, progress: Any) -> "Found":
    """Search the springs of a spec's balance, or compute its cam; where a sole is named (by "" its only one), search that.

    Raises:
        SpecError: the spec is not a robot, has no such balance or sole, or there is nothing within its bounds.
        ToolchainError: scipy, which searches, is not installed.
    """
    if starts is not None and starts < 1:
        raise SpecError(Problem("WG219", f"{starts} starts", "one start at least: --starts 24"))
    if sole is not None and balance:
        raise SpecError(Problem("WG219", "a balance and a sole at once", "leave --balance or --sole out"))
    if sole is not None:
        rolled: SoleDesigned = _module("sole_search").sole_designed(path, sole, starts, seed, progress)
        return rolled
    search = _module("search")
    found: Designed | CamDesigned = search.designed(path, search.Wanted(balance, starts, seed), progress)
    return found


def reported(found: "Found") -> str:
    """For the terminal."""
    text: str = _told(found, "report")
    return text


def _told(found: "Found", how: str) -> Any:
    """By the module and function of that name for this kind of design."""
    name = found.module_prefix + how
    return getattr(_module(name), name)(found)


def check_suffixes(plot: Path | None, cam: Path | None) -> None:
    """Before anything is searched for.

    Raises:
        SpecError: a plot or cam with another suffix than they may have.
    """
    for what, output, suffixes in (("plot", plot, SUFFIXES), ("cam", cam, CAM_SUFFIXES)):
        if output is not None and output.suffix not in suffixes:
            message = f"{shown(output.name)}: a {what} is written as {' or '.join(suffixes)}"
            raise SpecError(Problem("WG219", message, "name a file with one of them"))


def files(path: Path, found: "Found", output: Path | None, plot: Path | None, cam: Path | None) -> Iterator[tuple[Path, str | bytes]]:
    """What is to be written: the spec with the values that were found, the plot, the cam.

    Raises:
        SpecError: a cam is asked for where springs balance.
        ToolchainError: a library that draws them is not installed.
    """
    if output is not None:
        yield output, _module("rewrite").rewritten(path, found.values)
    if plot is not None:
        yield plot, _plotted(found, plot)
    if cam is not None:
        yield cam, _cam_text(found, cam)


def _plotted(found: "Found", output: Path) -> str | bytes:
    """By the file's suffix."""
    drawn: str | bytes = _told(found, "page" if output.suffix == ".html" else "picture")
    return drawn


def _cam_text(found: "Found", output: Path) -> str:
    """By the file's suffix."""
    cut = getattr(found, "profile", None)
    if cut is None:
        raise SpecError(Problem("WG219", f"{shown(output.name)}: the design has no cam", "leave --cam out"))
    module = _module("cam_dxf" if output.suffix == ".dxf" else "cam_files")
    text: str = getattr(module, output.suffix[1:])(cut)
    return text


def _module(name: str) -> Any:
    try:
        return import_module(f"walkgen.design.{name}")
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] == "walkgen":
            raise
        message = f"{error.name} is not installed; designs need it"
        raise ToolchainError(Problem("WG220", message, "pip install 'walkgen[design]'")) from error

"""From a spec to a design, with what only designs need loaded when it is wanted; and its files."""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from walkgen.errors import Problem, SpecError, ToolchainError
from walkgen.spec.problems import shown

if TYPE_CHECKING:
    from walkgen.design.search import Designed

SUFFIXES = (".html", ".png")


def designed(path: Path, balance: str, starts: int | None, seed: int, progress: Any) -> "Designed":
    """Search the springs of a spec's balance.

    Raises:
        SpecError: the spec is not a robot, has no such balance, or no springs within the bounds only pull and fit.
        ToolchainError: scipy, which searches, is not installed.
    """
    search = _module("search")
    if starts is not None and starts < 1:
        raise SpecError(Problem("WG219", f"{starts} starts", "one start at least: --starts 24"))
    found: Designed = search.designed(path, search.Wanted(balance, starts, seed), progress)
    return found


def reported(found: "Designed") -> str:
    """For the terminal."""
    text: str = _module("report").report(found)
    return text


def spec_text(path: Path, found: "Designed") -> str:
    """The spec with the values that were found."""
    text: str = _module("rewrite").rewritten(path, found.values)
    return text


def check_suffix(output: Path | None) -> None:
    """Before anything is searched for.

    Raises:
        SpecError: a plot with another suffix than .html and .png.
    """
    if output is not None and output.suffix not in SUFFIXES:
        message = f"{shown(output.name)}: a plot is written as {' or '.join(SUFFIXES)}"
        raise SpecError(Problem("WG219", message, "name a file with one of them"))


def plotted(found: "Designed", output: Path) -> str | bytes:
    """The plot, by its file's suffix.

    Raises:
        ToolchainError: plotly or matplotlib, which draw it, is not installed.
    """
    drawn: str | bytes = _module("page").page(found) if output.suffix == ".html" else _module("picture").picture(found)
    return drawn


def _module(name: str) -> Any:
    try:
        return import_module(f"walkgen.design.{name}")
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] == "walkgen":
            raise
        message = f"{error.name} is not installed; designs need it"
        raise ToolchainError(Problem("WG220", message, "pip install 'walkgen[design]'")) from error

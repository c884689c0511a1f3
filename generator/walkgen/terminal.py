"""What the command line prints and writes: problems, counts, progress, and files that must not exist yet."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich.console import Console

from walkgen.errors import Problem, SpecError

if TYPE_CHECKING:
    from walkgen.gait.walk import Walk
    from walkgen.pipeline import BuildReport


def report(problems: tuple[Problem, ...]) -> None:
    """Print problems where errors go."""
    for problem in problems:
        typer.echo(str(problem), err=True)


def as_json(problem: Problem) -> dict[str, str | int]:
    """A problem for programs that read the output."""
    place: dict[str, str | int] = (
        {"file": problem.place.file, "line": problem.place.line, "column": problem.place.column} if problem.place else {}
    )
    return {**place, "code": problem.code, "message": problem.message, "cure": problem.cure}


def count(number: int, noun: str) -> str:
    """The number with its noun: 1 file, 2 files."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def print_build(built: "BuildReport") -> None:
    """Say what a build wrote."""
    size = f"{count(len(built.files), 'file')}, {count(built.functions, 'function')}, {built.operations} operations"
    typer.echo(f"{built.folder}: {size}, {built.seconds:.1f} s")
    for file in built.files:
        typer.echo(f"  {file}")
    typer.echo(f"  {built.library} compiled" if built.library else "  no library (no C compiler, or the target c is off): runs on NumPy")


def print_walk(walk: "Walk", files: list[Path]) -> None:
    """Say how a walk went, what stands against it and which files have it."""
    pace = f"{walk.times[-1] - walk.times[0]:.4g} s, {count(len(walk.holds.leg), 'foothold')}, {walk.trajectory.speed:.4g} m/s"
    typer.echo(f"{walk.robot}: {pace}, {walk.margin_summary}")
    for file in files:
        typer.echo(f"  {file}")
    for fault in walk.faults:
        typer.echo(f"  {fault}")


def write_new(path: Path, content: str | bytes) -> None:
    """Write a file that does not exist yet.

    Raises:
        SpecError: it exists, or its folder cannot be written.
    """
    try:
        with path.open("xb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
    except FileExistsError as error:
        raise SpecError(Problem("WG517", f"{path} exists already", "name another file, or remove this one first")) from error
    except OSError as error:
        raise SpecError(Problem("WG518", f"cannot write {path}: {error.strerror}", "name a file in a folder that you can write")) from error


def deliver(text: str, output: Path | None, following: str = "") -> None:
    """Into a new file if one is named, else to the terminal."""
    if output is None:
        typer.echo(text, nl=False)
        return
    write_new(output, text)
    typer.echo(f"{output} written" + (f"; next: {following} {output}" if following else ""), err=True)


@contextmanager
def progress_of(spec: Path) -> Iterator[Callable[[str], None]]:
    """Show what a build is doing on a terminal; say nothing where the output is read by a program."""
    console = Console(stderr=True)
    if not (console.is_terminal and sys.stdout.isatty()):
        yield lambda _: None
        return
    with console.status(f"{spec}") as status:
        yield lambda step: status.update(f"{spec}: {step}")

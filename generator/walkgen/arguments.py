"""What the commands take: choices, and arguments that several of them share."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

TARGETS = ("c", "casadi", "numpy")
TO_FILE = "Write here instead of to the terminal."


class Stage(StrEnum):
    """What `walkgen show` can show."""

    SPEC = "spec"
    MECHANISM = "mechanism"
    FUNCTIONS = "functions"
    PROGRAM = "program"


class Format(StrEnum):
    """How `walkgen check` reports."""

    TEXT = "text"
    JSON = "json"


class Body(StrEnum):
    """What a platform does before a leg lifts."""

    LEVEL = "level"
    WAVED = "waved"
    SWINGING = "swinging"


class Verify(StrEnum):
    """What `walkgen build` proves of what it built."""

    NONE = "none"
    TEST = "test"
    FULL = "full"


Specs = Annotated[list[Path], typer.Argument(metavar="SPEC", help="Robot specs (TOML).")]
Output = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Each robot gets its own folder DIR/<robot>/.")]
SoleName = Annotated[str | None, typer.Option("--sole", metavar="NAME", help='Instead, which of the spec\'s soles; "" its only one.')]


def targets_of(text: str) -> tuple[str, ...]:
    """The targets asked for, in their fixed order; none means the spec's."""
    names = tuple(part.strip() for part in text.split(",") if part.strip())
    unknown = [name for name in names if name not in TARGETS]
    if unknown:
        raise typer.BadParameter(f"unknown: {', '.join(unknown)}; targets are {', '.join(TARGETS)}", param_hint="--targets")
    return tuple(name for name in TARGETS if name in names)

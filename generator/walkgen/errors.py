"""What a user can mend: problems with a place, a cause and a cure, raised all at once."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Place:
    """Where in a file a problem sits; line and column count from 1."""

    file: str
    line: int
    column: int
    source: str = ""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


@dataclass(frozen=True)
class Problem:
    """One thing a user has to mend: a stable code, what is wrong, and how to mend it."""

    code: str
    message: str
    cure: str = ""
    place: Place | None = None

    def __str__(self) -> str:
        where = f"{self.place}  " if self.place else ""
        lines = [f"{where}{self.code}  {self.message}"]
        if self.place and self.place.source:
            lines.append(f"    | {self.place.source.rstrip()}")
        if self.cure:
            lines.append(f"    = {self.cure}")
        return "\n".join(lines)


class WalkgenError(Exception):
    """Every problem the user can mend, together; the command line turns it into exit code 2."""

    def __init__(self, *problems: Problem) -> None:
        super().__init__("\n".join(str(problem) for problem in problems))
        self.problems = problems


class SpecError(WalkgenError):
    """The spec is not a robot: wrong keys, units, shapes, names or physics."""


class UnsupportedMechanism(WalkgenError):
    """A correct robot, but the asked function has no form for it."""


class ToolchainError(WalkgenError):
    """No C compiler, or it refused the generated sources."""


class OutputError(WalkgenError):
    """The output folder cannot be written without harming what is not walkgen's."""

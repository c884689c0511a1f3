"""What goes into the emitters and what comes out: a robot's programs, and texts with a relative path."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePosixPath

from walkgen.graph.program import Composite, Program
from walkgen.graph.sharing import repeated
from walkgen.model.mechanism import Mechanism
from walkgen.signature import Table

Body = Program | Composite


@dataclass(frozen=True)
class Artifact:
    """One generated file, relative to the robot's folder; text, byte-identical for the same spec.

    `in_library` marks what the compiled library is made from.
    """

    path: PurePosixPath
    text: str
    in_library: bool = False


@dataclass(frozen=True)
class RobotCode:
    """All that the emitters know of a robot.

    `functions` are those asked for, in a fixed order; `digest` is the spec's sha256 in hexadecimal;
    `fma` fuses multiply-add where the target has it; `planar` adds functions of component-major arrays.
    """

    mechanism: Mechanism
    functions: tuple[Body, ...]
    digest: str
    targets: tuple[str, ...] = ("c", "casadi", "numpy")
    fma: bool = True
    float32: bool = False
    planar: bool = False

    @property
    def public(self) -> frozenset[Program]:
        """The functions that are one Program: Composites may call them."""
        return frozenset(body for body in self.functions if isinstance(body, Program))

    @cached_property
    def repeated(self) -> Mapping[Body, Body]:
        """Functions with the same code as an earlier one, each with that one: they call it and do nothing else."""
        return repeated(self.functions)

    @property
    def tables(self) -> tuple[Table, ...]:
        """The constants that routines read, each once."""
        composites = (body for body in self.functions if isinstance(body, Composite))
        return tuple(dict.fromkeys(table for composite in composites for table in composite.all_tables))

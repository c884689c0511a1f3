"""Names, shapes and units of a generated function: the one vocabulary that generator and runtime share."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from decimal import Decimal
from math import prod
from types import MappingProxyType
from typing import Literal

Kind = Literal["real", "integer", "truth"]
Dimension = int | str
"""A size, or the name of one that every call chooses."""

COUNTS: Mapping[str, int] = MappingProxyType({"k": 16, "r": 96, "poses": 1024})
"""Counts that a call chooses, and the most that C has room for: feet in contact (WALKGEN_MAX_FEET) and rows of joint limits; of the poses
of a path C has as many as its caller has room for, Python so many.
"""

STATUSES = ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE", "INFEASIBLE", "DUPLICATE")


@dataclass(frozen=True)
class Port:
    """One named argument: a row-major array of `shape` (empty for a scalar) in `unit`; a truth is 0 or 1 in C, a bool in Python.

    A shape may name a count, such as the feet in contact ("k", 3): C takes it as an argument, Python reads it off the arrays.
    `default` holds the elements that Python fills in where the caller leaves out this input; C takes every input.
    """

    name: str
    shape: tuple[Dimension, ...] = ()
    unit: str = "1"
    kind: Kind = "real"
    default: tuple[float, ...] = ()

    @property
    def sizes(self) -> tuple[int, ...]:
        """The shape of a port that names no count."""
        sizes = tuple(dimension for dimension in self.shape if isinstance(dimension, int))
        assert len(sizes) == len(self.shape), self.name
        return sizes

    @property
    def size(self) -> int:
        """How many elements the port has; it must name no count."""
        return prod(self.sizes)

    def sized(self, counts: Mapping[str, int]) -> "Port":
        """The port with its counts replaced by sizes."""
        return replace(self, shape=tuple(counts[size] if isinstance(size, str) else size for size in self.shape))


def _counts(ports: Iterable[Port]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(size for port in ports for size in port.shape if isinstance(size, str)))


@dataclass(frozen=True)
class Table:
    """Constant numbers under a full name; `columns` only lays them out."""

    name: str
    values: tuple[Decimal, ...] = field(hash=False, repr=False)  # long, and the name tells tables apart
    columns: int = 8


@dataclass(frozen=True)
class Records:
    """An argument of a routine: rows of one of its structs, which name functions that it calls back; empty rows have none."""

    struct: str
    rows: tuple[tuple[str | int, ...], ...]


Argument = str | Decimal | int | Records
"""Of a step: a name, a literal, or records."""


@dataclass(frozen=True)
class Signature:
    """A generated function: `<robot>_<owner>_<name>`; `owner` is a leg, chain or route, or empty for the robot.

    An output port `status` (kind integer) of shape () is C's return value, and so is a truth that is the only output;
    a status of shape (b,) is an argument and C returns the number of OK entries. C takes `counts` before all inputs, and
    before the outputs a pointer to the caller's `workspace` (a struct of csupport), where the function has one.
    """

    robot: str
    owner: str
    name: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    doc: str = ""
    source: str = ""
    workspace: str = ""

    @property
    def counts(self) -> tuple[str, ...]:
        """Names of the sizes that every call chooses, as they first occur."""
        return _counts((*self.inputs, *self.outputs))

    @property
    def capacities(self) -> tuple[str, ...]:
        """Those that no input has: how much room the caller gives an output."""
        told = _counts(self.inputs)
        return tuple(count for count in self.counts if count not in told)

    @property
    def full_name(self) -> str:
        """The name in C: robot, owner and function, joined."""
        return "_".join(part for part in (self.robot, self.owner, self.name) if part)

    @property
    def status(self) -> Port | None:
        """The output that carries status codes, if the function can fail."""
        return next((port for port in self.outputs if port.name == "status"), None)

    @property
    def returned(self) -> Port | None:
        """The output that is C's return value: a scalar status, or the only output where that is a truth."""
        verdict = self.outputs[0] if len(self.outputs) == 1 and self.outputs[0].kind == "truth" else self.status
        return verdict if verdict and not verdict.shape else None

"""Names, shapes and units of a generated function: the one vocabulary that generator and runtime share."""

from dataclasses import dataclass
from math import prod
from typing import Literal

Kind = Literal["real", "integer"]

STATUSES = ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "NO_CONVERGENCE", "INFEASIBLE", "DUPLICATE")


@dataclass(frozen=True)
class Port:
    """One named argument: a row-major array of `shape` (empty for a scalar) in `unit`."""

    name: str
    shape: tuple[int, ...] = ()
    unit: str = "1"
    kind: Kind = "real"

    @property
    def size(self) -> int:
        """How many elements the port has."""
        return prod(self.shape)


@dataclass(frozen=True)
class Signature:
    """A generated function: `<robot>_<owner>_<name>`; `owner` is a leg, chain or route, or empty for the robot.

    An output port `status` (kind integer) of shape () is C's return value; of shape (b,) it is an argument
    and C returns the number of OK entries.
    """

    robot: str
    owner: str
    name: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    doc: str = ""
    source: str = ""

    @property
    def full_name(self) -> str:
        """The name in C: robot, owner and function, joined."""
        return "_".join(part for part in (self.robot, self.owner, self.name) if part)

    @property
    def status(self) -> Port | None:
        """The output that carries status codes, if the function can fail."""
        return next((port for port in self.outputs if port.name == "status"), None)

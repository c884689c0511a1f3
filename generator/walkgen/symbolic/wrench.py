"""Forces and moments, or linear and angular momenta, handed from link to link towards the base."""

from dataclasses import dataclass

import sympy

from walkgen.symbolic.tape import ZERO_VECTOR, Tape, Vec, cross, plus
from walkgen.symbolic.tree import BASE
from walkgen.symbolic.turning import Turning


@dataclass(frozen=True)
class Wrench:
    """Force and moment about the origin."""

    force: Vec = ZERO_VECTOR
    moment: Vec = ZERO_VECTOR

    def __add__(self, other: "Wrench") -> "Wrench":
        return Wrench(plus(self.force, other.force), plus(self.moment, other.moment))

    def named(self, tape: Tape, name: str) -> "Wrench":
        """Every component under a name."""
        return Wrench(tape.vector(f"{name}_force", self.force), tape.vector(f"{name}_moment", self.moment))

    def seen_from(self, lever: Vec) -> "Wrench":
        """About the point from which this origin lies at `lever`."""
        return Wrench(self.force, plus(self.moment, cross(lever, self.force)))


def grouped(turning: Turning, index: int, wrench: Wrench) -> Wrench:
    """A wrench from where the link's quantities live into its group's axes."""
    if not turning.bears[index]:
        return wrench
    name = turning.links[index].name
    return Wrench(turning.out(index, wrench.force, f"{name}_force_group"), turning.out(index, wrench.moment, f"{name}_moment_group"))


def along_route(turning: Turning, index: int, wrench: Wrench, unit: str) -> tuple[dict[int, sympy.Expr], Wrench]:
    """Efforts of a link's joint and of all that bear it, by link, for a wrench about its origin in its group's axes; what the base gets.

    Args:
        turning: the tree at its joint values.
        index: the link.
        wrench: what the link needs.
        unit: begins the intermediates' names.
    """
    efforts: dict[int, sympy.Expr] = {}
    while True:
        link = turning.links[index]
        effort = wrench.moment[2] if link.revolute else wrench.force[2]
        efforts[index] = turning.tape.let(f"{unit}_{link.name}", link.sense * effort)
        wrench = carried(turning, index, wrench).named(turning.tape, f"{unit}_on_{link.name}")
        if link.parent == BASE:
            return efforts, wrench
        if link.turn is not None:
            wrench = grouped(turning, link.parent, wrench)
        index = link.parent


def carried(turning: Turning, index: int, wrench: Wrench) -> Wrench:
    """A wrench about the link's origin in its group's axes, on its parent's side about the parent's origin."""
    name = turning.links[index].name
    force = turning.leave(index, wrench.force, f"{name}_force_on")
    moment = turning.leave(index, wrench.moment, f"{name}_moment_on")
    return Wrench(force, moment).seen_from(turning.lever(index))

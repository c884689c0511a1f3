"""Forces and moments, or linear and angular momenta, handed from link to link towards the base."""

from dataclasses import dataclass

from walkgen.symbolic.tape import ZERO_VECTOR, Tape, Vec, cross, plus
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


def carried(turning: Turning, index: int, wrench: Wrench) -> Wrench:
    """A wrench about the link's origin in its group's axes, on its parent's side about the parent's origin."""
    name = turning.links[index].name
    force = turning.leave(index, wrench.force, f"{name}_force_on")
    moment = turning.leave(index, wrench.moment, f"{name}_moment_on")
    return Wrench(force, moment).seen_from(turning.lever(index))

"""How a tree's links turn and slide: sines and cosines of summed angles, and vectors carried from frame to frame.

A link's quantities live in its group's axes, where parallel links share all but one component, or in the link's own frame if
it bears other groups (`bears`): those must be reached anyway.
"""

from collections.abc import Sequence
from functools import cached_property

import sympy

from walkgen.symbolic.frames import cosine_sine
from walkgen.symbolic.inertia import Inertia
from walkgen.symbolic.path import quarter_turned
from walkgen.symbolic.tape import IDENTITY, Tape, Vec, dot, plus, scaled, times
from walkgen.symbolic.tree import BASE, Link, Tree


class Turning:
    """The tree at joint values q."""

    def __init__(self, tree: Tree, tape: Tape, q: Sequence[sympy.Expr]) -> None:
        self.tree, self.tape, self.q = tree, tape, q
        self.links = tree.links
        self.bears = tuple(tree.bears(index) for index in range(len(tree.links)))

    def along(self, values: Sequence[sympy.Expr], index: int) -> sympy.Expr:
        """A joint's value, rate or acceleration as motion about or along z."""
        link = self.links[index]
        return link.sense * values[link.coordinate]

    @cached_property
    def angles(self) -> tuple[tuple[str, sympy.Expr], ...]:
        """For every link the sum of its group's angles, constants left out, and its name."""
        found: list[tuple[str, sympy.Expr]] = []
        for index, link in enumerate(self.links):
            label, angle = found[link.parent] if link.turn is None else ("", sympy.S.Zero)
            if link.revolute:
                label = f"{label}_{link.joint.name}" if label else link.name
                angle = self.tape.let(f"angle_{label}", angle + self.along(self.q, index))
            found.append((label, angle))
        return tuple(found)

    def cosine_sine(self, index: int) -> tuple[sympy.Expr, sympy.Expr]:
        """Of the angle from the group's axes to the link's."""
        (label, angle), offset = self.angles[index], self.links[index].offset
        return cosine_sine(offset) if angle == 0 else quarter_turned(label, angle, offset, self.tape)

    def out(self, index: int, vector: Vec, name: str) -> Vec:
        """From the link's frame into its group's axes."""
        cosine, sine = self.cosine_sine(index)
        x, y, z = vector
        return self.tape.vector(name, (cosine * x - sine * y, sine * x + cosine * y, z))

    def back(self, index: int, vector: Vec, name: str) -> Vec:
        """From the group's axes into the link's frame."""
        cosine, sine = self.cosine_sine(index)
        x, y, z = vector
        return self.tape.vector(name, (cosine * x + sine * y, cosine * y - sine * x, z))

    def enter(self, index: int, vector: Vec, name: str) -> Vec:
        """From the parent's side (its frame where a group begins, else its group's axes) into the link's group's axes."""
        turn = self.links[index].turn
        if turn is None or turn == IDENTITY:
            return vector
        x, y, z = (dot(column, vector) for column in turn)
        return self.tape.vector(name, (x, y, z))

    def leave(self, index: int, vector: Vec, name: str) -> Vec:
        """From the link's group's axes to the parent's side."""
        turn = self.links[index].turn
        if turn is None or turn == IDENTITY:
            return vector
        return self.tape.vector(name, times(turn, vector))

    def lever(self, index: int) -> Vec:
        """From the parent's origin to the link's, on the parent's side."""
        link = self.links[index]
        way = link.origin if link.turn is not None else self.out(link.parent, link.origin, f"{link.name}_lever")
        if link.revolute:
            return way
        return self.tape.vector(f"{link.name}_slid", plus(way, scaled(self.along(self.q, index), link.axis)))

    def homely(self, index: int, vector: Vec, name: str) -> Vec:
        """A vector of the link's frame where the link's quantities live."""
        return vector if self.bears[index] else self.out(index, vector, name)

    def inertia(self, index: int, *, first: str = "x") -> Inertia:
        """The link's inertia where its quantities live; of the tensor's xx and yy the `first` comes cheaper."""
        link = self.links[index]
        if self.bears[index]:
            return link.inertia
        return link.inertia.spun(*self.cosine_sine(index), self.tape, f"{link.name}_inertia", first=first)

    def down_to(self, index: int, vector: Vec, name: str) -> Vec:
        """A vector of the base's axes where a link's quantities live."""
        if index == BASE:
            return vector
        previous: Link | None = None
        for step in self.tree.route(index):
            link = self.links[step]
            if previous is not None and link.turn is not None:
                vector = self.back(link.parent, vector, f"{name}_{previous.name}")
            vector = self.enter(step, vector, f"{name}_{link.name}_group")
            previous = link
        return self.back(index, vector, f"{name}_{self.links[index].name}") if self.bears[index] else vector

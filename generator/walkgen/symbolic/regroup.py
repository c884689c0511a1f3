"""Moves inertia between links, without changing any joint torque, until few numbers are left: minimal inertial parameters.

Masses on a joint's axis may be carried on either side of it, and a link that slides turns with its parent (Gautier and Khalil
1990). Where a link bears one other, a mass on that one's axis takes the place of the first moment along the way to it. Origins
are free along their axes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import sympy

from walkgen.symbolic.frames import rotation_about
from walkgen.symbolic.inertia import Inertia, axial, difference, relative
from walkgen.symbolic.tape import IDENTITY, Tape, Vec, constant_vector, minus, plus, scaled, times
from walkgen.symbolic.tree import BASE, Foot, Link, Tree

_LEAST_COSINE = sympy.Rational(1, 8)
"""Of an axis with a component that a shift along it is to remove: a far origin would cost the inertia's digits."""


def regrouped(tree: Tree, tape: Tape, floating: bool, *, by_value: bool = True) -> Tree:
    """The tree with as few inertial numbers and lever components as possible, and the same dynamics.

    Args:
        tree: as the robot is described.
        tape: for entries that hold runtime parameters.
        floating: whether the base moves.
        by_value: whether the inertias' own numbers may decide what moves, or the joints alone.
    """
    work = _Regrouping(tree, tape, floating)
    for index in range(len(work.links)):
        work.slide(index)
    for index in reversed(range(len(work.links))):
        if by_value:
            work.centre(index)
            work.hand_over(index)
        work.give_back(index)
    return Tree(tuple(work.links), work.base, tuple(work.feet))


class _Regrouping:
    """A tree whose links change while inertia moves."""

    def __init__(self, tree: Tree, tape: Tape, floating: bool) -> None:
        self.tree, self.tape, self.floating = tree, tape, floating
        self.links = list(tree.links)
        self.feet = list(tree.feet)
        self.base = tree.base

    # ---- origins

    def slide(self, index: int) -> None:
        """Put the link's origin where its axis meets the fewest lever components."""
        best = min(self._shifts(index), key=lambda shift: self._lever_entries(index, shift))
        if best != 0:
            link = self.links[index]
            self._recentre(index, (sympy.S.Zero, sympy.S.Zero, best), scaled(best, link.axis))

    def _shifts(self, index: int) -> Iterator[sympy.Expr]:
        yield sympy.S.Zero
        link = self.links[index]
        own = [-way / along for way, along in zip(link.origin, link.axis, strict=True) if along.is_number and abs(along) > _LEAST_COSINE]
        others = [self.links[child].origin[2] for child in self.tree.children(index)]
        yield from (shift for shift in (*own, *others) if shift.is_number)

    def _lever_entries(self, index: int, shift: sympy.Expr) -> int:
        link = self.links[index]
        counted = self.floating or link.parent != BASE
        own = _nonzeros(plus(link.origin, scaled(shift, link.axis))) if counted else 0
        back = scaled(-shift, IDENTITY[2])
        return own + sum(_nonzeros(plus(self.links[child].origin, back)) for child in self.tree.children(index))

    def _recentre(self, index: int, centre: Vec, way: Vec) -> None:
        """Move the link's origin to `centre` in its frame, which is `way` in its parent's."""
        link = self.links[index]
        inertia = relative(link.inertia, centre).named(self.tape, f"{link.name}_about")
        frame = replace(link.frame, origin=constant_vector(minus(link.frame.origin, centre)))
        self.links[index] = replace(link, origin=constant_vector(plus(link.origin, way)), inertia=inertia, frame=frame)
        for child in self.tree.children(index):
            origin = constant_vector(minus(self.links[child].origin, centre))
            self.links[child] = replace(self.links[child], origin=origin)
        moved = [Foot(foot.link, constant_vector(minus(foot.origin, centre))) for foot in self.feet]
        self.feet = [new if old.link == index else old for new, old in zip(moved, self.feet, strict=True)]

    # ---- inertia

    def centre(self, index: int) -> None:
        """A sliding link at the end of its path has its origin in its centre of mass."""
        link = self.links[index]
        numbers = (link.inertia.mass, *link.inertia.moment)
        if link.revolute or any(self.tree.children(index)) or link.inertia.mass == 0 or not all(number.is_number for number in numbers):
            return
        centre = constant_vector(scaled(1 / link.inertia.mass, link.inertia.moment))
        self._recentre(index, centre, self._outwards(link, centre))

    def _outwards(self, link: Link, vector: Vec) -> Vec:
        """A vector of a sliding link's frame in its parent's; the angle between them is constant."""
        before = self.links[link.parent].offset if link.turn is None else sympy.S.Zero
        return times(link.turn or IDENTITY, times(rotation_about(2, link.offset - before).rotation, vector))

    def hand_over(self, index: int) -> None:
        """Where the link bears one other, a point mass there takes over the first moment if that leaves none."""
        children = list(self.tree.children(index))
        if len(children) != 1:
            return
        link, child = self.links[index], self.links[children[0]]
        mass = self._point_mass(link.inertia.moment, child.origin) if child.revolute else sympy.S.Zero
        if mass != 0:
            inertia = difference(link.inertia, child.origin, mass).named(self.tape, f"{link.name}_less")
            self.links[index] = replace(link, inertia=inertia)
            self.links[children[0]] = replace(child, inertia=child.inertia + Inertia(mass))

    def _point_mass(self, moment: Vec, lever: Vec) -> sympy.Expr:
        if not all(component.is_number for component in (*moment, *lever)):
            return sympy.S.Zero
        masses = [first / way for first, way in zip(moment, lever, strict=True) if way != 0]
        left = {mass: _nonzeros(constant_vector(minus(moment, scaled(mass, lever)))) for mass in masses}
        best = min(masses, key=lambda mass: left[mass], default=sympy.S.Zero)
        return best if best != 0 and left[best] == 0 else sympy.S.Zero

    def give_back(self, index: int) -> None:
        """Carry on the parent what may as well be there."""
        link = self.links[index]
        part = axial(link.inertia) if link.revolute else Inertia(tensor=link.inertia.tensor)
        self.links[index] = replace(link, inertia=(link.inertia - part).named(self.tape, f"{link.name}_kept"))
        moved = self._in_parent(link, part)
        if link.parent == BASE:
            self.base = (self.base + moved).named(self.tape, "base_sum")
        else:
            parent = self.links[link.parent]
            self.links[link.parent] = replace(parent, inertia=(parent.inertia + moved).named(self.tape, f"{parent.name}_sum"))

    def _in_parent(self, link: Link, part: Inertia) -> Inertia:
        """What is given back, about the parent's origin; a sliding link's tensor knows no place."""
        name = f"{link.name}_given"
        if link.revolute:
            return part.turned(link.turn or IDENTITY, self.tape, name).named(self.tape, name).seen_from(link.origin)
        x, y, z = (self._outwards(link, axis) for axis in IDENTITY)
        return part.turned((x, y, z), self.tape, name)


def _nonzeros(vector: Sequence[sympy.Expr]) -> int:
    """Components that are not known to be 0."""
    return sum(component != 0 for component in constant_vector((vector[0], vector[1], vector[2])))

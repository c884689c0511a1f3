"""Masses and first moments of what each joint moves: all that a centre of mass and its Jacobian need."""

from functools import cached_property

import sympy

from walkgen.symbolic.tape import ZERO_VECTOR, Vec, plus, scaled
from walkgen.symbolic.tree import BASE
from walkgen.symbolic.turning import Turning

_ZERO = sympy.S.Zero


class FirstMoments:
    """At a turning's joint values; masses are those of the regrouped tree, whose sum alone is the robot's."""

    def __init__(self, turning: Turning) -> None:
        self.turning, self.tape, self.links, self.tree = turning, turning.tape, turning.links, turning.tree

    @cached_property
    def masses(self) -> tuple[sympy.Expr, ...]:
        """Of every link and all that hangs on it; the base's whole mass comes last."""
        found = [*(link.inertia.mass for link in self.links), self.tree.base.mass]
        for index in reversed(range(len(self.links))):
            parent = self.links[index].parent
            found[parent] = self.tape.let("mass" if parent == BASE else f"{self.links[parent].name}_mass", found[parent] + found[index])
        return tuple(found)

    @cached_property
    def moments(self) -> tuple[Vec, ...]:
        """Mass times centre of mass from every link's origin, in its group's axes; the base's comes last."""
        own = [link.inertia.moment for link in self.links]
        parallel = [ZERO_VECTOR for _ in self.links]
        base = self.tree.base.moment
        for index in reversed(range(len(self.links))):
            link = self.links[index]
            turned = self.turning.out(index, self.tape.vector(f"{link.name}_borne", own[index]), f"{link.name}_moment_own")
            parallel[index] = self.tape.vector(f"{link.name}_moment", plus(turned, parallel[index]))
            there = self.turning.leave(index, parallel[index], f"{link.name}_moment_on")
            handed = plus(there, scaled(self.masses[index], self.turning.lever(index)))
            if link.parent == BASE:
                base = self.tape.vector("moment", plus(base, handed))
            elif link.turn is None:
                parallel[link.parent] = plus(parallel[link.parent], handed)
            else:
                own[link.parent] = plus(own[link.parent], handed)
        return (*parallel, base)

    @property
    def mass(self) -> sympy.Expr:
        """Of the whole tree."""
        return self.masses[BASE]

    @property
    def moment(self) -> Vec:
        """Of the whole tree, from the base's origin in its axes."""
        return self.moments[BASE]

    @cached_property
    def centre(self) -> Vec:
        """Centre of mass of the whole tree, from the base's origin in its axes."""
        reciprocal = self.tape.let("reciprocal_mass", 1 / self.mass)
        return self.tape.vector("centre", scaled(reciprocal, self.moment))

    def unit(self, index: int) -> Vec:
        """Momentum of the whole for a unit rate of the joint, in its group's axes."""
        link = self.links[index]
        x, y, _ = self.moments[index]
        if link.revolute:
            return (-link.sense * y, link.sense * x, _ZERO)
        return (_ZERO, _ZERO, link.sense * self.masses[index])

"""Velocities of a tree's links from the base outwards, and what is made of them: kinetic energy and momentum."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.symbolic.inertia import Inertia
from walkgen.symbolic.tape import ZERO_VECTOR, Vec, cross, dot, plus, scaled
from walkgen.symbolic.tree import BASE
from walkgen.symbolic.turning import Turning
from walkgen.symbolic.wrench import Wrench, carried, grouped

_ZERO = sympy.S.Zero


@dataclass(frozen=True)
class Velocity:
    """Spin (rad/s) and velocity of the origin (m/s)."""

    spin: Vec = ZERO_VECTOR
    origin: Vec = ZERO_VECTOR


class Velocities:
    """Of every link, for joint rates and the base's velocity."""

    def __init__(self, turning: Turning, rates: Sequence[sympy.Expr], base: Velocity = Velocity()) -> None:
        self.turning, self.tape, self.links = turning, turning.tape, turning.links
        self.rates, self.base = rates, base

    @cached_property
    def _found(self) -> tuple[tuple[Velocity, ...], tuple[Velocity, ...]]:
        """In the group's axes, and where the link's quantities live."""
        parallel: list[Velocity] = []
        homely: list[Velocity] = []
        for index, link in enumerate(self.links):
            before = self.base if link.parent == BASE else homely[link.parent] if link.turn is not None else parallel[link.parent]
            parallel.append(self._moved(index, before))
            homely.append(self._turned(index, parallel[-1]) if self.turning.bears[index] else parallel[-1])
        return tuple(parallel), tuple(homely)

    def _moved(self, index: int, before: Velocity) -> Velocity:
        name, revolute = self.links[index].name, self.links[index].revolute
        carried_along = plus(before.origin, cross(before.spin, self.turning.lever(index)))
        named = self.tape.vector(f"{name}_velocity_before", carried_along)
        spin = self.turning.enter(index, before.spin, f"{name}_spin_before")
        origin = self.turning.enter(index, named, f"{name}_velocity_group")
        rate = (_ZERO, _ZERO, self.turning.along(self.rates, index))
        spin = self.tape.vector(f"{name}_spin", plus(spin, rate)) if revolute else spin
        return Velocity(spin, origin if revolute else self.tape.vector(f"{name}_velocity", plus(origin, rate)))

    def _turned(self, index: int, velocity: Velocity) -> Velocity:
        name = self.links[index].name
        spin = self.turning.back(index, velocity.spin, f"{name}_spin_own")
        return Velocity(spin, self.turning.back(index, velocity.origin, f"{name}_velocity_own"))

    @property
    def grouped(self) -> tuple[Velocity, ...]:
        """In the axes of each link's group."""
        return self._found[0]

    @property
    def homely(self) -> tuple[Velocity, ...]:
        """Where each link's quantities live."""
        return self._found[1]

    def side(self, index: int) -> Velocity:
        """Of a link's parent, on the parent's side."""
        link = self.links[index]
        if link.parent == BASE:
            return self.base
        return (self.grouped if link.turn is None else self.homely)[link.parent]

    def lever_rate(self, index: int) -> Vec:
        """Rate of the lever from the parent's origin to the link's, on the parent's side."""
        link = self.links[index]
        swing = cross(self.side(index).spin, self.turning.lever(index))
        if not link.revolute:
            swing = plus(swing, scaled(self.turning.along(self.rates, index), link.axis))
        return self.tape.vector(f"{link.name}_lever_rate", swing)

    @cached_property
    def momenta(self) -> tuple[Wrench, ...]:
        """Linear and angular momentum of every link alone, about its origin, where its quantities live."""
        return tuple(self._momentum(index, velocity) for index, velocity in enumerate(self.homely))

    def _momentum(self, index: int, velocity: Velocity) -> Wrench:
        inertia = self.turning.inertia(index, first="x" if velocity.spin[0] != 0 else "y")
        return momentum(inertia, velocity).named(self.tape, f"{self.links[index].name}_momentum")

    @cached_property
    def energy(self) -> sympy.Expr:
        """Kinetic energy (J) of all links, half the sum of momentum times velocity; the base's and rotors' left out."""
        terms = [
            self.tape.let(f"{link.name}_energy", dot(part.force, velocity.origin) + dot(part.moment, velocity.spin))
            for link, part, velocity in zip(self.links, self.momenta, self.homely, strict=True)
        ]
        return sympy.Add(*terms)

    @cached_property
    def base_momentum(self) -> Wrench:
        """Of the base and all links, about the base's origin in its axes."""
        own = list(self.momenta)
        parallel = [Wrench() for _ in self.links]
        base = momentum(self.turning.tree.base, self.base)
        for index in reversed(range(len(self.links))):
            link = self.links[index]
            total = grouped(self.turning, index, own[index].named(self.tape, f"{link.name}_borne")) + parallel[index]
            parallel[index] = total.named(self.tape, f"{link.name}_carried")
            handed = carried(self.turning, index, parallel[index])
            if link.parent == BASE:
                base = (base + handed).named(self.tape, "base")
            elif link.turn is None:
                parallel[link.parent] += handed
            else:
                own[link.parent] += handed
        return base


def momentum(inertia: Inertia, velocity: Velocity) -> Wrench:
    """Linear and angular momentum of a rigid body about its origin."""
    linear = plus(scaled(inertia.mass, velocity.origin), cross(velocity.spin, inertia.moment))
    return Wrench(linear, plus(inertia.angular(velocity.spin), cross(inertia.moment, velocity.origin)))

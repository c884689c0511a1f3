"""Composite bodies over a tree of links: what each joint moves as one rigid body, and the mass matrix made of them."""

from collections.abc import Iterator
from functools import cached_property

import sympy

from walkgen.symbolic.inertia import Inertia
from walkgen.symbolic.tape import IDENTITY
from walkgen.symbolic.tree import BASE
from walkgen.symbolic.turning import Turning
from walkgen.symbolic.wrench import Wrench, along_route

_ZERO = sympy.S.Zero


class CompositeBodies:
    """Composite inertias and the mass matrix at a turning's joint values (Walker and Orin 1982); rotors left out."""

    def __init__(self, turning: Turning) -> None:
        self.turning, self.tape, self.links = turning, turning.tape, turning.links

    @cached_property
    def _composites(self) -> tuple[tuple[Inertia, ...], Inertia]:
        """What moves with every joint, about the link's origin in its group's axes, and the whole about the base's."""
        own = [link.inertia if self.turning.bears[index] else Inertia() for index, link in enumerate(self.links)]
        parallel = [Inertia() if self.turning.bears[index] else self.turning.inertia(index) for index in range(len(self.links))]
        base = self.turning.tree.base
        for index in reversed(range(len(self.links))):
            link = self.links[index]
            parallel[index] = self._whole(index, own[index], parallel[index])
            if link.parent == BASE:
                base = (base + self._handed(index, parallel[index])).named(self.tape, "base")
            elif link.turn is None:
                parallel[link.parent] += self._handed(index, parallel[index])
            else:
                own[link.parent] += self._handed(index, parallel[index])
        return tuple(parallel), base

    def _whole(self, index: int, own: Inertia, parallel: Inertia) -> Inertia:
        name = self.links[index].name
        if self.turning.bears[index]:
            cosine_sine = self.turning.cosine_sine(index)
            own = own.named(self.tape, f"{name}_borne").spun(*cosine_sine, self.tape, f"{name}_whole")
        return (own + parallel).named(self.tape, f"{name}_composite")

    def _handed(self, index: int, inertia: Inertia) -> Inertia:
        """On the parent's side, about the parent's origin."""
        turned = inertia.turned(self.links[index].turn or IDENTITY, self.tape, f"{self.links[index].name}_composite")
        return turned.seen_from(self.turning.lever(index))

    @cached_property
    def base(self) -> Inertia:
        """The whole tree about the base's origin, in its axes."""
        return self._composites[1]

    def unit_wrench(self, index: int) -> Wrench:
        """What a unit acceleration of the joint takes, about the link's origin in its group's axes."""
        inertia, sense = self._composites[0][index], self.links[index].sense
        x, y, _ = inertia.moment
        _, _, zz, _, xz, yz = inertia.tensor
        if self.links[index].revolute:
            return Wrench((-sense * y, sense * x, _ZERO), (sense * xz, sense * yz, sense * zz))
        return Wrench((_ZERO, _ZERO, sense * inertia.mass), (sense * y, -sense * x, _ZERO))

    def column(self, index: int) -> tuple[dict[int, sympy.Expr], Wrench]:
        """Mass matrix entries of the joint with itself and the links that bear it, by link, and the wrench on the base."""
        return along_route(self.turning, index, self.unit_wrench(index), f"M_{self.links[index].name}")

    @cached_property
    def columns(self) -> tuple[tuple[dict[int, sympy.Expr], Wrench], ...]:
        """One for every link."""
        return tuple(self.column(index) for index in range(len(self.links)))

    def joint_entries(self) -> Iterator[tuple[int, int, sympy.Expr]]:
        """Row and column (coordinates) and value of the mass matrix's joint block, both halves, zeros left out."""
        for index, (entries, _) in enumerate(self.columns):
            for other, value in entries.items():
                first, second = self.links[index].coordinate, self.links[other].coordinate
                yield first, second, value
                if first != second:
                    yield second, first, value

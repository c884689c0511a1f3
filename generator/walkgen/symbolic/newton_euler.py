"""Recursive Newton-Euler over a tree of links, unrolled: motions from the base outwards, wrenches back.

A link's motion is what its acceleration field needs: the field's matrix U = [dw/dt]x + w w' - |w|^2 (Khalil and Kleinfinger
1987) is made of the spin w, its rate about z and the third column of U, the acceleration of the z axis. That column and the
spin across z are common to a group of parallel axes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.symbolic.inertia import Inertia
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, cross, dot, minus, plus, scaled, times
from walkgen.symbolic.tree import BASE, Foot
from walkgen.symbolic.turning import Turning
from walkgen.symbolic.wrench import Wrench, carried, grouped

_ZERO = sympy.S.Zero


@dataclass(frozen=True)
class Motion:
    """Spin (rad/s), its rate about z, acceleration of the unit vector z (its x and y), acceleration of the origin less gravity."""

    spin: Vec = ZERO_VECTOR
    rate: sympy.Expr = _ZERO
    pole: tuple[sympy.Expr, sympy.Expr] = (_ZERO, _ZERO)
    origin: Vec = ZERO_VECTOR

    def rates(self) -> Vec:
        """The whole angular acceleration."""
        x, y, z = self.spin
        return (y * z - self.pole[1], self.pole[0] - x * z, self.rate)

    def entered(self, columns: Columns, tape: Tape, name: str) -> "Motion":
        """In the axes `columns` of the motion's own."""
        if columns == IDENTITY:
            return self
        spin, rates, origin = (_turned_into(columns, vector) for vector in (self.spin, self.rates(), self.origin))
        x, y, z = tape.vector(f"{name}_spin_before", spin)
        first, second, rate = tape.vector(f"{name}_rates_before", rates)
        pole = (tape.let(f"{name}_pole_x", x * z + second), tape.let(f"{name}_pole_y", y * z - first))
        return Motion((x, y, z), rate, pole, tape.vector(f"{name}_at_group", origin))

    def field(self, tape: Tape, name: str) -> Columns:
        """U: a point at r from the origin accelerates by U r more."""
        x, y, z = self.spin
        first, second = self.pole
        ux = tape.vector(f"{name}_field_x", (-(y**2) - z**2, x * y + self.rate, 2 * x * z - first))
        uy = tape.vector(f"{name}_field_y", (x * y - self.rate, -(x**2) - z**2, 2 * y * z - second))
        return (ux, uy, tape.vector(f"{name}_field_z", (first, second, -(x**2) - y**2)))


def _turned_into(columns: Columns, vector: Vec) -> Vec:
    x, y, z = (dot(column, vector) for column in columns)
    return (x, y, z)


def accelerated(motion: Motion, inertia: Inertia, wheel: sympy.Expr, tape: Tape, name: str) -> Wrench:
    """What moves a body: mass times acceleration, and the moments of it about the origin; `wheel` is the inertia's."""
    ux, uy, uz = motion.field(tape, name)
    force = plus(scaled(inertia.mass, motion.origin), times((ux, uy, uz), inertia.moment))
    moment = plus(tape.vector(f"{name}_heave", cross(inertia.moment, motion.origin)), _turning(motion, inertia, wheel, (ux, uy, uz)))
    return Wrench(tape.vector(f"{name}_inertial_force", force), tape.vector(f"{name}_inertial_moment", moment))


def _turning(motion: Motion, inertia: Inertia, wheel: sympy.Expr, field: Columns) -> Vec:
    """J dw/dt + w x J w, written with the entries of U that are there anyway."""
    xx, yy, zz, xy, xz, yz = inertia.tensor
    wx, wy, wz = motion.spin
    (_, u10, u20), (u01, _, u21), (u02, u12, _) = field
    x = u21 * xx - u20 * xy + (wy**2 - wz**2) * yz + u10 * xz + wheel * wy * wz
    y = -u20 * yy + u21 * xy + (wz**2 - wx**2) * xz - u01 * yz - wheel * wx * wz
    z = motion.rate * zz + wx * wy * (yy - xx) + (wx**2 - wy**2) * xy + u02 * yz - u12 * xz
    return (x, y, z)


class NewtonEuler:
    """Joint efforts and the base's wrench for given rates, accelerations and foot forces; a tree without feet has no forces."""

    def __init__(
        self, turning: Turning, rates: Sequence[sympy.Expr], accelerations: Sequence[sympy.Expr], base: Motion, forces: Sequence[Vec] = ()
    ) -> None:
        self.turning, self.tape, self.links = turning, turning.tape, turning.links
        self.rates, self.accelerations, self.base, self.forces = rates, accelerations, base, forces

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """Of every link, where its quantities live."""
        grouped: list[Motion] = []
        found: list[Motion] = []
        for index, link in enumerate(self.links):
            before = self.base if link.parent == BASE else found[link.parent] if link.turn is not None else grouped[link.parent]
            grouped.append(self._moved(index, before))
            found.append(self._turned(index, grouped[-1]) if self.turning.bears[index] else grouped[-1])
        return tuple(found)

    def _moved(self, index: int, before: Motion) -> Motion:
        """The link's motion in its group's axes, from the motion on its parent's side."""
        link, tape = self.links[index], self.tape
        name = link.name
        lever = self.turning.lever(index)
        swing = times(before.field(tape, self._side(index)), lever)
        origin = tape.vector(f"{name}_at", plus(before.origin, swing))
        motion = Motion(before.spin, before.rate, before.pole, origin).entered(link.turn or IDENTITY, tape, name)
        rate, acceleration = self.turning.along(self.rates, index), self.turning.along(self.accelerations, index)
        x, y, z = motion.spin
        if link.revolute:
            spin, change = tape.let(f"{name}_spin_z", z + rate), tape.let(f"{name}_rate", motion.rate + acceleration)
            return Motion((x, y, spin), change, motion.pole, motion.origin)
        sliding = tape.vector(f"{name}_sliding", plus(motion.origin, (2 * y * rate, -2 * x * rate, acceleration)))
        return Motion(motion.spin, motion.rate, motion.pole, sliding)

    def _side(self, index: int) -> str:
        """Names the axes on the parent's side."""
        link = self.links[index]
        return "base" if link.parent == BASE else self.links[link.parent].name

    def own_motion(self, index: int) -> Motion:
        """A link's motion in its own axes."""
        return self.motions[index] if self.turning.bears[index] else self._turned(index, self.motions[index])

    def _turned(self, index: int, motion: Motion) -> Motion:
        """From the group's axes into the link's own."""
        name = self.links[index].name
        spin = self.turning.back(index, motion.spin, f"{name}_spin")
        first, second, _ = self.turning.back(index, (*motion.pole, _ZERO), f"{name}_pole")
        return Motion(spin, motion.rate, (first, second), self.turning.back(index, motion.origin, f"{name}_at_own"))

    @cached_property
    def _wrenches(self) -> tuple[tuple[Wrench, ...], Wrench]:
        """What every joint transmits, in its group's axes about the link's origin, and what the base does."""
        own = [self._own(index) for index in range(len(self.links))]
        parallel = [Wrench() for _ in self.links]
        base = accelerated(self.base, self.turning.tree.base, self.turning.tree.base.wheel, self.tape, "base") + self._at_feet(BASE)
        for index in reversed(range(len(self.links))):
            link = self.links[index]
            total = grouped(self.turning, index, own[index].named(self.tape, f"{link.name}_own")) + parallel[index]
            parallel[index] = total.named(self.tape, link.name)
            handed = carried(self.turning, index, parallel[index])
            if link.parent == BASE:
                base = (base + handed).named(self.tape, "base")
            elif link.turn is None:
                parallel[link.parent] += handed
            else:
                own[link.parent] += handed
        return tuple(parallel), base

    def _own(self, index: int) -> Wrench:
        motion = self.motions[index]
        inertia = self.turning.inertia(index, first="x" if motion.spin[0] != 0 else "y")
        link = self.links[index]
        return accelerated(motion, inertia, link.inertia.wheel, self.tape, link.name) + self._at_feet(index)

    def _at_feet(self, index: int) -> Wrench:
        """The reaction to forces on the feet of a link."""
        total = Wrench()
        for number, (foot, force) in enumerate(zip(self.turning.tree.feet, self.forces, strict=False)):
            if foot.link == index:
                total += self._at_foot(foot, force, f"foot_{number}" if len(self.forces) > 1 else "foot")
        return total

    def _at_foot(self, foot: Foot, force: Vec, name: str) -> Wrench:
        local = self.turning.down_to(foot.link, force, f"{name}_force")
        lever = foot.origin if foot.link == BASE else self.turning.homely(foot.link, foot.origin, f"{name}_lever")
        return Wrench(minus(ZERO_VECTOR, local)).seen_from(lever)

    @cached_property
    def efforts(self) -> tuple[sympy.Expr, ...]:
        """Generalised forces of the joints, in the order of the tree's coordinates; friction and rotors left out."""
        found = [_ZERO] * len(self.links)
        for index, link in enumerate(self.links):
            wrench = self._wrenches[0][index]
            found[link.coordinate] = self.turning.along([wrench.moment[2] if link.revolute else wrench.force[2]] * len(found), index)
        return tuple(found)

    @cached_property
    def base_wrench(self) -> Wrench:
        """What the base needs from outside, about its origin, in its axes."""
        return self._wrenches[1]

"""The Coriolis matrix over a tree of links: Christoffel's, so that dM/dt - 2 C is skew.

For a swarm of particles C_ij = sum m dp/dq_i . d/dt(dp/dq_j). Summed over a composite body that takes, besides its inertia, the
first and second moments of its particles' velocities: P = sum m r' and K = sum m r r'^T, r from the joint's origin and r' its
rate (the closed sum of Echeandia and Wensing 2021).
"""

from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.symbolic.inertia import WEIGHTLESS, Inertia
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Columns, Tape, Vec, cross, plus, scaled, times
from walkgen.symbolic.tree import BASE
from walkgen.symbolic.velocities import Velocities
from walkgen.symbolic.wrench import Wrench, carried, grouped

_ZERO = sympy.S.Zero
_NOTHING: Columns = (ZERO_VECTOR, ZERO_VECTOR, ZERO_VECTOR)


@dataclass(frozen=True)
class Swarm:
    """Inertia about an origin, P (kg m/s) and the rows of K (kg m^2/s), velocities relative to the origin's."""

    inertia: Inertia = WEIGHTLESS
    flow: Vec = ZERO_VECTOR
    spread: Columns = _NOTHING

    def __add__(self, other: "Swarm") -> "Swarm":
        x, y, z = (plus(one, more) for one, more in zip(self.spread, other.spread, strict=True))
        return Swarm(self.inertia + other.inertia, plus(self.flow, other.flow), (x, y, z))

    def named(self, tape: Tape, name: str) -> "Swarm":
        """Every entry under a name."""
        x, y, z = (tape.vector(f"{name}_spread_{axis}", row) for axis, row in zip("xyz", self.spread, strict=True))
        return Swarm(self.inertia.named(tape, name), tape.vector(f"{name}_flow", self.flow), (x, y, z))

    def seen_from(self, lever: Vec, rate: Vec) -> "Swarm":
        """About the point from which this origin lies at `lever`, which grows by `rate`."""
        inertia = self.inertia
        rows = (
            plus(row, plus(scaled(way, self.flow), scaled(first + inertia.mass * way, rate)))
            for row, way, first in zip(self.spread, lever, inertia.moment, strict=True)
        )
        x, y, z = rows
        return Swarm(inertia.seen_from(lever), plus(self.flow, scaled(inertia.mass, rate)), (x, y, z))

    def turned(self, columns: Columns, tape: Tape, name: str) -> "Swarm":
        """In the axes in which this frame's axes are `columns`."""
        if columns == IDENTITY:
            return self
        half = [tape.vector(f"{name}_half_{axis}", times(columns, row)) for axis, row in zip("xyz", self.spread, strict=True)]
        x, y, z = (_combined([column[row] for column in columns], half) for row in range(3))
        return Swarm(self.inertia.turned(columns, tape, name), times(columns, self.flow), (x, y, z))


def _combined(factors: list[sympy.Expr], rows: list[Vec]) -> Vec:
    first, second, third = (scaled(factor, row) for factor, row in zip(factors, rows, strict=True))
    return plus(plus(first, second), third)


def _rigid(inertia: Inertia, spin: Vec) -> Swarm:
    """A body that turns: r' = w x r."""
    xx, yy, zz, xy, xz, yz = inertia.tensor
    half = sympy.Rational(1, 2)
    second = ((half * (yy + zz - xx), -xy, -xz), (-xy, half * (xx + zz - yy), -yz), (-xz, -yz, half * (xx + yy - zz)))
    x, y, z = (cross(spin, row) for row in second)
    return Swarm(inertia, cross(spin, inertia.moment), (x, y, z))


@dataclass(frozen=True)
class _Row:
    """A joint's dp/dq summed against its swarm: what the axis and its rate of a joint nearer to the base are multiplied by."""

    force: Vec
    by_rate: Vec
    by_axis: Vec

    def named(self, tape: Tape, name: str) -> "_Row":
        force, by_rate, by_axis = (
            tape.vector(f"{name}_{word}", vector)
            for word, vector in (("force", self.force), ("by_rate", self.by_rate), ("by_axis", self.by_axis))
        )
        return _Row(force, by_rate, by_axis)


class Coriolis:
    """C(q, qd) at velocities whose base is at rest."""

    def __init__(self, velocities: Velocities) -> None:
        self.velocities, self.turning = velocities, velocities.turning
        self.tape, self.links = self.turning.tape, self.turning.links

    @cached_property
    def _swarms(self) -> tuple[Swarm, ...]:
        """What moves with every joint, about the link's origin in its group's axes."""
        own: list[Swarm] = []
        for index, velocity in enumerate(self.velocities.homely):
            rigid = _rigid(self.turning.inertia(index), velocity.spin)
            own.append(rigid.named(self.tape, f"{self.links[index].name}_swarm"))
        parallel = [Swarm() for _ in self.links]
        for index in reversed(range(len(self.links))):
            link = self.links[index]
            total = self._grouped(index, own[index].named(self.tape, f"{link.name}_borne")) + parallel[index]
            parallel[index] = total.named(self.tape, f"{link.name}_composite")
            if link.parent != BASE:
                turned = parallel[index].turned(link.turn or IDENTITY, self.tape, f"{link.name}_on")
                handed = turned.seen_from(self.turning.lever(index), self.velocities.lever_rate(index))
                target = parallel if link.turn is None else own
                target[link.parent] += handed
        return tuple(parallel)

    def _grouped(self, index: int, swarm: Swarm) -> Swarm:
        if not self.turning.bears[index]:
            return swarm
        cosine, sine = self.turning.cosine_sine(index)
        return swarm.turned(((cosine, sine, _ZERO), (-sine, cosine, _ZERO), IDENTITY[2]), self.tape, f"{self.links[index].name}_group")

    def _axis_rate(self, index: int) -> Vec:
        """Of the joint's z, in its group's axes."""
        x, y, _ = self.velocities.grouped[index].spin
        return (y, -x, _ZERO)

    def _column(self, index: int) -> Wrench:
        """Sum of m d/dt(dp/dq) of the joint, and its moment."""
        swarm, rate = self._swarms[index], self._axis_rate(index)
        moment = swarm.inertia.moment
        if not self.links[index].revolute:
            return Wrench(scaled(swarm.inertia.mass, rate), cross(moment, rate))
        xx, xy, xz = (swarm.spread[0][0], swarm.spread[1][1], swarm.spread[2])
        force = plus(cross(rate, moment), cross(IDENTITY[2], swarm.flow))
        return Wrench(force, plus(swarm.inertia.angular(rate), (-xz[0], -xz[1], xx + xy)))

    def _row(self, index: int) -> _Row:
        """Sum of m dp/dq of the joint, taken with d/dt(dp/dq) of joints nearer to the base."""
        swarm = self._swarms[index]
        z = IDENTITY[2]
        if not self.links[index].revolute:
            return _Row(scaled(swarm.inertia.mass, z), cross(swarm.inertia.moment, z), cross(swarm.flow, z))
        (xx, _, xz), (_, yy, yz), _ = swarm.spread
        return _Row(cross(z, swarm.inertia.moment), swarm.inertia.angular(z), (-xz, -yz, xx + yy))

    def _entry(self, row: _Row, index: int) -> sympy.Expr:
        x, y, _ = self.velocities.grouped[index].spin
        if not self.links[index].revolute:
            return row.force[0] * y - row.force[1] * x
        return row.by_axis[2] + row.by_rate[0] * y - row.by_rate[1] * x

    def _handed(self, index: int, row: _Row) -> _Row:
        """The row on the parent's side, about the parent's origin."""
        name = self.links[index].name
        force, by_rate, by_axis = (
            self.turning.leave(index, vector, f"{name}_{word}_on")
            for word, vector in (("row", row.force), ("by_rate", row.by_rate), ("by_axis", row.by_axis))
        )
        lever, rate = self.turning.lever(index), self.velocities.lever_rate(index)
        return _Row(force, plus(by_rate, cross(lever, force)), plus(by_axis, cross(rate, force)))

    def entries(self) -> dict[tuple[int, int], sympy.Expr]:
        """Nonzero entries of C by row and column (coordinates)."""
        found: dict[tuple[int, int], sympy.Expr] = {}
        for last in range(len(self.links)):
            self._along_route(last, found)
        return found

    def _along_route(self, last: int, found: dict[tuple[int, int], sympy.Expr]) -> None:
        column, row, index = self._column(last), self._row(last), last
        unit, deeper = self.links[last].name, self.links[last]
        while True:
            link = self.links[index]
            sense = deeper.sense * link.sense
            effort = column.moment[2] if link.revolute else column.force[2]
            found[link.coordinate, deeper.coordinate] = self.tape.let(f"C_{link.name}_{unit}", sense * effort)
            found[deeper.coordinate, link.coordinate] = self.tape.let(f"C_{unit}_{link.name}", sense * self._entry(row, index))
            if link.parent == BASE:
                return
            column = carried(self.turning, index, column).named(self.tape, f"{unit}_column_on_{link.name}")
            row = self._handed(index, row).named(self.tape, f"{unit}_row_on_{link.name}")
            if link.turn is not None:
                column, row = grouped(self.turning, link.parent, column), self._row_out(link.parent, row, unit)
            index = link.parent

    def _row_out(self, index: int, row: _Row, unit: str) -> _Row:
        name = f"{unit}_row_in_{self.links[index].name}"
        force, by_rate, by_axis = (self.turning.out(index, vector, name) for vector in (row.force, row.by_rate, row.by_axis))
        return _Row(force, by_rate, by_axis)

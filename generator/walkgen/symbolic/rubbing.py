"""Friction in the pairs of a linkage as efforts on its drives: by virtual work, through how fast each pair turns or slides.

What a pair carries is taken from free bodies without friction and without acceleration, so that efforts stay linear in the accelerations
and forward dynamics undo inverse dynamics; what friction itself adds to it is of second order in mu.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import sympy

from walkgen.model.linkage import Linkage
from walkgen.model.pair_friction import PairFriction
from walkgen.symbolic.choices import less
from walkgen.symbolic.drives import sense
from walkgen.symbolic.frames import Parameters, expression
from walkgen.symbolic.free_bodies import FreeBodies, Load, at
from walkgen.symbolic.function import Select
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import Planar, conjugate, difference, outer, square, stretched, turned
from walkgen.symbolic.planar_motion import Coordinate, PlanarMotion
from walkgen.symbolic.tape import Tape

Exprs = Sequence[sympy.Expr]
Rubbed = tuple[PairFriction, tuple[tuple[int, Load], tuple[int, Load]]]
"""What a pair's friction does to its first and its second link."""
_NOTHING = sympy.Rational(1, 10**24)
"""Square of a force (N^2) that is none: its size has no slope there."""


@dataclass(frozen=True)
class Rubbing:
    """The frictions of one linkage; `motion` is that of their pairs, `start` the tree's first coordinate of the linkage, `drives` its q."""

    linkage: Linkage
    placing: Placing
    parameters: Parameters
    start: int
    drives: Sequence[int]
    tape: Tape
    motion: PlanarMotion

    def on(self, tape: Tape) -> "Rubbing":
        """The same, written on a tape that began as this one's."""
        return replace(self, tape=tape, motion=self.motion.on(tape))

    @property
    def loaded(self) -> bool:
        """Whether any depends on what its pair carries."""
        return any(self._coefficient(friction, "lever") != 0 for friction in self.linkage.frictions)

    def efforts(self, qd: Exprs, steady: Exprs) -> Iterator[tuple[int, sympy.Expr]]:
        """On the q, by number: against friction at the rates qd; `steady` as for `against`."""
        for row, effort in zip(self.motion.slopes, self.against(qd, steady), strict=True):
            yield from ((index, slope * effort) for index, slope in zip(self.drives, row, strict=True))

    def against(self, qd: Exprs, steady: Exprs) -> tuple[sympy.Expr, ...]:
        """What keeps every pair moving (N m of pins, N of the others), 0 at rest.

        Args:
            qd: rates of all q.
            steady: efforts on the tree's coordinates at these rates and loads, without accelerations; not read where none is `loaded`.
        """
        rates = self.motion.rates([qd[index] for index in self.drives])
        loads = self._loads(steady)
        found = []
        for friction, rate, load in zip(self.linkage.frictions, rates, loads, strict=True):
            viscous, coulomb, lever = (self._coefficient(friction, key) for key in ("viscous", "coulomb", "lever"))
            dry = self.tape.let(f"{friction.name}_dry", coulomb + lever * load)
            found.append(self.tape.let(f"{friction.name}_friction", viscous * rate + (dry * sense(rate) if dry != 0 else dry)))
        return tuple(found)

    def loads(self, against: Exprs) -> Iterator[Rubbed]:
        """What friction does to the links of every pair without a drive; a driven pair's is part of what its drive transmits."""
        for friction, effort in zip(self.linkage.frictions, against, strict=True):
            if friction.pair is None or not self.linkage.structure.pairs[friction.pair].driven:
                (first, _), (second, _) = friction.ends
                ends = self._pulled(friction, effort)
                yield friction, ((first, ends[0]), (second, ends[1]))

    def _pulled(self, friction: PairFriction, effort: sympy.Expr) -> tuple[Load, Load]:
        """Opposite loads on first and second link."""
        if self._turns(friction):
            return Load(moment=effort), Load(moment=-effort)
        first, second = end_points(friction, self.placing)
        along = self._along(friction)
        return at(first if friction.pair is None else second, stretched(effort, along)), at(second, stretched(-effort, along))

    def _along(self, friction: PairFriction) -> Planar:
        """The direction in which the second link slides."""
        if friction.pair is not None:
            return self.placing.along(friction.pair)
        first, second = end_points(friction, self.placing)
        span = difference(second, first)
        return stretched(1 / sympy.sqrt(square(span)), span)

    def _loads(self, steady: Exprs) -> list[sympy.Expr]:
        """Of every pair the force that it carries (N), of a slider across its guide."""
        if not self.loaded:
            return [sympy.S.Zero] * len(self.linkage.frictions)
        free = FreeBodies(self.linkage, self.placing, demands(self.linkage, self.placing, steady[self.start :]), self.tape)
        return [self._carried(friction, free) for friction in self.linkage.frictions]

    def _carried(self, friction: PairFriction, free: FreeBodies) -> sympy.Expr:
        if friction.pair is None:
            return sympy.S.Zero
        force = free.given.get((friction.pair, friction.ends[1][0]), Load()).force
        if self._turns(friction):
            whole = self.tape.let(f"{friction.name}_load_square", square(force))
            return self.tape.let(f"{friction.name}_load", Select(less(whole, _NOTHING), 0, sympy.sqrt(whole)))
        across = self.tape.let(f"{friction.name}_across", outer(self.placing.along(friction.pair), force))
        return self.tape.let(f"{friction.name}_load", across * sense(across) if across != 0 else across)

    def _turns(self, friction: PairFriction) -> bool:
        return friction.pair is not None and self.linkage.structure.pairs[friction.pair].kind == "R"

    def _coefficient(self, friction: PairFriction, key: str) -> sympy.Expr:
        return self.tape.let(f"{friction.name}_{key}", expression(getattr(friction, key), self.parameters))


def rubbing_of(
    linkage: Linkage, placing: Placing, parameters: Parameters, start: int, drives: Sequence[int], values: Exprs, tape: Tape
) -> Rubbing:
    """Of a placed linkage; `values` are those of its drives."""
    coordinates = [_coordinate(friction, linkage, placing) for friction in linkage.frictions]
    return Rubbing(linkage, placing, parameters, start, drives, tape, PlanarMotion(tape, values, coordinates))


def _coordinate(friction: PairFriction, linkage: Linkage, placing: Placing) -> Coordinate:
    """What changes while the pair moves."""
    (first, _), (second, _) = friction.ends
    if friction.pair is None:
        points = end_points(friction, placing)
        return Coordinate(friction.name, sympy.sqrt(square(difference(points[1], points[0]))))
    if linkage.structure.pairs[friction.pair].kind == "P":
        return Coordinate(friction.name, placing.measured(friction.pair))
    return Coordinate(friction.name, rotor=turned(conjugate(placing.pose(first).rotor), placing.pose(second).rotor))


def end_points(friction: PairFriction, placing: Placing) -> tuple[Planar, Planar]:
    """Where the pair's ends are in the plane."""
    first, second = (placing.point(body, placing.planar(point)) for body, point in friction.ends)
    return first, second


def demands(linkage: Linkage, placing: Placing, virtual: Exprs) -> dict[int, Load]:
    """By link, what its pairs must give it in the plane: what the tree's joints of each link would.

    Args:
        linkage: bodies and foot.
        placing: where they are.
        virtual: efforts on the tree's coordinates, from the linkage's first on: along X, along Y, about the normal of every link with
            mass, along X and Y of the foot, and about the normal there where joints follow.
    """
    found, rest = dict[int, Load](), iter(virtual)
    for body, mass in linkage.heavy:
        centre = placing.point(body, placing.planar(mass.com))
        found[body] = at(centre, (next(rest), next(rest))) + Load(moment=next(rest))
    body, point = linkage.foot
    foot = at(placing.point(body, placing.planar(point)), (next(rest), next(rest)))
    if linkage.bears:
        foot += Load(moment=next(rest))
    found[body] = found.get(body, Load()) + foot
    return found

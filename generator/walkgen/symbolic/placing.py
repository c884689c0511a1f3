"""Places the bodies of a planar linkage: drives first, then group after group, dyads in closed form and triads by their unknowns."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy

from walkgen.model.linkage import Linkage
from walkgen.spec.assur import Drive, Group, Order, Triad
from walkgen.symbolic.clusters import Clusters
from walkgen.symbolic.frames import Parameters
from walkgen.symbolic.planar import (
    Planar,
    PlanarPose,
    angle_of,
    conjugate,
    difference,
    inner,
    named,
    outer,
    square,
    stretched,
    sum_of,
    turned,
)
from walkgen.symbolic.tape import Tape
from walkgen.symbolic.triads import place_triad, seats, shape, transmission

_ONE = sympy.S.One


@dataclass(frozen=True)
class Margin:
    """How far a group is from where it cannot be assembled: positive while it can, 0 at its dead point, no unit."""

    group: Group | Triad
    value: sympy.Expr


class Placing(Clusters):
    """Every body's pose in its cluster, on a tape.

    Args:
        linkage: points and pairs.
        order: what is placed by what; of the forward or of the inverse problem.
        tape: where it is written.
        values: of driven pairs, by index.
        bars: lengths of driven cylinders, by body.
        signs: of every dyad's name, +1 or -1.
        parameters: the runtime parameters.
        target: where the foot is pinned to the frame, for the inverse.
        root: of what is negative where a group cannot be assembled.
        unknowns: two of every triad, in order.
        held: the point of the foot's link that is pinned at the target; the linkage's foot where left out.
    """

    def __init__(
        self,
        linkage: Linkage,
        order: Order,
        tape: Tape,
        values: Mapping[int, sympy.Expr],
        bars: Mapping[int, sympy.Expr],
        signs: Mapping[str, sympy.Expr],
        parameters: Parameters,
        target: Planar | None = None,
        root: Callable[[sympy.Expr], sympy.Expr] = sympy.sqrt,
        unknowns: Sequence[sympy.Symbol] = (),
        held: Planar | None = None,
    ) -> None:
        super().__init__(linkage, tape, bars, parameters, target, held)
        self.order, self._signs, self._root = order, signs, root
        self.margins: list[Margin] = []
        self.shapes: list[tuple[Planar, ...]] = []
        pending = iter(unknowns)
        for placement in order.placements:
            if isinstance(placement, Drive):
                self.drive(placement, values[placement.pair])
            elif isinstance(placement, Triad):
                self._triad(placement, (next(pending), next(pending)))
            else:
                self._GROUPS[placement.kind](self, placement)

    def rod(self, group: Group) -> tuple[Planar, Planar]:
        """Of an RRP group whose bodies are placed: from pin to sliding pin, and the guide's direction seen from there."""
        slider, third = self.odd_one(group, "P")
        fixed, sliding = (index for index in range(3) if index != third)
        pins = {self.other(group, pair, third): pair for pair in group.pairs if pair != slider}
        along = self.along(slider)
        reach = difference(self.joint(pins[sliding]), self.joint(pins[fixed]))
        return reach, along if group.guide == fixed else stretched(-_ONE, along)

    def ahead(self, group: Group) -> sympy.Expr:
        """Of an RRP group whose bodies are placed: positive where its slider is on the far side of the dead point."""
        return inner(*self.rod(group))

    def measured(self, pair: int) -> sympy.Expr:
        """The value of a pair whose bodies are placed: the second body's angle to the first, or the way along the guide."""
        first, second = self.linkage.structure.pairs[pair].bodies[:2]
        if self.linkage.structure.pairs[pair].kind == "R":
            return angle_of(turned(conjugate(self.pose(first).rotor), self.pose(second).rotor))
        start, now = self.point(second, self.located(pair, second)), self.point(first, self.located(pair, first))
        return inner(self.along(pair), difference(now, start))

    def _rrr(self, group: Group) -> None:
        """The inner pin where two circles meet; 16 times the triangle's area squared says whether they do."""
        base, first, second = (self.cluster[body] for body in group.bodies)
        p, q = (self.end(pair, base) for pair in group.pairs[:2])
        own = [(self.end(pair, body), self.end(group.pairs[2], body)) for pair, body in zip(group.pairs[:2], (first, second), strict=True)]
        name = group.name
        span = named(self.tape, f"{name}_span", difference(q, p))
        apart = self.tape.let(f"{name}_apart", square(span))
        r, s = (self.tape.let(f"{name}_radius", square(difference(*points))) for points in own)
        excess = self.tape.let(f"{name}_excess", apart + r - s)
        area = self.tape.let(f"{name}_area", 4 * apart * r - excess**2)
        self.margins.append(Margin(group, area / (4 * r * s)))
        height = self.tape.let(f"{name}_height", self._signs[group.name] * self._root(area))
        half = self.tape.let(f"{name}_half", 1 / (2 * apart))
        across = (half * (excess * span[0] - height * span[1]), half * (excess * span[1] + height * span[0]))
        pin = named(self.tape, f"{name}_pin", sum_of(p, across))
        self.join(base, first, self.pinned(p, pin, own[0]), f"{group.name}_first")
        self.join(base, second, self.pinned(q, pin, own[1]), f"{group.name}_second")

    def _rrp(self, group: Group) -> None:
        """The slider where its pin is as far from the other pin as the pinned body says."""
        clusters = [self.cluster[body] for body in group.bodies]
        slider, third = self.odd_one(group, "P")
        fixed, sliding = (index for index in range(3) if index != third)
        way = self.way(slider, clusters[fixed], clusters[sliding])
        pins = {self.other(group, pair, third): pair for pair in group.pairs if pair != slider}
        name = group.name
        start, own = self.end(pins[fixed], clusters[fixed]), tuple(self.end(pins[index], clusters[third]) for index in (fixed, sliding))
        run = self.end(pins[sliding], clusters[sliding])
        offset = named(self.tape, f"{name}_offset", difference(way.start.point(run), start))
        across = self.tape.let(f"{name}_across", outer(offset, way.step))
        length = self.tape.let(f"{name}_length", square(difference(own[1], own[0])))
        rest = self.tape.let(f"{name}_rest", length - across**2)
        self.margins.append(Margin(group, rest / length))
        value = self.tape.let(f"{name}_way", self._signs[group.name] * self._root(rest) - inner(offset, way.step))
        moved = way.at(value).named(self.tape, f"{name}_runner")
        hung = self.pinned(start, moved.point(run), (own[0], own[1]))
        self._settle(clusters, {fixed: PlanarPose(), sliding: moved, third: hung}, group)

    def _rpp(self, group: Group) -> None:
        """Two ways that meet in a pin: linear."""
        clusters = [self.cluster[body] for body in group.bodies]
        pin, middle = self.odd_one(group, "R")
        one, two = (index for index in range(3) if index != middle)
        slides = {self.other(group, pair, middle): pair for pair in group.pairs if pair != pin}
        ways = [self.way(slides[index], clusters[middle], clusters[index]) for index in (one, two)]
        name = group.name
        ends = [way.start.point(self.end(pin, clusters[index])) for way, index in zip(ways, (one, two), strict=True)]
        gap = named(self.tape, f"{name}_gap", difference(ends[1], ends[0]))
        sine = self.tape.let(f"{name}_sine", outer(ways[0].step, ways[1].step))
        self.margins.append(Margin(group, sine**2))
        values = (outer(gap, ways[1].step) / sine, outer(gap, ways[0].step) / sine)
        poses = {middle: PlanarPose()}
        for index, way, value in zip((one, two), ways, values, strict=True):
            poses[index] = way.at(self.tape.let(f"{name}_way", value))
        self._settle(clusters, poses, group)

    def _triad(self, triad: Triad, unknowns: tuple[sympy.Symbol, sympy.Symbol]) -> None:
        """Its two unknowns are what closes it."""
        seated = seats(self, triad)
        self.tape.close(unknowns, place_triad(self, triad, unknowns))
        self.shapes.append(shape(self, triad, seated))
        push, velocity = transmission(self, triad)
        rate = self.tape.let(f"{triad.name}_rate", inner(push, velocity))
        self.margins.append(Margin(triad, rate**2 / (square(push) * square(velocity))))

    def _pantograph(self, group: Group) -> None:
        """Two sliders whose pins the foot keeps in line: middle = ratio * top + (1 - ratio) * foot, linear in both."""
        found = self.linkage.structure.pantograph
        assert found is not None
        assert self.target is not None
        base, top, middle = (self.cluster[body] for body in group.bodies)
        ways = self.way(group.pairs[0], base, top), self.way(group.pairs[1], base, middle)
        x, y = (sympy.Rational(part.numerator, part.denominator) for part in found.ratio)
        ends = ways[0].start.point(self.end(found.top, top)), ways[1].start.point(self.end(found.middle, middle))
        wanted = sum_of(turned((x, y), ends[0]), turned((1 - x, -y), self.target))
        gap = named(self.tape, "pantograph_gap", difference(wanted, ends[1]))
        back = named(self.tape, "pantograph_back", stretched(-_ONE, turned((x, y), ways[0].step)))
        sine = self.tape.let("pantograph_sine", outer(ways[1].step, back))
        self.margins.append(Margin(group, sine**2 / square(back)))
        values = outer(ways[1].step, gap) / sine, outer(gap, back) / sine
        for way, cluster, value, name in zip(ways, (top, middle), values, ("top", "middle"), strict=True):
            self.join(base, cluster, way.at(self.tape.let(f"pantograph_{name}", value)), f"pantograph_{name}")

    def _spanned(self, group: Group) -> None:
        """A body by two pins whose places are known."""
        base, cluster = self.cluster[group.bodies[0]], self.cluster[group.bodies[1]]
        (p, q), own = ([self.end(pair, where) for pair in group.pairs[:2]] for where in (base, cluster))
        self.join(base, cluster, self.pinned(p, q, (own[0], own[1])), group.name)

    def _settle(self, clusters: Sequence[int], poses: Mapping[int, PlanarPose], group: Group) -> None:
        """Join first and second to the base, whatever the poses are relative to."""
        back = poses[0].named(self.tape, f"{group.name}_base").inverse()
        for index, name in ((1, "first"), (2, "second")):
            self.join(clusters[0], clusters[index], back * poses[index], f"{group.name}_{name}")

    def odd_one(self, group: Group, kind: str) -> tuple[int, int]:
        """The one pair of this kind, and which of the three bodies has no part in it."""
        place = next(index for index, pair in enumerate(group.pairs) if self.kind(pair) == kind)
        return group.pairs[place], 2 - place

    def other(self, group: Group, pair: int, index: int) -> int:
        """Which body a pair joins with the one of this index."""
        return sum(((0, 1), (0, 2), (1, 2))[group.pairs.index(pair)]) - index

    _GROUPS: ClassVar = {"RRR": _rrr, "RRP": _rrp, "RPP": _rpp, "pantograph": _pantograph, "spanned": _spanned}

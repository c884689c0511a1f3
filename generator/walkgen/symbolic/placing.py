"""Places the bodies of a planar linkage: drives first, then dyad after dyad in closed form (Assur groups of class II)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy

from walkgen.model.linkage import Linkage, Point
from walkgen.spec.assur import Drive, Group, Order
from walkgen.symbolic.frames import Parameters, cosine_sine, expression
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
from walkgen.symbolic.tape import Tape, constant

_ONE = sympy.S.One


@dataclass(frozen=True)
class Way:
    """Where one body lies in another's axes: `start` where the slider between them is at 0, moving along `step` per unit."""

    start: PlanarPose
    step: Planar

    def at(self, value: sympy.Expr) -> PlanarPose:
        """The pose at the slider's value."""
        return PlanarPose(sum_of(self.start.origin, stretched(value, self.step)), self.start.rotor)


@dataclass(frozen=True)
class Margin:
    """How far a group is from where it cannot be assembled: positive while it can, 0 at its dead point, no unit."""

    group: Group
    value: sympy.Expr


class Placing:
    """Every body's pose in its cluster, on a tape.

    Args:
        linkage: points and pairs.
        order: what is placed by what; of the forward or of the inverse problem.
        tape: where it is written.
        values: of driven pairs, by index.
        bars: lengths of driven cylinders, by body.
        signs: of every group's name, +1 or -1.
        parameters: the runtime parameters.
        target: where the foot is pinned to the frame, for the inverse.
        root: of what is negative where a group cannot be assembled.
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
    ) -> None:
        self._linkage, self._tape, self._parameters = linkage, tape, parameters
        self._values, self._bars, self._signs, self._target, self._root = values, bars, signs, target, root
        count = len(linkage.structure.names)
        self._cluster = list(range(count))
        self._pose = [PlanarPose() for _ in range(count)]
        self.margins: list[Margin] = []
        for placement in order.placements:
            if isinstance(placement, Drive):
                self._drive(placement)
            else:
                self._GROUPS[placement.kind](self, placement)

    def pose(self, body: int) -> PlanarPose:
        """Of a body in the frame, once it is placed."""
        assert self._cluster[body] == self._cluster[0]
        return self._pose[body]

    def point(self, body: int, point: Planar) -> Planar:
        """A point of a body in the frame's axes."""
        return self.pose(body).point(point)

    def located(self, pair: int, body: int) -> Planar:
        """The point where a pair meets one of its bodies, in that body's axes."""
        if pair == len(self._linkage.points):
            assert self._target is not None
            return self._target if body == 0 else self.planar(self._linkage.foot[1])
        end = self._linkage.points[pair][self._linkage.structure.pairs[pair].bodies.index(body)]
        return (self._bars[body], sympy.S.Zero) if end is None else self.planar(end)

    def planar(self, point: Point) -> Planar:
        """A point of the spec."""
        x, y = (expression(entry, self._parameters) for entry in point)
        return (constant(x) if x.is_number else x, constant(y) if y.is_number else y)

    def joint(self, pair: int) -> Planar:
        """Where a pair is, in the frame's axes: a pin, or a slider's sliding point."""
        body = next(body for body in self._bodies(pair) if body not in self._linkage.structure.bars)
        return self.point(body, self.located(pair, body))

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
        first, second = self._linkage.structure.pairs[pair].bodies[:2]
        if self._linkage.structure.pairs[pair].kind == "R":
            return angle_of(turned(conjugate(self.pose(first).rotor), self.pose(second).rotor))
        start, now = self.point(second, self.located(pair, second)), self.point(first, self.located(pair, first))
        return inner(self.along(pair), difference(now, start))

    def along(self, slider: int) -> Planar:
        """The direction of a slider's guide, in the frame's axes."""
        return turned(self.pose(self._linkage.structure.pairs[slider].bodies[1]).rotor, self._direction(slider))

    def _bodies(self, pair: int) -> tuple[int, ...]:
        return (0, self._linkage.foot[0]) if pair == len(self._linkage.points) else self._linkage.structure.pairs[pair].bodies

    def _direction(self, pair: int) -> Planar:
        """Of a slider's guide, in its body's axes."""
        cosine, sine = cosine_sine(expression(self._linkage.angles[pair], self._parameters))
        return (cosine, sine)

    def _end(self, pair: int, cluster: int) -> Planar:
        """Where the pair meets a cluster, in the cluster's axes."""
        body = next(body for body in self._bodies(pair) if self._cluster[body] == cluster)
        return self._pose[body].point(self.located(pair, body))

    def _join(self, base: int, moved: int, pose: PlanarPose, name: str) -> None:
        """Put a cluster, whose pose in the base's axes is found, among the base's bodies; the frame's cluster takes the other in."""
        if self._cluster[0] == moved:
            base, moved, pose = moved, base, pose.inverse()
        pose = pose.named(self._tape, name)
        for body, cluster in enumerate(self._cluster):
            if cluster == moved:
                joined = pose * self._pose[body]
                self._pose[body] = joined.named(self._tape, self._linkage.structure.names[body])
                self._cluster[body] = base

    def _drive(self, drive: Drive) -> None:
        base, moved, value = self._cluster[drive.base], self._cluster[drive.moved], self._values[drive.pair]
        pair = self._linkage.structure.pairs[drive.pair]
        if pair.kind == "P":
            self._join(base, moved, self._way(drive.pair, base, moved).at(value), pair.name)
            return
        turn = (self._tape.let(f"cos_{pair.name}", sympy.cos(value)), self._tape.let(f"sin_{pair.name}", sympy.sin(value)))
        rotor = turned(turned(self._pose[drive.base].rotor, turn), conjugate(self._pose[drive.moved].rotor))
        origin = difference(self._end(drive.pair, base), turned(rotor, self._end(drive.pair, moved)))
        self._join(base, moved, PlanarPose(origin, rotor), pair.name)

    def _way(self, pair: int, base: int, moved: int) -> Way:
        """A cluster in another's axes along the slider between them."""
        runner, guide = self._linkage.structure.pairs[pair].bodies
        along = turned(self._pose[guide].rotor, self._direction(pair))
        if self._cluster[guide] == base:
            rotor = turned(self._pose[guide].rotor, conjugate(self._pose[runner].rotor))
        else:
            rotor = turned(self._pose[runner].rotor, conjugate(self._pose[guide].rotor))
            along = stretched(-_ONE, turned(rotor, along))
        origin = difference(self._end(pair, base), turned(rotor, self._end(pair, moved)))
        return Way(PlanarPose(origin, rotor), along)

    def _pinned(self, start: Planar, end: Planar, own: tuple[Planar, Planar]) -> PlanarPose:
        """The pose of a body two of whose points lie at start and end."""
        span = difference(own[1], own[0])
        rotor = stretched(1 / square(span), turned(difference(end, start), conjugate(span)))
        return PlanarPose(difference(start, turned(rotor, own[0])), rotor)

    def _rrr(self, group: Group) -> None:
        """The inner pin where two circles meet; 16 times the triangle's area squared says whether they do."""
        base, first, second = (self._cluster[body] for body in group.bodies)
        p, q = (self._end(pair, base) for pair in group.pairs[:2])
        own = [
            (self._end(pair, body), self._end(group.pairs[2], body)) for pair, body in zip(group.pairs[:2], (first, second), strict=True)
        ]
        name = group.name
        span = named(self._tape, f"{name}_span", difference(q, p))
        apart = self._tape.let(f"{name}_apart", square(span))
        r, s = (self._tape.let(f"{name}_radius", square(difference(*points))) for points in own)
        excess = self._tape.let(f"{name}_excess", apart + r - s)
        area = self._tape.let(f"{name}_area", 4 * apart * r - excess**2)
        self.margins.append(Margin(group, area / (4 * r * s)))
        height = self._tape.let(f"{name}_height", self._signs[group.name] * self._root(area))
        half = self._tape.let(f"{name}_half", 1 / (2 * apart))
        across = (half * (excess * span[0] - height * span[1]), half * (excess * span[1] + height * span[0]))
        pin = named(self._tape, f"{name}_pin", sum_of(p, across))
        self._join(base, first, self._pinned(p, pin, own[0]), f"{group.name}_first")
        self._join(base, second, self._pinned(q, pin, own[1]), f"{group.name}_second")

    def _rrp(self, group: Group) -> None:
        """The slider where its pin is as far from the other pin as the pinned body says."""
        clusters = [self._cluster[body] for body in group.bodies]
        slider, third = self.odd_one(group, "P")
        fixed, sliding = (index for index in range(3) if index != third)
        way = self._way(slider, clusters[fixed], clusters[sliding])
        pins = {self.other(group, pair, third): pair for pair in group.pairs if pair != slider}
        name = group.name
        start, own = self._end(pins[fixed], clusters[fixed]), tuple(self._end(pins[index], clusters[third]) for index in (fixed, sliding))
        run = self._end(pins[sliding], clusters[sliding])
        offset = named(self._tape, f"{name}_offset", difference(way.start.point(run), start))
        across = self._tape.let(f"{name}_across", outer(offset, way.step))
        length = self._tape.let(f"{name}_length", square(difference(own[1], own[0])))
        rest = self._tape.let(f"{name}_rest", length - across**2)
        self.margins.append(Margin(group, rest / length))
        value = self._tape.let(f"{name}_way", self._signs[group.name] * self._root(rest) - inner(offset, way.step))
        moved = way.at(value).named(self._tape, f"{name}_runner")
        hung = self._pinned(start, moved.point(run), (own[0], own[1]))
        self._settle(clusters, {fixed: PlanarPose(), sliding: moved, third: hung}, group)

    def _rpp(self, group: Group) -> None:
        """Two ways that meet in a pin: linear."""
        clusters = [self._cluster[body] for body in group.bodies]
        pin, middle = self.odd_one(group, "R")
        one, two = (index for index in range(3) if index != middle)
        slides = {self.other(group, pair, middle): pair for pair in group.pairs if pair != pin}
        ways = [self._way(slides[index], clusters[middle], clusters[index]) for index in (one, two)]
        name = group.name
        ends = [way.start.point(self._end(pin, clusters[index])) for way, index in zip(ways, (one, two), strict=True)]
        gap = named(self._tape, f"{name}_gap", difference(ends[1], ends[0]))
        sine = self._tape.let(f"{name}_sine", outer(ways[0].step, ways[1].step))
        self.margins.append(Margin(group, sine**2))
        values = (outer(gap, ways[1].step) / sine, outer(gap, ways[0].step) / sine)
        poses = {middle: PlanarPose()}
        for index, way, value in zip((one, two), ways, values, strict=True):
            poses[index] = way.at(self._tape.let(f"{name}_way", value))
        self._settle(clusters, poses, group)

    def _pantograph(self, group: Group) -> None:
        """Two sliders whose pins the foot keeps in line: middle = ratio * top + (1 - ratio) * foot, linear in both."""
        found = self._linkage.structure.pantograph
        assert found is not None
        assert self._target is not None
        base, top, middle = (self._cluster[body] for body in group.bodies)
        ways = self._way(group.pairs[0], base, top), self._way(group.pairs[1], base, middle)
        x, y = (sympy.Rational(part.numerator, part.denominator) for part in found.ratio)
        ends = ways[0].start.point(self._end(found.top, top)), ways[1].start.point(self._end(found.middle, middle))
        wanted = sum_of(turned((x, y), ends[0]), turned((1 - x, -y), self._target))
        gap = named(self._tape, "pantograph_gap", difference(wanted, ends[1]))
        back = named(self._tape, "pantograph_back", stretched(-_ONE, turned((x, y), ways[0].step)))
        sine = self._tape.let("pantograph_sine", outer(ways[1].step, back))
        self.margins.append(Margin(group, sine**2 / square(back)))
        values = outer(ways[1].step, gap) / sine, outer(gap, back) / sine
        for way, cluster, value, name in zip(ways, (top, middle), values, ("top", "middle"), strict=True):
            self._join(base, cluster, way.at(self._tape.let(f"pantograph_{name}", value)), f"pantograph_{name}")

    def _spanned(self, group: Group) -> None:
        """A body by two pins whose places are known."""
        base, cluster = self._cluster[group.bodies[0]], self._cluster[group.bodies[1]]
        (p, q), own = ([self._end(pair, where) for pair in group.pairs[:2]] for where in (base, cluster))
        self._join(base, cluster, self._pinned(p, q, (own[0], own[1])), group.name)

    def _settle(self, clusters: Sequence[int], poses: Mapping[int, PlanarPose], group: Group) -> None:
        """Join first and second to the base, whatever the poses are relative to."""
        back = poses[0].named(self._tape, f"{group.name}_base").inverse()
        for index, name in ((1, "first"), (2, "second")):
            self._join(clusters[0], clusters[index], back * poses[index], f"{group.name}_{name}")

    def odd_one(self, group: Group, kind: str) -> tuple[int, int]:
        """The one pair of this kind, and which of the three bodies has no part in it."""
        place = next(index for index, pair in enumerate(group.pairs) if self._kind(pair) == kind)
        return group.pairs[place], 2 - place

    def other(self, group: Group, pair: int, index: int) -> int:
        """Which body a pair joins with the one of this index."""
        return sum(((0, 1), (0, 2), (1, 2))[group.pairs.index(pair)]) - index

    def _kind(self, pair: int) -> str:
        return "R" if pair == len(self._linkage.points) else self._linkage.structure.pairs[pair].kind

    _GROUPS: ClassVar = {"RRR": _rrr, "RRP": _rrp, "RPP": _rpp, "pantograph": _pantograph, "spanned": _spanned}

"""Forces in the pairs of a planar linkage, body by body: what is placed last is cut free first, and hands its load on."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy

from walkgen.model.linkage import Linkage
from walkgen.spec.assur import Drive, Group, Order, Placement, Strut, Triad
from walkgen.symbolic.placing import Placing
from walkgen.symbolic.planar import Planar, difference, inner, outer, square, stretched, sum_of
from walkgen.symbolic.tape import Tape

_ZERO = sympy.S.Zero


@dataclass(frozen=True)
class Load:
    """A force and its moment about the plane's origin."""

    force: Planar = (_ZERO, _ZERO)
    moment: sympy.Expr = _ZERO

    def __add__(self, other: "Load") -> "Load":
        return Load(sum_of(self.force, other.force), self.moment + other.moment)

    def __neg__(self) -> "Load":
        return Load(stretched(sympy.S.NegativeOne, self.force), -self.moment)

    def times(self, factor: sympy.Expr) -> "Load":
        """A multiple."""
        return Load(stretched(factor, self.force), factor * self.moment)

    def about(self, point: Planar) -> sympy.Expr:
        """Its moment about a point."""
        return self.moment - outer(point, self.force)

    def named(self, tape: Tape, name: str) -> "Load":
        """Short expressions."""
        x, y = self.force
        return Load((tape.let(f"{name}_x", x), tape.let(f"{name}_y", y)), tape.let(f"{name}_m", self.moment))


def at(point: Planar, force: Planar) -> Load:
    """A force at a point."""
    return Load(force, outer(point, force))


class FreeBodies:
    """What every pair does to the bodies that it joins.

    Args:
        linkage: pairs and bodies.
        placing: their places for the drives' values.
        demands: by body, what its pairs must give it: mass times acceleration, less gravity and other loads.
        tape: where it is written.
    """

    def __init__(self, linkage: Linkage, placing: Placing, demands: Mapping[int, Load], tape: Tape) -> None:
        self._linkage, self._placing, self._tape = linkage, placing, tape
        self._pairs = linkage.structure.pairs
        self._demand = [demands.get(body, Load()) for body in range(len(linkage.structure.names))]
        self.given: dict[tuple[int, int], Load] = {}
        history = list(_history(linkage.forward, len(linkage.structure.names)))
        for placement, clusters in reversed(history):
            if isinstance(placement, Drive):
                self._drive(placement, clusters)
            elif isinstance(placement, Triad):
                self._triad(placement, clusters)
            else:
                self._GROUPS[placement.kind](self, placement, clusters)

    def _whole(self, cluster: frozenset[int]) -> Load:
        """What a cluster's pairs to others must give it."""
        total = Load()
        for body in sorted(cluster):
            total += self._demand[body]
        return total

    def _point(self, pair: int) -> Planar:
        return self._placing.joint(pair)

    def _give(self, pair: int, cluster: frozenset[int], other: frozenset[int], load: Load) -> None:
        """A pair's load on its body of the cluster, the opposite on its body of the other."""
        receiver, giver = (next(body for body in self._pairs[pair].bodies if body in part) for part in (cluster, other))
        load = load.named(self._tape, f"on_{self._linkage.structure.names[receiver]}_at_{self._pairs[pair].name}")
        for body, own in ((receiver, load), (giver, -load)):
            self.given[pair, body] = self.given.get((pair, body), Load()) + own
            self._demand[body] = self._demand[body] + -own

    def _drive(self, drive: Drive, clusters: list[frozenset[int]]) -> None:
        """Everything that the moved cluster needs comes through its driven pair."""
        moved, base = (_of(body, clusters) for body in (drive.moved, drive.base))
        if 0 in moved:
            moved, base = base, moved
        self._give(drive.pair, moved, base, self._whole(moved))

    def _rrr(self, group: Group, clusters: list[frozenset[int]]) -> None:
        """Moments about the outer pins give the force in the inner one."""
        base, first, second = (_of(body, clusters) for body in group.bodies)
        p, q, pin = (self._point(pair) for pair in group.pairs)
        needs = self._whole(first), self._whole(second)
        force = self._crossed(difference(pin, p), difference(pin, q), needs[0].about(p), -needs[1].about(q))
        joint = at(pin, force)
        self._give(group.pairs[2], first, second, joint)
        self._give(group.pairs[0], first, base, needs[0] + -joint)
        self._give(group.pairs[1], second, base, needs[1] + joint)

    def _rrp(self, group: Group, clusters: list[frozenset[int]]) -> None:
        """The pin of the sliding body: its moment about the other pin, and its part along the guide, are known."""
        bodies = [_of(body, clusters) for body in group.bodies]
        slider, third = self._placing.odd_one(group, "P")
        fixed, sliding = (index for index in range(3) if index != third)
        pins = {self._placing.other(group, pair, third): pair for pair in group.pairs if pair != slider}
        start, run, along = self._point(pins[fixed]), self._point(pins[sliding]), self._placing.along(slider)
        needs = [self._whole(body) for body in bodies]
        hung = needs[third] if third else needs[fixed] + needs[sliding]
        push = inner(needs[sliding].force, along)
        force = self._crossed(difference(run, start), _normal(along), hung.about(start), -push if third else push)
        joint = at(run, force)
        receivers = (third, third) if third else (sliding, fixed)
        for pair, receiver, load in zip((pins[sliding], pins[fixed]), receivers, (joint, hung + -joint), strict=True):
            self._give(pair, bodies[receiver], bodies[self._placing.other(group, pair, receiver)], load)
        self._give(slider, bodies[sliding], bodies[fixed], needs[sliding] + (joint if third else -joint))

    def _rpp(self, group: Group, clusters: list[frozenset[int]]) -> None:
        """The pin's force along both guides is known."""
        bodies = [_of(body, clusters) for body in group.bodies]
        pin, middle = self._placing.odd_one(group, "R")
        one, two = (index for index in range(3) if index != middle)
        slides = {self._placing.other(group, pair, middle): pair for pair in group.pairs if pair != pin}
        ways = [self._placing.along(slides[index]) for index in (one, two)]
        needs = [self._whole(body) for body in bodies]
        first = needs[one] if middle == 0 else -(needs[middle] + needs[two])
        force = self._crossed(_normal(ways[0]), _normal(ways[1]), inner(first.force, ways[0]), -inner(needs[two].force, ways[1]))
        joint = at(self._point(pin), force)
        self._give(pin, bodies[one], bodies[two], joint)
        self._give(slides[two], bodies[two], bodies[middle], needs[two] + joint)
        if middle == 0:
            self._give(slides[one], bodies[one], bodies[middle], needs[one] + -joint)
        else:
            self._give(slides[one], bodies[middle], bodies[one], needs[middle] + needs[two] + joint)

    def _triad(self, triad: Triad, clusters: list[frozenset[int]]) -> None:
        """Every strut but the first leaves its push unknown; both follow from what the first strut's pairs cannot carry."""
        first, *others = triad.struts
        ends = [_of(body, clusters) for body in triad.ends]
        base, own = _of(triad.bodies[0], clusters), _of(first.body, clusters)
        pushes = [self._push(strut, _of(strut.body, clusters)) for strut in others]
        lacks = [self._whole(end) for end in ends]  # of the ends, from the first strut, but for the pushes
        for (known, _), strut in zip(pushes, others, strict=True):
            lacks = [lacks[0] + self._whole(_of(strut.body, clusters)) + -known, lacks[1] + known]
        factors = [-1, 1]
        if base != own:  # the end that is not the base hands its load on through the strut
            near = ends.index(base)
            lacks[near], factors[near] = lacks[1 - near] + self._whole(own), factors[1 - near]
        rests = [self._carried(pair, lack) for pair, lack in zip(first.pairs, lacks, strict=True)]
        rows = [[factor * self._carried(pair, push) for _, push in pushes] for pair, factor in zip(first.pairs, factors, strict=True)]
        size = self._tape.let("pushes", rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0])
        found = (rows[0][1] * rests[1] - rows[1][1] * rests[0]) / size, (rows[1][0] * rests[0] - rows[0][0] * rests[1]) / size
        for factor, (known, push), strut in zip(found, pushes, others, strict=True):
            held = _of(strut.body, clusters)
            self._give(strut.pairs[1], held, ends[1], known + push.times(self._tape.let("push", factor)))
            self._give(strut.pairs[0], held, ends[0], self._whole(held))
        order = [1, 0] if base == ends[0] else [0, 1]
        for place in order:
            outer_part = ends[place] if ends[place] != base else own
            self._give(first.pairs[place], outer_part, own if outer_part != own else base, self._whole(outer_part))

    def _carried(self, pair: int, load: Load) -> sympy.Expr:
        """What a pair cannot carry: a pin's moment, a slider's force along its guide."""
        if self._pairs[pair].kind == "R":
            return self._tape.let("moment", load.about(self._point(pair)))
        return self._tape.let("along", inner(load.force, self._placing.along(pair)))

    def _push(self, strut: Strut, held: frozenset[int]) -> tuple[Load, Load]:
        """What a triad's second end gives a strut that the first end holds: what it needs, and what it may have as well."""
        need, points = self._whole(held), [self._point(pair) for pair in strut.pairs]
        ways = [None if self._pairs[pair].kind == "R" else self._placing.along(pair) for pair in strut.pairs]
        if ways[0] is None and ways[1] is None:
            span = difference(points[1], points[0])
            turn = self._tape.let("turn", need.about(points[0]) / square(span))
            return at(points[1], (-turn * span[1], turn * span[0])), at(points[1], span)
        if ways[0] is None or ways[1] is None:
            return self._push_of_one_slider(need, points, ways)
        across = _normal(ways[1])
        force = stretched(inner(need.force, ways[0]) / inner(across, ways[0]), across)
        return at(points[1], force), Load(moment=sympy.S.One)

    def _push_of_one_slider(self, need: Load, points: Sequence[Planar], ways: Sequence[Planar | None]) -> tuple[Load, Load]:
        if ways[1] is None:
            assert ways[0] is not None
            return at(points[1], stretched(inner(need.force, ways[0]), ways[0])), at(points[1], _normal(ways[0]))
        return Load(moment=need.about(points[0])), at(points[0], _normal(ways[1]))

    def _crossed(self, a: Planar, b: Planar, moment_a: sympy.Expr, moment_b: sympy.Expr) -> Planar:
        """The force whose moments with two levers are known."""
        size = self._tape.let("levers", outer(a, b))
        x, y = (self._tape.let("pin_force", (b[axis] * moment_a - a[axis] * moment_b) / size) for axis in range(2))
        return (x, y)

    _GROUPS: ClassVar = {"RRR": _rrr, "RRP": _rrp, "RPP": _rpp}


def _normal(along: Planar) -> Planar:
    """The lever with which a force has its part along a direction as its moment."""
    return (along[1], -along[0])


def _of(body: int, clusters: Iterable[frozenset[int]]) -> frozenset[int]:
    return next(cluster for cluster in clusters if body in cluster)


def _history(order: Order, count: int) -> Iterable[tuple[Placement, list[frozenset[int]]]]:
    """Every placement with the clusters before it."""
    clusters = [frozenset({body}) for body in range(count)]
    for placement in order.placements:
        yield placement, clusters
        bodies = (placement.base, placement.moved) if isinstance(placement, Drive) else placement.bodies
        joined = frozenset().union(*(_of(body, clusters) for body in bodies))
        clusters = [cluster for cluster in clusters if not cluster & joined] + [joined]

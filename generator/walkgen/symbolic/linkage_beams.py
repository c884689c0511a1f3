"""Links of a planar linkage as straight beams: how far the foot yields while the drives are held (theory 4.3).

In the plane every pair's load follows from a unit load on the foot by free bodies, so that the links' energy is known. Out of the plane,
where rigid links in parallel planes cannot tell how they share a load, it goes the way of the fewest pairs from foot to frame.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, combinations_with_replacement
from math import hypot

import sympy

from walkgen.model.linkage import Linkage, Point
from walkgen.model.mechanism import Limb, Mechanism, Section
from walkgen.model.walk import number
from walkgen.spec.scalar import Scalar
from walkgen.symbolic.beams import Beam, Rows, beams_of, limb_beams
from walkgen.symbolic.choices import chosen, less
from walkgen.symbolic.driven import DrivenKinematics
from walkgen.symbolic.frames import expression
from walkgen.symbolic.free_bodies import FreeBodies, Load, at
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.planar import Planar, conjugate, difference, inner, outer, square, stretched, sum_of, turned
from walkgen.symbolic.tape import Columns, Tape, Vec, cross, dot, minus, plus, scaled

Exprs = Sequence[sympy.Expr]
_ZERO, _ONE = sympy.S.Zero, sympy.S.One
_SAME = 1e-12
"""m: so near to a beam's end is at it."""


@dataclass(frozen=True)
class PlanarYield:
    """How a linkage yields in its plane: `matrix` [3][3] maps force along X, Y and moment on the link at its end to that link's motion.

    `axes` are X, Y and the normal, `end` is the linkage's end, in the path's base axes. Its methods are those of `Beam`.
    """

    axes: Columns
    matrix: tuple[tuple[sympy.Expr, ...], ...]
    end: Vec

    def shared(self, first: Vec, second: Vec, tape: Tape) -> Rows:
        """How far the first point yields [3] for a unit force [3] in the second, both beyond the linkage."""
        left, right = self._ways(first, tape), self._ways(second, tape)
        halves = [self._mixed(row, right, tape) for row in self.matrix[: len(left)]]
        return [[dot([way[row] for way in left], [half[column] for half in halves]) for column in range(3)] for row in range(3)]

    def twisted(self, point: Vec, tape: Tape) -> Rows:
        """How far a point beyond the linkage yields [3] for a unit moment [3] there."""
        moved = self._mixed(self.matrix[2], self._ways(point, tape), tape)
        return [[moved[row] * self.axes[2][column] for column in range(3)] for row in range(3)]

    def turned(self, tape: Tape) -> Rows:
        """How far what is beyond the linkage turns [3] for a unit moment [3] on it."""
        normal = self.axes[2]
        turn = tape.let("planar", self.matrix[2][2])
        return [[turn * normal[row] * normal[column] for column in range(3)] for row in range(3)]

    def _ways(self, point: Vec, tape: Tape) -> tuple[Vec, ...]:
        """How a point moves with the end along X, along Y, and where it is elsewhere about the normal."""
        x, y, normal = self.axes
        if point == self.end:
            return (x, y)
        return (x, y, tape.vector("swing", cross(normal, tape.vector("arm", minus(point, self.end)))))

    @staticmethod
    def _mixed(factors: Exprs, ways: Sequence[Vec], tape: Tape) -> Vec:
        x, y, z = (dot(factors[: len(ways)], [way[row] for way in ways]) for row in range(3))
        return tape.vector("planar", (x, y, z))


Yielding = Beam | PlanarYield


def yields_of(
    mechanism: Mechanism, limbs: Sequence[Limb], kinematics: Kinematics | DrivenKinematics
) -> tuple[tuple[Yielding | None, ...], ...]:
    """What yields of every limb of a path: a beam a joint in series, then the links of a linkage."""
    if isinstance(kinematics, Kinematics):
        return beams_of(mechanism, limbs, kinematics)
    leg, linkage = limbs[-1], limbs[-1].linkage
    assert linkage is not None
    path = kinematics.carrier
    *found, own = beams_of(mechanism, (*limbs[:-1], leg.inner), path)
    after = limb_beams(mechanism, leg.outer, path, len(path.path.joints) - leg.beyond)
    return (*found, (*own, *LinkageBeams(mechanism, linkage, kinematics).all(), *after))


@dataclass(frozen=True)
class _Pushed:
    """A load on a beam: where (m, from its far end, negative), and force along and across it (N) and moment (N m)."""

    at: sympy.Expr
    along: sympy.Expr
    across: sympy.Expr
    moment: sympy.Expr


@dataclass(frozen=True)
class _Axis:
    """A link's beam in the link's axes: its far end, its direction, its length."""

    end: Planar
    way: Planar
    length: sympy.Expr


class LinkageBeams:
    """Of a linkage placed on the path's tape."""

    def __init__(self, mechanism: Mechanism, linkage: Linkage, kinematics: DrivenKinematics) -> None:
        self._mechanism, self._linkage, self._kinematics = mechanism, linkage, kinematics
        self._placing, self._tape = kinematics.placing, kinematics.tape

    def all(self) -> Iterator[Yielding]:
        """All links in the plane as one, then those that carry loads out of it."""
        energy = [self._energy(body) for body in range(1, len(self._linkage.structure.names)) if self._linkage.sections[body]]
        rows = [[_ZERO] * 3 for _ in range(3)]
        for row, column in combinations_with_replacement(range(3), 2):
            entry = self._tape.let("flexible", sympy.Add(*(each[row, column] for each in energy)))
            rows[row][column] = rows[column][row] = entry
        yield PlanarYield(self._kinematics.plane, tuple(map(tuple, rows)), self._kinematics.end)
        yield from self._out_of_plane()

    # ---- in the plane

    @cached_property
    def _foot(self) -> Planar:
        body, point = self._linkage.foot
        return self._placing.point(body, self._placing.planar(point))

    @cached_property
    def _loads(self) -> tuple[Load, Load, Load]:
        """Units on the foot's link."""
        return at(self._foot, (_ONE, _ZERO)), at(self._foot, (_ZERO, _ONE)), Load(moment=_ONE)

    @cached_property
    def _carried(self) -> tuple[FreeBodies, ...]:
        """What pairs give their links under each of them."""
        return tuple(FreeBodies(self._linkage, self._placing, {self._linkage.foot[0]: -load}, self._tape) for load in self._loads)

    def _energy(self, body: int) -> dict[tuple[int, int], sympy.Expr]:
        """Twice the mutual energy of a link under every two of the loads."""
        if body in self._linkage.structure.bars:
            return self._stretched(body)
        axis, section = self._axis(body), self._section(body)
        pairs = list(combinations_with_replacement(range(3), 2))
        if axis is None:
            return dict.fromkeys(pairs, _ZERO)
        pushed = [self._pushed(body, axis, load) for load in range(3)]
        stretch, bend = (1 / (self._number(section.E) * self._number(size)) for size in (section.A, section.Iz))
        return {(a, b): self._tape.let("energy", _mutual(pushed[a], pushed[b], stretch, bend, self._tape)) for a, b in pairs}

    def _stretched(self, bar: int) -> dict[tuple[int, int], sympy.Expr]:
        """Of a driven cylinder, which only pushes."""
        section = self._section(bar)
        pair = next(index for index, ends in enumerate(self._linkage.points) if None in ends and bar in self._bodies(index))
        way = self._placing.pose(bar).rotor
        thrust = [self._tape.let("thrust", inner(way, each.given.get((pair, bar), Load()).force)) for each in self._carried]
        soft = self._placing.located(pair, bar)[0] / (self._number(section.E) * self._number(section.A))
        return {(a, b): self._tape.let("energy", soft * thrust[a] * thrust[b]) for a, b in combinations_with_replacement(range(3), 2)}

    def _pushed(self, body: int, axis: _Axis, load: int) -> list[_Pushed]:
        """Everything that acts on a link under one of the loads, but at the far end of its beam, where it bends nothing."""
        found = []
        for pair in self._pairs(body):
            given = self._carried[load].given.get((pair, body), Load())
            found += self._acting(body, axis, self._where(pair, body), given.force, given.about(self._placing.joint(pair)))
        if body == self._linkage.foot[0]:
            unit = self._loads[load]
            found += self._acting(body, axis, self._placing.planar(self._linkage.foot[1]), unit.force, unit.about(self._foot))
        return found

    def _acting(self, body: int, axis: _Axis, point: Planar, force: Planar, moment: sympy.Expr) -> list[_Pushed]:
        """A load at a point of a link, handed on to its beam by an arm across it, beyond its ends along it."""
        own = turned(conjugate(self._placing.pose(body).rotor), force)
        along, across = inner(axis.way, own), outer(axis.way, own)
        away = difference(point, axis.end)
        place, aside = (self._tape.let("on_beam", part) for part in (inner(axis.way, away), outer(axis.way, away)))
        here = self._on(axis, place)
        if here == 0:
            return []
        names = zip(("along", "across", "moment"), (along, across, moment - aside * along + (place - here) * across), strict=True)
        return [_Pushed(here, *(self._tape.let(name, value) for name, value in names))]

    def _on(self, axis: _Axis, place: sympy.Expr) -> sympy.Expr:
        """A place on the beam; those that move with a drive are kept between its ends."""
        if not place.free_symbols - set(self._kinematics.parameters.values()):
            return _ZERO if place.is_number and abs(place) < _SAME else place
        inside = chosen(less(place, -axis.length), -axis.length, place)
        return self._tape.let("inside", chosen(less(_ZERO, inside), _ZERO, inside))

    # ---- out of the plane

    def _out_of_plane(self) -> Iterator[Beam]:
        """Links between the foot and the frame, by torsion and by bending across the plane."""
        way = self._way()
        for (body, near), (_, far) in zip(way, [(0, None), *way], strict=False):
            axis = self._axis(body) if self._linkage.sections[body] and body not in self._linkage.structure.bars else None
            if axis is not None:
                places = [self._on(axis, inner(axis.way, difference(self._end(body, pair), axis.end))) for pair in (near, far)]
                yield from self._across(body, axis, places)

    def _across(self, body: int, axis: _Axis, places: Exprs) -> Iterator[Beam]:
        section, tape = self._section(body), self._tape
        span = places[1] - places[0]
        length = tape.let("length", abs(span) if span.is_number else sympy.sqrt(span**2))
        if length.is_number and length == 0:
            return
        x, y, normal = self._kinematics.plane
        c, s = turned(self._placing.pose(body).rotor, axis.way)
        along = tape.vector("beam_x", plus(scaled(c, x), scaled(s, y)))
        side = tape.vector("beam_y", plus(scaled(-s, x), scaled(c, y)))
        middle = self._placing.point(body, sum_of(axis.end, stretched((places[0] + places[1]) / 2, axis.way)))
        twist, bend = (
            tape.let("turn", length / (self._number(modulus) * self._number(size)))
            for modulus, size in ((section.G, section.J), (section.E, section.Iy))
        )
        shear = tape.let("shear", length**2 * bend / 12)
        place = tape.vector("beam_middle", self._kinematics.place(middle))
        yield Beam((along, side, normal), place, _ZERO, (twist, bend, _ZERO), (_ZERO, shear))

    def _way(self) -> list[tuple[int, int]]:
        """Links from the foot's to the frame, each with the pair to the next; cylinders only where nothing else leads there."""
        for barred in (self._linkage.structure.bars, frozenset[int]()):
            seen, front = {self._linkage.foot[0]: list[tuple[int, int]]()}, [self._linkage.foot[0]]
            while front and 0 not in seen:
                body = front.pop(0)
                for pair in self._pairs(body):
                    for other in self._bodies(pair):
                        if other not in seen and other not in barred:
                            seen[other] = [*seen[body], (body, pair)]
                            front.append(other)
            if 0 in seen:
                return seen[0]
        return []

    # ---- links

    def _end(self, body: int, pair: int | None) -> Planar:
        """Where a link is held, in its axes; None is the foot."""
        return self._placing.planar(self._linkage.foot[1]) if pair is None else self._where(pair, body)

    def _where(self, pair: int, body: int) -> Planar:
        """Where a pair is, in a link's axes; on a guide it moves."""
        ends = self._linkage.structure.pairs[pair]
        if ends.kind == "R" or body != ends.bodies[1]:
            return self._placing.located(pair, body)
        pose = self._placing.pose(body)
        x, y = turned(conjugate(pose.rotor), difference(self._placing.joint(pair), pose.origin))
        return (self._tape.let("guided_x", x), self._tape.let("guided_y", y))

    def _axis(self, body: int) -> _Axis | None:
        """Between the two points of a link, of its pairs and the foot, that are farthest apart; None where all are one."""
        points = [end for pair in self._pairs(body) if (end := self._linkage.points[pair][self._bodies(pair).index(body)]) is not None]
        points += [self._linkage.foot[1]] if body == self._linkage.foot[0] else []
        best = max(combinations(points, 2), key=lambda two: self._apart(*two), default=None)
        if best is None or self._apart(*best) == 0.0:
            return None
        start, end = map(self._placing.planar, best)
        span = difference(end, start)
        length = self._tape.let("beam_length", sympy.sqrt(square(span)))
        x, y = (self._tape.let("beam_way", part / length) for part in span)
        return _Axis(end, (x, y), length)

    def _apart(self, first: Point, second: Point) -> float:
        x, y = (float(number(a, self._mechanism) - number(b, self._mechanism)) for a, b in zip(first, second, strict=True))
        return round(hypot(x, y), 12)

    def _pairs(self, body: int) -> list[int]:
        return [index for index in range(len(self._linkage.points)) if body in self._bodies(index)]

    def _bodies(self, pair: int) -> tuple[int, ...]:
        return self._linkage.structure.pairs[pair].bodies

    def _section(self, body: int) -> Section:
        return next(section for section in self._mechanism.sections if section.name == self._linkage.sections[body])

    def _number(self, value: Scalar) -> sympy.Expr:
        return expression(value, self._kinematics.parameters)


def _mutual(first: Sequence[_Pushed], second: Sequence[_Pushed], stretch: sympy.Expr, bend: sympy.Expr, tape: Tape) -> sympy.Expr:
    """The integral of N N' / EA + M M' / EI along a beam, where the loads nearer to its near end than a cut act on it."""
    terms = []
    for one in first:
        for other in second:
            cut = _greater(one.at, other.at, tape)
            a, b = (tape.let("bending", each.moment + each.at * each.across) for each in (one, other))
            bent = -a * b * cut + (a * other.across + b * one.across) * cut**2 / 2 - one.across * other.across * cut**3 / 3
            terms.append(tape.let("mutual", bend * bent - stretch * one.along * other.along * cut))
    return sympy.Add(*terms)


def _greater(a: sympy.Expr, b: sympy.Expr, tape: Tape) -> sympy.Expr:
    if a == b:
        return a
    if a.is_number and b.is_number:
        return max(a, b)
    return tape.let("cut", chosen(less(a, b), b, a))

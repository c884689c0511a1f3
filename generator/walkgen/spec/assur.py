"""Which bodies of a planar linkage can be placed one after another: Assur groups of class II and triads, found by their pairs alone.

Bodies that are joined pair by pair in a triangle are rigid together: three pins (an RRR dyad on its base), two pins and a slider (RRP,
RPR) or a pin and two sliders (PRP, RPP). Placing them makes one cluster of three, until the linkage is a single cluster. Where no
triangle is left, five clusters may be rigid together: two that are joined by three others. That is every Assur group of four links and
six pairs: with one of the two as its base a ternary link on three binary ones (class III), with one of the three a loop of four links
(class IV). What is left otherwise holds a larger group. Driven pairs join their bodies first, driven cylinders are bodies of a given
length.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations, product
from typing import Literal

GroupKind = Literal["RRR", "RRP", "RPP", "pantograph", "spanned", "triad"]
_KINDS: dict[str, GroupKind] = {"RRR": "RRR", "PRR": "RRP", "PPR": "RPP"}
SIDES = {"RRR": ("left", "right"), "RRP": ("ahead", "behind"), "RPP": (), "pantograph": (), "spanned": (), "triad": ()}
"""How a group may be assembled. left: the inner pin lies left of the ray from the first outer pin to the second; ahead: the slider lies
further along its guide."""


Three = tuple[int, int, int]


@dataclass(frozen=True)
class Pair:
    """A pin (R) or slider (P) between bodies; a pin may join more than two. A slider's guide is on its second body."""

    kind: Literal["R", "P"]
    name: str
    bodies: tuple[int, ...]
    driven: bool = False


@dataclass(frozen=True)
class Pantograph:
    """Two pins that a pantograph keeps in line with the foot: middle = ratio * top + (1 - ratio) * foot, `ratio` a complex number."""

    top: int
    middle: int
    ratio: tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Structure:
    """Bodies by index, 0 the frame; `bars` are those that are driven cylinders; a pantograph places two sliders at once for a foot.

    `held` is the pair that pins the foot to the frame, where one does.
    """

    names: tuple[str, ...]
    pairs: tuple[Pair, ...]
    bars: frozenset[int] = frozenset()
    pantograph: Pantograph | None = None
    held: int | None = None

    @property
    def mobility(self) -> int:
        """Degrees of freedom in the plane, 3 (n - 1) - 2 j, a driven cylinder counted as its two links and three pairs."""
        links = len(self.names) - len(self.bars)
        joints = sum(len(pair.bodies) - 1 for pair in self.pairs if not self.bars & set(pair.bodies))
        return 3 * (links - 1) - 2 * joints

    @property
    def drive_count(self) -> int:
        """Driven pairs, and driven cylinders."""
        return len(self.bars) + sum(pair.driven for pair in self.pairs)

    def released(self, foot: int) -> "Structure":
        """Without drives, the foot's link pinned to the frame: what places the drives for a foot. Pairs keep their indices."""
        free = tuple(Pair(pair.kind, pair.name, () if self.bars & set(pair.bodies) else pair.bodies) for pair in self.pairs)
        return replace(self, pairs=(*free, Pair("R", "foot", (0, foot))), held=len(free))


@dataclass(frozen=True)
class Drive:
    """A driven pair joins two clusters."""

    pair: int
    base: int
    moved: int


@dataclass(frozen=True)
class Group:
    """Three clusters, each by one of its bodies, the first the base; `pairs` join base and first, base and second, first and second.

    `guide` says which of the three bears the guide of an RRP group's slider.
    """

    kind: GroupKind
    name: str
    bodies: Three
    pairs: Three
    guide: int = 0


@dataclass(frozen=True)
class Strut:
    """A cluster, by one of its bodies, between the two ends of a triad, with the pair to the first and the pair to the second."""

    body: int
    pairs: tuple[int, int]


@dataclass(frozen=True)
class Triad:
    """Two clusters, each by one of its bodies, that three struts join; where the base is a strut, it is the first."""

    name: str
    ends: tuple[int, int]
    struts: tuple[Strut, Strut, Strut]

    @property
    def kind(self) -> GroupKind:
        """As that of a dyad."""
        return "triad"

    @property
    def bodies(self) -> tuple[int, ...]:
        """The base first, one body of every cluster."""
        return tuple(sorted((*self.ends, *(strut.body for strut in self.struts))))


Placement = Drive | Group | Triad


@dataclass(frozen=True)
class Order:
    """Placements in order, and the clusters that they end in, by their bodies: one where the linkage is solved."""

    placements: tuple[Placement, ...]
    clusters: tuple[frozenset[int], ...]

    def rigid_before(self, triad: Triad, body: int) -> frozenset[int]:
        """The bodies that move with one before a triad is placed."""
        found = frozenset({body})
        before = self.placements[: self.placements.index(triad)]
        while grown := [set(joined) for each in before if found & (joined := _joined_by(each)) and not joined <= found]:
            found = found.union(*grown)
        return found

    @property
    def groups(self) -> tuple[Group | Triad, ...]:
        """All but the drives."""
        return tuple(placement for placement in self.placements if not isinstance(placement, Drive))

    @property
    def dyads(self) -> tuple[Group, ...]:
        """In closed form."""
        return tuple(placement for placement in self.placements if isinstance(placement, Group))

    @property
    def triads(self) -> tuple[Triad, ...]:
        """Each with two unknowns."""
        return tuple(placement for placement in self.placements if isinstance(placement, Triad))


def _joined_by(placement: Placement) -> frozenset[int]:
    return frozenset((placement.base, placement.moved) if isinstance(placement, Drive) else placement.bodies)


def order(structure: Structure) -> Order:
    """Place what can be placed, from the frame outwards first."""
    search = _Search(structure)
    search.drive()
    while search.span() or search.place() or search.place_pantograph() or search.place_triad():
        pass
    bars = structure.bars if not any(pair.driven or structure.bars & set(pair.bodies) for pair in structure.pairs) else frozenset()
    clusters = {cluster for cluster in search.clusters if not cluster <= bars}
    return Order(tuple(search.placements), tuple(sorted(clusters, key=min)))


class _Search:
    def __init__(self, structure: Structure) -> None:
        self._structure = structure
        self.placements: list[Placement] = []
        self.clusters = [frozenset({body}) for body in range(len(structure.names))]
        self._used: set[str] = set()

    def drive(self) -> None:
        """Join across driven pairs."""
        for index, pair in enumerate(self._structure.pairs):
            if pair.driven and not self._together(*pair.bodies):
                base, moved = (pair.bodies[0], pair.bodies[1]) if pair.kind == "R" else (pair.bodies[1], pair.bodies[0])
                self.placements.append(Drive(index, base, moved))
                self._join(base, moved)

    def place(self) -> bool:
        """Place one group if there is any; those on the frame's cluster come first."""
        ordered = sorted(self.clusters, key=min)
        for triple in combinations(ordered, 3):
            group = self._group(*triple)
            if group is not None:
                self.placements.append(group)
                self._join(*group.bodies)
                return True
        return False

    def place_triad(self) -> bool:
        """Place one group of four links if there is any; those on the frame's cluster come first."""
        ordered = sorted(self.clusters, key=min)
        for first, second in combinations(ordered, 2):
            between = [cluster for cluster in ordered if cluster not in (first, second)]
            struts = [strut for cluster in between if (strut := self._strut(cluster, first, second))]
            for three in combinations(struts, 3):
                if sum(self._slides(strut) == 2 for strut in three) < 2:
                    triad = self._triad((min(first), min(second)), three)
                    self.placements.append(triad)
                    self._join(*triad.bodies)
                    return True
        return False

    def _strut(self, cluster: frozenset[int], first: frozenset[int], second: frozenset[int]) -> Strut | None:
        pairs = next(self._between(cluster, first), None), next(self._between(cluster, second), None)
        return None if pairs[0] is None or pairs[1] is None or pairs[0] == pairs[1] else Strut(min(cluster), (pairs[0], pairs[1]))

    def _slides(self, strut: Strut) -> int:
        return sum(self._structure.pairs[pair].kind == "P" for pair in strut.pairs)

    def _triad(self, ends: tuple[int, int], struts: tuple[Strut, ...]) -> Triad:
        """First the strut that is the base, else one of two sliders, whose ends do not turn to each other, else as the spec has them."""
        base = min(*ends, *(strut.body for strut in struts))
        first, second, third = sorted(struts, key=lambda strut: (strut.body != base, self._slides(strut) < 2, strut.pairs))
        ternary = next(end for end in ends if end != base)
        return Triad(self._free(self._structure.names[ternary]), ends, (first, second, third))

    def place_pantograph(self) -> bool:
        """Place two sliders on the frame by the pantograph between them, once the foot is held."""
        pantograph, frame = self._structure.pantograph, min(self.clusters, key=min)
        if pantograph is None or self._structure.held is None:
            return False
        for top, middle in product(*(self._structure.pairs[pin].bodies for pin in (pantograph.top, pantograph.middle))):
            slides = [self._slide(body, frame) for body in (top, middle)]
            if None not in slides:
                pairs = (slides[0] or 0, slides[1] or 0, pantograph.middle)
                self.placements.append(Group("pantograph", "pantograph", (0, top, middle), pairs))
                self._join(0, top, middle)
                return True
        return False

    def span(self) -> bool:
        """Place a bar of a placed pantograph by both its pins: their distance is right, because the parallelogram closes."""
        if not any(isinstance(placement, Group) and placement.kind == "pantograph" for placement in self.placements):
            return False
        frame, *others = sorted(self.clusters, key=min)
        for cluster in others:
            pins = [pair for pair in self._between(frame, cluster) if self._structure.pairs[pair].kind == "R"]
            if len(pins) > 1:
                body = min(cluster)
                self.placements.append(Group("spanned", self._structure.names[body], (0, body, body), (pins[0], pins[1], pins[1])))
                self._join(0, body)
                return True
        return False

    def _slide(self, body: int, frame: frozenset[int]) -> int | None:
        """The slider between a body that is not placed and the frame's cluster."""
        own = next(cluster for cluster in self.clusters if body in cluster)
        between = () if own == frame else tuple(self._between(own, frame))
        return next((pair for pair in between if self._structure.pairs[pair].kind == "P"), None)

    def _group(self, base: frozenset[int], first: frozenset[int], second: frozenset[int]) -> Group | None:
        """Whether the clusters make a group: every two joined, not by three sliders."""
        for found in product(self._between(base, first), self._between(base, second), self._between(first, second)):
            kind = _KINDS.get("".join(sorted(self._structure.pairs[pair].kind for pair in found)))
            if kind is not None and len(set(found)) == 3:
                bodies, pairs = self._cylinder_first((min(base), min(first), min(second)), found)
                return Group(kind, self._name(bodies, pairs), bodies, pairs, self._guide(bodies, pairs) if kind == "RRP" else 0)
        return None

    def _between(self, one: frozenset[int], other: frozenset[int]) -> Iterator[int]:
        for index, pair in enumerate(self._structure.pairs):
            if one & set(pair.bodies) and other & set(pair.bodies):
                yield index

    def _cylinder_first(self, bodies: Three, pairs: Three) -> tuple[Three, Three]:
        """The cylinder's pin counts as the first outer one; else the pin that the spec names first does."""
        base, first, second = bodies
        key = [(body not in self._structure.bars, pair) for body, pair in ((first, pairs[0]), (second, pairs[1]))]
        return (bodies, pairs) if key[0] <= key[1] else ((base, second, first), (pairs[1], pairs[0], pairs[2]))

    def _guide(self, bodies: Three, pairs: Three) -> int:
        slider = next(self._structure.pairs[pair] for pair in pairs if self._structure.pairs[pair].kind == "P")
        return next(index for index, body in enumerate(bodies) if self._together(body, slider.bodies[1]))

    def _name(self, bodies: Three, pairs: Three) -> str:
        """The cylinder's, else the slider's, else the inner pin's; then with a number where it is taken."""
        bar = next((self._structure.names[body] for body in bodies if body in self._structure.bars), "")
        slider = next((self._structure.pairs[pair].name for pair in pairs if self._structure.pairs[pair].kind == "P"), "")
        return self._free(bar or slider or self._structure.pairs[pairs[2]].name)

    def _free(self, name: str) -> str:
        free = next(text for text in (name, *(f"{name}_{number}" for number in range(2, 99))) if text not in self._used)
        self._used.add(free)
        return free

    def _together(self, one: int, other: int) -> bool:
        return any(one in cluster and other in cluster for cluster in self.clusters)

    def _join(self, *bodies: int) -> None:
        joined = frozenset().union(*(cluster for cluster in self.clusters if cluster & set(bodies)))
        self.clusters = [cluster for cluster in self.clusters if not cluster & joined] + [joined]

"""From a robot's q to the coordinates of its tree of links, and efforts back: the identity, but where linkages place links.

A linkage's links are links of the tree that slide and turn in the plane, with coordinates y(q): dy = S dq, and efforts on q are S' times
those on y.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import sympy

from walkgen.symbolic.planar_motion import PlanarMotion
from walkgen.symbolic.rubbing import Rubbing
from walkgen.symbolic.springs import Springs
from walkgen.symbolic.tape import Tape

Exprs = Sequence[sympy.Expr]
_ONE = sympy.S.One


@dataclass
class Spread:
    """`values` are the tree's coordinates; `slopes` the entries of S by coordinate, then by q; `motions` whose coordinates start where,
    and which q drive them; `rubbings` the friction of linkages that have any, `springs` those of legs that have any.
    """

    count: int
    tape: Tape
    values: list[sympy.Expr] = field(default_factory=list)
    slopes: list[Mapping[int, sympy.Expr]] = field(default_factory=list)
    motions: list[tuple[int, Sequence[int], PlanarMotion]] = field(default_factory=list)
    rubbings: list[Rubbing] = field(default_factory=list)
    springs: list[Springs] = field(default_factory=list)

    def on(self, tape: Tape) -> "Spread":
        """The same, written on a tape that began as this one's."""
        motions = [(start, drives, motion.on(tape)) for start, drives, motion in self.motions]
        rubbings, springs = [rubbing.on(tape) for rubbing in self.rubbings], [each.on(tape) for each in self.springs]
        return replace(self, tape=tape, motions=motions, rubbings=rubbings, springs=springs)

    @property
    def free(self) -> bool:
        """Whether every coordinate is a q."""
        return not self.motions

    def joint(self, index: int, value: sympy.Expr) -> int:
        """A coordinate that is a q; its number."""
        self.values.append(value)
        self.slopes.append({index: _ONE})
        return len(self.values) - 1

    def driven(self, drives: Sequence[int], values: Exprs, motion: PlanarMotion) -> range:
        """Coordinates of a linkage; their numbers."""
        start = len(self.values)
        self.motions.append((start, drives, motion))
        self.values += values
        self.slopes += [dict(zip(drives, row, strict=True)) for row in motion.slopes]
        return range(start, len(self.values))

    def rates(self, qd: Exprs) -> tuple[sympy.Expr, ...]:
        """Of the tree's coordinates."""
        found = (sympy.Add(*(slope * qd[index] for index, slope in row.items())) for row in self.slopes)
        return tuple(self.tape.let(f"rate_{number}", value) for number, value in enumerate(found))

    def accelerations(self, qd: Exprs, qdd: Exprs) -> tuple[sympy.Expr, ...]:
        """Of the tree's coordinates."""
        found = [sympy.Add(*(slope * qdd[index] for index, slope in row.items())) for row in self.slopes]
        for start, drives, motion in self.motions:
            own = [qd[index] for index in drives]
            if any(rate != 0 for rate in own):
                for number, curve in enumerate(motion.curved(own), start):
                    found[number] += curve
        return tuple(self.tape.let(f"acceleration_{number}", value) for number, value in enumerate(found))

    def borne(self, efforts: Exprs) -> tuple[sympy.Expr, ...]:
        """Efforts on the q of efforts on the tree's coordinates."""
        found: list[list[sympy.Expr]] = [[] for _ in range(self.count)]
        for row, effort in zip(self.slopes, efforts, strict=True):
            for index, slope in row.items():
                found[index].append(slope * effort)
        return tuple(sympy.Add(*terms) for terms in found)

    def sprung(self, efforts: Exprs) -> tuple[sympy.Expr, ...]:
        """Efforts on the tree's coordinates with those that hold against all springs."""
        found = [[effort] for effort in efforts]
        for springs in self.springs:
            for spring in range(len(springs.coils)):
                for number, effort in springs.efforts(spring):
                    found[number].append(effort)
        return tuple(sympy.Add(*terms) for terms in found)

    def rubbed(self, qd: Exprs, steady: Callable[[], Exprs]) -> tuple[sympy.Expr, ...]:
        """Efforts on the q against friction in pairs of linkages.

        Args:
            qd: rates of all q.
            steady: gives efforts on the tree's coordinates at these rates and loads, without accelerations; asked where loads count.
        """
        loads = steady() if any(rubbing.loaded for rubbing in self.rubbings) else ()
        found: list[list[sympy.Expr]] = [[] for _ in range(self.count)]
        for rubbing in self.rubbings:
            for index, effort in rubbing.efforts(qd, loads):
                found[index].append(effort)
        return tuple(sympy.Add(*terms) for terms in found)

    def matrix(self, entries: Mapping[tuple[int, int], sympy.Expr]) -> dict[tuple[int, int], sympy.Expr]:
        """S' M S of the entries of M."""
        found: dict[tuple[int, int], list[sympy.Expr]] = {}
        for (row, column), value in entries.items():
            for first, left in self.slopes[row].items():
                for second, right in self.slopes[column].items():
                    found.setdefault((first, second), []).append(left * right * value)
        return {place: sympy.Add(*terms) for place, terms in found.items()}

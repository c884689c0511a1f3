"""Rules of how a linkage is assembled: sides of dyads, the start of triads."""

from collections.abc import Iterator
from itertools import combinations

from walkgen.spec.assur import SIDES, Group, Structure, Triad, order
from walkgen.spec.evaluate import Numbers
from walkgen.spec.planar import End, joined_pairs, table_of
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.scalar import names
from walkgen.spec.schema import LegDesign
from walkgen.spec.table import Pair, Path

_MOST_TRIADS = 4


def check_assembly(path: Path, design: LegDesign, structure: Structure, numbers: Numbers) -> Iterator[Finding]:
    """Of a linkage whose references hold and whose groups are placed."""
    yield from _folded(path, design, structure, numbers)
    if len(order(structure).triads) > _MOST_TRIADS:
        message = f"the linkage holds more than {_MOST_TRIADS} triads, which is not supported"
        yield Finding("WG150", path, message, "drive other pairs, so that dyads follow")
    yield from _sides((*path, "assembly"), design, structure)
    if design.start is not None:
        yield from _start((*path, "start"), design, structure)


def _folded(path: Path, design: LegDesign, structure: Structure, numbers: Numbers) -> Iterator[Finding]:
    """Two pins of a group that lie at one point of a link, whatever the runtime parameters are: a triangle without one of its sides."""
    joined = joined_pairs(design)
    for group in order(structure).groups:
        for one, other in _sides_of(structure, group):
            for body in set(structure.pairs[one].bodies) & set(structure.pairs[other].bodies):
                points = (joined[pair].points[structure.pairs[pair].bodies.index(body)] for pair in (one, other))
                if _one_point(next(points), next(points), numbers):
                    pins = " and ".join(f'"{shown(structure.pairs[pair].name)}"' for pair in (one, other))
                    link, title = shown(structure.names[body]), "triad" if isinstance(group, Triad) else "dyad"
                    message = f"{pins} end at one point of {link}: the {title} {shown(group.name)} cannot close, or never moves"
                    yield Finding("WG179", (*path, *table_of(design, max(one, other))), message, f"move one of them on {link}")


def _sides_of(structure: Structure, group: Group | Triad) -> Iterator[tuple[int, int]]:
    """Pins of a dyad, or of a triad's strut, two by two."""
    for pairs in [strut.pairs for strut in group.struts] if isinstance(group, Triad) else [group.pairs]:
        yield from combinations([pair for pair in pairs if structure.pairs[pair].kind == "R"], 2)


def _one_point(one: End, other: End, numbers: Numbers) -> bool:
    return one is not None and other is not None and (one == other or _values(one, numbers) == _values(other, numbers) is not None)


def _values(point: Pair, numbers: Numbers) -> tuple[object, ...] | None:
    """Of a point that no runtime parameter moves."""
    fixed = all(names(entry) <= numbers.constants.keys() for entry in point)
    return tuple(numbers.number(entry) for entry in point) if fixed else None


def _sides(path: Path, design: LegDesign, structure: Structure) -> Iterator[Finding]:
    groups = {group.name: SIDES[group.kind] for group in order(structure).groups if SIDES[group.kind]}
    triads = [triad.name for triad in order(structure).triads]
    for name, side in design.assembly.items():
        if name in triads:
            message = f'"{shown(name)}" is a triad, which has up to six assemblies and no sides'
            yield Finding("WG187", (*path, name), message, "say by start = { ... } which of them it has")
        elif name not in groups:
            yield Finding("WG187", (*path, name), f'there is no dyad "{shown(name)}"', did_you_mean(name, groups, "dyads"))
        elif side not in groups[name]:
            cure = f"write {' or '.join(groups[name])}"
            yield Finding("WG187", (*path, name), f'the dyad "{shown(name)}" has no side "{shown(side)}"', cure)


def _start(path: Path, design: LegDesign, structure: Structure) -> Iterator[Finding]:
    assert design.start is not None
    if not order(structure).triads:
        message = "start says how triads are assembled, and the linkage has none"
        yield Finding("WG187", path, message, "remove start; dyads have sides: assembly")
    kinds = [pair.kind for pair in structure.pairs if pair.driven] + ["P"] * len(structure.bars)
    for key, kind, unit in (("drives", "", "rad or m"), ("drives_deg", "R", "degrees"), ("drives_mm", "P", "mm")):
        given = getattr(design.start, key)
        if given is not None and len(given) != len(kinds):
            message = f"the linkage has {len(kinds)} drives, not {len(given)}"
            yield Finding("WG187", (*path, key), message, f"give {len(kinds)} values, in the order of q")
        elif given is not None and kind and set(kinds) != {kind}:
            yield Finding("WG187", (*path, key), f"not all drives are in {unit}", "write drives, in rad or m")

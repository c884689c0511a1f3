"""Rules of what moves in a linkage: all links hang on the frame, as many pairs are driven as are free, each drive moves a part of its own.

What is wrong is told at the pair or link that is to blame, with the part of the linkage that it concerns.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

from walkgen.spec.assur import Drive, Structure, order
from walkgen.spec.evaluate import Numbers
from walkgen.spec.mobility import free_linkage
from walkgen.spec.planar import joined_pairs, link_names, table_of
from walkgen.spec.problems import Finding, shown
from walkgen.spec.scalar import ZERO
from walkgen.spec.schema import LegDesign
from walkgen.spec.table import Path

Cluster = frozenset[int]
_MOST_NAMED = 6


def check_mobility(path: Path, design: LegDesign, structure: Structure, numbers: Numbers) -> Iterator[Finding]:
    """Of a linkage whose references hold; nothing where its drives place every link."""
    astray = list(_astray(path, design, structure))
    if astray:
        yield from astray
    elif structure.mobility != structure.drive_count:
        yield _miscounted(path, design, structure, numbers)
    elif len(_clusters(structure)) > 1:
        yield _stuck(path, design, structure)


def _astray(path: Path, design: LegDesign, structure: Structure) -> Iterator[Finding]:
    """Every part that no chain of pairs joins to the frame, at its first link."""
    left = set(range(len(structure.names))) - _joined_to(structure, 0)
    while left:
        part = _joined_to(structure, min(left))
        left -= part
        first, names = structure.names[min(part)], ", ".join(shown(structure.names[body]) for body in sorted(part))
        message = f"nothing joins {names} to the frame" + (", only to each other" if len(part) > 1 else "")
        where = ("links", first) if first in link_names(design) else ("cylinders",)
        yield Finding("WG182", (*path, *where), message, f"join {shown(first)} by pins, sliders or cylinders, or remove it")


def _joined_to(structure: Structure, body: int) -> set[int]:
    reached, grown = set[int](), {body}
    while grown != reached:
        reached = grown
        grown = reached.union(*(pair.bodies for pair in structure.pairs if reached & set(pair.bodies)))
    return reached


def _clusters(structure: Structure) -> tuple[Cluster, ...]:
    return order(structure).clusters


def _miscounted(path: Path, design: LegDesign, structure: Structure, numbers: Numbers) -> Finding:
    """Not as many drives as freedoms; where its dimensions are special, it has others than the count says."""
    guides = [slider.guide.si("angle") or ZERO for slider in design.sliders]
    joined = joined_pairs(design)
    angles = (*(ZERO,) * (len(joined) - len(guides)), *guides)
    loops = free_linkage(structure, [each.points for each in joined], angles, numbers.number)
    found = min((loops.mobility(x) for x in loops.poses()), key=lambda each: each.freedoms, default=None) if loops else None
    if found is None or found.freedoms == structure.mobility:
        return _wrongly_driven(path, design, structure)
    pairs = ", ".join(shown(name) for name in found.pairs)
    message = f"{_count(structure)}; the rank of its pairs' equations where it closes leaves {found.freedoms}: {pairs} say one thing twice"
    return Finding("WG191", path, message, "leave out a link between these pairs whose motion the others make already")


def _wrongly_driven(path: Path, design: LegDesign, structure: Structure) -> Finding:
    """Too many drives, at one of them that moves nothing of its own, or too few, with what stays free."""
    more = structure.mobility - structure.drive_count
    if more < 0:
        spare = _spare(structure)
        cure = "leave out links or pairs: it cannot move" if structure.mobility < 1 else f"drive {-more} fewer, or mend the pairs"
        return Finding("WG183", (*path, *table_of(design, spare)), f"{_count(structure)}; {_repeats(structure, spare)}", cure)
    cure = f"drive {more} more{_such_as(design, structure)}, or mend the pairs"
    return Finding("WG183", path, f"{_count(structure)}; {_free(structure)}", cure)


def _count(structure: Structure) -> str:
    links = len(structure.names) - len(structure.bars)
    joints = sum(len(pair.bodies) - 1 for pair in structure.pairs if not structure.bars & set(pair.bodies))
    driven = [pair.name for pair in structure.pairs if pair.driven] + [structure.names[bar] for bar in sorted(structure.bars)]
    return (
        f"the linkage has 3 ({links} - 1) - 2 * {joints} = {structure.mobility} degrees of freedom in its plane "
        f"(cylinders left out of the count of links and pairs), and {len(driven)} driven{_listed(driven, ': ', ', ')}"
    )


def _stuck(path: Path, design: LegDesign, structure: Structure) -> Finding:
    """The count is right, yet the drives do not place everything."""
    clusters = _clusters(structure)
    if not _tied_twice(structure, clusters):
        stuck = " + ".join(_named(structure, cluster) for cluster in clusters)
        cure = "solve it by groups of two or four links: add or move pins and sliders, or drive other pairs"
        return Finding("WG150", path, f"the group {stuck} has more than four links, which is not supported", cure)
    spare = _spare(structure)
    message = f"{_repeats(structure, spare)}, while {_free(structure, spare)}"
    cure = f"drive a pair of that part instead{_such_as(design, structure, spare)}"
    return Finding("WG184", (*path, *table_of(design, spare)), message, cure)


def _tied_twice(structure: Structure, clusters: tuple[Cluster, ...]) -> bool:
    """Whether a drive joins what is rigid without it, or two rigid parts have two pairs between them: more than they can satisfy."""
    placed = {placement.pair for placement in order(structure).placements if isinstance(placement, Drive)}
    undone = any(pair.driven and index not in placed for index, pair in enumerate(structure.pairs))
    return undone or any(len(_between(structure, one, other)) > 1 for one, other in combinations(clusters, 2))


def _between(structure: Structure, one: Cluster, other: Cluster) -> list[int]:
    return [index for index, pair in enumerate(structure.pairs) if one & set(pair.bodies) and other & set(pair.bodies)]


def _spare(structure: Structure) -> int:
    """The pair of the drive, the last there is, without which the fewest parts are free; of a driven cylinder its first end's."""
    drives = [index for index, pair in enumerate(structure.pairs) if pair.driven]
    drives += [next(index for index, pair in enumerate(structure.pairs) if bar in pair.bodies) for bar in sorted(structure.bars)]
    return min(reversed(drives), key=lambda drive: len(_parts(_without(structure, drive))))


def _without(structure: Structure, drive: int) -> Structure:
    """The drive's pair moves freely, a cylinder is taken away."""
    bars = structure.bars & set(structure.pairs[drive].bodies)
    free = [replace(pair, bodies=()) if bars & set(pair.bodies) else pair for pair in structure.pairs]
    free[drive] = replace(free[drive], driven=False)
    return replace(structure, pairs=tuple(free))


def _repeats(structure: Structure, spare: int) -> str:
    """What a drive does that others do."""
    pair, others = structure.pairs[spare], _without(structure, spare)
    moved = set(pair.bodies) - structure.bars
    held = next((cluster for cluster in _clusters(others) if moved <= cluster), frozenset(moved))
    return f'the drive "{shown(pair.name)}" moves nothing of its own: other drives hold {_named(structure, held - structure.bars)}'


def _parts(structure: Structure) -> tuple[Cluster, ...]:
    """What the drives leave free: parts with links, but the frame's."""
    return tuple(cluster for cluster in _clusters(structure) if 0 not in cluster and not cluster <= structure.bars)


def _free(structure: Structure, spare: int | None = None) -> str:
    """What no drive moves, a spare one left out."""
    parts = _parts(structure if spare is None else _without(structure, spare))
    return f"nothing drives {' + '.join(_named(structure, part) for part in parts)}"


def _such_as(design: LegDesign, structure: Structure, spare: int | None = None) -> str:
    """Pairs of the free parts that could be driven."""
    driven = structure if spare is None else _without(structure, spare)
    bodies, clusters = set().union(*_parts(driven)), _clusters(driven)
    links = {structure.names[body] for body in bodies}
    between = (pair for pair in driven.pairs if bodies & set(pair.bodies) and not any(set(pair.bodies) <= each for each in clusters))
    pairs = [pair.name for pair in between if not structure.bars & set(pair.bodies)]
    passive = (cylinder for cylinder in design.cylinders if not cylinder.driven)
    pairs += [each.name for each in passive if links & {end.partition(".")[0] for end in each.between}]
    return _listed(pairs, ", for instance ", " or ")


def _listed(names: list[str], before: str, between: str) -> str:
    """Nothing where there are many."""
    return before + between.join(map(shown, names)) if 0 < len(names) <= _MOST_NAMED else ""


def _named(structure: Structure, cluster: Cluster) -> str:
    return "/".join(shown(structure.names[body]) for body in sorted(cluster))

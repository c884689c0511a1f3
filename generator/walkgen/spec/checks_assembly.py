"""Rules of how a linkage is assembled: sides of dyads, the start of triads."""

from collections.abc import Iterator

from walkgen.spec.assur import SIDES, Structure, order
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.schema import LegDesign
from walkgen.spec.table import Path

_MOST_TRIADS = 4


def check_assembly(path: Path, design: LegDesign, structure: Structure) -> Iterator[Finding]:
    """Of a linkage whose references hold and whose groups are placed."""
    if len(order(structure).triads) > _MOST_TRIADS:
        message = f"the linkage holds more than {_MOST_TRIADS} triads, which is not supported"
        yield Finding("WG150", path, message, "drive other pairs, so that dyads follow")
    yield from _sides((*path, "assembly"), design, structure)
    if design.start is not None:
        yield from _start((*path, "start"), design, structure)


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

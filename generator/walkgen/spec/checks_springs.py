"""Rules of springs: their ends are points that exist, on two bodies, and their free length is given."""

from collections.abc import Iterator

from walkgen.spec.checks_linkage import point_findings
from walkgen.spec.linkage import FRAME
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.schema import LegDesign, RobotSpec
from walkgen.spec.springs import MOUNT, SpringEnd, SpringSpec
from walkgen.spec.table import Path


def check_springs(spec: RobotSpec) -> Iterator[Finding]:
    """Every spring of every leg design, linkages in the long form."""
    for name, design in spec.leg_designs.items():
        path: Path = ("leg_designs", name)
        if design.springs and any(joint.name == MOUNT for joint in design.rows):
            message = f'a joint is called "{MOUNT}", which springs take for the leg\'s first frame'
            yield Finding("WG201", (*path, "joints"), message, "give the joint another name")
        for index, spring in enumerate(design.springs):
            yield from _spring((*path, "springs", index), spring, design)


def _spring(path: Path, spring: SpringSpec, design: LegDesign) -> Iterator[Finding]:
    if spring.si("free_length") is None:
        cure = "write free_length = 0.15 (m), where the spring begins to stretch"
        yield Finding("WG111", (*path, "free_length"), 'missing key "free_length"', cure)
    broken = [finding for place, end in enumerate(spring.between) for finding in _end((*path, "between", place), end, design)]
    yield from broken
    if not broken and _body(spring.between[0], design) == _body(spring.between[1], design):
        yield Finding(
            "WG202", (*path, "between"), "both ends of the spring are on one body, so it pulls at nothing", "name points of two links"
        )


def _end(path: Path, end: SpringEnd, design: LegDesign) -> Iterator[Finding]:
    if isinstance(end, str):
        if design.planar:
            yield from point_findings(path, end, design)
        else:
            cure = f'write {{ link = "{_last(design)}", xyz = [0.1, 0.0, 0.0] }}'
            yield Finding("WG201", path, f'"{shown(end)}": the leg has no linkage with named points', cure)
    elif end.link not in (known := (MOUNT, *(joint.name for joint in design.rows))):
        yield Finding("WG201", (*path, "link"), f'no joint "{shown(end.link)}" moves a link', did_you_mean(end.link, known, "links"))


def _last(design: LegDesign) -> str:
    return shown(design.joints[-1].name) if design.joints else MOUNT


def _body(end: SpringEnd, design: LegDesign) -> str:
    """What moves the end: a joint, nothing (the mount) or the linkage; the linkage's frame is what the last joint moves."""
    if not isinstance(end, str):
        return end.link
    link = end.partition(".")[0]
    return f"{link}." if link != FRAME else _last(design)

"""Rules of planar linkages: points exist, pairs join what can move, all hangs together, and the drives move exactly what is free."""

from collections.abc import Iterator
from dataclasses import replace
from math import prod

from walkgen.spec.assur import Structure
from walkgen.spec.branches import (
    CARRIED_BRANCHES,
    CURVE_BRANCHES,
    carries_curve,
    follows_curve,
    linkage_branches,
    linkage_choices,
    linkage_hindrance,
)
from walkgen.spec.checks_assembly import check_assembly
from walkgen.spec.checks_joints import named_branches
from walkgen.spec.checks_mobility import check_mobility
from walkgen.spec.evaluate import Numbers
from walkgen.spec.linkage import FRAME, CylinderSpec, PinFriction
from walkgen.spec.planar import located, structure_of
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.schema import LegDesign, RobotSpec
from walkgen.spec.table import Path, entries

_OF_LINKAGES = ("plane", "assembly", "start", "joints_after", "linkage_end")
_MOST_CHOICES = 4


def check_linkages(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every leg design that ends in a linkage; its structure, once its references hold."""
    for name, design in spec.leg_designs.items():
        path: Path = ("leg_designs", name)
        if not design.planar:
            yield from _no_linkage(path, design)
            continue
        broken = list(_references(path, design))
        yield from broken
        yield from _passive(path, design)
        yield from _sections(path, design)
        yield from _bolts(path, design)
        yield from _lengths(path, design, numbers)
        if not broken:
            yield from _structure(path, design, numbers)


def _no_linkage(path: Path, design: LegDesign) -> Iterator[Finding]:
    if isinstance(design.foot, str):
        yield Finding(
            "WG180",
            (*path, "foot"),
            "the foot is a point of a linkage, and there is none",
            "give the foot's xyz and rpy_deg, or describe links",
        )
    for key in _OF_LINKAGES:
        if getattr(design, key):
            yield Finding(
                "WG180", (*path, key), f"{key} belongs to a linkage, and the leg has none", f"remove {key}, or describe links and pins"
            )


def _references(path: Path, design: LegDesign) -> Iterator[Finding]:
    if FRAME not in design.links:
        cure = "write [leg_designs.NAME.links.frame] with the points that do not move"
        yield Finding("WG111", (*path, "links"), 'missing link "frame"', cure)
    yield from _end(path, design)
    for index, pin in enumerate(design.pins):
        for place, text in enumerate(pin.joins):
            yield from point_findings((*path, "pins", index, "joins", place), text, design)
        yield from _pin((*path, "pins", index), pin.joins, pin.driven)
    for index, slider in enumerate(design.sliders):
        here = (*path, "sliders", index)
        yield from point_findings((*here, "link"), slider.link, design)
        if slider.guide.link not in design.links:
            cure = did_you_mean(slider.guide.link, design.links, "links")
            yield Finding("WG180", (*here, "guide", "link"), f'there is no link "{shown(slider.guide.link)}"', cure)
        elif slider.link.partition(".")[0] == slider.guide.link:
            yield Finding("WG181", (*here, "guide", "link"), "the slider joins a link to itself", "name the guide of another link")
    for index, cylinder in enumerate(design.cylinders):
        here = (*path, "cylinders", index, "between")
        for place, text in enumerate(cylinder.between):
            yield from point_findings((*here, place), text, design)
        yield from _ends(here, cylinder)
    yield from _start((*path, "start"), design)


def _end(path: Path, design: LegDesign) -> Iterator[Finding]:
    """The point that the linkage places, for the foot or for the joints after it."""
    if not design.joints_after:
        if design.linkage_end:
            cure = 'remove linkage_end and write foot = "link.point", or describe [[leg_designs.NAME.joints_after]]'
            yield Finding("WG180", (*path, "linkage_end"), "no joints follow the linkage that could hang on its end", cure)
        if not isinstance(design.foot, str):
            yield Finding("WG180", (*path, "foot"), "the foot of a linkage is one of its points", 'write foot = "link.point"')
        else:
            yield from point_findings((*path, "foot"), design.foot, design)
        return
    if isinstance(design.foot, str):
        message = "joints follow the linkage: the foot is in the frame after the last of them"
        cure = f'write linkage_end = {{ point = "{shown(design.foot)}" }}, and foot = {{ xyz = [0.0, 0.0, -0.1] }}'
        yield Finding("WG180", (*path, "foot"), message, cure)
    if design.linkage_end is None or design.linkage_end.point is None:
        cure = 'write linkage_end = { point = "link.point", rpy_deg = [0, 90, 0] }: where the first joint after it stands'
        yield Finding("WG111", (*path, "linkage_end"), "missing the point of the linkage that the joints after it hang on", cure)
    else:
        yield from point_findings((*path, "linkage_end", "point"), design.linkage_end.point, design)


def _start(path: Path, design: LegDesign) -> Iterator[Finding]:
    """Points and links that hints name."""
    if design.start is None:
        return
    for text in design.start.points:
        yield from point_findings((*path, "points", text), text, design)
    for key in ("angles", "angles_deg"):
        for link in getattr(design.start, key) or ():
            if link not in design.links:
                cure = did_you_mean(link, design.links, "links")
                yield Finding("WG180", (*path, key, link), f'there is no link "{shown(link)}"', cure)


def point_findings(path: Path, text: str, design: LegDesign) -> Iterator[Finding]:
    """What keeps a text from naming a point of the linkage."""
    link, dot, point = text.partition(".")
    if not dot:
        yield Finding("WG180", path, f'"{shown(text)}" is not a point', "write link.point, such as thigh.K")
    elif link not in design.links:
        yield Finding("WG180", path, f'there is no link "{shown(link)}"', did_you_mean(link, design.links, "links"))
    elif point not in design.links[link].points:
        cure = did_you_mean(point, design.links[link].points, f"points of {shown(link)}")
        yield Finding("WG180", path, f'the link "{shown(link)}" has no point "{shown(point)}"', cure)


def _pin(path: Path, joins: tuple[str, ...], driven: bool) -> Iterator[Finding]:
    links = [text.partition(".")[0] for text in joins]
    if len(set(links)) < len(links):
        twice = next(link for link in links if links.count(link) > 1)
        yield Finding("WG181", (*path, "joins"), f'the pin joins the link "{shown(twice)}" to itself', "name points of different links")
    elif len(links) < 2:
        yield Finding("WG181", (*path, "joins"), "the pin joins one link to nothing", "name points of two links or more")
    elif driven and len(links) > 2:
        yield Finding("WG181", (*path, "joins"), f"a driven pin joins two links, not {len(links)}", "split it into pins of two links each")


def _passive(path: Path, design: LegDesign) -> Iterator[Finding]:
    """What only a pair with a motor can have."""
    for key in ("pins", "sliders", "cylinders"):
        for index, pair in enumerate(getattr(design, key)):
            for name in ("rotor", "max_effort", "max_speed", "limits", "limits_deg", "limits_mm"):
                if not pair.driven and getattr(pair, name, None) is not None:
                    message = f"the pair is not driven, and only a drive has {name}"
                    yield Finding("WG186", (*path, key, index, name), message, f"remove {name}, or write driven = true")


def _sections(path: Path, design: LegDesign) -> Iterator[Finding]:
    """What cannot yield."""
    if FRAME in design.links and design.links[FRAME].section is not None:
        cure = "remove section; the link of the joint before the linkage may have one"
        yield Finding("WG193", (*path, "links", FRAME, "section"), "the frame is held by what carries it, and is rigid", cure)
    for index, cylinder in enumerate(design.cylinders):
        if cylinder.section is not None and not cylinder.driven:
            message = "the cylinder is not driven, so that it carries nothing that could stretch it"
            yield Finding("WG193", (*path, "cylinders", index, "section"), message, "remove section, or write driven = true")


def _bolts(path: Path, design: LegDesign) -> Iterator[Finding]:
    """Friction of what a pin carries needs its coefficient and the bolt's radius."""
    for here, friction in entries(design, path):
        if isinstance(friction, PinFriction) and (friction.mu is None) != (friction.radius is None):
            key, example = ("radius", "radius = 0.01 (m)") if friction.radius is None else ("mu", "mu = 0.1")
            message = f'missing key "{key}": mu and radius stand together'
            yield Finding("WG111", (*here, key), message, f"write {example}, or leave both out")


def _ends(path: Path, cylinder: CylinderSpec) -> Iterator[Finding]:
    """On two links."""
    first, second = (text.partition(".")[0] for text in cylinder.between)
    if first == second:
        message = f'both ends of the cylinder "{shown(cylinder.name)}" are on the link "{shown(first)}", so it moves nothing'
        yield Finding("WG185", path, message, "name points of two links")


def _lengths(path: Path, design: LegDesign, numbers: Numbers) -> Iterator[Finding]:
    """Of cylinders, above 0."""
    for index, cylinder in enumerate(design.cylinders):
        limits = cylinder.si("limits")
        least = numbers.number(limits[0]) if limits else None
        if least is not None and least <= 0:
            key = "limits" if cylinder.limits is not None else "limits_mm"
            message = f'the least length of the cylinder "{shown(cylinder.name)}" is {float(least):g} m: it would have no direction'
            yield Finding("WG185", (*path, "cylinders", index, key), message, "give two lengths above 0")


def _structure(path: Path, design: LegDesign, numbers: Numbers) -> Iterator[Finding]:
    """What counting and ordering tell."""
    structure = structure_of(design)
    unmoved = list(check_mobility(path, design, structure, numbers))
    yield from unmoved
    if not unmoved:
        yield from check_assembly(path, design, structure, numbers)
        if design.branches is not None:
            yield from _branches((*path, "branches"), design, structure)


def _branches(path: Path, design: LegDesign, structure: Structure) -> Iterator[Finding]:
    """As many names as branches, which the cure spells where there are few."""
    if not design.joints_after and follows_curve(structure, len(design.joints)):
        yield from named_branches(path, design, len(CURVE_BRANCHES))
        return
    if carries_curve(structure, len(design.joints) + len(design.joints_after)):
        yield from named_branches(path, design, len(CARRIED_BRANCHES))
        return
    foot, _ = located(design, design.placed)
    kinds, after = ("".join(joint.type[0].upper() for joint in rows) for rows in (design.joints, design.joints_after))
    hindrance = linkage_hindrance(structure, foot, kinds, after)
    turning = [joint.name for joint in (*design.joints, *design.joints_after) if joint.type == "revolute"]
    choices = linkage_choices(structure, foot, turning)
    for finding in named_branches(path, design, 0 if hindrance else prod(map(len, choices))):
        spelt = f"{finding.cure}: {', '.join(linkage_branches(choices))}" if len(choices) <= _MOST_CHOICES else finding.cure
        yield replace(finding, cure=f"leave branches out: {hindrance}" if hindrance else spelt)

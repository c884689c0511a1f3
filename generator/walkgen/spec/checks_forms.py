"""Rules of the short forms of linkages, and the rules of linkages and springs on what they stand for, told where the short form is."""

import math
from collections.abc import Iterator
from dataclasses import replace

from walkgen.spec.checks_balance import check_balances
from walkgen.spec.checks_linkage import check_linkages
from walkgen.spec.checks_springs import check_springs
from walkgen.spec.evaluate import Numbers
from walkgen.spec.expand import expanded
from walkgen.spec.linkage_forms import POINTS_OF, FiveBar, FourBar, LinkageForm, Parallelogram, SixBar, Stephenson, hung_points, tables_of
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.schema import LegDesign, RobotSpec
from walkgen.spec.table import Path

_BARS = ("ground", "crank", "coupler", "rocker")


def check_forms(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every leg design, its linkage in the short form or the long one, and what balances it."""
    whole: dict[str, LegDesign] = {}
    for name, design in spec.leg_designs.items():
        found = list(_design(("leg_designs", name), design, numbers))
        yield from found
        if not found:
            whole[name] = expanded(design)
    long = spec.model_copy(update={"leg_designs": whole})
    for finding in (*check_linkages(long, numbers), *check_springs(long)):
        yield _located(finding, spec)
    yield from check_balances(long, numbers)


def _located(finding: Finding, spec: RobotSpec) -> Finding:
    """With its place in the file: what the file does not say stands for the short form."""
    design = spec.leg_designs[str(finding.path[1])]
    for key, form in design.forms.items():
        return replace(finding, path=_place(finding.path, design, (*finding.path[:2], key), len(tables_of(form).pins)))
    return finding


def _place(path: Path, design: LegDesign, form: Path, pins: int) -> Path:
    match path[2:]:
        case ("assembly" | "start" | "cylinders" | "sliders" | "plane" | "springs" | "joints_after" | "linkage_end", *_):
            return path
        case ("pins", int(index), *rest) if index >= pins:
            return (*path[:3], index - pins, *rest)
        case ("links", str(link), *_) if link in design.links:
            return path
        case ("foot",) if design.foot is not None:
            return path
    return form


def _design(path: Path, design: LegDesign, numbers: Numbers) -> Iterator[Finding]:
    forms = design.forms
    if len(forms) > 1:
        yield Finding("WG190", (*path, list(forms)[1]), f"{' and '.join(forms)} describe the linkage twice", "keep one of them")
        return
    for key, form in forms.items():
        here = (*path, key)
        six = list(_six_bar(here, key, form)) if isinstance(form, SixBar) else []
        yield from six
        if not six:
            yield from _foot(here, design, form)
            yield from _points(path, design, form)
        if isinstance(form, FourBar) and not (isinstance(form, Stephenson) and form.inversion == "II"):
            yield from _closes(here, form, numbers)
        if isinstance(form, Parallelogram):
            yield from _half_turn(here, design, form, numbers)


def _six_bar(path: Path, key: str, form: SixBar) -> Iterator[Finding]:
    """Its points fit its inversion."""
    inversion = str(getattr(form, "inversion", ""))
    choices = POINTS_OF.get((key, inversion))
    given = tuple(name for name, _ in hung_points(form))
    if choices is not None and given not in choices:
        wanted = " or ".join(" and ".join(choice) for choice in choices)
        other = next((kind for kind, pairs in POINTS_OF.items() if given in pairs), None)
        cure = f"write {wanted}" + (f", or {other[0]} with inversion {other[1]}" if other else "")
        message = f"a {key.capitalize()} {inversion} has {wanted}, not {' and '.join(given) or 'no points'}"
        yield Finding("WG190", path, message, cure)


def _foot(path: Path, design: LegDesign, form: LinkageForm) -> Iterator[Finding]:
    links = tables_of(form).links
    if form.foot is not None and design.foot is not None:
        yield Finding("WG190", (*path, "foot"), "the foot is given twice: by the design too", "keep one of them")
    elif form.foot is None and design.foot is None and not isinstance(form, FiveBar):
        cure = 'write foot = [x, y] in the short form, or foot = "link.point" in the design'
        yield Finding("WG111", (*path, "foot"), 'missing key "foot"', cure)
    if form.foot_link is not None and form.foot_link not in links:
        cure = did_you_mean(form.foot_link, links, "links")
        yield Finding("WG180", (*path, "foot_link"), f'there is no link "{shown(form.foot_link)}"', cure)
    elif form.foot_link is not None and form.foot is None:
        yield Finding("WG190", (*path, "foot_link"), "foot_link says whose point the foot is, and there is no foot", "write foot = [x, y]")


def _points(path: Path, design: LegDesign, form: LinkageForm) -> Iterator[Finding]:
    """What the design adds to the short form's links has names of its own."""
    for name, link in tables_of(form).links.items():
        for point in design.links[name].points if name in design.links else ():
            if point in link.points:
                message = f"the short form gives {name}.{point} already"
                yield Finding("WG190", (*path, "links", name, "points", point), message, "give the point another name")


def _closes(path: Path, form: FourBar, numbers: Numbers) -> Iterator[Finding]:
    """No bar is as long as the other three together."""
    known = {key: float(number) for key in _BARS if (number := numbers.number(getattr(form, key))) is not None}
    if len(known) == len(_BARS) and min(known.values()) > 0:
        longest = max(known, key=lambda key: known[key])
        rest = sum(known.values()) - known[longest]
        if known[longest] >= rest:
            message = f"the four bars do not close: {longest} = {known[longest]:g} m, the other three {rest:g} m together"
            yield Finding("WG190", (*path, longest), message, "mend a length")


def _half_turn(path: Path, design: LegDesign, form: Parallelogram, numbers: Numbers) -> Iterator[Finding]:
    """Where all bars lie on a line the two ways of assembling meet; beyond, the same side of the dyad is the crossed one."""
    limits = form.drive.si("limits")
    low, high = (numbers.number(limit) for limit in limits) if limits else (None, None)
    if low is None or high is None or low > high:
        return
    if math.floor(float(low) / math.pi) != math.ceil(float(high) / math.pi) - 1:
        message = "the crank's limits pass the line of the ground, where a parallelogram folds"
        yield Finding("WG190", (*path, "drive"), message, "give limits between 0 and 180 degrees, or between -180 and 0")
        return
    side = "left" if math.floor(float(low) / math.pi) % 2 == 0 else "right"
    if design.assembly.get("c", "left") != side:
        message = f"with these limits the parallelogram is the {side} one of the two ways to assemble it, the other crosses its bars"
        yield Finding("WG190", (*path, "drive"), message, f'write assembly = {{ c = "{side}" }} in the design')

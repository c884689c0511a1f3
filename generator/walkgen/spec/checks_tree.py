"""Rules of references: what a spec names exists, platforms form one tree, every chain joins two of them, every leg has joints."""

from collections.abc import Iterable, Iterator

from walkgen.spec.functions import FUNCTION_NAMES
from walkgen.spec.joint_tables import JointRow
from walkgen.spec.linkage import CylinderSpec, PlanarLinkSpec
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.schema import ChainDesign, LegDesign, LegSpec, PlatformSpec, RobotSpec
from walkgen.spec.shapes import STAND_IN_NAME
from walkgen.spec.table import Path
from walkgen.spec.tree import mirror_circle, platform_circle

_OF_THE_CHAIN = ("chain", "root", "end", "end_xyz", "end_xyz_mm", "source_names")
_OF_THE_ORIGINAL = ("design", "platform", "mount", "signs", "zeros", "zeros_deg", "sole")


def check_references(spec: RobotSpec) -> Iterator[Finding]:
    """Every name that stands for something else."""
    platforms = [platform.name for platform in spec.platforms]
    for index, platform in enumerate(spec.platforms):
        yield from _reference(("platforms", index, "parent"), platform.parent, platforms, "platform")
        yield from _reference(("platforms", index, "chain"), platform.chain, spec.chain_designs, "chain design")
    for index, leg in enumerate(spec.legs):
        yield from _reference(("legs", index, "design"), leg.design, spec.leg_designs, "leg design")
        yield from _reference(("legs", index, "platform"), leg.platform, platforms, "platform")
        yield from _reference(("legs", index, "mirror_of"), leg.mirror_of, [other.name for other in spec.legs], "leg")
    for path, joint in joint_rows(spec):
        if joint.link:
            yield from _reference((*path, "link", "section"), joint.link.section, spec.sections, "section")
    for path, part in _planar_parts(spec):
        yield from _reference((*path, "section"), part.section, spec.sections, "section")
    functions = () if spec.generate.functions == "all" else spec.generate.functions
    for index, name in enumerate(functions):
        yield from _reference(("generate", "functions", index), name, FUNCTION_NAMES, "function")


def joint_rows(spec: RobotSpec) -> Iterator[tuple[Path, JointRow]]:
    """Every joint of every design, with its path."""
    for key in ("leg_designs", "chain_designs"):
        for name, design in getattr(spec, key).items():
            yield from rows_of((key, name), design)


def rows_of(path: Path, design: ChainDesign | LegDesign) -> Iterator[tuple[Path, JointRow]]:
    """Every joint of one design in series, with its path."""
    before = len(design.joints)
    for index, joint in enumerate(design.rows):
        yield (*path, "joints", index) if index < before else (*path, "joints_after", index - before), joint


def _planar_parts(spec: RobotSpec) -> Iterator[tuple[Path, PlanarLinkSpec | CylinderSpec]]:
    """What may have a section in linkages."""
    for name, design in spec.leg_designs.items():
        yield from ((("leg_designs", name, "links", link), own) for link, own in design.links.items())
        yield from ((("leg_designs", name, "cylinders", index), own) for index, own in enumerate(design.cylinders))


def check_tree(spec: RobotSpec) -> Iterator[Finding]:
    """Platforms are one tree with the first as its root; legs have joints; chains join."""
    if not spec.platforms:
        yield Finding("WG111", ("platforms",), "the robot has no platform", 'write [[platforms]] with name = "body"')
    if not spec.legs:
        yield Finding("WG111", ("legs",), "the robot has no leg", "write [[legs]] with name, design and platform")
    for index, platform in enumerate(spec.platforms):
        path: Path = ("platforms", index)
        yield from _root(path, platform) if index == 0 else _branch(path, platform)
        circle = platform_circle(spec, platform.name)
        if platform.name == min(circle, default=None):
            message = f"the platforms are each other's parents: {' -> '.join(shown(name) for name in circle)}"
            yield Finding("WG143", (*path, "parent"), message, "let every platform lead back to the first one")
    for index, leg in enumerate(spec.legs):
        yield from _leg(spec, ("legs", index), leg)
    yield from _designs(spec)


def _reference(path: Path, name: str | None, known: Iterable[str], what: str) -> Iterator[Finding]:
    names = list(known)
    if name is not None and name not in names and STAND_IN_NAME not in names:
        yield Finding("WG140", path, f'there is no {what} "{shown(name)}"', did_you_mean(name, names, f"known {what}s"))


def _root(path: Path, platform: PlatformSpec) -> Iterator[Finding]:
    if platform.parent is not None:
        cure = "put the root platform first, or remove parent and chain here"
        yield Finding("WG146", (*path, "parent"), "the first platform is the root and has no parent", cure)
        return
    for key in _OF_THE_CHAIN:
        if getattr(platform, key) is not None:
            yield Finding("WG145", (*path, key), f"{key}: the first platform has no parent, so its chain joins nothing", f"remove {key}")


def _branch(path: Path, platform: PlatformSpec) -> Iterator[Finding]:
    if platform.parent is None and platform.chain is not None:
        yield Finding(
            "WG145", (*path, "chain"), "the chain joins nothing: the platform has no parent", 'write parent = "..."', ((*path, "parent"),)
        )
    elif platform.parent is None:
        cure = 'write parent = "..." and chain = "..."; a robot has one root, its first platform'
        yield Finding("WG146", (*path, "parent"), f'the platform "{shown(platform.name)}" hangs on nothing', cure)
    elif platform.chain is None:
        cure = 'write chain = "..."; a rigid connection is part of the parent itself'
        yield Finding("WG146", (*path, "chain"), f'no chain joins "{shown(platform.name)}" to its parent', cure)
    if platform.end != "level" and (platform.end_xyz is not None or platform.end_xyz_mm is not None):
        key = "end_xyz" if platform.end_xyz is not None else "end_xyz_mm"
        yield Finding(
            "WG124", (*path, key), f'{key} goes with end = "level"', 'write end = "level", or put xyz into end = { ... }', ((*path, "end"),)
        )


def _leg(spec: RobotSpec, path: Path, leg: LegSpec) -> Iterator[Finding]:
    if leg.mirror_of is None:
        for key in ("design", "platform"):
            if getattr(leg, key) is None:
                yield Finding(
                    "WG111", (*path, key), f'missing key "{key}"', f'write {key} = "...", or mirror_of = "..."', ((*path, "mirror_of"),)
                )
        return
    for key in _OF_THE_ORIGINAL:
        if getattr(leg, key) is not None:
            yield Finding(
                "WG147", (*path, key), f"a mirrored leg takes its {key} from the leg that it mirrors", f"remove {key} or mirror_of"
            )
    circle = mirror_circle(spec, leg)
    if leg.name == min(circle, default=None):
        message = f"the leg mirrors itself: {' -> '.join(shown(name) for name in circle)}"
        yield Finding("WG148", (*path, "mirror_of"), message, "describe one of the legs by its design and platform")


def _designs(spec: RobotSpec) -> Iterator[Finding]:
    for key, what in (("leg_designs", "leg"), ("chain_designs", "chain")):
        for name, design in getattr(spec, key).items():
            if not design.joints and not (isinstance(design, LegDesign) and design.planar):
                yield Finding("WG144", (key, name, "joints"), f"the {what} has no joints", f"write [[{key}.{name}.joints]] for every joint")
    uses: tuple[Path, ...] = (("platforms",), *(("platforms", index, "chain") for index in range(len(spec.platforms))))
    used = {platform.chain for platform in spec.platforms}
    astray = used - {None} - spec.chain_designs.keys()  # an unknown name may have meant the unused design
    for name in spec.chain_designs:
        if name not in used and not astray:
            cure = f'write chain = "{shown(name)}" at a platform, or remove the design'
            yield Finding("WG145", ("chain_designs", name), "the chain joins nothing: no platform uses it", cure, uses)

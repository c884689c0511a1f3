"""Rules of names: what they look like, that they differ, and that they still differ when joined to the names of generated code."""

from collections.abc import Iterator
from typing import TypeVar

from walkgen.spec.checks_gait import gait_owner, gaits_of
from walkgen.spec.checks_tree import rows_of
from walkgen.spec.functions import CHAIN_FUNCTIONS, GAIT_FUNCTIONS, LEG_FUNCTIONS, ROBOT_FUNCTIONS, ROUTE_FUNCTIONS, TERRAIN_FUNCTIONS
from walkgen.spec.linkage import PairSpec
from walkgen.spec.linkage_forms import DriveSpec
from walkgen.spec.names import PATTERN, RESERVED, is_own_prefix, suggestion
from walkgen.spec.problems import Finding, shown
from walkgen.spec.schema import ChainDesign, Design, LegDesign, LegSpec, PlatformSpec, RobotSpec
from walkgen.spec.shapes import STAND_IN_NAME
from walkgen.spec.springs import SpringSpec
from walkgen.spec.table import Path, entries
from walkgen.spec.tree import design_of, platform_of

_LONGEST_TEXT = 500
_Entry = TypeVar("_Entry", PlatformSpec, LegSpec)


def check_names(spec: RobotSpec) -> Iterator[Finding]:
    """Every name by itself, then every group of names that must differ."""
    for path, name in _named(spec):
        yield from _check_name(path, name)
    if is_own_prefix(spec.robot.name):
        yield Finding("WG131", ("robot", "name"), f'"{spec.robot.name}" is the prefix of the support code', "choose another name")
    for group in _groups(spec):
        yield from _duplicates(group)


def check_joined_names(spec: RobotSpec) -> Iterator[Finding]:
    """No two generated functions and no two joints may get the same full name."""
    yield from _collisions(_function_names(spec), "the generated functions of both are called")
    yield from _collisions(_joint_names(spec), "two joints are called")


def check_texts(spec: RobotSpec) -> Iterator[Finding]:
    """Free texts are printed into comments and strings of the generated code."""
    for path, text in _texts(spec):
        if not text.isprintable() or "*/" in text or "/*" in text or len(text) > _LONGEST_TEXT:
            message = f'"{shown(text)}" holds control characters, a comment mark, or more than {_LONGEST_TEXT} letters'
            yield Finding("WG134", path, message, "write one line of plain text without /* and */")
    for index, patch in enumerate(spec.terrain):
        if patch.file is not None and (".." in patch.file or patch.file.startswith("/") or "\\" in patch.file or ":" in patch.file):
            yield Finding(
                "WG134", ("terrain", index, "file"), f'"{shown(patch.file)}" leaves the spec\'s folder', "name a file beside the spec"
            )


def _named(spec: RobotSpec) -> Iterator[tuple[Path, str]]:
    yield ("robot", "name"), spec.robot.name
    for key in ("parameters", "leg_designs", "chain_designs", "sections", "balance"):
        yield from (((key, name), name) for name in getattr(spec, key))
    for key in ("platforms", "legs", "terrain"):
        yield from (((key, index, "name"), entry.name) for index, entry in enumerate(getattr(spec, key)))
    for path, design in _designs(spec):
        yield from (((*place, "name"), joint.name) for place, joint in rows_of(path, design))
    yield from ((path, name) for name, path, _ in gaits_of(spec) if name)
    yield from _branch_names(spec)
    yield from _pair_names(spec)


def _branch_names(spec: RobotSpec) -> Iterator[tuple[Path, str]]:
    for key, design in spec.leg_designs.items():
        yield from ((("leg_designs", key, "branches", index), name) for index, name in enumerate(design.branches or ()))


def _pair_names(spec: RobotSpec) -> Iterator[tuple[Path, str]]:
    """Of linkages: pairs, and the drives of short forms; of springs."""
    for key, design in spec.leg_designs.items():
        for path, table in entries(design, ("leg_designs", key)):
            if isinstance(table, PairSpec | DriveSpec | SpringSpec) and (name := getattr(table, "name", None)) is not None:
                yield (*path, "name"), name


def _designs(spec: RobotSpec) -> Iterator[tuple[Path, LegDesign | ChainDesign]]:
    yield from ((("leg_designs", name), design) for name, design in spec.leg_designs.items())
    yield from ((("chain_designs", name), design) for name, design in spec.chain_designs.items())


def _check_name(path: Path, name: str) -> Iterator[Finding]:
    better = suggestion(name)
    cure = f'call it "{better}"' if better else "choose a name such as front_left"
    if not PATTERN.fullmatch(name):
        message = f'"{shown(name)}" is not a name: a letter a-z, then at most 30 of a-z, 0-9 and _'
        yield Finding("WG130", path, message, cure)
    elif name in RESERVED:
        yield Finding("WG131", path, f'"{name}" is {RESERVED[name]}', cure)


def _groups(spec: RobotSpec) -> Iterator[list[tuple[Path, str]]]:
    named = list(_named(spec))
    for key in ("platforms", "legs", "terrain"):
        yield [(path, name) for path, name in named if path[0] == key]
    for path, _ in _designs(spec):
        for keys in (("joints", "joints_after"), ("branches",), ("springs",)):
            yield [(place, name) for place, name in named if any(place[:3] == (*path, key) for key in keys)]


def _duplicates(group: list[tuple[Path, str]]) -> Iterator[Finding]:
    seen: set[str] = set()
    for path, name in group:
        if name in seen and name != STAND_IN_NAME:
            yield Finding("WG132", path, f'the name "{shown(name)}" is used twice', "give each its own name")
        seen.add(name)


def _first(listed: tuple[_Entry, ...]) -> list[tuple[int, _Entry]]:
    """The entries with their indices, without those that repeat a name (which is a problem of its own)."""
    names = [entry.name for entry in listed]
    return [(index, entry) for index, entry in enumerate(listed) if names.index(entry.name) == index]


def _function_names(spec: RobotSpec) -> Iterator[tuple[Path, str]]:
    """Where each generated function's owner is named, and the function's full name."""
    robot = spec.robot.name
    yield from ((("robot", "name"), f"{robot}_{function}") for function in ROBOT_FUNCTIONS)
    yield from ((("terrain",), f"{robot}_terrain_{function}") for function in TERRAIN_FUNCTIONS if spec.terrain)
    for name, path, _ in gaits_of(spec):
        yield from ((path, f"{robot}_{gait_owner(name)}_{function}") for function in GAIT_FUNCTIONS)
    for index, platform in _first(spec.platforms)[1:]:
        yield from ((("platforms", index, "name"), f"{robot}_{platform.name}_{function}") for function in CHAIN_FUNCTIONS)
    for index, leg in _first(spec.legs):
        place: Path = ("legs", index, "name")
        yield from ((place, f"{prefix}_{leg.name}_{function}") for function in LEG_FUNCTIONS for prefix in (robot, f"{robot}_f32"))
        if spec.platforms and platform_of(spec, leg) != spec.platforms[0].name:
            yield from ((place, f"{robot}_root_to_{leg.name}_{function}") for function in ROUTE_FUNCTIONS)


def _joint_names(spec: RobotSpec) -> Iterator[tuple[Path, str]]:
    """Where each joint of the robot gets its name, and that name."""
    chains = spec.chain_designs
    owners: list[tuple[Path, PlatformSpec | LegSpec, Design | None]] = [
        (("platforms", index), platform, chains.get(platform.chain or "")) for index, platform in _first(spec.platforms)
    ]
    owners += [(("legs", index), leg, design_of(spec, leg)) for index, leg in _first(spec.legs)]
    for path, owner, design in owners:
        for index, joint in enumerate(design.rows if design else ()):
            sources = owner.source_names
            if sources and index < len(sources):
                yield (*path, "source_names", index), sources[index]
            else:
                yield (*path, "name"), f"{owner.name}_{joint.name}"


def _collisions(names: Iterator[tuple[Path, str]], message: str) -> Iterator[Finding]:
    seen: dict[str, Path] = {}
    blamed: set[Path] = set()
    for path, name in names:
        other = seen.setdefault(name, path)
        if other != path and path not in blamed and STAND_IN_NAME not in name:
            blamed.add(path)
            yield Finding("WG133", path, f"{message} {shown(name, 100)}", "rename one of them")


def _texts(spec: RobotSpec) -> Iterator[tuple[Path, str]]:
    yield ("robot", "description"), spec.robot.description
    yield from ((("parameters", name, "unit"), entry.unit) for name, entry in spec.parameters.items())
    for key in ("platforms", "legs"):
        for index, entry in enumerate(getattr(spec, key)):
            yield from (((key, index, "source_names", place), text) for place, text in enumerate(entry.source_names or ()))

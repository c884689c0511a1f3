"""From a URDF file to a spec: the tree cut into platforms, chains and legs, every name made one that a spec may have."""

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import tomli
from pydantic import ValidationError

from walkgen.errors import Place, Problem, SpecError
from walkgen.spec.checks_names import check_joined_names, check_texts
from walkgen.spec.names import PATTERN, RESERVED, is_own_prefix, suggestion
from walkgen.spec.schema import RobotSpec
from walkgen.spec.urdf_limbs import Limbs, Row, cut
from walkgen.spec.urdf_pose import off_grid
from walkgen.spec.urdf_read import read_urdf
from walkgen.spec.urdf_tree import Tree
from walkgen.spec.urdf_write import key, oddity, write

_RENAME = "rename it in the URDF"


@dataclass(frozen=True)
class Imported:
    """The spec's text, its names (the URDF's, the spec's), and what the user should know."""

    toml: str
    names: tuple[tuple[str, str], ...]
    warnings: tuple[Problem, ...]


def convert(path: Path, feet: tuple[str, ...]) -> Imported:
    """The spec of the robot in a URDF file.

    Args:
        path: the URDF file.
        feet: link names; each becomes a leg of that name, its foot frame the link's frame.

    Raises:
        SpecError: the file is not a robot, a foot does not exist or has no joints of its own, names collide, the robot is too large.
    """
    tree = Tree(read_urdf(path))
    limbs = cut(tree, feet)
    names = _names(tree, limbs)
    toml = write(_robot(tree.urdf.name), path.name, limbs)
    _check_joined(toml, tree.urdf.place)
    return Imported(toml, names, (*limbs.warnings, *_warnings(tree, limbs)))


def _robot(name: str) -> str:
    """The robot's name; where its own cannot be one, the nearest that can."""
    near = suggestion(name)
    return near if near and not is_own_prefix(near) else "robot"


def _unusable(name: str) -> str:
    """What keeps a text from being a name; empty if nothing does."""
    if not PATTERN.fullmatch(name):
        return "not a name: a letter first, at most 31 letters, digits and underscores"
    return RESERVED.get(name, "")


def _names(tree: Tree, limbs: Limbs) -> tuple[tuple[str, str], ...]:
    """Each of the URDF's names that the spec uses, with the spec's name."""
    ends = [platform.link for platform in limbs.platforms] + [leg.end for leg in limbs.legs]
    groups = [[(link, tree.links[link].place) for link in ends]]
    groups += [[(row.joint.name, row.joint.place) for row in limb.rows] for limb in limbs.all]
    problems = [problem for group in groups for problem in _collisions(group)]
    if problems:
        raise SpecError(*problems)
    return tuple((source, key(source)) for group in groups for source, _ in group)


def _collisions(group: list[tuple[str, Place]]) -> Iterator[Problem]:
    first: dict[str, str] = {}
    for source, place in group:
        name = key(source)
        if _unusable(name):
            yield Problem("WG511", f"{source!r} becomes {name!r}, which is {_unusable(name)}", _RENAME, place)
        elif first.setdefault(name, source) != source:
            yield Problem("WG511", f"{first[name]!r} and {source!r} both become {name!r}", "rename one of them in the URDF", place)


def _check_joined(toml: str, place: Place) -> None:
    """Names that are fine one by one must also be so where a limb's and a function's are joined, and texts in comments."""
    try:
        spec = RobotSpec.model_validate(tomli.loads(toml, parse_float=Decimal))
    except ValidationError as error:
        cure = "import fewer feet, or remove joints: a leg or chain has at most 64, a robot at most 100 of each"
        raise SpecError(Problem("WG522", f"the robot is larger than a spec may be: {error.errors()[0]['msg']}", cure, place)) from None
    findings = [*check_joined_names(spec), *check_texts(spec)]
    if findings:
        raise SpecError(*(Problem("WG511", finding.message, _RENAME, place) for finding in findings))


def _warnings(tree: Tree, limbs: Limbs) -> Iterator[Problem]:
    rows: list[Row] = [row for limb in limbs.all for row in limb.rows]
    bodies = [(platform.link, platform.body) for platform in limbs.platforms] + [(row.joint.child, row.body) for row in rows]
    for link, body in bodies:
        reason = oddity(body) if body else ""
        if reason:
            cure = "kept with allow_unphysical = true; correct it in the spec if you can"
            yield Problem("WG514", f"link {link!r} (with what is fixed to it): {reason}", cure, tree.links[link].place)
    for joint in tree.urdf.joints:
        rounded = [str(angle) for angle in joint.origin.rpy if off_grid(angle)]
        if rounded:
            cure = "kept as typed; if a multiple of 15 degrees is meant, give it to 16 digits: the closed form of the inverse depends on it"
            yield Problem("WG515", f"joint {joint.name!r}: rpy {', '.join(rounded)} looks rounded", cure, joint.place)

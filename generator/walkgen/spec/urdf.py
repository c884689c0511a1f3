"""From a URDF file to a spec: fixed joints folded, legs cut out along the paths to their feet, numbers kept digit by digit."""

import difflib
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from walkgen.errors import Problem, SpecError, UnsupportedMechanism
from walkgen.spec.names import PATTERN, RESERVED, is_own_prefix, suggestion
from walkgen.spec.urdf_pose import IDENTITY, Inertial, Pose, compose, merge, off_grid
from walkgen.spec.urdf_read import Urdf, UrdfJoint, UrdfLink, read_urdf
from walkgen.spec.urdf_write import Leg, Row, oddity, write


@dataclass(frozen=True)
class Imported:
    """The spec's text, the names that changed (the URDF's, the spec's), and what the user should know."""

    toml: str
    names: tuple[tuple[str, str], ...]
    warnings: tuple[Problem, ...]


def convert(path: Path, feet: tuple[str, ...]) -> Imported:
    """The spec of the robot in a URDF file.

    Args:
        path: the URDF file.
        feet: link names; each becomes a leg of that name, its foot frame the link's frame.

    Raises:
        SpecError: the file is not a robot, a foot's link does not exist, names collide.
        UnsupportedMechanism: movable joints shared by several feet, or on the way to none.
    """
    tree = Tree(read_urdf(path))
    paths = tuple(tree.path(link) for link in _foot_links(tree, feet))
    _refuse_shared(tree, feet, paths)
    legs = tuple(_leg(tree, foot, path) for foot, path in zip(feet, paths, strict=True))
    base = tree.body(tree.root)
    keys = _names(tree, feet, legs)
    return Imported(write(_robot(tree.urdf.name), path.name, (_key(tree.root), base), legs), keys, _warnings(tree, base, legs))


class Tree:
    """The links as the joints hang them together: one root, every other link below it."""

    def __init__(self, urdf: Urdf) -> None:
        """Raises SpecError where the file is not a tree."""
        self.urdf = urdf
        self.links = {link.name: link for link in urdf.links}
        problems = [*_repeated(urdf.links), *_repeated(urdf.joints), *self._dangling()]
        if problems:
            raise SpecError(*problems)
        self.above = {joint.child: joint for joint in urdf.joints}
        self.below: dict[str, list[UrdfJoint]] = {link.name: [] for link in urdf.links}
        for joint in urdf.joints:
            self.below[joint.parent].append(joint)
        self.root = self._root()

    def path(self, link: str) -> tuple[UrdfJoint, ...]:
        """The joints from the root to the link."""
        joints: list[UrdfJoint] = []
        while link in self.above:
            joints.append(self.above[link])
            link = joints[-1].parent
        return tuple(reversed(joints))

    def body(self, link: str) -> Inertial | None:
        """The link and all that is fixed to it, in the link's frame; None without any mass."""
        bodies: list[tuple[Pose, Inertial]] = []
        waiting = [(link, IDENTITY)]
        while waiting:
            name, pose = waiting.pop(0)
            inertial = self.links[name].inertial
            if inertial is not None:
                bodies.append((pose, inertial))
            waiting += [(joint.child, compose(pose, joint.origin)) for joint in self.below[name] if joint.kind == "fixed"]
        return merge(bodies) if bodies else None

    def _dangling(self) -> Iterable[Problem]:
        parents = Counter(joint.child for joint in self.urdf.joints)
        for joint in self.urdf.joints:
            for link in (joint.parent, joint.child):
                if link not in self.links:
                    yield Problem(
                        "WG510",
                        f"joint {joint.name!r} names the link {link!r}, which is not there",
                        _nearest(link, self.links),
                        joint.place,
                    )
            if parents[joint.child] > 1:
                message = f"link {joint.child!r} is the child of {parents[joint.child]} joints"
                yield Problem("WG510", message, "a URDF is a tree: open the loop at one joint", joint.place)

    def _root(self) -> str:
        roots = [link for link in self.links if link not in self.above]
        if len(roots) != 1:
            found = "no link is the base: the joints form a loop" if not roots else f"{len(roots)} links have no parent: {', '.join(roots)}"
            raise SpecError(Problem("WG510", found, "a URDF is one tree: hang every link but the base below a joint", self.urdf.place))
        reached, waiting = set(), list(roots)
        while waiting:
            link = waiting.pop()
            reached.add(link)
            waiting += [joint.child for joint in self.below[link]]
        loop = [link for link in self.links if link not in reached]
        if loop:
            message = f"these links form a loop that the base does not reach: {', '.join(loop)}"
            raise SpecError(Problem("WG510", message, "a URDF is one tree: hang every link but the base below a joint", self.urdf.place))
        return roots[0]


def _repeated(items: tuple[UrdfLink, ...] | tuple[UrdfJoint, ...]) -> Iterable[Problem]:
    seen: set[str] = set()
    for item in items:
        if item.name in seen:
            yield Problem("WG510", f"the name {item.name!r} is given twice", "give every link and every joint its own name", item.place)
        seen.add(item.name)


def _foot_links(tree: Tree, feet: tuple[str, ...]) -> tuple[str, ...]:
    problems = [
        Problem("WG509", f"--foot {foot}: no such link", _nearest(foot, tree.links), tree.urdf.place)
        for foot in feet
        if foot not in tree.links
    ]
    problems += [
        Problem("WG509", f"--foot {foot} is given twice", "name each foot once") for foot, count in Counter(feet).items() if count > 1
    ]
    for foot in feet:
        if foot in tree.links and all(joint.kind == "fixed" for joint in tree.path(foot)):
            cure = "name the last link of a leg: --foot LINK"
            problems.append(
                Problem(
                    "WG516", f"no movable joint lies between the base {tree.root!r} and the foot {foot!r}", cure, tree.links[foot].place
                )
            )
    if not feet:
        leaves = [link for link in tree.links if not tree.below[link]]
        problems.append(
            Problem("WG509", "no foot is named", f"name each: --foot LINK; the last links of this file are {', '.join(leaves)}")
        )
    if problems:
        raise SpecError(*problems)
    return feet


def _refuse_shared(tree: Tree, feet: tuple[str, ...], paths: tuple[tuple[UrdfJoint, ...], ...]) -> None:
    uses = Counter(joint.name for path in paths for joint in path)
    problems = []
    for joint in tree.urdf.joints:
        if joint.kind == "fixed" or uses[joint.name] == 1:
            continue
        if uses[joint.name]:
            sharing = ", ".join(foot for foot, path in zip(feet, paths, strict=True) if joint in path)
            cure = "describe the joints between two platforms by hand as a chain design, or import the feet of one platform only"
            problems.append(Problem("WG512", f"joint {joint.name!r} moves several feet: {sharing}", cure, joint.place))
        else:
            cure = 'make it fixed (type="fixed") where it stands, or name the foot that it moves with --foot'
            problems.append(Problem("WG513", f"joint {joint.name!r} lies on the way to no foot", cure, joint.place))
    if problems:
        raise UnsupportedMechanism(*problems)


def _leg(tree: Tree, foot: str, path: tuple[UrdfJoint, ...]) -> Leg:
    rows: list[Row] = []
    pose = IDENTITY
    for joint in path:
        pose = compose(pose, joint.origin)
        if joint.kind != "fixed":
            rows.append(Row(_key(joint.name), joint, pose, tree.body(joint.child)))
            pose = IDENTITY
    return Leg(_key(foot), tuple(rows), pose)


def _key(name: str) -> str:
    """The spec's name: lower case, every other character an underscore."""
    return re.sub(r"[^a-z0-9_]", "_", name.lower())


def _robot(name: str) -> str:
    """The robot's name; where its own cannot be one, the nearest that can."""
    near = suggestion(name)
    return near if near and not is_own_prefix(near) else "robot"


def _unusable(key: str) -> str:
    """What keeps a key from being a name; empty if nothing does."""
    if not PATTERN.fullmatch(key):
        return "not a name: a letter first, at most 31 letters, digits and underscores"
    return RESERVED.get(key, "")


def _names(tree: Tree, feet: tuple[str, ...], legs: tuple[Leg, ...]) -> tuple[tuple[str, str], ...]:
    """Each of the URDF's names that the spec uses, with the spec's name."""
    links = [(name, _key(name), tree.links[name].place) for name in (tree.root, *feet)]
    groups = [links, *([(row.joint.name, row.key, row.joint.place) for row in leg.rows] for leg in legs)]
    problems = []
    for group in groups:
        first: dict[str, str] = {}
        for source, key, place in group:
            if _unusable(key):
                problems.append(Problem("WG511", f"{source!r} becomes {key!r}, which is {_unusable(key)}", "rename it in the URDF", place))
            elif first.setdefault(key, source) != source:
                message = f"{first[key]!r} and {source!r} both become {key!r}"
                problems.append(Problem("WG511", message, "rename one of them in the URDF", place))
    if problems:
        raise SpecError(*problems)
    return tuple((source, key) for group in groups for source, key, _ in group)


def _warnings(tree: Tree, base: Inertial | None, legs: tuple[Leg, ...]) -> tuple[Problem, ...]:
    rows = [row for leg in legs for row in leg.rows]
    warnings = []
    for link, body in ((tree.root, base), *((row.joint.child, row.body) for row in rows)):
        reason = oddity(body) if body else ""
        if reason:
            cure = "kept with allow_unphysical = true; correct it in the spec if you can"
            warnings.append(Problem("WG514", f"link {link!r} (with what is fixed to it): {reason}", cure, tree.links[link].place))
    for joint in tree.urdf.joints:
        rounded = [str(angle) for angle in joint.origin.rpy if off_grid(angle)]
        if rounded:
            cure = "kept as typed; if a multiple of 15 degrees is meant, give it to 16 digits: the closed form of the inverse depends on it"
            warnings.append(Problem("WG515", f"joint {joint.name!r}: rpy {', '.join(rounded)} looks rounded", cure, joint.place))
    return tuple(warnings)


def _nearest(name: str, names: Iterable[str]) -> str:
    known = tuple(names)
    near = difflib.get_close_matches(name, known, 1, 0)
    return f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(known)}"

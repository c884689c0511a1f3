"""Cuts a URDF's tree into platforms, the chains between them and legs, along the paths to the feet."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from walkgen.errors import Problem, SpecError
from walkgen.spec.urdf_pose import IDENTITY, Inertial, Pose, compose
from walkgen.spec.urdf_read import UrdfJoint
from walkgen.spec.urdf_tree import Tree, nearest


@dataclass(frozen=True)
class Row:
    """A movable joint with the folded pose before it and the folded body after it."""

    joint: UrdfJoint
    origin: Pose
    body: Inertial | None


@dataclass(frozen=True)
class Limb:
    """The rows from the platform `start` to the link `end` (a foot or another platform), whose frame is `tip` in the last row's."""

    start: str
    end: str
    rows: tuple[Row, ...]
    tip: Pose


@dataclass(frozen=True)
class Platform:
    """A platform, known by the link whose frame it has; `chain` leads to it, None for the root."""

    link: str
    body: Inertial | None
    chain: Limb | None


@dataclass(frozen=True)
class Limbs:
    """The whole robot: the root platform first, parents before their children, legs in the order of the feet."""

    platforms: tuple[Platform, ...]
    legs: tuple[Limb, ...]
    warnings: tuple[Problem, ...]

    @property
    def chains(self) -> tuple[Limb, ...]:
        """The connecting chains, in the order of the platforms that they lead to."""
        return tuple(platform.chain for platform in self.platforms if platform.chain)

    @property
    def all(self) -> tuple[Limb, ...]:
        """Chains, then legs: the order of q."""
        return self.chains + self.legs


def cut(tree: Tree, feet: tuple[str, ...]) -> Limbs:
    """The robot's limbs.

    A body is a platform where the paths to the feet part, where joints of no foot's path leave it, and where such joints end.

    Raises:
        SpecError: a foot is unknown, named twice, or has no joint of its own.
    """
    _check_feet(tree, feet)
    cutter = _Cutter(tree, feet)
    problems = tuple(cutter.footless())
    if problems:
        raise SpecError(*problems)
    return Limbs(tuple(cutter.platforms()), tuple(cutter.limb(foot) for foot in feet), tuple(cutter.cut_legs()))


class _Cutter:
    """What is counted once for all limbs; a body goes by its top link, the one right after a movable joint (or the root)."""

    def __init__(self, tree: Tree, feet: tuple[str, ...]) -> None:
        self.tree = tree
        self.feet = feet
        self.paths = {foot: tree.path(foot) for foot in feet}
        self.carried = Counter(joint.child for path in self.paths.values() for joint in path)
        self.carried[tree.root] = len(feet)
        self.tops: dict[str, str] = {}
        for link in tree.links:
            joint = tree.above.get(link)
            self.tops[link] = link if joint is None or joint.kind != "fixed" else self.tops[joint.parent]
        self.leaving: dict[str, list[UrdfJoint]] = {top: [] for top in self.tops.values()}
        for link in tree.links:
            for joint in tree.below[link]:
                if joint.kind != "fixed":
                    self.leaving[self.tops[link]].append(joint)

    @cached_property
    def ends(self) -> Mapping[str, str]:
        """The platform's link of every body that is a platform, by the body's top; the root is the first."""
        return {top: self.junction(top) for top in self.leaving if self.is_platform(top)}

    @cached_property
    def starts(self) -> frozenset[str]:
        return frozenset(self.ends.values())

    def is_platform(self, top: str) -> bool:
        """Not where one joint carries on to all the same feet, nor where a leg ends."""
        here, onward = self.carried[top], [self.carried[joint.child] for joint in self.leaving[top]]
        return top == self.tree.root or not (onward == [here] or (here == 1 and not onward))

    def junction(self, top: str) -> str:
        """The last link that all paths through the body share; its top where none goes on."""
        if top == self.tree.root:
            return top
        last = top
        users = [joint.parent for joint in self.leaving[top]] + [foot for foot in self.feet if self.tops[foot] == top]
        for group in zip(*(self.within(link, top) for link in users), strict=False):
            if len(set(group)) > 1:
                break
            last = group[0]
        return last

    def within(self, link: str, top: str) -> list[str]:
        """The links from the body's top to this one."""
        names = [link]
        while names[-1] != top:
            names.append(self.tree.above[names[-1]].parent)
        return names[::-1]

    def platforms(self) -> Iterator[Platform]:
        for top, link in self.ends.items():
            yield Platform(link, self.tree.body(link), None if top == self.tree.root else self.limb(link))

    def limb(self, end: str) -> Limb:
        """The joints between the last platform above the link and the link itself."""
        joints: list[UrdfJoint] = []
        link = end
        while not joints or link not in self.starts:
            joints.insert(0, self.tree.above[link])
            link = joints[0].parent
        rows: list[Row] = []
        pose = IDENTITY
        for joint in joints:
            pose = compose(pose, joint.origin)
            if joint.kind != "fixed":
                rows.append(Row(joint, pose, None if joint.child in self.ends else self.tree.body(joint.child)))
                pose = IDENTITY
        return Limb(link, end, tuple(rows), pose)

    def footless(self) -> Iterator[Problem]:
        """Feet that stand on a platform themselves, so that nothing is left to be their leg."""
        for foot in self.feet:
            top = self.tops[foot]
            place = self.tree.links[foot].place
            others = [other for other in self.feet if other != foot and self.last_joint(foot) in self.paths[other]]
            if self.last_joint(foot) is None:
                message = f"no movable joint lies between the base {self.tree.root!r} and the foot {foot!r}"
                yield Problem("WG516", message, "name the last link of a leg: --foot LINK", place)
            elif others:
                message = f"every joint on the way to the foot {foot!r} also moves: {', '.join(others)}"
                yield Problem("WG512", message, "name one foot for each leg, the last link of the leg", place)
            elif self.leaving[top]:
                names = ", ".join(repr(joint.name) for joint in self.leaving[top])
                cure = 'name a link beyond it as the foot, or make it fixed (type="fixed") where it stands'
                yield Problem("WG513", f"the foot {foot!r} is not its leg's end: it carries {names}", cure, self.leaving[top][0].place)

    def last_joint(self, foot: str) -> UrdfJoint | None:
        return next((joint for joint in reversed(self.paths[foot]) if joint.kind != "fixed"), None)

    def cut_legs(self) -> Iterator[Problem]:
        """Platforms in the middle of one foot's way, made only for the joints that hang there."""
        for top, link in self.ends.items():
            if top != self.tree.root and self.carried[top] == 1:
                foot = next(foot for foot, path in self.paths.items() if self.tree.above[top] in path)
                for joint in self.leaving[top]:
                    if not self.carried[joint.child]:
                        message = f"joint {joint.name!r} hangs on the way to {foot!r}: {link!r} becomes a platform and the leg starts there"
                        yield Problem("WG521", message, 'to keep the leg whole, make the joint fixed (type="fixed")', joint.place)


def _check_feet(tree: Tree, feet: tuple[str, ...]) -> None:
    problems = [
        Problem("WG509", f"--foot {foot}: no such link", nearest(foot, tree.links), tree.urdf.place)
        for foot in feet
        if foot not in tree.links
    ]
    problems += [
        Problem("WG509", f"--foot {foot} is given twice", "name each foot once") for foot, count in Counter(feet).items() if count > 1
    ]
    if not feet:
        leaves = ", ".join(link for link in tree.links if not tree.below[link])
        problems.append(Problem("WG509", "no foot is named", f"name each: --foot LINK; the last links of this file are {leaves}"))
    if problems:
        raise SpecError(*problems)

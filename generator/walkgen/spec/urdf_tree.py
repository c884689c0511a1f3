"""The links of a URDF as its joints hang them together, with everything that keeps them from being one tree."""

import difflib
from collections import Counter
from collections.abc import Iterable

from walkgen.errors import Problem, SpecError
from walkgen.spec.urdf_pose import IDENTITY, Inertial, Pose, compose, inverse, merge
from walkgen.spec.urdf_read import Urdf, UrdfJoint, UrdfLink

_ONE_TREE = "a URDF is one tree: hang every link but the base below a joint"


class Tree:
    """One root, every other link below it; `links` has parents before their children."""

    def __init__(self, urdf: Urdf) -> None:
        """Raises SpecError where the file is not a tree."""
        self.urdf = urdf
        links = {link.name: link for link in urdf.links}
        problems = [*_repeated(urdf.links), *_repeated(urdf.joints), *_dangling(urdf, links)]
        if problems:
            raise SpecError(*problems)
        self.above = {joint.child: joint for joint in urdf.joints}
        self.below: dict[str, list[UrdfJoint]] = {link.name: [] for link in urdf.links}
        for joint in urdf.joints:
            self.below[joint.parent].append(joint)
        self.root = self._root(links)
        self.links = {name: links[name] for name in self._reached(links)}

    def path(self, link: str) -> tuple[UrdfJoint, ...]:
        """The joints from the root to the link."""
        joints: list[UrdfJoint] = []
        while link in self.above:
            joints.append(self.above[link])
            link = joints[-1].parent
        return tuple(reversed(joints))

    def top(self, link: str) -> str:
        """The first of the links that the link is fixed to: the one right after a movable joint, or the root."""
        while link in self.above and self.above[link].kind == "fixed":
            link = self.above[link].parent
        return link

    def body(self, link: str) -> Inertial | None:
        """The link and all that is fixed to it, above and below, in the link's frame; None without any mass."""
        top = self.top(link)
        between = self.path(link)[len(self.path(top)) :]
        bodies: list[tuple[Pose, Inertial]] = []
        waiting = [(top, inverse(_folded(between)))]
        for name, pose in waiting:
            inertial = self.links[name].inertial
            if inertial is not None:
                bodies.append((pose, inertial))
            waiting += [(joint.child, compose(pose, joint.origin)) for joint in self.below[name] if joint.kind == "fixed"]
        return merge(bodies) if bodies else None

    def _root(self, links: dict[str, UrdfLink]) -> str:
        roots = [link for link in links if link not in self.above]
        if len(roots) != 1:
            found = "no link is the base: the joints form a loop" if not roots else f"{len(roots)} links have no parent: {', '.join(roots)}"
            raise SpecError(Problem("WG510", found, _ONE_TREE, self.urdf.place))
        return roots[0]

    def _reached(self, links: dict[str, UrdfLink]) -> list[str]:
        reached = [self.root]
        for link in reached:
            reached += [joint.child for joint in self.below[link]]
        loop = links.keys() - set(reached)
        if loop:
            message = f"these links form a loop that the base does not reach: {', '.join(link for link in links if link in loop)}"
            raise SpecError(Problem("WG510", message, _ONE_TREE, self.urdf.place))
        return reached


def nearest(name: str, names: Iterable[str]) -> str:
    """The cure for a misspelt name: the known one most like it."""
    known = tuple(names)
    near = difflib.get_close_matches(name, known, 1, 0)
    return f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(known)}"


def _folded(joints: tuple[UrdfJoint, ...]) -> Pose:
    pose = IDENTITY
    for joint in joints:
        pose = compose(pose, joint.origin)
    return pose


def _repeated(items: tuple[UrdfLink, ...] | tuple[UrdfJoint, ...]) -> Iterable[Problem]:
    seen: set[str] = set()
    for item in items:
        if item.name in seen:
            yield Problem("WG510", f"the name {item.name!r} is given twice", "give every link and every joint its own name", item.place)
        seen.add(item.name)


def _dangling(urdf: Urdf, links: dict[str, UrdfLink]) -> Iterable[Problem]:
    parents = Counter(joint.child for joint in urdf.joints)
    for joint in urdf.joints:
        for link in (joint.parent, joint.child):
            if link not in links:
                message = f"joint {joint.name!r} names the link {link!r}, which is not there"
                yield Problem("WG510", message, nearest(link, links), joint.place)
        if parents[joint.child] > 1:
            message = f"link {joint.child!r} is the child of {parents[joint.child]} joints"
            yield Problem("WG510", message, "a URDF is a tree: open the loop at one joint", joint.place)

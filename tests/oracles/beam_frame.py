"""A robot with locked joints as a frame of Euler-Bernoulli beams: an own direct-stiffness finite-element model, read from a spec's text.

Every link with a section is one 12 by 12 element, platforms and links without one are rigid bodies (master and slaves), feet are pinned
or stand on springs. It shares nothing with walkgen: geometry comes from the oracle walker, forces from one linear system.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from oracles.walker import MIRROR, Array, WalkerLimb, X, read, rotation, translation

SCALE = 1e6


@dataclass(frozen=True)
class Segment:
    """A link: both ends and the far frame's z (its x where z runs along the link), in the root platform's frame; the section, or None."""

    a: Array
    b: Array
    z: Array
    section: Mapping[str, float] | None


def skew(v) -> Array:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def beam_axes(segment: Segment) -> Array:
    """Rows x, y, z of a link."""
    along = (segment.b - segment.a).astype(np.longdouble)
    x = along / np.linalg.norm(along)
    z = segment.z - (segment.z @ x) * x
    z = z / np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z])


def element(segment: Segment) -> Array:
    """The 12 by 12 stiffness in the root platform's axes: displacement and rotation of both ends."""
    s, L = segment.section, np.linalg.norm((segment.b - segment.a).astype(np.longdouble))
    E, G, A, Iy, Iz, J = (s[key] for key in ("E", "G", "A", "Iy", "Iz", "J"))
    K = np.zeros((12, 12), np.longdouble)
    for i, k in ((0, E * A / L), (3, G * J / L)):
        K[np.ix_([i, i + 6], [i, i + 6])] = k * np.array([[1, -1], [-1, 1]])
    bending = np.array(
        [
            [12, 6 * L, -12, 6 * L],
            [6 * L, 4 * L * L, -6 * L, 2 * L * L],
            [-12, -6 * L, 12, -6 * L],
            [6 * L, 2 * L * L, -6 * L, 4 * L * L],
        ]
    )
    K[np.ix_([1, 5, 7, 11], [1, 5, 7, 11])] = E * Iz / L**3 * bending
    flip = np.diag([1.0, -1.0, 1.0, -1.0])
    K[np.ix_([2, 4, 8, 10], [2, 4, 8, 10])] = E * Iy / L**3 * flip @ bending @ flip
    turn = np.kron(np.eye(4), beam_axes(segment))
    return turn.T @ K @ turn


def refined(system: Array, right: Array) -> Array:
    """The solution of a system of long doubles, by steps in doubles."""
    rough, found = system.astype(float), np.zeros(len(right), system.dtype)
    for _ in range(8):
        found = found + np.linalg.solve(rough, (right - system @ found).astype(float))
    return found


@dataclass
class Body:
    """What moves as one: where its six unknowns stand, and the point that they belong to."""

    start: int
    point: Array


@dataclass
class Frame:
    """`feet` hold the body of every point in contact (each foot, each corner of a sole), `platforms` each platform's."""

    count: int = 0
    elements: list[tuple[Body, Body, Segment]] = field(default_factory=list)
    platforms: dict[str, Body] = field(default_factory=dict)
    feet: list[Body] = field(default_factory=list)
    points: list[Array] = field(default_factory=list)

    def body(self, point) -> Body:
        self.count += 6
        return Body(self.count - 6, np.asarray(point, dtype=float))

    def grow(self, body: Body, segments: Sequence[Segment]) -> Body:
        for segment in segments:
            if segment.section is not None and np.linalg.norm(segment.b - segment.a) > 0.0:
                beyond = self.body(segment.b)
                self.elements.append((body, beyond, segment))
                body = beyond
        return body

    def at(self, body: Body, point) -> Array:
        """[6,count]: displacement and rotation of a point of a body."""
        T = np.zeros((6, self.count))
        T[:, body.start : body.start + 6] = np.eye(6)
        T[:3, body.start + 3 : body.start + 6] = -skew(np.asarray(point) - body.point)
        return T

    def stiffness(self) -> Array:
        K = np.zeros((self.count, self.count), np.longdouble)
        for near, far, segment in self.elements:
            T = np.vstack([self.at(near, segment.a), self.at(far, segment.b)])
            K += T.T @ element(segment) @ T
        return K

    def load(self, loads: Mapping[str, Sequence[float]]) -> Array:
        """Wrenches on platforms, moments about the root's origin."""
        return sum(
            (self.at(self.platforms[name], np.zeros(3)).T @ np.asarray(wrench) for name, wrench in loads.items()), np.zeros(self.count)
        )

    def forces(self, loads, springs=None, misfit=None) -> tuple[Array, Array]:
        """The ground's forces [F,3], and displacement and rotation of the root platform [6].

        Feet pinned, or on springs [F,3,3] (N/m); the misfit [F,3] is how far each foot would stand off its ground unloaded.
        """
        A = np.vstack([self.at(body, point)[:3] for body, point in zip(self.feet, self.points, strict=True)])
        off = -np.zeros(len(A)) if misfit is None else -np.ravel(misfit)
        give = np.zeros((len(A), len(A)))
        for foot, spring in enumerate(springs if springs is not None else ()):
            give[3 * foot : 3 * foot + 3, 3 * foot : 3 * foot + 3] = np.linalg.inv(spring)
        system = np.block([[self.stiffness(), -SCALE * A.T], [-SCALE * A, -(SCALE**2) * give]])
        right = np.concatenate([self.load(loads), -SCALE * off])
        found = refined(system, right)
        root = self.at(next(iter(self.platforms.values())), np.zeros(3))
        return (SCALE * found[self.count :]).astype(float).reshape(-1, 3), (root @ found[: self.count]).astype(float)

    def compliance(self) -> Array:
        """[3F,3F]: how far the feet move for unit forces on them while the root platform, the first six unknowns, is held."""
        A = np.vstack([self.at(body, point)[:3] for body, point in zip(self.feet, self.points, strict=True)])[:, 6:]
        K = self.stiffness()[6:, 6:]
        return (A @ np.stack([refined(K, force) for force in A.astype(np.longdouble)], axis=-1)).astype(float)


def segments(limb: WalkerLimb, rows, convention: str | None, q, base: Array, sections) -> list[Segment]:
    """Links of a limb on a platform: what follows a row's motion belongs to the link that the row's joint moves."""
    plain = WalkerLimb(limb.name, limb.platform, limb.mount, limb.joints, limb.tip, mirrored=False)
    poses, foot = plain.frames(q), plain.pose(q)
    stands = [pose @ _before(row, joint, convention) for row, joint, pose in zip(rows, limb.joints, poses[:-1], strict=True)]
    ends = [*stands[1:], foot]
    turn = base @ MIRROR if limb.mirrored else base
    found = []
    for row, near, far in zip(rows, stands, ends, strict=True):
        name = row.get("link", {}).get("section")
        a, b, (x, z) = (turn @ near[:, 3])[:3], (turn @ far[:, 3])[:3], (turn[:3, :3] @ far[:3, axis] for axis in (0, 2))
        along = np.linalg.norm(np.cross(z, b - a)) < 1e-12 * np.linalg.norm(b - a)
        found.append(Segment(a, b, x if along else z, sections[name] if name else None))
    return found


def _before(row, joint, convention) -> Array:
    """From the frame before to where the row's motion begins."""
    if "axis" in row:
        return joint.before
    if convention == "craig":
        return rotation(X, np.deg2rad(row.get("alpha_deg", 0.0))) @ translation((row.get("a", 0.0), 0, 0))
    return np.eye(4)


def frame(text: str, q) -> Frame:
    """The robot of a spec's text at joint values q [nq] (angles of rows in degrees, lengths in m)."""
    table, walker, q = tomllib.loads(text), read(text), np.asarray(q, dtype=float)
    found, sections = Frame(), table.get("sections", {})
    poses = dict(zip(walker.platforms, walker.platform_poses(q), strict=True))
    found.platforms[walker.platforms[0]] = found.body(np.zeros(3))
    for platform in table["platforms"][1:]:
        chain, design = walker.chains[platform["name"]], table["chain_designs"][platform["chain"]]
        ended = WalkerLimb(chain.name, chain.platform, chain.mount, chain.joints, np.eye(4), mirrored=False)
        links = segments(ended, design["joints"], design.get("dh"), q[walker.slice(chain.name)], poses[chain.platform], sections)
        found.platforms[chain.name] = found.grow(found.platforms[chain.platform], links)
    designs = {leg["name"]: leg.get("design") for leg in table["legs"]}
    designs |= {leg["name"]: designs[leg["mirror_of"]] for leg in table["legs"] if "mirror_of" in leg}
    for leg in walker.legs:
        design = table["leg_designs"][designs[leg.name]]
        links = segments(leg, design["joints"], design.get("dh"), q[walker.slice(leg.name)], poses[leg.platform], sections)
        foot, pose = found.grow(found.platforms[leg.platform], links), poses[leg.platform]
        points = leg.contacts(q[walker.slice(leg.name)]) @ pose[:3, :3].T + pose[:3, 3] if leg.sole is not None else [links[-1].b]
        for point in points:
            found.feet.append(foot)
            found.points.append(point)
    return found


def grasp(points) -> Array:
    """G [6,3k]: force and moment about the origin of forces on the points."""
    return np.hstack([np.vstack([np.eye(3), skew(point)]) for point in points])


def spread(points, C, wrench, misfit=None) -> tuple[Array, Array]:
    """f [k,3] and delta [6] of the compliance form, by one linear system: C f + e + G' delta = 0, G f + wrench = 0."""
    G, e = grasp(points), np.zeros(3 * len(points)) if misfit is None else np.ravel(misfit)
    scale = np.trace(C) / len(C)
    system = np.block([[C / scale, G.T], [G, np.zeros((6, 6))]])
    found = np.linalg.solve(system, np.concatenate([-e / scale, -np.asarray(wrench)]))
    return found[:-6].reshape(-1, 3), scale * found[-6:]

"""Whole robots as trees of joints, frame after frame in 4 x 4 matrices: what adaption is checked with, without a line of walkgen's."""

from dataclasses import dataclass, replace

import numpy as np

from oracles.walker import X, Z, rotation, translation

Array = np.ndarray
STEP = 1e-30


@dataclass(frozen=True)
class TreeJoint:
    """It moves about or along z of the frame `before` after its parent's frame; -1 is the root platform."""

    parent: int
    before: Array
    slides: bool = False


@dataclass(frozen=True)
class Robot:
    """Joints in the order of q; each foot and platform hangs on a joint's frame (-1: the root) by a constant pose; limits [nq, 2]."""

    joints: tuple[TreeJoint, ...]
    feet: tuple[tuple[int, Array], ...]
    platforms: tuple[tuple[int, Array], ...]
    limits: Array

    @property
    def counts(self) -> tuple[int, int, int]:
        return len(self.joints), len(self.feet), len(self.platforms)

    def frames(self, q) -> list[Array]:
        """Every joint's frame after its motion, the root's last [..., 4, 4]; rows of q, and complex ones too."""
        q = np.asarray(q)
        frames = [np.eye(4)] * (len(self.joints) + 1)
        for index, joint in enumerate(self.joints):
            frames[index] = frames[joint.parent] @ joint.before @ _motion(q[..., index], joint.slides)
        return frames

    def foot_positions(self, q) -> Array:
        """[..., k, 3]"""
        frames = self.frames(q)
        return np.stack([(frames[joint] @ pose)[..., :3, 3] for joint, pose in self.feet], axis=-2)

    def platform_poses(self, q) -> list[Array]:
        frames = self.frames(q)
        return [frames[joint] @ pose for joint, pose in self.platforms]

    def jacobian(self, q) -> Array:
        """Of all feet's coordinates [3 k, nq], by complex steps: exact to rounding."""
        return np.asarray(self.foot_positions(q + 1j * STEP * np.eye(len(q))).imag.reshape(len(q), -1).T / STEP)

    def least_singular_value(self, q) -> float:
        """Of all legs' Jacobians."""
        J = self.jacobian(q).reshape(-1, 3, len(q))
        return float(min(np.linalg.svd(J[foot][:, leg])[1][-1] for foot, leg in enumerate(self.legs)))

    @property
    def geometry(self) -> Array:
        """Axis and point of every joint, the feet, the platforms' rotations and origins, at q = 0."""
        zero = np.zeros(len(self.joints))
        axes = [frame[:3, 2:].T.ravel() for frame in self.frames(zero)[:-1]]
        platforms = [np.concatenate([pose[:3, :3].ravel(), pose[:3, 3]]) for pose in self.platform_poses(zero)]
        return np.concatenate([*axes, self.foot_positions(zero).ravel(), *platforms])

    @property
    def topology(self) -> Array:
        parents, kinds = [joint.parent for joint in self.joints], [int(joint.slides) for joint in self.joints]
        return np.array([*parents, *kinds, *(joint for joint, _ in self.feet), *(joint for joint, _ in self.platforms)], np.int32)

    @property
    def data(self) -> tuple[Array, Array, Array]:
        """What every routine takes first."""
        return self.geometry, self.topology, self.limits

    @property
    def middle(self) -> Array:
        return self.limits.mean(axis=-1)

    @property
    def half(self) -> Array:
        return 0.5 * (self.limits[:, 1] - self.limits[:, 0])

    @property
    def legs(self) -> Array:
        """Every foot's last three joints [k, 3]."""
        last = np.array([joint for joint, _ in self.feet], int)
        return last[:, None] - [2, 1, 0]

    @property
    def chains(self) -> Array:
        """All other joints."""
        return np.setdiff1d(np.arange(len(self.joints)), self.legs)

    def home(self, foot: int) -> int:
        """The platform that the foot's leg hangs on."""
        return [joint for joint, _ in self.platforms].index(self.joints[self.legs[foot][0]].parent)

    def limited(self, joints, lower, upper) -> "Robot":
        """With other limits of some joints."""
        limits = self.limits.copy()
        limits[joints] = np.stack(np.broadcast_arrays(lower, upper), axis=-1)
        return replace(self, limits=limits)


def _motion(q: Array, slides: bool) -> Array:
    """Along or about z [..., 4, 4]."""
    motion = np.zeros((*q.shape, 4, 4), q.dtype) + np.eye(4)
    if slides:
        motion[..., 2, 3] = q
    else:
        motion[..., 0, 0] = motion[..., 1, 1] = np.cos(q)
        motion[..., 1, 0] = np.sin(q)
        motion[..., 0, 1] = -motion[..., 1, 0]
    return motion


@dataclass(frozen=True)
class Ground:
    """A robot's task: the criterion of theory note 1, section 3.3, on targets [k, 3] and unit normals [m, 3]; weights as `adapt` takes."""

    robot: Robot
    targets: Array
    normals: Array
    weights: Array

    def phi(self, q):
        """Rows of q, and complex ones too. Joints without two limits apart do not count."""
        robot, (limit, level, height, wanted) = self.robot, self.weights
        counted = np.isfinite(robot.limits).all(axis=-1) & (robot.limits[:, 0] < robot.limits[:, 1])
        total = limit * np.sum(((q - robot.middle)[..., counted] / robot.half[counted]) ** 2, axis=-1)
        poses, homes = robot.platform_poses(q), np.array([robot.home(foot) for foot in range(len(robot.feet))])
        for m in range(1, len(robot.platforms)):
            total += level * (1.0 - poses[m][..., :3, 2] @ self.normals[m])
            if (homes == m).any():
                total += height * ((poses[m][..., :3, 3] - self.targets[homes == m].mean(axis=0)) @ self.normals[m] - wanted) ** 2
        return total

    def followed(self, c, q) -> Array | None:
        """Chain joints at c, legs by Newton from q; None where they do not arrive."""
        q, legs = q.copy(), self.robot.legs.ravel()
        q[self.robot.chains] = c
        for _ in range(30):
            gap = (self.robot.foot_positions(q) - self.targets).ravel()
            if np.max(np.abs(gap), initial=0.0) <= 1e-14:
                break
            q[legs] -= np.linalg.solve(self.robot.jacobian(q)[:, legs], gap)
        return q if np.max(np.abs(gap), initial=0.0) <= 1e-12 else None

    def gradient(self, q) -> Array:
        """Of Phi by the chain joints, legs following: N^T dPhi/dq, all by complex steps [nc]."""
        chains, legs, J = self.robot.chains, self.robot.legs.ravel(), self.robot.jacobian(q)
        slope = self.phi(q + 1j * STEP * np.eye(len(q))).imag / STEP
        return slope[chains] - np.linalg.solve(J[:, legs], J[:, chains]).T @ slope[legs]

    def pushed(self, q) -> Array:
        """What is left of the gradient by the chain joints that their limits do not hold [nc]."""
        gradient, (lower, upper) = self.gradient(q), self.robot.limits[self.robot.chains].T
        c = q[self.robot.chains]
        return np.where(((c <= lower) & (gradient > 0.0)) | ((c >= upper) & (gradient < 0.0)) | (lower == upper), 0.0, gradient)


def unit(vectors) -> Array:
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def row(theta: float, s: float, a: float, alpha: float) -> Array:
    """A row of theory note 1, the chapter's A at q = 0."""
    return rotation(Z, theta) @ translation((a, 0.0, s)) @ rotation(X, alpha)


def _hang(joints: list[TreeJoint], parent: int, before: Array, rows: list[Array], kinds: str) -> tuple[int, Array]:
    """Append a chain of rows: its last joint, and the pose that remains after it."""
    for kind, item in zip(kinds, rows, strict=True):
        joints.append(TreeJoint(parent, before, kind == "P"))
        parent, before = len(joints) - 1, item
    return parent, before


def _side(side: float) -> Array:
    return translation((0.0, 0.20 * side, 0.0)) @ rotation(Z, side * np.pi / 2)


def chapter_module() -> Robot:
    """Section 2.3 (e): a root platform without legs, a chain, one child module with two legs (0, .35, .40, 0); limits of note 3.3."""
    joints: list[TreeJoint] = []
    root = translation((-0.30, 0.0, 0.0)) @ rotation(Z, np.pi)
    rows = [row(0.0, 0.0, 0.10, np.pi / 2), row(np.pi / 2, 0.0, 0.0, np.pi / 2), row(0.0, 0.25, 0.0, 0.0)]
    last, after = _hang(joints, -1, root, rows, "RRR")
    end = np.eye(4)
    end[:3, :3] = (root @ rows[0] @ rows[1] @ rows[2])[:3, :3].T
    child = after @ end @ translation((-0.30, 0.0, 0.0))
    links = [row(0.0, 0.0, 0.0, np.pi / 2), row(0.0, 0.0, 0.35, 0.0), row(0.0, 0.0, 0.40, 0.0)]
    feet = tuple(_hang(joints, last, child @ _side(side), links, "RRR") for side in (1.0, -1.0))
    middle, half = np.array([0, 0, 0, *(0, 0.5, -1.6) * 2]), np.array([0.5, 0.5, 0.5, *(0.7, 0.9, 0.9) * 2])
    return Robot(tuple(joints), feet, ((-1, np.eye(4)), (last, child)), np.stack([middle - half, middle + half], axis=-1))


def random_robot(rng, modules: int, serial: bool, legs_on_root: bool = True) -> Robot:
    """Platforms one behind the other or all on the first, with chains of 1 to 4 joints and two legs each; some joints slide."""
    joints: list[TreeJoint] = []
    platforms, feet = [(-1, np.eye(4))], []
    for m in range(1, modules):
        platforms.append(_module(rng, joints, *platforms[m - 1 if serial else 0], turn=np.pi if serial else 2.0 * np.pi * m / modules))
    for parent, pose in platforms[0 if legs_on_root else 1 :]:
        feet += [_leg(rng, joints, parent, pose @ _side(side)) for side in (1.0, -1.0)]
    leg = {joint - i for joint, _ in feet for i in range(3)}
    posture = np.array([rng.uniform(-0.2, 0.2) if j not in leg else rng.uniform(-0.1, 0.1) for j in range(len(joints))])
    half = np.array([0.2 if joint.slides else rng.uniform(0.5, 1.0) for joint in joints])
    return Robot(tuple(joints), tuple(feet), tuple(platforms), np.stack([posture - half, posture + half], axis=-1))


def random_ground(seed: int, serial: bool, modules: int = 0) -> tuple[Ground, Array]:
    """A robot, by default of two modules or of three in a row, on targets of a posture in which no leg is near a singular one."""
    rng = np.random.default_rng(seed)
    while True:
        robot = random_robot(rng, modules or (3 if serial else 2), serial, legs_on_root=not serial)
        q = robot.middle + 0.4 * robot.half * rng.uniform(-1.0, 1.0, len(robot.joints))
        if robot.least_singular_value(q) > 0.08:
            break
    normals = unit(rng.uniform(-0.2, 0.2, (len(robot.platforms), 3)) + np.array([0.0, 0.0, 1.0]))
    return Ground(robot, robot.foot_positions(q), normals, np.array([1.0, 4.0, 20.0, 0.30])), q


def _module(rng, joints: list[TreeJoint], parent: int, pose: Array, turn: float) -> tuple[int, Array]:
    kinds = str(rng.choice(("RRR", "RPR", "RR", "PRR", "R", "RRPR")))
    before = pose @ rotation(Z, turn) @ translation((0.3, 0.0, 0.0)) @ rotation(X, rng.uniform(-0.3, 0.3))
    rows = [row(0.0, rng.uniform(-0.05, 0.05), rng.uniform(0.05, 0.25), rng.choice([np.pi / 2, -np.pi / 2, 0.4])) for _ in kinds]
    last, after = _hang(joints, parent, before, rows, kinds)
    level = np.eye(4)
    level[:3, :3] = np.linalg.multi_dot([before, *rows, np.eye(4)])[:3, :3].T
    return last, after @ level @ translation((0.2 * np.cos(turn), 0.2 * np.sin(turn), 0.0))


def _leg(rng, joints: list[TreeJoint], parent: int, mount: Array) -> tuple[int, Array]:
    """A hip and two links that stand bent at q = 0; a joint that slides leaves its bend as it is."""
    kinds = str(rng.choice(("RRR", "RRR", "RRP", "RPR", "PRR", "RPP")))
    bends = (rng.uniform(-0.3, 0.3), rng.uniform(0.4, 0.7), rng.uniform(-1.8, -1.3))
    twists = (np.pi / 2 + rng.uniform(-0.1, 0.1), np.pi / 2 if kinds[2] == "P" else rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1))
    rows = [row(bend, rng.uniform(-0.05, 0.05), a, twist) for bend, a, twist in zip(bends, (0.05, 0.35, 0.40), twists, strict=True)]
    return _hang(joints, parent, mount @ rotation(X, rng.uniform(-0.1, 0.1)), rows, kinds)

"""Forward kinematics straight from the text of a spec, in plain NumPy: an oracle that shares no line with walkgen.

Works on complex numbers too, so that derivatives are complex steps: exact to rounding, and without differences of nearby poses.
"""

import ast
import math
import operator
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

Array = np.ndarray
MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
STEP = 1e-30


def translation(xyz: Sequence[complex]) -> Array:
    T = np.eye(4, dtype=np.result_type(*(np.asarray(x) for x in xyz), float))
    T[:3, 3] = xyz
    return T


def rotation(axis: Sequence[float], angle: complex) -> Array:
    """Rodrigues' formula about a unit axis."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4, dtype=np.result_type(np.asarray(angle), float))
    T[:3, :3] = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * (K @ K)
    return T


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def rpy_pose(xyz: Sequence[complex], rpy: Sequence[complex]) -> Array:
    return translation(xyz) @ rotation(Z, rpy[2]) @ rotation(Y, rpy[1]) @ rotation(X, rpy[0])


@dataclass(frozen=True)
class WalkerJoint:
    revolute: bool
    before: Array
    axis: tuple[float, float, float]
    after: Array
    sign: float
    zero: float

    def transform(self, q: complex) -> Array:
        amount = self.sign * q + self.zero
        motion = rotation(self.axis, amount) if self.revolute else translation(np.asarray(self.axis) * amount)
        return self.before @ motion @ self.after


@dataclass(frozen=True)
class WalkerLimb:
    """`sole` has the corners in the foot frame as homogeneous columns [4,4], once round, and `normal` points away from the ground."""

    name: str
    platform: str
    mount: Array
    joints: tuple[WalkerJoint, ...]
    tip: Array
    mirrored: bool
    sole: Array | None = None
    normal: Array | None = None

    def frames(self, q: Sequence[complex]) -> Array:
        """joint_frames [n+1,4,4] in the platform's frame."""
        poses = [self.mount]
        for joint, value in zip(self.joints, q, strict=True):
            poses.append(poses[-1] @ joint.transform(value))
        stack = np.stack([pose.astype(np.result_type(*poses)) for pose in poses])
        return MIRROR @ stack @ MIRROR if self.mirrored else stack

    def pose(self, q: Sequence[complex]) -> Array:
        """Foot frame (or child platform) in the platform's frame, [4,4]."""
        tip = MIRROR @ self.tip @ MIRROR if self.mirrored else self.tip
        return self.frames(q)[-1] @ tip

    def contacts(self, q: Sequence[complex]) -> Array:
        """The corners of the sole, or the foot [k,3]; those of a mirrored leg go round the other way, beginning at the same end."""
        pose, flip = self.described(q)
        if self.sole is None:
            return (flip @ pose)[None, :3, 3]
        corners = (flip @ pose @ self.sole)[:3].T
        return corners[::-1] if self.mirrored else corners

    def sole_normal(self, q: Sequence[complex]) -> Array:
        pose, flip = self.described(q)
        return (flip @ pose @ np.append(self.normal, 0.0))[:3]

    def described(self, q: Sequence[complex]) -> tuple[Array, Array]:
        """The foot frame of the leg as its design describes it, and the reflection that makes the leg of it."""
        plain = replace(self, mirrored=False)
        return plain.frames(q)[-1] @ self.tip, MIRROR if self.mirrored else np.eye(4)

    def position(self, q: Sequence[complex]) -> Array:
        return self.pose(q)[:3, 3]

    def jacobian(self, q: Array) -> Array:
        """[3,n], complex steps of the position."""
        return derivative(self.position, q)

    def spatial_jacobian(self, q: Array) -> Array:
        """[6,n]: linear, angular; the angular rows from the skew part of dR R^T."""

        def columns(value: Array) -> Array:
            return self.pose(value)[:3]

        dT = derivative(columns, q)
        spin = np.einsum("abi,cb->aci", dT[:, :3], self.pose(q)[:3, :3])
        return np.vstack([dT[:, 3], spin[2, 1], spin[0, 2], spin[1, 0]])

    def hessian(self, q: Array) -> Array:
        """[3,n,n], complex steps of the Jacobian written with cross products (itself tested against `jacobian`)."""
        return derivative(self.cross_jacobian, q)[:3]

    def cross_jacobian(self, q: Array) -> Array:
        """[6,n] by z x (p - o) and z: the axis of joint i sits between its `before` and `after`."""
        foot, columns = self.pose(q)[:3, 3], []
        pose = self.mount
        flip = MIRROR if self.mirrored else np.eye(4)
        for joint, value in zip(self.joints, q, strict=True):
            axis = flip @ pose @ joint.before
            unit = np.asarray(joint.axis, dtype=float) / np.linalg.norm(joint.axis)
            z = joint.sign * axis[:3, :3] @ unit
            if joint.revolute:
                z = -z if self.mirrored else z
                columns.append(np.concatenate([np.cross(z, foot - axis[:3, 3]), z]))
            else:
                columns.append(np.concatenate([z, 0 * z]))
            pose = pose @ joint.transform(value)
        return np.stack(columns, axis=1)

    def bias_acceleration(self, q: Array, qd: Array) -> Array:
        """dJ/dt qd [6]: linear, angular."""
        return np.einsum("aij,i,j->a", derivative(self.cross_jacobian, q), qd, qd)


def derivative(function: Callable[[Array], Array], q: Array) -> Array:
    """Real derivative with a last axis for the component of q, by complex steps."""
    steps = np.eye(len(q)) * 1j * STEP
    return np.stack([function(q + step).imag / STEP for step in steps], axis=-1)


@dataclass(frozen=True)
class Walker:
    """The robot as a spec's text describes it: order of q is chains, then legs, in file order."""

    platforms: tuple[str, ...]
    chains: Mapping[str, WalkerLimb]
    legs: tuple[WalkerLimb, ...]

    @property
    def joint_count(self) -> int:
        return sum(len(limb.joints) for limb in (*self.chains.values(), *self.legs))

    def leg(self, name: str) -> WalkerLimb:
        return next(leg for leg in self.legs if leg.name == name)

    def slice(self, name: str) -> slice:
        """Where the chain's (by its child platform) or the leg's joints stand in q."""
        start = 0
        for key, limb in (*self.chains.items(), *((leg.name, leg) for leg in self.legs)):
            if key == name:
                return slice(start, start + len(limb.joints))
            start += len(limb.joints)
        raise KeyError(name)

    def platform_pose(self, name: str, q: Array) -> Array:
        if name not in self.chains:
            return np.eye(4)
        chain = self.chains[name]
        return self.platform_pose(chain.platform, q) @ chain.pose(q[self.slice(name)])

    def platform_poses(self, q: Array) -> Array:
        poses = [self.platform_pose(name, q) for name in self.platforms]
        return np.stack(poses)

    def foot_pose(self, leg: WalkerLimb, q: Array) -> Array:
        """In the root platform's frame."""
        return self.platform_pose(leg.platform, q) @ leg.pose(q[self.slice(leg.name)])

    def foot_positions(self, q: Array) -> Array:
        return np.stack([self.foot_pose(leg, q)[:3, 3] for leg in self.legs])

    def contact_points(self, q: Array) -> Array:
        """[k,3]"""
        poses = [self.platform_pose(leg.platform, q) for leg in self.legs]
        points = [leg.contacts(q[self.slice(leg.name)]) @ pose[:3, :3].T + pose[:3, 3] for leg, pose in zip(self.legs, poses, strict=True)]
        return np.concatenate(points)

    def foot_jacobians(self, q: Array) -> Array:
        """[feet,3,nq]"""
        return derivative(self.foot_positions, q)

    def route(self, name: str) -> tuple[int, ...]:
        """Indices into q of the joints from the root platform to the leg's foot."""
        here, indices = self.leg(name).platform, list(range(*self.slice(name).indices(self.joint_count)))
        while here in self.chains:
            indices = [*range(*self.slice(here).indices(self.joint_count)), *indices]
            here = self.chains[here].platform
        return tuple(indices)


# ---- reading -----------------------------------------------------------------------------------------------------------------


def read(text: str, **parameters: float) -> Walker:
    """The robot of a spec's text; keywords replace the values of its parameters."""
    return Reader(tomllib.loads(text), parameters).walker()


@dataclass(frozen=True)
class Reader:
    table: dict[str, Any]
    overrides: Mapping[str, float]

    def walker(self) -> Walker:
        platforms = self.table["platforms"]
        legs = {leg["name"]: leg for leg in self.table["legs"]}
        return Walker(
            tuple(platform["name"] for platform in platforms),
            {platform["name"]: self.chain(platform) for platform in platforms if "parent" in platform},
            tuple(self.leg(leg, legs) for leg in legs.values()),
        )

    def leg(self, leg: dict[str, Any], legs: Mapping[str, dict[str, Any]]) -> WalkerLimb:
        if "mirror_of" in leg:
            original = self.leg(legs[leg["mirror_of"]], legs)
            return replace(original, name=leg["name"], mirrored=not original.mirrored)
        design = self.table["leg_designs"][leg["design"]]
        own_zeros = "zeros" in leg or "zeros_deg" in leg
        inherited = ("signs",) if own_zeros else ("signs", "zeros", "zeros_deg")
        signed = {**{key: design[key] for key in inherited if key in design}, **leg}
        mount, tip = self.pose(leg.get("mount")), self.pose(design.get("foot"))
        sole = self.sole(leg.get("sole", design.get("sole")))
        return WalkerLimb(leg["name"], leg["platform"], mount, self.joints(design, signed), tip, mirrored=False, **sole)

    def sole(self, table: dict[str, Any] | None) -> dict[str, Array]:
        if table is None:
            return {}
        turn, half = self.pose(table), [self.scalar(table, key) / 2 for key in ("length", "width")]
        corners = [[x * half[0], y * half[1], 0.0, 1.0] for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        return {"sole": turn @ np.transpose(corners), "normal": turn[:3, 2]}

    def chain(self, platform: dict[str, Any]) -> WalkerLimb:
        design = self.table["chain_designs"][platform["chain"]]
        root, joints = self.pose(platform.get("root")), self.joints(design, design)
        end = platform["end"]
        if end == "level":
            straight = root
            for joint in joints:
                straight = straight @ joint.transform(0.0)
            back = np.eye(4)
            back[:3, :3] = straight[:3, :3].T
            tip = back @ translation(self.vector(platform, "end_xyz"))
        else:
            tip = self.pose(end)
        return WalkerLimb(platform["name"], platform["parent"], root, joints, tip, mirrored=False)

    def joints(self, design: dict[str, Any], signed: dict[str, Any]) -> tuple[WalkerJoint, ...]:
        rows = design["joints"]
        signs = signed.get("signs", [1] * len(rows))
        zeros = self.vector(signed, "zeros", len(rows))
        return tuple(self.joint(design.get("dh"), row, sign, zero) for row, sign, zero in zip(rows, signs, zeros, strict=True))

    def joint(self, convention: str | None, row: dict[str, Any], sign: float, zero: float) -> WalkerJoint:
        revolute = row["type"] == "revolute"
        if "axis" in row:
            axis = tuple(self.number(x) for x in row["axis"])
            return WalkerJoint(revolute, self.pose(row), axis, np.eye(4), sign, zero)
        a, d = self.scalar(row, "a"), self.scalar(row, "d")
        screw = rotation(Z, self.scalar(row, "theta")) @ translation((0, 0, d))
        twist = rotation(X, self.scalar(row, "alpha")) @ translation((a, 0, 0))
        if convention == "craig":
            return WalkerJoint(revolute, twist @ screw, Z, np.eye(4), sign, zero)
        assert convention == "classic"
        return WalkerJoint(revolute, screw, Z, twist, sign, zero)

    def pose(self, table: dict[str, Any] | None) -> Array:
        return rpy_pose(self.vector(table or {}, "xyz"), self.vector(table or {}, "rpy"))

    def vector(self, table: dict[str, Any], key: str, size: int = 3) -> tuple[float, ...]:
        for suffix, unit in (("", 1.0), ("_deg", math.pi / 180), ("_mm", 0.001)):
            if key + suffix in table:
                return tuple(self.number(value) * unit for value in table[key + suffix])
        return (0.0,) * size

    def scalar(self, table: dict[str, Any], key: str) -> float:
        for suffix, unit in (("", 1.0), ("_deg", math.pi / 180), ("_mm", 0.001)):
            if key + suffix in table:
                return self.number(table[key + suffix]) * unit
        return 0.0

    def number(self, value: float | str) -> float:
        return self.expression(ast.parse(value, mode="eval").body) if isinstance(value, str) else float(value)

    def expression(self, node: ast.expr) -> float:
        if isinstance(node, ast.Constant):
            return float(node.value)
        if isinstance(node, ast.Name):
            return math.pi if node.id == "pi" else self.parameter(node.id)
        if isinstance(node, ast.UnaryOp):
            return -self.expression(node.operand)
        if isinstance(node, ast.Call):
            return getattr(math, node.func.id)(*map(self.expression, node.args))
        operators = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}
        return operators[type(node.op)](self.expression(node.left), self.expression(node.right))

    def parameter(self, name: str) -> float:
        if name in self.overrides:
            return self.overrides[name]
        value = self.table["parameters"][name]
        return self.number(value["value"] if isinstance(value, dict) else value)

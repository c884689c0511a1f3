"""A Mechanism walked in doubles with SciPy's rotations, and specs to assemble: nothing here calls walkgen.model.walk."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Joint, Limb, Mechanism, Transform
from walkgen.spec.read import read
from walkgen.spec.scalar import Apply, Exact, Name, Scalar

MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
OPERATIONS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "pow": lambda a, b: a**b,
    **{name: getattr(math, name) for name in ("sqrt", "sin", "cos", "tan", "atan2", "hypot")},
}


def assembled(folder: Path, text: str) -> Mechanism:
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return assemble(read(path))


def robot(joints: str, design: str = 'dh = "classic"', legs: str = "", head: str = "", platforms: str = "") -> str:
    """Spec text of a robot with one design, a leg on its body and whatever else is given."""
    return f"""walkgen = 1
[robot]
name = "robot"
gravity = [0, 0, -9.81]
{head}
[leg_designs.design]
{design}
joints = [
{joints}
]
[[platforms]]
name = "body"
{platforms}
[[legs]]
name = "leg"
design = "design"
platform = "body"
{legs}
"""


def number(scalar: Scalar, values: Mapping[str, float]) -> float:
    if isinstance(scalar, Exact):
        return float(scalar.value)
    if isinstance(scalar, Name):
        return values[scalar.name]
    if isinstance(scalar, Apply):
        return OPERATIONS[scalar.function](*(number(argument, values) for argument in scalar.arguments))
    return math.pi


def pose(rotation: Rotation, shift: Sequence[float] = (0, 0, 0)) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation.as_matrix(), shift
    return T


def elementary(kind: str, axis: int, amount: float) -> np.ndarray:
    unit = np.eye(3)[axis]
    return pose(Rotation.from_rotvec(amount * unit)) if kind == "rotate" else pose(Rotation.identity(), amount * unit)


def product(transform: Transform, values: Mapping[str, float]) -> np.ndarray:
    T = np.eye(4)
    for motion in transform:
        T = T @ elementary(motion.kind, motion.axis, number(motion.amount, values))
    return T


def through(joint: Joint, q: float, values: Mapping[str, float]) -> np.ndarray:
    amount = joint.sign * q + number(joint.zero, values)
    moved = elementary("rotate" if joint.kind == "revolute" else "translate", 2, amount)
    return product(joint.before, values) @ moved @ product(joint.after, values)


def frames(limb: Limb, q: Sequence[float], values: Mapping[str, float] | None = None) -> list[np.ndarray]:
    """Mount, the frame that moves with each joint, the tip."""
    values = values or {}
    poses = [product(limb.mount, values)]
    for joint, value in zip(limb.joints, q, strict=True):
        poses.append(poses[-1] @ through(joint, value, values))
    return [*poses, poses[-1] @ product(limb.tip, values)]


def rpy(xyz: Sequence[float], angles: Sequence[float]) -> np.ndarray:
    """SciPy's extrinsic x-y-z is Rz(yaw) Ry(pitch) Rx(roll)."""
    return pose(Rotation.from_euler("xyz", angles), xyz)


def close(found: Any, expected: Any, tolerance: float = 1e-14) -> bool:
    return bool(np.max(np.abs(np.asarray(found, dtype=float) - np.asarray(expected, dtype=float))) <= tolerance)

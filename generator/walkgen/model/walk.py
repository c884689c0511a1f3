"""A 50-digit matrix walk over the Mechanism: the reference that shares nothing with the generated programs."""

from collections.abc import Mapping, Sequence
from typing import Any

from mpmath.ctx_mp import MPContext

from walkgen.model.mechanism import Joint, Limb, Mechanism, Motion, Transform
from walkgen.spec.scalar import Scalar, evaluate

CONTEXT = MPContext()
CONTEXT.dps = 50

Matrix = Any
"""An mpmath matrix; 4x4 homogeneous, the 1 last."""


def defaults(mechanism: Mechanism) -> dict[str, Any]:
    """The runtime parameters' default values by name."""
    values: dict[str, Any] = {}
    for parameter in mechanism.parameters:
        values[parameter.name] = evaluate(parameter.default, CONTEXT, values)
    return values


def number(scalar: Scalar, mechanism: Mechanism) -> Any:
    """The scalar at the default parameters."""
    return evaluate(scalar, CONTEXT, defaults(mechanism))


def motion_matrix(kind: str, axis: int, amount: Any) -> Matrix:
    """Homogeneous matrix of one elementary motion."""
    matrix = CONTEXT.eye(4)
    if kind == "translate":
        matrix[axis, 3] = amount
        return matrix
    cosine, sine = CONTEXT.cos(amount), CONTEXT.sin(amount)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix[first, first] = matrix[second, second] = cosine
    matrix[second, first], matrix[first, second] = sine, -sine
    return matrix


def matrix_of(transform: Transform, values: Mapping[str, Any]) -> Matrix:
    """Product of the transform's motions, left to right."""
    product = CONTEXT.eye(4)
    for motion in transform:
        product = product * _motion(motion, values)
    return product


def _motion(motion: Motion, values: Mapping[str, Any]) -> Matrix:
    return motion_matrix(motion.kind, motion.axis, evaluate(motion.amount, CONTEXT, values))


def joint_matrix(joint: Joint, q: Any, values: Mapping[str, Any]) -> Matrix:
    """From the frame before the joint to the frame that moves with it."""
    amount = joint.sign * CONTEXT.mpf(q) + evaluate(joint.zero, CONTEXT, values)
    kind = "rotate" if joint.kind == "revolute" else "translate"
    return matrix_of(joint.before, values) * motion_matrix(kind, 2, amount) * matrix_of(joint.after, values)


def limb_frames(mechanism: Mechanism, limb: Limb, q: Sequence[Any], values: Mapping[str, Any] | None = None) -> list[Matrix]:
    """Mount, then the frame that moves with each joint, then the tip; in the limb's own platform's frame.

    Args:
        mechanism: the robot, for its parameters.
        limb: a leg or a connecting chain.
        q: joint values [n], rad or m.
        values: runtime parameters by name; the defaults where not given.
    """
    values = defaults(mechanism) if values is None else values
    frames = [matrix_of(limb.mount, values)]
    for joint, value in zip(limb.joints, q, strict=True):
        frames.append(frames[-1] * joint_matrix(joint, value, values))
    return [*frames, frames[-1] * matrix_of(limb.tip, values)]


def joint_axis(mechanism: Mechanism, limb: Limb, index: int, values: Mapping[str, Any]) -> Matrix:
    """Direction of a joint's axis at q = 0, positive for growing q, in the limb's platform's frame (3x1)."""
    frames = limb_frames(mechanism, limb, [0] * len(limb.joints), values)
    joint = limb.joints[index]
    frame = frames[index] * matrix_of(joint.before, values)
    return frame[:3, 2] * joint.sign


def platform_poses(mechanism: Mechanism, q: Sequence[Any]) -> list[Matrix]:
    """Pose of every platform in the first platform's frame, for the robot's q [nq]."""
    poses: list[Matrix] = [CONTEXT.eye(4)] * len(mechanism.platforms)
    for index in range(len(mechanism.platforms)):
        for chain in mechanism.ancestors(index):
            start = mechanism.offset(chain)
            values = q[start : start + len(chain.joints)]
            poses[chain.child or 0] = poses[chain.platform] * limb_frames(mechanism, chain, values)[-1]
    return poses

"""A 50-digit matrix walk over the Mechanism: the reference that shares nothing with the generated programs."""

from collections.abc import Mapping, Sequence
from typing import Any

from mpmath.ctx_mp import MPContext

from walkgen.model.mechanism import Joint, Limb, Mechanism, Transform
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


def moved(frame: Matrix, kind: str, axis: int, amount: Any) -> Matrix:
    """The frame times one elementary motion: two columns turn, or the last one shifts."""
    frame = frame.copy()
    if kind == "translate":
        for row in range(3):
            frame[row, 3] += frame[row, axis] * amount
        return frame
    cosine, sine = CONTEXT.cos_sin(amount)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    for row in range(3):
        a, b = frame[row, first], frame[row, second]
        frame[row, first], frame[row, second] = cosine * a + sine * b, cosine * b - sine * a
    return frame


def along(frame: Matrix, transform: Transform, values: Mapping[str, Any]) -> Matrix:
    """The frame times the transform's motions, left to right."""
    for motion in transform:
        frame = moved(frame, motion.kind, motion.axis, evaluate(motion.amount, CONTEXT, values))
    return frame


def limb_frames(
    mechanism: Mechanism, limb: Limb, q: Sequence[Any], values: Mapping[str, Any] | None = None, base: Matrix | None = None
) -> list[Matrix]:
    """Mount, then the frame that moves with each joint, then the tip; in the limb's own platform's frame.

    Args:
        mechanism: the robot, for its parameters.
        limb: a leg or a connecting chain.
        q: joint values [n], rad or m.
        values: runtime parameters by name; the defaults where not given.
        base: the platform's pose in another frame, for the result in that frame.
    """
    values = defaults(mechanism) if values is None else values
    frames = [along(CONTEXT.eye(4) if base is None else base, limb.mount, values)]
    for joint, value in zip(limb.joints, q, strict=True):
        frames.append(_past(joint, value, frames[-1], values))
    return [*frames, along(frames[-1], limb.tip, values)]


def _past(joint: Joint, q: Any, frame: Matrix, values: Mapping[str, Any]) -> Matrix:
    """From the frame before the joint to the frame that moves with it."""
    amount = joint.sign * CONTEXT.mpf(q) + evaluate(joint.zero, CONTEXT, values)
    kind = "rotate" if joint.kind == "revolute" else "translate"
    return along(moved(along(frame, joint.before, values), kind, 2, amount), joint.after, values)


def joint_axis(mechanism: Mechanism, limb: Limb, index: int, values: Mapping[str, Any]) -> Matrix:
    """Direction of a joint's axis at q = 0, positive for growing q, in the limb's platform's frame (3x1)."""
    frames = limb_frames(mechanism, limb, [0] * len(limb.joints), values)
    joint = limb.joints[index]
    return along(frames[index], joint.before, values)[:3, 2] * joint.sign


def platform_poses(mechanism: Mechanism, q: Sequence[Any]) -> list[Matrix]:
    """Pose of every platform in the first platform's frame, for the robot's q [nq]."""
    poses: list[Matrix] = [CONTEXT.eye(4)] * len(mechanism.platforms)
    for index in range(len(mechanism.platforms)):
        for chain in mechanism.ancestors(index):
            start = mechanism.offset(chain)
            values = q[start : start + len(chain.joints)]
            poses[chain.child or 0] = limb_frames(mechanism, chain, values, base=poses[chain.platform])[-1]
    return poses

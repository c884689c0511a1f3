"""Constant frames as elementary motions: built from DH rows, origins and axes, inverted, reflected, all exact."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Literal

from walkgen.model.mechanism import Motion, Transform
from walkgen.spec.scalar import Exact, Pi, Scalar, Vector, add, apply, is_zero, mul, names, neg, sub

X, Y, Z = 0, 1, 2
QUARTER_TURN = mul(Exact(Fraction(1, 2)), Pi())
HALF_TURN = Pi()
_NEGLIGIBLE = 1e-40


def rotation(axis: int, angle: Scalar) -> Transform:
    """Rotation about a coordinate axis; empty for angle 0."""
    return () if is_zero(angle) else (Motion("rotate", axis, angle),)


def translation(axis: int, distance: Scalar) -> Transform:
    """Translation along a coordinate axis; empty for distance 0."""
    return () if is_zero(distance) else (Motion("translate", axis, distance),)


def origin(xyz: Vector, rpy: Vector) -> Transform:
    """Translation xyz, then Rz(yaw) Ry(pitch) Rx(roll): a frame in its parent, as URDF writes it."""
    shift = sum((translation(axis, xyz[axis]) for axis in (X, Y, Z)), ())
    return shift + sum((rotation(axis, rpy[axis]) for axis in (Z, Y, X)), ())


def align(axis: Vector, size: Callable[[Scalar], float]) -> tuple[Transform, Literal[1, -1]]:
    """A rotation that carries z onto the axis, up to the returned sign (negative coordinate axes keep their zeros that way).

    Args:
        axis: a direction of any length.
        size: the value of a scalar; a constant that comes to 0, such as sin(0), is 0 here.
    """
    nonzero = [index for index in (X, Y, Z) if names(axis[index]) or abs(size(axis[index])) > _NEGLIGIBLE]
    if len(nonzero) == 1:
        turn = {X: rotation(Y, QUARTER_TURN), Y: rotation(X, neg(QUARTER_TURN)), Z: ()}[nonzero[0]]
        return turn, 1 if size(axis[nonzero[0]]) > 0 else -1
    azimuth = apply("atan2", axis[Y], axis[X])
    polar = apply("atan2", apply("hypot", axis[X], axis[Y]), axis[Z])
    return rotation(Z, azimuth) + rotation(Y, polar), 1


def inverse(transform: Transform) -> Transform:
    """The inverse motion: reversed order, opposite amounts."""
    return tuple(replace(motion, amount=neg(motion.amount)) for motion in reversed(transform))


def carried(transform: Transform, point: Vector) -> Vector:
    """A point of the frame that the transform leads to, in the frame where it begins."""
    x, y, z = point
    for motion in reversed(transform):
        entries = [x, y, z]
        if motion.kind == "translate":
            entries[motion.axis] = add(entries[motion.axis], motion.amount)
        else:
            cosine, sine = apply("cos", motion.amount), apply("sin", motion.amount)
            first, second = (motion.axis + 1) % 3, (motion.axis + 2) % 3
            a, b = entries[first], entries[second]
            entries[first], entries[second] = sub(mul(cosine, a), mul(sine, b)), add(mul(sine, a), mul(cosine, b))
        x, y, z = entries
    return (x, y, z)


def mirrored(transform: Transform) -> Transform:
    """S T S with S the reflection in the plane y = 0: again a motion of space."""
    return tuple(replace(motion, amount=neg(motion.amount)) if _flips(motion) else motion for motion in transform)


def _flips(motion: Motion) -> bool:
    return (motion.axis == Y) == (motion.kind == "translate")

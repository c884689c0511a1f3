"""Exact folding of URDF's fixed joints: sums of decimals where nothing turns, 70-digit matrices where something does."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Any

from mpmath.ctx_mp import MPContext

Triple = tuple[Decimal, Decimal, Decimal]
Moments = tuple[Decimal, Decimal, Decimal, Decimal, Decimal, Decimal]

_MP = MPContext()
_MP.dps = 70
_POSE_DIGITS = 50  # what makes two axes parallel in the URDF must stay parallel to the classifier
_BODY_DIGITS = 20
_NOTHING = _MP.mpf(10) ** -55
_STEP = _MP.pi / 12
_SNAP = _MP.mpf("1e-15")
ORIGIN: Triple = (Decimal(0), Decimal(0), Decimal(0))


@dataclass(frozen=True)
class Pose:
    """A frame in its parent: translation (m), then Rz(yaw) Ry(pitch) Rx(roll) (rad)."""

    xyz: Triple
    rpy: Triple


IDENTITY = Pose(ORIGIN, ORIGIN)


@dataclass(frozen=True)
class Inertial:
    """Mass (kg), the frame of the inertia (its origin is the centre of mass) and the moments in it: xx yy zz xy xz yz (kg m^2)."""

    mass: Decimal
    origin: Pose
    moments: Moments


def compose(outer: Pose, inner: Pose) -> Pose:
    """The pose outer * inner; exact where `outer` does not turn or `inner` is the identity."""
    if inner == IDENTITY:
        return outer
    if not any(outer.rpy):
        with localcontext() as context:
            context.prec = 1000
            x, y, z = (left + right for left, right in zip(outer.xyz, inner.xyz, strict=True))
        return Pose((x, y, z), inner.rpy)
    turn = _rotation(outer.rpy)
    shift = turn * _column(inner.xyz) + _column(outer.xyz)
    return Pose(_triple(shift), _rpy(turn * _rotation(inner.rpy)) if any(inner.rpy) else outer.rpy)


def inverse(pose: Pose) -> Pose:
    """The pose that undoes this one; exact where it does not turn."""
    if not any(pose.rpy):
        x, y, z = (value.copy_negate() if value else value for value in pose.xyz)
        return Pose((x, y, z), ORIGIN)
    back = _rotation(pose.rpy).T
    return Pose(_triple(back * _column(pose.xyz) * -1), _rpy(back))


def merge(bodies: Sequence[tuple[Pose, Inertial]]) -> Inertial:
    """One body for several that are fixed to each other.

    Args:
        bodies: each with the pose of its link's frame in the common frame; at least one.

    Returns:
        The sum, its inertia about the common centre of mass in axes parallel to the common frame (rpy is zero);
        a single body that is not turned comes back digit by digit.
    """
    placed = [(body, compose(pose, body.origin)) for pose, body in bodies]
    if len(placed) == 1 and not any(placed[0][1].rpy):
        return Inertial(placed[0][0].mass, placed[0][1], placed[0][0].moments)
    mass = sum((body.mass for body, _ in placed), Decimal(0))
    centre = _MP.zeros(3, 1)
    for body, origin in placed:
        centre += _column(origin.xyz) * (_mpf(body.mass) / _mpf(mass) if mass else _MP.mpf(1) / len(placed))
    total = _MP.zeros(3)
    for body, origin in placed:
        turn, arm = _rotation(origin.rpy), _column(origin.xyz) - centre
        total += turn * _matrix(body.moments) * turn.T + _mpf(body.mass) * ((arm.T * arm)[0] * _MP.eye(3) - arm * arm.T)
    xx, yy, zz, xy, xz, yz = (_decimal(total[i, j], _BODY_DIGITS) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    return Inertial(mass, Pose(_triple(centre, _BODY_DIGITS), ORIGIN), (xx, yy, zz, xy, xz, yz))


def off_grid(angle: Decimal) -> bool:
    """Whether an angle looks like a rounded multiple of pi/12: closer than 1e-4 rad, yet not equal to double precision."""
    error = abs(_mpf(angle) - _MP.nint(_mpf(angle) / _STEP) * _STEP)
    return bool(_SNAP < error < _MP.mpf("1e-4")) and abs(angle) > Decimal("0.1")


def _rotation(rpy: Triple) -> Any:
    """Rz(yaw) Ry(pitch) Rx(roll); an angle within 1e-15 of a multiple of pi/12 is that multiple, as the spec language has it."""
    roll, pitch, yaw = (_sine_cosine(angle) for angle in rpy)
    (sr, cr), (sp, cp), (sy, cy) = roll, pitch, yaw
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return _MP.matrix(rows)


def _sine_cosine(angle: Decimal) -> tuple[Any, Any]:
    steps = _MP.nint(_mpf(angle) / _STEP)
    exact = abs(_mpf(angle) - steps * _STEP) <= _SNAP
    return (_MP.sinpi(steps / 12), _MP.cospi(steps / 12)) if exact else (_MP.sin(_mpf(angle)), _MP.cos(_mpf(angle)))


def _rpy(turn: Any) -> Triple:
    """The angles of a rotation matrix; at pitch = +-pi/2 the roll is 0."""
    level = _MP.hypot(turn[0, 0], turn[1, 0])
    pitch = _MP.atan2(-turn[2, 0], level)
    if level < _NOTHING:
        return ORIGIN[0], _decimal(pitch), _angle(-turn[0, 1], turn[1, 1])
    return _angle(turn[2, 1], turn[2, 2]), _decimal(pitch), _angle(turn[1, 0], turn[0, 0])


def _angle(sine: Any, cosine: Any) -> Decimal:
    return _decimal(_MP.atan2(_chopped(sine), _chopped(cosine)))


def _matrix(moments: Moments) -> Any:
    xx, yy, zz, xy, xz, yz = (_mpf(moment) for moment in moments)
    return _MP.matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _column(triple: Triple) -> Any:
    return _MP.matrix([_mpf(value) for value in triple])


def _triple(column: Any, digits: int = _POSE_DIGITS) -> Triple:
    return _decimal(column[0], digits), _decimal(column[1], digits), _decimal(column[2], digits)


def _mpf(number: Decimal) -> Any:
    return _MP.mpf(str(number))


def _chopped(number: Any) -> Any:
    return _MP.mpf(0) if abs(number) < _NOTHING else number


def _decimal(number: Any, digits: int = _POSE_DIGITS) -> Decimal:
    return Decimal(_MP.nstr(_chopped(number), digits, strip_zeros=True))

"""Joint rates of a three-joint leg, damped near singular poses: the reference of walkgen_damped.h."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]

_OK, _BAD_INPUT, _SINGULAR = (STATUSES.index(name) for name in ("OK", "BAD_INPUT", "SINGULAR"))


def damped_inverse_3(J: ArrayLike, v: ArrayLike, epsilon: ArrayLike, lambda_max: ArrayLike) -> tuple[Reals, Integers]:
    """Joint rates qd with J qd = v where the least singular value s of J is at least epsilon, else the damped ones.

    Below epsilon, qd = J^T (J J^T + lambda^2 1)^-1 v with lambda^2 = (1 - (s/epsilon)^2) lambda_max^2, so that
    |qd| <= |v| / (2 lambda). Nakamura and Hanafusa 1986; Maciejewski and Klein 1988.

    Args:
        J: the foot's Jacobian [..., 3, 3].
        v: the foot's velocity [..., 3], m/s.
        epsilon: bound on the singular values [...], in J's unit.
        lambda_max: damping where J is singular [...], in J's unit.

    Returns:
        qd [..., 3] and status [...]: OK, SINGULAR where damping is active or J has rank below 3, or BAD_INPUT with NaN where an input
        is not finite, epsilon or lambda_max is negative, or qd exceeds the range of numbers.
    """
    jacobian, velocity, bound, most = _broadcast(J, v, epsilon, lambda_max)
    numbers = np.concatenate([jacobian.reshape(*bound.shape, 9), velocity, bound[..., None], most[..., None]], axis=-1)
    fine = np.isfinite(numbers).all(axis=-1) & (bound >= 0.0) & (most >= 0.0)
    jacobian, velocity = np.where(fine[..., None, None], jacobian, 0.0), np.where(fine[..., None], velocity, 0.0)
    qd, regular = _solved(jacobian, velocity, np.where(fine, bound, 0.0), np.where(fine, most, 0.0))
    fine &= np.isfinite(qd).all(axis=-1)
    status = np.where(fine, np.where(regular, _OK, _SINGULAR), _BAD_INPUT)
    return np.where(fine[..., None], qd, np.nan), status.astype(np.int32)


def _broadcast(J: ArrayLike, v: ArrayLike, epsilon: ArrayLike, lambda_max: ArrayLike) -> tuple[Reals, Reals, Reals, Reals]:
    jacobian, velocity, bound, most = (np.asarray(item, float) for item in (J, v, epsilon, lambda_max))
    shape = np.broadcast_shapes(jacobian.shape[:-2], velocity.shape[:-1], bound.shape, most.shape)
    return (
        np.broadcast_to(jacobian, (*shape, 3, 3)),
        np.broadcast_to(velocity, (*shape, 3)),
        np.broadcast_to(bound, shape),
        np.broadcast_to(most, shape),
    )


def _solved(jacobian: Reals, velocity: Reals, epsilon: Reals, lambda_max: Reals) -> tuple[Reals, NDArray[np.bool_]]:
    """The rates, and whether they are undamped; finite input of any size, scaled by powers of 2."""
    _, size = np.frexp(np.abs(jacobian).max(axis=(-2, -1)))
    _, speed = np.frexp(np.abs(velocity).max(axis=-1))
    U, s, Vt = np.linalg.svd(np.ldexp(jacobian, -size[..., None, None]))
    least, limit = s[..., -1], np.ldexp(epsilon, -size)
    share = np.where(least < limit, least / np.where(limit > 0.0, limit, 1.0), 1.0)
    with np.errstate(over="ignore"):
        damping = np.where(least < limit, np.ldexp(lambda_max, -size), 0.0) * np.sqrt((1.0 - share) * (1.0 + share))
        length = np.hypot(s, damping[..., None])
    divisor = np.where(length > 0.0, length, 1.0)
    along = np.einsum("...ji,...j->...i", U, np.ldexp(velocity, -speed[..., None]))
    rates = np.einsum("...ji,...j->...i", Vt, s / divisor * along / divisor)
    with np.errstate(over="ignore", under="ignore"):
        qd = np.ldexp(rates, (speed - size)[..., None])
    return qd, (least >= limit) & (least > 0.0)

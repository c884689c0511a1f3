"""Joint rates of a leg or route of any number of joints, damped near singular poses: the reference of walkgen_damped_general.h."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR = (STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR"))
_MOST_JOINTS = 16
_ATTAINED = 1e-9


def damped_inverse(J: ArrayLike, v: ArrayLike, n: int, epsilon: ArrayLike, lambda_max: ArrayLike) -> tuple[Reals, Integers]:
    """Joint rates qd = J^+ v where the least singular value s of J is at least epsilon, else the damped ones.

    J^+ v is the least of all qd with J qd = v for n > 3, and the qd with J qd closest to v for n < 3. Below epsilon,
    qd = J^T (J J^T + lambda^2 1)^-1 v = (J^T J + lambda^2 1)^-1 J^T v with lambda^2 = (1 - (s/epsilon)^2) lambda_max^2, so that
    |qd| <= |v| / (2 lambda). Nakamura and Hanafusa 1986; Maciejewski and Klein 1988.

    Args:
        J: the foot's Jacobian [..., 3, n].
        v: the foot's velocity [..., 3], m/s.
        n: number of joints, 1 to 16.
        epsilon: bound on the singular values [...], of which J has the lesser of 3 and n, in J's unit.
        lambda_max: damping where J is singular [...], in J's unit.

    Returns:
        qd [..., n] and status [...]: OK; UNREACHABLE where n < 3 and J qd misses v by more than 1e-9 of |v|; SINGULAR where damping is
        active or the least singular value is 0; or BAD_INPUT with NaN where an input is not finite, epsilon or lambda_max is negative,
        n is not 1 to 16, or qd exceeds the range of numbers.
    """
    jacobian, velocity, bound, most = _broadcast(J, v, n, epsilon, lambda_max)
    numbers = np.concatenate([jacobian.reshape(*bound.shape, 3 * n), velocity, bound[..., None], most[..., None]], axis=-1)
    fine = np.isfinite(numbers).all(axis=-1) & (bound >= 0.0) & (most >= 0.0) & (1 <= n <= _MOST_JOINTS)
    jacobian, velocity = np.where(fine[..., None, None], jacobian, 0.0), np.where(fine[..., None], velocity, 0.0)
    qd, status = _solved(jacobian, velocity, np.where(fine, bound, 0.0), np.where(fine, most, 0.0))
    fine &= np.isfinite(qd).all(axis=-1)
    return np.where(fine[..., None], qd, np.nan), np.where(fine, status, _BAD_INPUT).astype(np.int32)


def _broadcast(J: ArrayLike, v: ArrayLike, n: int, epsilon: ArrayLike, lambda_max: ArrayLike) -> tuple[Reals, Reals, Reals, Reals]:
    jacobian, velocity, bound, most = (np.asarray(item, float) for item in (J, v, epsilon, lambda_max))
    shape = np.broadcast_shapes(jacobian.shape[:-2], velocity.shape[:-1], bound.shape, most.shape)
    return (
        np.broadcast_to(jacobian, (*shape, 3, n)),
        np.broadcast_to(velocity, (*shape, 3)),
        np.broadcast_to(bound, shape),
        np.broadcast_to(most, shape),
    )


def _solved(jacobian: Reals, velocity: Reals, epsilon: Reals, lambda_max: Reals) -> tuple[Reals, Integers]:
    """The rates and their status; finite input of any size, scaled by powers of 2."""
    _, size = np.frexp(np.abs(jacobian).max(axis=(-2, -1)))
    _, speed = np.frexp(np.abs(velocity).max(axis=-1))
    scaled = np.ldexp(velocity, -speed[..., None])
    U, s, Vt = np.linalg.svd(np.ldexp(jacobian, -size[..., None, None]), full_matrices=False)
    along = np.einsum("...ji,...j->...i", U, scaled)
    with np.errstate(over="ignore", under="ignore"):
        limit, most = np.ldexp(epsilon, -size), np.ldexp(lambda_max, -size)
        length = np.hypot(s, _damping(s[..., -1], limit, most)[..., None])
        divisor = np.where(length > 0.0, length, 1.0)
        rates = np.einsum("...ji,...j->...i", Vt, s / divisor * along / divisor)
        qd = np.ldexp(rates, (speed - size)[..., None])
    regular = (s[..., -1] >= limit) & (s[..., -1] > 0.0)
    rest = scaled - np.einsum("...ij,...j->...i", U, along)
    attained = (jacobian.shape[-1] > 2) | (np.linalg.norm(rest, axis=-1) <= _ATTAINED * np.linalg.norm(scaled, axis=-1))
    return qd, np.where(regular, np.where(attained, _OK, _UNREACHABLE), _SINGULAR).astype(np.int32)


def _damping(least: Reals, limit: Reals, most: Reals) -> Reals:
    """Lambda, from the least singular value [...], epsilon and lambda_max."""
    share = np.where(least < limit, least / np.where(limit > 0.0, limit, 1.0), 1.0)
    return np.asarray(np.where(least < limit, most, 0.0) * np.sqrt((1.0 - share) * (1.0 + share)))

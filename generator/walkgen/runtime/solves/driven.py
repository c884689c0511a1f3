"""Joint values of a chain whose foot a function describes, for a position of the foot; the reference of walkgen_driven.h."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.reach import answered, flat_rows
from walkgen.runtime.solves.rows import Integers, Reals, Truths, sliding_of
from walkgen.runtime.solves.serial import FAR, MOST_JOINTS, TOLERANCE, Arm, Motion, every
from walkgen.runtime.solves.within import all_closest
from walkgen.signature import STATUSES

Callback = tuple[Any, ...]
"""A function as `Motion` has it, and what it takes after q."""
_UNREACHABLE = STATUSES.index("UNREACHABLE")


def closest_driven(
    p: ArrayLike, limits: ArrayLike, reach: ArrayLike, sequence: int, callback: Callback, q: ArrayLike, status: ArrayLike
) -> tuple[Reals, Integers]:
    """Where the status is UNREACHABLE, the joint values within the limits that bring the foot closest to a position.

    Args:
        p: the foot's target [..., 3], m.
        limits: lower and upper [..., n, 2], infinite where there is none.
        reach: about how far the foot gets [...], m.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides; 1 <= n <= 16.
        callback: the foot.
        q: a guess [..., n].
        status: of the guess [...].

    Returns:
        As `closest_within`; the guess and NO_CONVERGENCE where no q that is tried has a foot.
    """
    function, *given = callback
    shape, (target, bounds, far, guess, state, *data) = flat_rows(
        (p, limits, reach, q, status, *given), (1, 2, 0, 1, 0, *(1 for _ in given))
    )
    values, states = guess.copy(), state.astype(np.int32)
    asked = np.flatnonzero(states == _UNREACHABLE)
    if asked.size:
        motion = Motion(function, tuple(data)).take(asked)
        values[asked], states[asked] = all_closest(*_arm(target[asked], far[asked], sequence, motion), bounds[asked], guess[asked])
    return values.reshape(*shape, guess.shape[-1]), states.reshape(shape)


def inverse_driven(
    p: ArrayLike, q_seed: ArrayLike, limits: ArrayLike, reach: ArrayLike, sequence: int, callback: Callback
) -> tuple[Reals, Integers]:
    """Joint values near a seed that bring the foot to a position.

    Args:
        p: as of `closest_driven`.
        q_seed: joint values to start from [..., n].
        limits: as of `closest_driven`; a solution within them goes before others.
        reach: as of `closest_driven`.
        sequence: as of `closest_driven`.
        callback: as of `closest_driven`.

    Returns:
        As `inverse_reach`; the seed and NO_CONVERGENCE where no q that is tried has a foot.
    """
    function, *given = callback
    shape, (target, seed, bounds, far, *data) = flat_rows((p, q_seed, limits, reach, *given), (1, 1, 2, 0, *(1 for _ in given)))
    return answered(*_arm(target, far, sequence, Motion(function, tuple(data))), seed, bounds, shape)


def _arm(p: Reals, reach: Reals, sequence: int, motion: Motion) -> tuple[Arm | None, Truths]:
    """The arms of rows, lengths scaled by a power of 2 to about 1, a target very far away brought nearer; which rows are arms."""
    sliding = sliding_of(sequence) if sequence > 1 else np.zeros(0, bool)
    if not 0 < len(sliding) <= MOST_JOINTS:
        return None, np.zeros(len(p), bool)
    fine = every(np.isfinite(p)) & np.isfinite(reach) & (reach > 0.0)
    target, far = np.where(fine[:, None], p, 0.0), np.where(fine, reach, 1.0)
    size = np.frexp(far)[1]
    scale = np.frexp(np.max(np.abs(target), axis=-1))[1]
    scale = np.where(scale - size > FAR, scale - FAR, size)
    own, none = np.ldexp(far, -size), np.zeros((len(p), len(sliding), 3))
    target = np.ldexp(target, -scale[:, None])
    return Arm(sliding, none, none, none, none[:, 0], target, None, size, 0.25 * own, own, TOLERANCE * own, motion), fine

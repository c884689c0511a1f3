"""One row chosen among all solutions of an inverse, by a seed or by the joint limits: the reference of walkgen_rows.h."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from walkgen.signature import STATUSES

Reals = NDArray[np.float64]
Truths = NDArray[np.bool_]
Integers = NDArray[np.int32]

_OK, _UNREACHABLE, _BAD_INPUT, _SINGULAR, _DUPLICATE = (
    STATUSES.index(name) for name in ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR", "DUPLICATE")
)
_TURN = 2.0 * np.pi
_SLACK = 1e-12


def sliding_of(sequence: int) -> Truths:
    """Whether each joint slides [n]: the binary digits after the leading 1, base to foot."""
    return np.array([digit == "1" for digit in f"{sequence:b}"[1:]], bool)


def nearest_row(rows: ArrayLike, states: ArrayLike, seed: ArrayLike, sequence: int, slots: int) -> tuple[Reals, Integers]:
    """The row with the least sum of squared differences to a seed, those of revolute joints modulo full turns.

    Args:
        rows: joint values [..., slots, n].
        states: their statuses [..., slots]; rows that reach the target (OK, SINGULAR, DUPLICATE) go before others, BAD_INPUT rows are none.
        seed: joint values [..., n].
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides (RRR is 8).
        slots: number of rows.

    Returns:
        q [..., n] and status [...]: the row's own, OK for DUPLICATE; BAD_INPUT with NaN where the seed is not finite or there is no row.
    """
    q, state, wanted = _broadcast(rows, states, seed, slots, 1)
    fine = np.all(np.isfinite(wanted), axis=-1, keepdims=True)
    with np.errstate(over="ignore", invalid="ignore"):
        gap = q - np.where(fine, wanted, 0.0)[..., None, :]
        gap = np.where(sliding_of(sequence), gap, _short_way(gap))
        distance = np.sum(gap * gap, axis=-1)
    chosen = _first_least(state, distance)
    status = _status(state, chosen, fine[..., 0])
    return np.where((status == _BAD_INPUT)[..., None], np.nan, _row(q, chosen)), status


def admissible_row(rows: ArrayLike, states: ArrayLike, limits: ArrayLike, sequence: int, slots: int) -> tuple[Reals, Integers]:
    """Of the rows that reach the target and, full turns added, fit the limits: the one nearest their middle.

    Distances count over the half range; over pi where a revolute joint lacks a limit, not at all where a sliding one does.

    Args:
        rows: joint values [..., slots, n].
        states: their statuses [..., slots].
        limits: lower and upper [..., n, 2], infinite where there is none.
        sequence: 1, then a binary digit a joint, base to foot: 0 turns, 1 slides (RRR is 8).
        slots: number of rows.

    Returns:
        q [..., n] within the limits and status [...]: the row's own, OK for DUPLICATE; UNREACHABLE with the row that comes nearest to
        fitting, clamped; BAD_INPUT with NaN where there is no row or the limits are none.
    """
    q, state, bounds = _broadcast(rows, states, limits, slots, 2)
    low, high = bounds[..., 0], bounds[..., 1]
    fine = np.all((low <= high) & (low < np.inf) & (high > -np.inf), axis=-1, keepdims=True)
    low, high = (np.where(fine, bound, 0.0)[..., None, :] for bound in (low, high))
    with np.errstate(over="ignore", invalid="ignore"):
        inside, excess, share = admitted(sliding_of(sequence), q, low, high)
        outside = np.maximum(np.sum(excess * excess, axis=-1), np.where((excess > 0.0).any(axis=-1), np.finfo(float).tiny, 0.0))
        distance = np.sum(share * share, axis=-1)
    chosen = _first_least(state, outside, distance)
    status = _status(state, chosen, fine[..., 0])
    unfit = (np.take_along_axis(outside, chosen[..., None], axis=-1)[..., 0] > 0.0) | ~_reaches(status)
    status = np.where(status == _BAD_INPUT, status, np.where(unfit, _UNREACHABLE, status)).astype(np.int32)
    return np.where((status == _BAD_INPUT)[..., None], np.nan, _row(inside, chosen)), status


def admitted(sliding: Truths, q: Reals, low: Reals, high: Reals) -> tuple[Reals, Reals, Reals]:
    """Joint values turned fully towards the middle of the limits, or into the one there is, and clamped [..., n].

    Returns:
        The values, by how much each was clamped (0 for roundings), and its distance from the middle over the half range.
    """
    bounded = np.isfinite(low) & np.isfinite(high)
    half = np.where(bounded, 0.5 * high - 0.5 * low, np.inf)
    middle = np.where(bounded, low + half, 0.0)
    towards = middle + _short_way(q - middle)
    into = q + _TURN * (np.ceil(np.maximum(low - q, 0.0) / _TURN) - np.ceil(np.maximum(q - high, 0.0) / _TURN))
    value = np.where(sliding, q, np.where(bounded, towards, np.where(np.isfinite(into), into, q)))
    inside = np.minimum(np.maximum(value, low), high)
    excess = np.abs(value - inside)
    size = np.where(sliding, np.abs(inside), np.maximum(np.abs(inside), 1.0))
    scale = np.where(bounded, np.where(half > 0.0, half, 1.0), np.where(sliding, np.inf, np.pi))
    return inside, np.where(excess <= _SLACK * size, 0.0, excess), (inside - middle) / scale


def _short_way(angle: Reals) -> Reals:
    """Less full turns, within half a turn."""
    rest = np.fmod(angle, _TURN)
    return np.asarray(rest - _TURN * np.round(rest / _TURN))


def _broadcast(rows: ArrayLike, states: ArrayLike, other: ArrayLike, slots: int, rank: int) -> tuple[Reals, Integers, Reals]:
    q, state, more = np.asarray(rows, float), np.asarray(states, np.int32), np.asarray(other, float)
    n = q.shape[-1]
    tail = (n, 2)[:rank]
    shape = np.broadcast_shapes(q.shape[:-2], state.shape[:-1], more.shape[: more.ndim - rank])
    q, state = np.broadcast_to(q, (*shape, slots, n)), np.broadcast_to(state, (*shape, slots))
    none = ~np.isfinite(q).all(axis=-1)
    return np.where(none[..., None], 0.0, q), np.where(none, _BAD_INPUT, state), np.broadcast_to(more, (*shape, *tail))


def _reaches(states: Integers) -> Truths:
    return np.isin(states, (_OK, _SINGULAR, _DUPLICATE))


def _first_least(states: Integers, *keys: Reals) -> NDArray[np.intp]:
    """The first row [...] of those that reach, or else do not, with the least keys in their order."""
    rank = np.where(states == _BAD_INPUT, 2, np.where(_reaches(states), 0, 1))
    best = np.ones(states.shape, bool)
    for key in (rank.astype(float), *keys):
        value = np.where(best & ~np.isnan(key), key, np.inf)
        best = best & (value <= np.min(value, axis=-1, keepdims=True))
    return np.asarray(np.argmax(best, axis=-1))


def _row(q: Reals, chosen: NDArray[np.intp]) -> Reals:
    return np.asarray(np.take_along_axis(q, chosen[..., None, None], axis=-2)[..., 0, :])


def _status(states: Integers, chosen: NDArray[np.intp], fine: Truths) -> Integers:
    state = np.take_along_axis(states, chosen[..., None], axis=-1)[..., 0]
    return np.where(fine, np.where(state == _DUPLICATE, _OK, state), _BAD_INPUT).astype(np.int32)

"""When legs lift and are placed in a list of events, and where feet are meanwhile; the reference of walkgen_schedule.h.

Leg i's events are times[first[i]], ..., times[first[i + 1] - 1], in order; each changes its state, which is lifted[i] (1 in transfer)
before the first one. What the last one leaves lasts for ever.
"""

from itertools import pairwise

import numpy as np

from walkgen.runtime.solves.gait import Motion, gait_step


def schedule_states(times: np.ndarray, first: np.ndarray, lifted: np.ndarray, k: int, t: np.ndarray) -> np.ndarray:
    """0 supports, 1 in transfer [..., k]; -1 where t is not finite. At an event's time the state after it.

    Args:
        times: of all events, leg after leg [n], s.
        first: the number of each leg's first event in `times`, and n [k + 1].
        lifted: 1 for legs in transfer before their first event, else 0 [k].
        k: legs.
        t: s [...].
    """
    t = np.asarray(t, float)
    passed = np.stack([np.searchsorted(own, t, side="right") for own in _own(times, first, k)], axis=-1)
    return np.where(np.isfinite(t)[..., None], (passed + np.reshape(lifted, k).astype(int)) % 2, -1).astype(np.int32)


def schedule_phase(times: np.ndarray, first: np.ndarray, k: int, t: np.ndarray) -> np.ndarray:
    """The share of its support or transfer that each leg has behind it [..., k] in [0, 1); NaN where that has no start or no end.

    Arguments as `schedule_states`.
    """
    start, end = _around(times, first, k, t)
    return np.asarray((np.asarray(t, float)[..., None] - start) / (end - start))


def schedule_next_event(times: np.ndarray, first: np.ndarray, lifted: np.ndarray, k: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first time after t at which legs change, and which do [..., k]: 1 lifted, -1 placed, 0 neither; NaN and 0 after the last event.

    Arguments as `schedule_states`.
    """
    t = np.asarray(t, float)
    _, end = _around(times, first, k, t)
    time = np.fmin.reduce(end, axis=-1)
    before = np.where(np.isfinite(time), t, np.nan)
    change = schedule_states(times, first, lifted, k, time) - schedule_states(times, first, lifted, k, before)
    return time, change.astype(np.int32)


def schedule_transfers(
    times: np.ndarray, first: np.ndarray, lifted: np.ndarray, k: int, lift: float, t: np.ndarray, start: np.ndarray, end: np.ndarray
) -> Motion:
    """Position, velocity, acceleration [..., k, 3] of feet that stand at `start` and, in transfer, go to `end`, as `gait_transfers` has it.

    NaN for a transfer that has no start or no end, and where t is not finite.

    Args:
        times: as `schedule_states` takes them, like the others.
        first: [k + 1].
        lifted: [k].
        k: legs.
        lift: m, along z.
        t: s [...].
        start: footholds [..., k, 3], m.
        end: footholds to come [..., k, 3], m; those of feet in support do not count.
    """
    stands = schedule_states(times, first, lifted, k, t) == 0
    began, ends = _around(times, first, k, t)
    share = schedule_phase(times, first, k, t)
    goal = np.where(stands[..., None], start, end)
    return gait_step(np.where(stands, 0.0, share), np.where(stands, 0.0, 1.0 / (ends - began)), lift, start, goal)


def _own(times: np.ndarray, first: np.ndarray, k: int) -> list[np.ndarray]:
    """Every leg's events."""
    starts = np.reshape(first, k + 1).astype(int)
    return [np.asarray(times, float)[here:there] for here, there in pairwise(starts)]


def _around(times: np.ndarray, first: np.ndarray, k: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times of every leg's last event up to t and next one after it [..., k]; NaN where there is none, and where t is not finite."""
    t = np.asarray(t, float)
    bounds = [np.concatenate([[np.nan], own, [np.nan]]) for own in _own(times, first, k)]
    places = [np.searchsorted(own[1:-1], t, side="right") for own in bounds]
    start, end = (np.stack([own[place + after] for own, place in zip(bounds, places, strict=True)], axis=-1) for after in (0, 1))
    known = np.isfinite(t)[..., None]
    return np.where(known, start, np.nan), np.where(known, end, np.nan)

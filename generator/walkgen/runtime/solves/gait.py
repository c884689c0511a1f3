"""When legs lift and are placed, and where feet are meanwhile; the reference of walkgen_gait.h (theory 3.1).

Leg i is placed at phase[i] and lifted at phase[i] + duty[i], in periods. Its local phase is u = F(t/T - phase), F the fractional part; it
supports (state 0) while u < duty, else it is in transfer (state 1).
"""

import numpy as np

_SLACK = 4.0
"""Events closer than this many roundings of t/T have happened: so that the state at the time of an event is the state after it."""
Motion = tuple[np.ndarray, np.ndarray, np.ndarray]


def gait_phase(duty: np.ndarray, phase: np.ndarray, k: int, period: float, t: np.ndarray) -> np.ndarray:
    """Local phases u [..., k] in [0, 1); NaN where t is not finite.

    Args:
        duty: factors [k].
        phase: when each leg is placed [k], in periods.
        k: legs.
        period: s.
        t: s [...].
    """
    duty, phase = np.reshape(duty, k), np.reshape(phase, k)
    with np.errstate(all="ignore"):
        x = (np.asarray(t, float) / period)[..., None]
        y = x - phase
        u = y - np.floor(y)
        slack = _SLACK * np.finfo(float).eps * (1.0 + np.abs(x))
    u = np.where(u >= 1.0 - slack, 0.0, np.where((u < duty) & (u >= duty - slack), duty, u))
    return np.where(np.isfinite(y), u, np.nan)


def gait_states(duty: np.ndarray, phase: np.ndarray, k: int, period: float, t: np.ndarray) -> np.ndarray:
    """0 supports, 1 in transfer [..., k]; -1 where t is not finite. Arguments as `gait_phase`."""
    u = gait_phase(duty, phase, k, period, t)
    return np.where(np.isnan(u), -1, np.where(u < np.reshape(duty, k), 0, 1)).astype(np.int32)


def gait_next_event(duty: np.ndarray, phase: np.ndarray, k: int, period: float, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first time after t at which a leg is lifted or placed, and what changes [..., k]: 1 lifted, -1 placed, 0 neither.

    Arguments as `gait_phase`; the time is NaN and nothing changes where t is not finite.
    """
    t = np.asarray(t, float)
    u = gait_phase(duty, phase, k, period, t)
    factors = np.reshape(duty, k)
    rest = np.where(u < factors, factors - u, 1.0 - u).min(axis=-1)
    time = t + rest * period
    change = gait_states(duty, phase, k, period, time) - gait_states(duty, phase, k, period, t)
    return time, change.astype(np.int32)


def gait_transfers(
    duty: np.ndarray, phase: np.ndarray, k: int, period: float, lift: float, t: np.ndarray, start: np.ndarray, end: np.ndarray
) -> Motion:
    """Position, velocity, acceleration [..., k, 3] of feet that stand at `start` and, in transfer, go to `end`.

    Both are at rest in the frame. x, y and z of a foot in transfer run by the quintic 10 s^3 - 15 s^4 + 6 s^5 of s = (u - duty)/(1 - duty),
    on which 64 s^3 (1 - s)^3 lifts it: velocity and acceleration are 0 at both ends, and half way it is `lift` over the higher end.

    Args:
        duty: factors [k].
        phase: when each leg is placed [k], in periods.
        k: legs.
        period: s.
        lift: m, along z.
        t: s [...].
        start: footholds [..., k, 3], m.
        end: footholds to come [..., k, 3], m; those of feet in support do not count.
    """
    u = gait_phase(duty, phase, k, period, t)
    duty = np.reshape(duty, k)
    stands = u < duty
    share = np.where(stands, 0.0, (u - duty) / (1.0 - duty))
    return gait_step(share, 1.0 / ((1.0 - duty) * period), lift, start, np.where(stands[..., None], start, end))


def gait_step(share: np.ndarray, rate: np.ndarray, lift: float, start: np.ndarray, end: np.ndarray) -> Motion:
    """Position, velocity, acceleration [..., 3] of feet on their way from `start` to `end`, both at rest: at rest there at its ends.

    Args:
        share: of the way's time [...], in [0, 1].
        rate: 1/s [...]; the way lasts 1/rate.
        lift: m, along z, over the higher end half way.
        start: footholds [..., 3], m.
        end: footholds [..., 3], m.
    """
    s, rate = np.asarray(share, float)[..., None], np.asarray(rate, float)[..., None]
    way = np.asarray(end, float) - start
    raised = np.array([0.0, 0.0, 1.0]) * (lift + 0.5 * np.abs(way[..., 2:]))
    r = 1.0 - s
    part = s**3 * (10.0 - s * (15.0 - 6.0 * s)), 30.0 * (s * r) ** 2, 60.0 * s * r * (r - s)
    hump = 64.0 * (s * r) ** 3, 192.0 * (s * r) ** 2 * (r - s), 384.0 * s * r * (1.0 - 5.0 * s * r)
    position = start + way * part[0] + raised * hump[0]
    velocity = (way * part[1] + raised * hump[1]) * rate
    acceleration = (way * part[2] + raised * hump[2]) * rate**2
    return position, velocity, acceleration


def gait_targets(
    duty: np.ndarray,
    phase: np.ndarray,
    k: int,
    period: float,
    lift: float,
    stance: np.ndarray,
    t: np.ndarray,
    twist: np.ndarray,
) -> Motion:
    """Position, velocity, acceleration [..., k, 3] of the feet in the frame of a platform that moves steadily over level ground.

    A foot passes its `stance` in the middle of its support, at rest on the ground, and goes from one such foothold to the next as
    `gait_transfers` has it; all continuous up to the acceleration.

    Args:
        duty: factors [k].
        phase: when each leg is placed [k], in periods.
        k: legs.
        period: s.
        lift: m, along z.
        stance: [k, 3], m, in the platform's frame.
        t: s [...].
        twist: of the platform in its own frame [..., 3]: velocity along x and y (m/s), turning about z (rad/s); constant.
    """
    duty = np.reshape(duty, k)
    stance, twist, t = np.reshape(stance, (k, 3)), np.asarray(twist, float)[..., None, :], np.asarray(t, float)
    u = gait_phase(duty, phase, k, period, t)
    start = _seen_later(stance, twist, (u - 0.5 * duty) * period)
    end = _seen_later(stance, twist, (u - 0.5 * duty - 1.0) * period)
    position, ground_velocity, ground_acceleration = gait_transfers(duty, phase, k, period, lift, t, start, end)
    velocity = ground_velocity - _carried(twist, position)
    acceleration = ground_acceleration - _turned(twist, ground_velocity) - _turned(twist, velocity)
    return position, velocity, acceleration


def _seen_later(point: np.ndarray, twist: np.ndarray, time: np.ndarray) -> np.ndarray:
    """A point at rest on the ground as the moving platform sees it `time` after it was at `point`."""
    angle = twist[..., 2] * time
    half = 0.5 * angle
    with np.errstate(all="ignore"):
        along = np.where(angle == 0.0, 1.0, np.sin(angle) / angle)
        across = np.where(half == 0.0, 0.0, np.sin(half) ** 2 / half)
    x = point[..., 0] - time * (along * twist[..., 0] - across * twist[..., 1])
    y = point[..., 1] - time * (across * twist[..., 0] + along * twist[..., 1])
    z = np.broadcast_to(point[..., 2], x.shape) + 0.0 * angle
    return np.stack([np.cos(angle) * x + np.sin(angle) * y, np.cos(angle) * y - np.sin(angle) * x, z], -1)


def _turned(twist: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Omega x vector."""
    rate = twist[..., 2]
    return np.stack([-rate * vector[..., 1], rate * vector[..., 0], np.zeros_like(vector[..., 2])], -1)


def _carried(twist: np.ndarray, point: np.ndarray) -> np.ndarray:
    """The velocity of the platform's point: v + omega x point."""
    carried: np.ndarray = twist * [1.0, 1.0, 0.0] + _turned(twist, point)
    return carried

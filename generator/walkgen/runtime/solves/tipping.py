"""How a stiff robot turns about a line between two feet, phi'' = kappa sin(phi) from upright: the reference of walkgen_tipping.h."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, OK, Integers, Reals

_CLOSE = 1e-3
_EPSILON = float(np.finfo(float).eps)
_TINY = float(np.finfo(float).tiny)
_Place = tuple[float, float, float]
"""Sine and cosine of a half angle, and 1/kappa times the square of its rate."""


class _Start(NamedTuple):
    """Half the tilt, and 1/sqrt(kappa) times its rate."""

    x: float
    pace: float

    @property
    def energy(self) -> float:
        """What keeps its value: pace^2 - sin(x)^2."""
        return (self.pace - math.sin(self.x)) * (self.pace + math.sin(self.x))


def tipping_time(kappa: ArrayLike, tilt: ArrayLike, rate: ArrayLike, turn: ArrayLike) -> tuple[Reals, Integers]:
    """The time in which a robot turns on by an angle: elliptic integrals of the first kind (Carlson 1979; DLMF 19.29).

    Args:
        kappa: of its line, 1/s^2 [...].
        tilt: from upright, rad, below 0 over its feet [...].
        rate: at which it turns, rad/s [...].
        turn: by how much it turns on, rad, to less than pi from upright [...].

    Returns:
        time [...], s; status [...]: INFEASIBLE and infinite where it never does, BAD_INPUT and NaN.
    """
    time, status = _each(_time, kappa, tilt, rate, turn)
    return time, status


def tipping_tilt(kappa: ArrayLike, tilt: ArrayLike, rate: ArrayLike, time: ArrayLike) -> tuple[Reals, Reals, Integers]:
    """How far a robot has turned after a time, and its rate then: elliptic functions (DLMF 22.8, 22.20).

    Args:
        kappa: as `tipping_time` takes it, like tilt and rate.
        tilt: [...].
        rate: [...].
        time: s [...].

    Returns:
        turn [...], rad, from upright by less than a whole turn; rate [...], rad/s; status [...]: BAD_INPUT and NaN.
    """
    turn, rate_then, status = _each(_tilt, kappa, tilt, rate, time)
    return turn, rate_then, status


def tipping_speed_limit(length: ArrayLike, kappa: ArrayLike, tilt: ArrayLike, rate: ArrayLike, turn: ArrayLike) -> tuple[Reals, Integers]:
    """The least forward speed, m/s, at which a step of a length, m, ends before the robot has turned on; 0 where it never turns so far."""
    speed, status = _each(_speed, length, kappa, tilt, rate, turn)
    return speed, status


def _each(one: Callable[..., tuple[float | int, ...]], *inputs: ArrayLike) -> list[Any]:
    items = np.broadcast_arrays(*(np.asarray(item, float) for item in inputs))
    rows = np.array([one(*(float(item[index]) for item in items)) for index in np.ndindex(items[0].shape)])
    columns = [np.array(rows[..., i]).reshape(items[0].shape) for i in range(rows.shape[-1])]
    return [*columns[:-1], columns[-1].astype(np.int32)]


def _start(kappa: float, tilt: float, rate: float) -> _Start | None:
    if not (0.0 < kappa < math.inf and abs(tilt) < math.pi and math.isfinite(rate)):
        return None
    return _Start(0.5 * tilt, 0.5 * rate / math.sqrt(kappa))


def _time(kappa: float, tilt: float, rate: float, turn: float) -> tuple[float, int]:
    start = _start(kappa, tilt, rate)
    if start is None or not (turn >= 0.0 and tilt + turn < math.pi):
        return math.nan, BAD_INPUT
    taken = _long(start, start.x + 0.5 * turn) if turn > 0.0 else 0.0
    return (math.inf, INFEASIBLE) if taken is None else (taken / math.sqrt(kappa), OK)


def _speed(length: float, kappa: float, tilt: float, rate: float, turn: float) -> tuple[float, int]:
    time, status = _time(kappa, tilt, rate, turn)
    if status == BAD_INPUT or not (0.0 <= length < math.inf and turn > 0.0):
        return math.nan, BAD_INPUT
    return length / time, OK


def _long(start: _Start, end: float) -> float | None:
    """sqrt(kappa) times the time to a half angle; None where it never comes."""
    a, difference = start.energy, math.sin(end - start.x) * math.sin(end + start.x)
    stop = start.pace**2 + difference
    here: _Place = (abs(math.sin(start.x)), math.cos(start.x), start.pace**2)
    there: _Place = (abs(math.sin(end)), math.cos(end), max(stop, 0.0))
    top: _Place = (0.0, 1.0, max(a, 0.0))
    if start.x < 0.0:
        if not start.pace > 0.0 or not (a > 0.0 if end > 0.0 else stop > 0.0):
            return None
        if end <= 0.0:
            return _between(a, there, here, -difference)
        return _between(a, top, here, here[0] ** 2) + _between(a, top, there, there[0] ** 2)
    if start.pace < 0.0:
        turn: _Place = (math.sqrt(max(-a, 0.0)), math.sqrt(max(1.0 + a, 0.0)), 0.0)
        return _between(a, turn, here, here[2]) + _between(a, turn, there, stop) if a < 0.0 else None
    return _between(a, here, there, difference) if max(start.x, start.pace) > 0.0 else None


def _between(energy: float, start: _Place, end: _Place, difference: float) -> float:
    """Between places on one side of upright, the difference of the squares of whose sines is given."""
    root = (end[0] * end[1] * math.sqrt(start[2]) + start[0] * start[1] * math.sqrt(end[2])) / difference
    return _integral(root**2 + 1.0 + energy, max(root**2 + energy, 0.0), root**2)


def _integral(x: float, y: float, z: float) -> float:
    """Carlson's R_F of numbers of which at most one is 0."""
    for _ in range(60):
        more = math.sqrt(x * y) + math.sqrt(y * z) + math.sqrt(z * x)
        x, y, z = (0.25 * (item + more) for item in (x, y, z))
        mean = (x + y + z) / 3.0
        if max(abs(mean - item) for item in (x, y, z)) <= _CLOSE * mean:
            break
    first, second = 1.0 - x / mean, 1.0 - y / mean
    third = -(first + second)
    p, q = first * second - third**2, first * second * third
    return (1.0 - p / 10.0 + q / 14.0 + p**2 / 24.0 - 3.0 * p * q / 44.0) / math.sqrt(mean)


def _tilt(kappa: float, tilt: float, rate: float, time: float) -> tuple[float, float, int]:
    start = _start(kappa, tilt, rate)
    if start is None or not 0.0 <= time < math.inf:
        return math.nan, math.nan, BAD_INPUT
    sine, cosine, v = math.sin(start.x), math.cos(start.x), math.sqrt(kappa) * time
    if sine == 0.0 and start.pace == 0.0:
        return 0.0, 0.0, OK
    size = math.hypot(start.pace, cosine)
    if start.energy < 0.0:
        side, complement = math.copysign(1.0, sine), -start.energy
        dn = math.sqrt(complement) / abs(sine)
        place = (side * start.pace / (size * abs(sine)), cosine * dn / size, dn)
        sn, cn, dn = _sum(complement, place, _elliptic(v, complement))
        then = (math.sqrt(complement) / dn, size * cn / dn, size * math.sqrt(complement) * sn / dn)
    else:
        side, complement = math.copysign(1.0, start.pace), max(start.energy / size**2, _TINY)
        place = (cosine, -side * sine, abs(start.pace) / size)
        sn, cn, dn = _sum(complement, place, _elliptic(v * size, complement))
        then = (-cn, sn, size * dn)
    return 2.0 * math.atan2(side * then[0], then[1]) - tilt, 2.0 * math.sqrt(kappa) * side * then[2], OK


def _elliptic(u: float, complement: float) -> tuple[float, float, float]:
    """sn, cn, dn of the complementary parameter, by the arithmetic-geometric mean."""
    a, b = 1.0, math.sqrt(complement)
    ratios: list[float] = []
    while not ratios or (ratios[-1] > _EPSILON and len(ratios) < 24):
        a, b, half = 0.5 * (a + b), math.sqrt(a * b), 0.5 * (a - b)
        ratios.append(half / a)
    phi = math.ldexp(a * u, len(ratios))
    for ratio in reversed(ratios):
        phi = 0.5 * (phi + math.asin(ratio * math.sin(phi)))
    return math.sin(phi), math.cos(phi), math.sqrt(complement + (1.0 - complement) * math.cos(phi) ** 2)


def _sum(complement: float, p: tuple[float, float, float], q: tuple[float, float, float]) -> tuple[float, float, float]:
    """sn, cn, dn of a sum."""
    m = 1.0 - complement
    size, mixed = p[1] ** 2 + (p[0] * q[2]) ** 2, m * p[0] * p[1] * q[0] * q[1]
    together = p[2] * q[2]
    dn = (complement + m * (p[1] * q[1]) ** 2) / (together + mixed) if mixed > 0.0 else (together - mixed) / size
    return (p[0] * q[1] * q[2] + q[0] * p[1] * p[2]) / size, (p[1] * q[1] - p[0] * q[0] * p[2] * q[2]) / size, dn

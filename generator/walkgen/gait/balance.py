"""Waved and swinging gaits: the platform shifts, or turns about a side of the support polygon, before a leg lifts (theory 3.1)."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np

from walkgen.gait.motion import Motion, composed, shifting, turning_about
from walkgen.gait.pattern import Gait
from walkgen.gait.steps import Standing, Steps
from walkgen.gait.trajectory import Trajectory

Body = Callable[[np.ndarray], Motion]
Com = Callable[[Body, np.ndarray], np.ndarray]
"""The centre of mass [t,3] (m) of a body's motion at times [t]."""

_PAUSE = 0.5
_GENTLE = 1.5
"""Shares of a transfer for which all legs stand before it: at least, and where time is inserted; so long takes a shift."""
_SAMPLES = 17
_ROUNDS = 20
_MORE = 1e-4
"""Aimed at beyond the margin (m), for what lies between the samples of a transfer."""
_HARDLY = 1e-9


class Lift(NamedTuple):
    """A transfer, and the pauses around it: the body moves from `begin` to `start`, stays so until `end` and is back at `rest` (s)."""

    begin: float
    start: float
    end: float
    rest: float


class Side(NamedTuple):
    """A support polygon's side [2,3], its inward normal in the plan [2], how far inside the centre of mass is at every sample [s] (m)."""

    points: np.ndarray
    normal: np.ndarray
    inside: np.ndarray


@dataclass(frozen=True)
class Moves:
    """What the body does for every lift: a shift [j,3] (m), or a turn by `angle` [j] (rad) about lines through `point` along `axis`."""

    lifts: tuple[Lift, ...]
    shift: np.ndarray
    point: np.ndarray
    axis: np.ndarray
    angle: np.ndarray

    def __call__(self, t: np.ndarray) -> Motion:
        """The motion at times [t] that is added to the body's own: of the lift to come on that of the last one, which comes to an end."""
        now = np.maximum(np.searchsorted([lift.begin for lift in self.lifts], t, side="right") - 1, 0)
        return composed(self._move(np.maximum(now - 1, 0), t, now > 0), self._move(now, t, now >= 0))

    def _move(self, number: np.ndarray, t: np.ndarray, counts: np.ndarray) -> Motion:
        share, rate, second = (part * counts for part in _bump(np.array(self.lifts)[number].T, t))
        moved = shifting(*(part[:, None] * self.shift[number] for part in (share, rate, second)))
        angles = (part * self.angle[number] for part in (share, rate, second))
        return composed(moved, turning_about(self.point[number], self.axis[number], *angles))


def with_room(feet: Trajectory | Steps) -> Trajectory | Steps:
    """Feet with time for the platform before every lift: `with_pauses` of a gait, a list of events as it is.

    Raises:
        ValueError: two legs are in transfer together, or nearly so in a list of events.
    """
    if isinstance(feet, Steps):
        feet.refuse_crowded(_PAUSE)
        return feet
    return with_pauses(feet)


def with_pauses(trajectory: Trajectory) -> Trajectory:
    """The gait with time inserted where a leg lifts too soon after the one before was placed; transfers and stride stay as they are.

    Raises:
        ValueError: two legs are in transfer together, so that no platform's motion can help one after the other.
    """
    gait = trajectory.gait
    air = [(1.0 - duty) * gait.period for duty in gait.duty_factor]
    lifts = sorted(
        ((phase + duty) % 1.0 * gait.period, leg) for leg, (phase, duty) in enumerate(zip(gait.phase, gait.duty_factor, strict=True))
    )
    added, start = 0.0, dict[int, float]()
    for (at, leg), (last, before) in zip(lifts, [lifts[-1], *lifts], strict=False):
        gap = (at - last) % gait.period - air[before] if len(lifts) > 1 else gait.period - air[leg]
        if gap < -_HARDLY * gait.period:
            raise ValueError(
                f"{gait.legs[before]} and {gait.legs[leg]} are in transfer together; a body that helps every lift needs one at a time"
            )
        added += _GENTLE * air[leg] - gap if gap < _PAUSE * air[leg] * (1.0 - _HARDLY) else 0.0
        start[leg] = at + added
    period = gait.period + added
    phase = [(start[leg] + air[leg]) / period for leg in range(len(air))]
    slower = Gait(gait.legs, tuple(1.0 - part / period for part in air), tuple(phase), period, gait.stride)
    return replace(trajectory, gait=slower)


def moves(footholds: Standing, body: Body, com: Com, kind: Literal["waved", "swinging"], margin: float, cycles: int) -> Moves:
    """The least shifts, or turns, that keep the margin in every transfer of a walk.

    Found round by round, since the legs' own masses do not move as the body does. A margin that a support polygon is too small for is
    come near to.

    Args:
        footholds: of the walk.
        body: its platform's motion without them.
        com: centre of mass of a motion.
        kind: waved or swinging.
        margin: static, from above (m).
        cycles: of the walk.
    """
    lifts = lifts_of(footholds, cycles)
    none = np.zeros((len(lifts), 3))
    found = Moves(lifts, none, none, none + np.array([1.0, 0.0, 0.0]), np.zeros(len(lifts)))
    times = np.array([np.linspace(lift.start, lift.end, _SAMPLES) for lift in lifts])
    sides = [_feet(footholds, lift) for lift in lifts]
    for _ in range(_ROUNDS):
        moved = com(_joined(found, body), times.ravel()).reshape(*times.shape, 3)
        measured = [_sides(feet, path) for feet, path in zip(sides, moved, strict=True)]
        if all(side.inside.min() >= margin for around in measured for side in around):
            break
        found = _waved(found, measured, margin + _MORE) if kind == "waved" else _swung(found, measured, moved, margin + _MORE)
    return found


def _joined(found: Moves, body: Body) -> Body:
    return lambda t: composed(found(t), body(t))


def lifts_of(footholds: Standing, cycles: int) -> tuple[Lift, ...]:
    """All transfers of a walk in order, and one before and after it where it goes on."""
    times = footholds.transfers(cycles)
    pause = [_PAUSE * (end - start) for start, end in times]
    begins = [times[0][0] - pause[0], *(end for _, end in times[:-1])]
    rests = [*(start for start, _ in times[1:]), times[-1][1] + pause[-1]]
    return tuple(Lift(begin, start, end, rest) for begin, (start, end), rest in zip(begins, times, rests, strict=True))


def _feet(footholds: Standing, lift: Lift) -> np.ndarray:
    """Those that support during the transfer [k,3]."""
    feet, support = footholds.motion(np.array([0.5 * (lift.start + lift.end)]))
    standing: np.ndarray = feet.position[0, support[0]]
    return standing


def _sides(feet: np.ndarray, com: np.ndarray) -> tuple[Side, ...]:
    """Of the support polygon; empty where it has no area."""
    found = []
    for here, there in ((a, b) for pair in combinations(range(len(feet)), 2) for a, b in (pair, pair[::-1])):
        along = feet[there, :2] - feet[here, :2]
        normal = np.array([-along[1], along[0]]) / (np.linalg.norm(along) or 1.0)
        beyond = (feet[:, :2] - feet[here, :2]) @ normal
        if beyond.min() > -_HARDLY and beyond.max() > _HARDLY:
            found.append(Side(feet[[here, there]], normal, (com[:, :2] - feet[here, :2]) @ normal))
    return tuple(found)


def _waved(found: Moves, measured: Sequence[tuple[Side, ...]], aim: float) -> Moves:
    steps = [
        shift_needed(np.array([side.normal for side in sides]), aim - np.array([side.inside.min() for side in sides])) for sides in measured
    ]
    return replace(found, shift=found.shift + np.array([[*step, 0.0] for step in steps]))


def shift_needed(normals: np.ndarray, short: np.ndarray) -> np.ndarray:
    """The least shift [2] (m) that moves a point `short` [e] (m) further inside of sides with unit inward normals [e,2].

    Where none does: the one after which the worst side is short by least.
    """
    pairs = [list(pair) for size in (0, 1, 2) for pair in combinations(range(len(short)), size)]
    shifts = [np.linalg.pinv(normals[pair]) @ short[pair] for pair in pairs]
    fitting = [shift for shift in shifts if (normals @ shift >= short - _HARDLY).all()]
    if fitting or len(short) < 3:
        return min(fitting or [np.zeros(2)], key=lambda shift: float(np.linalg.norm(shift)))
    return _innermost(normals, short)


def _innermost(normals: np.ndarray, short: np.ndarray) -> np.ndarray:
    """Equally short of three sides, which for some three is the best that there is."""
    rows = np.column_stack([normals, np.ones(len(short))])
    triples = [np.linalg.lstsq(rows[list(three)], short[list(three)], rcond=None)[0] for three in combinations(range(len(short)), 3)]
    best: np.ndarray = min(triples, key=lambda point: float((short - normals @ point[:2]).max()))
    return best[:2]


def _swung(found: Moves, measured: Sequence[tuple[Side, ...]], com: np.ndarray, aim: float) -> Moves:
    """Each turn goes on about the side that was the worst when it began."""
    angle, point, axis = found.angle.copy(), found.point.copy(), found.axis.copy()
    for number, (sides, path) in enumerate(zip(measured, com, strict=True)):
        chosen = _side(found, number, sides, aim)
        if chosen is None:
            continue
        sample = int(chosen.inside.argmin())
        point[number] = chosen.points[0]
        axis[number] = _axis(chosen)
        high = _height(path[sample], chosen)
        angle[number] += swing_angle(float(chosen.inside[sample]), aim, high)
    return replace(found, angle=angle, point=point, axis=axis)


def _side(found: Moves, number: int, sides: tuple[Side, ...], aim: float) -> Side | None:
    """None where the margin is kept already."""
    if found.angle[number]:
        sides = tuple(
            side for side in sides if np.array_equal(side.points[0], found.point[number]) and _axis(side) @ found.axis[number] > 0.999
        )
    lacking = [side for side in sides if side.inside.min() < aim]
    return min(lacking, key=lambda side: float(side.inside.min())) if lacking else None


def _axis(side: Side) -> np.ndarray:
    """Along the side, so that a positive turn tips what is above it inwards."""
    along = side.points[0] - side.points[1]
    unit: np.ndarray = along / np.linalg.norm(along)
    return unit


def _height(com: np.ndarray, side: Side) -> float:
    """Of the centre of mass over the side's line."""
    along = side.points[1] - side.points[0]
    share = float((com[:2] - side.points[0, :2]) @ along[:2] / (along[:2] @ along[:2]))
    return float(com[2] - side.points[0, 2] - share * along[2])


def swing_angle(inside: float, aim: float, height: float) -> float:
    """By how much a body turns about a side to bring its centre of mass, `height` (m) over it, from `inside` to `aim` (m): rad.

    arccos(inside/rho) - arccos(aim/rho), rho the distance to the line; as far as it goes where the aim is further than that.
    """
    rho = math.hypot(inside, height)
    return math.acos(inside / rho) - math.acos(min(aim / rho, 1.0))


def _bump(lift: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From 0 before a lift begins over 1 to 0, by quintics: the share of its motion with its derivatives [t]; lift [4,t]."""
    begin, start, end, rest = lift
    up, down = _step(t - begin, start - begin), _step(t - end, rest - end)
    share, rate, second = (one - other for one, other in zip(up, down, strict=True))
    return share, rate, second


def _step(t: np.ndarray, span: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    u = np.clip(t / span, 0.0, 1.0)
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2), 30.0 * (u * (1.0 - u)) ** 2 / span, 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / span**2

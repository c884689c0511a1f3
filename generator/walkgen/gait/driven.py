"""Legs of fewer than three joints, such as linkages of one drive: the foot keeps to its own path, so the drive is what is planned."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from walkgen.gait.footholds import Footholds
from walkgen.gait.motion import Motion
from walkgen.gait.pattern import Gait
from walkgen.gait.trajectory import Trajectory
from walkgen.runtime.robot import Leg, Robot

_SAMPLES = 1440
_PLACES = 181
_STEPS = 6
_SPACE = 3


class Path(NamedTuple):
    """The part of a foot's path near the ground: drive values [n] (rad) as the foot goes back, and x, y, z [n,3] (m) there."""

    drive: np.ndarray
    points: np.ndarray


class Driven(NamedTuple):
    """Of the legs that `is_driven` [nq]: joint values, rates, accelerations, 0 elsewhere."""

    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray


def is_driven(leg: Leg) -> bool:
    """Whether the leg's foot cannot be put anywhere in space; its last joint then moves it along, the others stay at 0."""
    return len(leg.joints) < _SPACE


def own_stance(robot: Robot, gait: Gait) -> Trajectory:
    """The gait with feet on the straightest strokes of their own paths.

    Raises:
        ValueError: a stroke longer than the part of a path near the ground.
    """
    strokes = [_straightest(leg, stroke) for leg, stroke in zip(robot.legs.values(), gait.ordered(tuple(robot.legs)).stroke, strict=True)]
    x, y, z = np.array(strokes).T.tolist()
    return Trajectory(gait.ordered(tuple(robot.legs)), tuple(zip(x, y, z, strict=True)), 0.0)


def _straightest(leg: Leg, stroke: float) -> tuple[float, float, float]:
    """The middle of the stroke that is most nearly level."""
    x, y, z = path(leg).points.T
    room = float(x[0] - x[-1]) - stroke
    if room < 0.0:
        raise ValueError(f"{leg.name}: its foot goes back for {room + stroke:.4g} m; a stroke of {stroke:.4g} m is {-room:.4g} m longer")
    centres = x[-1] + 0.5 * stroke + room * np.linspace(0.0, 1.0, _PLACES)
    inside = [np.abs(x - centre) <= 0.5 * stroke for centre in centres]
    best = min(range(_PLACES), key=lambda number: float(np.ptp(z[inside[number]], axis=0)) if inside[number].any() else np.inf)
    return float(centres[best]), float(y[inside[best]].mean()), float(0.5 * (z[inside[best]].max() + z[inside[best]].min()))


def path(leg: Leg) -> Path:
    """Where the foot goes back next to its lowest point, in its platform's frame."""
    drive = np.linspace(0.0, 2.0 * np.pi, _SAMPLES, endpoint=False)
    points = leg.foot_position(_joints(leg, drive))
    lowest = int(np.nanargmin(points[:, 2]))
    points, drive = np.tile(points, (3, 1)), np.concatenate([drive - 2.0 * np.pi, drive, drive + 2.0 * np.pi])
    lowest += _SAMPLES
    if points[lowest + 1, 0] > points[lowest, 0]:
        points, drive, lowest = points[::-1], drive[::-1], 3 * _SAMPLES - 1 - lowest
    turns = np.flatnonzero(~(np.diff(points[:, 0]) < 0.0))
    first, last = int(turns[turns < lowest].max()) + 1, int(turns[turns >= lowest].min())
    return Path(drive[first : last + 1], points[first : last + 1])


def _joints(leg: Leg, drive: np.ndarray) -> np.ndarray:
    q = np.zeros((*drive.shape, len(leg.joints)))
    q[..., -1] = drive
    return q


def driven(robot: Robot, footholds: Footholds, body: Callable[[np.ndarray], Motion], t: np.ndarray) -> Driven:
    """Drives that keep every supporting foot over its foothold along x, and run on smoothly to the next one in between.

    Across and upwards the foot is where its path is.

    Args:
        robot: with `foot_position`, `foot_jacobian` and `foot_bias_acceleration` of such legs, which are on its first platform.
        footholds: of the feet.
        body: motion of the first platform at times.
        t: instants [t] (s).
    """
    found = Driven(*np.zeros((3, len(t), len(robot.joint_names))))
    for foot, leg in enumerate(robot.legs.values()):
        if is_driven(leg):
            joint = leg.slice.stop - 1
            for part, values in zip(found, _drive(leg, foot, footholds, body, t), strict=True):
                part[:, joint] = values
    return found


def _drive(leg: Leg, foot: int, footholds: Footholds, body: Callable[[np.ndarray], Motion], t: np.ndarray) -> np.ndarray:
    """Drive value, rate and acceleration [3,t]."""
    along, gait = path(leg), footholds.trajectory.gait
    turn = 2.0 * np.pi * float(np.sign(along.drive[-1] - along.drive[0]))
    number, _ = footholds.support(t)
    u = gait.leg_phase(t)[:, foot]
    m, duty, period = number[:, foot], gait.duty_factor[foot], gait.period
    moves = ~footholds.skipped[foot]
    turns = turn * np.concatenate([[0], np.cumsum(moves)[:-1]])
    stands = (u < duty) | ~moves[m]
    placed = t - u * period

    def at(times: np.ndarray, support: np.ndarray) -> np.ndarray:
        return _over(leg, along, body(times), footholds.points[foot, support])

    there, start, end = at(t, m), at(placed + duty * period, m), at(placed + period, m + 1)
    there[0] += turns[m]
    start[0] += turns[m]
    end[0] += turns[m + 1]
    moving = _between(start, end, (u - duty) / (1.0 - duty), (1.0 - duty) * period)
    return np.where(stands, there, moving)


def _over(leg: Leg, along: Path, motion: Motion, point: np.ndarray) -> np.ndarray:
    """Drive value, rate and acceleration [3,t] with the foot over a point at rest [t,3], along x."""
    none = np.zeros_like(point)[:, None]
    x, rate, second = (part[:, 0, 0] for part in motion.seen(point[:, None], none, none))
    drive = np.interp(-x, -along.points[:, 0], along.drive)
    for _ in range(_STEPS):
        q = _joints(leg, drive)
        drive = drive - (leg.foot_position(q)[:, 0] - x) / leg.foot_jacobian(q)[:, 0, -1]
    q = _joints(leg, drive)
    slope = leg.foot_jacobian(q)[:, 0, -1]
    speed = rate / slope
    bias = leg.foot_bias_acceleration(q, _joints(leg, speed))[:, 0]
    return np.array([drive, speed, (second - bias) / slope])


def _between(start: np.ndarray, end: np.ndarray, s: np.ndarray, span: float) -> np.ndarray:
    """The quintic with these values, rates and accelerations [3,t] at both ends, at the share s [t] of a span (s)."""
    scale = np.array([1.0, span, span**2])[:, None]
    (p0, v0, a0), (p1, v1, a1) = start * scale, end * scale
    c3, c4, c5 = np.linalg.inv([[1, 1, 1], [3, 4, 5], [6, 12, 20]]) @ np.array([p1 - p0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0])
    value = p0 + s * (v0 + s * (a0 / 2 + s * (c3 + s * (c4 + s * c5))))
    rate = v0 + s * (a0 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))
    second = a0 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))
    moving: np.ndarray = np.array([value, rate, second]) / scale
    return moving

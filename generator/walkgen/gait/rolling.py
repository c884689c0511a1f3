"""Legs with curved soles: each foot stands flat, rolls over its toe in the last part of its support, and turns back on its way.

The foot's angle is planned; where the sole rolls without slipping gives the ankle, and hip and ankle the joints.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from walkgen.gait.footholds import Footholds
from walkgen.gait.motion import Motion
from walkgen.runtime.robot import Leg, Robot
from walkgen.runtime.solves.gait import gait_step
from walkgen.signature import STATUSES

_OK = STATUSES.index("OK")
FLAT = -0.5 * np.pi
"""A foot's angle (rad)."""
_ROLL = 0.7
"""How far, of what the toe's curve allows."""
_STEADY = 0.9
"""Of the way that a platform goes in half a support of a steady walk."""
_KNEE = 1
_LOOKS = 721
Rows = np.ndarray


class Rolled(NamedTuple):
    """Of the legs that `is_rolling`: joint values, rates, accelerations [t,nq], 0 elsewhere; and every leg's status [t,k]."""

    q: Rows
    qd: Rows
    qdd: Rows
    status: Rows


def is_rolling(leg: Leg) -> bool:
    """Whether the leg has a sole with a toe to roll over."""
    return "toe_rolling" in leg.functions


def rolled(robot: Robot, footholds: Footholds, body: Callable[[Rows], Motion], t: Rows) -> Rolled:
    """Joint motions that keep every supporting sole on the ground, flat and then rolling, and lead it to the next foothold in between.

    Args:
        robot: with the functions of such legs, whose planes are along its first platform's x and z.
        footholds: below the ankles of flat feet, on a plane.
        body: motion of the first platform at times, which keeps its z along the plane's normal and does not turn.
        t: instants [t] (s).
    """
    none = np.zeros((len(t), len(robot.joint_names)))
    found = Rolled(none, none.copy(), none.copy(), np.zeros((len(t), len(robot.legs)), np.int32))
    for foot, leg in enumerate(robot.legs.values()):
        if is_rolling(leg):
            joints = slice(leg.slice.stop - 3, leg.slice.stop)
            *parts, found.status[:, foot] = _joints(leg, foot, footholds, body, t)
            for whole, part in zip(found[:3], parts, strict=True):
                whole[:, joints] = part
    return found


def _joints(leg: Leg, foot: int, footholds: Footholds, body: Callable[[Rows], Motion], t: Rows) -> tuple[Rows, ...]:
    """q, qd, qdd [t,3] and status [t]."""
    gait = footholds.trajectory.gait
    number, support = footholds.support(t)
    u, duty = gait.leg_phase(t)[:, foot], gait.duty_factor[foot]
    stays = footholds.skipped[foot, number[:, foot]]
    motion = body(t)
    axes = motion.rotation[0]
    here, there = (footholds.points[foot, number[:, foot] + step] @ axes for step in (0, 1))
    stands = support[:, foot] | stays
    end = np.where(_steady(foot, footholds, body, axes[:, 0])[number[:, foot]], FLAT + _ROLL * (_limit(leg) - FLAT), FLAT)
    angle = _planned(np.where(stays, 0.0, u), duty, gait.period, end, footholds.trajectory.heel_off)
    last = _on_toe(leg, np.array([end, 0.0 * end, 0.0 * end]))[0]
    share = np.clip((u - duty) / (1.0 - duty), 0.0, 1.0)
    over = last - [0.0, _height(leg)]
    moving = _carried(share, 1.0 / ((1.0 - duty) * gait.period), footholds.trajectory.lift, here[:, [0, 2]] + over, there[:, [0, 2]])
    moving[0, :, 1] += _height(leg)
    ankle = np.where(stands[None, :, None], _placed(here, _on_toe(leg, angle)), moving)
    at, velocity, acceleration = motion.seen(*(_spread(part) @ axes.T for part in ankle))
    away = np.stack([part[:, 0][:, [0, 2]] for part in (at, velocity, acceleration)], 1)
    relative = -away
    relative[:, 0] += _hip(leg)
    relative[:, 0, 1] += _height(leg)
    links, status = leg.flat_motion(relative, 0.0, _KNEE)
    links = np.concatenate([links[:, :, :2], angle.T[:, :, None]], axis=2)
    zero = leg.joint_angles(np.zeros(3))
    q, qd, qdd = (leg.joint_angles(np.ascontiguousarray(links[:, order])) for order in range(3))
    return q, qd - zero, qdd - zero, status


def _spread(part: Rows) -> Rows:
    """Points of one foot [t,2] along the platform's x and z as [t,1,3]; sideways the foothold does not matter."""
    return np.stack([part[:, 0], np.zeros(len(part)), part[:, 1]], -1)[:, None]


def _steady(foot: int, footholds: Footholds, body: Callable[[Rows], Motion], forward: Rows) -> Rows:
    """Of every support of a foot [m]: whether the platform gets about as far ahead of it as in a steady walk.

    Else, next to a walk's ends, the load is not yet ahead of the toe when the heel would be off the ground: the foot is lifted flat.
    """
    gait, count = footholds.trajectory.gait, footholds.points.shape[1]
    half = 0.5 * gait.duty_factor[foot] * gait.period
    middle = (footholds.first + np.arange(count) + gait.phase[foot]) * gait.period + half
    ahead = (body(middle + half).position - body(middle).position) @ forward
    steady: Rows = ahead > _STEADY * gait.speed * half
    return steady


def _planned(u: Rows, duty: float, period: float, end: Rows, heel_off: float) -> Rows:
    """The foot's angle with rate and acceleration [3,t], by where its roll ends [t]."""
    rest = np.zeros_like(u)
    start, off = heel_off * duty, duty
    flat = np.array([FLAT + rest, rest, rest])
    rolling = _eased((u - start) / (off - start), (off - start) * period, flat[0], end)
    turning = _eased((u - off) / (1.0 - off), (1.0 - off) * period, end, flat[0])
    return np.where(u < start, flat, np.where(u < off, rolling, turning))


def _eased(share: Rows, span: float, start: Rows, end: Rows) -> Rows:
    """From rest to rest, with rate and acceleration [3,t]."""
    there = np.clip(share, 0.0, 1.0)
    first, last = (np.stack([angle] * 3, -1) for angle in (start, end))
    moving = gait_step(there, np.full(len(there), 1.0 / span), 0.0, first, last)
    return np.array([part[:, 0] for part in moving])


def _limit(leg: Leg) -> float:
    """The angle beyond which the foot has no more toe to roll over."""
    angles = np.linspace(FLAT, -1.5 * np.pi, _LOOKS)
    links = np.stack([np.full(_LOOKS, FLAT), np.full(_LOOKS, FLAT), angles], -1)
    status = leg.hip_position(links, 0.0)[-1]
    beyond = np.flatnonzero(status != _OK)
    return float(angles[beyond[0] - 1] if len(beyond) else angles[-1])


def _on_toe(leg: Leg, angle: Rows) -> Rows:
    """The ankle over a foothold at 0 with rate and acceleration [3,t,2], by the foot's angle with those [3,t]."""
    rest = np.full(angle.shape[1], FLAT)
    _, phase, contact, ankle, _, _ = leg.hip_position(np.stack([rest, rest, np.minimum(angle[0], FLAT)], -1), 0.0)
    rolls = phase == 1
    turning, _, _, by_contact = leg.toe_rolling(contact, _edge(leg))
    rate = np.where(rolls, angle[1] / turning[:, 1], 0.0)[:, None]
    second = np.where(rolls, (angle[2] - turning[:, 2] * rate[:, 0] ** 2) / turning[:, 1], 0.0)[:, None]
    return np.stack([ankle, by_contact[:, 1] * rate, by_contact[:, 2] * rate**2 + by_contact[:, 1] * second])


def _edge(leg: Leg) -> float:
    """How far the flat part goes ahead of the ankle (m): where the foot touches the ground once it is a little turned."""
    flat = np.array([FLAT, FLAT, FLAT])
    turned = flat - [0.0, 0.0, 1e-7]
    return float(leg.hip_position(turned, 0.0)[4][0])


def _hip(leg: Leg) -> Rows:
    """Where the hip is in the platform's x and z (m)."""
    angles = np.full(3, FLAT)
    q = np.zeros(len(leg.joints))
    q[-3:] = leg.joint_angles(angles)
    hip, _, _, _, point, _ = leg.hip_position(angles, 0.0)
    found: Rows = leg.foot_position(q)[[0, 2]] + hip - point
    return found


def _height(leg: Leg) -> float:
    """Of a flat foot's ankle (m)."""
    return float(leg.hip_position(np.full(3, FLAT), 0.0)[3][1])


def _placed(foothold: Rows, ankle: Rows) -> Rows:
    """[3,t,2] along the platform's x and z: over footholds at rest [t,3]."""
    placed = ankle.copy()
    placed[0] += foothold[:, [0, 2]]
    return placed


def _carried(share: Rows, rate: float, lift: float, start: Rows, end: Rows) -> Rows:
    """A point on its way, along the platform's x and z, with rates and accelerations [3,t,2]."""
    begin, there = (np.stack([place[:, 0], np.zeros(len(place)), place[:, 1]], -1) for place in (start, end))
    return np.stack([part[:, [0, 2]] for part in gait_step(share, np.full(len(share), rate), lift, begin, there)])

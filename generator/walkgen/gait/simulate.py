"""Simulates a walk: the platform's motion, footholds, chains and legs for all instants by few calls of generated functions."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from walkgen.gait import balance
from walkgen.gait.carried import Moving, carried
from walkgen.gait.chains import Bending, Rest, adapted, held
from walkgen.gait.course import Course, Pace, course
from walkgen.gait.driven import driven, is_driven
from walkgen.gait.faults import Fault, worst
from walkgen.gait.footholds import Footholds, place
from walkgen.gait.ground import Ground, Slope
from walkgen.gait.legs import missing, postures
from walkgen.gait.motion import Motion, composed
from walkgen.gait.planned import is_planned
from walkgen.gait.power import Power
from walkgen.gait.rates import rates
from walkgen.gait.rolling import is_rolling, rolled
from walkgen.gait.rolling_ground import hindrances
from walkgen.gait.standing import crowd
from walkgen.gait.steps import Standing, Steps, place_steps
from walkgen.gait.trajectory import FootMotion, Trajectory
from walkgen.gait.walk import Walk
from walkgen.runtime.robot import Robot
from walkgen.signature import STATUSES

_SINGULAR, _UNREACHABLE = STATUSES.index("SINGULAR"), STATUSES.index("UNREACHABLE")
_REACHED = 1e-9
_WITHIN = 1e-9
_TOUCHED = 1e-6
"""Slacks of footholds (m), of limits and speeds, and of feet that touch the ground (m)."""


@dataclass(frozen=True)
class Options:
    """How to walk.

    Attributes:
        cycles: how many periods.
        rate: instants in a second.
        from_rest: start and stop in a period each, all feet on the ground at both ends; else steadily.
        adapt: connecting chains are adapted to the footholds; else held straight.
        body: level, waved (shifts before a leg lifts) or swinging (turns about a side of the support polygon).
        static: the margin is that of the centre of mass, as if nothing moved; else that of the load with its inertia.
        margin: the least stability margin (m); 0 is the border of falling.
        max_speed: of joints [nq] (rad/s, m/s); infinite where unknown.
        units: of joints [nq], rad or m; rad where left out.
        mu: coefficient of friction; where left out the ground's, 0.7 where that is not known.
        heading: of the course (rad).
        give: how far ground and feet yield, so that a foot with a path of its own may be so far off its foothold (m).
    """

    cycles: int = 3
    rate: float = 100.0
    from_rest: bool = False
    adapt: bool = False
    body: Literal["level", "waved", "swinging"] = "level"
    static: bool = True
    margin: float = 0.0
    max_speed: tuple[float, ...] = ()
    units: tuple[str, ...] = ()
    mu: float | None = None
    heading: float = 0.0
    give: float = 0.0


_LEVEL, _STEADILY = Slope(), Options()


class Plan(NamedTuple):
    """What a walk follows: footholds and the first platform's motion by time, and when it rests."""

    footholds: Standing
    body: Callable[[np.ndarray], Motion]
    rest: Rest = None


class State(NamedTuple):
    """Of a plan at some instants."""

    motion: Motion
    feet: FootMotion
    support: np.ndarray
    bending: Bending
    q: np.ndarray
    status: np.ndarray
    com: np.ndarray


def simulate(robot: Robot, trajectory: Trajectory | Steps, ground: Ground = _LEVEL, options: Options = _STEADILY) -> Walk:
    """Walk a robot over a ground, from the origin along `heading`.

    The platform keeps the gait's speed along its course, whose height and inclination follow the ground under the stance; feet stand
    where their stance points are in the middle of a support, and stay there exactly. A list of events is walked once, from rest to rest.

    Args:
        robot: loaded; its z is up at rest.
        trajectory: gait, stance and lift; or a list of events with them.
        ground: level where left out.
        options: how to walk.

    Raises:
        ValueError: no cycle, or a rate that is not more than 0; a list of events for legs with paths of their own, or one that leaves a
            body no time; soles that roll on what is no plane, or under a platform that turns or shifts; more corners of soles that
            support at once than contact forces have room for.
    """
    if options.cycles < 1 or not options.rate > 0.0:
        raise ValueError(f"{options.cycles} cycles at {options.rate:g} instants a second: one and more than 0 are needed")
    trajectory = trajectory.ordered(tuple(robot.legs))
    if isinstance(trajectory, Steps) and any(map(is_planned, robot.legs.values())):
        raise ValueError("legs with a path of their own, or that roll on their soles, walk in cycles, not by a list of events")
    if options.body != "level" and any(map(is_rolling, robot.legs.values())):
        raise ValueError("legs that roll on their soles step in planes of their own, and keep the platform level")
    if options.body != "level":
        trajectory = balance.with_room(trajectory)
    plan = planned(trajectory, ground, options)
    if isinstance(plan.footholds, Footholds):
        for hindrance in hindrances(robot, plan.footholds, plan.body, ground, instants(trajectory, options)):
            raise ValueError(hindrance)
    times = instants(trajectory, options)
    if crowded := crowd(robot, plan.footholds.motion(times)[1], times):
        raise ValueError(crowded)
    if options.body != "level":
        plan = _balanced(robot, plan, options, options.body)
    return _walk(robot, plan, ground, options, times)


def instants(trajectory: Trajectory | Steps, options: Options) -> np.ndarray:
    """The instants of a walk [t] (s), both ends included."""
    if isinstance(trajectory, Steps):
        start, end = trajectory.start, trajectory.end
    else:
        start, end = 0.0, options.cycles * trajectory.gait.period
    return np.linspace(start, end, math.ceil((end - start) * options.rate) + 1)


def planned(trajectory: Trajectory | Steps, ground: Ground, options: Options) -> Plan:
    """Course and footholds."""
    if isinstance(trajectory, Steps):
        return _listed(trajectory, ground, options)
    gait = trajectory.gait
    pace = Pace(gait.speed, options.cycles * gait.period, min(1.0, options.cycles / 2) * gait.period if options.from_rest else 0.0)
    path = course(ground, np.array(trajectory.stance), gait.stride, gait.stride * options.cycles, options.heading)
    return Plan(place(trajectory, path, pace, ground), _along(path, pace), (0.0, pace.duration) if options.from_rest else None)


def _listed(steps: Steps, ground: Ground, options: Options) -> Plan:
    pace = Pace(steps.speed, steps.end - steps.start, steps.ramp)
    stride = steps.stride / max(map(len, steps.supports))
    path = course(ground, np.array(steps.stance), stride, steps.stride, options.heading)
    return Plan(place_steps(steps, path, pace, ground), _along(path, pace, steps.start), (steps.start, steps.end))


def _along(path: Course, pace: Pace, start: float = 0.0) -> Callable[[np.ndarray], Motion]:
    return lambda t: path.at(pace.at(t - start))


def state(robot: Robot, plan: Plan, adapt: bool, times: np.ndarray) -> State:
    """Where everything is at these instants."""
    motion = plan.body(times)
    feet, support = plan.footholds.motion(times)
    bending = adapted(robot, plan.footholds, plan.body, times, plan.rest) if adapt and robot.chains else held(robot, times)
    led = [foot for foot, leg in enumerate(robot.legs.values()) if is_driven(leg)]
    if led and isinstance(plan.footholds, Footholds):
        drives = driven(robot, plan.footholds, plan.body, times)
        bending = Bending(bending.q + drives.q, bending.qd + drives.qd, bending.qdd + drives.qdd, bending.failed)
    rolls = [foot for foot, leg in enumerate(robot.legs.values()) if is_rolling(leg)]
    status = np.zeros(support.shape, np.int32)
    if rolls and isinstance(plan.footholds, Footholds):
        turned = rolled(robot, plan.footholds, plan.body, times)
        bending = Bending(bending.q + turned.q, bending.qd + turned.qd, bending.qdd + turned.qdd, bending.failed)
        status = turned.status
    found = postures(robot, motion.inward(feet.position - motion.position[:, None]), bending.q)
    found = found._replace(status=np.where(status == 0, found.status, status))
    if led or rolls:
        feet = _on_their_way(robot, motion, feet, support, (led, rolls), found.q)
    has_mass = hasattr(robot, "com")
    com = robot.com(motion.pose, found.q) if has_mass else np.full((len(times), 3), np.nan)
    return State(motion, feet, support, bending, found.q, found.status, com)


def _on_their_way(
    robot: Robot, motion: Motion, feet: FootMotion, support: np.ndarray, which: tuple[list[int], list[int]], q: np.ndarray
) -> FootMotion:
    """The feet: in transfer those with a path of their own where it takes them, those that roll too; in support these but sideways."""
    position, (led, rolls) = feet.position.copy(), which
    own = motion.position[:, None] + motion.outward(robot.foot_positions(q))
    position[:, led] = np.where(support[:, led, None], position[:, led], own[:, led])
    across = motion.rotation[:, None, :, 1]
    beside = np.where(support, ((feet.position - own) * across).sum(axis=-1), 0.0)[..., None] * across
    position[:, rolls] = np.where(np.isfinite(own[:, rolls]), (own + beside)[:, rolls], position[:, rolls])
    return feet._replace(position=position)


def _balanced(robot: Robot, plan: Plan, options: Options, body: Literal["waved", "swinging"]) -> Plan:
    """The plan with the shifts or turns of the platform that keep the margin."""

    def com(candidate: Callable[[np.ndarray], Motion], times: np.ndarray) -> np.ndarray:
        return state(robot, plan._replace(body=candidate), options.adapt, times).com

    moves = balance.moves(plan.footholds, plan.body, com, body, options.margin, options.cycles)
    return plan._replace(body=lambda t: composed(moves(t), plan.body(t)))


def _walk(robot: Robot, plan: Plan, ground: Ground, options: Options, times: np.ndarray) -> Walk:
    now = state(robot, plan, options.adapt, times)
    seen = now.motion.seen(*now.feet)
    qd, qdd = rates(robot, now.q, now.bending, seen[1], seen[2])
    feet = now.motion.position[:, None] + now.motion.outward(robot.foot_positions(now.q))
    moving = Moving(robot, now.motion, now.q, (qd, qdd), now.feet.position, now.support)
    stands, stable, cost = carried(moving, now.com, ground, options.heading, options.mu)
    return Walk(
        robot=robot.name,
        legs=tuple(robot.legs),
        joints=robot.joint_names,
        trajectory=plan.footholds.trajectory,
        times=times,
        base_pose=now.motion.pose,
        q=now.q,
        qd=qd,
        qdd=qdd,
        stance=now.support,
        standing=stands,
        feet=feet,
        targets=now.feet.position,
        statuses=now.status,
        com=now.com,
        margins=stable,
        static=options.static,
        holds=plan.footholds.holds(float(times[-1])),
        power=cost,
        faults=tuple(_faults(robot, now, qd, ground, options, times, stable.static if options.static else stable.dynamic, cost)),
    )


def _faults(
    robot: Robot,
    now: State,
    qd: np.ndarray,
    ground: Ground,
    options: Options,
    times: np.ndarray,
    margin: np.ndarray,
    cost: Power | None,
) -> Iterator[Fault]:
    legs, joints = tuple(robot.legs), robot.joint_names
    point = now.feet.position
    nowhere = np.isnan(point).any(axis=-1)
    yield from worst("ground", legs, times, np.where(nowhere, np.inf, np.nan), "m", 0.0)
    away = missing(robot, now.motion.inward(point - now.motion.position[:, None]), now.q)
    own = np.array([is_driven(leg) for leg in robot.legs.values()])
    lost = now.status == _UNREACHABLE
    away = np.where(lost & np.isnan(away), np.inf, away)
    yield from worst("reach", legs, times, np.where(own, np.nan, away), "m", _REACHED)
    yield from worst("off", legs, times, np.where(own, away, np.nan), "m", max(options.give, _REACHED))
    yield from worst("singular", legs, times, np.where(now.status == _SINGULAR, np.inf, np.nan), "m", 0.0)
    deep = np.where(now.support, np.nan, ground.height(point[..., 0], point[..., 1]) - point[..., 2])
    yield from worst("through", legs, times, deep, "m", max(options.give, _TOUCHED))
    units = options.units or ("rad",) * len(joints)
    beyond = np.maximum(robot.limits[:, 0] - now.q, now.q - robot.limits[:, 1])
    yield from worst("limit", joints, times, beyond, units, _WITHIN)
    if options.max_speed:
        yield from worst("speed", joints, times, np.abs(qd) - options.max_speed, [f"{unit}/s" for unit in units], _WITHIN)
    if len(now.bending.failed):
        share = len(now.bending.failed) / len(times)
        yield Fault("chains", "chains", float(now.bending.failed[0]), math.nan, "m", share)
    if not hasattr(robot, "com"):
        yield Fault("mass", robot.platforms[0], 0.0, math.nan, "kg", 1.0)
    if cost is not None:
        yield from worst("carry", (robot.platforms[0],), times, np.where(cost.overcome, np.inf, np.nan)[:, None], "N", 0.0)
    yield from worst("margin", (robot.platforms[0],), times, (options.margin - margin)[:, None], "m", _WITHIN)

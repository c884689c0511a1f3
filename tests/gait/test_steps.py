"""Walks by lists of events: every step where and when it is listed, from rest to rest, without jumps, chains adapted, margins kept."""

import numpy as np
import pytest

from walkgen.gait.ground import Relief, Slope
from walkgen.gait.pattern import Event
from walkgen.gait.schedule import Schedule
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.steps import Steps
from walkgen.walking import walked
from walkgen.walking_request import Wanted

HILLS = Relief(lambda x, y: 0.02 * np.sin(3 * x) + 0.03 * x * y)
STANCE = ((0.0, 0.35, -0.3), (0.0, -0.35, -0.3), (-0.6, 0.35, -0.3), (-0.6, -0.35, -0.3))
EVENTS = (
    *(("front_left", 0.5, 1.0), ("rear_right", 1.5, 2.25), ("front_right", 3.0, 3.5)),
    *(("front_left", 4.0, 4.5), ("rear_left", 5.0, 6.0)),
)
"""As in duo.toml."""


@pytest.fixture(scope="module")
def robot(duo):
    return walked(duo, Wanted(cycles=1, rate=10.0)).robot


@pytest.fixture(scope="module")
def steps(robot):
    found = tuple(event for leg, up, down in EVENTS for event in (Event(up, leg, "lift"), Event(down, leg, "place")))
    return Steps(Schedule(tuple(robot.legs), found), STANCE, 0.05, 0.2)


@pytest.fixture(
    scope="module", params=[(HILLS, {}), (HILLS, {"adapt": True, "heading": 0.5}), (Slope(0.1), {"body": "waved", "margin": 0.03})]
)
def case(request, robot, steps):
    ground, options = request.param
    return robot, ground, options, simulate(robot, steps, ground, Options(**options))


def test_the_spec_says_the_same(duo, steps):
    walk = walked(duo, Wanted(gait="steps", terrain="flat", rate=20.0)).walk
    assert walk.trajectory == steps
    assert walk.times[[0, -1]].tolist() == [0.0, 6.0]
    assert "10 events, 0.2 m in 6 s" in walk.trajectory.summary


def test_feet_stand_but_for_their_steps(case):
    robot, ground, _, walk = case
    names = tuple(robot.legs)
    for foot, leg in enumerate(names):
        up = np.zeros(len(walk.times), bool)
        for name, lifted, placed in EVENTS:
            if name == leg:
                up |= (walk.times >= lifted - 1e-12) & (walk.times < placed - 1e-12)
        np.testing.assert_array_equal(walk.stance[:, foot], ~up)
        holds = walk.holds.point[walk.holds.leg == foot]
        assert len(holds) == 1 + sum(name == leg for name, *_ in EVENTS)
        away = np.linalg.norm(walk.feet[~up, foot][:, None] - holds, axis=-1).min(axis=1)
        assert away.max() < 1e-9
    assert walk.slip < 1e-9
    x, y, z = np.moveaxis(walk.feet, -1, 0)
    above = z - ground.height(x, y)
    assert np.abs(above[walk.stance]).max() < 1e-9
    assert above.min() > -1e-9
    assert above[~walk.stance].max() > 0.045


def test_rates_are_derivatives_and_begin_and_end_at_rest(case):
    robot, ground, options, walk = case
    fine = simulate(robot, walk.trajectory, ground, Options(**options, rate=800.0))
    step = fine.times[1] - fine.times[0]
    assert np.abs((fine.q[2:] - fine.q[:-2]) / (2 * step) - fine.qd[1:-1]).max() < 1e-3 * np.abs(fine.qd).max()
    assert np.abs(np.diff(fine.qd, axis=0)).max() < 1.1 * np.abs(fine.qdd).max() * step
    if not options.get("body"):
        assert np.abs(walk.qd[[0, -1]]).max() < 1e-9
    way = walk.base_pose[-1, :3, 3] - walk.base_pose[0, :3, 3]
    heading = options.get("heading", 0.0)
    if not options.get("body"):
        assert way[:2] @ [np.cos(heading), np.sin(heading)] == pytest.approx(0.2, abs=2e-3)  # along the hills


def test_a_body_keeps_the_margin_of_every_step(robot, steps):
    level = simulate(robot, steps, Slope(), Options())
    assert {fault.kind for fault in level.faults} >= {"margin"}
    for body in ("waved", "swinging"):
        walk = simulate(robot, steps, Slope(), Options(body=body, margin=0.03))
        assert walk.feasible, "\n".join(map(str, walk.faults))
        assert walk.least_margin >= 0.03


def test_lists_that_are_no_walk():
    with pytest.raises(ValueError, match="a walk by events has some"):
        Steps(Schedule(("a", "b"), ()), ((0.0, 0.0, 0.0),) * 2, 0.1)
    with pytest.raises(ValueError, match="a: in transfer at the end"):
        Steps(Schedule(("a", "b"), (Event(0.5, "a", "lift"),)), ((0.0, 0.0, 0.0),) * 2, 0.1)
    with pytest.raises(ValueError, match="b: in transfer at the start"):
        Steps(Schedule(("a", "b"), (Event(0.5, "b", "place"),), ("b",)), ((0.0, 0.0, 0.0),) * 2, 0.1)
    with pytest.raises(ValueError, match="stance has shape"):
        Steps(Schedule(("a", "b"), (Event(0.5, "a", "lift"), Event(1.0, "a", "place"))), ((0.0, 0.0, 0.0),), 0.1)
    pairs = (("a", 0.0, 1.0), ("b", 1.25, 2.0))
    events = tuple(event for leg, up, down in pairs for event in (Event(up, leg, "lift"), Event(down, leg, "place")))
    crowded = Steps(Schedule(("a", "b"), events), ((0.0, 0.0, 0.0),) * 2, 0.1)
    with pytest.raises(ValueError, match=r"b is lifted at 1\.25 s, 0\.25 s after the last foot was placed"):
        crowded.refuse_crowded(0.5)
    crowded.refuse_crowded(0.3)
    assert crowded.ordered(("b", "a")).schedule.legs == ("b", "a")
    with pytest.raises(ValueError, match="the gait's legs are a, b"):
        crowded.ordered(("a", "c"))

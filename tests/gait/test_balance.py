"""Waved and swinging bodies: the section-5 shift and turn, and walks that keep their margin by them."""

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

from walkgen.gait import balance
from walkgen.gait.ground import Slope
from walkgen.gait.simulate import Options, simulate
from walkgen.gait.standard import crawl, trot
from walkgen.gait.trajectory import Trajectory
from walkgen.walking import walked
from walkgen.walking_request import Wanted

SIDES = ("fl", "rl"), ("fr", "rr")


def test_oracle_o17():
    """Feet (+-.35, +-.3), G = (.03, 0, .4), front left lifted: theory note, O17."""
    front_right, rear_left = np.array([0.35, -0.3]), np.array([-0.35, 0.3])
    along = rear_left - front_right
    normal = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    inside = float(normal @ ([0.03, 0.0] - front_right))
    assert inside == pytest.approx(-0.019523741203679, abs=1e-14)
    shift = balance.shift_needed(normal[None], np.array([0.05 - inside]))
    np.testing.assert_allclose(shift, [-0.04524545102573959, -0.05278635953002952], atol=1e-15)
    assert balance.swing_angle(inside, 0.05, 0.4) == pytest.approx(0.17394867401916714, abs=1e-14)


def test_shift_is_the_least_that_is_enough():
    """Against scipy, over random sides: least squares where some shift is enough, the least shortfall by a linear program elsewhere."""
    rng = np.random.default_rng(3)
    enough = []
    for _ in range(40):
        angles = rng.uniform(0, 2 * np.pi, 3)
        normals, short = np.stack([np.cos(angles), np.sin(angles)], axis=-1), rng.uniform(-0.1, 0.3, 3)
        found = balance.shift_needed(normals, short)
        shortfall = linprog([0, 0, 1], -np.column_stack([normals, np.ones(3)]), -short, bounds=[(-9, 9), (-9, 9), (0, None)]).fun
        assert max((short - normals @ found).max(), 0.0) == pytest.approx(shortfall, abs=1e-8)
        enough.append(shortfall < 1e-12)
        if enough[-1]:
            rules = {"type": "ineq", "fun": lambda d, n=normals, s=short: n @ d - s}
            best = minimize(lambda d: d @ d, found + 0.1, constraints=[rules], method="SLSQP", options={"ftol": 1e-14, "maxiter": 200}).x
            assert np.linalg.norm(found) <= np.linalg.norm(best) + 1e-6
    assert 5 < sum(enough) < 35


def test_pauses_leave_transfers_and_stride_as_they_are():
    before = Trajectory(crawl(*SIDES, period=2.0, stride=0.3), ((0.0, 0.0, 0.0),) * 4, 0.05)
    after = balance.with_pauses(before).gait
    air = (1 - np.array(after.duty_factor)) * after.period
    np.testing.assert_allclose(air, 0.5)
    assert after.stride == 0.3
    assert [event.leg for event in after.events if event.does == "lift"] != []
    downs = [len(span.supporting) for span in after.spans]
    assert downs.count(4) == 4
    pauses = [span.end - span.start for span in after.spans if len(span.supporting) == 4]
    np.testing.assert_allclose(np.array(pauses) * after.period, 0.75)
    order = [[event.leg for event in gait.events if event.does == "lift"] for gait in (before.gait, after)]
    start = order[1].index(order[0][0])
    assert order[1][start:] + order[1][:start] == order[0]
    assert balance.with_pauses(Trajectory(after, before.stance, 0.05)).gait.period == pytest.approx(after.period)


def test_a_body_cannot_help_two_legs_at_once():
    with pytest.raises(ValueError, match="one at a time"):
        balance.with_pauses(Trajectory(trot(*SIDES, stride=0.1), ((0.0, 0.0, 0.0),) * 4, 0.05))


@pytest.fixture(scope="module")
def robot(duo):
    return walked(duo, Wanted(cycles=1, rate=10.0)).robot


@pytest.mark.parametrize(("body", "margin"), [("waved", 0.05), ("swinging", 0.03)])
@pytest.mark.parametrize("slope", [0.0, 6.0])
def test_the_margin_that_is_asked_for_holds(robot, body, margin, slope):
    trajectory, ground = Trajectory.of(robot.gaits["crawl"]), Slope(np.radians(slope))
    level = simulate(robot, trajectory, ground, Options(rate=50.0))
    assert level.least_margin < 0.0
    walk = simulate(robot, trajectory, ground, Options(body=body, margin=margin, rate=50.0))
    assert walk.feasible
    assert margin <= walk.least_margin < margin + 2e-3
    assert walk.slip < 1e-12


def test_a_swinging_body_turns_and_a_waved_one_does_not(robot):
    trajectory = Trajectory.of(robot.gaits["crawl"])
    waved, swung = (simulate(robot, trajectory, Slope(), Options(body=body, margin=0.03)) for body in ("waved", "swinging"))
    assert np.ptp(waved.base_pose[:, 1, 3]) > 0.03
    np.testing.assert_allclose(waved.base_pose[:, :3, :3], np.broadcast_to(np.eye(3), (len(waved.times), 3, 3)), atol=1e-12)
    assert np.abs(swung.base_pose[:, 2, :2]).max() > 0.05


def test_a_margin_that_no_polygon_has_is_reported(robot):
    walk = simulate(robot, Trajectory.of(robot.gaits["crawl"]), Slope(), Options(body="waved", margin=0.5, rate=50.0))
    assert any(fault.kind == "margin" and fault.amount > 0.2 for fault in walk.faults)

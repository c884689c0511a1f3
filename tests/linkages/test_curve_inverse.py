"""Legs whose linkage has one drive: every place that the foot has been is found again, elsewhere the nearest one."""

from pathlib import Path

import casadi
import numpy as np
import pytest

from linkages.placed import code_of
from linkages.topologies import TOPOLOGIES, spec

TEXT = (Path(__file__).parents[2] / "specs" / "garrec.toml").read_text(encoding="utf-8")
FUNCTIONS = ("foot_position", "inverse", "inverse_branch", "inverse_near", "inverse_distance")
OK, UNREACHABLE, BAD_INPUT, SINGULAR = 0, 1, 2, 3
MOUNT = np.array([0.6, 0.25, 0.0])
SLIDING = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.8] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "one", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } }]
generate = { functions = ["foot_position", "inverse", "inverse_near", "inverse_distance"], targets = ["numpy"] }
[leg_designs.one]
dh = "classic"
four_bar = { ground = 0.2, crank = 0.05, coupler = 0.25, rocker = 0.25, foot = [0.125, 0.1] }
joints = [{ name = "slide", type = "prismatic", a = 0.1, d = 0.0, alpha_deg = 70, theta_deg = 20, limits = [-1, 1] }]
plane = { xyz = [0, 0.1, 0], rpy_deg = [10, 30, 0] }
"""


@pytest.fixture(scope="module")
def garrec(built):
    start, stop = TEXT.index("[generate]"), TEXT.index("[leg_designs.garrec]")
    wanted = ", ".join(f'"{name}"' for name in FUNCTIONS)
    legs = '[[legs]]\nname = "middle_left"', '[[legs]]\nname = "front_right"', '[[legs]]\nname = "middle_right"'
    text = TEXT[:start] + f'[generate]\nfunctions = [{wanted}]\ntargets = ["c", "numpy", "casadi"]\n' + TEXT[stop:]
    middle, right, after = map(text.index, legs)
    return built(text[:middle] + text[right:after])


def angle(turn):
    return np.angle(np.exp(1j * turn))


def check_round_trip(leg, q, target):
    rows, status = leg.inverse(target)
    assert rows.shape[1:] == (8, 2)
    assert leg.branch_names == tuple(f"root_{number}" for number in range(1, 9))
    good = status == OK
    assert good[:, 0].all()
    assert np.abs(leg.foot_position(rows) - target[:, None])[good].max() <= 1e-11
    away = np.where(good, np.abs(angle(rows - q[:, None])).max(-1), np.inf).min(-1)
    assert away.max() <= 1e-9
    again = np.where(good[..., None], 0, rows - rows[:, :1])
    assert np.array_equal(again, np.zeros_like(rows))
    distance = leg.inverse_distance(target)
    assert distance[good].max() <= 1e-11
    near, one = leg.inverse_near(target, q + 0.01)
    assert (one == OK).all()
    assert np.abs(angle(near - q)).max() <= 1e-9
    for branch in (0, 7):
        row, state = leg.inverse_branch(target, branch)
        assert np.array_equal(row, rows[:, branch])
        assert np.array_equal(state, status[:, branch])
    assert leg.inverse_branch(target[0], 8)[1] == BAD_INPUT


@pytest.mark.parametrize(("backend", "name", "count"), [("c", "front_left", 3000), ("c", "front_right", 300), ("numpy", "front_right", 3)])
def test_every_pose_is_found_again(garrec, backend, name, count):
    leg = getattr(garrec, backend).legs[name]
    q = np.random.default_rng(7).uniform(-np.pi, np.pi, (count, 2))
    check_round_trip(leg, q, leg.foot_position(q))


def test_elsewhere_the_nearest(garrec):
    """No drive with any yaw is nearer: the distance from a circle is known."""
    leg = garrec.c.legs["front_left"]
    random = np.random.default_rng(8)
    target = leg.foot_position(random.uniform(-np.pi, np.pi, (200, 2))) + random.normal(size=(200, 3)) * 0.1
    rows, status = leg.inverse(target)
    assert (status == UNREACHABLE).all()
    assert np.array_equal(rows, np.broadcast_to(rows[:, :1], rows.shape))
    distance = np.linalg.norm(leg.foot_position(rows[:, 0]) - target, axis=-1)
    assert leg.inverse_distance(target)[:, 0] == pytest.approx(distance, abs=1e-14)
    foot = leg.foot_position(np.stack([np.zeros(20001), np.linspace(-np.pi, np.pi, 20001)], -1)) - MOUNT
    radius, away = np.hypot(foot[:, 0], foot[:, 1]), target - MOUNT
    least = [np.hypot(radius - np.hypot(x, y), foot[:, 2] - z).min() for x, y, z in away]
    assert (distance - least).max() <= 1e-13
    assert (np.array(least) - distance).max() <= 1e-4
    near, one = leg.inverse_near(target, rows[:, 0])
    assert (one == UNREACHABLE).all()
    assert np.array_equal(near, rows[:, 0])


def test_backends_agree(garrec):
    target = MOUNT + np.random.default_rng(9).uniform(-0.6, 0.3, (4, 3))
    (in_c, state), (numpy, other) = (getattr(garrec, backend).legs["front_left"].inverse(target) for backend in ("c", "numpy"))
    assert np.array_equal(state, other)
    foot = garrec.c.legs["front_left"].foot_position
    far, near = (np.linalg.norm(foot(rows) - target[:, None], axis=-1) for rows in (in_c, numpy))
    assert np.abs(far - near).max() <= 1e-13


def test_near_a_seed_in_casadi(garrec):
    """Steps from the seed come to the row of C, with the slopes that the foot's Jacobian has the other way round."""
    robot, leg = garrec.c, garrec.c.legs["front_left"]
    function = robot.casadi("front_left_inverse_near")
    p, seed = casadi.SX.sym("p", 3), casadi.SX.sym("seed", 2)
    q, status = function(p, seed)
    slope = casadi.Function("slope", [p, seed], [q, status, casadi.jacobian(q, p)])
    for own in np.random.default_rng(11).uniform(-np.pi, np.pi, (6, 2)):
        target = leg.foot_position(own)
        near, one = leg.inverse_near(target, own + 0.02)
        found, state, J = (np.array(each) for each in slope(target, own + 0.02))
        assert (int(state.item()), one) == (OK, OK)
        assert np.abs(angle(found.ravel() - near)).max() < 1e-9
        step = np.array([0, 1e-6])
        moved = (leg.foot_position(own + step) - leg.foot_position(own - step)) / 2e-6
        assert J @ moved == pytest.approx([0, 1], abs=1e-6)
    assert int(slope(target + np.array([0, 0, 0.3]), own)[1]) == UNREACHABLE


def test_what_is_no_number(garrec):
    leg = garrec.c.legs["front_left"]
    rows, status = leg.inverse([np.nan, 0, 0])
    assert np.isnan(rows).all()
    assert (status == BAD_INPUT).all()
    assert np.isfinite(leg.inverse(MOUNT)[0]).all()  # on the axis: any yaw is as near


@pytest.mark.nightly
def test_a_joint_that_slides(tmp_path):
    leg = code_of(SLIDING, ("foot_position", "inverse", "inverse_near", "inverse_distance"), tmp_path)
    random = np.random.default_rng(10)
    q = np.c_[random.uniform(-1, 1, 10), random.uniform(-np.pi, np.pi, 10)]
    target = leg["leg_foot_position"](q)
    rows, status = leg["leg_inverse"](target)
    near, one = leg["leg_inverse_near"](target, q)
    assert (status[:, 0] == OK).all()
    assert (one == OK).all()
    assert np.abs(near[:, 0] - q[:, 0]).max() <= 1e-11
    assert np.abs(angle(near[:, 1] - q[:, 1])).max() <= 1e-11
    off = target + random.normal(size=target.shape) * 0.05
    (rows, status), distance = leg["leg_inverse"](off), leg["leg_inverse_distance"](off)[:, 0]
    assert (status == UNREACHABLE).all()
    for way in np.linspace(-0.01, 0.01, 5):
        for turn in np.linspace(-0.01, 0.01, 5):
            other = leg["leg_foot_position"](rows[:, 0] + [way, turn])
            assert (np.linalg.norm(other - off, axis=-1) >= distance - 1e-13).all()


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["moving_guide", "watt", "scotch_yoke", "four_bar"])
def test_dimensions_as_parameters(name, tmp_path):
    """No joint before the linkage; some dimensions assemble for part of a turn alone."""
    leg = code_of(spec(name, ("foot_position", "inverse")), ("foot_position", "inverse"), tmp_path)
    dimensions, drives = TOPOLOGIES[name].draw(np.random.default_rng(11), 16)
    target = leg["leg_foot_position"](drives, dimensions)
    there = np.isfinite(target).all(-1)
    assert there.sum() > 3
    rows, status = leg["leg_inverse"](target[there], dimensions[there])
    assert (status[:, 0] == OK).all()
    away = np.where(status == OK, np.abs(angle(rows[..., 0] - drives[there])), np.inf).min(-1)
    assert away.max() <= 1e-8
    assert (status == OK).sum() >= there.sum()

"""Legs of one drive and two joints: every pose is found again, as many as a dense scan of the drive has; in C and NumPy."""

import re

import numpy as np
import pytest

from linkages.chained import with_joints
from linkages.topologies import spec
from walkgen.model.classify import inverse_class
from walkgen.pipeline import mechanism_of

FUNCTIONS = (
    "foot_position",
    "foot_jacobian",
    "inverse",
    "inverse_branch",
    "inverse_distance",
    "inverse_near",
    "inverse_admissible",
    "within_limits",
)
OK, UNREACHABLE, BAD_INPUT, SINGULAR = 0, 1, 2, 3
SIZES = {
    "four_bar": [0.5, 0.1, 0.25, 0.6, 0.3, 0.2, 0.5],
    "slider_crank": [0.3, 0.7, 0.4, 0.2, 0.05, 0.02, 0.0, 0.03, 0.1, 0.2, 0.3],
}
ROCKING = [0.5, 0.1, 0.6, 0.4, 0.3, 0.2, 0.3]
"""Of a four-bar that assembles for part of a turn."""
TWO_BEFORE = """dh = "classic"
joints = [{ name = "yaw", type = "revolute", a = 0.1, alpha_deg = 90, d = 0.0 },
          { name = "lean", type = "revolute", a = 0.15, alpha_deg = -60, d = 0.05 }]
plane = { xyz = [0.1, 0.02, 0.0], rpy_deg = [80, 10, 0] }
"""
KINDS = [("R", "R"), ("", "RR"), ("P", "R"), ("R", "P"), ("", "PR"), ("", "RP"), ("P", "P"), ("RR", "")]


def text_of(topology, before, after, values=None, runtime=False, turn="20, 70, 0"):
    text = spec(topology, FUNCTIONS, values=SIZES[topology] if values is None else values)
    text = text if runtime else text.replace("runtime = true", "runtime = false")
    text = with_joints(text, before, after, turn) if after else re.sub(r'(?m)^(foot = ".*"\n)', r"\g<1>" + TWO_BEFORE, text)
    return text.replace('targets = ["numpy"]', 'targets = ["c", "numpy"]')


def away_from(rows, q, kinds):
    turning = np.array([kind != "P" for kind in kinds])
    apart = rows - q[..., None, :]
    return np.abs(np.where(turning, np.angle(np.exp(1j * apart)), apart)).max(-1)


def poses(leg, count, seed=3):
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 3))
    return q[np.isfinite(leg.foot_position(q)).all(-1)]


def found_again(leg, q, kinds, param=None):
    """All of them: none is left out."""
    given = {} if param is None else {"param": param}
    p = leg.foot_position(q, **given)
    rows, status = leg.inverse(p, **given)
    good = (status == OK) | (status == SINGULAR)
    assert rows.shape[1:] == (16, 3)
    assert leg.branch_names == tuple(f"root_{number}" for number in range(1, 17))
    every = {} if param is None else {"param": param[:, None]}
    distance = np.linalg.norm(leg.foot_position(rows, **every) - p[:, None], axis=-1)
    assert distance[good].max() <= 1e-9
    away = np.where(good, away_from(rows, q, kinds), np.inf).min(-1)
    least = np.linalg.svd(leg.foot_jacobian(q, **given), compute_uv=False)[:, -1]
    assert np.all(away * np.minimum(least, 1) <= 1e-10)
    drive = rows[..., kinds.index("D")]
    assert np.all((np.diff(drive, axis=-1) >= -2e-9) | ~good[:, 1:])
    assert np.array_equal(np.where(good[..., None], 0, rows - rows[:, :1]), np.zeros_like(rows))
    return p, rows, status


def order_of(before, after):
    return f"{before}D{after}"


@pytest.mark.parametrize(("topology", "kinds"), [("four_bar", ("R", "R")), ("slider_crank", ("", "RR"))])
def test_every_pose_is_found_again(built, topology, kinds):
    robot = built(text_of(topology, *kinds))
    leg, order = robot.c.legs["leg"], order_of(*kinds)
    q = poses(leg, 1500)
    p, rows, status = found_again(leg, q, order)
    assert leg.inverse_distance(p) == pytest.approx(np.linalg.norm(leg.foot_position(rows) - p[:, None], axis=-1), abs=1e-13)
    near, states = leg.inverse_near(p, q + 1e-3)
    assert (states == OK).all()
    assert leg.foot_position(near) == pytest.approx(p, abs=1e-9)
    for branch in (0, 1, 15):
        row, state = leg.inverse_branch(p, branch)
        assert np.array_equal(row, rows[:, branch])
        assert np.array_equal(state, status[:, branch])
    assert leg.inverse_branch(p[0], 16)[1] == BAD_INPUT
    best, fits = leg.inverse_admissible(p[:20])
    assert leg.foot_position(best)[fits == OK] == pytest.approx(p[:20][fits == OK], abs=1e-9)
    numpy, other = robot.numpy.legs["leg"].inverse(p[:3])
    assert np.array_equal(other, status[:3])
    assert numpy == pytest.approx(rows[:3], abs=1e-8)


@pytest.mark.parametrize(("before", "after"), [("R", "R"), ("", "RR")])
def test_lengths_as_parameters_and_mirrored(built, before, after):
    """The mirrored foot belongs to the same joint values."""
    text = text_of("four_bar", before, after, runtime=True)
    robot = built(text.replace("legs = [{", 'legs = [{ name = "other", mirror_of = "leg" }, {', 1))
    leg, other = (robot.c.legs[name] for name in ("leg", "other"))
    param = np.random.default_rng(5).uniform(0.9, 1.1, (200, 7)) * SIZES["four_bar"]
    q = np.random.default_rng(6).uniform(-np.pi, np.pi, (200, 3))
    there = np.isfinite(leg.foot_position(q, param=param)).all(-1)
    q, param = q[there], param[there]
    p, rows, status = found_again(leg, q, order_of(before, after), param)
    assert there.sum() > 100
    turned, states = other.inverse(p * [1, -1, 1], param=param)
    assert np.array_equal(states, status)
    assert turned == pytest.approx(rows, abs=1e-7)


def newton_solutions(leg, p, random, starts=300):
    """Joint values that Newton's method comes to from random starts."""
    q = random.uniform(-np.pi, np.pi, (starts, 3))
    for _ in range(60):
        gap = p - leg.foot_position(q)
        step = np.einsum("kij,kj->ki", np.linalg.pinv(leg.foot_jacobian(q)), gap)
        q = q + step * np.minimum(1, 0.3 / np.maximum(np.linalg.norm(step, axis=-1), 1e-9))[:, None]
        q = q[np.isfinite(leg.foot_position(q)).all(-1)]
    return q[np.linalg.norm(leg.foot_position(q) - p, axis=-1) < 1e-12]


@pytest.mark.parametrize("kinds", [("R", "R"), ("", "RR")])
def test_nothing_else_reaches(built, kinds):
    """What Newton's method comes to from 300 starts is among the rows."""
    leg = built(text_of("four_bar", *kinds)).c.legs["leg"]
    random, seen = np.random.default_rng(7), 0
    for own in poses(leg, 25, 8):
        p = leg.foot_position(own)
        rows, status = leg.inverse(p)
        for q in newton_solutions(leg, p, random):
            assert away_from(rows[status == OK][None], q[None], order_of(*kinds)).min() < 1e-6
            seen += 1
    assert seen > 1000


def test_elsewhere_the_nearest(built):
    """No pose of a grid is nearer."""
    leg = built(text_of("four_bar", "R", "R")).c.legs["leg"]
    target = np.random.default_rng(9).uniform([-3, -3, -1], [3, 3, 5], (12, 3))
    rows, status = leg.inverse(target)
    out = status[:, 0] == UNREACHABLE
    assert out.sum() > 5
    assert (status[out] == UNREACHABLE).all()
    assert np.array_equal(rows[out], np.broadcast_to(rows[out][:, :1], rows[out].shape))
    distance = np.linalg.norm(leg.foot_position(rows[out, 0]) - target[out], axis=-1)
    assert leg.inverse_distance(target[out])[:, 0] == pytest.approx(distance, abs=1e-13)
    turn = np.linspace(-np.pi, np.pi, 41)
    grid = leg.foot_position(np.stack(np.meshgrid(turn, turn, turn), -1).reshape(-1, 3))
    least = np.array([np.nanmin(np.linalg.norm(grid - p, axis=-1)) for p in target[out]])
    assert np.all(distance <= least + 1e-12)
    assert np.all(distance >= least - 0.2)
    near, state = leg.inverse_near(target[out], rows[out, 0])
    assert (state == UNREACHABLE).all()
    assert np.linalg.norm(leg.foot_position(near) - target[out], axis=-1) == pytest.approx(distance, abs=1e-7)


@pytest.mark.parametrize("after", ["R", "P"])
def test_the_foot_on_the_first_axis(built, after):
    """Any yaw will do."""
    text = text_of("four_bar", "R", after).replace("mount = { xyz = [0.3, 0.2, 0.1], rpy_deg = [5, 0, 30] }", "mount = {}")
    leg = built(text.replace("xyz = [0.01, 0.02, -0.15]", "xyz = [0.9, 0.2, -0.15]") if after == "R" else text).c.legs["leg"]
    seen = 0
    for q in poses(leg, 60, 11):
        q[0] = 0
        for _ in range(60):
            slope = leg.foot_jacobian(q)[:2, 1:]
            q[1:] -= np.clip(np.linalg.pinv(slope) @ leg.foot_position(q)[:2], -0.3, 0.3)
        p = leg.foot_position(q)
        if np.hypot(*p[:2]) < 1e-14:
            rows, status = leg.inverse([0, 0, p[2]])
            own = away_from(rows[None, :, 1:], q[None, 1:], "D" + after)[0]
            assert status[own < 1e-6][0] == SINGULAR
            assert (rows[status == SINGULAR][:, 0] == 0).all()
            assert leg.foot_position(rows[status == SINGULAR]) == pytest.approx(
                np.array([[0, 0, p[2]]] * sum(status == SINGULAR)), abs=1e-11
            )
            seen += 1
    assert seen > 3


def test_what_is_no_number(built):
    for leg in (getattr(built(text_of("four_bar", "R", "R")), backend).legs["leg"] for backend in ("c", "numpy")):
        rows, status = leg.inverse([np.nan, 0, 0])
        assert np.isnan(rows).all()
        assert (status == BAD_INPUT).all()
        assert np.isfinite(leg.inverse([1e9, 0, 0])[0]).all()


@pytest.mark.nightly
@pytest.mark.parametrize("topology", SIZES)
@pytest.mark.parametrize("kinds", KINDS)
def test_many_poses_of_all_kinds(built, topology, kinds):
    check = built(text_of(topology, *kinds)).c.legs["leg"]
    found_again(check, poses(check, 20000, 12), order_of(*kinds))


@pytest.mark.nightly
def test_many_poses_where_the_linkage_ends(built):
    leg = built(text_of("four_bar", "R", "R", ROCKING)).c.legs["leg"]
    found_again(leg, poses(leg, 100000, 13), "RDR")


def test_why_there_are_no_rows(tmp_path):
    path = tmp_path / "spec.toml"
    text = text_of("four_bar", "", "RR", turn="0, 0, 40").replace("alpha_deg = 60", "alpha_deg = 0")
    path.write_text(text, encoding="utf-8")
    mechanism = mechanism_of(path)
    found = inverse_class(mechanism, mechanism.legs[0])
    assert not found.name
    assert "on a surface" in found.reason

"""General legs as users call them: printed parameters, special classes forced through the general solver, every kind of target."""

import itertools
from functools import cache

import numpy as np
import pytest
from legs import HAND_MADE
from scipy.optimize import least_squares
from sequences import design, head, leg, row

from oracles.measure import difference
from oracles.multistart import multistart
from oracles.screws import screws
from oracles.walker import read
from walkgen.runtime.solves.inverse_general import inverse_general

OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE = 0, 1, 2, 3, 6
REACHES = (OK, SINGULAR, DUPLICATE)


def pitching(name, first, second, third="alpha = 0.0"):
    """A yaw-pitch-pitch leg but for its twists."""
    rows = [row("r", 0.08, first, 0.1, 0.0), row("r", 0.35, second, 0.02, 0.0), row("r", 0.4, third, -0.01, 0.0)]
    return design(name, rows, "0.01, -0.03, 0.05")


PRINTED = {
    "two_digits": pitching("two_digits", "alpha = 1.57", "alpha = 0.0"),
    "three_digits": pitching("three_digits", "alpha = -1.571", "alpha = 0.0"),
    "four_digits": pitching("four_digits", "alpha = 1.5708", "alpha = 3.1416"),
    "askew": pitching("askew", "alpha_deg = 90", "alpha = 2.7e-6"),
    "hardly_askew": pitching("hardly_askew", "alpha_deg = 90", "alpha = 1e-9"),
    "all_rounded": pitching("all_rounded", "alpha = 1.57", "alpha = 2.7e-6", "alpha = 1.5708"),
    "crossing": design(
        "crossing",
        [row("r", 0.0, "alpha = 1.57", 0.0, 0), row("r", 1e-6, "alpha = -1.57", 0.2, 0), row("r", 0.3, "alpha = 0.0", 0.1, 0)],
        "0, 0, 0",
    ),
    "sliding": design(
        "sliding",
        [row("r", 0.3, "alpha = 2.7e-6", 0, 0), row("r", 0.25, "alpha = 3.1416", 0, 0), row("p", 0, "alpha = 0.0", 0.2, 0)],
        "0, 0, 0",
    ),
    "csiro": design(
        "csiro",
        [row("r", 0.047, "alpha = 1.571", 0, 0), row("r", 0.035, "alpha = 1.571", -0.06, 0), row("r", 0.114, "alpha = 0.0", 0, 0)],
        "0.2, 0, 0",
    ),
}
ASKEW = {
    name: leg(name, *name.split("_"), np.random.default_rng(list(name.encode())))
    for name in ("rrr_xx", "rrr_zx", "rrp_xp", "rpr_px", "ppr_xx", "rr_x", "rp_p", "p_")
}
LOOPING = ("rrr_xx", "rrr_zx", "rr_x")
"""Legs that only turn have an outermost reach."""
SPECIAL = ("general", "general_mirrored", "mapped", "distant", "craig", "roll")
"""Legs that are yaw-pitch-pitch."""
DESIGNS = {**PRINTED, **ASKEW, **{name: HAND_MADE[name] for name in SPECIAL}}
FEW = ("two_digits", "askew", "crossing", "sliding", "csiro", "rrr_xx", "rrr_zx", "rrp_xp", "ppr_xx", "rr_x", "p_")
FEW += ("mapped", "craig", "roll")
"""What the ordinary run builds: every kind of rounding, of short and of special legs."""


def spec(names=FEW):
    return head("general", ("inverse",)) + "\n".join(text for name, text in DESIGNS.items() if name in names)


PATHS = {limb.name: screws(limb) for limb in read(spec(DESIGNS)).legs}


def some(names):
    return [name if name in FEW else pytest.param(name, marks=pytest.mark.nightly) for name in names]


@pytest.fixture(params=["c", "numpy"])
def robot(request, built):
    """With the few legs, or with all where another is tested."""
    name = request.node.callspec.params.get("name", FEW[0])
    return getattr(built(spec() if name in FEW else spec(DESIGNS)), request.param)


def least(path, q):
    return np.linalg.svd(path.jacobian(q), compute_uv=False)[..., path.n - 1]


# ---- printed parameters --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", some(PRINTED))
def test_printed_parameters_lose_nothing(robot, name):
    path, generated = PATHS[name], robot.legs[name]
    q = path.random(np.random.default_rng(1), 300 if robot.backend == "c" else 10)
    p = path.foot(q)
    rows, status = generated.inverse(p)
    reached = np.isin(status, REACHES)
    assert np.all(reached.any(axis=1))
    assert np.all(np.linalg.norm(path.foot(rows) - p[:, None], axis=-1)[reached] <= 1e-12)
    nearest, weakest = np.min(np.where(reached, path.apart(rows, q[:, None]), np.inf), axis=1), least(path, q)
    assert np.all((nearest <= 1e-13 + 1e-14 / weakest)[weakest > 1e-6])
    found, gap = multistart(path, p[:10])
    sharp = (gap < 1e-11) & (least(path, found) > 1e-4)
    apart = np.where((status == OK)[:10], path.apart(rows[:10], found[:, :, None]), np.inf)
    assert np.all(apart.min(axis=-1)[sharp] <= 1e-7)


def test_the_class_is_the_printed_one(robot):
    """Nothing coarser than a rounding of a double is taken for a right angle."""
    assert {robot.legs[name].inverse_class for name in PRINTED if name in FEW} == {"general RRR", "general RRP"}


# ---- special classes forced through the general solver --------------------------------------------------------------------------


@pytest.mark.parametrize("robot", ["c"], indirect=True)
@pytest.mark.parametrize("name", some(SPECIAL))
def test_a_special_leg_has_the_same_rows_by_the_general_solver(robot, name):
    path, generated = PATHS[name], robot.legs[name]
    assert generated.inverse_class == "yaw-pitch-pitch"
    q = path.random(np.random.default_rng(2), 25)
    p = np.concatenate([path.foot(q), path.foot(q) * 1.4])
    (rows, status), (others, states) = generated.inverse(p), inverse_general(path.numbers, p, path.sequence)
    for one, state, other, code in zip(rows, status, others, states, strict=True):
        mine, theirs = one[state == OK], other[code == OK]
        if np.all(least(path, np.concatenate([mine, theirs])) > 1e-4):
            assert np.count_nonzero(np.isin(state, REACHES)) == np.count_nonzero(np.isin(code, REACHES))
            assert all(np.min(path.apart(theirs, row)) <= 1e-13 + 1e-14 / least(path, row) for row in mine)
        if np.all(state == UNREACHABLE):
            assert np.all(code == UNREACHABLE)
    outside = np.all(status == UNREACHABLE, axis=1)
    assert outside.any()
    distances = [np.min(np.linalg.norm(path.foot(found[outside]) - p[outside, None], axis=-1), axis=1) for found in (rows, others)]
    assert difference(*distances) <= 1e-9


# ---- every kind of target --------------------------------------------------------------------------------------------------------

VALUES = (0.0, -0.0, np.nan, np.inf, -np.inf, 1e308, -1e308, 5e-324, 1e-160, 0.3, -1e100)
EVERY = np.array(list(itertools.product(VALUES, repeat=3)))


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", some([*ASKEW, "two_digits", "sliding"]))
def test_every_target_has_an_answer(robot, name):
    p = EVERY if robot.backend == "c" else EVERY[::29]
    with np.errstate(all="ignore"):
        rows, status = robot.legs[name].inverse(p)
    bad = ~np.all(np.isfinite(p), axis=1)
    assert np.all(status[bad] == BAD_INPUT)
    assert np.all(np.isnan(rows) == (status == BAD_INPUT)[..., None])
    sane = np.all(np.abs(p) <= 1.0, axis=1)
    assert np.all(status[sane] != BAD_INPUT)


@pytest.mark.parametrize("name", ["rrr_xx", "rrp_xp", "ppr_xx", "two_digits"])
def test_the_sign_of_zero_and_dust_do_not_matter(robot, name):
    p = np.array([[0.2, 0.0, 0.1], [0.2, -0.0, 0.1], [0.2, 5e-324, 0.1], [0.2, -5e-324, 0.1]])
    rows, status = robot.legs[name].inverse(p)
    assert np.all(status == status[0])
    assert difference(rows, np.broadcast_to(rows[0], rows.shape)) <= 1e-12


@pytest.mark.parametrize("name", LOOPING)
def test_far_targets_are_out_of_reach(robot, name):
    """However far: the foot points towards them."""
    path, generated = PATHS[name], robot.legs[name]
    direction = np.array([[0.6, 0.0, 0.8], [-0.3, 0.9, 0.3], [0.0, -1.0, 0.0]])
    for size in (1e3, 1e12, 1e100, 1e300):
        rows, status = generated.inverse(direction * size)
        assert np.all(status == UNREACHABLE)
        turned, _ = generated.inverse(direction * 1e20)
        apart = np.sum(direction * (path.foot(rows[:, 0]) - path.foot(turned[:, 0])), axis=1)
        assert np.all(np.abs(apart) <= 2.0 / size + 1e-9)


@cache
def closest(name, x, y, z):
    """The least distance of the foot from a target, by minimising it from the best of many poses."""
    path, p = PATHS[name], np.array([x, y, z])
    starts = path.random(np.random.default_rng(3), 3000, 2.0)
    best = starts[np.argsort(np.linalg.norm(path.foot(starts) - p, axis=1))[:6]]
    done = [least_squares(lambda q: path.foot(q) - p, q, path.jacobian, xtol=1e-12, ftol=1e-14, gtol=1e-14) for q in best]
    return min(np.sqrt(2 * one.cost) for one in done)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", some([*ASKEW, "two_digits", "csiro"]))
def test_unreachable_rows_hold_the_closest_pose(robot, name):
    path, generated = PATHS[name], robot.legs[name]
    p = np.random.default_rng(4).normal(size=(12 if robot.backend == "c" else 4, 3)) * 2.0
    rows, status = generated.inverse(p)
    out = np.all(status == UNREACHABLE, axis=1)
    assert out.any() or path.n == 3
    for target, found in zip(p[out][:3], rows[out][:3], strict=True):
        assert abs(np.min(np.linalg.norm(path.foot(found) - target, axis=1)) - closest(name, *target)) <= 1e-9


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", ["rrr_xx", "rrr_zx", "two_digits", "csiro", "rrp_xp", "rr_x"])
def test_the_boundary_is_reached_and_a_hair_beyond_is_not(robot, name):
    path, generated = PATHS[name], robot.legs[name]
    p = np.random.default_rng(5).normal(size=(24 if robot.backend == "c" else 6, 3)) * 2.0
    rows, status = generated.inverse(p)
    out = np.all(status == UNREACHABLE, axis=1)
    edge = path.foot(rows[out][: 3 if robot.backend == "c" else 1, 0])
    outward = p[out][: len(edge)] - edge
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    assert len(edge) >= 1
    beside = [edge, np.nextafter(edge, edge + outward), np.nextafter(edge, edge - outward), edge + 1e-13 * path.reach * outward]
    for targets in beside:
        found, states = generated.inverse(targets)
        assert np.all(np.isin(states, REACHES).any(axis=1))
        gap = np.linalg.norm(path.foot(found) - targets[:, None], axis=-1)
        assert np.all(gap[np.isin(states, REACHES)] <= 1e-12 * (path.reach + np.abs(targets).max()))
    found, states = generated.inverse(edge + 1e-9 * outward)
    assert np.all(states == UNREACHABLE)
    gap = np.linalg.norm(path.foot(found[:, 0]) - edge - 1e-9 * outward, axis=1)
    assert np.all(np.abs(gap - 1e-9) <= 1e-14 + 1e-13 * path.reach)

"""Searches in the drives of linkages: within the limits closest to a target, and near a seed where no rows are known."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import minimize

OK, UNREACHABLE, BAD_INPUT = 0, 1, 2
HEAD = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } }]
[generate]
functions = ["foot_position", "foot_jacobian", "assembly_status", "within_limits", "inverse_near", "inverse_admissible"]
targets = ["c", "numpy", "casadi"]
[leg_designs.leg]
dh = "classic"
plane = { xyz = [0.02, 0.01, 0.0], rpy_deg = [90, 0, 0] }
"""
YAW = 'joints = [{ name = "yaw", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 0, limits_deg = [-40, 50] }]'
HIP = """
joints = [
    { name = "roll", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 90, limits_deg = [-40, 50] },
    { name = "slide", type = "prismatic", a = 0.0, d = 0.0, alpha_deg = -30, limits = [-0.05, 0.1] },
]
"""
FIVE_BAR = """
foot = "coupler.P"
[leg_designs.leg.five_bar]
ground = 0.1
cranks = [0.15, 0.2]
couplers = [0.3, 0.28]
drives = [{ limits_deg = [100, 200] }, { limits_deg = [-60, 50] }]
[leg_designs.leg.links.coupler]
points = { P = [0.5, 0.03] }
"""
CYLINDERS = """
foot = "shank.P"
[leg_designs.leg.links.frame]
points = { E = [-0.25, 0.10], I = [0.02, -0.01] }
[leg_designs.leg.links.thigh]
points = { I = [0.0, 0.0], H = [0.35, 0.0], G = [0.0435, 0.1118], J = [0.0607, 0.0795] }
[leg_designs.leg.links.shank]
points = { P = [0.0, 0.0], H = [0.45, 0.0], L = [0.49, -0.0993] }
[[leg_designs.leg.pins]]
joins = ["frame.I", "thigh.I"]
[[leg_designs.leg.pins]]
joins = ["thigh.H", "shank.H"]
[[leg_designs.leg.cylinders]]
name = "lift"
between = ["frame.E", "thigh.G"]
driven = true
limits = [0.25, 0.45]
[[leg_designs.leg.cylinders]]
name = "knee"
between = ["thigh.J", "shank.L"]
driven = true
limits = [0.25, 0.45]
"""
CRANK = """
four_bar = { ground = 0.2, crank = 0.05, coupler = 0.25, rocker = 0.25, foot = [0.125, 0.1], drive = { limits_deg = [-100, 60] } }
"""


def brought_closest(leg, limits, target):
    """The least distance of the foot within the limits: descents without slopes from the best points of a grid."""
    axes = [np.linspace(low, high, 21) for low, high in limits]
    grid = np.array(list(product(*axes)))

    def distance(q):
        gap = np.linalg.norm(leg.foot_position(np.clip(q, *limits.T)) - target, axis=-1)
        return np.where(np.isfinite(gap), gap, 1e3)

    def descended(start):
        for size in (0.05, 0.01, 0.001):
            simplex = np.vstack([start, start + size * np.diag(limits[:, 1] - limits[:, 0])])
            options = {"initial_simplex": simplex, "xatol": 1e-10, "fatol": 1e-12, "maxiter": 2000}
            start = minimize(distance, start, method="Nelder-Mead", options=options).x
        return float(distance(start))

    return min(descended(grid[place]) for place in np.argsort(distance(grid))[:2])


def targets(leg, limits, count, wide):
    """About the workspace, so much wider."""
    q = np.random.default_rng(4).uniform(*limits.T, (500, len(limits)))
    feet = leg.foot_position(q)
    feet = feet[np.isfinite(feet).all(-1)]
    low, high = feet.min(0), feet.max(0)
    return np.random.default_rng(5).uniform(low - wide * (high - low), high + wide * (high - low), (count, 3))


def missed(leg, q, target):
    return np.linalg.norm(leg.foot_position(q) - target, axis=-1)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("text", [YAW + FIVE_BAR, YAW + CRANK, HIP + FIVE_BAR], ids=["five_bar", "crank", "hip"])
def test_no_pose_within_the_limits_is_closer(built, text):
    leg = built(HEAD + text).c.legs["leg"]
    limits = np.array(leg.limits)
    p = targets(leg, limits, 2, 0.4)
    q, status = leg.inverse_admissible(p)
    assert leg.within_limits(q).all()
    assert set(status) <= {OK, UNREACHABLE}
    assert (missed(leg, q, p)[status == OK] < 1e-11).all()
    for row in np.flatnonzero(status == UNREACHABLE):
        assert missed(leg, q[row], p[row]) <= brought_closest(leg, limits, p[row]) + 1e-9


def test_edges_of_what_assembles(built):
    """Cylinders that are longer than their dyads can stretch: closest may be where a dyad is stretched."""
    leg = built(HEAD + YAW + CYLINDERS).c.legs["leg"]
    limits = np.array(leg.limits)
    p = targets(leg, limits, 10, 0.3)
    q, status = leg.inverse_admissible(p)
    assert leg.within_limits(q).all()
    assert np.isfinite(leg.foot_position(q)).all()
    assert set(status) <= {OK, UNREACHABLE}
    for row in np.flatnonzero(status == UNREACHABLE)[:1]:
        assert missed(leg, q[row], p[row]) <= brought_closest(leg, limits, p[row]) + 1e-7


@pytest.mark.parametrize(
    "text", [YAW + FIVE_BAR, YAW + CYLINDERS, YAW + CRANK, HIP + FIVE_BAR], ids=["five_bar", "cylinders", "crank", "hip"]
)
def test_poses_within_the_limits_are_reached(built, text):
    leg = built(HEAD + text).c.legs["leg"]
    q = np.random.default_rng(6).uniform(*np.array(leg.limits).T, (300, len(leg.limits)))
    q = q[leg.assembly_status(q) == OK]
    p = leg.foot_position(q)
    found, status = leg.inverse_admissible(p)
    assert (status == OK).all()
    assert leg.within_limits(found).all()
    assert missed(leg, found, p).max() < 1e-10
    near, status = leg.inverse_near(p, q + 0.002)
    assert (status == OK).all()
    assert missed(leg, near, p).max() < 1e-10


def test_more_drives_than_a_position_needs(built):
    """Near the seed; CasADi's steps come to a solution as well."""
    robots = built(HEAD + HIP + FIVE_BAR)
    leg = robots.c.legs["leg"]
    q = np.random.default_rng(7).uniform(*np.array(leg.limits).T, (50, 4))
    q = q[leg.assembly_status(q) == OK]
    p, seed = leg.foot_position(q), q + 0.02
    near, status = leg.inverse_near(p, seed)
    assert (status == OK).all()
    assert np.abs(near - seed).max() < 0.2
    by_casadi = robots.c.casadi("leg_inverse_near")
    for row in range(5):
        own, state = (np.array(entry).ravel() for entry in by_casadi(p[row], seed[row]))
        assert state == OK
        assert missed(leg, own, p[row]) < 1e-9


def test_numpy_agrees(built):
    robots = built(HEAD + YAW + FIVE_BAR)
    leg, own = robots.c.legs["leg"], robots.numpy.legs["leg"]
    p = targets(leg, np.array(leg.limits), 4, 0.4)
    q, status = leg.inverse_admissible(p)
    other, states = own.inverse_admissible(p)
    assert np.array_equal(status, states)
    assert np.abs(missed(leg, q, p) - missed(leg, other, p)).max() < 1e-9


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_bad_input(built, backend):
    leg = getattr(built(HEAD + HIP + FIVE_BAR), backend).legs["leg"]
    for p in ([np.nan, 0.1, 0.2], [np.inf, 0.1, 0.2]):
        q, status = leg.inverse_admissible(p)
        assert status == BAD_INPUT
        assert np.isnan(q).all()
        q, status = leg.inverse_near(p, np.zeros(4))
        assert status == BAD_INPUT
    q, status = leg.inverse_near([0.1, 0.2, 0.1], [np.nan, 0, 0, 0])
    assert status == BAD_INPUT
    q, status = leg.inverse_admissible([1e300, 0.0, 0.0])
    assert np.isfinite(q).all()
    assert status == UNREACHABLE


@pytest.mark.nightly
def test_nothing_assembles_near_the_seed(built):
    """Another start finds the foot's place."""
    leg = built(HEAD + HIP + FIVE_BAR.replace("couplers = [0.3, 0.28]", "couplers = [0.22, 0.2]")).c.legs["leg"]
    apart = np.array([0.0, 0.0, np.pi, 0.0])  # cranks that point away from each other
    assert leg.assembly_status(apart) == UNREACHABLE
    q = np.array([0.1, 0.02, 1.75, 0.85])
    near, status = leg.inverse_near(leg.foot_position(q), apart)
    assert status == OK
    assert missed(leg, near, leg.foot_position(q)) < 1e-10


@pytest.mark.nightly
def test_behind_a_chain(built):
    """From the first platform, chain and leg together."""
    platforms = 'platforms = [{ name = "body" }, { name = "rear", parent = "body", chain = "spine" }]'
    spine = '[chain_designs.spine]\ndh = "classic"\njoints = [{ name = "bend", type = "revolute", a = 0.3, d = 0.02, alpha_deg = 90 }]\n'
    text = HEAD.replace('platforms = [{ name = "body" }]', platforms).replace('platform = "body"', 'platform = "rear"')
    robot = built(text.replace("[leg_designs.leg]", f"{spine}[leg_designs.leg]") + YAW + FIVE_BAR).c
    route = robot.routes["leg"]
    q = np.random.default_rng(8).uniform(*np.array([[-0.5, 0.5], *robot.legs["leg"].limits]).T, (40, 4))
    p = route.foot_position(q)
    near, status = route.inverse_near(p, q + 0.02)
    assert (status == OK).all()
    assert np.abs(near - q).max() < 0.3
    assert np.abs(route.foot_position(near) - p).max() < 1e-11

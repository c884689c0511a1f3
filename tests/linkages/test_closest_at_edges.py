"""Targets out of reach that are closest where a linkage ceases to assemble: the drives there are found, UNREACHABLE."""

import numpy as np
import pytest

from linkages.edge_scan import EdgeScan
from linkages.test_driven_search import CYLINDERS, HEAD, HIP, YAW, brought_closest, missed, targets

OK, UNREACHABLE, SINGULAR = 0, 1, 3
FUNCTIONS = ("foot_position", "foot_jacobian", "assembly_status", "within_limits", "inverse_near", "inverse_admissible")
NEAR = 3e-7
"""Of the leg's size: how much farther the foot may be than it could. The last bound of the root of the margin is 3e-8, rounding is of that
size there too, for the scan as well, and a foot goes up to three sizes a unit of the root."""


def five_bar(seed):
    """Random dimensions and limits, drawn before anything is known of them."""
    random = np.random.default_rng(seed)
    ground, *bars = (*random.uniform(0.05, 0.3, 1), *random.uniform(0.1, 0.3, 2), *random.uniform(0.15, 0.4, 2))
    low = random.uniform(-180, 180, 2)
    high = low + random.uniform(60, 180, 2)
    x, y = random.uniform(-0.3, 0.5, 2)
    drives = ", ".join(f"{{ limits_deg = [{one:.1f}, {other:.1f}] }}" for one, other in zip(low, high, strict=True))
    return f"""
foot = "coupler.P"
[leg_designs.leg.five_bar]
ground = {ground:.4f}
cranks = [{bars[0]:.4f}, {bars[1]:.4f}]
couplers = [{bars[2]:.4f}, {bars[3]:.4f}]
drives = [{drives}]
[leg_designs.leg.links.coupler]
points = {{ P = [{x:.4f}, {y:.4f}] }}
"""


def in_the_plane(leg, limits, count):
    """Targets about the workspace of a leg that has no joints before its linkage, in its plane, twice as wide."""
    q = np.random.default_rng(4).uniform(*limits.T, (1000, 2))
    feet = leg.foot_position(q)
    feet = feet[np.isfinite(feet).all(-1)]
    middle, axes = feet.mean(0), np.linalg.svd(feet - feet.mean(0), full_matrices=False)[2][:2]
    along = (feet - middle) @ axes.T
    size = np.ptp(along, axis=0).max()
    low, high = along.min(0) - size / 2, along.max(0) + size / 2
    return middle + np.random.default_rng(5).uniform(low, high, (count, 2)) @ axes, size


def assert_closest(leg, count, dense=100):
    """What is unreachable, and how many of these are closest at an edge of what assembles."""
    limits = np.array(leg.limits)
    limits[~np.isfinite(limits).all(-1)] = [-np.pi, np.pi]
    p, size = in_the_plane(leg, limits, count)
    q, status = leg.inverse_admissible(p)
    assert set(status) <= {OK, UNREACHABLE}
    assert leg.within_limits(q).all()
    scan, gap = EdgeScan(leg, limits, dense), missed(leg, q, p)
    turns = (status == OK) & (leg.assembly_status(q) == SINGULAR)  # both ends of a dyad at one place: its foot goes round there
    assert np.isfinite(gap[~turns]).all()
    least = [scan.closest(target) for target in p[status == UNREACHABLE]]
    assert (gap[status == UNREACHABLE] <= least + NEAR * size).all(), (gap[status == UNREACHABLE] - least) / size
    away = np.array([[1e-3, 0], [-1e-3, 0], [0, 1e-3], [0, -1e-3]])
    return (leg.assembly_status(q[status == UNREACHABLE][:, None] + away) == UNREACHABLE).any(-1).sum()


def test_five_bar(built):
    assert assert_closest(built(HEAD + five_bar(2)).c.legs["leg"], 8) > 0


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(30))
def test_many_five_bars(built, seed):
    assert_closest(built(HEAD + five_bar(seed)).c.legs["leg"], 40, 300)


def test_both_cranks_in_one_line(shipped):
    """Of equal couplers on one axis: there the dyad's ends are at one place, and its margin is as flat as a parabola."""
    assert_closest(shipped("minitaur", FUNCTIONS).c.legs["front_left"], 8)


def test_two_dyads(built):
    leg = built(HEAD + CYLINDERS).c.legs["leg"]
    assert assert_closest(leg, 8) > 0


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("joints", "drives"), [(YAW, 2), (HIP, 11)], ids=["yaw", "hip"])
def test_joints_before(built, joints, drives):
    """Descents without slopes come no closer."""
    leg = built(HEAD + joints + five_bar(drives)).c.legs["leg"]
    limits = np.array(leg.limits)
    p = targets(leg, limits, 6, 0.3)
    q, status = leg.inverse_admissible(p)
    assert set(status) <= {OK, UNREACHABLE}
    for row in np.flatnonzero(status == UNREACHABLE)[:1]:
        assert missed(leg, q[row], p[row]) <= brought_closest(leg, limits, p[row]) + NEAR


def test_near_a_seed(built):
    """Legs without rows: the best that is found is at rest."""
    leg = built(HEAD + HIP + five_bar(11)).c.legs["leg"]
    limits = np.array(leg.limits)
    p = targets(leg, limits, 30, 0.5)
    q, status = leg.inverse_near(p, limits.mean(-1))
    assert set(status) <= {OK, UNREACHABLE, 3}
    assert np.isfinite(leg.foot_position(q)).all()


def test_numpy_agrees(built):
    robots = built(HEAD + five_bar(2))
    leg, own = robots.c.legs["leg"], robots.numpy.legs["leg"]
    limits = np.array(leg.limits)
    p, size = in_the_plane(leg, limits, 15)
    p = p[leg.inverse_admissible(p)[1] == UNREACHABLE][:2]
    q, other = leg.inverse_admissible(p)[0], own.inverse_admissible(p)
    assert (other[1] == UNREACHABLE).all()
    assert np.abs(missed(leg, q, p) - missed(leg, other[0], p)).max() < NEAR * size

"""Special values: extremes of the number range, exact boundaries and a hair beside them, free joints, double roots."""

from itertools import product

import numpy as np
import pytest
from anatomy import turned
from legs import LEGS

OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE = 0, 1, 2, 3, 6
EXTREMES = (0.0, -0.0, 0.3, -0.25, 5e-324, -1e-300, 1e-20, 1e154, -1e155, 1e308, -9e307)
AZIMUTHS = (-3.1, -1.0, 0.0, 0.4, 2.2)


@pytest.fixture(params=["c", "numpy"])
def either(request, specimen):
    return lambda name: specimen(name, request.param)


def one_branch_each(leg, p):
    found = [leg.generated.inverse_branch(p, branch) for branch in range(4)]
    return np.stack([q for q, _ in found], axis=-2), np.stack([status for _, status in found], axis=-1)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", LEGS)
def test_every_number_is_answered(either, name):
    """No finite target is bad input, and no row holds anything but angles."""
    leg = either(name)
    p = np.array(list(product(EXTREMES, repeat=3)))
    with np.errstate(all="ignore"):
        answers = leg.generated.inverse(p), one_branch_each(leg, p)
    for rows, status in answers:
        assert np.all(np.isin(status, (OK, UNREACHABLE, SINGULAR, DUPLICATE)))
        assert np.all((rows > -np.pi) & (rows <= np.pi))
        far = np.max(np.abs(p), axis=1) > 100 * leg.anatomy.reach
        assert np.all(status[far] == UNREACHABLE)


@pytest.mark.parametrize("name", LEGS)
def test_targets_farther_than_numbers_go_are_unreachable(either, name):
    """Their distance overflows: the rows need not hold numbers, but no row is OK."""
    leg = either(name)
    p = np.array(list(product((np.finfo(float).max, -np.finfo(float).max), repeat=3)))
    with np.errstate(all="ignore"):
        answers = leg.generated.inverse(p), one_branch_each(leg, p)
    for _, status in answers:
        assert np.all(np.isin(status, (UNREACHABLE, BAD_INPUT)))


@pytest.mark.parametrize("name", LEGS)
def test_what_is_not_finite_is_bad_input(either, name):
    leg = either(name)
    p = np.array([case for case in product((np.nan, np.inf, -np.inf, 0.2, 1e308), repeat=3) if not np.all(np.isfinite(case))])
    with np.errstate(all="ignore"):
        answers = leg.generated.inverse(p), one_branch_each(leg, p)
    for rows, status in answers:
        assert np.all(status == BAD_INPUT)
        assert np.all(np.isnan(rows))


def on_circle(anatomy, radius, outward):
    """Targets on (or `outward` of) a circle about the hip in the leg plane, clear of axis 1: [n, 3].

    Also: which rows have their sheet [n, 2], and how far the foot moves in the leg plane for a step of the target outward [n].
    """
    a1, _, _, w = anatomy.lengths
    angles = np.linspace(-3, 3, 41)
    rho, height = a1 + (radius + outward) * np.cos(angles), (radius + outward) * np.sin(angles)
    clear = np.abs(rho) > 0.02 * anatomy.reach
    p = anatomy.point(np.hypot(rho, w)[clear], height[clear], angles[clear])
    gain = np.hypot(np.cos(angles) * np.hypot(rho, w) / rho, np.sin(angles))[clear]
    return p, np.array([[0, 1], [2, 3]])[np.where(rho[clear] > 0, 0, 1)], gain


def boundaries(anatomy):
    """Radii of the stretched and the folded leg, with the direction that leads out of the workspace."""
    _, thigh, shank, _ = anatomy.lengths
    folded = abs(thigh - shank)
    return [(thigh + shank, 1.0), *([(folded, -1.0)] if folded > 1e-3 else [])]


def own_rows(leg, p, sheet):
    """Rows [n,2,3] and statuses [n,2] of the targets' sheets."""
    rows, status = leg.generated.inverse(p)
    return np.take_along_axis(rows, sheet[..., None], 1), np.take_along_axis(status, sheet, 1)


def misses(leg, rows, p):
    return np.linalg.norm(leg.anatomy.foot(rows) - p[:, None], axis=-1)


@pytest.mark.parametrize("name", LEGS)
def test_a_hair_outside_is_reached(either, name):
    """Up to 1e-12 of the reach: OK with the clamped q, which the other knee repeats."""
    leg = either(name)
    for radius, out in boundaries(leg.anatomy):
        p, sheet, _ = on_circle(leg.anatomy, radius, out * 0.5e-12 * leg.anatomy.reach)
        assert len(p) >= 3
        rows, status = own_rows(leg, p, sheet)
        assert np.array_equal(status, np.tile([OK, DUPLICATE], (len(p), 1)))
        assert np.all(turned(rows[:, 0], rows[:, 1]) <= 1e-15)
        assert np.all(misses(leg, rows, p) <= 1e-12 * leg.anatomy.reach)
        _, bend = leg.anatomy.sides(rows)
        assert np.all(np.abs(bend) <= 1e-15)


@pytest.mark.parametrize("name", LEGS)
def test_farther_outside_is_unreachable(either, name):
    """10 times the tolerance: the closest foot is given, and it is that far away."""
    leg = either(name)
    beyond = 1e-11 * leg.anatomy.reach
    for radius, out in boundaries(leg.anatomy):
        p, sheet, gain = on_circle(leg.anatomy, radius, out * beyond)
        rows, status = own_rows(leg, p, sheet)
        assert np.all(status == UNREACHABLE)
        assert np.all(np.abs(misses(leg, rows, p) - (beyond / gain)[:, None]) <= 1e-3 * beyond)


@pytest.mark.parametrize("name", LEGS)
@pytest.mark.parametrize("ulps", [-1, 0, 1])
def test_on_the_boundary(either, name, ulps):
    """Exactly stretched or folded, and an ulp to either side: a solution, single or double, never a refusal."""
    leg = either(name)
    for radius, _ in boundaries(leg.anatomy):
        p, sheet, _ = on_circle(leg.anatomy, radius + ulps * np.spacing(radius), 0.0)
        rows, status = own_rows(leg, p, sheet)
        assert np.all(status[:, 0] == OK)
        assert np.all(np.isin(status[:, 1], (OK, DUPLICATE)))
        assert np.all(misses(leg, rows, p) <= 1e-12 * leg.anatomy.reach)


ON_AXIS = ("chapter", "equal")
EQUAL = ("equal", "equal_offset")
"""Legs whose bones are equally long and whose hip is not on the hip cylinder's edge, where the hip distance is known to 1e-8 only."""


def test_the_lists_are_complete(anatomies):
    rounded = {name: np.round(anatomy.lengths, 12) for name, anatomy in anatomies.items()}
    assert tuple(name for name, (_, _, _, w) in rounded.items() if w == 0) == ON_AXIS
    assert tuple(name for name, (a1, thigh, shank, w) in rounded.items() if thigh == shank and (a1 != 0 or w == 0)) == EQUAL


@pytest.mark.parametrize("name", ON_AXIS)
def test_any_yaw_will_do_on_axis_1(either, name):
    """SINGULAR with joint 0 at 0; the other sheet repeats it."""
    leg = either(name)
    a1, thigh, shank, _ = leg.anatomy.lengths
    heights = np.array([-0.9, -0.3, 0.5, 0.95]) * (thigh + shank - abs(a1))
    p = leg.anatomy.point(0.0, heights)
    for rows, status in (leg.generated.inverse(p), one_branch_each(leg, p)):
        assert np.array_equal(status, np.tile([SINGULAR, SINGULAR, DUPLICATE, DUPLICATE], (len(p), 1)))
        assert np.all(rows[..., 0] == 0)
        assert np.all(misses(leg, rows + np.array([0.7, 0, 0]), p) <= 1e-12 * leg.anatomy.reach)


@pytest.mark.parametrize("name", EQUAL)
def test_any_thigh_will_do_at_the_hip(either, name):
    """Equal bones fold back to the hip: SINGULAR with joint 1 at 0; the other knee repeats it."""
    leg = either(name)
    a1, _, _, w = leg.anatomy.lengths
    p = leg.anatomy.point(np.hypot(a1, w), 0.0, AZIMUTHS)
    for rows, status in (leg.generated.inverse(p), one_branch_each(leg, p)):
        pair = slice(0, 2) if a1 >= 0 else slice(2, 4)
        assert np.array_equal(status[:, pair], np.tile([SINGULAR, DUPLICATE], (len(p), 1)))
        assert np.all(rows[:, pair, 1] == 0)
        assert np.all(misses(leg, rows[:, pair] + np.array([0, -1.3, 0]), p) <= 1e-12 * leg.anatomy.reach)


@pytest.mark.parametrize("name", LEGS)
def test_duplicates_repeat_an_earlier_row(either, name):
    """Whatever is said to repeat does; what is said to be OK is another solution than those before."""
    leg = either(name)
    a1, thigh, shank, w = leg.anatomy.lengths
    heights = np.linspace(-1, 1, 41) * (thigh + shank)
    edge, _, _ = on_circle(leg.anatomy, thigh + shank, 0.0)
    p = np.concatenate([leg.anatomy.point(abs(w), heights), edge, leg.anatomy.point(np.hypot(a1, w), 0.0, AZIMUTHS)])
    rows, status = leg.generated.inverse(p)
    assert np.all(status[:, 0] != DUPLICATE)
    for row in range(1, 4):
        differences = np.max(np.abs(rows[:, :row] - rows[:, row, None]), axis=-1)
        apart = np.min(np.where(status[:, :row] == UNREACHABLE, np.inf, differences), axis=1)
        assert np.all(apart[status[:, row] == DUPLICATE] <= 1e-12)
        assert np.all(apart[status[:, row] == OK] > 0)

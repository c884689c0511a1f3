"""Heels given in every way are toes seen in a mirror: of the foot's y, of angles about the flat foot's, of the way along the ground."""

import numpy as np
import pytest
from rolling_robots import CURVES, FRONT, SHANK, THIGH, direction, end_of, leg_text

HEEL = "heel = { ellipse = [0.05, 0.05], end_deg = 60 }"
FUNCTIONS = ("toe_rolling", "heel_rolling", "toe_motion", "heel_motion", "stance_position", "hip_position", "flat_position")
MIRRORED = {
    "ellipse": "heel = { ellipse = [0.09, 0.06], end_deg = 75 }",
    "polynomial": "heel = { polynomial = [5.0, -12.0], end = 0.095 }",
    "expressions": 'heel = { x = "0.09 - 0.06*(1 - cos(lambda))", y = "-0.12 - 0.09*sin(lambda)", end = 1.3 }',
    "late": 'heel = { x = "0.09 - 0.5*(lambda - 2)**2 / (1 + lambda)", y = "-0.12 - (lambda - 2)/8", start = 2, end = 3 }',
    "spline": "heel = { points = [[0.085, -0.15], [0.07, -0.18], [0.04, -0.205]] }",
}
BY_DAY = "polynomial"
ROWS = 60


@pytest.fixture(params=[pytest.param(name, marks=() if name == BY_DAY else pytest.mark.nightly) for name in MIRRORED])
def symmetric(request, built):
    """A leg whose sole is its own mirror image, and the bounds of its curves."""
    name = request.param
    text = leg_text(CURVES[name], FUNCTIONS, "symmetric", ("c", "numpy"))
    assert HEEL in text
    leg = built(text.replace(HEEL, MIRRORED[name]).replace("flat = [-0.06, 0.12]", "flat = [-0.12, 0.12]")).c.legs["leg"]
    start = 2.0 if name == "late" else 0.0
    return leg, start, 0.103 if name == "spline" else end_of(CURVES[name])


def seen(angle):
    """In the mirror: from X backward."""
    return -np.pi - angle


def test_rolling(symmetric):
    leg, start, end = symmetric
    at = np.random.default_rng(1).uniform(start, end, ROWS)
    toe, heel = leg.toe_rolling(at, 0.3), leg.heel_rolling(at, -0.3)
    assert np.abs(heel[0] * [-1, -1, -1] - [np.pi, 0, 0] - toe[0]).max() < 1e-12 * np.abs(toe[0]).max()
    assert np.abs(heel[1] - toe[1]).max() < 1e-13 * np.abs(toe[1]).max()
    for one, other in zip(toe[2:], heel[2:], strict=True):
        assert np.abs(other * [-1, 1] - one).max() < 1e-12 * np.abs(one).max()


def test_motions(symmetric):
    leg, start, end = symmetric
    random = np.random.default_rng(2)
    contact, edge = random.uniform(start, end, ROWS), random.uniform(-1, 1, ROWS)
    thigh, shank = random.uniform(-1.6, -0.9, ROWS), random.uniform(-2.7, -2.1, ROWS)
    hip, swing = random.uniform(-2, 2, (ROWS, 3, 2)), np.column_stack([thigh, random.uniform(-4, 4, (ROWS, 2))])
    hip[:, 0] = leg.toe_rolling(contact, edge)[3][:, 0] - SHANK * direction(shank) - THIGH * direction(thigh)
    *toe, status = leg.toe_motion(hip, swing, edge)
    other = -swing
    other[:, 0] -= np.pi
    *heel, behind = leg.heel_motion(hip * [-1, 1], other, -edge)
    assert (status == behind).all()
    good = status == 0
    assert good.mean() > 0.9
    mirrored = (heel[0], np.where(np.arange(3)[:, None] == 0, seen(heel[1]), -heel[1]), heel[2] * [-1, 1], heel[3] * [-1, 1], heel[4])
    for one, two in zip(toe, mirrored, strict=True):
        away = one[good] - two[good]
        if one.ndim == 3 and one.shape[2] == 3:
            away[:, 0] = np.angle(np.exp(1j * away[:, 0]))
        assert np.abs(away).max() < 1e-8 * np.abs(one[good]).max()


def test_phases(symmetric):
    """The hip that goes back rolls the foot over its heel as the one that goes on over its toe."""
    leg, start, _ = symmetric
    thigh = leg.flat_position([0.34, 0.80], 0.18, 1)[0][0]
    ahead = leg.stance_position([0.38, 0.80], thigh, 0.18)
    behind = leg.stance_position([-0.38, 0.80], seen(thigh), -0.18)
    assert (int(ahead[0]), int(behind[0])) == (1, -1)
    assert start < ahead[1] == pytest.approx(behind[1], rel=1e-12)
    assert behind[4] * [-1, 1] == pytest.approx(ahead[4], abs=1e-13)
    back = leg.hip_position(behind[2], -0.18)
    assert back[0] == pytest.approx([-0.38, 0.80], abs=1e-12)
    assert int(back[1]) == -1
    assert abs(ahead[4][0] - 0.18 - FRONT) > 1e-3

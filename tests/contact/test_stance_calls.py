"""What a stance can do, as users call it: friction that is needed, margins, slip, what feet cannot carry; the chapter's numbers."""

import numpy as np
import pytest
from quadruped import balance, spec, stands

OK, SINGULAR, INFEASIBLE = 0, 3, 5
FUNCTIONS = ("grasp_map", "friction_needed", "friction_share", "load_margin", "foot_admissible", "slip")
TRIPOD = np.array([[0.30, 0.0, 0.0], [-0.2, 0.25, 0.0], [-0.15, -0.28, 0.0]])
UP = np.tile([0.0, 0.0, 1.0], (3, 1))
WEIGHT = 60 * 9.81 * np.array([np.sin(np.radians(18)), 0.0, -np.cos(np.radians(18))])
GRAVITY = np.concatenate([WEIGHT, np.cross([0.02, 0.03, 0.30], WEIGHT)])
PUSHED = GRAVITY + np.array([0.0, 20.0, 0.0, 0.0, 0.0, 6.0])
"""Theory O10: gravity at the centre of mass, a side force and a moment about the origin."""


@pytest.fixture(params=["c", "numpy"])
def robot(request, built):
    return getattr(built(spec(*FUNCTIONS)), request.param)


def test_a_tripod_on_the_verge_of_slipping(robot):
    load = PUSHED
    mu, status, twist, N, f, axis, _ = robot.slip(TRIPOD, UP, load)
    assert status == OK
    assert mu == pytest.approx(0.32809786048976614, abs=1e-11)
    np.testing.assert_allclose(N, [348.6499724960401, 143.2329924592835, 67.90890053600377], atol=1e-9)
    np.testing.assert_allclose(axis[:2], [-0.18287015561434, 2.70775496746280], atol=1e-9)
    assert twist[5] > 0.0
    assert np.max(np.abs(balance(TRIPOD, f, load))) <= 1e-9
    assert robot.friction_needed(TRIPOD, UP, load)[0] == pytest.approx(mu, abs=1e-9)


def test_an_incline_needs_its_tangent(robot):
    needed, status, f, _ = robot.friction_needed(TRIPOD, UP, GRAVITY)
    assert status == OK
    assert needed == pytest.approx(np.tan(np.radians(18)), abs=1e-10)
    assert np.max(np.abs(balance(TRIPOD, f, GRAVITY))) <= 1e-7
    share, status = robot.friction_share(TRIPOD, UP[0], 0.5, GRAVITY)
    assert share == pytest.approx(needed / 0.5, abs=1e-9)


def test_margins_end_where_forces_do(robot):
    points, normals, mu, wrench = stands(4, 4, seed=2, slope=0.1)
    side = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
    reach, status, lift = robot.load_margin(points, normals, mu, wrench, side)
    assert np.all(status == OK)
    assert np.all((reach > 0.0) & (lift > 0.0))
    for factor, within in ((0.999, True), (1.001, False)):
        share, _ = robot.friction_share(points, normals, mu, wrench + factor * reach[:, None] * np.array(side))
        assert np.array_equal(share <= 1.0, np.full(4, within))


def test_the_field_of_a_foot(robot):
    """On a plane, a tripod's foot may stand where the triangle keeps the centre of mass, whatever the friction, under weight alone."""
    weight = np.array([0.0, 0.0, -100.0, -3.0, 2.0, 0.0])  # at (0.02, 0.03)
    spots = np.array([[0.30, 0.0, 0.0], [0.1, 0.05, 0.0], [-0.1, 0.0, 0.0], [0.03, 0.1, 0.0]])
    share, status = robot.foot_admissible(TRIPOD, UP, np.full(3, 0.5), weight, 0, spots, UP[0])
    assert np.array_equal(share <= 1.0, [True, True, False, False])
    assert np.array_equal(status == INFEASIBLE, [False, False, True, True])


def test_what_feet_cannot_carry_is_said(robot):
    line = np.array([[-0.3, 0.1, 0.0], [0.1, 0.1, 0.0], [0.4, 0.1, 0.0]])
    G, status, rank, condition, singular_values, lost = robot.grasp_map(line)
    assert (status, rank) == (SINGULAR, 5)
    assert np.isinf(condition)
    assert G.shape == (6, 3, 3)
    f = np.random.default_rng(0).normal(size=(3, 3))
    np.testing.assert_allclose(np.einsum("xij,ij->x", G, f), balance(line, f, np.zeros(6)), atol=1e-12)
    about_line = np.array([0.0, 0.0, 0.1, 1.0, 0.0, 0.0])  # a turn about the line does not move the feet
    np.testing.assert_allclose(np.abs(lost[0]), np.abs(about_line / np.linalg.norm(about_line) * np.linalg.norm(lost[0])), atol=1e-9)
    assert robot.grasp_map(TRIPOD)[1:3] == (OK, 6)
    assert singular_values.shape == (6,)

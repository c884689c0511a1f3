"""A biped on soles, as users call it: more points than legs, forces in both methods, the pressure under each sole."""

import casadi as ca
import numpy as np
import pytest
from quadruped import balance

from mechanisms.elastic_robots import SECTIONS
from oracles.beam_frame import grasp, spread
from oracles.walker import read

LENGTH, WIDTH, KN, KT = 0.22, 0.1, 4e5, 2e5
FUNCTIONS = (
    *("sole_points", "sole_normal", "sole_compliance", "ground_pressure", "contact_points", "contact_normals", "stance_compliance"),
    *("contact_forces", "contact_forces_coupled"),
)
TEXT = f"""
walkgen = 1
robot = {{ name = "biped", gravity = [0, 0, -9.81] }}
generate = {{ functions = {list(FUNCTIONS)} }}
platforms = [{{ name = "pelvis" }}]
legs = [
    {{ name = "left", design = "leg", platform = "pelvis", mount = {{ xyz = [0, 0.1, 0] }} }},
    {{ name = "right", mirror_of = "left" }},
]
{SECTIONS}
[leg_designs.leg]
foot = {{ xyz = [0.02, 0.0, -0.08] }}
sole = {{ length = {LENGTH}, width = {WIDTH}, kn = {KN}, kt = {KT} }}
joints = [
    {{ name = "roll", type = "revolute", xyz = [0, 0, 0], axis = [1, 0, 0], link = {{ section = "upper" }} }},
    {{ name = "hip", type = "revolute", xyz = [0, 0, -0.05], axis = [0, 1, 0], link = {{ section = "upper" }} }},
    {{ name = "knee", type = "revolute", xyz = [0, 0, -0.4], axis = [0, 1, 0], link = {{ section = "middle" }} }},
    {{ name = "ankle", type = "revolute", xyz = [0, 0, -0.4], axis = [0, 1, 0], link = {{ section = "lower" }} }},
]
""".replace("'", '"')
STRIDE = np.array([0.0, -0.5, 0.8, -0.3, 0.0, -0.3, 0.8, -0.5])
"""Soles level and of one height, one foot behind the other."""
OK, BAD_INPUT = 0, 2
FREE = 2
CORNERS = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [LENGTH / 2, WIDTH / 2]


@pytest.fixture(params=["c", "numpy"])
def robot(request, built):
    return getattr(built(TEXT), request.param)


def weight_at(*point):
    force = np.array([20.0, -10.0, -600.0])
    return np.concatenate([force, np.cross([*point, 0.0], force)])


def carried(robot, load):
    points, normals = robot.contact_points(STRIDE), robot.contact_normals(STRIDE)
    compliance = robot.stance_compliance(STRIDE)
    return {
        method: robot.contact_forces(points, normals, 0.6, load, method=method, **options)
        for method, options in (("least_squares", {}), ("stiffness", {"compliance": compliance}))
    }


def test_a_biped_stands_on_eight_points(robot):
    points = robot.contact_points(STRIDE)
    np.testing.assert_allclose(points, read(TEXT).contact_points(STRIDE), rtol=0, atol=1e-14)
    np.testing.assert_allclose(robot.contact_normals(STRIDE), np.tile([0, 0, 1], (8, 1)), rtol=0, atol=1e-15)
    load = weight_at(0.03, 0.02)
    for f, status, state, *_ in carried(robot, load).values():
        assert status == OK
        assert not np.any(state)
        assert np.max(np.abs(balance(points, f, load))) <= 1e-9
    stiff = carried(robot, load)["stiffness"][0]
    np.testing.assert_allclose(stiff, spread(points, robot.stance_compliance(STRIDE), load)[0], rtol=0, atol=1e-8)


def test_c_and_numpy_agree(built):
    robots = built(TEXT)
    for load in (weight_at(0.03, 0.02), weight_at(0.0, 0.14)):
        ours, theirs = (carried(robot, load) for robot in (robots.c, robots.numpy))
        for method, found in ours.items():
            np.testing.assert_allclose(found[0], theirs[method][0], rtol=0, atol=1e-8)
            assert np.array_equal(found[2], theirs[method][2])


def test_corners_lift_where_the_load_leaves_them(robot):
    """By the outer edge of the left sole: what touches stays on the ground, what hangs free is above it, and nothing pulls."""
    points, normals, load = robot.contact_points(STRIDE), robot.contact_normals(STRIDE), weight_at(0.0, 0.14)
    compliance = robot.stance_compliance(STRIDE)
    f, status, state, displacement, _ = robot.contact_forces_coupled(points, normals, 0.6, load, compliance.reshape(8, 3, 8, 3))
    assert status == OK
    assert 2 <= np.count_nonzero(state == FREE) <= 5
    assert np.max(np.abs(balance(points, f, load))) <= 1e-9
    height = (compliance @ f.ravel() + grasp(points).T @ displacement).reshape(8, 3)[:, 2]
    np.testing.assert_allclose(height[state != FREE], 0.0, rtol=0, atol=1e-12)
    assert np.all(height[state == FREE] > 0.0)
    assert not np.any(f[state == FREE])
    assert np.all(f[state != FREE, 2] > 0.0)


def test_rigid_soles_on_rigid_ground_are_refused(robot):
    """Without pads the compliance has six ways to move for the twelve forces of a sole."""
    n = np.array([0.0, 0.0, 1.0])
    pad = np.outer(n, n) / KN + (np.eye(3) - np.outer(n, n)) / KT
    bare = robot.stance_compliance(STRIDE) - np.kron(np.eye(8), pad)
    assert np.linalg.matrix_rank(bare, tol=1e-12 * np.max(bare)) == 12
    stance = robot.contact_points(STRIDE), n, 0.6
    with pytest.raises(ValueError, match=r"compliance is .*positive definite: add the ground's"):
        robot.contact_forces(*stance, weight_at(0, 0), method="stiffness", compliance=bare)
    f, status, *_ = robot.contact_forces_coupled(*stance, weight_at(0, 0), bare.reshape(8, 3, 8, 3))
    assert status == BAD_INPUT
    assert np.all(np.isnan(f))


def test_the_pressure_stands_under_the_load(robot):
    points, load = robot.contact_points(STRIDE), weight_at(0.03, 0.02)
    f = carried(robot, load)["stiffness"][0]
    left, right = (robot.legs[name].ground_pressure(f[4 * i : 4 * i + 4]) for i, name in enumerate(("left", "right")))
    assert (left[0] + right[0]) * LENGTH * WIDTH == pytest.approx(600.0, rel=1e-12)
    np.testing.assert_allclose(left[1], f[:4, 2] @ CORNERS / f[:4, 2].sum(), rtol=0, atol=1e-15)
    places = [points[:4].mean(axis=0)[:2] + left[1], points[4:].mean(axis=0)[:2] + right[1]]
    shared = np.array([left[0], right[0]]) / (left[0] + right[0])
    about = load[3:] - np.cross([0.0, 0.0, points[0, 2]], load[:3])  # a point of the ground
    np.testing.assert_allclose(shared @ places, [about[1] / 600.0, -about[0] / 600.0], rtol=0, atol=1e-12)
    tilted = robot.legs["left"].ground_pressure(f[:4], np.array([0.6, 0.0, 0.8]))
    assert tilted[0] == pytest.approx(f[:4].sum(axis=0) @ [0.6, 0.0, 0.8] / (LENGTH * WIDTH))
    with np.errstate(invalid="ignore"):
        lifted = robot.legs["left"].ground_pressure(np.zeros((4, 3)))
    assert lifted[0] == 0.0
    assert np.all(np.isnan(lifted[1]))


def test_casadi_agrees(built):
    robot, q = built(TEXT).c, STRIDE + 0.1
    for name in ("contact_points", "contact_normals", "stance_compliance"):
        np.testing.assert_allclose(np.array(robot.casadi(name)(q)), getattr(robot, name)(q), rtol=1e-11, atol=1e-14)
    left, f = robot.legs["left"], np.arange(12.0).reshape(4, 3)
    for name in ("sole_points", "sole_compliance"):
        np.testing.assert_allclose(np.array(robot.casadi(f"left_{name}")(q[:4])), getattr(left, name)(q[:4]), rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(np.array(robot.casadi("left_sole_normal")(q[:4]))[:, 0], left.sole_normal(q[:4]), rtol=0, atol=1e-14)
    pressure, centre = robot.casadi("left_ground_pressure")(f, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(float(pressure), left.ground_pressure(f)[0], rtol=1e-13)
    np.testing.assert_allclose(np.array(centre)[:, 0], left.ground_pressure(f)[1], rtol=1e-13)
    load = weight_at(0.03, 0.02)
    points, normals = robot.contact_points(STRIDE), robot.contact_normals(STRIDE)
    found = robot.casadi("contact_forces")(points, normals, np.full(8, 0.6), load, np.ones(8), np.full(8, np.inf), 0)
    np.testing.assert_allclose(np.array(found[0]), carried(robot, load)["least_squares"][0], rtol=0, atol=1e-8)


def test_feet_that_share_links_in_casadi(built):
    """The lines of docs/contact.md."""
    robot, load = built(TEXT).c, weight_at(0.02, 0.01)
    points, C = robot.casadi("contact_points")(STRIDE), robot.casadi("stance_compliance")(STRIDE)
    G = ca.horzcat(*(ca.vertcat(ca.DM.eye(3), ca.skew(points[i, :])) for i in range(points.shape[0])))
    S, misfit, wrench = ca.solve(C, G.T), ca.linspace(-1e-4, 1e-4, 24), ca.MX.sym("wrench", 6)
    delta = ca.solve(G @ S, wrench - S.T @ misfit)
    f = ca.Function("f", [wrench], [-S @ delta - ca.solve(C, misfit)])(load)
    expected, status, *_ = robot.contact_forces(
        robot.contact_points(STRIDE),
        robot.contact_normals(STRIDE),
        1e6,
        load,
        method="stiffness",
        compliance=robot.stance_compliance(STRIDE),
        misfit=np.linspace(-1e-4, 1e-4, 24).reshape(8, 3),
    )
    assert status == 0
    np.testing.assert_allclose(np.array(f).reshape(8, 3), expected, rtol=0, atol=1e-9)

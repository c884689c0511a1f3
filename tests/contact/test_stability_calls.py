"""Static stability as users call it: margins, their gradients, regions and pushes, with the robot's own gravity and mass."""

import numpy as np
import pytest
from heavy import HEAVY
from quadruped import spec

from oracles.stability import O15_COM, O15_ENERGY, O15_HEIGHTS, O15_LONGITUDINAL, O15_POINTS, O15_STATIC
from oracles.stances import random_rotation
from walkgen.errors import UnsupportedMechanism
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load

OK, BAD_INPUT, SINGULAR = 0, 2, 3
AHEAD = [1.0, 0.0, 0.0]


@pytest.fixture(params=["c", "numpy"])
def robot(request, built):
    return getattr(built(HEAVY), request.param)


def test_the_example_with_the_robots_own_weight(robot):
    found = robot.stability_margins(O15_POINTS, O15_COM, AHEAD)
    static, status, longitudinal, energy, height, friction, polygon, vertices, edge, heights = found
    assert found.static_margin == static
    assert found.tipping_edge is edge
    assert status == OK
    assert static == pytest.approx(O15_STATIC, abs=1e-12)
    assert friction == static
    np.testing.assert_allclose(longitudinal, O15_LONGITUDINAL, rtol=0, atol=1e-12)
    np.testing.assert_allclose(heights, O15_HEIGHTS, rtol=0, atol=1e-12)
    assert height == heights.min()
    assert energy == pytest.approx(O15_ENERGY, abs=1e-12)
    assert (polygon.tolist(), int(vertices), edge.tolist()) == ([0, 1, 2, 3], 4, [0, 1])
    assert (polygon.dtype, vertices.dtype) == (np.int32, np.int32)


def test_gravity_and_mass_are_runtime_parameters_or_given(robot):
    usual = robot.stability_margins(O15_POINTS, O15_COM, AHEAD)[3]
    laden = robot.stability_margins(O15_POINTS, O15_COM, AHEAD, param=[20.0, -9.81])[3]
    moon = robot.stability_margins(O15_POINTS, O15_COM, AHEAD, param=[0.0, -1.62])[3]
    assert laden == pytest.approx(usual * 80 / 60, rel=1e-13)
    assert moon == pytest.approx(usual * 1.62 / 9.81, rel=1e-13)
    R = random_rotation(np.random.default_rng(1))
    turned = robot.stability_margins(O15_POINTS @ R.T, R @ O15_COM, R @ AHEAD, mass=80.0, gravity=R @ [0.0, 0.0, -1.62])[3]
    assert turned == pytest.approx(usual * 80 / 60 * 1.62 / 9.81, rel=1e-12)


def test_friction_counts_where_it_is_given(robot):
    slope = np.tile([np.sin(0.6), 0.0, np.cos(0.6)], (4, 1))
    smooth, fine = robot.stability_margins(O15_POINTS, O15_COM, AHEAD, 0.9, slope)[:2]
    assert (smooth, fine) == (pytest.approx(O15_STATIC), OK)
    rough = [robot.stability_margins(O15_POINTS, O15_COM, AHEAD, mu, slope)[5] for mu in (0.9, 0.7)]
    assert rough[1] <= rough[0] + 1e-9
    assert robot.stability_margins(O15_POINTS, O15_COM, AHEAD, 0.6, slope)[1] == 5  # tan(0.6) is 0.68: INFEASIBLE


def test_gradients_and_batches(robot):
    coms = O15_COM + np.random.default_rng(2).uniform(-0.1, 0.1, (3, 2, 3))
    d_static, status, d_way, d_energy, d_height, d_friction = robot.stability_margins_d_com(O15_POINTS, coms, AHEAD, 0.8)
    assert [item.shape for item in (d_static, status, d_way, d_energy)] == [(3, 2, 3), (3, 2), (3, 2, 2, 3), (3, 2, 3)]
    np.testing.assert_allclose(d_energy, 588.6 * d_height, rtol=1e-12)
    np.testing.assert_allclose(d_friction, d_static, rtol=0, atol=1e-6)  # level ground: the same border
    margins = robot.stability_margins(O15_POINTS, coms, AHEAD)
    moved = robot.stability_margins(O15_POINTS, coms + 1e-7 * d_static, AHEAD)
    np.testing.assert_allclose(moved[0] - margins[0], 1e-7, rtol=1e-6)


def test_a_region_and_pushes(robot):
    polygon, status, vertices, error = robot.feasible_region(O15_POINTS, 0.6)
    assert (polygon.shape, status) == ((64, 3), OK)
    assert vertices == 4
    assert error <= 1e-4
    force, status, direction = robot.disturbance_margin(O15_POINTS, O15_COM, 0.2, O15_COM)
    assert status == OK
    assert force == pytest.approx(0.2 * 588.6, rel=1e-9)
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    tips, status, _ = robot.disturbance_margin(O15_POINTS, O15_COM, 5.0, O15_COM + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.5]]))
    assert np.all(status == OK)
    assert tips[1] < tips[0]  # the higher the wind


@pytest.mark.nightly
def test_single_precision(tmp_path):
    (tmp_path / "spec.toml").write_text(spec("stability_margins"), encoding="utf-8")
    robot = load(build(tmp_path / "spec.toml", tmp_path, BuildOptions(float32=True, targets=("c",))).folder)
    found = robot.stability_margins(*(np.array(item, np.float32) for item in (O15_POINTS, O15_COM, AHEAD)))
    assert found[0].dtype == np.float32
    assert found[0] == pytest.approx(O15_STATIC, abs=1e-6)


def test_what_is_wrong_is_said(robot):
    assert robot.stability_margins(O15_POINTS[:2], O15_COM, AHEAD)[1] == SINGULAR
    mixed = robot.stability_margins(O15_POINTS, O15_COM, [AHEAD, [0.0, 0.0, 1.0]])
    assert mixed.status.tolist() == [OK, BAD_INPUT]
    assert np.isnan(mixed.static_margin).tolist() == [False, True]
    for change, words in (
        ({"direction": [0.0, 0.0, 0.0]}, "direction is .* that is not along gravity"),
        ({"direction": [0.0, 0.0, 1.0]}, "direction along gravity"),
        ({"mu": [0.5, 0.5, -0.1, 0.5]}, "mu is .* not negative"),
        ({"centre_of_mass": [0.0, np.nan, 0.5]}, "centre_of_mass has NaN"),
        ({"normals": [0.0, 0.0, 0.5], "mu": 0.5}, "normals is .* unit vectors"),
        ({"mass": -1.0}, "mass is -1"),
    ):
        with pytest.raises(ValueError, match=words):
            robot.stability_margins(**({"points": O15_POINTS, "centre_of_mass": O15_COM, "direction": AHEAD} | change))
    with pytest.raises(ValueError, match="tolerance is 0"):
        robot.feasible_region(O15_POINTS, 0.6, tolerance=0.0)
    with pytest.raises(TypeError, match="misses direction"):
        robot.stability_margins(O15_POINTS, O15_COM)
    with pytest.raises(ValueError, match="1 to 16"):
        robot.stability_margins(np.zeros((17, 3)), O15_COM, AHEAD)
    with pytest.raises(UnsupportedMechanism, match="no CasADi form"):
        robot.casadi("stability_margins")


def test_the_own_mass_is_what_the_ground_carries(built):
    for param in ([0.0, -9.81], [7.0, -3.0]):
        robot = built(HEAVY).c
        load = robot.demanded_wrench(np.eye(4), np.zeros(4), np.zeros(10), np.zeros(10), param=param)
        *_, energy, height = robot.stability_margins(O15_POINTS, O15_COM, AHEAD, param=param)[:5]
        assert energy / height == pytest.approx(-load[2], rel=1e-13)

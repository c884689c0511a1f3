"""How `contact_forces` is called: any number of feet, values that serve all of them, methods, batches, precisions, mistakes."""

import numpy as np
import pytest
from quadruped import INFEASIBLE, balance, spec, stands

from oracles.backends import BACKENDS
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load

DOWN = [0.0, 0.0, -100.0, 0.0, 0.0, 0.0]
SQUARE = np.array([[0.3, 0.2, 0.0], [0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0]])


@pytest.fixture(params=[name for name in BACKENDS if name in {"c", "numpy"}])
def robot(request, built):
    return getattr(built(spec("contact_forces", more=", derivatives = false")), request.param)


@pytest.mark.parametrize("feet", [3, 4, 6, 16])
def test_any_number_of_feet(robot, feet):
    points, normals, mu, wrench = stands(3, feet, seed=feet, slope=0.1)
    f, status, state, certificate, violation = robot.contact_forces(points, normals, mu, wrench)
    assert f.shape == (3, feet, 3)
    assert np.all(status == 0)
    assert np.all((state >= 0) & (state <= 2))
    assert np.max(np.abs(balance(points, f, wrench))) <= 1e-9
    assert np.array_equal(certificate, np.zeros((3, 6)))
    assert np.all(violation <= 1e-9)


def test_one_value_serves_all_feet_and_rows(robot):
    points = np.stack([SQUARE, 2 * SQUARE])
    one = robot.contact_forces(points, [0, 0, 1], 0.5, DOWN)
    for row in range(2):
        alone = robot.contact_forces(
            points[row], np.tile([0.0, 0.0, 1.0], (4, 1)), np.full(4, 0.5), DOWN, weight=np.ones(4), n_max=np.full(4, np.inf)
        )
        assert all(np.array_equal(part[row], whole) for part, whole in zip(one, alone, strict=True))
    np.testing.assert_allclose(one[0], np.broadcast_to([0, 0, 25.0], (2, 4, 3)), atol=1e-12)
    rows = robot.contact_forces(points[:, None], [0, 0, 1], np.array([0.2, 0.4, 0.9])[:, None], DOWN)
    assert rows[0].shape == (2, 3, 4, 3)


def test_loads_that_cannot_be_carried_are_proven(robot):
    push = [80.0, 0.0, -100.0, 0.0, 0.0, 0.0]
    f, status, state, certificate, violation = robot.contact_forces(SQUARE, [0, 0, 1], 0.5, push)
    assert status == INFEASIBLE
    assert np.all(np.isnan(f))
    assert abs(certificate @ push - 1) <= 1e-12
    pull = certificate[:3] + np.cross(certificate[3:], SQUARE)  # certificate . (f, p x f) = pull . f
    assert np.all(pull[:, 2] >= 0.5 * np.linalg.norm(pull[:, :2], axis=1) - 1e-12)
    assert violation > 1.0
    assert state.shape == (4,)


def test_facets_lie_inside_the_cone(robot):
    push = [34.0, 34.0, -100.0, 0.0, 0.0, 0.0]
    assert robot.contact_forces(SQUARE, [0, 0, 1], 0.5, push)[1] == 0
    assert robot.contact_forces(SQUARE, [0, 0, 1], 0.5, push, cone=np.int64(64))[1] == 0
    assert robot.contact_forces(SQUARE, [0, 0, 1], 0.4, [40.0, 0, -100, 0, 0, 0], cone=4)[1] == INFEASIBLE  # a corner's cosine less


def test_largest_normal_forces_and_weights(robot):
    f, status, *_ = robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, n_max=[20.0, np.inf, np.inf, np.inf])
    assert status == 0
    assert f[0, 2] == pytest.approx(20.0)
    free = robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, weight=[4.0, 1.0, 1.0, 4.0])[0]
    assert free[0, 2] < 25.0 < free[1, 2]


def test_mistakes_are_named(robot):
    with pytest.raises(ValueError, match="k is 17; 1 to 16"):
        robot.contact_forces(np.zeros((17, 3)), [0, 0, 1], 0.5, DOWN)
    with pytest.raises(ValueError, match=r"normals has shape \[4\]"):
        robot.contact_forces(SQUARE, [0, 0, 1, 0], 0.5, DOWN)
    with pytest.raises(ValueError, match="points has shape"):
        robot.contact_forces([0, 0, 1], [0, 0, 1], 0.5, DOWN)
    with pytest.raises(ValueError, match="cone is 2"):
        robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, cone=2)
    with pytest.raises(ValueError, match=r"cone is 1025; give .* 3 to 1024"):
        robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, cone=1025)
    for option in ({"cone": 4}, {"torque_rows": np.zeros((1, 4, 3))}):
        with pytest.raises(TypeError, match=f"'stiffness' has no {next(iter(option))}"):
            robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, method="stiffness", compliance=np.eye(12), **option)
        with pytest.raises(TypeError, match=f"'vertical' has no {next(iter(option))}"):
            robot.contact_forces(SQUARE[:3], [0, 0, 1], None, DOWN, method="vertical", **option)
    with pytest.raises(ValueError, match="'best' is not a method"):
        robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, method="best")
    with pytest.raises(TypeError, match="misses wrench"):
        robot.contact_forces(SQUARE, [0, 0, 1], 0.5)
    with pytest.raises(TypeError, match="speed"):
        robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, speed=1)


BAD = {
    "mu of foot 1 is nan; give finite": {"mu": [0.5, np.nan, 0.5, 0.5]},
    "mu of foot 1 is -1; coefficients of friction are 0 or more": {"mu": [0.5, -1.0, 0.5, 0.5]},
    "mu of foot 1 is inf; coefficients of friction are": {"mu": [0.5, np.inf, 0.5, 0.5]},
    "mu is -0.1; coefficients": {"mu": -0.1},
    "normals of foot 2 is .0.* 2.*unit vector": {"normals": [[0, 0, 1], [0, 0, 1], [0, 0, 2], [0, 0, 1]]},
    "normals is .*unit vector": {"normals": [0, 0, 0]},
    "points of foot 3 is .*nan.*finite": {"points": SQUARE * [[1], [1], [1], [np.nan]]},
    "wrench is .*nan": {"wrench": [0.0, 0.0, np.nan, 0.0, 0.0, 0.0]},
    "weight of foot 0 is 0; weights are above 0": {"weight": [0.0, 1.0, 1.0, 1.0]},
    "n_max of foot 0 is -5; the largest": {"n_max": [-5.0, 9.0, 9.0, 9.0]},
}


@pytest.mark.parametrize("words", BAD)
def test_bad_numbers_are_named(robot, words):
    stance = {"points": SQUARE, "normals": [0, 0, 1], "mu": 0.5, "wrench": DOWN}
    with pytest.raises(ValueError, match=f"contact_forces: {words}"):
        robot.contact_forces(**(stance | BAD[words]))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0])
def test_bad_rows_have_a_status(robot, bad):
    f, status, *_ = robot.contact_forces(SQUARE, [0, 0, 1], [[0.5, bad, 0.5, 0.5], [0.5] * 4], DOWN)
    assert status.tolist() == [2, 0]
    assert np.all(np.isnan(f[0]))


def test_a_robot_of_one_leg_shares_nothing(built):
    robot = built(spec("contact_forces", "foot_positions", legs=1)).c
    with pytest.raises(AttributeError, match="contact_forces"):
        robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN)


def test_runtime_parameters_come_last(built):
    robot = built(spec("contact_forces", parameters="[parameters]\nload = { value = 1.0, runtime = true }\n")).c
    f, status, *_ = robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, param=[2.0])
    assert status == 0
    assert f[0, 2] == pytest.approx(25.0)


def test_arrays_need_not_be_dense(robot):
    points, normals, mu, wrench = stands(5, 4, seed=3, slope=0.1)
    expected = robot.contact_forces(points, normals, mu, wrench)
    turned = [np.asfortranarray(array) for array in (points, normals, mu, wrench)]
    wide = np.zeros((5, 4, 6))
    wide[..., ::2] = points
    found = robot.contact_forces(wide[..., ::2], turned[1], turned[2], turned[3])
    for part, whole in zip(found, expected, strict=True):
        np.testing.assert_array_equal(part, whole)


def test_single_precision(tmp_path):
    (tmp_path / "spec.toml").write_text(spec("contact_forces", legs=2))
    robot = load(build(tmp_path / "spec.toml", tmp_path, BuildOptions(float32=True, targets=("c",))).folder)
    stance = stands(20, 5, seed=4, slope=0.1)
    f, status, *_ = robot.contact_forces(*(array.astype(np.float32) for array in stance))
    expected, verdict, *_ = robot.contact_forces(*stance)
    assert (f.dtype, expected.dtype) == (np.float32, np.float64)
    assert np.array_equal(status, verdict)
    np.testing.assert_allclose(f, expected, atol=1e-3)


def test_limits_of_joint_torques(built):
    """Two feet of four may push along their normals by at most 20 N: the others bear the rest; one row too many has a proof."""
    robots = built(spec("contact_forces", "contact_forces_limited"))
    rows = np.zeros((2, 4, 3))
    rows[0, 0, 2] = rows[1, 1, 2] = 1.0
    for robot in (robots.c, robots.numpy):
        options = {"torque_rows": rows, "torque_limits": [20.0, np.inf]}
        f, status, *_, certificate, _ = robot.contact_forces(SQUARE, [0, 0, 1], 0.5, DOWN, **options)
        assert status == 0
        assert f[0, 2] == pytest.approx(20.0, abs=1e-9)
        assert np.max(np.abs(balance(SQUARE, f, np.array(DOWN)))) <= 1e-9
        found = robot.contact_forces_limited(SQUARE, [0, 0, 1], 0.5, DOWN, rows, [20.0, 20.0])
        assert (found[1], found[5].shape) == (INFEASIBLE, (2,))
        assert certificate.shape == (6,)
        assert abs(found[3] @ DOWN - found[5] @ [20.0, 20.0] - 1.0) <= 1e-6


def test_forces_along_the_normals_under_any_limit(built):
    """All on the cones' axes, where the way to the boundary has a double root."""
    robots = built(spec("contact_forces", "contact_forces_limited"))
    row = np.zeros((1, 4, 3))
    row[0, 0, 2] = 1.0
    most = np.linspace(0.5, 24.5, 97)
    for robot in (robots.c, robots.numpy):
        f, status, *_ = robot.contact_forces_limited(SQUARE, [0, 0, 1], 0.5, DOWN, row, most[:, None])
        assert (status == 0).all()
        np.testing.assert_allclose(f[:, 0, 2], most, atol=1e-9)

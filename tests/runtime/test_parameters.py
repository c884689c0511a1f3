"""Runtime parameters come by the keyword `param`, the spec's values by default."""

from collections.abc import Callable

import numpy as np
import pytest

from walkgen.runtime import Robot

Robots = Callable[..., Robot]
Q = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])


@pytest.fixture(params=("c", "numpy"))
def robot(request: pytest.FixtureRequest, robots: Robots) -> Robot:
    return robots("parameters", request.param)


def test_default_is_the_specs(robot: Robot) -> None:
    assert dict(robot.parameters) == {"scale": 2.0, "shift": 0.5}
    np.testing.assert_array_equal(robot.legs["left"].foot_position(Q)[:, 0], [6.5, 18.5])


def test_given_by_keyword_and_broadcast(robot: Robot) -> None:
    function = robot.legs["left"].foot_position
    np.testing.assert_array_equal(function(Q, param=[10, 1])[:, 0], [31, 91])
    np.testing.assert_array_equal(function(Q[0], param=[[10, 1], [100, 1]])[:, 0], [31, 301])
    np.testing.assert_array_equal(function(Q, param=np.array([[[10, 1]], [[100, 1]]]))[..., 0], [[31, 91], [301, 901]])


def test_out_passes_through(robot: Robot) -> None:
    out = np.empty((2, 3))
    assert robot.legs["left"].foot_position(Q, param=[10, 1], out=out) is out
    assert out[1, 0] == 91


def test_not_by_position(robot: Robot) -> None:
    with pytest.raises(TypeError, match="keyword param"):
        robot.legs["left"].foot_position(Q, [10, 1])


def test_wrong_length(robot: Robot) -> None:
    with pytest.raises(ValueError, match="dimension"):
        robot.legs["left"].foot_position(Q, param=[1, 2, 3])


def test_function_of_parameters_alone(robot: Robot) -> None:
    np.testing.assert_array_equal(robot.platform_poses(), np.eye(4)[None])
    assert robot.platform_poses(param=np.ones((5, 2))).shape == (5, 1, 4, 4)


def test_default_keeps_float32(robots: Robots) -> None:
    function = robots("both").legs["left"].foot_position
    assert function(Q.astype(np.float32)).dtype == np.float32
    assert function(Q).dtype == np.float64
    assert function(Q.astype(np.float32), param=np.array([1.0, 0.0])).dtype == np.float64


def test_says_what_it_takes(robots: Robots) -> None:
    assert repr(robots("parameters").legs["left"].foot_position) == "<function 'tiny_left_foot_position' with param=[2]>"

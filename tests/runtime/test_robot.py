"""What a loaded robot says of itself, and of what it does not have."""

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import FrozenInstanceError
from pathlib import Path

import numpy as np
import pytest
from tiny_robot import Tiny, write

from walkgen.errors import ToolchainError, UnsupportedMechanism
from walkgen.runtime import MissingFunction, Robot, load

Robots = Callable[..., Robot]


def test_describes_itself(robots: Robots) -> None:
    robot = robots()
    assert (robot.name, robot.description, robot.platforms) == ("tiny", "A robot checked by hand", ("body",))
    assert robot.joint_names == ("left_yaw", "left_pitch", "left_knee")
    np.testing.assert_array_equal(robot.limits, [[-1, 1], [-np.inf, np.inf], [-2, 2]])
    assert dict(robot.parameters) == {}
    assert (list(robot.legs), list(robot.chains), list(robot.routes)) == (["left"], [], [])
    assert repr(robot).startswith("<robot 'tiny': 1 platforms, 1 legs, 3 joints, 10 functions in c (found ")


def test_leg_describes_itself(robots: Robots) -> None:
    leg = robots().legs["left"]
    assert (leg.name, leg.platform, leg.joints, leg.slice) == ("left", "body", ("yaw", "pitch", "knee"), slice(0, 3))
    np.testing.assert_array_equal(leg.limits, robots().limits)
    assert repr(leg) == "<leg 'left' on 'body': yaw, pitch, knee; inverse general RRR; 8 functions>"
    assert "foot_position" in dir(leg)
    assert leg.foot_position is leg.functions["foot_position"]


def test_nothing_can_be_changed(robots: Robots) -> None:
    robot = robots()
    with pytest.raises(FrozenInstanceError):
        robot.name = "other"
    with pytest.raises(TypeError):
        robot.legs["right"] = robot.legs["left"]
    with pytest.raises(ValueError, match="read-only"):
        robot.limits[0, 0] = 5


def test_unknown_name_is_an_attribute_error_with_the_nearest(robots: Robots) -> None:
    leg = robots().legs["left"]
    assert not hasattr(leg, "nonsense")
    with pytest.raises(AttributeError, match="did you mean foot_position"):
        leg.foot_positon  # noqa: B018
    with pytest.raises(AttributeError) as error:
        leg.nonsense  # noqa: B018
    assert not isinstance(error.value, UnsupportedMechanism)


def test_known_name_says_why_it_is_not_there(robots: Robots) -> None:
    leg = robots().legs["left"]
    assert not hasattr(leg, "inverse_pose")
    with pytest.raises(UnsupportedMechanism, match="cannot give the foot every pose") as error:
        leg.inverse_pose  # noqa: B018
    assert isinstance(error.value, MissingFunction)
    assert error.value.problems[0].code == "WG410"
    with pytest.raises(UnsupportedMechanism, match="was not built"):
        leg.mass_matrix  # noqa: B018
    with pytest.raises(UnsupportedMechanism, match="did you mean foot_positions"):
        robots().foot_jacobians  # noqa: B018


def test_pickled_and_copied_by_its_folder(robots: Robots) -> None:
    robot = robots()
    for other in (pickle.loads(pickle.dumps(robot)), copy.deepcopy(robot)):  # noqa: S301
        assert (other.folder, other.backend) == (robot.folder, "c")
        np.testing.assert_array_equal(other.foot_positions([1, 2, 3]), [[1, 2, 3]])


@pytest.mark.parametrize("name", ["tiny_left_foot_position", "left_foot_position"])
def test_casadi(robots: Robots, name: str) -> None:
    function = robots().casadi(name)
    np.testing.assert_allclose(np.array(function([1, 2, 3])).ravel(), [3, 6, np.cos(3)], rtol=1e-15)


def test_casadi_without_a_form(robots: Robots) -> None:
    with pytest.raises(UnsupportedMechanism, match="has no CasADi form") as error:
        robots().casadi("left_gravity_torque")
    assert error.value.problems[0].code == "WG411"


def test_casadi_of_no_function(robots: Robots) -> None:
    with pytest.raises(AttributeError, match="did you mean left_foot_position"):
        robots().casadi("left_foot_positio")


def test_casadi_file_not_built(built: Path) -> None:
    (built / "tiny_casadi.py").unlink()
    with pytest.raises(ToolchainError, match="targets") as error:
        load(built).casadi("left_foot_position")
    assert error.value.problems[0].code == "WG412"


def test_casadi_not_installed(built: Path) -> None:
    code = f"""
import sys
sys.modules["casadi"] = None
from walkgen.errors import ToolchainError
from walkgen.runtime import load
try:
    load({str(built)!r}).casadi("left_foot_position")
except ToolchainError as error:
    print(error)
"""
    answer = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert "needs casadi, which is not installed" in answer.stdout
    assert "pip install casadi" in answer.stdout


def test_two_robots_in_one_process(robots: Robots, tmp_path: Path) -> None:
    twin = load(write(Tiny(name="twin", functions=("foot_position", "foot_positions")), tmp_path / "twin"))
    assert list(twin.functions) == ["twin_left_foot_position", "twin_foot_positions"]
    np.testing.assert_array_equal(twin.legs["left"].foot_position([1, 2, 3]), robots().legs["left"].foot_position([1, 2, 3]))


def test_ufunc_outlives_its_robot(built: Path) -> None:
    function = load(built).legs["left"].foot_torque
    np.testing.assert_array_equal(function(np.ones((2, 3)), [1, 2, 3], 0), [6, 6])
    assert function.__doc__.startswith("tiny_left_foot_torque(")

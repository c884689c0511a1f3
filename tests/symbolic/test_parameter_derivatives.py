"""`<name>_d_param` of a built robot against central differences: a length, a twist, an offset and a chain's length at run time."""

import numpy as np
import pytest

TEXT = """walkgen = 1
[robot]
name = "tunable"
gravity = [0, 0, -9.81]
[generate]
derivatives = true
functions = [
    "foot_position", "foot_pose", "foot_jacobian", "foot_spatial_jacobian", "foot_hessian", "foot_velocity", "foot_acceleration",
    "foot_bias_acceleration", "joint_frames", "pose", "jacobian", "frames", "platform_poses", "foot_positions", "foot_jacobians",
]
targets = ["c"]
[parameters]
shank = { value = 0.40, unit = "m", runtime = true }
tilt = { value = 0.7, unit = "rad", runtime = true }
offset = { value = 0.05, unit = "m", runtime = true }
boom = { value = 0.25, unit = "m", runtime = true }
half = "shank/2"
[leg_designs.leg]
dh = "classic"
joints = [
  { name = "yaw", type = "revolute", a = "half", alpha = "tilt", d = "offset" },
  { name = "lift", type = "revolute", a = 0.3, alpha_deg = 0, d = "-2*offset" },
  { name = "slide", type = "prismatic", a = "shank", alpha = "pi/2 - tilt", d = 0.1, theta_deg = 30 },
]
[chain_designs.waist]
dh = "craig"
joints = [{ name = "yaw", type = "revolute", a = "boom", alpha = "-tilt", d = 0.1 }]
[[platforms]]
name = "front"
[[platforms]]
name = "rear"
parent = "front"
chain = "waist"
root = { xyz = [-0.2, 0, 0], rpy_deg = [0, 0, 180] }
end = "level"
end_xyz = ["-boom", 0, 0]
[[legs]]
name = "left"
design = "leg"
platform = "rear"
mount = { xyz = [0, "offset", 0], rpy_deg = [0, 0, 90] }
[[legs]]
name = "right"
mirror_of = "left"
"""
VALUES = np.array([0.42, 0.9, -0.03, 0.2])
STEP = 1e-5
FORWARD = {
    "foot_position": 1,
    "foot_pose": 1,
    "foot_jacobian": 1,
    "foot_spatial_jacobian": 1,
    "foot_hessian": 1,
    "foot_velocity": 2,
    "foot_acceleration": 3,
    "foot_bias_acceleration": 2,
    "joint_frames": 1,
}
generator = np.random.default_rng(3)


@pytest.fixture(scope="module")
def robot(built):
    return built(TEXT).c


def assert_slopes(function, slopes, *inputs):
    steps = np.eye(len(VALUES)) * STEP
    expected = [(function(*inputs, param=VALUES + step) - function(*inputs, param=VALUES - step)) / (2 * STEP) for step in steps]
    found = slopes(*inputs, param=VALUES)
    assert found.shape == (*expected[0].shape, len(VALUES))
    assert np.max(np.abs(found - np.stack(expected, axis=-1))) <= 1e-8
    return found


@pytest.mark.sampled(8)
@pytest.mark.parametrize("leg", ["left", "right"])
@pytest.mark.parametrize("name", FORWARD)
def test_legs(robot, leg, name):
    inputs = generator.uniform(-1, 1, (FORWARD[name], 4, 3))
    owner = robot.legs[leg]
    found = assert_slopes(getattr(owner, name), getattr(owner, f"{name}_d_param"), *inputs)
    assert not np.any(found[..., 3])  # the leg does not know the chain's boom
    assert np.any(found[..., 0])
    assert np.any(found[..., 1])


@pytest.mark.parametrize("name", ["pose", "jacobian", "frames"])
def test_chains(robot, name):
    chain = robot.chains["rear"]
    found = assert_slopes(getattr(chain, name), getattr(chain, f"{name}_d_param"), generator.uniform(-1, 1, (4, 1)))
    assert not np.any(found[..., [0, 2]])


@pytest.mark.parametrize("name", ["platform_poses", "foot_positions", "foot_jacobians"])
def test_robot(robot, name):
    assert_slopes(getattr(robot, name), getattr(robot, f"{name}_d_param"), generator.uniform(-1, 1, (4, 7)))


def test_routes(robot):
    functions = robot.functions
    q = generator.uniform(-1, 1, (4, 4))
    found = assert_slopes(functions["tunable_root_to_left_foot_position"], functions["tunable_root_to_left_foot_position_d_param"], q)
    assert np.any(found[..., 3])

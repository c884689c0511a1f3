"""Every kinematic sample of the reference cases, in every way walkgen computes it, and these ways against each other."""

from itertools import combinations

import numpy as np
import pytest

from cases.to_spec import LEG_CASES, ROBOT_CASES, case, from_dh, from_tree
from oracles.backends import BACKENDS
from oracles.measure import difference
from walkgen.spec.functions import FORWARD_FUNCTIONS

ACCURACY = 1e-12
AGREEMENT = 1e-13
ROBOT = ("foot_positions", "foot_jacobians", "platform_poses")
FORWARD = ("foot_position", "foot_rotation", "foot_spatial_jacobian", "foot_hessian", "joint_frames")


def stacked(samples, key):
    return np.array([sample[key] for sample in samples])


def conversions(data):
    """By the tree of joints, and by the DH table; a robot's legs are tested one by one elsewhere."""
    wanted = ROBOT if data["kind"] == "robot" else FORWARD_FUNCTIONS
    return {"tree": from_tree(data, wanted), "dh": from_dh(data, data.get("dh_chains"), wanted)}


@pytest.fixture(params=["tree", "dh"])
def route(request):
    return request.param


LEGS = [
    pytest.param(name, way, id=f"{name}-{way}", marks=pytest.mark.nightly if (index + turn) % 2 else ())
    for index, name in enumerate(LEG_CASES)
    for turn, way in enumerate(("tree", "dh"))
]
"""The ordinary run takes every leg by one of the two."""


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("name", "route"), LEGS)
def test_leg_samples(built, name, route, backend):
    data = case(name)
    conversion = conversions(data)[route]
    robot, (foot,) = built(conversion.text), conversion.feet
    samples = data["samples"]
    q, qd, qdd = (stacked(samples, key) for key in ("q", "qd", "qdd"))
    assert conversion.order == tuple(range(q.shape[1]))
    assert difference(robot.call(backend, foot, "foot_position", q), stacked(samples, "p")) <= ACCURACY
    assert difference(robot.call(backend, foot, "foot_rotation", q), stacked(samples, "R")) <= ACCURACY
    J = stacked(samples, "J")
    assert difference(robot.call(backend, foot, "foot_spatial_jacobian", q), J) <= ACCURACY
    assert difference(robot.call(backend, foot, "foot_jacobian", q), J[:, :3]) <= ACCURACY
    assert difference(robot.call(backend, foot, "foot_bias_acceleration", q, qd), stacked(samples, "Jdot_qd")) <= ACCURACY
    acceleration = stacked(samples, "acc_classical")[:, :3]
    assert difference(robot.call(backend, foot, "foot_acceleration", q, qd, qdd), acceleration) <= ACCURACY
    velocity = np.einsum("nij,nj->ni", J[:, :3], qd)
    assert difference(robot.call(backend, foot, "foot_velocity", q, qd), velocity) <= ACCURACY


@pytest.mark.parametrize(("name", "route"), LEGS)
def test_leg_ways_agree(built, name, route):
    data = case(name)
    conversion = conversions(data)[route]
    robot, (foot,) = built(conversion.text), conversion.feet
    q = stacked(data["samples"], "q")
    for function in FORWARD:
        ways = [robot.call(backend, foot, function, q) for backend in BACKENDS]
        for one, other in combinations(ways, 2):
            assert difference(one, other) <= AGREEMENT, function


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", ROBOT_CASES)
def test_robot_samples(built, name, route, backend):
    data = case(name)
    conversion = conversions(data)[route]
    robot, order = built(conversion.text), list(conversion.order)
    samples = data["samples"]
    q, v = stacked(samples, "q"), stacked(samples, "v")
    base_R, base_pos = stacked(samples, "base_R"), stacked(samples, "base_pos")
    local = robot.call(backend, "", "foot_positions", q[:, order])
    feet = np.einsum("nij,nfj->nfi", base_R, local) + base_pos[:, None]
    assert difference(feet, stacked(samples, "feet")) <= ACCURACY
    J = robot.call(backend, "", "foot_jacobians", q[:, order])
    moving = v[:, None, :3] + np.cross(v[:, None, 3:6], local) + np.einsum("nfij,nj->nfi", J, v[:, 6:][:, order])
    assert difference(np.einsum("nij,nfj->nfi", base_R, moving), stacked(samples, "feet_vel")) <= ACCURACY


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", ROBOT_CASES)
def test_robot_jacobian_samples(built, name, backend):
    """The joint columns of the published foot Jacobians; only the first samples carry them."""
    data = case(name)
    conversion = conversions(data)["tree"]
    samples = [sample for sample in data["samples"] if "J_feet_lin" in sample]
    assert samples
    J = built(conversion.text).call(backend, "", "foot_jacobians", stacked(samples, "q")[:, list(conversion.order)])
    world = np.einsum("nij,nfjk->nfik", stacked(samples, "base_R"), J)
    assert difference(world, stacked(samples, "J_feet_lin")[..., 6:][..., list(conversion.order)]) <= ACCURACY


@pytest.mark.parametrize("name", ROBOT_CASES)
def test_robot_ways_agree(built, name, route):
    data = case(name)
    conversion = conversions(data)[route]
    robot = built(conversion.text)
    q = stacked(data["samples"], "q")[:, list(conversion.order)]
    for function in ROBOT:
        ways = [robot.call(backend, "", function, q) for backend in BACKENDS]
        for one, other in combinations(ways, 2):
            assert difference(one, other) <= AGREEMENT, function

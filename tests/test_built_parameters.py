"""Runtime parameters: the same leg for any value, and derivatives by complex steps through the walker."""

import numpy as np
import pytest

from oracles.measure import difference
from oracles.walker import STEP, read

NAMES = ("shank", "heel")
VALUES = np.array([0.47, 0.03])
FUNCTIONS = {
    "foot_position": lambda leg, q: leg.position(q),
    "foot_pose": lambda leg, q: leg.pose(q),
    "foot_jacobian": lambda leg, q: leg.cross_jacobian(q)[:3],
    "joint_frames": lambda leg, q: leg.frames(q),
}


@pytest.fixture(scope="module")
def robot(shipped):
    return shipped("mero_leg_param")


@pytest.fixture(params=["c", "numpy"])
def leg(request, robot):
    return (robot.c if request.param == "c" else robot.numpy).legs["leg"]


def walker_leg(robot, values):
    return read(robot.spec.read_text(encoding="utf-8"), **dict(zip(NAMES, values, strict=True))).legs[0]


Q = np.random.default_rng(8).uniform(-2, 2, (6, 3))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_values(robot, leg, name):
    function = getattr(leg, name)
    for values, found in ((VALUES, function(Q, param=VALUES)), ((0.40, 0.02), function(Q))):
        walker = walker_leg(robot, values)
        assert difference(found, [FUNCTIONS[name](walker, q) for q in Q]) <= 1e-14


@pytest.mark.parametrize("name", FUNCTIONS)
def test_derivatives(robot, leg, name):
    found = getattr(leg, f"{name}_d_param")(Q, param=VALUES)
    legs = [walker_leg(robot, VALUES + step) for step in np.eye(2) * 1j * STEP]
    expected = [np.stack([FUNCTIONS[name](one, q).imag / STEP for one in legs], axis=-1) for q in Q]
    assert difference(found, expected) <= 1e-13


def test_parameters_broadcast(robot, leg):
    many = np.array([VALUES, VALUES * 0.8, VALUES * 0.6])
    found = leg.foot_position(Q[:, None], param=many)
    assert found.shape == (6, 3, 3)
    for column, values in enumerate(many):
        assert difference(found[:, column], [walker_leg(robot, values).position(q) for q in Q]) <= 1e-14


def test_inverse_returns_to_the_foot(robot, leg):
    walker = walker_leg(robot, VALUES)
    for q in Q:
        p = walker.position(q)
        rows, status = leg.inverse(p, param=VALUES)
        assert np.count_nonzero(status == 0) >= 2
        for row in rows[status == 0]:
            assert difference(walker.position(row), p) <= 1e-13


def test_casadi_takes_param_last(robot):
    function = robot.c.casadi("leg_foot_position")
    walker = walker_leg(robot, VALUES)
    for q in Q:
        assert difference(np.array(function(q, VALUES)).ravel(), walker.position(q)) <= 1e-14


def test_manifest_names_them(robot):
    assert dict(robot.c.parameters) == {"shank": 0.40, "heel": 0.02}

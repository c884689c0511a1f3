"""The walker against published robots: Pinocchio's numbers in the cases, and Pinocchio itself on random robots."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cases.to_spec import LEG_CASES, ROBOT_CASES, case, from_dh, from_tree
from mechanisms.random_specs import specs
from oracles.measure import difference
from oracles.peer import PinocchioLeg
from oracles.walker import read


def leg_routes(data):
    return from_tree(data), from_dh(data)


def robot_routes(data):
    return from_tree(data), from_dh(data, data["dh_chains"])


@pytest.mark.parametrize("name", LEG_CASES)
def test_leg_cases(name):
    data = case(name)
    for conversion in leg_routes(data):
        (leg,) = read(conversion.text).legs
        for sample in data["samples"]:
            q, qd = np.array(sample["q"]), np.array(sample["qd"])
            assert difference(leg.pose(q)[:3, 3], sample["p"]) <= 1e-12
            assert difference(leg.pose(q)[:3, :3], sample["R"]) <= 1e-12
            assert difference(leg.spatial_jacobian(q), sample["J"]) <= 1e-12
            assert difference(leg.bias_acceleration(q, qd), sample["Jdot_qd"]) <= 1e-12


@pytest.mark.parametrize("name", ROBOT_CASES)
def test_robot_cases(name):
    data = case(name)
    for conversion in robot_routes(data):
        robot = read(conversion.text)
        for sample in data["samples"]:
            q = np.array(sample["q"])[list(conversion.order)]
            feet = robot.foot_positions(q) @ np.array(sample["base_R"]).T + sample["base_pos"]
            assert difference(feet, sample["feet"]) <= 1e-12


@settings(max_examples=60, derandomize=True, deadline=None)
@given(specs(), st.integers(0, 2**32 - 1))
def test_random_legs_are_pinocchios(text, seed):
    generator = np.random.default_rng(seed)
    for leg in read(text).legs:
        peer = PinocchioLeg(leg)
        q, qd = generator.uniform(-np.pi, np.pi, len(leg.joints)), generator.normal(size=len(leg.joints))
        assert difference(leg.pose(q), peer.pose(q)) <= 1e-12
        assert difference(leg.spatial_jacobian(q), peer.spatial_jacobian(q)) <= 1e-12
        assert difference(leg.cross_jacobian(q), peer.spatial_jacobian(q)) <= 1e-12
        assert difference(leg.bias_acceleration(q, qd), peer.bias_acceleration(q, qd)) <= 1e-12

"""Random robots with random bodies against Pinocchio: sliding joints, branching chains, links that weigh nothing, seven-joint legs."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from mechanisms.random_bodies import specs_with_bodies
from oracles.backends import interpreted
from oracles.dynamic_peer import DynamicPeer
from oracles.measure import difference
from walkgen.graph.lower import lower
from walkgen.pipeline import mechanism_of
from walkgen.symbolic.leg_functions import LegFunctions
from walkgen.symbolic.robot_dynamics import ROBOT_DYNAMICS, FloatingFunctions

ACCURACY = 1e-11
LEG = (
    "inverse_dynamics",
    "forward_dynamics",
    "mass_matrix",
    "bias",
    "gravity_torque",
    "coriolis_matrix",
    "kinetic_energy",
    "potential_energy",
)
UNSHRUNK = settings(derandomize=True, deadline=None, phases=[Phase.generate])


def programs(text, build):
    """The lowered functions that the mechanism has, by name."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "spec.toml"
        path.write_text(text, encoding="utf-8")
        return build(mechanism_of(path))


def leg_programs(mechanism, leg):
    return lowered(LegFunctions(mechanism, leg), LEG)


def lowered(functions, names):
    derived = {name: functions.function(name) for name in names}
    return {name: lower(function) for name, function in derived.items() if function}


def assert_legs(text: str, seed: int) -> None:
    found = programs(text, lambda mechanism: {leg.name: leg_programs(mechanism, leg) for leg in mechanism.legs})
    for leg, functions in found.items():
        assert_leg(functions, DynamicPeer(text, leg), np.random.default_rng(seed))


def assert_leg(functions, peer, generator) -> None:
    q, qd, qdd = generator.uniform(-2, 2, (3, peer.model.nv))
    force = generator.normal(size=3) * 10
    tau, M, g = peer.inverse_dynamics(q, qd, qdd), peer.mass_matrix(q), peer.gravity(q)
    bias = peer.inverse_dynamics(q, qd, 0 * q)
    kinetic, potential = peer.energies(q, qd)
    expected = {
        "inverse_dynamics": ((q, qd, qdd, force), tau - peer.foot_jacobian(q).T @ force),
        "mass_matrix": ((q,), M),
        "bias": ((q, qd), bias),
        "gravity_torque": ((q,), g),
        "kinetic_energy": ((q, qd), kinetic),
        "potential_energy": ((q,), potential),
    }
    for name, (inputs, value) in expected.items():
        assert difference(interpreted(functions[name], *inputs), value) <= ACCURACY, name
    for column in np.eye(len(q)):  # what small builds take for a column of M
        rest, far = (interpreted(functions["inverse_dynamics"], q, 0 * q, scale * column, np.zeros(3)) for scale in (0, 2.0**100))
        assert difference((far - rest) / 2.0**100, M @ column) <= ACCURACY
    C = interpreted(functions["coriolis_matrix"], q, qd)
    assert difference(C @ qd, bias - g) <= ACCURACY
    if "forward_dynamics" in functions and np.linalg.cond(M) < 1e6:
        assert difference(interpreted(functions["forward_dynamics"], q, qd, tau, np.zeros(3)), qdd) <= 1e-8


def random_pose(generator):
    R, _ = np.linalg.qr(generator.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = R * np.linalg.det(R), generator.normal(size=3)
    return pose


def assert_robot(text: str, seed: int) -> None:
    found = programs(text, lambda mechanism: lowered(FloatingFunctions(mechanism), ROBOT_DYNAMICS))
    peer, generator = DynamicPeer(text), np.random.default_rng(seed)
    pose, q = random_pose(generator), generator.uniform(-2, 2, peer.model.nv - 6)
    v, a = generator.uniform(-2, 2, (2, peer.model.nv))
    forces = generator.normal(size=(len(peer.walker.legs), 3)) * 10
    arguments = {"base_pose": pose, "q": q, "v": v, "a": a, "foot_forces": forces}
    for name, value in peer.robot(pose, q, v, a, forces).items():
        inputs = [arguments[port.name] for port in found[name].signature.inputs]
        assert difference(interpreted(found[name], *inputs), value) <= ACCURACY, name


NEARLY = """walkgen = 1
[robot]
name = "nearly"
gravity = [-2.3, 2.9, -0.25]
[[leg_designs.leg.joints]]
name = "yaw"
type = "revolute"
xyz = [0, 0, 0]
rpy = [0, 0, 0]
axis = [0, 0, 1]
link = { mass = 1.5, com = [-0.28, 0.1, 0.05], inertia = [0.02, 0.025, 0.022, 0.001, 0.002, 0.003] }
[[leg_designs.leg.joints]]
name = "lift"
type = "revolute"
xyz = [0.2, 0, 0.1]
rpy = [0.5, 0, 0]
axis = [0, 0, 1]
link = { mass = 0.7, com = [0.1, 0, 0.2], inertia = [0.01, 0.02, 0.015, 0, 0, 0] }
[[platforms]]
name = "base"
mass = 1.8
inertia = [0.02, 0.02, 0.03, 0, 0, 0]
[[legs]]
name = "leg"
design = "leg"
platform = "base"
mount = { xyz = [0.11, 0.071, 0.05], rpy_deg = [0, 1e-4, 0] }
"""
"""Its first axis is 1e-4 degrees off the right angle to the first component of its lever."""


def test_nearly_right_angles_lose_no_digits():
    assert_legs(NEARLY, 3)
    assert_robot(NEARLY, 3)


@settings(UNSHRUNK, max_examples=2)
@given(specs_with_bodies(most_joints=5), st.integers(0, 2**32 - 1))
def test_legs(text, seed):
    assert_legs(text, seed)


@settings(UNSHRUNK, max_examples=2)
@given(specs_with_bodies(most_joints=3), st.integers(0, 2**32 - 1))
def test_robots(text, seed):
    assert_robot(text, seed)


@pytest.mark.nightly
@settings(UNSHRUNK, max_examples=40)
@given(specs_with_bodies(), st.integers(0, 2**32 - 1))
def test_many_legs(text, seed):
    assert_legs(text, seed)


@pytest.mark.nightly
@settings(UNSHRUNK, max_examples=30)
@given(specs_with_bodies(), st.integers(0, 2**32 - 1))
def test_many_robots(text, seed):
    assert_robot(text, seed)

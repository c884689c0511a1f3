"""Random robots with random bodies against MuJoCo: the same kinds as against Pinocchio, by a peer that reckons about centres of mass."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mechanisms.random_bodies import specs_with_bodies
from oracles.backends import interpreted
from oracles.measure import difference
from oracles.mujoco_peer import MujocoPeer
from test_random_dynamics import UNSHRUNK, lowered, programs, random_pose
from walkgen.symbolic.leg_functions import LegFunctions
from walkgen.symbolic.robot_dynamics import FloatingFunctions

ACCURACY = 1e-11
LEG = ("inverse_dynamics", "mass_matrix", "bias")
ROBOT = ("floating_mass_matrix", "floating_inverse_dynamics")


def assert_legs(text: str, seed: int) -> None:
    def build(mechanism):
        return {leg.name: lowered(LegFunctions(mechanism, leg), LEG) for leg in mechanism.legs}

    for leg, functions in programs(text, build).items():
        assert_leg(functions, MujocoPeer(text, leg), np.random.default_rng(seed))


def assert_leg(functions, peer, generator) -> None:
    q, qd, qdd = generator.uniform(-2, 2, (3, peer.model.nv))
    force = generator.normal(size=3) * 10
    expected = {
        "inverse_dynamics": ((q, qd, qdd, force), peer.inverse(q, qd, qdd, force[None])),
        "mass_matrix": ((q,), peer.mass_matrix(q)),
        "bias": ((q, qd), peer.bias(q, qd)),
    }
    for name, (inputs, value) in expected.items():
        assert difference(interpreted(functions[name], *inputs), value) <= ACCURACY, name


def assert_robot(text: str, seed: int) -> None:
    found = programs(text, lambda mechanism: lowered(FloatingFunctions(mechanism), ROBOT))
    peer, generator = MujocoPeer(text), np.random.default_rng(seed)
    pose, q = random_pose(generator), generator.uniform(-2, 2, peer.model.nv - 6)
    v, a = generator.uniform(-2, 2, (2, peer.model.nv))
    forces = generator.normal(size=(len(peer.feet), 3)) * 10
    arguments = {"base_pose": pose, "q": q, "v": v, "a": a, "foot_forces": forces}
    for name, value in peer.robot(pose, q, v, a, forces).items():
        inputs = [arguments[port.name] for port in found[name].signature.inputs]
        assert difference(interpreted(found[name], *inputs), value) <= ACCURACY, name


@settings(UNSHRUNK, max_examples=2)
@given(specs_with_bodies(), st.integers(0, 2**32 - 1))
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

"""Random robots against the walker: the Programs of many by the interpreter, and a few of them all the way to the compiled code."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import Phase, find, given, settings
from hypothesis import strategies as st

from mechanisms.random_specs import CONVENTIONS, specs
from oracles.backends import BACKENDS, interpreted, programs
from oracles.measure import difference
from oracles.peer import PinocchioLeg
from oracles.walker import Walker, WalkerLimb, read

ACCURACY = 1e-12
UNSHRUNK = settings(derandomize=True, deadline=None, phases=[Phase.generate])


def leg_functions(leg: WalkerLimb, q, qd, qdd, force):
    """What every function of a leg must give: name, inputs, value."""
    J, bias = leg.spatial_jacobian(q), leg.bias_acceleration(q, qd)
    return (
        ("foot_position", (q,), leg.position(q)),
        ("foot_rotation", (q,), leg.pose(q)[:3, :3]),
        ("foot_pose", (q,), leg.pose(q)),
        ("foot_jacobian", (q,), J[:3]),
        ("foot_spatial_jacobian", (q,), J),
        ("foot_hessian", (q,), leg.hessian(q)),
        ("foot_velocity", (q, qd), J[:3] @ qd),
        ("foot_acceleration", (q, qd, qdd), J[:3] @ qdd + bias[:3]),
        ("foot_bias_acceleration", (q, qd), bias),
        ("foot_torque", (q, force), J[:3].T @ force),
        ("joint_frames", (q,), leg.frames(q)),
    )


def expectations(robot: Walker, seed: int):
    """Owner, name, inputs and value of every forward function of the robot, at one random pose."""
    generator = np.random.default_rng(seed)
    q, qd, qdd = generator.uniform(-np.pi, np.pi, (3, robot.joint_count))
    force = generator.normal(size=3)
    for leg in robot.legs:
        own = robot.slice(leg.name)
        for name, inputs, value in leg_functions(leg, q[own], qd[own], qdd[own], force):
            yield leg.name, name, inputs, value
        if leg.platform in robot.chains:
            yield from route_functions(robot, leg, q)
    for name, chain in robot.chains.items():
        own = q[robot.slice(name)]
        yield name, "pose", (own,), chain.pose(own)
        yield name, "jacobian", (own,), chain.spatial_jacobian(own)
        yield name, "frames", (own,), chain.frames(own)
    yield "", "platform_poses", (q,), robot.platform_poses(q)
    yield "", "foot_positions", (q,), robot.foot_positions(q)
    yield "", "foot_jacobians", (q,), robot.foot_jacobians(q)


def route_functions(robot: Walker, leg: WalkerLimb, q):
    """The route's own q is the robot's at `route`; derivatives by the robot's Jacobian, whose other columns are zero."""
    indices = list(robot.route(leg.name))
    J = robot.foot_jacobians(q)[robot.legs.index(leg)]
    assert not np.any(np.delete(J, indices, axis=1))
    owner, own = f"root_to_{leg.name}", q[indices]
    yield owner, "foot_position", (own,), robot.foot_pose(leg, q)[:3, 3]
    yield owner, "foot_pose", (own,), robot.foot_pose(leg, q)
    yield owner, "foot_jacobian", (own,), J[:, indices]


def assert_programs(text: str, seed: int) -> None:
    robot = read(text)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "spec.toml"
        path.write_text(text, encoding="utf-8")
        found = {(program.signature.owner, program.signature.name): program for program in programs(path).values()}
    for owner, name, inputs, value in expectations(robot, seed):
        assert difference(interpreted(found[owner, name], *inputs), value) <= ACCURACY, (owner, name)


@settings(UNSHRUNK, max_examples=3)
@given(specs(), st.integers(0, 2**32 - 1))
def test_programs(text, seed):
    assert_programs(text, seed)


@pytest.mark.nightly
@settings(UNSHRUNK, max_examples=300)
@given(specs(), st.integers(0, 2**32 - 1))
def test_many_programs(text, seed):
    assert_programs(text, seed)


def has_everything(text: str) -> bool:
    """A robot worth compiling: a chain on a chain, both kinds of joint, a mirrored leg."""
    robot = read(text)
    nested = any(chain.platform in robot.chains for chain in robot.chains.values())
    kinds = {joint.revolute for leg in robot.legs for joint in leg.joints}
    return nested and len(kinds) == 2 and any(leg.mirrored for leg in robot.legs) and robot.joint_count <= 12


@pytest.fixture(scope="module", params=CONVENTIONS)
def compiled(request, built):
    """The first random robot in this convention that has everything."""
    search = settings(UNSHRUNK, max_examples=5000)
    text = find(specs(most_joints=5, conventions=[request.param]), has_everything, settings=search)
    return read(text), built(text.replace('name = "robot"', f'name = "random_{request.param}"'))


@pytest.mark.parametrize("backend", BACKENDS)
def test_compiled_robot(compiled, backend):
    walker, robot = compiled
    for seed in range(3):
        for owner, name, inputs, value in expectations(walker, seed):
            rows = [np.asarray(part)[None] for part in inputs]
            assert difference(robot.call(backend, owner, name, *rows)[0], value) <= ACCURACY, (owner, name)


@pytest.mark.parametrize("backend", BACKENDS)
def test_compiled_robot_moves_as_pinocchios(compiled, backend):
    walker, robot = compiled
    generator = np.random.default_rng(9)
    for leg in walker.legs:
        peer = PinocchioLeg(leg)
        q, qd = generator.uniform(-np.pi, np.pi, (2, 4, len(leg.joints)))
        J = robot.call(backend, leg.name, "foot_spatial_jacobian", q)
        bias = robot.call(backend, leg.name, "foot_bias_acceleration", q, qd)
        assert difference(J, [peer.spatial_jacobian(row) for row in q]) <= ACCURACY
        assert difference(bias, [peer.bias_acceleration(*row) for row in zip(q, qd, strict=True)]) <= ACCURACY

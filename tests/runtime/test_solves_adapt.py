"""Adaption's reference in NumPy: the theory's example and O8, exact derivatives, minima that SciPy cannot lower, every status."""

import numpy as np
import pytest
from scipy.optimize import minimize

from oracles import theory
from oracles.trees import Ground, Robot, chapter_module, random_ground, unit
from walkgen.runtime.solves.adapt import adapt, plane_normal
from walkgen.runtime.solves.adapt_criterion import Criterion, derivatives
from walkgen.runtime.solves.adapt_legs import leg_of
from walkgen.runtime.solves.tree import middle_and_spans, motion, read_tree

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE = range(5)
MODULE = chapter_module()
POSTURE = np.array([*theory.O8_C, *theory.O8_Q3, *theory.O8_Q4])
TARGETS = np.array([[-0.80, 0.55, -0.33], [-0.75, -0.52, -0.24]])
NORMALS = np.tile(unit([0.1, 0.05, 1.0]), (2, 1))
WEIGHTS = np.array([1.0, 4.0, 20.0, 0.30])
UP = np.array([0.0, 0.0, 1.0])
NOWHERE = np.full(9, np.nan)
BEST = np.array([-0.0348539, -0.0356307, 0.0306370])


def solve(robot=MODULE, targets=TARGETS, normals=NORMALS, start=NOWHERE, weights=WEIGHTS):
    return adapt(*robot.data, targets, normals, start, weights, *robot.counts)


def test_o8_feet():
    tree = read_tree(*MODULE.data[:2], *MODULE.counts)
    at = motion(tree, POSTURE)
    feet = [at.moved(leg[-1], foot) for leg, foot in zip(tree.legs, tree.feet, strict=True)]
    np.testing.assert_allclose(feet, [theory.O8_FOOT3, theory.O8_FOOT4], rtol=0, atol=1e-14)


def test_the_example():
    q, status, cost = solve()
    assert status == OK
    assert abs(cost - 1.169086782046906) <= 1e-14
    np.testing.assert_allclose(q[:3], BEST, rtol=0, atol=1e-7)
    np.testing.assert_allclose(MODULE.foot_positions(q), TARGETS, rtol=0, atol=1e-14)


def test_the_example_with_its_chain_locked():
    """Then only the legs' part and the platform's are left: Phi(0)."""
    q, status, cost = solve(MODULE.limited([0, 1, 2], 0.0, 0.0))
    assert status == OK
    assert abs(cost - 1.233067) <= 5e-7
    assert not q[:3].any()


def test_eight_restarts_of_the_example_end_there():
    start = np.tile(NOWHERE, (8, 1))
    start[:, :3] = np.random.default_rng(1).uniform(-0.2, 0.2, (8, 3))
    q, status, cost = solve(start=start)
    assert (status == OK).all()
    np.testing.assert_allclose(q[:, :3], np.broadcast_to(BEST, (8, 3)), rtol=0, atol=1e-7)
    np.testing.assert_allclose(cost, 1.169086782046906, rtol=0, atol=1e-13)


@pytest.mark.parametrize("serial", [True, False])
@pytest.mark.parametrize("seed", range(3))
def test_derivatives_are_exact(seed, serial):
    """The gradient against complex steps; the Hessian against differences of that gradient along legs that follow."""
    ground, q = random_ground(seed, serial)
    robot, chains = ground.robot, ground.robot.chains
    tree = criterion(ground).tree
    legs = [leg_of(tree, foot, ground.robot.half) for foot in range(len(tree.legs))]
    slope = derivatives(criterion(ground), motion(tree, q), legs, q)
    size = np.max(np.abs(slope.hessian))
    np.testing.assert_allclose(slope.gradient, ground.gradient(q), rtol=0, atol=1e-11 * size)
    steps = 1e-4 * np.eye(len(chains))
    sides = [[ground.gradient(ground.followed(q[chains] + sign * step, q)) for step in steps] for sign in (1, -1, 2, -2)]
    above, below, far_above, far_below = (np.array(side) for side in sides)
    differences = (8.0 * (above - below) - (far_above - far_below)) / 12e-4
    np.testing.assert_allclose(slope.hessian, differences, rtol=0, atol=1e-8 * size)
    assert robot.counts[0] == len(q)


def criterion(ground: Ground) -> Criterion:
    tree = read_tree(*ground.robot.data[:2], *ground.robot.counts)
    middle, half, counted = middle_and_spans(tree, ground.robot.limits)
    homes = np.array(tree.homes)
    standing = np.array([(homes == m).any() for m in range(len(tree.carriers))])
    means = np.array([ground.targets[homes == m].mean(axis=0) if on else np.zeros(3) for m, on in enumerate(standing)])
    return Criterion(tree, ground.weights, middle, half, counted, ground.normals, means, standing, (True,) * len(tree.legs))


@pytest.mark.parametrize("serial", [True, False])
@pytest.mark.parametrize("seed", range(2))
def test_scipy_from_the_same_start_ends_no_lower(seed, serial):
    ground, start = random_ground(seed, serial)
    robot, chains = ground.robot, ground.robot.chains
    q, status, cost = solve(robot, ground.targets, ground.normals, start)
    assert status == OK
    assert abs(ground.phi(q) - cost) <= 1e-12
    assert np.max(np.abs(robot.foot_positions(q) - ground.targets)) <= 1e-12
    other = minimize(value_and_gradient(ground, start), start[chains], jac=True, method="L-BFGS-B", bounds=robot.limits[chains])
    assert cost <= other.fun + 1e-12
    again = minimize(value_and_gradient(ground, q), q[chains], jac=True, method="L-BFGS-B", bounds=robot.limits[chains])
    assert again.fun >= cost - 1e-11


def value_and_gradient(ground: Ground, start):
    """Of Phi by the chain joints, legs continued from where they last arrived; 1e3 where they do not."""
    last = [start]

    def function(c):
        q = ground.followed(c, last[0])
        if q is None:
            return 1e3, np.zeros_like(c)
        last[0] = q
        return ground.phi(q), ground.gradient(q)

    return function


@pytest.mark.parametrize("held", [(0.1, np.inf), (-np.inf, -0.2)])
def test_limits_hold_where_they_bind(held):
    """A chain joint's limit away from the optimum: it ends on the near one, pushed against it, the others where Phi is stationary."""
    robot = MODULE.limited([0], *held)
    q, status, _ = solve(robot)
    near = min(held, key=abs)
    gradient = Ground(robot, TARGETS, NORMALS, WEIGHTS).gradient(q)
    assert status == OK
    assert q[0] == near
    assert gradient[0] * near > 0.0
    assert np.max(np.abs(gradient[1:])) <= 1e-9


PLACES = {"geometry": 0, "limits": 2, "targets": 3, "normal": 4, "weights": 6}


@pytest.mark.parametrize("name", PLACES)
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_is_bad_input(name, value):
    inputs = [*MODULE.data, TARGETS, NORMALS, NOWHERE, WEIGHTS]
    inputs[PLACES[name]] = inputs[PLACES[name]].copy()
    inputs[PLACES[name]].flat[1 if (name, value) == ("limits", -np.inf) else 0] = value
    assert_bad(adapt(*inputs, *MODULE.counts))


@pytest.mark.parametrize(
    ("robot", "weights"),
    [(MODULE, [-1.0, 4.0, 20.0, 0.3]), (MODULE, [1.0, 4.0, -1e-9, 0.3]), (MODULE.limited([4], 0.1, 0.0), WEIGHTS)],
    ids=["limit weight", "height weight", "crossed limits"],
)
def test_negative_weights_and_crossed_limits_are_bad_input(robot, weights):
    assert_bad(solve(robot, weights=np.array(weights)))


@pytest.mark.parametrize(
    ("place", "value"),
    [(0, 9), (0, 0), (0, -2), (9, 2), (18, 2), (18, 8), (18, 9), (20, 9), (21, 5)],
    ids=["no joint", "own parent", "no parent", "no kind", "no leg", "shared leg", "no foot joint", "no carrier", "platform on a leg"],
)
def test_what_is_no_tree_is_bad_input(place, value):
    topology = MODULE.topology.copy()
    topology[place] = value
    assert_bad(adapt(MODULE.geometry, topology, MODULE.limits, TARGETS, NORMALS, NOWHERE, WEIGHTS, *MODULE.counts))


def assert_bad(answer) -> None:
    q, status, cost = answer
    assert status == BAD_INPUT
    assert np.isnan(q).all()
    assert np.isnan(cost)


def test_no_normal_is_that_of_the_targets():
    rng = np.random.default_rng(4)
    points = rng.uniform(-1.0, 1.0, (6, 3)) * [1.0, 1.0, 0.1]
    found = plane_normal(points)
    expected = np.linalg.svd(points - points.mean(axis=0))[2][2]
    assert np.max(np.abs(found - expected * np.sign(expected[2]))) <= 1e-14
    assert (plane_normal(points[:2]) == [0.0, 0.0, 1.0]).all()
    assert (plane_normal(np.outer(np.arange(4.0), [1.0, 0.0, 0.5])) == [0.0, 0.0, 1.0]).all()


def test_of_two_targets_the_plane_is_level():
    level, given = solve(normals=np.zeros((2, 3))), solve(normals=np.tile([0.0, 0.0, 3.0], (2, 1)))
    assert all(np.array_equal(a, b) for a, b in zip(level, given, strict=True))


def test_unknown_starts_are_the_middle_joint_by_joint():
    start = MODULE.middle + 0.1
    start[[0, 5]] = np.nan, np.inf
    middle = np.where(np.isfinite(start), start, MODULE.middle)
    assert all(np.array_equal(a, b) for a, b in zip(solve(start=start), solve(start=middle), strict=True))


def test_legs_keep_the_fold_of_the_start():
    """Where limits do not count, a knee bent the other way changes nothing for platform and chain."""
    start = np.stack([MODULE.middle, MODULE.middle])
    start[1, [4, 5]] = -1.0, 1.6
    weights = np.array([0.0, 4.0, 20.0, 0.15])
    q, status, cost = solve(start=start, weights=weights)
    assert (status == OK).all()
    assert q[0, 5] < -0.4
    assert q[1, 5] > 0.4
    np.testing.assert_allclose(np.delete(q[1], [4, 5]), np.delete(q[0], [4, 5]), rtol=0, atol=1e-8)
    np.testing.assert_allclose(cost, Ground(MODULE, TARGETS, NORMALS, weights).phi(q[0]), rtol=0, atol=1e-13)


def rooted() -> Robot:
    """Only the legs, on the root platform: no joint of a chain."""
    joints = tuple(type(joint)(joint.parent - 3 if joint.parent > 2 else -1, joint.before, joint.slides) for joint in MODULE.joints[3:])
    return Robot(joints, tuple((joint - 3, pose) for joint, pose in MODULE.feet), ((-1, np.eye(4)),), MODULE.limits[3:])


def test_without_chains_legs_stand_on_their_own():
    robot = rooted()
    targets = robot.foot_positions(robot.middle + 0.1)
    q, status, cost = adapt(*robot.data, targets, np.zeros((1, 3)), np.full(6, np.nan), WEIGHTS, *robot.counts)
    assert status == OK
    np.testing.assert_allclose(q, robot.middle + 0.1, rtol=0, atol=1e-13)
    assert abs(cost - np.sum((0.1 / robot.half) ** 2)) <= 1e-12
    _, status, cost = adapt(*robot.data, targets + 9.0 * UP, np.zeros((1, 3)), np.full(6, np.nan), WEIGHTS, *robot.counts)
    assert status == UNREACHABLE
    assert np.isfinite(cost)


def test_leading_dimensions_broadcast():
    weights = np.array([WEIGHTS, 2.0 * WEIGHTS])[:, None]
    targets = TARGETS + np.array([0.0, 0.01, -0.01])[:, None, None]
    q, status, cost = solve(targets=targets, weights=weights)
    assert q.shape == (2, 3, 9)
    assert status.shape == cost.shape == (2, 3)
    alone = solve(targets=targets[2], weights=weights[1, 0])
    assert all(np.array_equal(a[1, 2], b) for a, b in zip((q, status, cost), alone, strict=True))

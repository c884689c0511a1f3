"""Modular robots from their specs adapted to the ground: the theory's example and oracle O8, stands that no neighbour beats, defaults."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import minimize

from oracles.measure import difference
from oracles.walker import Walker, derivative, read
from walkgen.errors import UnsupportedMechanism

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE = range(5)
HEAD = """
walkgen = 1
[robot]
name = "{name}"
gravity = [0.0, 0.0, -9.81]
[generate]
functions = ["adapt", "adapt_velocity", "foot_positions"]
targets = ["c", "numpy"]
[adapt]
clearance = 0.30
[leg_designs.leg]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = {a1}, alpha_deg = 90, d = 0.0, limits = [-0.7, 0.7] }},
  {{ name = "thigh", type = "revolute", a = 0.35, alpha_deg = 0, d = 0.0, limits = [-0.4, 1.4] }},
  {{ name = "shank", type = "revolute", a = 0.40, alpha_deg = 0, d = 0.0, limits = [-2.5, -0.7] }},
]
[chain_designs.waist]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0, limits = [-0.5, 0.5] }},
  {{ name = "pitch", type = "revolute", a = 0.0, alpha_deg = 90, d = 0.0, theta_deg = 90, limits = [-0.5, 0.5] }},
  {{ name = "roll", type = "revolute", a = 0.0, alpha_deg = 0, d = 0.25, limits = [-0.5, 0.5] }},
]
[[platforms]]
name = "front"
"""
CHILD = """
[[platforms]]
name = "{name}"
parent = "{parent}"
chain = "waist"
root = {{ xyz = [-0.30, 0.0, 0.0], rpy_deg = [0, 0, 180] }}
end = "level"
end_xyz = [-0.30, 0.0, 0.0]
"""
LEGS = """
[[legs]]
name = "{name}_left"
design = "leg"
platform = "{name}"
mount = {{ xyz = [0.0, 0.20, 0.0], rpy_deg = [0, 0, 90] }}
[[legs]]
name = "{name}_right"
design = "leg"
platform = "{name}"
mount = {{ xyz = [0.0, -0.20, 0.0], rpy_deg = [0, 0, -90] }}
"""
PAIR = HEAD.format(name="pair", a1=0.0) + CHILD.format(name="rear", parent="front") + LEGS.format(name="rear")
WALKER = (
    HEAD.format(name="walker", a1=0.08)
    + CHILD.format(name="middle", parent="front")
    + CHILD.format(name="rear", parent="middle")
    + "".join(LEGS.format(name=name) for name in ("front", "middle", "rear"))
)
C, Q3, Q4 = (0.1, -0.05, 0.08), (0.1, 0.7, -1.7), (-0.2, 0.6, -1.45)
POSTURE = np.array([*C, *Q3, *Q4])
FEET = np.array(
    [[-1.0527748685978846, 0.5981761159391858, -0.1949067118790862], [-0.9784235030240849, -0.8195133906580229, -0.07619828766832615]]
)
TARGETS = np.array([[-0.80, 0.55, -0.33], [-0.75, -0.52, -0.24]])
NORMAL = np.array([0.1, 0.05, 1.0])
WEIGHTS = (1.0, 4.0, 20.0, 0.30)


@cache
def oracle(text: str) -> Walker:
    return read(text)


@pytest.fixture(params=["c", "numpy"])
def pair(request, built):
    return getattr(built(PAIR), request.param)


@pytest.fixture(params=["c", "numpy"])
def walker(request, built):
    return getattr(built(WALKER), request.param)


# ---- the theory's figures ----------------------------------------------------------------------------------------------------------


def test_oracle_o8_feet(pair):
    assert difference(pair.foot_positions(POSTURE), FEET) <= 1e-12


def test_the_example_of_the_theory(pair):
    q, status, cost = pair.adapt(TARGETS, [NORMAL, NORMAL])
    assert status == OK
    assert abs(cost - 1.169086782046906) <= 1e-9
    assert difference(q[:3], [-0.0348539, -0.0356307, 0.0306370]) <= 6e-8  # as printed
    assert difference(pair.foot_positions(q), TARGETS) <= 1e-12


def test_every_start_finds_the_same_stand(pair):
    chains = np.random.default_rng(1).uniform(-0.4, 0.4, (8, 3))
    starts = np.hstack([chains, np.tile([0, 0.5, -1.6, 0, 0.5, -1.6], (8, 1))])
    q, status, cost = pair.adapt(TARGETS, [NORMAL, NORMAL], starts)
    assert np.all(status == OK)
    assert np.all(np.abs(cost - 1.169086782046906) <= 1e-9)
    assert np.ptp(q, axis=0).max() <= 1e-6


def test_oracle_o8_rates(pair):
    xd, qd0 = [[0.05, 0.0, 0.0], [0.05, 0.0, 0.02]], [0.1, 0.2, -0.1, 0, 0, 0, 0, 0, 0]
    expected = [
        *(0.0025204434732044017, 0.08477361890513196, -0.03056512353851496),
        *(-0.1339696219950477, -0.16606059029743886, 0.028386892021903844),
        *(0.094154965662519, -0.020240342117141635, -0.017474963332241047),
    ]
    qd, status = pair.adapt_velocity(POSTURE, xd, qd0)
    assert status == OK
    assert difference(qd, expected) <= 1e-12


# ---- stands ------------------------------------------------------------------------------------------------------------------------


def criterion(text, q, targets, normals, weights):
    """Phi of theory note 1, section 3.3, by the walker."""
    robot, middle, half = oracle(text), np.array([0.0, 0.5, -1.6]), np.array([0.7, 0.9, 0.9])
    chains = 3 * len(robot.chains)
    share = np.concatenate([q[:chains] / 0.5, ((q[chains:].reshape(-1, 3) - middle) / half).ravel()])
    total = weights[0] * share @ share
    for index, name in enumerate(robot.platforms[1:], start=1):
        pose, normal = robot.platform_pose(name, q), normals[index]
        own = [foot for foot, leg in enumerate(robot.legs) if leg.platform == name]
        total += (
            weights[1] * (1 - normal @ pose[:3, 2]) + weights[2] * (normal @ (pose[:3, 3] - targets[own].mean(axis=0)) - weights[3]) ** 2
        )
    return total


def legs_follow(text, q, c, targets):
    """Joint values with these chain joints whose feet stand on the targets, by Newton from a stand nearby."""
    robot = oracle(text)
    q, chains = np.concatenate([c, q[len(c) :]]), len(c)
    for _ in range(6):
        gap = (robot.foot_positions(q) - targets).ravel()
        q[chains:] -= np.linalg.solve(derivative(robot.foot_positions, q).reshape(len(gap), -1)[:, chains:], gap)
    return q


def ground(seed):
    """Targets of a posture near the middle, on rough ground."""
    rng = np.random.default_rng(seed)
    q = np.concatenate([rng.uniform(-0.15, 0.15, 6), (np.array([0, 0.5, -1.6]) + rng.uniform(-0.2, 0.2, (6, 3))).ravel()])
    return q, oracle(WALKER).foot_positions(q)


def plane(points):
    normal = np.linalg.svd(points - points.mean(axis=0))[2][-1]
    return normal * np.sign(normal[2])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(3))
def test_no_neighbour_of_a_stand_is_better(walker, seed):
    truth, targets = ground(seed)
    q, status, cost = walker.adapt(targets)
    normals = np.tile(plane(targets), (3, 1))
    assert status == OK
    assert difference(walker.foot_positions(q), targets) <= 1e-12
    assert np.all(((q >= walker.limits[:, 0]) & (q <= walker.limits[:, 1]))[:6])
    assert abs(cost - criterion(WALKER, q, targets, normals, WEIGHTS)) <= 1e-12
    assert cost <= criterion(WALKER, truth, targets, normals, WEIGHTS)
    for direction in np.random.default_rng(seed + 10).normal(size=(4, 6)):
        for size in (1e-3, -1e-3):
            beside = legs_follow(WALKER, q, q[:6] + size * direction, targets)
            assert criterion(WALKER, beside, targets, normals, WEIGHTS) >= cost - 1e-13


def test_a_minimiser_finds_nothing_better(built):
    """Nelder and Mead over the chains of the pair."""
    q, _, cost = built(PAIR).c.adapt(TARGETS, [NORMAL, NORMAL])
    normals = np.tile(NORMAL / np.linalg.norm(NORMAL), (2, 1))

    def phi(c):
        return criterion(PAIR, legs_follow(PAIR, q, c, TARGETS), TARGETS, normals, WEIGHTS)

    found = minimize(phi, q[:3] + 0.02, method="Nelder-Mead", options={"xatol": 1e-5, "fatol": 1e-10})
    assert abs(found.fun - cost) <= 1e-9


# ---- defaults and inputs -----------------------------------------------------------------------------------------------------------


def test_defaults_are_those_of_the_spec_and_of_the_ground(walker):
    _, targets = ground(5)
    expected = walker.adapt(targets)
    assert expected[1] == OK
    same = [
        walker.adapt(targets, np.zeros((3, 3))),
        walker.adapt(targets, np.tile(plane(targets) * 7.0, (3, 1))),
        walker.adapt(targets, start=np.full(24, np.nan)),
        walker.adapt(targets, start=[0.0] * 6 + [0, 0.5, -1.6] * 6),
        walker.adapt(targets, weights=WEIGHTS),
        walker.adapt(targets, None, None, WEIGHTS),
    ]
    for q, status, cost in same:
        assert status == OK
        assert difference(q, expected[0]) <= 1e-9
        assert abs(cost - expected[2]) <= 1e-11


def test_weights_and_normals_count(walker):
    _, targets = ground(6)
    upright = np.tile([0.0, 0.0, 1.0], (3, 1))
    for weights in ((1.0, 0.0, 0.0, 0.0), (0.1, 50.0, 0.0, 0.0), (0.1, 0.0, 200.0, 0.25)):
        q, status, cost = walker.adapt(targets, upright, weights=weights)
        assert status == OK
        assert abs(cost - criterion(WALKER, q, targets, upright, weights)) <= 1e-11
    heights = [oracle(WALKER).platform_pose(name, q)[2, 3] for name in ("middle", "rear")]
    means = [targets[2:4, 2].mean(), targets[4:6, 2].mean()]
    assert np.all(np.abs(np.array(heights) - means - 0.25) <= 0.02)


def test_c_and_numpy_agree(built):
    targets = np.array([ground(seed)[1] for seed in (7, 8, 9)])
    compiled, plain = (robot.adapt(targets) for robot in (built(WALKER).c, built(WALKER).numpy))
    assert np.array_equal(compiled[1], plain[1])
    assert difference(compiled[0], plain[0]) <= 1e-8
    assert difference(compiled[2], plain[2]) <= 1e-11
    q, rng = np.array([ground(seed)[0] for seed in (7, 8, 9)]), np.random.default_rng(2)
    xd, qd0 = rng.normal(size=(3, 6, 3)), rng.normal(size=(3, 24))
    for one, other in zip(*(robot.adapt_velocity(q, xd, qd0) for robot in (built(WALKER).c, built(WALKER).numpy)), strict=True):
        assert difference(one, other) <= 1e-11


def test_rates_are_the_least_that_move_the_feet_so(walker):
    """Against the weighted pseudo-inverse, qd = J_W^+ xd + (1 - J_W^+ J) qd0; without qd0 it is 0."""
    q, _ = ground(10)
    rng = np.random.default_rng(3)
    xd, qd0 = rng.normal(size=(6, 3)), rng.normal(size=24)
    half = np.array([0.5] * 6 + [0.7, 0.9, 0.9] * 6)
    J = derivative(oracle(WALKER).foot_positions, q).reshape(18, 24)
    spread = half[:, None] ** 2 * J.T
    for wanted, arguments in ((qd0, (qd0,)), (np.zeros(24), ())):
        qd, status = walker.adapt_velocity(q, xd, *arguments)
        assert status == OK
        assert difference(qd, wanted + spread @ np.linalg.solve(J @ spread, xd.ravel() - J @ wanted)) <= 1e-10


def test_targets_out_of_reach_are_said_so(built):
    _, targets = ground(11)
    targets[4] += [-0.8, 0.3, 0.0]
    q, status, cost = built(WALKER).c.adapt(targets)
    assert status == UNREACHABLE
    assert np.all(np.isfinite(q))
    assert np.isfinite(cost)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_no_number_is_bad_input(walker, value):
    _, targets = ground(12)
    wrong = targets.copy()
    wrong[3, 1] = value
    normals = np.full((3, 3), value)
    with np.errstate(all="ignore"):
        answers = [walker.adapt(wrong), walker.adapt(targets, normals), walker.adapt(targets, weights=[1, value, 1, 1])]
    for q, status, cost in answers:
        assert status == BAD_INPUT
        assert np.all(np.isnan(q))
        assert np.isnan(cost)
    q, status, cost = walker.adapt(targets, weights=[-1, 1, 1, 1])
    assert status == BAD_INPUT
    with np.errstate(all="ignore"):
        qd, status = walker.adapt_velocity(ground(12)[0], wrong)
    assert status == BAD_INPUT
    assert np.all(np.isnan(qd))


def test_a_stretched_leg_is_damped(walker):
    q, _ = ground(13)
    q[8] = 0.0
    qd, status = walker.adapt_velocity(q, np.ones((6, 3)))
    assert status == SINGULAR
    assert np.all(np.isfinite(qd))
    assert np.abs(qd).max() < 100


def test_casadi_says_that_it_has_none(built):
    for name in ("adapt", "adapt_velocity"):
        with pytest.raises(UnsupportedMechanism):
            built(PAIR).c.casadi(name)

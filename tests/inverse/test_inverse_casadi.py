"""The inverse in CasADi: the same rows as C, exact derivatives, and a part of an optimisation."""

import casadi as ca
import numpy as np
import pytest
from sequences import design, head, leg, row

from oracles.screws import screws
from oracles.walker import read

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, DUPLICATE = 0, 1, 2, 3, 4, 6
REACHES = (OK, SINGULAR, DUPLICATE)
FUNCTIONS = ("foot_position", "inverse", "inverse_branch", "inverse_near", "inverse_distance", "inverse_pose", "inverse_velocity")
PITCHING = [row("r", 0.08, "alpha_deg = 90", 0.1, 0), row("r", 0.35, "alpha_deg = 0", 0.02, 0), row("r", 0.4, "alpha_deg = 0", -0.01, 0)]
ROUNDED = [row("r", 0.08, "alpha = 1.57", 0.1, 0), *PITCHING[1:]]
ARM = [
    row("r", 0.1, "alpha_deg = 90", 0.2, 0),
    *PITCHING[1:],
    row("r", 0.1, "alpha_deg = 90", 0.1, 30),
    row("r", 0.05, "alpha_deg = -90", 0.1, 0),
]


def random_leg(name):
    return leg(name, *name.split("_"), np.random.default_rng(list(name.encode())))


BRANCHED = {
    "pitching": design("pitching", PITCHING, "0.01, -0.03, 0.05", "xyz = [0.1, 0.2, -0.1], rpy_deg = [10, 20, 30]"),
    "rounded": design("rounded", ROUNDED, "0.01, -0.03, 0.05"),
    **{name: random_leg(name) for name in ("rrr_xx", "rrp_pz", "rpr_xp", "rpp_xx", "rr_x")},
}
ARMS = {
    "arm": design("arm", ARM, "0.05, 0, 0.1"),
    "six": design("six", [*ARM, row("r", 0.05, "alpha_deg = 90", 0.05, 10)], "0.05, 0, 0.1"),
}
DESIGNS = BRANCHED | ARMS
FEW = ("pitching", "rrr_xx", "rrp_pz", "rpp_xx", "rr_x", "six")
"""What the ordinary run builds: every kind of closed form, and an arm whose poses are iterated."""


def spec(names=FEW):
    return head("smooth", FUNCTIONS, ("c", "casadi")) + "\n".join(text for name, text in DESIGNS.items() if name in names)


PATHS = {limb.name: screws(limb) for limb in read(spec(DESIGNS)).legs}


def some(names):
    return [name if name in FEW else pytest.param(name, marks=pytest.mark.nightly) for name in names]


@pytest.fixture(params=some(BRANCHED))
def name(request):
    return request.param


@pytest.fixture
def robot(built, name):
    """With the few legs, or with all where another is tested."""
    return built(spec() if name in FEW else spec(DESIGNS)).c


def targets(name, count, seed=1):
    """Poses away from singular ones, and their feet."""
    path = PATHS[name]
    q = path.random(np.random.default_rng(seed), 10 * count)
    q = q[np.linalg.svd(path.jacobian(q), compute_uv=False)[:, min(path.n, 3) - 1] > 0.08 * min(1.0, path.reach)][:count]
    return q, path.foot(q)


def call(function, *inputs):
    """Outputs as arrays."""
    return [np.array(value).squeeze() for value in function.call(inputs)]


def jacobian(function, *inputs):
    """Of the first output by the first input, by CasADi."""
    symbols = [ca.SX.sym(f"x{index}", *function.size_in(index)) for index in range(function.n_in())]
    derivative = ca.Function(
        "derivative", symbols, [ca.jacobian(function(*symbols)[0] if function.n_out() > 1 else function(*symbols), symbols[0])]
    )
    return np.array(derivative(*inputs))


# ---- the same as C ---------------------------------------------------------------------------------------------------------------


def test_rows_are_those_of_c(robot, name):
    path, generated, function = PATHS[name], robot.legs[name], robot.casadi(f"{name}_inverse")
    for p in targets(name, 12)[1]:
        (rows, status), (expected, states) = call(function, p), generated.inverse(p)
        rows = rows.reshape(expected.shape)
        assert np.array_equal(np.atleast_1d(status), states)
        assert np.all(path.apart(rows, expected)[np.isin(states, REACHES)] <= 1e-11)


def test_targets_out_of_reach_and_without_numbers_are_said_so(robot, name):
    generated, function = robot.legs[name], robot.casadi(f"{name}_inverse")
    for p in ([40.0, 20.0, -30.0], [0.3, np.nan, 0.1], [np.inf, 0.1, 0.1]):
        status = call(function, p)[1]
        with np.errstate(all="ignore"):
            assert np.array_equal(np.atleast_1d(status), generated.inverse(p)[1])


def test_one_branch_is_one_row(robot, name):
    generated, function = robot.legs[name], robot.casadi(f"{name}_inverse_branch")
    p = targets(name, 3)[1]
    for target in p:
        rows, states = generated.inverse(target)
        for branch, (expected, state) in enumerate(zip(rows, states, strict=True)):
            q, status = call(function, target, branch)
            assert status == state
            assert state not in REACHES or PATHS[name].apart(np.atleast_1d(q), expected) <= 1e-11
        for branch in (-1, len(states)):
            q, status = call(function, target, branch)
            assert status == BAD_INPUT
            assert np.all(np.isnan(q))


def test_near_is_that_of_c(robot, name):
    generated, function = robot.legs[name], robot.casadi(f"{name}_inverse_near")
    truth, p = targets(name, 8, 2)
    seeds = truth + np.random.default_rng(3).uniform(-7, 7, truth.shape)
    for target, seed in zip(p, seeds, strict=True):
        q, status = call(function, target, seed)
        expected, state = generated.inverse_near(target, seed)
        assert status == state
        assert PATHS[name].apart(np.atleast_1d(q), expected) <= 1e-11
    q, status = call(function, p[0], seeds[0] * np.nan)
    assert status == BAD_INPUT
    assert np.all(np.isnan(q))


def test_distance_is_that_of_c(robot, name):
    generated, function = robot.legs[name], robot.casadi(f"{name}_inverse_distance")
    for p in targets(name, 4)[1]:
        (distance,), states = call(function, p), generated.inverse(p)[1]
        assert np.all(np.atleast_1d(distance)[np.isin(states, REACHES)] <= 1e-11)


# ---- derivatives -----------------------------------------------------------------------------------------------------------------


def inverse_of(path, q):
    """d q / d p of a pose: J^+, which for three joints is J^-1."""
    return np.linalg.pinv(path.jacobian(q))


@pytest.mark.parametrize("name", some(name for name in BRANCHED if name != "rr_x"), indirect=True)
def test_derivatives_are_the_inverse_of_the_jacobian(robot, name):
    path, generated, function = PATHS[name], robot.legs[name], robot.casadi(f"{name}_inverse_branch")
    for p in targets(name, 3, 4)[1]:
        rows, states = generated.inverse(p)
        for branch in np.flatnonzero(states == OK):
            J = path.jacobian(rows[branch])
            weakest = np.linalg.svd(J, compute_uv=False)[-1]
            found = jacobian(function, p, float(branch))
            assert weakest < 1e-3 or np.max(np.abs(found @ J - np.eye(3))) <= 1e-9 / weakest**2


@pytest.mark.parametrize("name", ["pitching", "rrr_xx", "rrp_pz"], indirect=True)
def test_near_has_the_same_derivatives(robot, name):
    truth, p = targets(name, 3, 5)
    function = robot.casadi(f"{name}_inverse_near")
    for q, target in zip(truth, p, strict=True):
        assert np.max(np.abs(jacobian(function, target, q) @ PATHS[name].jacobian(q) - np.eye(3))) <= 1e-7


@pytest.mark.parametrize("name", some(["pitching", "rrr_xx", "rounded", "rpr_xp"]), indirect=True)
def test_all_rows_have_derivatives(robot, name):
    """[b, n] by p, each row its own."""
    path, generated, function = PATHS[name], robot.legs[name], robot.casadi(f"{name}_inverse")
    p = targets(name, 1, 6)[1][0]
    rows, states = generated.inverse(p)
    found = jacobian(function, p).reshape(3, len(rows), 3)  # CasADi stacks columns: joints, then rows
    for branch in np.flatnonzero(states == OK):
        weakest = np.linalg.svd(path.jacobian(rows[branch]), compute_uv=False)[-1]
        assert weakest < 1e-2 or np.max(np.abs(found[:, branch] - inverse_of(path, rows[branch]))) <= 1e-8 / weakest**2


# ---- iterated --------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", some(ARMS), indirect=True)
def test_iterated_positions_and_poses(robot, name):
    """From seeds nearby: the target is met; the derivative is that of the implicit function."""
    path = PATHS[name]
    truth = targets(name, 6, 7)[0]
    seeds = truth + np.random.default_rng(8).uniform(-0.1, 0.1, truth.shape)
    near, pose = robot.casadi(f"{name}_inverse_near"), robot.casadi(f"{name}_inverse_pose")
    for q, seed in zip(truth, seeds, strict=True):
        p = path.foot(q)
        found, status = call(near, p, seed)
        assert status == OK
        assert np.linalg.norm(path.foot(found) - p) <= 1e-9
        J = path.jacobian(found)
        assert np.max(np.abs(J @ jacobian(near, p, seed) - np.eye(3))) <= 1e-5
        T = path.pose(q)
        if np.linalg.svd(path.pose_jacobian(q), compute_uv=False)[-1] > 0.05 and path.n >= 6:
            found, status = call(pose, T, seed)
            assert status == OK
            assert np.max(np.abs(path.pose(found) - T)) <= 1e-9


@pytest.mark.parametrize("name", some(DESIGNS), indirect=True)
def test_velocities_are_those_of_c(robot, name):
    rng = np.random.default_rng(9)
    q = PATHS[name].random(rng, 5)
    v = rng.normal(size=(5, 3))
    qd, status = robot.legs[name].inverse_velocity(q, v)
    for pose, speed, expected, state in zip(q, v, qd, status, strict=True):
        found, code = call(robot.casadi(f"{name}_inverse_velocity"), pose, speed)
        assert code == state
        assert np.max(np.abs(np.atleast_1d(found) - expected)) <= 1e-9 * (1 + np.max(np.abs(expected)))


# ---- in an optimisation ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["pitching", "rrr_xx"], indirect=True)
def test_a_foot_is_placed_by_an_optimiser(robot, name):
    """The foot within 0.02 m of a point whose joint values are least bent from those wanted: ipopt's answer against a dense search."""
    path, function = PATHS[name], robot.casadi(f"{name}_inverse_branch")
    truth, p = targets(name, 1, 10)
    centre, rows, states = p[0], *robot.legs[name].inverse(p[0])
    branch = int(np.flatnonzero(states == OK)[0])
    wanted = rows[branch] + np.array([0.3, -0.2, 0.4])
    foot = ca.SX.sym("foot", 3)
    q = function(foot, branch)[0]
    cost = ca.sumsqr(q - ca.DM(wanted))
    problem = {"x": foot, "f": cost, "g": ca.sumsqr((foot - ca.DM(centre)) / 0.02)}
    options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-10, "ipopt.bound_relax_factor": 0.0}
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    found = solver(x0=centre, lbg=0, ubg=1.0)
    assert solver.stats()["success"]
    x = np.array(found["x"]).ravel()
    assert np.linalg.norm(x - centre) <= 0.02 * (1 + 1e-6)
    directions = np.random.default_rng(11).normal(size=(4000, 3))
    points = centre + 0.02 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    others, codes = robot.legs[name].inverse_branch(points, branch)
    least = np.min(np.sum((others - wanted) ** 2, axis=1)[codes == OK])
    assert float(found["f"]) <= least + 1e-9
    assert float(found["f"]) >= least - 0.01
    assert np.all(path.apart(np.array(function(x, branch)[0]).ravel(), wanted) < 0.5)
    assert len(truth) == 1

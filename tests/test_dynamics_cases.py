"""Every dynamic sample of the reference cases, in every way walkgen computes it, and the unphysical bodies among them."""

from itertools import combinations

import numpy as np
import pytest

from cases.to_spec import LEG_CASES, ROBOT_CASES, case, from_tree
from oracles.backends import BACKENDS
from oracles.measure import difference

ACCURACY = 1e-11
AGREEMENT = 1e-12
WEIGHED = [name for name in LEG_CASES if name != "csiro_bullet_ar_leg_dh"]
LEG = (
    "inverse_dynamics",
    "forward_dynamics",
    "mass_matrix",
    "bias",
    "gravity_torque",
    "coriolis_matrix",
    "kinetic_energy",
    "potential_energy",
    "inverse_dynamics_derivatives",
    "regressor",
    "base_parameters",
)
ROBOT = ("com", "com_jacobian", "centroidal_momentum_matrix", "momentum", "momentum_rate", "demanded_wrench")
ROBOT += ("floating_mass_matrix", "floating_inverse_dynamics")
FORCE = np.array([3.0, -5.0, 20.0])


def stacked(samples, key):
    return np.array([sample[key] for sample in samples])


def leg_arguments(samples):
    rows = {key: stacked(samples, key) for key in ("q", "qd", "qdd", "tau")}
    return rows | {"f": np.tile(FORCE, (len(samples), 1))}


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", WEIGHED)
def test_leg_samples(built, name, backend):
    data = case(name)
    conversion = from_tree(data, LEG)
    robot, (foot,) = built(conversion.text), conversion.feet
    samples = data["samples"]
    rows = leg_arguments(samples)
    q, qd, qdd, tau, f = rows.values()
    load = np.einsum("nij,i->nj", stacked(samples, "J")[:, :3], FORCE)
    assert difference(robot.call(backend, foot, "inverse_dynamics", q, qd, qdd, f), tau - load) <= ACCURACY
    assert difference(robot.call(backend, foot, "inverse_dynamics", q, qd, qdd, 0 * f), tau) <= ACCURACY
    M = robot.call(backend, foot, "mass_matrix", q)
    assert difference(M, stacked(samples, "M")) <= ACCURACY
    assert difference(robot.call(backend, foot, "bias", q, qd), stacked(samples, "nle")) <= ACCURACY
    assert difference(robot.call(backend, foot, "gravity_torque", q), stacked(samples, "g")) <= ACCURACY
    C = robot.call(backend, foot, "coriolis_matrix", q, qd)
    assert difference(np.einsum("nij,nj->ni", C, qd) + stacked(samples, "g"), stacked(samples, "nle")) <= ACCURACY
    assert difference(robot.call(backend, foot, "kinetic_energy", q, qd), np.einsum("ni,nij,nj->n", qd, M, qd) / 2) <= ACCURACY
    assert difference(robot.call(backend, foot, "forward_dynamics", q, qd, tau - load, f), qdd) <= 1e-9


@pytest.mark.parametrize("name", WEIGHED)
def test_leg_ways_agree(built, name):
    data = case(name)
    conversion = from_tree(data, LEG)
    robot, (foot,) = built(conversion.text), conversion.feet
    rows = leg_arguments(data["samples"])
    for function in LEG:
        inputs = [rows[port.name] for port in robot.signature(foot, function).inputs]
        ways = [robot.call(backend, foot, function, *inputs) for backend in BACKENDS]
        for one, other in combinations(ways, 2):
            assert difference(one, other) <= AGREEMENT, function


def test_the_foot_force_may_be_left_out(built):
    """In Python; it is no force then."""
    data = case("solo12_fl_leg")
    conversion = from_tree(data, LEG)
    leg = built(conversion.text).c.legs[conversion.feet[0]]
    q, qd, qdd, tau = (stacked(data["samples"], key) for key in ("q", "qd", "qdd", "tau"))
    assert difference(leg.inverse_dynamics(q, qd, qdd), tau) <= ACCURACY
    assert difference(leg.forward_dynamics(q, qd, tau), qdd) <= 1e-9
    assert difference(leg.inverse_dynamics(q[0], qd[0], qdd[0]), tau[0]) <= ACCURACY


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_functions_with_two_outputs(built, backend):
    """As Python gives them: slopes by q and qd, the regressor of the fewest parameters and their values."""
    data = case("puma560_first3")
    conversion = from_tree(data, LEG)
    robot, samples = built(conversion.text), data["samples"]
    leg = getattr(robot, backend).legs[conversion.feet[0]]
    q, qd, qdd, tau = (stacked(samples, key) for key in ("q", "qd", "qdd", "tau"))
    Y, p = leg.base_parameters(q, qd, qdd)
    assert difference(np.einsum("nij,nj->ni", Y, p), tau) <= ACCURACY
    assert np.array_equal(p, np.tile(p[0], (len(q), 1)))
    by_q, by_qd = leg.inverse_dynamics_derivatives(q, qd, qdd)
    step = 1e-5
    for slopes, way in ((by_q, np.array([1, 0])), (by_qd, np.array([0, 1]))):
        for index in range(3):
            shift = step * way[:, None] * np.eye(3)[index]
            ahead, behind = (leg.inverse_dynamics(q + sign * shift[0], qd + sign * shift[1], qdd) for sign in (1, -1))
            assert difference((ahead - behind) / (2 * step), slopes[:, :, index]) <= 1e-6


def robot_arguments(data, order):
    columns = [*range(6), *(6 + index for index in order)]
    samples = data["samples"]
    pose = np.tile(np.eye(4), (len(samples), 1, 1))
    pose[:, :3, :3], pose[:, :3, 3] = stacked(samples, "base_R"), stacked(samples, "base_pos")
    feet = len(data["model"]["feet"])
    return columns, {
        "base_pose": pose,
        "q": stacked(samples, "q")[:, list(order)],
        "v": stacked(samples, "v")[:, columns],
        "a": stacked(samples, "a")[:, columns],
        "foot_forces": np.zeros((len(samples), feet, 3)),
    }


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", ROBOT_CASES)
def test_robot_samples(built, name, backend):
    data = case(name)
    conversion = from_tree(data, ROBOT)
    robot, samples = built(conversion.text), data["samples"]
    columns, rows = robot_arguments(data, conversion.order)

    def call(function, count=None):
        return robot.call(backend, "", function, *(rows[port.name][:count] for port in robot.signature("", function).inputs))

    for function, key in {"com": "com", "momentum": "hg", "momentum_rate": "dhg"}.items():
        assert difference(call(function), stacked(samples, key)) <= ACCURACY, function
    assert difference(call("floating_inverse_dynamics"), stacked(samples, "tau")[:, columns]) <= ACCURACY
    whole = [sample for sample in samples if "M" in sample]
    assert whole == samples[: len(whole)]
    assert difference(call("floating_mass_matrix", len(whole)), stacked(whole, "M")[:, columns][:, :, columns]) <= ACCURACY
    assert difference(call("com_jacobian", len(whole)), stacked(whole, "Jcom")[:, :, columns]) <= ACCURACY
    assert difference(call("centroidal_momentum_matrix", len(whole)), stacked(whole, "Ag")[:, :, columns]) <= ACCURACY
    push = data["total_mass"] * np.array(data["model"]["gravity"]) - stacked(samples, "dhg")[:, :3]
    moment = np.cross(stacked(samples, "com"), push) - stacked(samples, "dhg")[:, 3:]
    assert difference(call("demanded_wrench"), np.hstack([push, moment])) <= ACCURACY


@pytest.mark.parametrize("name", ROBOT_CASES)
def test_robot_ways_agree(built, name):
    data = case(name)
    conversion = from_tree(data, ROBOT)
    robot = built(conversion.text)
    _, rows = robot_arguments(data, conversion.order)
    rows["foot_forces"] = np.random.default_rng(1).normal(size=rows["foot_forces"].shape) * 50
    for function in ROBOT:
        inputs = [rows[port.name][:5] for port in robot.signature("", function).inputs]
        ways = [robot.call(backend, "", function, *inputs) for backend in BACKENDS]
        for one, other in combinations(ways, 2):
            assert difference(one, other) <= AGREEMENT, function

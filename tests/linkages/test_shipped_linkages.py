"""Shipped linkages beside the theory's own dyads, their slopes beside differences, their dynamics beside their own energies."""

import numpy as np
import pytest

from linkages.branches import check_branches
from linkages.theory import BOXES, FEET

STEP = 1e-6
REACH = 1.0
YAWED = ("odex", "bessonov", "garrec")
FUNCTIONS = (
    *("foot_position", "foot_jacobian", "foot_hessian", "foot_spatial_jacobian", "foot_bias_acceleration", "foot_velocity"),
    *("inverse", "inverse_branch", "inverse_near", "inverse_velocity", "inverse_dynamics", "forward_dynamics", "mass_matrix", "bias"),
    *("coriolis_matrix", "gravity_torque", "kinetic_energy", "potential_energy"),
)
SHIPPED = [pytest.param(name, marks=pytest.mark.nightly) if name == "bessonov" else name for name in FEET]


@pytest.fixture(scope="module")
def shipped(shipped):
    """With what is tested here; of Garrec's six legs, which are far larger, the foot alone."""
    return lambda name: shipped(name, FUNCTIONS[:2] if name == "garrec" else FUNCTIONS)


def drives(name, count, seed=0):
    low, high = BOXES[name]
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def posture(name, count, seed=0):
    q = drives(name, count, seed)
    return np.c_[np.random.default_rng(seed + 1).uniform(-1, 1, count), q] if name in YAWED else q


def leg_of(robot):
    return next(iter(robot.legs.values()))


def mounted(name, planar, yaw):
    """A point of the plane in the platform's frame: X forward, Y up, turned about the vertical at the mount."""
    mount = {"odex": (0.4, 0.0), "bessonov": (0.3, 0.0), "garrec": (0.6, 0.25)}.get(name, (0.0, 0.0))
    return np.stack([mount[0] + np.cos(yaw) * planar[:, 0], mount[1] + np.sin(yaw) * planar[:, 0], planar[:, 1]], axis=-1)


@pytest.mark.parametrize("name", SHIPPED)
def test_foot_is_where_the_theory_puts_it(shipped, name):
    q = posture(name, 200)
    drive = q[:, 1:] if name in YAWED else q
    yaw = q[:, 0] if name in YAWED else np.zeros(len(q))
    wanted = mounted(name, np.array([FEET[name](*row) for row in drive]), yaw)
    robot = shipped(name)
    for backend in (robot.c, robot.numpy):
        assert np.abs(leg_of(backend).foot_position(q) - wanted).max() <= 1e-14 * REACH


@pytest.mark.parametrize("name", SHIPPED)
def test_jacobian_is_the_slope(shipped, name):
    leg, q = leg_of(shipped(name).c), posture(name, 20)
    change = np.stack([(leg.foot_position(q + STEP * e) - leg.foot_position(q - STEP * e)) / (2 * STEP) for e in np.eye(q.shape[1])], -1)
    assert np.abs(change - leg.foot_jacobian(q)).max() < 1e-6


@pytest.mark.parametrize("name", ["odex", "pantograph"])
def test_second_derivatives(shipped, name):
    leg, q = leg_of(shipped(name).c), posture(name, 20)
    change = np.stack([(leg.foot_jacobian(q + STEP * e) - leg.foot_jacobian(q - STEP * e)) / (2 * STEP) for e in np.eye(q.shape[1])], -1)
    hessian = leg.foot_hessian(q)
    assert np.abs(change - hessian).max() < 1e-6 * max(np.abs(hessian).max(), 1)
    qd = np.random.default_rng(2).normal(size=q.shape)
    jacobians = [leg.foot_spatial_jacobian(q + sign * STEP * qd) for sign in (1, -1)]
    bias = np.einsum("nij,nj->ni", (jacobians[0] - jacobians[1]) / (2 * STEP), qd)
    assert np.abs(bias - leg.foot_bias_acceleration(q, qd)).max() < 1e-5 * max(np.abs(bias).max(), 1)


@pytest.mark.parametrize(("name", "branches"), [("odex", 16), pytest.param("bessonov", 8, marks=pytest.mark.nightly), ("pantograph", 2)])
def test_every_branch_of_the_inverse_that_is_ok_reaches(shipped, name, branches):
    leg, q = leg_of(shipped(name).c), posture(name, 200)
    target = leg.foot_position(q)
    found, status = leg.inverse(target)
    assert found.shape[1] == len(leg.branch_names) == branches
    reached = status == 0
    assert np.abs(leg.foot_position(found) - target[:, None])[reached].max() <= 1e-14
    assert (np.abs(found - q[:, None]).max(-1) < 1e-11).any(axis=1).all()
    assert np.isin(status, (0, 5)).all()
    assert leg.inverse_near(target, q)[0] == pytest.approx(q, abs=1e-11)


def test_one_branch_is_its_row_of_all(shipped):
    check_branches(shipped("odex"))


def test_targets_out_of_reach_are_said_to_be(shipped):
    leg = leg_of(shipped("odex").c)
    _, status = leg.inverse(np.array([[3.0, 0.0, 0.0], [0.4, np.nan, 0.0]]))
    assert (status[0] == 1).all()
    assert (status[1] == 2).all()


@pytest.mark.parametrize("name", ["odex", "pantograph"])
def test_dynamics_agree_with_each_other(shipped, name):
    leg, q = leg_of(shipped(name).c), posture(name, 10)
    generator = np.random.default_rng(3)
    qd, qdd, f = (generator.normal(size=shape) for shape in (q.shape, q.shape, (len(q), 3)))
    tau, mass, bias = leg.inverse_dynamics(q, qd, qdd, f), leg.mass_matrix(q), leg.bias(q, qd)
    jacobian, coriolis = leg.foot_jacobian(q), leg.coriolis_matrix(q, qd)
    scale = np.abs(tau).max()
    composed = np.einsum("nij,nj->ni", mass, qdd) + bias - np.einsum("nji,nj->ni", jacobian, f)
    assert np.abs(composed - tau).max() < 1e-12 * scale
    assert np.abs(leg.forward_dynamics(q, qd, tau, f) - qdd).max() < 1e-11
    assert np.abs(np.einsum("nij,nj->ni", coriolis, qd) + leg.gravity_torque(q) - bias).max() < 1e-12 * scale
    assert np.abs(leg.kinetic_energy(q, qd) - np.einsum("ni,nij,nj->n", qd, mass, qd) / 2).max() < 1e-12 * scale
    change = (leg.mass_matrix(q + STEP * qd) - leg.mass_matrix(q - STEP * qd)) / (2 * STEP) - 2 * coriolis
    assert np.abs(change + np.swapaxes(change, 1, 2)).max() < 1e-6 * scale


@pytest.mark.parametrize("name", ["odex", "pantograph"])
def test_efforts_are_slopes_of_the_energy(shipped, name):
    """dE/dt = tau . qd along a motion, with the energies of the links summed by hand from their frames."""
    leg, q = leg_of(shipped(name).c), posture(name, 10)
    generator = np.random.default_rng(4)
    qd, qdd = generator.normal(size=q.shape), generator.normal(size=q.shape)
    later, before = (q + sign * STEP * qd + STEP**2 * qdd / 2 for sign in (1, -1))
    energy = [leg.kinetic_energy(p, qd + sign * STEP * qdd) + leg.potential_energy(p) for p, sign in ((later, 1), (before, -1))]
    power = np.einsum("ni,ni->n", leg.inverse_dynamics(q, qd, qdd), qd)
    assert (energy[0] - energy[1]) / (2 * STEP) == pytest.approx(power, rel=1e-6, abs=1e-6)


def test_velocities_and_back(shipped):
    leg, q = leg_of(shipped("odex").c), posture("odex", 50)
    qd = np.random.default_rng(5).normal(size=q.shape)
    found, status = leg.inverse_velocity(q, leg.foot_velocity(q, qd))
    assert (status == 0).all()
    assert found == pytest.approx(qd, abs=1e-9)

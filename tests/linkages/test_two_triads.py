"""Legs with two groups of class III: both on the way from the foot back to the drives, both under the drives, or one each."""

import numpy as np
import pytest

from linkages.two_triads import leg
from walkgen import selftest
from walkgen.model.classify import inverse_class
from walkgen.pipeline import mechanism_of

KINEMATICS = ("foot_position", "foot_jacobian", "foot_hessian", "assembly_status", "transmission_angles", "within_limits", "inverse_near")
INVERSES = ("inverse_admissible", "inverse_velocity", "inverse_acceleration")
ROWS = ("inverse", "inverse_branch", "inverse_distance")
MECHANICS = (
    *("mass_matrix", "kinetic_energy", "potential_energy", "gravity_torque", "inverse_dynamics", "forward_dynamics", "driving_forces"),
    *("power", "joint_reactions", "regressor", "coriolis_matrix", "bias"),
)
WAYS = {"held": ("dyads", "dyads"), "driven": ("triad", "triad"), "one each": ("triad", "dyads")}
TRIADS = {"held": (0, 2), "driven": (2, 0), "one each": (1, 1)}
"""Under the drives, and with the foot held."""
NAMES = [pytest.param(name, marks=() if name == "held" else pytest.mark.nightly) for name in WAYS]
OK, UNREACHABLE, BAD_INPUT, INFEASIBLE, DUPLICATE = 0, 1, 2, 5, 6


def kinematics(built, name):
    rows = () if name == "held" else ROWS
    return built(leg(*WAYS[name], (*KINEMATICS, *INVERSES, *rows), ("c", "numpy") if name == "held" else ("c",)))


def drives(limb, count, seed=3):
    """Within the limits, where the linkage assembles."""
    q = np.random.default_rng(seed).uniform(*np.array(limb.limits).T, (count, 3))
    q = q[limb.assembly_status(q) == OK]
    assert len(q) > count / 2
    return q


@pytest.mark.parametrize("name", WAYS)
def test_groups(tmp_path, name):
    path = tmp_path / "bot.toml"
    path.write_text(leg(*WAYS[name], ("foot_position",)), encoding="utf-8")
    mechanism = mechanism_of(path)
    limb = mechanism.legs[0]
    assert (len(limb.linkage.forward.triads), len(limb.linkage.inverse.triads)) == TRIADS[name]
    found = inverse_class(mechanism, limb)
    if name == "held":
        assert found.branch_names == ()
        assert "coupler_1 and coupler_2 are parts of two triads" in found.reason
    else:
        assert len(found.branch_names) == {"driven": 64, "one each": 96}[name]


@pytest.mark.parametrize("name", NAMES)
def test_loops_close(built, name):
    """All links' equations in 50 digits."""
    assert selftest.run(kinematics(built, name).folder) == 0


@pytest.mark.parametrize("name", NAMES)
def test_slopes_and_curvatures(built, name):
    limb, step = kinematics(built, name).c.legs["leg"], 1e-5
    q = drives(limb, 100)
    q = q[np.abs(np.sin(limb.transmission_angles(q))).min(-1) > 0.3]
    assert len(q) > 20
    for joint, e in enumerate(step * np.eye(3)):
        J, H = ((function(q + e) - function(q - e)) / (2 * step) for function in (limb.foot_position, limb.foot_jacobian))
        assert np.abs(limb.foot_jacobian(q)[..., joint] - J).max() < 1e-6
        assert np.abs(limb.foot_hessian(q)[..., joint] - H).max() < 1e-4


@pytest.mark.parametrize("name", NAMES)
def test_back_to_the_drives(built, name):
    """Near a seed, and within the limits; beyond the workspace and for what is no number the status says so."""
    limb = kinematics(built, name).c.legs["leg"]
    q = drives(limb, 100)
    p = limb.foot_position(q)
    near, status = limb.inverse_near(p, q + 0.01)
    assert (status == OK).all()
    assert np.abs(limb.foot_position(near) - p).max() < 1e-11
    assert np.mean(np.abs(near - q).max(-1) < 1e-6) > 0.9
    inside, status = limb.inverse_admissible(p[:20])
    assert (status == OK).all()
    assert limb.within_limits(inside).all()
    assert np.abs(limb.foot_position(inside) - p[:20]).max() < 1e-11
    assert set(limb.inverse_admissible(3 * p[:3])[1]) <= {UNREACHABLE}
    assert limb.inverse_near([np.nan, 0, 0], q[0])[1] == BAD_INPUT


@pytest.mark.parametrize("name", NAMES)
def test_rates(built, name):
    """The foot moves along the way that the rates and accelerations of the drives make as it is wanted to."""
    limb, random = kinematics(built, name).c.legs["leg"], np.random.default_rng(7)
    q = drives(limb, 100)
    wanted, bent = random.uniform(-0.3, 0.3, (2, len(q), 3))
    v = np.einsum("nij,nj->ni", limb.foot_jacobian(q), wanted)
    qd, status = limb.inverse_velocity(q, v)
    assert np.mean(status == OK) > 0.8
    assert np.abs(qd - wanted)[status == OK].max() < 1e-9
    a = np.einsum("nij,nj->ni", limb.foot_jacobian(q), bent)
    qdd, told = limb.inverse_acceleration(q, qd, a)
    assert np.array_equal(told, status)
    calm, step = (status == OK) & (np.abs(qdd).max(-1) < 3) & (np.abs(np.sin(limb.transmission_angles(q))).min(-1) > 0.3), 1e-4
    assert calm.mean() > 0.2
    places = (limb.foot_position(q + time * qd + time**2 / 2 * qdd)[calm] for time in (-step, 0, step))
    back, here, on = places
    assert np.abs((on - back) / (2 * step) - v[calm]).max() < 1e-6
    assert np.abs((on - 2 * here + back) / step**2 - a[calm]).max() < 1e-5


def test_numpy_agrees(built):
    robot = kinematics(built, "held")
    limb, own = robot.c.legs["leg"], robot.numpy.legs["leg"]
    q = drives(limb, 10)
    assert np.abs(limb.foot_hessian(q) - own.foot_hessian(q)).max() < 1e-11
    p = limb.foot_position(q[:2])
    assert np.abs(limb.inverse_near(p, q[:2] + 0.01)[0] - own.inverse_near(p, q[:2] + 0.01)[0]).max() < 1e-9


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["driven", "one each"])
def test_rows(built, name):
    """Every row that is said to reach the target does; the drives that the foot came from are among them."""
    limb = kinematics(built, name).c.legs["leg"]
    q = drives(limb, 60)
    p = limb.foot_position(q)
    rows, status = limb.inverse(p)
    assert set(np.unique(status)) <= {OK, UNREACHABLE, INFEASIBLE, DUPLICATE}
    assert np.isfinite(rows).all()
    missed = np.linalg.norm(limb.foot_position(rows) - p[:, None], axis=-1)
    rounded = 2e-14 * np.maximum(1, np.linalg.norm(limb.foot_jacobian(rows), axis=(-2, -1)))  # hundreds of metres a radian where triads jam
    assert (missed <= rounded)[status == OK].all()
    assert not (missed[status == INFEASIBLE] < 1e-7).any()
    away = np.where(status == OK, np.abs(np.angle(np.exp(1j * (rows - q[:, None])))).max(-1), np.inf).min(-1)
    assert np.mean(away < 1e-8) > 0.9
    assert limb.inverse_distance(p) == pytest.approx(missed, abs=1e-13, nan_ok=True)
    for branch in (0, len(limb.branch_names) - 1):
        row, state = limb.inverse_branch(p, branch)
        assert np.array_equal(row, rows[:, branch])
        assert np.array_equal(state, status[:, branch])


@pytest.mark.nightly
@pytest.mark.parametrize("name", WAYS)
def test_mechanics(built, name):
    """Efforts, energies and powers agree with each other, with differences and with virtual work."""
    robot = built(leg(*WAYS[name], ("foot_position", "foot_jacobian", "assembly_status", "transmission_angles", *MECHANICS), ("c",)))
    limb, random, step = robot.c.legs["leg"], np.random.default_rng(8), 1e-5
    q = drives(limb, 40)
    q = q[np.abs(np.sin(limb.transmission_angles(q))).min(-1) > 0.3]
    qd, qdd, f = random.normal(size=(3, len(q), 3)) * [[[1]], [[1]], [[50]]]
    tau, M = limb.inverse_dynamics(q, qd, qdd, f), limb.mass_matrix(q)
    assert limb.forward_dynamics(q, qd, tau, f) == pytest.approx(qdd, rel=1e-7, abs=1e-7)
    assert np.einsum("ni,nij,nj->n", qd, M, qd) / 2 == pytest.approx(limb.kinetic_energy(q, qd), rel=1e-9)
    assert np.linalg.eigvalsh(M).min() > 0
    slopes = [(limb.potential_energy(q + e) - limb.potential_energy(q - e)) / (2 * step) for e in step * np.eye(3)]
    assert limb.gravity_torque(q) == pytest.approx(np.stack(slopes, -1), rel=1e-5, abs=1e-6)
    held = np.einsum("nij,ni->nj", limb.foot_jacobian(q), f)
    assert tau == pytest.approx(limb.inverse_dynamics(q, qd, qdd, np.zeros(3)) - held, rel=1e-8, abs=1e-8)
    assert tau == pytest.approx(np.einsum("nij,nj->ni", M, qdd) + limb.bias(q, qd) - held, rel=1e-8, abs=1e-8)
    assert limb.driving_forces(q, qd, qdd, f) == pytest.approx(tau[:, 1:], rel=1e-12)
    each, whole, _ = limb.power(q, qd, qdd, f)
    assert each == pytest.approx(tau * qd, rel=1e-9, abs=1e-9)
    assert whole == pytest.approx((tau * qd).sum(-1), rel=1e-9, abs=1e-9)
    assert np.isfinite(limb.joint_reactions(q, qd, qdd, f)).all()

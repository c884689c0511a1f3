"""Legs with cams: the generated functions count follower and spring as the cam moves them, beside a level set of 50 digits."""

from pathlib import Path

import numpy as np
import pytest
from cammed import SPAN, Cammed, bare_of, text_of

from symbolic.dynamic_legs import EXACT, SPECS, exact, leg_programs, rate_along, robot_programs, value, values, written
from walkgen.symbolic.leg_functions import DYNAMICS, SPRUNG

NAMES = tuple(DYNAMICS | SPRUNG)
DIFFERENCES = 1e-25
STATES = np.random.default_rng(7).uniform(-1.5, 1.5, (3, 3, 3))
STATES[:, 0, 1] = (-0.45, 0.1, 0.7)
"""Rows q, qd, qdd; the hip within the cam's range."""
G, LOAD = 9.80665, 1.5


@pytest.fixture(scope="module", params=["link", "frame"])
def leg(request, tmp_path_factory):
    text = text_of(request.param)
    programs = leg_programs(written(tmp_path_factory.mktemp("cammed"), text), names=NAMES)
    bare = leg_programs(written(tmp_path_factory.mktemp("bare"), bare_of(text)), names=("potential_energy", "kinetic_energy"))
    oracle = Cammed(request.param, lambda q: value(bare["potential_energy"], q, context=EXACT))
    return programs, bare, oracle


def test_the_hip_is_balanced_where_the_cam_is_cut_for(leg):
    """At the load and with the other joints held, as the design has it; yaw may be anything."""
    for phi in np.linspace(*SPAN, 41):
        found = value(leg[0]["unbalance_moment"], np.array([0.9, phi, -0.5]), LOAD)
        assert abs(found[1]) < 1e-12
        assert abs(found[0]) < 1e-13


def test_another_load_is_left_alone(leg):
    for phi in (-0.3, 0.2):
        foot = 0.4 * np.cos(phi) + 0.35 * np.cos(phi - 0.5)
        assert value(leg[0]["unbalance_moment"], np.array([0.9, phi, -0.5]), LOAD + 2)[1] == pytest.approx(2 * G * foot, rel=1e-11)


def test_the_spring_and_its_energy(leg):
    programs, _, oracle = leg
    for q, _, _ in STATES:
        at = exact(q)
        r = oracle.way(at)
        length = value(programs["spring_length"], q)
        assert length[0] == pytest.approx(float(oracle.length(at, r)), rel=1e-13)
        assert value(programs["spring_tension"], q)[0] == pytest.approx(20 + 2000 * (length[0] - 0.08), rel=1e-13)
        assert value(programs["spring_energy"], q)[0] == pytest.approx(float(oracle.stored(at, r)), rel=1e-12)
    q = exact(STATES[0, 0])
    stored = rate_along(lambda at: value(programs["spring_energy"], at, context=EXACT), q, exact([0, 1, 0]))
    moments = value(programs["spring_moment"], q, context=EXACT)
    assert abs(moments[0, 1] + stored[0]) < DIFFERENCES * abs(stored[0])
    assert moments[0, 0] == moments[0, 2] == 0


def test_potential_energy(leg):
    programs, bare, oracle = leg
    for q, _, _ in STATES:
        at = exact(q)
        r = oracle.way(at)
        wanted = float(value(bare["potential_energy"], at, context=EXACT) + oracle.hanging(at, r) + oracle.stored(at, r))
        assert value(programs["potential_energy"], q) == pytest.approx(wanted, rel=1e-13)


def test_kinetic_energy_counts_what_slides(leg):
    programs, bare, oracle = leg
    for q, qd, _ in STATES:
        wanted = value(bare["kinetic_energy"], q, qd) + float(oracle.moving(exact(q), exact(qd)))
        assert value(programs["kinetic_energy"], q, qd) == pytest.approx(wanted, rel=1e-12)
        assert qd @ value(programs["mass_matrix"], q) @ qd / 2 == pytest.approx(wanted, rel=1e-12)


def test_joints_hold_the_slope_of_the_potential(leg):
    programs, q = leg[0], exact(STATES[1, 0])
    slopes = [rate_along(lambda at: value(programs["potential_energy"], at, context=EXACT), q, exact(unit)) for unit in np.eye(3)]
    found = value(programs["gravity_torque"], q, context=EXACT)
    assert max(abs(found - slopes)) < DIFFERENCES * max(abs(found))


def test_motion_keeps_the_balance_of_energy(leg):
    programs = leg[0]
    for state in STATES:
        q, qd, qdd = (exact(row) for row in state)
        tau = value(programs["inverse_dynamics"], q, qd, qdd, context=EXACT)
        step = EXACT.mpf(10) ** -18

        def energy(t, q=q, qd=qd, qdd=qdd):
            at, rate = q + t * qd + t**2 * qdd / 2, qd + t * qdd
            kinetic = value(programs["kinetic_energy"], at, rate, context=EXACT)
            return kinetic + value(programs["potential_energy"], at, context=EXACT)

        change = (energy(step) - energy(-step)) / (2 * step)
        assert abs(change - tau @ qd) < DIFFERENCES * (abs(tau) @ abs(qd))


def test_dynamics_agree_with_each_other(leg):
    programs = leg[0]
    for q, qd, qdd in STATES:
        f = np.array([3.0, -5.0, 20.0])
        tau, loaded = value(programs["inverse_dynamics"], q, qd, qdd), value(programs["inverse_dynamics"], q, qd, qdd, f)
        assert value(programs["forward_dynamics"], q, qd, loaded, f) == pytest.approx(qdd, abs=1e-9)
        C, h, g = value(programs["coriolis_matrix"], q, qd), value(programs["bias"], q, qd), value(programs["gravity_torque"], q)
        scale = np.abs(tau).max()
        assert h == pytest.approx(C @ qd + g, abs=1e-11 * scale)
        assert value(programs["mass_matrix"], q) @ qdd + h == pytest.approx(tau, abs=1e-11 * scale)
        pulled = value(programs["spring_moment"], q).sum(0)
        Y, p = values(programs["base_parameters"], q, qd, qdd)
        assert Y @ p - pulled == pytest.approx(tau, abs=1e-10 * scale)


def test_slopes_of_the_efforts(leg):
    programs = leg[0]
    q, qd, qdd = (exact(row) for row in STATES[1])
    by_q, by_qd = (np.array(table) for table in values(programs["inverse_dynamics_derivatives"], q, qd, qdd, context=EXACT))
    for joint, unit in enumerate(np.eye(3)):
        slope = rate_along(lambda at: value(programs["inverse_dynamics"], at, qd, qdd, context=EXACT), q, exact(unit))
        rate = rate_along(lambda at: value(programs["inverse_dynamics"], q, at, qdd, context=EXACT), qd, exact(unit))
        assert max(abs(slope - by_q[:, joint])) <= DIFFERENCES * max(abs(slope))
        assert max(abs(rate - by_qd[:, joint])) <= DIFFERENCES * max(abs(rate))


def test_beyond_its_ends_the_cam_goes_straight_on(leg):
    """Efforts do not jump there, and stay what anybody can hold half a turn away."""
    programs = leg[0]
    for end in SPAN:
        inside, outside = (value(programs["gravity_torque"], np.array([0.9, end + side, -0.5])) for side in (-1e-9, 1e-9))
        assert inside == pytest.approx(outside, abs=1e-5)
    assert np.abs(value(programs["gravity_torque"], np.array([0.0, 3.0, 0.0]))).max() < 3e3


def test_on_a_floating_base(leg, tmp_path):
    """Mass centre and momentum count the follower; power of all efforts is the change of energy."""
    oracle, text = leg[2], text_of(leg[2].on)
    (tmp_path / "bare").mkdir()
    robot, bare = robot_programs(written(tmp_path, text)), robot_programs(written(tmp_path / "bare", bare_of(text)))
    q, mass = exact(STATES[0, 0]), EXACT.mpf("7.9")
    pose = exact(np.eye(4))
    points = oracle.points(q, oracle.way(q))
    total = mass + sum(own for own, _ in points)
    wanted = (mass * value(bare["com"], pose, q, context=EXACT) + sum(own * at for own, at in points)) / total
    assert max(abs(value(robot["com"], pose, q, context=EXACT) - wanted)) < 1e-15
    v = np.concatenate([np.zeros(6), STATES[0, 1]])
    along = rate_along(lambda at: value(robot["com"], pose, at, context=EXACT), q, exact(STATES[0, 1]))
    momentum = value(robot["momentum"], pose, q, exact(v), context=EXACT)
    assert max(abs(momentum[:3] - total * along)) < DIFFERENCES * max(abs(momentum))
    a = np.concatenate([np.zeros(6), STATES[0, 2]])
    found = value(robot["floating_inverse_dynamics"], np.eye(4), STATES[0, 0], v, a)[6:]
    assert found == pytest.approx(value(leg[0]["inverse_dynamics"], *STATES[0]), abs=1e-11 * np.abs(found).max())


def test_a_mirrored_leg_has_the_cam_too(leg, tmp_path):
    mirror = '[[legs]]\nname = "other"\nmirror_of = "leg"\n'
    path = written(tmp_path, text_of(leg[2].on) + mirror)
    names = ("spring_length", "spring_moment", "gravity_torque", "potential_energy", "mass_matrix")
    one, other = (leg_programs(path, index, names) for index in (0, 1))
    for name in names:
        assert value(one[name], STATES[2, 0]) == pytest.approx(value(other[name], STATES[2, 0]), rel=1e-11, abs=1e-11)


def test_signs_and_zeros_of_joints_change_nothing(leg, tmp_path):
    """q is the link's angle whatever the mechanism's own angle is: the same leg with the hip's axis turned round and its zero shifted."""
    other = text_of(leg[2].on).replace("axis = [0, -1, 0]\nlink = { mass = 3.0", "axis = [0, 1, 0]\nlink = { mass = 3.0")
    assert other != text_of(leg[2].on)
    other = other.replace('design = "arm"\n', 'design = "arm"\nsigns = [1, -1, 1]\n')
    programs = leg_programs(written(tmp_path, other), names=("gravity_torque", "mass_matrix", "spring_length"))
    for q, _, _ in STATES:
        for name, program in programs.items():
            assert value(program, q) == pytest.approx(value(leg[0][name], q), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
@pytest.mark.parametrize("on", ["link", "frame"])
def test_in_every_target(built, backend, on):
    wanted = (*SPRUNG, "gravity_torque", "potential_energy", "inverse_dynamics", "mass_matrix", "foot_position")
    named = ", ".join(f'"{name}"' for name in wanted)
    made = built(text_of(on).replace("[leg_designs.arm]", f"[generate]\nfunctions = [{named}]\n[leg_designs.arm]", 1))
    q = np.linspace([0.1, -0.9, -0.5], [0.1, 1.0, -0.5], 41)
    left = made.call(backend, "leg", "unbalance_moment", q, np.full(41, LOAD))[:, 1]
    cut = (q[:, 1] >= SPAN[0]) & (q[:, 1] <= SPAN[1])
    assert np.abs(left[cut]).max() < 1e-12
    assert np.abs(left[~cut]).max() > 1e-3
    for name, given in (("gravity_torque", (q,)), ("potential_energy", (q,)), ("inverse_dynamics", (q, q, q, q)), ("spring_moment", (q,))):
        reference = made.call("interpreter", "leg", name, *given)
        assert made.call(backend, "leg", name, *given) == pytest.approx(reference, rel=1e-11, abs=1e-11 * np.abs(reference).max())


@pytest.mark.parametrize(("number", "span"), [(1, (-35, 55)), (2, (-35, 45))])
def test_shipped_cams_keep_the_total_potential(number, span):
    """As the generated functions have it, constant to 1e-13 of its value; what is left for the drive is rounding."""
    spec: Path = SPECS / f"balanced_leg_cam{number}.toml"
    programs = leg_programs(spec, names=("potential_energy", "unbalance_moment", "gravity_torque"))
    phi = np.deg2rad(np.linspace(*span, 91))[:, None]
    energies = np.array([value(programs["potential_energy"], at) for at in phi])
    assert np.ptp(energies) < 1e-13 * np.abs(energies).max()
    for name in ("unbalance_moment", "gravity_torque"):
        assert max(abs(value(programs[name], at)[0]) for at in phi) < 1e-12

"""Springs on legs of joints in series: length, tension, energy and moment, what they ask of the joints, and what they weigh."""

import re

import numpy as np
import pytest
from sprung import Sprung

from symbolic.dynamic_legs import BODY, EXACT, SLIDE, THIGH, YAW, exact, leg_programs, rate_along, spec_of, value, values, written
from walkgen.graph.lower import lower
from walkgen.pipeline import mechanism_of
from walkgen.symbolic.leg_functions import DYNAMICS, SPRUNG
from walkgen.symbolic.robot_dynamics import FloatingFunctions

ROWS = [f"{YAW}, {BODY}", f"{SLIDE}, {BODY}", f"{THIGH}, {BODY}"]
DIFFERENCES = 1e-25
"""Accuracy of central differences of 50-digit numbers with a step of 1e-20, of which 30 digits are left, for sums of a thousand."""
NAMES = tuple(name for name in DYNAMICS | SPRUNG if name != "regressor")
ENERGIES = ("potential_energy", "kinetic_energy")
PULLED = ("inverse_dynamics", "bias", "gravity_torque")


def spring(name, first, second, numbers):
    """The table of a spring between two (link, xyz)."""
    ends = ", ".join(f'{{ link = "{link}", xyz = {[round(float(entry), 3) for entry in xyz]} }}' for link, xyz in (first, second))
    return f'[[leg_designs.arm.springs]]\nname = "{name}"\nbetween = [{ends}]\n{numbers}\n'


def sprung_text(seed, *, every=False):
    """A leg of three joints with springs between pairs of its links and the mount, three or every one; some have mass."""
    random, links = np.random.default_rng(seed), ["mount", "yaw", "slide", "thigh"]
    pairs = [(first, second) for place, first in enumerate(links) for second in links[place + 1 :]]
    tables = []
    for number, pair in enumerate(pairs if every else pairs[::2]):
        k, free, pull = random.uniform(500, 5000), random.uniform(0.01, 0.2), random.uniform(0, 40)
        weighs = f"masses = {{ at_first = {0.2 + 0.1 * number:.2f}, at_second = 0.3 }}" if number in (0, 2) else ""
        numbers = f"stiffness = {k:.1f}\nfree_length = {free:.3f}\ninitial_tension = {pull:.1f}\n{weighs}"
        ends = ((link, random.uniform(-0.3, 0.3, 3)) for link in pair[:: 1 - 2 * (number % 2)])
        tables.append(spring(f"s{number}", *ends, numbers))
    return spec_of(*ROWS) + "".join(tables)


@pytest.fixture(scope="module", params=(1, pytest.param(2, marks=pytest.mark.nightly)))
def leg(request, tmp_path_factory):
    text = sprung_text(request.param, every=request.param > 1)
    programs = leg_programs(written(tmp_path_factory.mktemp("sprung"), text), names=NAMES)
    bare = re.sub(r"\[\[leg_designs\.arm\.springs\]\].*?(?=\[\[|\Z)", "", text, flags=re.DOTALL)
    return programs, leg_programs(written(tmp_path_factory.mktemp("bare"), bare), names=ENERGIES), Sprung(text)


STATES = np.random.default_rng(5).uniform(-1.5, 1.5, (4, 3, 3))


def test_length_tension_energy_and_moment(leg):
    programs, _, oracle = leg
    for q, _, _ in STATES:
        assert value(programs["spring_length"], q) == pytest.approx(oracle.lengths(q).real, rel=1e-13)
        assert value(programs["spring_tension"], q) == pytest.approx(oracle.tensions(q).real, rel=1e-12)
        assert value(programs["spring_energy"], q) == pytest.approx(oracle.energies(q).real, rel=1e-12)
        moments = oracle.moments(q)
        assert value(programs["spring_moment"], q) == pytest.approx(moments, abs=1e-12 * np.abs(moments).max())


def test_potential_energy_is_gravity_and_springs(leg):
    programs, bare, oracle = leg
    for q, _, _ in STATES:
        wanted = value(bare["potential_energy"], q) + oracle.hanging(q) + oracle.energies(q).real.sum()
        assert value(programs["potential_energy"], q) == pytest.approx(wanted, rel=1e-12)


def test_joints_hold_the_slope_of_the_potential(leg):
    programs, q = leg[0], exact(STATES[0, 0])
    potential = lambda at: value(programs["potential_energy"], at, context=EXACT)  # noqa: E731
    slopes = [rate_along(potential, q, exact(unit)) for unit in np.eye(3)]
    found = value(programs["gravity_torque"], q, context=EXACT)
    assert max(abs(found - slopes)) < DIFFERENCES * max(abs(found))


def test_kinetic_energy_counts_what_springs_weigh(leg):
    programs, bare, oracle = leg
    for q, qd, _ in STATES:
        wanted = value(bare["kinetic_energy"], q, qd) + oracle.moving(q, qd)
        assert value(programs["kinetic_energy"], q, qd) == pytest.approx(wanted, rel=1e-12)
        assert qd @ value(programs["mass_matrix"], q) @ qd / 2 == pytest.approx(wanted, rel=1e-12)


def test_motion_keeps_the_balance_of_energy(leg):
    """Efforts times rates are the change of kinetic and potential energy."""
    programs = leg[0]
    for state in STATES[:2]:
        q, qd, qdd = (exact(row) for row in state)
        tau = value(programs["inverse_dynamics"], q, qd, qdd, context=EXACT)
        kinetic = lambda t, q=q, qd=qd, qdd=qdd: value(  # noqa: E731
            programs["kinetic_energy"], q + t * qd + t**2 * qdd / 2, qd + t * qdd, context=EXACT
        )
        potential = lambda t, q=q, qd=qd: value(programs["potential_energy"], q + t * qd, context=EXACT)  # noqa: E731
        step = EXACT.mpf(10) ** -18
        change = sum((energy(step) - energy(-step)) / (2 * step) for energy in (kinetic, potential))
        assert abs(change - tau @ qd) < DIFFERENCES * (abs(tau) @ abs(qd))


def test_dynamics_agree_with_each_other(leg):
    programs, _, oracle = leg
    for q, qd, qdd in STATES:
        tau, f = value(programs["inverse_dynamics"], q, qd, qdd), np.array([3.0, -5.0, 20.0])
        loaded = value(programs["inverse_dynamics"], q, qd, qdd, f)
        assert value(programs["forward_dynamics"], q, qd, loaded, f) == pytest.approx(qdd, abs=1e-9)
        C, h, g = (
            value(programs[name], *given) for name, given in (("coriolis_matrix", (q, qd)), ("bias", (q, qd)), ("gravity_torque", (q,)))
        )
        scale = np.abs(tau).max()
        assert h == pytest.approx(C @ qd + g, abs=1e-11 * scale)
        Y, p = values(programs["base_parameters"], q, qd, qdd)
        assert Y @ p - oracle.moments(q).sum(0) == pytest.approx(tau, abs=1e-10 * scale)


def test_slopes_of_the_efforts(leg):
    programs = leg[0]
    q, qd, qdd = (exact(row) for row in STATES[1])
    by_q, by_qd = (np.array(table) for table in values(programs["inverse_dynamics_derivatives"], q, qd, qdd, context=EXACT))
    for joint, unit in enumerate(np.eye(3)):
        slope = rate_along(lambda at: value(programs["inverse_dynamics"], at, qd, qdd, context=EXACT), q, exact(unit))
        rate = rate_along(lambda at: value(programs["inverse_dynamics"], q, at, qdd, context=EXACT), qd, exact(unit))
        assert max(abs(slope - by_q[:, joint])) < DIFFERENCES * max(abs(slope))
        assert max(abs(rate - by_qd[:, joint])) < DIFFERENCES * max(abs(rate))


def of_robot(spec, name):
    return lower(FloatingFunctions(mechanism_of(spec)).function(name), fma=False)


# ---- the whole robot ------------------------------------------------------------------------------------------------------------------


def test_on_a_floating_base_springs_push_joints_alone(tmp_path):
    """The same robot with springs and with lumps alone: base wrench equal, joints apart by the springs' moments."""
    text = sprung_text(3)
    slack = re.sub(r"stiffness = \S+", "stiffness = 1e-9", re.sub(r"initial_tension = \S+", "initial_tension = 0.0", text))
    (tmp_path / "slack").mkdir()
    sprung, loose = (
        of_robot(written(folder, spec), "floating_inverse_dynamics") for folder, spec in ((tmp_path, text), (tmp_path / "slack", slack))
    )
    pose, random = np.eye(4), np.random.default_rng(8)
    q, v, a = random.uniform(-1, 1, 3), random.normal(size=9), random.normal(size=9)
    one, other = (value(program, pose, q, v, a) for program in (sprung, loose))
    scale = np.abs(one).max()
    assert one[:6] == pytest.approx(other[:6], abs=1e-12 * scale)
    assert one[6:] - other[6:] == pytest.approx(-Sprung(text).moments(q).sum(0), abs=1e-8 * scale)


def test_what_springs_weigh_at_the_mount_hangs_on_the_platform(tmp_path):
    """Centre of mass of the robot: that of the bare one and of every end."""
    text = sprung_text(4)
    bare = re.sub(r"masses = .*", "", text)
    (tmp_path / "bare").mkdir()
    heavy, light = (of_robot(written(folder, spec), "com") for folder, spec in ((tmp_path, text), (tmp_path / "bare", bare)))
    q, oracle = np.array([0.3, -0.1, 0.7]), Sprung(text)
    own = 3.0 + 3 * 1.1
    masses, ends = oracle.masses(), oracle.ends(q).real
    wanted = (own * value(light, np.eye(4), q) + (masses[..., None] * ends).sum((0, 1))) / (own + masses.sum())
    assert value(heavy, np.eye(4), q) == pytest.approx(wanted, rel=1e-13)


def test_a_mirrored_leg_has_mirrored_springs(tmp_path):
    mirror = '[[legs]]\nname = "other"\nmirror_of = "leg"\n'
    path = written(tmp_path, sprung_text(6).replace("rpy_deg = [20, -35, 60]", "rpy_deg = [0, 0, 60]") + mirror)
    names = ("spring_length", "spring_moment", "gravity_torque", "potential_energy", "mass_matrix")
    left, right = (leg_programs(path, index, names) for index in (0, 1))
    for name in names:
        one, other = (value(leg[name], STATES[2, 0]) for leg in (left, right))
        assert one == pytest.approx(other, rel=1e-11, abs=1e-11)


def test_a_leg_without_springs_has_no_functions_of_them(tmp_path):
    assert not leg_programs(written(tmp_path, spec_of(*ROWS)), names=tuple(SPRUNG))


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_in_every_target(built, backend):
    text = sprung_text(1)
    wanted = ", ".join(f'"{name}"' for name in (*SPRUNG, *PULLED, "potential_energy", "foot_position"))
    made, q = built(text.replace("[leg_designs.arm]", f"[generate]\nfunctions = [{wanted}]\n[leg_designs.arm]", 1)), STATES[:, 0]
    oracle = Sprung(text)
    moments = np.array([oracle.moments(row) for row in q])
    assert made.call(backend, "leg", "spring_moment", q) == pytest.approx(moments, abs=1e-12 * np.abs(moments).max())
    assert made.call(backend, "leg", "spring_length", q) == pytest.approx(np.array([oracle.lengths(row).real for row in q]), rel=1e-13)
    for name, given in (("gravity_torque", (q,)), ("potential_energy", (q,)), ("bias", (q, q)), ("inverse_dynamics", (q, q, q, q))):
        wanted = made.call("interpreter", "leg", name, *given)
        assert made.call(backend, "leg", name, *given) == pytest.approx(wanted, rel=1e-11, abs=1e-11 * np.abs(wanted).max())

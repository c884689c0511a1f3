"""Dynamics of legs: few operations, and what mechanics says of them whatever the leg, to many digits."""

import numpy as np
import pytest
from dynamic_legs import BODY, EXACT, SLIDE, SPECS, THIGH, YAW, exact, leg_programs, rate_along, spec_of, value, values, written

from cases.to_spec import LEG_CASES, case, from_dh, from_tree
from oracles.measure import difference

ACCURACY = 1e-11
ROUNDING = 1e-36  # constants have 40 digits
WEIGHED = [name for name in LEG_CASES if name != "csiro_bullet_ar_leg_dh"]
PUBLISHED = ("mass_matrix", "bias", "gravity_torque", "inverse_dynamics", "coriolis_matrix", "forward_dynamics")
SEVEN = [f"{YAW}, {BODY}", f"{THIGH}, {BODY}", f"{SLIDE}, {BODY}", THIGH.replace("thigh", "light"), f"{YAW.replace('yaw', 'turn')}, {BODY}"]
SEVEN += [f"{THIGH.replace('thigh', 'knee')}, {BODY}", f"{SLIDE.replace('slide', 'foot')}, {BODY}"]
LEGS = {
    "plain": [f"{YAW}, {BODY}", f"{THIGH}, {BODY}", f"{THIGH.replace('thigh', 'shank')}, {BODY}"],
    "sliding": [f"{YAW}, {BODY}", f"{THIGH}, {BODY}", f"{SLIDE}, {BODY}"],
    "crane": [f"{SLIDE}, {BODY}", f"{YAW}, {BODY}", f"{SLIDE.replace('slide', 'lift')}, {BODY}"],
    "seven": SEVEN,
}


@pytest.fixture(scope="module", params=[pytest.param(name, marks=pytest.mark.nightly) if name == "seven" else name for name in LEGS])
def leg(request, tmp_path_factory):
    return leg_programs(written(tmp_path_factory.mktemp(request.param), spec_of(*LEGS[request.param])))


@pytest.fixture
def state(leg):
    """q, qd and qdd of 50 digits."""
    count = leg["bias"].signature.inputs[0].size
    return exact(np.random.default_rng(11).uniform(-1.5, 1.5, (3, count)))


# ---- reference cases ---------------------------------------------------------------------------------------------------------------


@pytest.mark.sampled(4)
@pytest.mark.parametrize("convert", [from_tree, from_dh])
@pytest.mark.parametrize("name", WEIGHED)
def test_published_samples(tmp_path, name, convert):
    data = case(name)
    text = with_bodies(data) if convert is from_dh else convert(data).text
    found = leg_programs(written(tmp_path, text), names=PUBLISHED)
    for sample in data["samples"]:
        q, qd, qdd = (np.array(sample[key]) for key in ("q", "qd", "qdd"))
        assert difference(value(found["mass_matrix"], q), sample["M"]) <= ACCURACY
        assert difference(value(found["bias"], q, qd), sample["nle"]) <= ACCURACY
        assert difference(value(found["gravity_torque"], q), sample["g"]) <= ACCURACY
        assert difference(value(found["inverse_dynamics"], q, qd, qdd), sample["tau"]) <= ACCURACY
        J = np.array(sample["J"])[:3]
        force = np.array([3.0, -5.0, 20.0])
        assert difference(value(found["inverse_dynamics"], q, qd, qdd, force), sample["tau"] - J.T @ force) <= ACCURACY
        assert difference(value(found["coriolis_matrix"], q, qd) @ qd, np.subtract(sample["nle"], sample["g"])) <= ACCURACY
        assert difference(value(found["forward_dynamics"], q, qd, np.array(sample["tau"]) - J.T @ force, force), qdd) <= 1e-9


def with_bodies(data):
    """The DH table's spec with the bodies of its links."""
    lines, links = [], iter(data["dh"]["links"])
    for line in from_dh(data).text.splitlines():
        lines.append(line)
        if line.startswith("type = "):
            link = next(links)
            inertia = np.array(link["inertia"])
            six = [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[0, 2], inertia[1, 2]]
            numbers = [", ".join(repr(float(entry)) for entry in entries) for entries in (link["com"], six)]
            lines.append(f"link = {{ mass = {link['mass']!r}, com = [{numbers[0]}], inertia = [{numbers[1]}], allow_unphysical = true }}")
    return "\n".join(lines) + "\n"


# ---- mechanics -----------------------------------------------------------------------------------------------------------------------


def test_mass_matrix_is_symmetric_and_positive(leg, state):
    M = value(leg["mass_matrix"], state[0]).astype(float)
    assert np.array_equal(M, M.T)
    assert np.linalg.eigvalsh(M)[0] > 0


def test_coriolis_matrix_is_christoffels(leg, state):
    """And so the rate of the mass matrix less twice it is skew."""
    q, qd, _ = state
    count = len(q)
    axes = exact(np.eye(count))
    slopes = [rate_along(lambda at: value(leg["mass_matrix"], at, context=EXACT), q, axis) for axis in axes]
    expected = exact(np.zeros((count, count)))
    for i, j, k in np.ndindex(count, count, count):
        expected[i, j] += (slopes[k][i, j] + slopes[j][i, k] - slopes[i][j, k]) * qd[k] / 2
    C = value(leg["coriolis_matrix"], q, qd, context=EXACT)
    assert np.max(np.abs(C - expected)) < 1e-18
    rate = rate_along(lambda at: value(leg["mass_matrix"], at, context=EXACT), q, qd)
    skew = rate - 2 * C
    assert np.max(np.abs(skew + skew.T)) < 1e-18


def test_efforts_are_mass_matrix_and_bias(leg, state):
    q, qd, qdd = state
    M, C = value(leg["mass_matrix"], q, context=EXACT), value(leg["coriolis_matrix"], q, qd, context=EXACT)
    bias, g = value(leg["bias"], q, qd, context=EXACT), value(leg["gravity_torque"], q, context=EXACT)
    tau = value(leg["inverse_dynamics"], q, qd, qdd, exact(np.zeros(3)), context=EXACT)
    assert np.max(np.abs(bias - (C @ qd + g))) < ROUNDING
    assert np.max(np.abs(tau - (M @ qdd + bias))) < ROUNDING
    assert np.max(np.abs(value(leg["forward_dynamics"], q, qd, tau, exact(np.zeros(3)), context=EXACT) - qdd)) < ROUNDING


def test_energies(leg, state):
    """T is the mass matrix's form, g the slope of U, and power flows into both."""
    q, qd, qdd = state
    M = value(leg["mass_matrix"], q, context=EXACT)
    assert abs(value(leg["kinetic_energy"], q, qd, context=EXACT) - qd @ M @ qd / 2) < ROUNDING
    slope = [rate_along(lambda at: value(leg["potential_energy"], at, context=EXACT), q, axis) for axis in exact(np.eye(len(q)))]
    assert np.max(np.abs(value(leg["gravity_torque"], q, context=EXACT) - slope)) < 1e-18
    tau = value(leg["inverse_dynamics"], q, qd, qdd, exact(np.zeros(3)), context=EXACT)

    def energy(both):
        position, rate = both
        return value(leg["kinetic_energy"], position, rate, context=EXACT) + value(leg["potential_energy"], position, context=EXACT)

    flow = rate_along(energy, np.array([q, qd]), np.array([qd, qdd]))
    assert abs(flow - tau @ qd) < 1e-18


def test_a_free_leg_keeps_its_energy():
    """A second of falling, Runge and Kutta's fourth order: what is lost is the integration's, less than a twelfth for half the step."""
    found = leg_programs(SPECS / "mero_leg.toml")
    energies = {step: integrated_energies(found, step) for step in (2e-3, 1e-3)}
    lost = {step: np.ptp(values) for step, values in energies.items()}
    assert lost[1e-3] < 1e-7 * np.max(np.abs(energies[1e-3]))
    assert lost[1e-3] < lost[2e-3] / 12


def integrated_energies(found, step):
    def slope(state):
        q, qd = state
        return np.array([qd, value(found["forward_dynamics"], q, qd)])

    state, energies = np.array([[0.3, 0.5, -1.0], [1.0, -2.0, 0.5]]), []
    for _ in range(round(1 / step)):
        one = slope(state)
        two = slope(state + step / 2 * one)
        three = slope(state + step / 2 * two)
        state = state + step / 6 * (one + 2 * two + 2 * three + slope(state + step * three))
        energies.append(value(found["kinetic_energy"], *state) + value(found["potential_energy"], state[0]))
    return energies


def test_derivatives_of_the_efforts(leg, state):
    """By q, qd and, as the mass matrix, qdd."""
    q, qd, qdd = state

    def efforts(both):
        return value(leg["inverse_dynamics"], *both, exact(np.zeros(3)), context=EXACT)

    by_q, by_qd = values(leg["inverse_dynamics_derivatives"], q, qd, qdd, context=EXACT)
    slopes = (by_q, by_qd, value(leg["mass_matrix"], q, context=EXACT))
    for which, slope in enumerate(slopes):
        for index in range(len(q)):
            way = exact(np.zeros((3, len(q))))
            way[which, index] = EXACT.mpf(1)
            assert np.max(np.abs(rate_along(efforts, np.array([q, qd, qdd]), way) - slope[:, index])) < 1e-18


# ---- what a spec may say -------------------------------------------------------------------------------------------------------------


def test_friction_and_rotors(tmp_path):
    """Viscous and Coulomb friction in efforts and bias, gear^2 times the rotor on the mass matrix's diagonal; nowhere else."""
    rows = [YAW, THIGH, SLIDE]
    drives = [
        "friction = { viscous = 0.3, coulomb = 0.7 }",
        "rotor = { inertia = 2e-4, gear = 50 }",
        "friction = { coulomb = 2.0 }, rotor = { inertia = 0.4 }",
    ]
    plain = leg_programs(written(tmp_path, spec_of(*(f"{row}, {BODY}" for row in rows))))
    driven = leg_programs(written(tmp_path, spec_of(*(f"{row}, {BODY}, {drive}" for row, drive in zip(rows, drives, strict=True)))))
    viscous, coulomb, rotor = np.array([0.3, 0, 0]), np.array([0.7, 0, 2.0]), np.array([0, 0.5, 0.4])
    generator = np.random.default_rng(5)
    for signs in (-1.0, 0.0, 1.0):
        q, qd, qdd = generator.uniform(0.1, 1.5, (3, 3))
        qd *= signs
        friction = viscous * qd + coulomb * np.sign(qd)
        assert difference(value(driven["bias"], q, qd), value(plain["bias"], q, qd) + friction) <= 1e-14
        tau = value(plain["inverse_dynamics"], q, qd, qdd) + friction + rotor * qdd
        assert difference(value(driven["inverse_dynamics"], q, qd, qdd), tau) <= 1e-14
        assert difference(value(driven["mass_matrix"], q), value(plain["mass_matrix"], q) + np.diag(rotor)) <= 1e-14
        assert difference(value(driven["forward_dynamics"], q, qd, tau), qdd) <= 1e-11
        plain_slopes, slopes = (values(found["inverse_dynamics_derivatives"], q, qd, qdd) for found in (plain, driven))
        assert np.array_equal(slopes[0], plain_slopes[0])
        assert difference(slopes[1], plain_slopes[1] + np.diag(viscous)) <= 1e-14
        energy = value(plain["kinetic_energy"], q, qd) + qd @ (rotor * qd) / 2
        assert difference(value(driven["kinetic_energy"], q, qd), energy) <= 1e-14
        for name in ("gravity_torque", "potential_energy"):
            assert np.array_equal(value(driven[name], q), value(plain[name], q))
        assert np.array_equal(value(driven["coriolis_matrix"], q, qd), value(plain["coriolis_matrix"], q, qd))


PARAMETERS = """[parameters]
load = { value = 0.8, unit = "kg", runtime = true }
down = { value = 9.0, unit = "m/s^2", runtime = true }
reach = { value = 0.25, unit = "m", runtime = true }
drag = { value = 0.2, runtime = true }
"""
INERTIA = 'inertia = ["load*reach**2", 0.05, 0.055, 0.001, -0.002, 0.003], allow_unphysical = true'
LOADED = f'link = {{ mass = "load", com = ["-reach/2", 0.02, "0.1*reach"], {INERTIA} }}'


def test_runtime_parameters_reach_param(tmp_path):
    """Gravity, mass, centre, inertia, friction and rotor follow `param`; the same numbers baked in give the same efforts."""
    rows = [f"{YAW}, {BODY}", f"{THIGH}, {BODY}", f"{THIGH.replace('thigh', 'shank')}, {LOADED}"]
    rows[2] += ', friction = { viscous = "drag" }, rotor = { inertia = "drag/100", gear = "2+drag" }'
    text = spec_of(*rows, parameters=PARAMETERS).replace("-9.80665", '"-down"')
    free = leg_programs(written(tmp_path, text))
    numbers = np.array([1.3, 3.7, 0.31, 0.45])
    baked = text.replace(PARAMETERS, "[parameters]\nload = 1.3\ndown = 3.7\nreach = 0.31\ndrag = 0.45\n")
    fixed = leg_programs(written(tmp_path, baked))
    q, qd, qdd = np.random.default_rng(3).uniform(-1.5, 1.5, (3, 3))
    arguments = {"q": q, "qd": qd, "qdd": qdd, "tau": qdd, "f": np.array([1.0, -2.0, 3.0]), "param": numbers}
    assert set(free) == set(fixed)
    for name, program in free.items():
        inputs = [arguments[port.name] for port in program.signature.inputs]
        assert program.signature.inputs[-1].name == "param"
        for one, other in zip(values(program, *inputs), values(fixed[name], *inputs[:-1]), strict=True):
            assert difference(one, other) <= 1e-13, name


def test_runtime_angles(tmp_path):
    """A twist, a zero and the mount's yaw in `param`, beside a sliding joint's offset."""
    table = "[parameters]\ntilt = { value = 0.4, runtime = true }\nway = { value = 0.1, runtime = true }\n"
    yaw, slide = YAW.replace("alpha_deg = 90", 'alpha = "tilt"'), SLIDE.replace("d = 0.2", 'd = "way"')
    rows = [f"{row}, {BODY}" for row in (yaw, THIGH, slide)]
    text = spec_of(*rows, parameters=table).replace("rpy_deg = [20, -35, 60]", 'rpy = [0.3, "2*tilt", "way"]')
    text = text.replace("[leg_designs.arm]", '[leg_designs.arm]\nzeros = [0.0, "tilt/3", "way"]')
    free = leg_programs(written(tmp_path, text))
    fixed = leg_programs(written(tmp_path, text.replace(table, "[parameters]\ntilt = 0.7\nway = -0.3\n")))
    q, qd, qdd = np.random.default_rng(6).uniform(-1.5, 1.5, (3, 3))
    arguments = {"q": q, "qd": qd, "qdd": qdd, "tau": qdd, "f": np.array([1.0, -2.0, 3.0])}
    for name, program in free.items():
        inputs = [arguments[port.name] for port in program.signature.inputs[:-1]]
        if name == "base_parameters":  # fewer may do for the one length than for all
            Y, p = values(program, *inputs, np.array([0.7, -0.3]))
            other, more = values(fixed[name], *inputs)
            assert difference(Y @ p, other @ more) <= 1e-12
            continue
        for one, other in zip(values(program, *inputs, np.array([0.7, -0.3])), values(fixed[name], *inputs), strict=True):
            assert difference(one, other) <= 1e-12, name


def test_a_leg_without_mass_carries_forces_only(tmp_path):
    found = leg_programs(written(tmp_path, spec_of(YAW, THIGH, SLIDE)))
    assert "forward_dynamics" not in found
    q, qd, qdd = np.random.default_rng(3).uniform(-1.5, 1.5, (3, 3))
    assert not np.any(value(found["inverse_dynamics"], q, qd, qdd))
    assert not np.any(value(found["mass_matrix"], q))
    assert np.all(value(found["inverse_dynamics"], q, qd, qdd, np.array([1.0, 2.0, 3.0])) != 0)


def test_a_massless_tip_leaves_no_accelerations(tmp_path):
    """The last joint moves nothing: any acceleration fits its effort of 0."""
    found = leg_programs(written(tmp_path, spec_of(f"{YAW}, {BODY}", THIGH)))
    assert "forward_dynamics" not in found
    assert value(found["mass_matrix"], [0.3, 0.4])[1].tolist() == [0, 0]


# ---- few operations --------------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def plain():
    return leg_programs(SPECS / "mero_leg.toml")


@pytest.mark.parametrize(
    ("name", "most"),
    [
        ("inverse_dynamics", 97),
        ("bias", 53),
        ("mass_matrix", 35),
        ("gravity_torque", 7),
        ("coriolis_matrix", 73),
        ("forward_dynamics", 114),
        ("kinetic_energy", 55),
        ("potential_energy", 9),
        ("inverse_dynamics_derivatives", 173),
    ],
)
def test_plain_leg_costs_little(plain, name, most):
    """Sines and cosines count one each; the foot force's share of the inverse dynamics is 19."""
    assert plain[name].operation_count <= most

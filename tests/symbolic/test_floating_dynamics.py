"""Dynamics of the whole robot on a floating base: published samples, identities of mechanics, few operations."""

import numpy as np
import pytest
from dynamic_legs import BODY, EXACT, SPECS, THIGH, YAW, exact, leg_programs, robot_programs, spec_of, value, written

from cases.to_spec import ROBOT_CASES, case, from_tree
from oracles.dynamic_peer import DynamicPeer
from oracles.measure import difference
from walkgen.pipeline import mechanism_of

ACCURACY = 1e-11
WORDS = {"com": "com", "com_jacobian": "Jcom", "centroidal_momentum_matrix": "Ag", "momentum": "hg", "momentum_rate": "dhg"}
WORDS |= {"floating_mass_matrix": "M", "floating_inverse_dynamics": "tau"}


def call(found, name, **arguments):
    """A function by its ports' names; ports without an argument are zeros."""
    return value(found[name], *(arguments.get(port.name, np.zeros(port.shape)) for port in found[name].signature.inputs))


@pytest.fixture(scope="module", params=ROBOT_CASES)
def published(request, tmp_path_factory):
    data = case(request.param)
    conversion = from_tree(data)
    return data, conversion, robot_programs(written(tmp_path_factory.mktemp(request.param), conversion.text))


def arguments_of(sample, order):
    """A sample's state in walkgen's order."""
    columns = [*range(6), *(6 + index for index in order)]
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = sample["base_R"], sample["base_pos"]
    v, a = np.array(sample["v"])[columns], np.array(sample["a"])[columns]
    return columns, {"base_pose": pose, "q": np.array(sample["q"])[list(order)], "v": v, "a": a}


def test_published_samples(published):
    data, conversion, found = published
    for sample in data["samples"]:
        columns, state = arguments_of(sample, conversion.order)
        for name, key in WORDS.items():
            if key not in sample:
                continue
            expected = np.array(sample[key])
            if name in ("com_jacobian", "centroidal_momentum_matrix"):
                expected = expected[:, columns]
            if name.startswith("floating"):
                expected = expected[np.ix_(*[columns] * expected.ndim)]
            assert difference(call(found, name, **state), expected) <= ACCURACY, name


def test_published_weights_and_velocities(published):
    """Nothing moves: g; the centre's velocity and acceleration; the load on the ground."""
    data, conversion, found = published
    for sample in data["samples"]:
        columns, state = arguments_of(sample, conversion.order)
        held = call(found, "floating_inverse_dynamics", base_pose=state["base_pose"], q=state["q"])
        assert difference(held, np.array(sample["g"])[columns]) <= ACCURACY
        bias = call(found, "floating_inverse_dynamics", **{**state, "a": 0 * state["a"]})
        assert difference(bias, np.array(sample["nle"])[columns]) <= ACCURACY
        assert difference(call(found, "com_jacobian", **state) @ state["v"], sample["vcom"]) <= ACCURACY
        mass, gravity = data["total_mass"], np.array(data["model"]["gravity"])
        assert difference(call(found, "momentum_rate", **state)[:3] / mass, sample["acom"]) <= ACCURACY
        push = mass * gravity - np.array(sample["dhg"])[:3]
        load = np.concatenate([push, np.cross(sample["com"], push) - np.array(sample["dhg"])[3:]])
        assert difference(call(found, "demanded_wrench", **state), load) <= ACCURACY


def test_published_foot_jacobians_carry_foot_forces(published):
    data, conversion, found = published
    samples = [sample for sample in data["samples"] if "J_feet_lin" in sample]
    assert samples
    for sample in samples:
        columns, state = arguments_of(sample, conversion.order)
        forces = np.random.default_rng(1).normal(size=(len(conversion.feet), 3)) * 50
        J = np.array(sample["J_feet_lin"])[:, :, columns]
        tau = np.array(sample["tau"])[columns] - np.einsum("fij,fi->j", J, forces)
        assert difference(call(found, "floating_inverse_dynamics", **state, foot_forces=forces), tau) <= ACCURACY


# ---- mechanics -----------------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def star():
    """A robot whose chains branch, and a state of it."""
    path = SPECS / "mero_style.toml"
    generator = np.random.default_rng(8)
    count = sum(len(limb.joints) for limb in mechanism_of(path).limbs)
    R, _ = np.linalg.qr(generator.normal(size=(3, 3)))
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = R * np.linalg.det(R), generator.normal(size=3)
    v, a = generator.normal(size=(2, 6 + count))
    return robot_programs(path), {"base_pose": pose, "q": generator.uniform(-1, 1, count), "v": v, "a": a}


def test_momentum_is_the_matrix_times_the_rates(star):
    found, state = star
    A = call(found, "centroidal_momentum_matrix", **state)
    assert difference(A @ state["v"], call(found, "momentum", **state)) <= 1e-12


def test_efforts_are_mass_matrix_and_bias(star):
    found, state = star
    bias = call(found, "floating_inverse_dynamics", **{**state, "a": 0 * state["a"]})
    M = call(found, "floating_mass_matrix", **state)
    assert np.array_equal(M, M.T)
    assert np.linalg.eigvalsh(M)[0] > 0
    assert difference(M @ state["a"] + bias, call(found, "floating_inverse_dynamics", **state)) <= 1e-11


def test_the_base_needs_what_the_ground_must_give(star):
    """The base's rows, in the world's axes about its origin, are opposite to the load."""
    found, state = star
    tau, load = call(found, "floating_inverse_dynamics", **state), call(found, "demanded_wrench", **state)
    R, p = state["base_pose"][:3, :3], state["base_pose"][:3, 3]
    force, moment = R @ tau[:3], R @ tau[3:6]
    assert difference(np.concatenate([force, moment + np.cross(p, force)]), -load) <= 1e-12


def test_foot_forces_that_balance_the_load_leave_the_base_free(star):
    """The ground's least forces against the demanded wrench: the base's rows vanish."""
    found, state = star
    path = SPECS / "mero_style.toml"
    peer = DynamicPeer(path.read_text(encoding="utf-8"))
    local = peer.walker.foot_positions(state["q"])
    feet = local @ state["base_pose"][:3, :3].T + state["base_pose"][:3, 3]
    G = np.vstack([np.hstack([np.eye(3)] * len(feet)), np.hstack([np.cross(np.eye(3), foot).T for foot in -feet])])
    f = np.linalg.lstsq(G, -call(found, "demanded_wrench", **state), rcond=None)[0].reshape(-1, 3)
    tau = call(found, "floating_inverse_dynamics", **state, foot_forces=f)
    assert np.max(np.abs(tau[:6])) < 1e-10 * np.max(np.abs(tau))


def test_a_held_base_is_the_legs_own(tmp_path):
    """With the base's axes the world's and at rest, the joints' rows are the leg's functions."""
    path = written(
        tmp_path,
        spec_of(
            f"{YAW}, {BODY}", f"{THIGH}, {BODY}, friction = {{ viscous = 0.2, coulomb = 0.1 }}, rotor = {{ inertia = 0.01, gear = 3 }}"
        ),
    )
    robot, leg = robot_programs(path), leg_programs(path)
    q, qd, qdd = np.random.default_rng(2).normal(size=(3, 2))
    force = np.array([1.0, -2.0, 9.0])
    v, a = np.concatenate([np.zeros(6), qd]), np.concatenate([np.zeros(6), qdd])
    tau = call(robot, "floating_inverse_dynamics", base_pose=np.eye(4), q=q, v=v, a=a, foot_forces=force[None])
    assert difference(tau[6:], value(leg["inverse_dynamics"], q, qd, qdd, force)) <= 1e-13
    M = call(robot, "floating_mass_matrix", base_pose=np.eye(4), q=q)
    assert difference(M[6:, 6:], value(leg["mass_matrix"], q)) <= 1e-13


def test_power_balance(tmp_path):
    """Kinetic energy v' M v / 2 grows by v' tau less what gravity takes, to many digits along a motion of base and joints."""
    path = written(tmp_path, spec_of(f"{YAW}, {BODY}", f"{THIGH}, {BODY}").replace("-9.80665", "0.0"))
    found = robot_programs(path)
    generator = np.random.default_rng(4)
    q = exact(generator.normal(size=2))
    v, a = (exact(values) for values in generator.normal(size=(2, 8)))
    step = EXACT.mpf(10) ** -20
    pose = exact(np.eye(4))

    def energy(sign):
        M = value(found["floating_mass_matrix"], pose, q + sign * step * v[6:], context=EXACT)
        rates = v + sign * step * a
        return rates @ M @ rates / 2

    tau = value(found["floating_inverse_dynamics"], pose, q, v, a, exact(np.zeros(3)), context=EXACT)
    assert abs((energy(1) - energy(-1)) / (2 * step) - v @ tau) < 1e-18


# ---- what a spec may say -------------------------------------------------------------------------------------------------------------


def test_a_robot_without_mass_has_no_centre(tmp_path):
    text = spec_of(YAW, THIGH)
    start, end = text.index("mass = 3.0"), text.index("[[legs]]")
    found = robot_programs(written(tmp_path, text[:start] + text[end:]))
    assert set(found) == {"demanded_wrench", "floating_mass_matrix", "floating_inverse_dynamics"}


def test_a_load_on_board_moves_the_centre(tmp_path):
    """The mass of a platform as a runtime parameter."""
    text = spec_of(f"{YAW}, {BODY}", f"{THIGH}, {BODY}", parameters="[parameters]\nload = { value = 3.0, runtime = true }")
    found = robot_programs(written(tmp_path, text.replace("mass = 3.0", 'mass = "load"')))
    q = np.array([0.3, -0.4])
    for load in (0.5, 3.0, 20.0):
        peer = DynamicPeer(text.replace("mass = 3.0", f"mass = {load}"))
        zeros = np.zeros((2, 8))
        expected = peer.robot(np.eye(4), q, *zeros, np.zeros((1, 3)))
        assert difference(call(found, "com", base_pose=np.eye(4), q=q, param=[load]), expected["com"]) <= 1e-14
        M = call(found, "floating_mass_matrix", base_pose=np.eye(4), q=q, param=[load])
        assert difference(M, expected["floating_mass_matrix"]) <= 1e-13


@pytest.fixture(scope="module")
def mero():
    return robot_programs(SPECS / "mero.toml")


@pytest.mark.parametrize(
    ("name", "most"),
    [("floating_inverse_dynamics", 2011), ("floating_mass_matrix", 1995), ("centroidal_momentum_matrix", 1946), ("com", 195)],
)
def test_mero_costs_little(mero, name, most):
    """24 joints, six feet with forces; CasADi's graph of the robot's dynamics has 5934 nodes."""
    assert mero[name].operation_count <= most

"""Legs of joints, a linkage and joints again, beside Pinocchio with loops closed by numbers."""

import tomllib
from itertools import product

import numpy as np
import pytest

from linkages.chained import ROWS, Chained, with_joints
from linkages.open_chain import OPEN, SERIES
from linkages.placed import code_of
from linkages.topologies import STEPHENSON_2, TOPOLOGIES, spec
from oracles.walker import Reader

LEGS = {
    "four_bar R1R": ("four_bar", "R", "R"),
    "hydraulic R2RP": ("hydraulic", "R", "RP"),
    "slider_crank P1PR": ("slider_crank", "P", "PR"),
    "five_bar 2P": ("five_bar", "", "P"),
}
KINEMATICS = (
    "foot_pose",
    "foot_spatial_jacobian",
    "foot_hessian",
    "foot_velocity",
    "foot_acceleration",
    "foot_bias_acceleration",
    "joint_frames",
)
DYNAMICS = (
    "mass_matrix",
    "bias",
    "gravity_torque",
    "coriolis_matrix",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "inverse_dynamics_derivatives",
    "regressor",
    "base_parameters",
    "potential_energy",
)
OWN = ("assembly_status", "transmission_angles", "driving_forces", "power", "joint_reactions", "pair_positions")
ALIKE = {
    **dict.fromkeys(("foot_pose", "foot_spatial_jacobian", "foot_hessian", "mass_matrix", "gravity_torque", "potential_energy"), "q"),
    **dict.fromkeys(("foot_compliance", "sole_compliance", "sole_points", "sole_normal"), "q"),
    **dict.fromkeys(("foot_bias_acceleration", "bias", "coriolis_matrix", "kinetic_energy"), "q qd"),
    **dict.fromkeys(("foot_acceleration", "inverse_dynamics_derivatives"), "q qd qdd"),
    "inverse_dynamics": "q qd qdd f",
    "forward_dynamics": "q qd tau f",
}
"""Functions that do not tell of a design's joints, with what they take."""
FEW = ("foot_pose", "sole_normal", "inverse_dynamics", "foot_compliance")
FLOATING = {"foot_jacobians": "q", "com": "pose q", "floating_mass_matrix": "pose q", "floating_inverse_dynamics": "pose q v a f"}
FUNCTIONS = (*KINEMATICS, *DYNAMICS, *OWN)
GRAVITY = "gravity = [0.7, -9.8, 0]", "gravity = [0.7, -1.1, -9.8]"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A leg's functions, its oracle, and a few q with the poses of its links, away from dead points."""
    done = {}

    def of(name):
        if name not in done:
            topology, before, after = LEGS[name]
            random, sides = np.random.default_rng(5), TOPOLOGIES[topology].sides
            while True:
                dimensions, drives = TOPOLOGIES[topology].draw(random, 12)
                text = spec(topology, FUNCTIONS, values=dimensions[0]).replace("runtime = true", "runtime = false").replace(*GRAVITY)
                oracle = Chained(with_joints(text, before, after), sides)
                x = oracle.closed(drives, random)
                closes = np.flatnonzero(np.isfinite(x[:, 0]))
                if len(closes) > 4:
                    break
            code = code_of(oracle.text, FUNCTIONS, tmp_path_factory.mktemp("leg"))
            q = np.concatenate([random.uniform(-1, 1, (12, len(before))), drives, random.uniform(-1, 1, (12, len(after)))], -1)
            assert np.array_equal(code["leg_assembly_status"](q) == 0, np.isfinite(x[:, 0]))
            sines = np.abs(np.sin(code["leg_transmission_angles"](q[closes]))).min(-1)
            best = closes[np.argsort(-sines)][:3]
            done[name] = {key.removeprefix("leg_"): value for key, value in code.items()}, oracle, q[best], x[best]
        return done[name]

    return of


def rates_of(q, seed):
    random = np.random.default_rng(seed)
    return random.uniform(-1, 1, len(q)), random.uniform(-1, 1, len(q)), random.uniform(-50, 50, 3)


def near(wanted, tolerance=1e-8):
    """Within so much of the largest entry."""
    return pytest.approx(wanted, abs=tolerance * max(1.0, np.abs(wanted).max()))


def sloped(function, q, step):
    """By every q, a last axis: central differences."""
    return np.stack([(function(q + unit) - function(q - unit)) / (2 * step) for unit in step * np.eye(len(q))], -1)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", LEGS)
def test_kinematics(made, name):
    code, oracle, *cases = made(name)
    for q, x in zip(*cases, strict=True):
        qd, qdd, _ = rates_of(q, 1)
        y, yd, ydd, S = oracle.at(q, x, qd, qdd)
        J = oracle.jacobian(y) @ S
        assert code["foot_pose"](q) == near(oracle.pose(y), 1e-12)
        assert code["foot_spatial_jacobian"](q) == near(J)
        assert code["foot_velocity"](q, qd) == near(J[:3] @ qd)
        assert code["foot_acceleration"](q, qd, qdd) == near(oracle.acceleration(y, yd, ydd)[:3])
        assert code["foot_bias_acceleration"](q, qd) == near(oracle.acceleration(*oracle.at(q, x, qd)[:3]))
        assert code["foot_hessian"](q) == near(sloped(lambda value: oracle.slopes(value, x)[:3], q, 1e-4), 1e-6)  # noqa: B023 - called here
        frames = code["joint_frames"](q)
        assert frames[-1] @ oracle.tip == near(code["foot_pose"](q), 1e-12)
        assert frames[-oracle.count[1] :] == near(oracle.frames_after(y), 1e-12)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", LEGS)
def test_dynamics(made, name):
    code, oracle, *cases = made(name)
    viscous, coulomb = oracle.frictions
    for q, x in zip(*cases, strict=True):
        qd, qdd, f = rates_of(q, 2)
        y, _, _, S = oracle.at(q, x)
        M, rubbed = oracle.mass_matrix(y, S), viscous * qd + coulomb * np.sign(qd)
        free = oracle.efforts(q, x, qd, qdd, f)[1]
        tau = free + oracle.motors * qdd + rubbed
        assert code["inverse_dynamics"](q, qd, qdd, f) == near(tau)
        assert code["forward_dynamics"](q, qd, tau, f) == near(qdd, 1e-6)
        assert code["mass_matrix"](q) == near(M)
        held, steady = oracle.efforts(q, x)[1], oracle.efforts(q, x, qd)[1]
        assert code["gravity_torque"](q) == near(held)
        assert code["bias"](q, qd) == near(steady + rubbed)
        C = code["coriolis_matrix"](q, qd)
        assert C @ qd == near(steady - held)
        step = 1e-4
        ahead, behind = (oracle.mass_matrix(*(oracle.at(q + side * step * qd, x)[index] for index in (0, 3))) for side in (1, -1))
        assert near((ahead - behind) / (2 * step), 1e-6) == C + C.T
        assert code["kinetic_energy"](q, qd) == near(qd @ M @ qd / 2)
        assert code["potential_energy"](q) == near(oracle.potential(y))
        by_q, by_qd = code["inverse_dynamics_derivatives"](q, qd, qdd)
        own = code["inverse_dynamics"]
        assert by_q == near(sloped(lambda value: own(value, qd, qdd, 0 * f), q, 1e-6), 1e-6)  # noqa: B023 - called here
        assert by_qd == near(sloped(lambda value: own(q, value, qdd, 0 * f), qd, 1e-6), 1e-6)  # noqa: B023 - called here


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", LEGS)
def test_identification(made, name):
    """Efforts are linear in what links weigh: those before, the linkage's, those after."""
    code, oracle, *cases = made(name)
    for q, x in zip(*cases, strict=True):
        qd, qdd, _ = rates_of(q, 3)
        free = oracle.efforts(q, x, qd, qdd)[1]
        assert code["regressor"](q, qd, qdd) @ oracle.parameters() == near(free)
        Y, p = code["base_parameters"](q, qd, qdd)
        assert Y @ p == near(free)
        assert Y.shape[1] < code["regressor"](q, qd, qdd).shape[1]


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", LEGS)
def test_forces_in_the_linkage(made, name):
    """Every link of the plane is in balance with what its pairs, the joints after it and its drives give it."""
    code, oracle, *cases = made(name)
    for q, x in zip(*cases, strict=True):
        qd, qdd, f = rates_of(q, 4)
        tau = code["inverse_dynamics"](q, qd, qdd, f)
        assert code["driving_forces"](q, qd, qdd, f) == near(tau[oracle.count[0] : len(tau) - oracle.count[1]], 1e-13)
        power, total, positive = code["power"](q, qd, qdd, f)
        assert power == near(tau * qd)
        assert np.array([total, positive]) == near(np.array([power.sum(), power[power > 0].sum()]))
        rows = code["joint_reactions"](q, qd, qdd, f)
        efforts, (before, after) = oracle.efforts(q, x, qd, qdd, f)[0], oracle.count
        wanted = efforts[before : len(efforts) - after].reshape(-1, 3)
        given = np.zeros((len(oracle.links), 3))
        for (link, arm), row in zip(oracle.pair_ends(x), rows, strict=True):
            if link != "frame":
                given[oracle.links.index(link)] += [row[0], row[1], row[2] + arm[0] * row[1] - arm[1] * row[0]]
        assert given == near(wanted)
        places = code["pair_positions"](q)
        assert places[-1] == near(code["foot_pose"](q)[:3, 3], 1e-12)


@pytest.fixture(scope="module")
def twice(tmp_path_factory):
    """Functions of one leg and its mirror image, in series and with a linkage without loops."""

    def of(names):
        return [code_of(text, names, tmp_path_factory.mktemp(name)) for name, text in (("series", SERIES), ("open", OPEN))]

    return of


@pytest.mark.parametrize("names", [pytest.param(FEW, id="few"), pytest.param(tuple(ALIKE), id="all", marks=pytest.mark.nightly)])
def test_a_linkage_without_loops_is_a_leg_in_series(twice, names):
    """A mirrored leg as well, in all that two legs have which are told in these two ways."""
    series, own = twice(names)
    random = np.random.default_rng(7)
    given = {name: random.uniform(-1, 1, (4, 5)) for name in ("q", "qd", "qdd", "tau")} | {"f": random.uniform(-50, 50, (4, 3))}
    for leg, name in product(("leg", "other"), names):
        arguments = [given[key] for key in ALIKE[name].split()]
        found, wanted = (code[f"{leg}_{name}"](*arguments) for code in (own, series))
        for one, other in zip(*((each if isinstance(each, tuple) else (each,)) for each in (found, wanted)), strict=True):
            assert one == near(other, 1e-11), name


@pytest.mark.nightly
def test_a_robot_on_linkages_without_loops(twice):
    series, own = twice(tuple(FLOATING))
    random = np.random.default_rng(8)
    given = {"q": random.uniform(-1, 1, 10), "v": random.uniform(-1, 1, 16), "a": random.uniform(-1, 1, 16), "pose": np.eye(4)}
    given["f"] = random.uniform(-50, 50, (2, 3))
    for name, inputs in FLOATING.items():
        arguments = [given[key] for key in inputs.split()]
        assert own[name](*arguments) == near(series[name](*arguments), 1e-11), name


TRIAD = """
walkgen = 1
robot = { name = "triad", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "leg", platform = "body" }]
[leg_designs.leg]
"""


def test_a_joint_on_a_triad(tmp_path):
    """Its q comes after the drive that the triad is followed by."""
    (plain, hung), row = (tmp_path / name for name in ("plain", "hung")), ROWS["R"]
    for folder in (plain, hung):
        folder.mkdir()
    after = f'dh = "classic"\nlinkage_end = {{ rpy_deg = [20, 70, 0] }}\njoints_after = [{{ name = "ankle", {row} }}]\n'
    bare = code_of(TRIAD + STEPHENSON_2, ("foot_pose",), plain)
    code = code_of(TRIAD + after + STEPHENSON_2, ("foot_pose", "inverse_near"), hung)
    q = np.array([[0.3, 0.5], [-0.4, -0.7]])
    reader = Reader(tomllib.loads(TRIAD + after), {})
    design = reader.table["leg_designs"]["leg"]
    joint = reader.joint("classic", design["joints_after"][0], 1, 0.0)
    wanted = [bare["leg_foot_pose"](own[:1]) @ reader.pose(design["linkage_end"]) @ joint.transform(own[1]) for own in q]
    found = code["leg_foot_pose"](q)
    assert np.isfinite(found).all()
    assert found == near(np.array(wanted), 1e-12)
    back, status = code["leg_inverse_near"](found[:, :3, 3], q + 0.01)
    assert (status == 0).all()
    assert back == near(q, 1e-9)

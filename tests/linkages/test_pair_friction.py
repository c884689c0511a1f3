"""Friction in pins, sliders and cylinders beside free bodies with it, beside virtual work, and as heat."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from linkages.closure import Closure, assembled
from linkages.newton_euler import Bodies, Motion
from linkages.placed import as_unknowns, code_of
from linkages.rubbed import Rubbed
from linkages.topologies import TOPOLOGIES, spec

SMOOTH = ("assembly_status", "transmission_angles", "joint_reactions", "power")
FUNCTIONS = (
    "joint_reactions",
    "inverse_dynamics",
    "driving_forces",
    "power",
    "bias",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "kinetic_energy",
    "potential_energy",
)
TINY = 1e-30
GRAVITY, SETS = (0.7, -9.8), 4
BOLT = "viscous = 0.8, coulomb = 1.5, mu = 0.2, radius = 0.03"
FRICTION = {
    "slider_crank": {"a": BOLT, "b": "mu = 0.1, radius = 0.02", "c": "viscous = 0.4", "slide": "coulomb = 3, viscous = 5, mu = 0.15"},
    "moving_guide": {"c": BOLT, "slide": "mu = 0.3"},
    "hydraulic": {"i": BOLT, "h": "coulomb = 2"},
    "telescope": {"a": "mu = 0.1, radius = 0.05", "stroke": "viscous = 4, mu = 0.2"},
    "pin_of_three": {"c": BOLT, "f": "mu = 0.1, radius = 0.04"},
    "four_bar": {"b": "coulomb = 1", "damper": "viscous = 30, coulomb = 4"},
}
QUICK = ("slider_crank", "four_bar")
MARKED = [pytest.param(name, marks=() if name in QUICK else pytest.mark.nightly) for name in FRICTION]
DAMPER = '[[leg_designs.one.cylinders]]\nname = "damper"\nbetween = ["frame.A", "coupler.C"]\nmasses = { at_first = 0, at_second = 0 }\n'


def text_of(name, friction, functions=FUNCTIONS):
    damper = DAMPER + (f"friction = {{ {friction['damper']} }}\n" if "damper" in friction else "")
    return spec(name, functions, friction) + ("\n" + damper if name == "four_bar" else "")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Code with friction and without, and some sets of dimensions and drives, away from dead points."""
    done = {}

    def of(name):
        if name not in done:
            each = ((FRICTION[name], FUNCTIONS), ({}, SMOOTH))
            codes = [code_of(text_of(name, *of), of[1], tmp_path_factory.mktemp(name)) for of in each]
            done[name] = (*codes, sets(codes[1], name))
        return done[name]

    return of


def sets(code, name):
    topology, random = TOPOLOGIES[name], np.random.default_rng(31)
    dimensions, drives = topology.draw(random, 80)
    sines = np.sin(code["leg_transmission_angles"](drives, dimensions))
    closes = np.flatnonzero((code["leg_assembly_status"](drives, dimensions) == 0) & (np.abs(sines) > 0.2).all(-1))[:SETS]
    assert len(closes) == SETS
    return dimensions[closes], drives[closes]


def states(shape):
    random = np.random.default_rng(32)
    return random.normal(size=shape) / 5, random.normal(size=shape), random.normal(size=(shape[0], 3)) * (100, 100, 0)


@pytest.mark.parametrize("name", MARKED)
def test_drives_and_pairs_beside_free_bodies(made, name):
    """A dense system whose links are rubbed as their tables say gives the same efforts and reactions."""
    rubbing, _, (dimensions, drives) = made(name)
    text, random = text_of(name, FRICTION[name]), np.random.default_rng(33)
    poses = assembled(text, TOPOLOGIES[name].sides, dimensions, drives, random, np.full(SETS, 6))
    rates, seconds, loads = states(drives.shape)
    for one, q, x, qd, qdd, f in zip(dimensions, drives, poses, rates, seconds, loads, strict=True):
        motion = Motion(text, one, q, x, qd, qdd)
        rubbed = Rubbed(motion, Motion(text, one, q, x, qd), GRAVITY, f[:2])
        bodies = Bodies(motion, GRAVITY, f[:2], rubbed.loads)
        wanted = rubbed.given.copy()
        wanted[: len(bodies.ends)] += bodies.reactions
        scale = np.abs(bodies.unknowns).max()
        assert np.abs(rubbing["leg_joint_reactions"](q, qd, qdd, f, one) - wanted).max() < 1e-6 * scale
        own = np.array(rubbed.efforts)[rubbed.drives] if any(rubbed.drives) else 0.0
        assert np.abs(rubbing["leg_driving_forces"](q, qd, qdd, f, one) - bodies.unknowns[bodies.drives] - own).max() < 1e-6 * scale
        assert rubbed.power > 0


def heat_of(name, rubbing, smooth, dimensions, drives, qd, f):
    """Sum over the pairs of effort times rate [n] (W)."""
    steady = smooth["leg_joint_reactions"](drives, qd, 0 * qd, f, dimensions)
    text, x = text_of(name, FRICTION[name]), as_unknowns(rubbing["leg_poses"](drives, dimensions))
    poses = moving(text, dimensions, drives, x, qd)
    closures = [Closure(text, *(part[k : k + 1] for part in (dimensions, drives))) for k in range(len(drives))]
    return np.array([sum(heats(*each)) for each in zip(closures, poses, steady, strict=True)])


def moving(text, dimensions, drives, x, qd):
    """Origin and rotor of every link, with TINY times their rates as imaginary parts."""
    slope = Closure(text, dimensions, drives).equations(x)[1]
    ahead, behind = (Closure(text, dimensions, drives + sign * 1e-5 * qd).equations(x)[0] for sign in (1, -1))
    rates = np.linalg.solve(slope, (behind - ahead)[..., None])[..., 0] / 2e-5
    links = (x + TINY * 1j * rates).reshape(len(x), -1, 3)
    poses = np.concatenate([links[..., :2], np.cos(links[..., 2:]), np.sin(links[..., 2:])], -1)
    return np.concatenate([np.broadcast_to([0, 0, 1, 0], (len(x), 1, 4)), poses], 1)


def heats(closure, poses, reactions):
    """Of every pair's friction, from poses whose imaginary parts are their rates, and from what its ends carry without friction."""
    rows = iter(reactions)
    for pin in closure.design.get("pins", ()):
        rotors = [poses[closure.coordinates(text)[0], 2:] for text in pin["joins"]]
        loads = [np.hypot(*next(rows)[:2]) for _ in rotors]
        yield from (heat(pin, spin(rotor) - spin(rotors[0]), load) for rotor, load in zip(rotors[1:], loads[1:], strict=True))
    for cylinder in closure.design.get("cylinders", ()):
        if cylinder.get("driven"):
            next(rows), next(rows)
        else:
            way = np.subtract(*(place(poses, *closure.coordinates(text)) for text in cylinder["between"]))
            yield heat(cylinder, np.sqrt(way @ way).imag / TINY, 0.0)
    for slider in closure.design.get("sliders", ()):
        guide = closure.links.index(slider["guide"]["link"])
        turn = closure.direction(slider)[0]
        along = turned(poses[guide, 2:], (np.cos(turn), np.sin(turn)))
        start = place(poses, guide, closure.pair(slider["guide"]["point"]))
        way = place(poses, *closure.coordinates(slider["link"])) - start
        force, _ = next(rows)[:2], next(rows)
        yield heat(slider, (along @ way).imag / TINY, abs(along[0] * force[1] - along[1] * force[0]).real)


def heat(table, rate, load):
    own = table.get("friction", {})
    dry = own.get("coulomb", 0) + own.get("mu", 0) * own.get("radius", 1) * load
    return own.get("viscous", 0) * rate**2 + dry * abs(rate)


def spin(rotor):
    return (rotor[0].real * rotor[1].imag - rotor[1].real * rotor[0].imag) / TINY


def turned(rotor, point):
    return np.array([rotor[0] * point[0] - rotor[1] * point[1], rotor[1] * point[0] + rotor[0] * point[1]])


def place(poses, link, point):
    return poses[link, :2] + turned(poses[link, 2:], point[0])


@pytest.mark.parametrize("name", MARKED)
def test_what_friction_takes_is_the_pairs_power(made, name):
    """tau . qd is larger by the sum of effort times rate over the pairs, rates by the loops' equations."""
    rubbing, smooth, (dimensions, drives) = made(name)
    qd, qdd, f = states(drives.shape)
    with_it, without = (code["leg_power"](drives, qd, qdd, f, dimensions)[1] for code in (rubbing, smooth))
    heat = heat_of(name, rubbing, smooth, dimensions, drives, qd, f)
    assert np.min(heat) > 0
    assert with_it - without == pytest.approx(heat, rel=1e-9, abs=1e-9 * np.abs(with_it).max())


@pytest.mark.parametrize("name", MARKED)
def test_functions_of_dynamics_agree(made, name):
    """Accelerations and back; what is without acceleration and foot force is the bias; slopes are those of differences."""
    leg, _, (dimensions, drives) = made(name)
    qd, qdd, f = states(drives.shape)
    tau = leg["leg_inverse_dynamics"](drives, qd, qdd, f, dimensions)
    scale = np.abs(tau).max()
    assert leg["leg_driving_forces"](drives, qd, qdd, f, dimensions) == pytest.approx(tau)
    assert np.abs(leg["leg_forward_dynamics"](drives, qd, tau, f, dimensions) - qdd).max() < 1e-10 * np.abs(qdd).max()
    still, unloaded = np.zeros_like(qdd), np.zeros_like(f)
    assert leg["leg_bias"](drives, qd, dimensions) == pytest.approx(leg["leg_inverse_dynamics"](drives, qd, still, unloaded, dimensions))
    by_q, by_qd = leg["leg_inverse_dynamics_derivatives"](drives, qd, qdd, dimensions)
    for joint, step in enumerate(1e-6 * np.eye(drives.shape[1])):
        ahead, behind = (leg["leg_inverse_dynamics"](drives + sign * step, qd, qdd, unloaded, dimensions) for sign in (1, -1))
        assert np.abs((ahead - behind) / 2e-6 - by_q[..., joint]).max() < 1e-6 * max(scale, np.abs(by_q).max())
        ahead, behind = (leg["leg_inverse_dynamics"](drives, qd + sign * step, qdd, unloaded, dimensions) for sign in (1, -1))
        assert np.abs((ahead - behind) / 2e-6 - by_qd[..., joint]).max() < 1e-6 * max(scale, np.abs(by_qd).max())


@pytest.mark.parametrize("name", MARKED)
def test_at_rest_there_is_no_friction(made, name):
    rubbing, smooth, (dimensions, drives) = made(name)
    _, qdd, f = states(drives.shape)
    found, wanted = (code["leg_joint_reactions"](drives, 0 * drives, qdd, f, dimensions) for code in (rubbing, smooth))
    assert np.abs(found[:, : wanted.shape[1]] - wanted).max() < 1e-13 * np.abs(wanted).max()


@pytest.mark.parametrize("name", [pytest.param("slider_crank", marks=pytest.mark.nightly), "four_bar"])
def test_energy_that_a_motion_loses_is_heat(made, name):
    """Integrated from a push, without efforts and until it nearly stops."""
    rubbing, smooth, (dimensions, drives) = made(name)
    one, still = dimensions[:1], np.zeros((1, 3))

    def slope(_, y):
        q, qd = y[None, :1], y[None, 1:2]
        return [y[1], rubbing["leg_forward_dynamics"](q, qd, 0 * q, still, one)[0, 0], heat_of(name, rubbing, smooth, one, q, qd, still)[0]]

    def stops(_, y):
        return y[1] - 0.05

    stops.terminal = True
    path = solve_ivp(slope, (0, 0.3), [drives[0, 0], 2.0, 0.0], method="DOP853", rtol=1e-9, atol=1e-11, events=stops)
    q, qd, heat = path.y[0, :, None], path.y[1, :, None], path.y[2]
    dimension = np.broadcast_to(one, (len(q), one.shape[1]))
    energy = rubbing["leg_kinetic_energy"](q, qd, dimension) + rubbing["leg_potential_energy"](q, dimension)
    assert np.all(np.diff(heat) > 0)
    assert energy + heat == pytest.approx(np.full(len(q), energy[0]), abs=1e-6 * heat[-1])
    assert heat[-1] > 0.05 * np.ptp(rubbing["leg_kinetic_energy"](q, qd, dimension))

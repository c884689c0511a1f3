"""Springs between links of planar linkages, beside a dense system of all links' equations with the springs' pulls as loads."""

import re

import numpy as np
import pytest
from sprung import Sprung

from linkages.closure import assembled
from linkages.newton_euler import Bodies, Motion
from linkages.placed import code_of
from linkages.rubbed import Rubbed
from linkages.topologies import TOPOLOGIES, spec
from symbolic.dynamic_legs import EXACT, SPECS, exact, leg_programs, rate_along, value, written

GRAVITY, SETS = (0.7, -9.8), 3
SMOOTH = ("assembly_status", "transmission_angles")
LOADED = (
    "joint_reactions",
    "driving_forces",
    "power",
    "inverse_dynamics",
    "potential_energy",
    "gravity_torque",
    "spring_moment",
    "spring_length",
)
BETWEEN = {
    "four_bar": (("frame.D", "coupler.P"), ("crank.B", "rocker.C"), ("rocker.C", "frame.A")),
    "slider_crank": (("rod.P", "block.S"), ("frame.A", "block.C"), ("rod.P", "frame.A")),
    "hydraulic": (("frame.I", "shank.P"), ("thigh.G", "shank.L")),
}
MARKED = [pytest.param(name, marks=pytest.mark.nightly if name == "hydraulic" else ()) for name in BETWEEN]
FRICTION = {"four_bar": {"b": "coulomb = 1, mu = 0.2, radius = 0.03", "c": "mu = 0.1, radius = 0.04"}}


def with_springs(name, between, friction=None):
    tables = [
        f'[[leg_designs.one.springs]]\nname = "s{number}"\nbetween = ["{first}", "{second}"]\nstiffness = {900 + 300 * number}\n'
        f"free_length = 0.1{number}\ninitial_tension = {20 * number}\n"
        for number, (first, second) in enumerate(between)
    ]
    functions = (*SMOOTH, *LOADED)
    return spec(name, functions, friction or {}) + "\n" + "".join(tables)


def sets(code, name):
    """Dimensions and drives away from dead points, with the poses of the links."""
    topology, random = TOPOLOGIES[name], np.random.default_rng(41)
    dimensions, drives = topology.draw(random, 80)
    sines = np.sin(code["leg_transmission_angles"](drives, dimensions))
    closes = np.flatnonzero((code["leg_assembly_status"](drives, dimensions) == 0) & (np.abs(sines) > 0.2).all(-1))[:SETS]
    assert len(closes) == SETS
    poses = assembled(spec(name, SMOOTH), topology.sides, dimensions[closes], drives[closes], random, np.full(SETS, 6))
    return zip(dimensions[closes], drives[closes], poses, strict=True)


def pulls(motion):
    """What the springs of a motion's spec do to every link: force and moment about the origin [links, 3]."""
    found = np.zeros((len(motion.closure.links), 3))
    for table in motion.closure.design["springs"]:
        ends = [motion.closure.coordinates(text) for text in table["between"]]
        points = [motion.point(link, own)[0] for link, own in ends]
        way = points[1] - points[0]
        length = np.hypot(*way)
        force = (table["initial_tension"] + table["stiffness"] * (length - table["free_length"])) * way / length
        for sign, (link, _), at in zip((1, -1), ends, points, strict=True):
            x, y = sign * force
            found[link] += [x, y, at[0] * y - at[1] * x]
    return found


@pytest.mark.parametrize("name", MARKED)
def test_drives_and_pairs_beside_free_bodies(name, tmp_path):
    friction = FRICTION.get(name, {})
    text = with_springs(name, BETWEEN[name], friction)
    code, random = code_of(text, (*SMOOTH, *LOADED), tmp_path), np.random.default_rng(42)
    for dimensions, q, x in sets(code, name):
        qd, qdd, f = random.normal(size=q.shape) / 5, random.normal(size=q.shape), random.normal(size=3) * (100, 100, 0)
        motion = Motion(text, dimensions, q, x, qd, qdd)
        loads, steady = pulls(motion), Motion(text, dimensions, q, x, qd)
        rubbed = Rubbed(motion, steady, GRAVITY, f[:2], pulls(steady))
        bodies = Bodies(motion, GRAVITY, f[:2], loads + rubbed.loads)
        scale = np.abs(bodies.unknowns).max()
        wanted = rubbed.given.copy()
        wanted[: len(bodies.ends)] += bodies.reactions
        assert np.abs(code["leg_joint_reactions"](q, qd, qdd, f, dimensions) - wanted).max() < 1e-6 * scale
        assert np.abs(code["leg_driving_forces"](q, qd, qdd, f, dimensions) - bodies.unknowns[bodies.drives]).max() < 1e-6 * scale


@pytest.mark.parametrize("name", MARKED)
def test_drives_hold_the_slope_of_the_potential(name, tmp_path):
    text = with_springs(name, BETWEEN[name])
    code = code_of(text, (*SMOOTH, *LOADED), tmp_path)
    chosen = list(sets(code, name))
    for dimensions, q, _ in chosen:
        for drive, unit in enumerate(np.eye(len(q))):
            step = 1e-5
            slope = np.subtract(*(code["leg_potential_energy"](q + sign * step * unit, dimensions) for sign in (1, -1))) / (2 * step)
            held = code["leg_gravity_torque"](q, dimensions)
            assert held[drive] == pytest.approx(slope, abs=1e-6 * np.abs(held).max())


def test_a_link_without_mass_may_be_pulled_at(tmp_path):
    """As one whose mass is 0."""
    text = with_springs("four_bar", BETWEEN["four_bar"])
    table = r"(\[leg_designs\.one\.links\.rocker\]\npoints = .*\n)mass = .*\ncom = .*\ninertia = .*\n"
    light, zero = re.sub(table, r"\1", text), re.sub(table, r"\1mass = 0\ncom = [0, 0]\ninertia = 0\n", text)
    assert len({text, light, zero}) == 3
    (tmp_path / "zero").mkdir()
    one, other = code_of(light, (*SMOOTH, *LOADED), tmp_path), code_of(zero, (*SMOOTH, *LOADED), tmp_path / "zero")
    for dimensions, q, _ in sets(one, "four_bar"):
        state = (q, q, q, np.array([30.0, 200.0, 0.0]), dimensions)
        assert one["leg_joint_reactions"](*state) == pytest.approx(other["leg_joint_reactions"](*state), rel=1e-12, abs=1e-9)
        assert np.isfinite(one["leg_inverse_dynamics"](*state)).all()


MIXED = """
[[leg_designs.hydraulic.springs]]
name = "from_mount"
between = [{ link = "mount", xyz = [0.05, 0.1, 0.2] }, "shank.H"]
stiffness = 2000.0
free_length = 0.1
initial_tension = 15.0
masses = { at_first = 0.4, at_second = 0.3 }
[[leg_designs.hydraulic.springs]]
name = "from_yaw"
between = ["thigh.G", { link = "yaw", xyz = [-0.1, 0.02, 0.3] }]
stiffness = 1500.0
free_length = 0.12
masses = { at_first = 0.2, at_second = 0.1 }
[[leg_designs.hydraulic.springs]]
name = "to_frame"
between = [{ link = "mount", xyz = [0.3, 0.2, 0.1] }, "frame.E"]
stiffness = 700.0
free_length = 0.05
[[leg_designs.hydraulic.springs]]
name = "in_plane"
between = ["frame.E", "shank.P"]
stiffness = 300.0
free_length = 0.2
"""
Q = np.array([0.4, 0.35, 0.37])


def test_between_mount_joints_and_links(tmp_path):
    """Lengths beside the spec's own tables, efforts beside slopes of the potential, whose links are those of the generated code."""
    text = (SPECS / "hydraulic_leg.toml").read_text(encoding="utf-8") + MIXED
    names = ("spring_length", "spring_energy", "spring_moment", "potential_energy", "gravity_torque")
    programs, oracle = leg_programs(written(tmp_path, text), names=names), Sprung(text)
    poses = code_of(text, ("foot_position",), tmp_path)["front_left_poses"](Q)
    links = [(x, y, np.arctan2(sine, cosine)) for x, y, cosine, sine in poses[1:]]
    assert value(programs["spring_length"], Q) == pytest.approx(oracle.lengths(Q, links).real, rel=1e-12)
    assert value(programs["spring_energy"], Q) == pytest.approx(oracle.energies(Q, links).real, rel=1e-12)
    q = exact(Q)
    held = value(programs["gravity_torque"], q, context=EXACT)
    moments = value(programs["spring_moment"], q, context=EXACT)
    for joint, unit in enumerate(np.eye(3)):
        slope = rate_along(lambda at: value(programs["potential_energy"], at, context=EXACT), q, exact(unit))
        stored = rate_along(lambda at: value(programs["spring_energy"], at, context=EXACT), q, exact(unit))
        assert abs(held[joint] - slope) < 1e-25 * max(abs(held))
        assert max(abs(moments[:, joint] + stored)) < 1e-25 * max(abs(held))


AFTER = """
[[leg_designs.hydraulic.joints_after]]
name = "ankle"
type = "revolute"
a = 0.06
alpha_deg = 50
d = 0.01
link = { mass = 0.7, com = [0.02, 0.01, -0.03], inertia = [0.002, 0.003, 0.0025, 0.0001, 0.0002, -0.0001] }
[[leg_designs.hydraulic.joints_after]]
name = "toe"
type = "prismatic"
a = 0.02
alpha_deg = -30
d = 0.1
link = { mass = 0.4, com = [0.0, 0.01, -0.02], inertia = [0.001, 0.002, 0.0015, 0, 0, 0] }
"""
HANGING = [
    ('{ link = "mount", xyz = [0.05, 0.1, 0.2] }', '{ link = "toe", xyz = [0.01, 0.02, -0.05] }'),
    ('{ link = "ankle", xyz = [0.0, 0.05, 0.03] }', '{ link = "yaw", xyz = [-0.1, 0.02, 0.3] }'),
    ('"thigh.G"', '{ link = "ankle", xyz = [0.02, 0.01, 0.04] }'),
    ('"shank.L"', '{ link = "toe", xyz = [0.0, 0.03, 0.0] }'),
    ('{ link = "toe", xyz = [0.03, 0.0, 0.01] }', '"frame.E"'),
    ('{ link = "toe", xyz = [0.03, 0.0, 0.01] }', '{ link = "ankle", xyz = [-0.2, 0.1, 0.1] }'),
]
"""Before and after the linkage, its links and its frame; both after it."""


def hanging():
    text = (SPECS / "hydraulic_leg.toml").read_text(encoding="utf-8")
    coils = [
        f'[[leg_designs.hydraulic.springs]]\nname = "s{number}"\nbetween = [{first}, {second}]\nstiffness = {900 + 100 * number}\n'
        f"free_length = 0.01\ninitial_tension = {10 * number}\nmasses = {{ at_first = 0.{number}, at_second = 0.2 }}\n"
        for number, (first, second) in enumerate(HANGING)
    ]
    end = 'foot = { xyz = [0.01, 0.02, -0.15] }\nlinkage_end = { point = "shank.P", xyz = [0.01, -0.02, 0.03], rpy_deg = [20, 70, 0] }'
    assert 'foot = "shank.P"' in text
    return text.replace('foot = "shank.P"', end) + AFTER + "".join(coils)


def test_beyond_the_linkage(tmp_path):
    """Lengths beside the spec's own tables, efforts beside slopes of the potential."""
    text, q = hanging(), np.array([*Q, 0.3, 0.05])
    names = ("spring_length", "spring_energy", "spring_moment", "potential_energy", "gravity_torque")
    programs, oracle = leg_programs(written(tmp_path, text), names=names), Sprung(text)
    poses = code_of(text, ("foot_position",), tmp_path)["front_left_poses"](q)
    links = [(x, y, np.arctan2(sine, cosine)) for x, y, cosine, sine in poses[1:]]
    assert value(programs["spring_length"], q) == pytest.approx(oracle.lengths(q, links).real, rel=1e-12)
    assert value(programs["spring_energy"], q) == pytest.approx(oracle.energies(q, links).real, rel=1e-12)
    at = exact(q)
    held, moments = (value(programs[name], at, context=EXACT) for name in ("gravity_torque", "spring_moment"))
    for joint, unit in enumerate(np.eye(5)):
        slopes = [
            rate_along(lambda p, name=name: value(programs[name], p, context=EXACT), at, exact(unit))
            for name in ("potential_energy", "spring_energy")
        ]
        assert abs(held[joint] - slopes[0]) < 1e-25 * max(abs(held))
        assert max(abs(moments[:, joint] + slopes[1])) < 1e-25 * max(abs(held))
    light = re.sub(r"\nmasses = \{ at_first = 0\.\d, at_second = 0\.2 \}", "", text)
    weightless = leg_programs(written(tmp_path, light), names=("potential_energy",))["potential_energy"]
    ends, masses = oracle.ends(q, links).real, oracle.masses()
    moving = np.array([[end != HANGING[0][0] for end in pair] for pair in HANGING])
    lift = -((masses * moving)[..., None] * ends * oracle.gravity).sum()
    assert value(programs["potential_energy"], q) - value(weightless, q) == pytest.approx(lift, rel=1e-10)


def test_what_the_frame_holds_of_springs_beyond(tmp_path):
    """Without gravity, at rest: its pairs give the linkage's frame what springs from there inwards pull the linkage with."""
    text, q, still = re.sub(r"gravity = .*", "gravity = [0, 0, 0]", hanging()), np.array([*Q, 0.3, 0.05]), np.zeros(5)
    code, oracle = code_of(text, ("joint_reactions", "foot_position"), tmp_path), Sprung(text)
    links = [(x, y, np.arctan2(sine, cosine)) for x, y, cosine, sine in code["front_left_poses"](q)[1:]]
    rows = re.search(r"Rows: (.*?)\.\s", " ".join(code["front_left_joint_reactions"].__doc__.split()))[1].split(", ")
    given = code["front_left_joint_reactions"](q, still, still, np.zeros(3))
    ends, tensions = oracle.ends(q, links).real, oracle.tensions(q, links).real
    pulls = tensions[:, None] * (ends[:, 0] - ends[:, 1]) / oracle.lengths(q, links).real[:, None]  # on the second end
    total = pulls[0] - pulls[1] - pulls[4]
    axes = (oracle.frames(q)[-1] @ oracle.plane).real[:3, :2]
    on_frame = [place for place, row in enumerate(rows) if row.endswith(" on frame")]
    assert len(on_frame) > 1
    assert given[on_frame, :2].sum(0) == pytest.approx(axes.T @ total, rel=1e-10)

"""How far linkages yield with their drives held: legs in series, an own finite-element model, out of the plane, of whole robots."""

import re

import numpy as np
import pytest

from linkages.placed import code_of
from linkages.topologies import TOPOLOGIES, TRIADS, spec
from oracles.planar_frame import PlanarFrame
from walkgen.errors import SpecError, UnsupportedMechanism
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.pipeline import mechanism_of
from walkgen.symbolic.chain_reactions import chain_reactions
from walkgen.symbolic.compliance import StanceCompliance, foot_compliance, sole_compliance

TUBE = "{ E = 70e9, G = 26e9, A = 3e-4, Iy = 2e-8, Iz = 3e-8, J = 4e-8 }"
ROD = "{ E = 210e9, G = 80e9, A = 1e-4, Iy = 1e-9, Iz = 2e-9, J = 3e-9 }"
TOP = f"""
walkgen = 1
robot = {{ name = "bot", gravity = [0, 0, -9.81] }}
sections = {{ tube = {TUBE}, rod = {ROD} }}
"""
LEGS = """
platforms = [{ name = "body" }]
legs = [
    { name = "leg", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } },
    { name = "other", mirror_of = "leg" },
]
"""
DESIGN = """
[leg_designs.leg]
dh = "classic"
"""
HEAD = TOP + LEGS + DESIGN
SERIES = """
joints = [
    { name = "yaw", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 90, link = { section = "tube" } },
    { name = "hip", type = "revolute", a = 0.3, d = 0.0, alpha_deg = 0, link = { section = "rod" } },
    { name = "knee", type = "revolute", a = 0.4, d = 0.0, alpha_deg = 0, link = { section = "tube" } },
]
"""
OPEN = """
joints = [{ name = "yaw", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 0, link = { section = "tube" } }]
plane = { rpy_deg = [90, 0, 0] }
foot = "shank.P"
links = { frame = { points = { A = [0, 0] } }, thigh = { points = { A = [0, 0], B = [0.3, 0] }, section = "rod" }, \
shank = { points = { B = [0, 0], P = [0.4, 0] }, section = "tube" } }
pins = [{ name = "hip", joins = ["frame.A", "thigh.A"], driven = true }, { name = "knee", joins = ["thigh.B", "shank.B"], driven = true }]
"""
SOLE = "sole = { length = 0.12, width = 0.06, rpy_deg = [0, 90, 0] }\n"
Q = [0.3, -0.7, 0.9, 0.1, 0.4, -1.1]


def matrix(function, q):
    (values,) = interpret(lower(function), {"q": list(q)}).values()
    return np.reshape(values, function.signature.outputs[0].shape)


def mechanism_from(folder, text, name="spec"):
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return mechanism_of(path)


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """A leg in series, and the same as a linkage without loops; on a mirrored one the foot's axes differ, so both stand on points."""
    folder = tmp_path_factory.mktemp("pair")
    return [mechanism_from(folder, HEAD + text, name) for name, text in (("series", SERIES), ("open", OPEN))]


def test_a_linkage_without_loops_yields_as_a_leg_in_series(pair):
    for number in range(2):
        series, own = (matrix(foot_compliance(mechanism, mechanism.legs[number]), Q[:3]) for mechanism in pair)
        assert np.abs(series - own).max() < 1e-13 * np.abs(series).max()


def test_a_sole(tmp_path):
    series, own = (mechanism_from(tmp_path, HEAD + SOLE + text, f"sole_{place}") for place, text in enumerate((SERIES, OPEN)))
    wanted, found = (matrix(sole_compliance(mechanism, mechanism.legs[0]), Q[:3]) for mechanism in (series, own))
    assert np.abs(wanted - found).max() < 1e-13 * np.abs(wanted).max()


def test_a_stance(pair):
    series, own = (matrix(StanceCompliance(mechanism).functions()["stance_compliance"](), Q) for mechanism in pair)
    assert np.abs(series - own).max() < 1e-13 * np.abs(series).max()
    assert np.linalg.eigvalsh(own)[0] > 0.0


CHAINED = """
platforms = [{ name = "body" }, { name = "rear", parent = "body", chain = "spine" }]
legs = [
    { name = "leg", design = "leg", platform = "body", mount = { rpy_deg = [10, 20, 30] } },
    { name = "back", design = "leg", platform = "rear", mount = { xyz = [-0.1, 0.1, 0] } },
]
[chain_designs.spine]
dh = "classic"
joints = [
    { name = "bend", type = "revolute", a = 0.3, d = 0.02, alpha_deg = 90, link = { section = "tube" } },
    { name = "reach", type = "prismatic", a = 0.05, d = 0.1, alpha_deg = 20 },
]
"""


def test_behind_a_chain(tmp_path):
    """Compliance, what loads do and what the chain carries, of a robot one of whose legs stands on another platform."""
    texts = enumerate((SERIES, OPEN))
    robots = [mechanism_from(tmp_path, TOP + CHAINED + DESIGN + text, f"chained_{place}") for place, text in texts]
    random = np.random.default_rng(3)
    inputs = {"q": [0.4, 0.05, *Q], "loads": random.normal(size=12), "foot_forces": random.normal(size=6)}
    functions = [StanceCompliance(robot).functions() | chain_reactions(robot) for robot in robots]
    for name in ("stance_compliance", "load_misfit", "chain_reactions"):
        wanted, found = (lower(each[name]()) for each in functions)
        wanted, found = (
            np.array(next(iter(interpret(one, {port.name: list(inputs[port.name]) for port in one.signature.inputs}).values())))
            for one in (wanted, found)
        )
        assert np.abs(wanted).max() > 0.0
        assert np.abs(wanted - found).max() < 1e-12 * np.abs(wanted).max()


def yielding(name, values, drives, rigid):
    """A topology's spec whose links and cylinders have sections, but for some."""
    text = spec(name, ["foot_compliance"], values=values, start=drives if name in TRIADS else None)
    text = text.replace("[parameters]", f"[sections]\ntube = {TUBE}\nrod = {ROD}\n[parameters]")
    names = [link for link in re.findall(r"^\[leg_designs.one.links.(\w+)\]$", text, re.MULTILINE) if link not in ("frame", *rigid)]
    for place, link in enumerate(names):
        header = f"[leg_designs.one.links.{link}]\n"
        text = text.replace(header, f'{header}section = "{("tube", "rod")[place % 2]}"\n')
    return text.replace("masses = {", 'section = "rod"\nmasses = {')


SAMPLED = ("hydraulic",)
REST = sorted({*TOPOLOGIES, *TRIADS} - {*SAMPLED, "pantograph"})


@pytest.mark.parametrize("name", [*SAMPLED, *(pytest.param(name, marks=pytest.mark.nightly) for name in REST)])
def test_loops_yield_as_a_finite_element_model(tmp_path, name):
    """In the plane, by beams between nodes that constraints join, at the poses of the links."""
    topology, found = (TOPOLOGIES | TRIADS)[name], 0
    for seed in range(60):
        random = np.random.default_rng(seed)
        values, drives = (entry[0] for entry in topology.draw(random, 1))
        text = yielding(name, values, drives, rigid=(("coupler",) if seed % 2 else ()))
        try:
            code = code_of(text, ["foot_compliance"], tmp_path)
        except UnsupportedMechanism:
            continue  # a triad that has no assembly
        poses, C = code["leg_poses"](drives, values), code["leg_foot_compliance"](drives, values)
        if not np.isfinite(poses).all():
            continue
        wanted = PlanarFrame(text, poses).compliance()[:2, :2]
        assert np.abs(C[:2, :2] - wanted).max() < 1e-8 * np.abs(wanted).max()
        assert np.abs(C - C.T).max() < 1e-12 * np.abs(C).max()
        assert np.linalg.eigvalsh(C)[0] > -1e-12 * np.abs(C).max()
        found += 1
        if found == 2:
            break
    assert found


def refused(folder, text):
    with pytest.raises(SpecError) as caught:
        mechanism_from(folder, text)
    return str(caught.value)


def test_sections_where_nothing_yields(tmp_path):
    message = refused(tmp_path, (HEAD + OPEN).replace("points = { A = [0, 0] } }", 'points = { A = [0, 0] }, section = "tube" }'))
    assert "WG193" in message
    assert "links.frame.section" in message
    damper = '[[leg_designs.leg.cylinders]]\nname = "damper"\nbetween = ["frame.A", "shank.B"]\nsection = "rod"\n'
    message = refused(tmp_path, HEAD + OPEN + damper)
    assert "WG193" in message
    assert "not driven" in message
    assert 'did you mean "rod"' in refused(tmp_path, (HEAD + OPEN).replace('section = "rod"', 'section = "rods"'))


def test_without_sections_there_is_none(tmp_path):
    bare = mechanism_from(tmp_path, HEAD + OPEN.replace(', section = "rod"', "").replace(', section = "tube" } }', " } }"))
    assert foot_compliance(bare, bare.legs[0]) is None
    assert "stance_compliance" not in StanceCompliance(bare).functions()

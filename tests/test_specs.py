"""The shipped specs: they read, say what they are, and stand for the robots they name."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from cases.to_spec import case, from_tree
from oracles import theory
from oracles.measure import difference
from oracles.walker import Walker
from oracles.walker import read as walk
from walkgen.model.assemble import assemble
from walkgen.model.mechanism import Mechanism
from walkgen.model.walk import CONTEXT, limb_frames, number, platform_poses
from walkgen.spec.read import read
from walkgen.spec.schema import schema_json

FOLDER = Path(__file__).parents[1] / "specs"
NAMES = (
    "ambler_rpp",
    "ambler_rrp",
    "anthropomorphic_biped",
    "anthropomorphic_leg",
    "anthropomorphic_leg_poly",
    "balanced_leg_cam1",
    "balanced_leg_cam2",
    "balanced_leg_total",
    "balanced_leg_two_springs",
    "bessonov",
    "garrec",
    "hydraulic_leg",
    "mero",
    "mero_leg",
    "mero_leg_param",
    "mero_star",
    "mero_style",
    "minitaur",
    "odex",
    "pantograph",
    "phantomx_leg",
    "quadruped",
    "solo12",
    "terrain_demo",
)
LINKAGES = {
    "balanced_leg_total",
    "bessonov",
    "garrec",
    "hydraulic_leg",
    "minitaur",
    "odex",
    "pantograph",
}  # closed: tests/linkages places them
SERIAL = [name for name in NAMES if name not in LINKAGES]
MERO_FEET = ["front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right"]


def text(name: str) -> str:
    return (FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def mechanism(name: str) -> Mechanism:
    return assemble(read(FOLDER / f"{name}.toml"))


def floats(matrix) -> np.ndarray:
    return np.array(matrix.tolist(), dtype=float)


def test_every_file_is_tested():
    assert sorted(path.stem for path in FOLDER.glob("*.toml")) == sorted(NAMES)


def test_schema_beside_the_specs_is_the_languages():
    committed = (FOLDER / "walkgen-spec-1.json").read_text(encoding="utf-8")
    assert committed.rstrip() == schema_json().rstrip(), "stale; run: walkgen check --schema > specs/walkgen-spec-1.json"


@pytest.mark.parametrize("name", NAMES)
def test_file_is_fit_to_be_read(name):
    source = text(name)
    assert source.startswith("#:schema ./walkgen-spec-1.json\n# ")
    assert max(map(len, source.splitlines())) <= 140
    table = tomllib.loads(source)
    assert table["walkgen"] == 1
    assert table["robot"]["name"] == name
    assert table["robot"]["description"]


@pytest.mark.parametrize("name", SERIAL)
def test_mechanism_is_the_walkers(name):
    """The 50-digit walk over the assembled Mechanism against the walker that reads the text itself."""
    robot, walker = mechanism(name), walk(text(name))
    assert [leg.name for leg in robot.legs] == [leg.name for leg in walker.legs]
    q = np.random.default_rng(5).uniform(-2, 2, walker.joint_count)
    assert difference([floats(pose) for pose in platform_poses(robot, list(q))], walker.platform_poses(q)) <= 1e-14
    for limb, other in zip(robot.limbs, (*walker.chains.values(), *walker.legs), strict=True):
        assert limb.name == other.name
        own = q[walker.slice(limb.name)]
        frames = [floats(frame) for frame in limb_frames(robot, limb, list(own))]
        assert difference(frames, [*other.frames(own), other.pose(own)]) <= 1e-14


def test_mero_stands_as_the_theory_says():
    robot = walk(text("mero"))
    assert [leg.name for leg in robot.legs] == MERO_FEET
    assert robot.platforms == ("front", "middle", "rear")
    straight = robot.platform_poses(np.zeros(24))
    assert difference(straight[:, :3, 3], [(0, 0, 0), (-0.95, 0, 0), (-1.9, 0, 0)]) <= 1e-15
    assert difference(straight[:, :3, :3], [np.eye(3)] * 3) <= 1e-15
    q = np.zeros(24)
    for name, values in (("middle", theory.O8_C), ("middle_left", theory.O8_Q3), ("middle_right", theory.O8_Q4)):
        q[robot.slice(name)] = values
    assert difference(robot.foot_positions(q)[2:4], [theory.O8_FOOT3, theory.O8_FOOT4]) <= 1e-14


def test_mero_star_hangs_on_its_centre():
    robot = walk(text("mero_star"))
    assert {name: chain.platform for name, chain in robot.chains.items()} == {"rear": "centre", "side": "centre"}
    poses = robot.platform_poses(np.zeros(24))
    assert difference(poses[1:, :3, 3], [(-0.95, 0, 0), (0, 1.1, 0.1)]) <= 1e-15
    assert difference(poses[2, :3, 0], (0, -1, 0)) <= 1e-15
    q = np.tile([0.2, 0.4, -1.1], 8)
    left, right = (robot.leg(name).position(q[:3]) for name in ("side_left", "side_right"))
    assert difference(right, left * (1, -1, 1)) <= 1e-15


def test_small_legs_are_the_theorys():
    leg = walk(text("mero_leg")).legs[0]
    assert difference(leg.position(theory.Q), theory.O2_P) <= 1e-14
    assert difference(leg.hessian(theory.Q), theory.O2_H) <= 1e-14
    q, p, det = theory.O5_RRP
    rrp = walk(text("ambler_rrp")).legs[0]
    assert difference(rrp.position(np.array(q)), p) <= 1e-14
    assert difference(np.linalg.det(rrp.jacobian(np.array(q))), det) <= 1e-14
    q, p = theory.O5_RPP
    assert difference(walk(text("ambler_rpp")).legs[0].position(np.array(q)), p) <= 1e-14


def test_the_leg_with_parameters_is_the_plain_leg_without_its_heel():
    plain, leg = walk(text("mero_leg")).legs[0], walk(text("mero_leg_param"), heel=0.0).legs[0]
    assert difference(leg.position(theory.Q), plain.position(theory.Q)) <= 1e-15
    longer = walk(text("mero_leg_param"), shank=0.45, heel=0.0).legs[0]
    assert abs(np.linalg.norm(longer.position(theory.Q) - leg.position(theory.Q)) - 0.05) <= 1e-15
    assert [parameter.name for parameter in mechanism("mero_leg_param").parameters] == ["shank", "heel"]


@pytest.mark.parametrize(
    ("name", "source"), [("mero_style", "mero_style_three_modules"), ("solo12", "solo12_robot"), ("phantomx_leg", "phantomx_rf_leg")]
)
def test_published_robots_keep_their_numbers(name, source, tmp_path):
    """Feet, link by link masses, centres of mass, inertias and limits are those of the case, whatever design they were put in."""
    conversion = from_tree(case(source))
    path = tmp_path / "case.toml"
    path.write_text(conversion.text, encoding="utf-8")
    ours, theirs = mechanism(name), assemble(read(path))
    assert_same_feet(walk(text(name)), walk(conversion.text))
    for limb, other in zip(ours.limbs, theirs.limbs, strict=True):
        for joint, its in zip(limb.joints, other.joints, strict=True):
            assert joint.source_name == its.source_name
            assert_same_body(ours, joint.body, its.body)
            assert joint.limits == its.limits
    for platform, its in zip(ours.platforms, theirs.platforms, strict=True):
        assert_same_body(ours, platform.body, its.body)


def assert_same_feet(ours: Walker, theirs: Walker) -> None:
    assert ours.joint_count == theirs.joint_count
    for q in np.random.default_rng(6).uniform(-3, 3, (5, ours.joint_count)):
        for leg, other in zip(ours.legs, theirs.legs, strict=True):
            assert difference(ours.foot_pose(leg, q), theirs.foot_pose(other, q)) <= 1e-14


def assert_same_body(robot, ours, theirs) -> None:
    assert (ours is None) == (theirs is None)
    if ours:
        pairs = zip((ours.mass, *ours.com, *ours.inertia), (theirs.mass, *theirs.com, *theirs.inertia), strict=True)
        assert max(abs(number(one, robot) - number(other, robot)) for one, other in pairs) <= CONTEXT.mpf("3e-16")


def test_gaits_are_those_that_the_specs_name():
    gaits = {name: {gait.name: gait for gait in mechanism(name).gaits} for name in ("mero", "quadruped", "garrec", "solo12")}
    assert {name: list(found) for name, found in gaits.items()} == {
        "mero": ["tripod", "wave", "slow_wave"],
        "quadruped": ["waved", "swinging", "set_right"],
        "garrec": [""],
        "solo12": [],
    }
    assert gaits["mero"]["tripod"].phase == (0, 1 / 2, 1 / 2, 0, 0, 1 / 2)  # 3 x 3, in the order of MERO_FEET
    assert [gait.body for gait in gaits["quadruped"].values()] == ["waved", "swinging", "waved"]


def test_the_quadrupeds_centre_of_mass_is_the_theorys():
    """O17: G = (0.03, 0, 0.4) over feet at (+-0.35, +-0.3), but for what the bent legs move."""
    robot = mechanism("quadruped")
    masses = [number(platform.body.mass, robot) for platform in robot.platforms]
    masses += [number(joint.body.mass, robot) for leg in robot.legs for joint in leg.joints]
    assert sum(masses) == 60
    assert masses[0] * number(robot.platforms[0].body.com[0], robot) / 60 == pytest.approx(0.03, abs=1e-15)

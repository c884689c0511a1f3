"""Import of branching URDFs: which links become platforms, where legs start, and every foot and body as Pinocchio has them."""

import re
import tomllib

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mechanisms.urdf_text import branching, inertial, joint, link
from oracles.measure import difference
from walkgen.emit.urdf import urdf
from walkgen.errors import SpecError
from walkgen.model.assemble import assemble
from walkgen.model.walk import limb_frames, platform_poses
from walkgen.spec.read import read
from walkgen.spec.urdf import convert


def imported(folder, parts, *feet):
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="r">{"".join(parts)}</robot>', encoding="utf-8")
    return convert(path, feet)


@pytest.fixture
def spec(tmp_path):
    """The imported robot's tables; it must also pass `check`."""

    def run(parts, *feet):
        result = imported(tmp_path, parts, *feet)
        (tmp_path / "robot.toml").write_text(result.toml, encoding="utf-8")
        read(tmp_path / "robot.toml")
        return tomllib.loads(result.toml), [warning.code for warning in result.warnings]

    return run


def refusal(folder, parts, *feet):
    with pytest.raises(SpecError) as caught:
        imported(folder, parts, *feet)
    return [(problem.code, problem.message) for problem in caught.value.problems]


# ---- against Pinocchio -------------------------------------------------------------------------------------------------------


def matrix(mp):
    return np.array(mp.tolist(), dtype=float)


def compare_bodies(reference, body):
    assert difference(body.get("mass", 0.0), reference.mass) <= 1e-14
    if reference.mass:
        xx, yy, zz, xy, xz, yz = body["inertia"]
        assert difference(body["com"], reference.lever) <= 1e-13
        assert difference([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], reference.inertia) <= 1e-13


@settings(max_examples=60, deadline=None, derandomize=True)
@given(tree=branching(), data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_feet_and_bodies_of_any_tree_are_those_of_pinocchio(tree, data, seed, tmp_path_factory):
    parts, ends = tree
    feet = data.draw(st.lists(st.sampled_from(ends), min_size=1, unique=True))
    folder = tmp_path_factory.mktemp("urdf")
    try:
        text = imported(folder, parts, *feet).toml
    except SpecError as error:
        assume({problem.code for problem in error.problems} - {"WG512", "WG513", "WG516"})
        raise
    (folder / "robot.toml").write_text(text, encoding="utf-8")
    mechanism, tables = assemble(read(folder / "robot.toml")), tomllib.loads(text)
    model = pin.buildModelFromXML((folder / "robot.urdf").read_text(encoding="utf-8"), pin.JointModelFreeFlyer())
    pin_data, neutral = model.createData(), pin.neutral(model)
    names = [row.source_name for limb in mechanism.limbs for row in limb.joints]
    assert sorted(names) == sorted(model.names[2:])
    q = np.random.default_rng(seed).uniform(-3, 3, len(names))
    for name, value in zip(names, q, strict=True):
        neutral[model.joints[model.getJointId(name)].idx_q] = value
    pin.framesForwardKinematics(model, pin_data, neutral)
    check_frames(mechanism, q, feet, model, pin_data)
    check_bodies(mechanism, tables, model)


def check_frames(mechanism, q, feet, model, data):
    poses = platform_poses(mechanism, list(q))
    for leg, foot in zip(mechanism.legs, feet, strict=True):
        assert leg.name == foot
        own = list(q[mechanism.offset(leg) : mechanism.offset(leg) + len(leg.joints)])
        pose = limb_frames(mechanism, leg, own, base=poses[leg.platform])[-1]
        assert difference(matrix(pose), data.oMf[model.getFrameId(foot)].homogeneous) <= 1e-13
    for platform, pose in zip(mechanism.platforms, poses, strict=True):
        assert difference(matrix(pose), data.oMf[model.getFrameId(platform.name)].homogeneous) <= 1e-13


def check_bodies(mechanism, tables, model):
    for platform in tables["platforms"]:
        frame = model.frames[model.getFrameId(platform["name"])]
        compare_bodies(frame.placement.inverse().act(model.inertias[frame.parentJoint]), platform)
    for limb in mechanism.limbs:
        rows = tables["leg_designs" if limb.child is None else "chain_designs"][limb.name]["joints"]
        for row, joint_ in list(zip(rows, limb.joints, strict=True))[: None if limb.child is None else -1]:
            compare_bodies(model.inertias[model.getJointId(joint_.source_name)], row.get("link", {}))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(tree=branching(), data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_there_and_back_the_robot_weighs_and_moves_the_same(tree, data, seed, tmp_path_factory):
    """URDF -> spec -> URDF: feet, and mass and inertia seen from the base, of both texts by Pinocchio."""
    parts, ends = tree
    feet = data.draw(st.lists(st.sampled_from(ends), min_size=1, unique=True))
    folder = tmp_path_factory.mktemp("urdf")
    try:
        text = imported(folder, parts, *feet).toml
    except SpecError as error:
        assume({problem.code for problem in error.problems} - {"WG512", "WG513", "WG516"})
        raise
    (folder / "robot.toml").write_text(text, encoding="utf-8")
    back = urdf(assemble(read(folder / "robot.toml"))).text
    draw = np.random.default_rng(seed)
    values = {name: draw.uniform(-3, 3) for name in re.findall('joint name="(.*?)"', "".join(parts))}
    before, after = (snapshot(each, values, feet) for each in ((folder / "robot.urdf").read_text(encoding="utf-8"), back))
    for one, other in zip(before, after, strict=True):
        assert difference(other, one) <= 1e-12


def snapshot(text, values, feet):
    """Poses of the feet, the composite inertia [6,6] about the base, and the joints' upper limits, at these joint values."""
    model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    data, q = model.createData(), pin.neutral(model)
    for name in model.names[2:]:
        q[model.joints[model.getJointId(name)].idx_q] = values[name]
    pin.framesForwardKinematics(model, data, q)
    pin.crba(model, data, q)
    limits = [model.upperPositionLimit[model.joints[model.getJointId(name)].idx_q] for name in sorted(model.names[2:])]
    return np.array([data.oMf[model.getFrameId(foot)].homogeneous for foot in feet]), data.Ycrb[1].matrix(), limits


# ---- what becomes of what ----------------------------------------------------------------------------------------------------

HINGE = "<axis xyz='0 0 1'/>"
BIPED = [
    link("pelvis", inertial("8")),
    *(link(f"{name}{side}", inertial("1")) for side in "LR" for name in ("thigh", "shank")),
    *(link(f"foot{side}") for side in "LR"),
    *(joint(f"hip{side}", "revolute", "torso", f"thigh{side}", HINGE) for side in "LR"),
    *(joint(f"knee{side}", "continuous", f"thigh{side}", f"shank{side}", HINGE) for side in "LR"),
    *(joint(f"sole{side}", "fixed", f"shank{side}", f"foot{side}", '<origin xyz="0.4 0 0"/>') for side in "LR"),
    link("carrier", inertial("2")),
    link("torso", inertial("5")),
    joint("waist_yaw", "revolute", "pelvis", "mid", HINGE),
    link("mid", inertial("0.5")),
    joint("waist_roll", "revolute", "mid", "carrier", "<axis xyz='1 0 0'/>"),
    joint("clamp", "fixed", "carrier", "torso", '<origin xyz="0.25 0 0.5"/>'),
]
ARM = [
    link("upper", inertial("1")),
    link("hand", inertial("0.5")),
    joint("shoulder", "revolute", "torso", "upper", HINGE),
    joint("elbow", "revolute", "upper", "hand", HINGE),
]


def structure(tables):
    chains = {platform["name"]: (platform["parent"], platform["source_names"]) for platform in tables["platforms"] if "parent" in platform}
    return chains, {leg["name"]: (leg["platform"], leg["source_names"]) for leg in tables["legs"]}


def test_shared_joints_become_a_chain_and_the_parting_link_a_platform(spec):
    tables, warnings = spec(BIPED, "footL", "footR")
    chains, legs = structure(tables)
    assert [platform["name"] for platform in tables["platforms"]] == ["pelvis", "torso"]
    assert chains == {"torso": ("pelvis", ["waist_yaw", "waist_roll"])}
    assert legs == {"footl": ("torso", ["hipL", "kneeL"]), "footr": ("torso", ["hipR", "kneeR"])}
    torso = tables["platforms"][1]
    assert torso["end"] == {"xyz": [0.25, 0.0, 0.5]}
    assert torso["mass"] == 7
    rows = tables["chain_designs"]["torso"]["joints"]
    assert [row.get("link", {}).get("mass") for row in rows] == [0.5, None]
    assert warnings == []


def test_joints_on_no_foots_way_become_a_chain_to_a_platform_of_their_own(spec):
    tables, warnings = spec(BIPED + ARM, "footL", "footR")
    assert structure(tables)[0]["hand"] == ("torso", ["shoulder", "elbow"])
    assert tables["platforms"][2]["mass"] == 0.5
    assert tables["chain_designs"]["hand"]["joints"][0]["link"]["mass"] == 1
    assert warnings == []


def test_a_side_branch_that_branches_gets_a_platform_where_it_does(spec):
    fingers = [part for n in "12" for part in (link(f"tip{n}"), joint(f"finger{n}", "prismatic", "hand", f"tip{n}"))]
    chains, _ = structure(spec(BIPED + ARM + fingers, "footL", "footR")[0])
    assert chains["tip1"] == ("hand", ["finger1"])
    assert chains["tip2"] == ("hand", ["finger2"])
    assert chains["hand"] == ("torso", ["shoulder", "elbow"])


def test_with_one_foot_the_other_leg_is_kept_for_its_mass(spec):
    chains, legs = structure(spec(BIPED, "footL")[0])
    assert chains == {"torso": ("pelvis", ["waist_yaw", "waist_roll"]), "shankr": ("torso", ["hipR", "kneeR"])}
    assert legs == {"footl": ("torso", ["hipL", "kneeL"])}


def test_a_joint_on_the_thigh_cuts_the_leg_and_says_so(spec):
    parts = [*BIPED, link("mirror", inertial("0.1")), joint("scan", "revolute", "thighL", "mirror")]
    tables, warnings = spec(parts, "footL", "footR")
    chains, legs = structure(tables)
    assert chains["thighl"] == ("torso", ["hipL"])
    assert chains["mirror"] == ("thighl", ["scan"])
    assert legs["footl"] == ("thighl", ["kneeL"])
    assert warnings == ["WG521"]


def test_every_joint_is_somewhere(spec):
    parts = [*BIPED, *ARM]
    tables, _ = spec(parts, "footL", "footR")
    chains, legs = structure(tables)
    sources = [name for _, names in (*chains.values(), *legs.values()) for name in names]
    assert sorted(sources) == sorted(["waist_yaw", "waist_roll", "hipL", "kneeL", "hipR", "kneeR", "shoulder", "elbow"])


# ---- what is refused ---------------------------------------------------------------------------------------------------------


def test_feet_without_joints_of_their_own(tmp_path):
    toe = [link("toe"), joint("toe_clamp", "fixed", "shankL", "toe")]
    assert refusal(tmp_path, BIPED + toe, "footL", "toe", "footR") == [
        ("WG512", "every joint on the way to the foot 'footL' also moves: toe"),
        ("WG512", "every joint on the way to the foot 'toe' also moves: footL"),
    ]
    assert refusal(tmp_path, BIPED, "torso", "footL") == [("WG512", "every joint on the way to the foot 'torso' also moves: footL")]


def test_a_foot_with_joints_beyond_it(tmp_path):
    wheel = [link("wheel"), joint("spin", "continuous", "shankL", "wheel")]
    assert refusal(tmp_path, BIPED + wheel, "footL", "footR") == [("WG513", "the foot 'footL' is not its leg's end: it carries 'spin'")]


def test_a_platform_and_a_foot_must_not_become_one_name(tmp_path):
    toe = [link("Torso"), joint("ankle", "revolute", "shankL", "Torso")]
    ((code, message),) = refusal(tmp_path, BIPED + toe, "Torso", "footR")
    assert (code, message) == ("WG511", "'torso' and 'Torso' both become 'torso'")


def test_names_that_only_meet_in_generated_code(tmp_path):
    """The chain to "a_foot" and the leg "a" would both own the function r_a_foot_pose."""
    parts = [link(name) for name in ("base", "a_foot", "a")]
    parts += [joint("j1", "revolute", "base", "a_foot"), joint("j2", "revolute", "base", "a")]
    assert [code for code, _ in refusal(tmp_path, parts, "a")] == ["WG511"]


def test_a_snake_longer_than_a_spec_allows(tmp_path):
    parts = [link("l0")]
    parts += [part for n in range(70) for part in (link(f"l{n + 1}"), joint(f"j{n}", "revolute", f"l{n}", f"l{n + 1}"))]
    assert [code for code, _ in refusal(tmp_path, parts, "l70")] == ["WG522"]

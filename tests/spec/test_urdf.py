"""Import of URDF against Pinocchio, which reads the same file: where the feet stand and what each joint carries."""

import tomllib

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mechanisms.urdf_text import ANGLES, AXES, LENGTHS, LIMIT, inertial, joint
from oracles.measure import difference
from walkgen.errors import SpecError
from walkgen.model.assemble import assemble
from walkgen.model.walk import limb_frames, number
from walkgen.spec.read import read
from walkgen.spec.urdf import convert

LEG = [
    '<link name="base"/><link name="Hip"/><link name="thigh"/><link name="foot"/>',
    joint("HAA", "revolute", "base", "Hip", f'<origin xyz="0.1946 0.0875 1e-3"/>{LIMIT}'),
    joint("HFE", "continuous", "Hip", "thigh", '<origin xyz="0.10 0.014 -.5"/><axis xyz="0 1 0"/>'),
    joint("ankle", "fixed", "thigh", "foot", '<origin xyz="0 0.008 -0.16"/>'),
]


@pytest.fixture
def imported(tmp_path):
    def run(parts, *feet, name="Robot-1"):
        path = tmp_path / "robot.urdf"
        path.write_text("<?xml version='1.0'?>\n" + f'<robot name="{name}">\n' + "\n".join(parts) + "\n</robot>\n", encoding="utf-8")
        return convert(path, feet)

    return run


def refusal(imported, parts, *feet):
    with pytest.raises(SpecError) as caught:
        imported(parts, *feet)
    return caught.value.problems


# ---- against Pinocchio -------------------------------------------------------------------------------------------------------


@st.composite
def trees(draw):
    """Legs on one base as (urdf text, feet); fixed joints and side links anywhere, any rpy, any axis."""
    parts, feet = [f'<link name="base">{inertial("3.5")}</link>'], []
    for leg in range(draw(st.integers(1, 3))):
        parent = "base"
        kinds = draw(st.lists(st.sampled_from(["fixed", "revolute", "prismatic", "side"]), max_size=5))
        for index, kind in enumerate([*kinds, "revolute", "fixed"]):
            name = f"l{leg}_{index}"
            triple = [" ".join(draw(numbers) for _ in range(3)) for numbers in (LENGTHS, ANGLES)]
            origin = f'<origin xyz="{triple[0]}" rpy="{triple[1]}"/>'
            mass = draw(st.sampled_from(["", "0.25", "1.5"]))
            parts.append(f'<link name="{name}">{inertial(mass, origin) if mass else ""}</link>')
            inner = origin if kind in {"fixed", "side"} else f'{origin}<axis xyz="{draw(AXES)}"/>{LIMIT}'
            parts.append(joint(f"j{name}", "fixed" if kind == "side" else kind, parent, name, inner))
            parent = parent if kind == "side" else name
        feet.append(parent)
    return parts, tuple(feet)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(tree=trees(), seed=st.integers(0, 2**32 - 1))
def test_feet_and_bodies_are_those_of_pinocchio(tree, seed, tmp_path_factory):
    parts, feet = tree
    path = tmp_path_factory.mktemp("urdf") / "robot.urdf"
    text = f'<robot name="r">{"".join(parts)}</robot>'
    path.write_text(text, encoding="utf-8")
    spec = convert(path, feet).toml
    model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    data = model.createData()
    path.with_suffix(".toml").write_text(spec, encoding="utf-8")
    mechanism, design = assemble(read(path.with_suffix(".toml"))), tomllib.loads(spec)
    compare_bodies(model.inertias[1], design["platforms"][0])
    q = pin.neutral(model)
    values = np.random.default_rng(seed).uniform(-3, 3, model.nq)
    for leg, foot in zip(design["legs"], feet, strict=True):
        rows = design["leg_designs"][foot]["joints"]
        indices = [model.joints[model.getJointId(name)].idx_q for name in leg["source_names"]]
        for index, name, row in zip(indices, leg["source_names"], rows, strict=True):
            q[index] = values[index]
            compare_bodies(model.inertias[model.getJointId(name)], row.get("link", {}))
    pin.framesForwardKinematics(model, data, q)
    for leg, foot in zip(mechanism.legs, feet, strict=True):
        indices = [model.joints[model.getJointId(joint.source_name)].idx_q for joint in leg.joints]
        frame = np.array(data.oMf[model.getFrameId(foot)].homogeneous)
        pose = limb_frames(mechanism, leg, [float(value) for value in q[indices]])[-1]
        assert difference(np.array(pose.tolist(), dtype=float), frame) <= 1e-13


def compare_bodies(reference, body):
    assert difference(body.get("mass", 0.0), reference.mass) <= 1e-14
    if reference.mass:
        xx, yy, zz, xy, xz, yz = body["inertia"]
        assert difference(body["com"], reference.lever) <= 1e-14
        assert difference([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], reference.inertia) <= 1e-14


# ---- what the text says ------------------------------------------------------------------------------------------------------


def test_numbers_are_copied_digit_by_digit(imported):
    toml = imported(LEG, "foot").toml
    assert "xyz = [0.1946, 0.0875, 0.001]\nrpy = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nlimits = [-7.0, 7.0]" in toml
    assert "xyz = [0.10, 0.014, -0.5]" in toml
    assert "foot = { xyz = [0.0, 0.008, -0.16] }" in toml


def test_a_decimal_longer_than_a_double_survives(imported):
    digits = "0.12345678901234567890123456789"
    parts = [*LEG[:3], joint("ankle", "fixed", "thigh", "foot", f'<origin xyz="{digits} 0 0"/>')]
    assert digits in imported(parts, "foot").toml


def test_sums_of_unturned_fixed_joints_are_exact(imported):
    parts = [
        '<link name="base"/><link name="a"/><link name="b"/><link name="foot"/>',
        joint("f", "fixed", "base", "a", '<origin xyz="0.1 0.2 0"/>'),
        joint("j", "revolute", "a", "b", f'<origin xyz="0.2 -0.2 0"/>{LIMIT}'),
        joint("g", "fixed", "b", "foot"),
    ]
    assert tomllib.loads(imported(parts, "foot").toml)["leg_designs"]["foot"]["joints"][0]["xyz"] == [0.3, 0.0, 0.0]


def test_turned_fixed_joints_stay_on_the_exact_angle(imported):
    turn = '<origin rpy="1.5707963267948966 0 0" xyz="0 0.1 0"/>'
    parts = [
        '<link name="base"/><link name="a"/><link name="b"/><link name="foot"/>',
        joint("f", "fixed", "base", "a", turn),
        joint("j", "revolute", "a", "b", f'<origin xyz="0 0.25 0" rpy="-1.5707963267948966 0 0"/>{LIMIT}'),
        joint("g", "fixed", "b", "foot"),
    ]
    row = tomllib.loads(imported(parts, "foot").toml)["leg_designs"]["foot"]["joints"][0]
    assert row["xyz"] == [0.0, 0.1, 0.25]
    assert row["rpy"] == [0.0, 0.0, 0.0]


def test_continuous_has_no_limits_and_zero_speed_means_not_given(imported):
    parts = [*LEG[:2], joint("HFE", "continuous", "Hip", "thigh", '<limit lower="-1" upper="1" effort="0" velocity="0"/>'), LEG[3]]
    row = tomllib.loads(imported(parts, "foot").toml)["leg_designs"]["foot"]["joints"][1]
    assert row["type"] == "revolute"
    assert not {"limits", "max_speed", "max_effort"} & set(row)


def test_limits_of_many_turns_pass_as_degrees(imported, tmp_path):
    parts = [*LEG[:2], joint("HFE", "revolute", "Hip", "thigh", '<limit lower="-100" upper="100" effort="1" velocity="1"/>'), LEG[3]]
    (tmp_path / "robot.toml").write_text(imported(parts, "foot").toml, encoding="utf-8")
    mechanism = assemble(read(tmp_path / "robot.toml"))
    assert [float(number(limit, mechanism)) for limit in mechanism.legs[0].joints[1].limits] == [-100.0, 100.0]


def test_names_are_mapped_and_the_sources_kept(imported):
    result = imported(LEG, "foot")
    spec = tomllib.loads(result.toml)
    assert spec["robot"]["name"] == "robot_1"
    assert spec["legs"][0]["source_names"] == ["HAA", "HFE"]
    assert [row["name"] for row in spec["leg_designs"]["foot"]["joints"]] == ["haa", "hfe"]
    assert ("HAA", "haa") in result.names


@pytest.mark.parametrize(("name", "key"), [("Solo-12", "solo_12"), ("7up", "n7up"), ("", "robot"), ("Walkgen", "robot"), ("int", "int_1")])
def test_the_robot_is_called_as_near_as_can_be(imported, name, key):
    assert tomllib.loads(imported(LEG, "foot", name=name).toml)["robot"]["name"] == key


def test_a_rod_without_thickness_is_marked_so_that_the_spec_passes(imported, tmp_path):
    body = inertial("1.0", origin="", moments=("0", "1", "1", "0", "0", "0"))
    result = imported([LEG[0].replace('<link name="Hip"/>', f'<link name="Hip">{body}</link>'), *LEG[1:]], "foot")
    assert [warning.code for warning in result.warnings] == ["WG514"]
    (tmp_path / "rod.toml").write_text(result.toml, encoding="utf-8")
    assert read(tmp_path / "rod.toml").leg_designs["foot"].joints[0].link.allow_unphysical


def test_free_text_is_escaped(imported):
    parts = [LEG[0], LEG[1], joint("x&quot;\\é", "revolute", "Hip", "thigh"), LEG[3]]
    assert tomllib.loads(imported(parts, "foot").toml)["legs"][0]["source_names"] == ["HAA", 'x"\\é']


def test_gravity_is_there_and_says_where_it_comes_from(imported):
    assert "gravity = [0.0, 0.0, -9.80665]  # a URDF gives none" in imported(LEG, "foot").toml


def test_an_unphysical_inertia_comes_in_with_a_warning(imported):
    body = inertial("1.0", moments=("1", "1", "3", "0", "0", "0"))
    result = imported([LEG[0].replace('<link name="Hip"/>', f'<link name="Hip">{body}</link>'), *LEG[1:]], "foot")
    assert [warning.code for warning in result.warnings] == ["WG514"]
    assert "triangle" in result.warnings[0].message
    assert tomllib.loads(result.toml)["leg_designs"]["foot"]["joints"][0]["link"]["allow_unphysical"] is True


def test_a_thin_plate_is_physical(imported):
    body = inertial("1.0", origin="", moments=("1", "2", "3", "0", "0", "0"))
    assert imported([LEG[0].replace('<link name="Hip"/>', f'<link name="Hip">{body}</link>'), *LEG[1:]], "foot").warnings == ()


def test_a_rounded_right_angle_is_pointed_out(imported):
    parts = [*LEG[:3], joint("ankle", "fixed", "thigh", "foot", '<origin rpy="0 1.5708 0"/>')]
    result = imported(parts, "foot")
    assert [warning.code for warning in result.warnings] == ["WG515"]
    assert "rpy = [0.0, 1.5708, 0.0]" in result.toml


# ---- what is refused ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parts", "code", "words"),
    [
        ([*LEG[:2], LEG[2].replace("</joint>", '<mimic joint="HAA"/></joint>'), LEG[3]], "WG505", "mimics"),
        ([*LEG[:2], LEG[2].replace("continuous", "floating"), LEG[3]], "WG506", "floating"),
        ([*LEG[:2], LEG[2].replace("continuous", "planar"), LEG[3]], "WG506", "planar"),
        ([*LEG[:2], LEG[2].replace(' link="Hip"', ""), LEG[3]], "WG507", "no <parent>"),
        ([LEG[0].replace(' name="Hip"', ""), *LEG[1:]], "WG507", "without a name"),
        ([*LEG[:2], LEG[2].replace("0.014", "nan"), LEG[3]], "WG508", "'nan'"),
        ([*LEG[:2], LEG[2].replace("0.014", "1e999"), LEG[3]], "WG508", "'1e999'"),
        ([*LEG[:2], LEG[2].replace("0.014", "1_0"), LEG[3]], "WG508", "'1_0'"),
        ([*LEG[:2], LEG[2].replace("0.014", ""), LEG[3]], "WG508", "three numbers"),
        ([*LEG[:2], LEG[2].replace("0 1 0", "0 0 0"), LEG[3]], "WG508", "no length"),
        ([LEG[0], LEG[1].replace('"-7"', '"8"'), *LEG[2:]], "WG508", "crossed"),
        ([*LEG, LEG[3].replace("ankle", "second")], "WG510", "child of 2 joints"),
        ([*LEG, '<link name="stray"/>'], "WG510", "2 links have no parent"),
        ([*LEG, '<link name="c"/><link name="d"/>', joint("x", "fixed", "c", "d"), joint("y", "fixed", "d", "c")], "WG510", "loop"),
        ([*LEG[:2], LEG[2].replace('"Hip"', '"hop"'), LEG[3]], "WG510", "'hop'"),
        ([*LEG, '<link name="Hip"/>'], "WG510", "given twice"),
        ([LEG[0], LEG[1].replace("HAA", "hfe"), *LEG[2:]], "WG511", "both become 'hfe'"),
        ([LEG[0], LEG[1].replace("HAA", "1st"), *LEG[2:]], "WG511", "not a name"),
        ([LEG[0], LEG[1].replace("HAA", "a&#127;"), *LEG[2:]], "WG511", "control characters"),
        ([LEG[0], LEG[1].replace("HAA", "Double"), *LEG[2:]], "WG511", "'double', which is a keyword of C"),
        ([LEG[0].replace('<link name="Hip"/>', f'<link name="Hip">{inertial("-1")}</link>'), *LEG[1:]], "WG508", "negative"),
        ([LEG[0], "<xacro:macro xmlns:xacro='http://www.ros.org/wiki/xacro'/>", *LEG[1:]], "WG503", "xacro"),
        ([LEG[0], LEG[1].replace("0.1946", "${x}"), *LEG[2:]], "WG503", "xacro"),
    ],
)
def test_refusals(imported, parts, code, words):
    problems = refusal(imported, parts, "foot")
    assert {problem.code for problem in problems} == {code}
    assert any(words in problem.message for problem in problems)
    assert all(problem.cure for problem in problems)


def test_every_problem_is_reported_at_once(imported):
    parts = [LEG[0], LEG[1].replace("0.1946", "x"), LEG[2].replace("continuous", "planar"), LEG[3].replace("-0.16", "inf")]
    assert [problem.place.line for problem in refusal(imported, parts, "foot")] == [4, 5, 6]


def test_feet_have_to_exist_and_to_move(imported):
    (problem,) = refusal(imported, LEG, "fot")
    assert (problem.code, problem.cure) == ("WG509", "did you mean 'foot'?")
    (problem,) = refusal(imported, LEG)
    assert problem.cure.endswith("are foot")
    (problem,) = refusal(imported, LEG, "base")
    assert problem.code == "WG516"
    assert [problem.code for problem in refusal(imported, LEG, "foot", "foot")] == ["WG509"]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ('<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><robot name="r">&b;</robot>', "WG502"),
        ('<!DOCTYPE robot SYSTEM "file:///etc/passwd"><robot name="r"/>', "WG502"),
        ("<sdf version='1.6'/>", "WG504"),
        ("<mujoco/>", "WG504"),
        ("<robot name='r'><link name='a'></robot>", "WG501"),
        ("<html/>", "WG501"),
        ("", "WG501"),
    ],
)
def test_files_that_are_no_urdf(tmp_path, text, code):
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        convert(path, ("foot",))
    assert [problem.code for problem in caught.value.problems] == [code]


def test_files_that_cannot_be_read(tmp_path):
    for path, data in (
        (tmp_path / "none.urdf", None),
        (tmp_path / "binary.urdf", b"\xff\xfe\x00"),
        (tmp_path / "huge.urdf", b" " * (16 * 2**20 + 1)),
    ):
        if data is not None:
            path.write_bytes(data)
        with pytest.raises(SpecError) as caught:
            convert(path, ("foot",))
        assert [problem.code for problem in caught.value.problems] == ["WG501"]


def test_a_chain_of_ten_thousand_links_is_walked_without_recursion(imported):
    links = "".join(f'<link name="l{index}"/>' for index in range(10_000))
    joints = "".join(joint(f"j{index}", "fixed", f"l{index}", f"l{index + 1}") for index in range(9_999))
    parts = [links, joints, '<link name="foot"/>', joint("last", "revolute", "l9999", "foot")]
    assert tomllib.loads(imported(parts, "foot").toml)["legs"][0]["name"] == "foot"

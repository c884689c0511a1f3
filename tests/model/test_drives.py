"""Friction and rotors of joints: read, checked, reflected through the gear, the same on both sides of a mirror."""

import pytest
from float_walk import assembled, number, robot

from walkgen.errors import SpecError
from walkgen.spec.scalar import ZERO, names

ROW = '{{ name = "only", type = "{kind}", a = 0.3, alpha_deg = 0, d = 0, {drive} }}'
DH = 'dh = "classic"'


def joint_of(tmp_path, drive, kind="revolute", more=""):
    (leg, *_) = assembled(tmp_path, robot(ROW.format(kind=kind, drive=drive), DH, "", more)).legs
    return leg.joints[0]


def test_left_out_is_nothing(tmp_path):
    joint = joint_of(tmp_path, "max_effort = 3")
    assert (joint.viscous, joint.coulomb, joint.rotor) == (ZERO, ZERO, ZERO)


def test_friction(tmp_path):
    joint = joint_of(tmp_path, "friction = { viscous = 0.25, coulomb = 1.5 }")
    assert (number(joint.viscous, {}), number(joint.coulomb, {})) == (0.25, 1.5)
    assert joint.rotor == ZERO


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize(("rotor", "felt"), [("inertia = 2e-4, gear = 50", 0.5), ("inertia = 0.4", 0.4), ("inertia = 0.4, gear = -2", 1.6)])
def test_the_joint_feels_the_rotor_through_the_gear(tmp_path, kind, rotor, felt):
    assert number(joint_of(tmp_path, f"rotor = {{ {rotor} }}", kind).rotor, {}) == pytest.approx(felt, rel=1e-15)


def test_runtime_parameters_stay(tmp_path):
    table = "[parameters]\nratio = { value = 9, runtime = true }\ndrag = { value = 0.1, runtime = true }"
    joint = joint_of(tmp_path, 'friction = { viscous = "2*drag" }, rotor = { inertia = 1e-3, gear = "ratio" }', more=table)
    assert names(joint.viscous) == {"drag"}
    assert number(joint.rotor, {"ratio": 9}) == pytest.approx(0.081)


def test_a_mirror_image_has_the_same_drives(tmp_path):
    image = '\n[[legs]]\nname = "image"\nmirror_of = "leg"'
    text = robot(ROW.format(kind="revolute", drive="friction = { coulomb = 2 }, rotor = { inertia = 0.1 }"), DH, image)
    first, second = assembled(tmp_path, text).legs
    assert first.joints[0].sign == -second.joints[0].sign
    assert (first.joints[0].coulomb, first.joints[0].rotor) == (second.joints[0].coulomb, second.joints[0].rotor)


@pytest.mark.parametrize(
    ("drive", "code", "says"),
    [
        ("friction = { viscous = -0.1 }", "WG161", "viscous must not be negative"),
        ("friction = { coulomb = -1 }", "WG161", "coulomb must not be negative"),
        ("rotor = { inertia = -1e-4 }", "WG161", "inertia must not be negative"),
        ("rotor = { gear = 50 }", "WG111", 'missing key "inertia"'),
        ("friction = { viscos = 1 }", "WG110", 'did you mean "viscous"?'),
        ('rotor = { inertia = "big" }', "WG141", "big"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, drive, code, says):
    with pytest.raises(SpecError, match=says.replace("?", r"\?")) as caught:
        joint_of(tmp_path, drive)
    assert {problem.code for problem in caught.value.problems} == {code}

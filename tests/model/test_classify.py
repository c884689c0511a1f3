"""Which legs have a closed-form inverse, and the sentence that says why or why not."""

import pytest
from float_walk import assembled, robot

from walkgen.model.classify import inverse_class

BRANCHES = ("rho_plus_knee_plus", "rho_plus_knee_minus", "rho_minus_knee_plus", "rho_minus_knee_minus")


def row(name, kind="revolute", a="0.3", alpha="alpha_deg = 0", d="0.0"):
    return f'{{ name = "{name}", type = "{kind}", a = {a}, {alpha}, d = {d} }},'


def rows(alpha1="alpha_deg = 90", alpha2="alpha_deg = 0", a3="0.4", a2="0.35", kinds=("revolute",) * 3):
    return row("one", kinds[0], "0.05", alpha1, "0.1") + row("two", kinds[1], a2, alpha2, "0.02") + row("three", kinds[2], a3)


def axis(name, direction, xyz):
    return f'{{ name = "{name}", type = "revolute", xyz = {xyz}, axis = {direction} }},'


YAW_PITCH_PITCH = {
    "yaw-pitch-pitch": robot(rows()),
    "turned the other way": robot(rows("alpha_deg = -90", "alpha_deg = 180")),
    "mounted askew": robot(rows(), legs="mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [13, 17, 19] }"),
    "pi/2 as a double": robot(rows("alpha = 1.5707963267948966")),
    "craig": robot(row("one") + row("two", alpha="alpha_deg = 90") + row("three"), 'dh = "craig"\nfoot = { xyz = [0.4, 0, 0] }'),
    "roll-pitch-pitch": robot(
        axis("roll", [1, 0, 0], [0, 0.1, 0]) + axis("pitch", [0, 1, 0], [0.1, 0, 0]) + axis("knee", [0, -1, 0], [0, 0, -0.3]),
        "foot = { xyz = [0, 0, -0.3] }",
    ),
    "with runtime lengths": robot(
        rows(a3='"shank"', a2='"2*shank"'), head='[parameters]\nshank = { value = 0.4, unit = "m", runtime = true }'
    ),
}
GENERAL = {
    "alpha rounded to 1.57": (robot(rows("alpha = 1.57")), "RRR", "not perpendicular"),
    "alpha 1.5708": (robot(rows("alpha = 1.5708")), "RRR", "not perpendicular"),
    "axes 2 and 3 askew": (robot(rows(alpha2="alpha_deg = 1")), "RRR", "not parallel"),
    "RRP": (robot(rows(kinds=("revolute", "revolute", "prismatic"))), "RRP", "RRP"),
    "RPP": (robot(rows(kinds=("revolute", "prismatic", "prismatic"))), "RPP", "RPP"),
    "RPR": (robot(rows(kinds=("revolute", "prismatic", "revolute"))), "RPR", "RPR"),
    "PRR": (robot(rows(kinds=("prismatic", "revolute", "revolute"))), "PRR", "quartic"),
    "PPR": (robot(rows(kinds=("prismatic", "prismatic", "revolute"))), "PPR", "quadratic"),
    "PPP": (robot(rows(kinds=("prismatic",) * 3)), "PPP", "at most one solution"),
    "two slides": (robot(row("one", "prismatic", alpha="alpha_deg = 90") + row("two", "prismatic")), "PP", "at most one solution"),
    "a turn and a slide": (robot(row("one") + row("two", "prismatic")), "RP", "quadratic"),
    "2.7e-6 rad off parallel": (robot(rows(alpha2="alpha = 2.7e-6")), "RRR", "2.7e-6 rad apart, not parallel"),
    "two joints": (robot(row("one", alpha="alpha_deg = 90") + row("two")), "RR", "RR"),
    "one joint": (robot(row("one", kind="prismatic")), "P", "projection"),
    "foot on axis 3": (robot(rows(a3="0.0")), "RRR", "axis 3"),
    "axis 3 on axis 2": (robot(rows(a2="0.0")), "RRR", "axis 2"),
    "perpendicular at the default only": (
        robot(rows('alpha = "tilt"'), head='[parameters]\ntilt = { value = "pi/2", unit = "rad", runtime = true }'),
        "RRR",
        "not perpendicular",
    ),
}
SLOTS = {"RRR": 4, "RRP": 4, "RPR": 4, "PRR": 4, "RPP": 2, "PPR": 2, "PPP": 1, "RR": 2, "RP": 2, "PP": 1, "P": 1}
FOUR_JOINTS = robot(rows() + row("four"))
NAMES = 'dh = "classic"\nbranches = ["reach_up", "reach_down", "back_up", "back_down"]'


def class_of(tmp_path, text):
    mechanism = assembled(tmp_path, text)
    return inverse_class(mechanism, mechanism.legs[0])


@pytest.mark.parametrize("name", YAW_PITCH_PITCH)
def test_yaw_pitch_pitch(tmp_path, name):
    found = class_of(tmp_path, YAW_PITCH_PITCH[name])
    assert (found.name, found.branch_names) == ("yaw-pitch-pitch", BRANCHES)
    assert "perpendicular" in found.reason
    assert "parallel" in found.reason


@pytest.mark.parametrize("name", GENERAL)
def test_every_other_leg_of_up_to_three_joints_is_general(tmp_path, name):
    text, kinds, reason = GENERAL[name]
    found = class_of(tmp_path, text)
    assert found.name == f"general {kinds}"
    assert found.branch_names == tuple(f"root_{number + 1}" for number in range(SLOTS[kinds]))
    assert reason in found.reason


def test_more_joints_have_no_branches(tmp_path):
    found = class_of(tmp_path, FOUR_JOINTS)
    assert (found.name, found.branch_names) == ("", ())
    assert "4 joints" in found.reason


@pytest.mark.parametrize("alpha", ["alpha_deg = 90", "alpha = 1.57"])
def test_names_of_the_spec(tmp_path, alpha):
    found = class_of(tmp_path, robot(rows(alpha), NAMES))
    assert found.branch_names == ("reach_up", "reach_down", "back_up", "back_down")


def test_fewer_branches_have_fewer_names(tmp_path):
    found = class_of(tmp_path, robot(rows(kinds=("revolute", "prismatic", "prismatic")), 'dh = "classic"\nbranches = ["ahead", "behind"]'))
    assert found.branch_names == ("ahead", "behind")


@pytest.mark.parametrize("count", [4, 6, 7])
def test_longer_legs_say_what_they_have_instead(tmp_path, count):
    found = class_of(tmp_path, robot("".join(row(f"joint{index}") for index in range(count))))
    assert (found.name, found.branch_names) == ("", ())
    assert found.reason == f"{count} joints leave the foot position redundant: solved by iteration from a seed"


def test_the_reason_says_how_far_from_it(tmp_path):
    """1.57 is 0.000796 rad short of a right angle; a person must be able to see that it was rounding."""
    assert "1.57 rad" in class_of(tmp_path, GENERAL["alpha rounded to 1.57"][0]).reason
    assert "0.0174533 rad" in class_of(tmp_path, GENERAL["axes 2 and 3 askew"][0]).reason


def test_a_mirror_image_is_of_the_same_class(tmp_path):
    mechanism = assembled(tmp_path, robot(rows(), legs='\n[[legs]]\nname = "image"\nmirror_of = "leg"'))
    assert [inverse_class(mechanism, leg).name for leg in mechanism.legs] == ["yaw-pitch-pitch"] * 2

"""What is wrong with a linkage is said with its place, its group, and how to mend it."""

from pathlib import Path

import pytest

from walkgen.errors import SpecError, UnsupportedMechanism
from walkgen.pipeline import build
from walkgen.spec.read import read

TEXT = (Path(__file__).parents[2] / "specs" / "hydraulic_leg.toml").read_text(encoding="utf-8")
SPARE = """
[leg_designs.hydraulic.links.spare]
points = { A = [0.0, 0.0] }
[[leg_designs.hydraulic.pins]]"""
TRIAD = """
walkgen = 1
robot = { name = "triad", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
[leg_designs.leg]
foot = "plate.A"
links = { frame = { points = { A = [0, 0], B = [1, 0], C = [0.5, 1] } }, plate = { points = { A = [0, 0], B = [0.2, 0], C = [0.1, 0.2] } } }
cylinders = [
    { name = "one", between = ["frame.A", "plate.A"], driven = true },
    { name = "two", between = ["frame.B", "plate.B"], driven = true },
    { name = "three", between = ["frame.C", "plate.C"], driven = true },
]
"""
SECOND_JOINT = """branches = ["a", "b"]
[[leg_designs.hydraulic.joints]]
name = "slide"
type = "prismatic"
a = 0.0
alpha_deg = 0
d = 0.0
[[leg_designs.hydraulic.joints]]"""
PIN = 'joins = ["thigh.H", "shank.H"]'
BAD = {
    "link": ("WG180", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H", "shnk.H"]', "shank"),
    "point": ("WG180", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H", "shank.h"]', "H"),
    "no point": ("WG180", 'foot = "shank.P"', 'foot = "shank"', "link.point"),
    "one link": ("WG181", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H"]', "two links"),
    "itself": ("WG181", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H", "thigh.J"]', "thigh"),
    "disconnected": ("WG182", "\n[[leg_designs.hydraulic.pins]]", SPARE, "spare"),
    "too many drives": ("WG183", 'joins = ["frame.I", "thigh.I"]', 'joins = ["frame.I", "thigh.I"]\ndriven = true', "2 degrees"),
    "one cylinder on one link": ("WG185", '["frame.E", "thigh.G"]', '["frame.E", "frame.I"]', "one link"),
    "no length": ("WG185", "limits = [0.25, 0.45]", "limits = [0.0, 0.45]", "no direction"),
    "passive rotor": ("WG186", PIN, PIN + "\nrotor = { inertia = 1 }", "driven"),
    "negative friction": ("WG161", PIN, PIN + "\nfriction = { viscous = -1 }", "viscous"),
    "negative coefficient": ("WG161", PIN, PIN + "\nfriction = { mu = -0.1, radius = 0.01 }", "mu"),
    "no bolt": ("WG161", PIN, PIN + "\nfriction = { mu = 0.1, radius = 0.0 }", "radius"),
    "a bolt of no size": ("WG111", PIN, PIN + "\nfriction = { mu = 0.1 }", "radius = 0.01"),
    "a bolt that is smooth": ("WG111", PIN, PIN + "\nfriction = { radius = 0.01 }", "mu = 0.1"),
    "friction of a cylinder's load": ("WG110", "max_effort = 4000.0", "friction = { mu = 0.1 }", "viscous"),
    "branches": ("WG127", 'knee = "left" }', 'knee = "left" }\nbranches = ["a", "b", "c"]', "yaw_plus_h_left, yaw_plus_h_right, yaw_minus"),
    "branches of no inverse": ("WG127", "[[leg_designs.hydraulic.joints]]", SECOND_JOINT, "2 joints (PR) before the linkage"),
    "no such dyad": ("WG187", 'knee = "left"', 'kne = "left"', "knee"),
    "no such side": ("WG187", 'knee = "left"', 'knee = "up"', "left or right"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_problem_has_its_place_and_cure(tmp_path, name):
    code, old, new, said = BAD[name]
    assert old in TEXT
    path = tmp_path / "robot.toml"
    path.write_text(TEXT.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(path)
    found = [problem for problem in error.value.problems if problem.code == code]
    assert found, error.value
    assert found[0].place is not None
    assert said in str(found[0])


def test_a_drive_that_moves_a_part_twice(tmp_path):
    text = TEXT.replace('joins = ["frame.I", "thigh.I"]', 'joins = ["frame.I", "thigh.I"]\ndriven = true', 1)
    head, _, tail = text.partition('name = "knee"')
    path = tmp_path / "robot.toml"
    path.write_text(head + 'name = "knee"' + tail.replace("driven = true", "driven = false", 1), encoding="utf-8")
    with pytest.raises(SpecError, match="WG184"):
        read(path)


PLATES = """
walkgen = 1
robot = { name = "plates", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
[leg_designs.leg]
foot = "plate.A"
pins = [{ joins = ["plate.C", "other.C"] }]
cylinders = [
    { name = "one", between = ["frame.A", "plate.A"], driven = true },
    { name = "two", between = ["frame.B", "plate.B"], driven = true },
    { name = "three", between = ["frame.A", "other.A"], driven = true },
    { name = "four", between = ["frame.B", "other.B"], driven = true },
]
[leg_designs.leg.links]
frame = { points = { A = [0, 0], B = [1, 0] } }
plate = { points = { A = [0, 0], B = [0.2, 0], C = [0.1, 0.2] } }
other = { points = { A = [0, 0], B = [0.2, 0], C = [0.1, 0.2] } }
"""


def test_a_group_of_six_links_is_named(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(PLATES, encoding="utf-8")
    with pytest.raises(UnsupportedMechanism, match="WG150") as error:
        read(path)
    assert "plate" in str(error.value)
    assert "more than four links" in str(error.value)


BAD_STARTS = {
    "no such point": ('points = { "plate.Z" = [0, 1] }', "WG180", "A"),
    "no such link": ("angles_deg = { plat = 10 }", "WG180", "plate"),
    "too few drives": ("drives = [1.0, 1.0]", "WG187", "3 drives"),
    "drives of another unit": ("drives_deg = [1.0, 1.0, 1.0]", "WG187", "rad or m"),
    "angles in two units": ("angles = { plate = 1 }, angles_deg = { plate = 10 }", "WG122", "angles"),
    "sides of a triad": ('} , assembly = { plate = "left"', "WG187", "start"),
}


@pytest.mark.parametrize("name", BAD_STARTS)
def test_a_bad_start_has_its_place_and_cure(tmp_path, name):
    start, code, said = BAD_STARTS[name]
    path = tmp_path / "robot.toml"
    given = f"start = {{ {start} }}".replace("} , assembly", "}\nassembly")
    path.write_text(TRIAD.replace('foot = "plate.A"', f'foot = "plate.A"\n{given}'), encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(path)
    found = [problem for problem in error.value.problems if problem.code == code]
    assert found, error.value
    assert found[0].place is not None
    assert said in str(found[0])


def test_a_triad_that_assembles_nowhere(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(TRIAD.replace('foot = "plate.A"', 'foot = "plate.A"\nstart = { drives = [0.1, 0.1, 5.0] }'), encoding="utf-8")
    with pytest.raises(SpecError, match="WG189") as error:
        build(path, tmp_path / "out")
    assert "plate" in str(error.value)

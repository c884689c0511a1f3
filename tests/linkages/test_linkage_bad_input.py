"""What is wrong with a linkage is said with its place, its group, and how to mend it."""

from pathlib import Path

import pytest

from walkgen.errors import SpecError, UnsupportedMechanism
from walkgen.pipeline import BuildOptions, build, generate
from walkgen.spec.read import read

TEXT = (Path(__file__).parents[2] / "specs" / "hydraulic_leg.toml").read_text(encoding="utf-8")
SPARE = """
[leg_designs.hydraulic.links.spare]
points = { A = [0.0, 0.0] }
[[leg_designs.hydraulic.pins]]"""
PAIR = """
[leg_designs.hydraulic.links.spare]
points = { A = [0.0, 0.0] }
[leg_designs.hydraulic.links.other]
points = { A = [0.0, 0.0] }
[[leg_designs.hydraulic.pins]]
joins = ["spare.A", "other.A"]
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
AFTER = """
[[leg_designs.hydraulic.joints_after]]
name = "ankle"
type = "revolute"
a = 0.0
alpha_deg = 0
d = 0.0
"""
HUNG = 'foot = {}\nlinkage_end = { point = "shank.P" }'
SPRING = """
[[leg_designs.hydraulic.springs]]
name = "coil"
between = ["thigh.H", { link = "ankle", xyz = [0, 0, 0.1] }]
stiffness = 100
free_length = 0.1
"""
FOOT, FIRST = 'foot = "shank.P"', "[[platforms]]"
PIN = 'joins = ["thigh.H", "shank.H"]'
BAD = {
    "an end without joints": ("WG180", FOOT, FOOT + '\nlinkage_end = { point = "shank.P" }', "joints_after"),
    "a point that is no foot": ("WG180", FIRST, AFTER + FIRST, 'linkage_end = { point = "shank.P" }'),
    "joints on nothing": ("WG111", f"{FOOT}|{FIRST}", f"foot = {{}}|{AFTER + FIRST}", "linkage_end"),
    "joints on no point": ("WG180", f"{FOOT}|{FIRST}", f"{HUNG.replace('P', 'Q')}|{AFTER + FIRST}", "points of shank"),
    "joints of one name": (
        "WG132",
        f"{FOOT}|{FIRST}",
        f"{HUNG}|{AFTER.replace('ankle', 'yaw') + FIRST}",
        "yaw",
    ),
    "signs of some joints": ("WG125", f"{FOOT}|{FIRST}", f"{HUNG}\nsigns = [1]|{AFTER + FIRST}", "2 joints"),
    "a spring on no joint": ("WG201", f"{FOOT}|{FIRST}", f"{HUNG}|{AFTER + SPRING.replace('ankle', 'ankel') + FIRST}", "ankle"),
    "branches behind it": (
        "WG127",
        f"{FOOT}|{FIRST}",
        f"{HUNG}\nbranches = ['a']|{AFTER + FIRST}",
        "one after it and none before",
    ),
    "link": ("WG180", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H", "shnk.H"]', "shank"),
    "point": ("WG180", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H", "shank.h"]', "H"),
    "no point": ("WG180", 'foot = "shank.P"', 'foot = "shank"', "link.point"),
    "one link": ("WG181", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H"]', "two links"),
    "itself": ("WG181", 'joins = ["thigh.H", "shank.H"]', 'joins = ["thigh.H", "thigh.J"]', "thigh"),
    "disconnected": ("WG182", "\n[[leg_designs.hydraulic.pins]]", SPARE, "spare"),
    "two that hang on each other": ("WG182", "\n[[leg_designs.hydraulic.pins]]", PAIR, "spare, other"),
    "too many drives": ("WG183", 'joins = ["frame.I", "thigh.I"]', 'joins = ["frame.I", "thigh.I"]\ndriven = true', "2 degrees"),
    "too few drives": ("WG183", '"thigh.G"]\ndriven = true', '"thigh.G"]', "drive 1 more, for instance i or lift"),
    "one cylinder on one link": ("WG185", '["frame.E", "thigh.G"]', '["frame.E", "frame.I"]', 'the link "frame"'),
    "a cylinder in a pin": ("WG179", '["frame.E", "thigh.G"]', '["frame.E", "thigh.I"]', "the dyad lift"),
    "limits of a passive pin": ("WG186", PIN, PIN + "\nlimits_deg = [0, 90]", "limits_deg"),
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
    path, text = tmp_path / "robot.toml", TEXT
    for one, other in zip(old.split("|"), new.split("|"), strict=True):
        assert one in text
        text = text.replace(one, other, 1)
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(path)
    found = [problem for problem in error.value.problems if problem.code == code]
    assert found, error.value
    assert found[0].place is not None
    assert said in str(found[0])


def problems_of(tmp_path, text):
    """Codes, and the lines that they are told at."""
    path = tmp_path / "robot.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SpecError) as error:
        read(path)
    lines = text.splitlines()
    return [(each.code, lines[each.place.line - 1].partition(" #")[0].strip(), str(each)) for each in error.value.problems]


@pytest.mark.parametrize("driven", [True, False])
@pytest.mark.parametrize(("ends", "link"), [('["frame.E", "frame.I"]', "frame"), ('["thigh.G", "thigh.J"]', "thigh")])
def test_a_cylinder_on_one_link_is_all_that_is_wrong(tmp_path, ends, link, driven):
    """Not what follows from it: that its drive moves nothing, or that there is a drive too few."""
    text = TEXT.replace('["frame.E", "thigh.G"]\ndriven = true', f"{ends}\n{'driven = true' if driven else ''}", 1)
    text = text if driven else text.replace("limits = [0.25, 0.45]\nmax_effort = 4000.0", "", 1)
    ((code, line, said),) = problems_of(tmp_path, text)
    assert (code, line) == ("WG185", f"between = {ends}")
    assert f'the cylinder "lift" are on the link "{link}"' in said


def test_a_drive_that_moves_a_part_twice(tmp_path):
    """Told at that drive, with what holds the part and with what is left free."""
    text = TEXT.replace('joins = ["frame.I", "thigh.I"]', 'joins = ["frame.I", "thigh.I"]\ndriven = true', 1)
    head, _, tail = text.partition('name = "knee"')
    tail = tail.replace("driven = true\nlimits = [0.25, 0.45]\nmax_effort = 4000.0\n", "", 1)
    ((code, line, said),) = problems_of(tmp_path, f'{head}name = "knee"{tail}')
    assert (code, line) == ("WG184", "[[leg_designs.hydraulic.cylinders]]")
    assert '"lift" moves nothing of its own: other drives hold frame/thigh, while nothing drives shank' in said
    assert "instead, for instance h or knee" in said


FOUR_BAR = """
walkgen = 1
robot = { name = "bars", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
[leg_designs.leg]
foot = "hand.T"
[leg_designs.leg.links]
frame = { points = { A = [0, 0], D = [0.3, 0] } }
crank = { points = { A = [0, 0], B = [0.1, 0] } }
coupler = { points = { B = [0, 0], C = [0.3, 0] } }
rocker = { points = { D = [0, 0], C = [0.3, 0], H = [0.4, 0] } }
hand = { points = { H = [0, 0], T = [0.3, 0] } }
[[leg_designs.leg.pins]]
joins = ["frame.A", "crank.A"]
driven = true
[[leg_designs.leg.pins]]
joins = ["frame.D", "rocker.D"]
driven = true
[[leg_designs.leg.pins]]
joins = ["crank.B", "coupler.B"]
[[leg_designs.leg.pins]]
joins = ["coupler.C", "rocker.C"]
[[leg_designs.leg.pins]]
joins = ["rocker.H", "hand.H"]
"""


def test_two_cranks_of_one_loop_and_a_hand_without_drive(tmp_path):
    ((code, _, said),) = problems_of(tmp_path, FOUR_BAR)
    assert code == "WG184"
    assert (
        'pins[1]: the drive "d" moves nothing of its own: other drives hold frame/crank/coupler/rocker, while nothing drives hand' in said
    )


def test_a_turning_drive_without_limits_that_assembles_nowhere(tmp_path):
    """A whole turn is looked at."""
    first, second = "driven = true\n", 'joins = ["rocker.H", "hand.H"]\n'
    text = FOUR_BAR.replace(first, "", 1).replace(second, second + first)
    path = tmp_path / "robot.toml"
    path.write_text(text, encoding="utf-8")
    generate(path, BuildOptions(targets=("c",)))
    path.write_text(text.replace("C = [0.3, 0]", "C = [0.05, 0]"), encoding="utf-8")
    with pytest.raises(SpecError, match="WG189") as error:
        generate(path, BuildOptions(targets=("c",)))
    assert "the dyad b cannot close" in str(error.value)


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

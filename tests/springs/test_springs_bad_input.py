"""What is wrong with a spring is said with its place and how to mend it."""

import pytest

from symbolic.dynamic_legs import BODY, SPECS, THIGH, YAW, spec_of, written
from walkgen.errors import SpecError
from walkgen.pipeline import BuildOptions, build, generate
from walkgen.spec.read import read

ENDS = 'between = [{ link = "mount", xyz = [0.1, -0.2, 0.05] }, { link = "thigh", xyz = [-0.05, 0.02, 0.01] }]'
SPRING = f"""
[[leg_designs.arm.springs]]
name = "pull"
{ENDS}
stiffness = 900.0
free_length = 0.1
"""
TEXT = spec_of(f"{YAW}, limits_deg = [-40, 40], {BODY}", f"{THIGH}, limits_deg = [-50, 60], {BODY}") + SPRING
LINKED = (SPECS / "hydraulic_leg.toml").read_text(encoding="utf-8") + SPRING.replace("arm", "hydraulic").replace(
    ENDS, 'between = ["frame.E", "thigh.H"]'
)
BAD = {
    "joint": ("WG201", 'link = "thigh"', 'link = "thihg"', 'did you mean "thigh"?'),
    "point of no linkage": ("WG201", '{ link = "thigh", xyz = [-0.05, 0.02, 0.01] }', '"thigh.P"', "xyz = "),
    "one body": ("WG202", 'link = "mount"', 'link = "thigh"', "two links"),
    "no free length": ("WG111", "free_length = 0.1", "", "free_length = 0.15"),
    "no stiffness": ("WG111", "stiffness = 900.0", "", "stiffness"),
    "soft": ("WG161", "stiffness = 900.0", "stiffness = 0.0", "positive"),
    "pushing": ("WG161", "free_length = 0.1", "free_length = 0.1\ninitial_tension = -3", "not be negative"),
    "lighter than nothing": ("WG161", "free_length = 0.1", "free_length = 0.1\nmasses = { at_first = -1 }", "not be negative"),
    "misspelt": ("WG110", "free_length = 0.1", "free_lenght = 0.1", "free_length"),
    "place": ("WG110", "xyz = [-0.05, 0.02, 0.01]", "xyy = [-0.05, 0.02, 0.01]", "xyz"),
    "three ends": ("WG112", ENDS, ENDS.replace("}]", '}, "a.B"]'), "2"),
    "name": ("WG131", 'name = "pull"', 'name = "short"', "keyword"),
    "twice": ("WG132", SPRING, SPRING + SPRING, "own name"),
    "two units": ("WG122", "free_length = 0.1", "free_length = 0.1\nfree_length_mm = 100", "free_length"),
    "mount": ("WG201", 'name = "yaw"', 'name = "mount"', "another name"),
}
OF_LINKAGE = {
    "link": ("WG180", '"thigh.H"]\nstiff', '"thihg.H"]\nstiff', "thigh"),
    "point": ("WG180", '"thigh.H"]\nstiff', '"thigh.X"]\nstiff', "points of thigh"),
    "one link": ("WG202", '["frame.E", "thigh.H"]', '["thigh.G", "thigh.H"]', "two links"),
    "frame and what carries it": ("WG202", '["frame.E", "thigh.H"]', '["frame.E", { link = "yaw" }]', "two links"),
}


@pytest.mark.parametrize("name", BAD)
def test_of_joints_in_series(tmp_path, name):
    _refused(tmp_path, TEXT, *BAD[name])


@pytest.mark.parametrize("name", OF_LINKAGE)
def test_of_a_linkage(tmp_path, name):
    _refused(tmp_path, LINKED, *OF_LINKAGE[name])


def _refused(folder, text, code, old, new, says):
    assert old in text
    path = written(folder, text.replace(old, new, 1))
    with pytest.raises(SpecError) as caught:
        read(path)
    found = [problem for problem in caught.value.problems if problem.code == code]
    assert found, caught.value
    assert any(says in str(problem) for problem in found), caught.value
    assert all(problem.place.line > 1 for problem in found)


def test_a_good_one_is_read(tmp_path):
    assert read(written(tmp_path, TEXT)).leg_designs["arm"].springs[0].name == "pull"
    assert read(written(tmp_path, LINKED)).leg_designs["hydraulic"].springs[0].stiffness


def test_a_slack_spring_is_refused_with_the_joints_values(tmp_path):
    """The spring is shortest where both joints are at ends of their limits; there its length is less than 0.4 m."""
    with pytest.raises(SpecError, match=r"(?s)WG203.*springs\[0\].*pull would have to push.*yaw .* rad, thigh .* rad.*0\.4 m") as caught:
        build(written(tmp_path, TEXT.replace("free_length = 0.1", "free_length = 0.4")), tmp_path / "out")
    (problem,) = caught.value.problems
    assert problem.place.source.startswith("[[leg_designs.arm.springs]]")


def test_a_slack_spring_of_a_linkage_is_refused(tmp_path):
    with pytest.raises(SpecError, match=r"(?s)WG203.*lift .* m"):
        generate(written(tmp_path, LINKED.replace("free_length = 0.1", "free_length = 0.9")))


def test_show_lists_springs(tmp_path):
    from typer.testing import CliRunner

    from walkgen.cli import app

    for text, wanted in ((TEXT, "spring pull  mount to thigh, 900 N/m"), (LINKED, "spring pull  frame to thigh, 900 N/m")):
        answer = CliRunner().invoke(app, ["show", str(written(tmp_path, text)), "--stage", "mechanism"])
        assert wanted in answer.output


def test_what_never_goes_slack_is_built(tmp_path):
    """As is what nobody can know: joints without limits."""
    options = BuildOptions(functions=("spring_length",))
    assert generate(written(tmp_path, TEXT.replace("free_length = 0.1", "free_length = 0.05")), options).functions
    unlimited = TEXT.replace("limits_deg = [-40, 40], ", "").replace("free_length = 0.1", "free_length = 0.9")
    assert generate(written(tmp_path, unlimited), options).functions

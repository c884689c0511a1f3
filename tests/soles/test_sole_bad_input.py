"""What is wrong with a curved sole is said with its code, its place and how to mend it."""

import pytest
from rolling_robots import CURVES, LEG
from typer.testing import CliRunner

from symbolic.dynamic_legs import written
from walkgen.cli import app
from walkgen.errors import SpecError
from walkgen.pipeline import BuildOptions, generate
from walkgen.spec.read import read

TOE = CURVES["ellipse"]
FLAT = "flat = [-0.06, 0.12]"
ANKLE = 'name = "ankle"\ntype = "revolute"\na = 0.0\nalpha_deg = 0'
PARAMETER = "[parameters]\nbig = { value = 0.15, runtime = true }\n\n[leg_designs.leg]\ndh"
BAD = {
    "misspelt": ("WG110", TOE, "toe = { elipse = [0.09, 0.06] }", "ellipse"),
    "one axis": ("WG112", "[0.09, 0.06]", "[0.09]", "semi-axis along y"),
    "one edge": ("WG112", FLAT, "flat = [0.12]", "rear edge"),
    "no coefficient": ("WG112", TOE, "toe = { polynomial = [], end = 0.1 }", "one number"),
    "no point": ("WG112", TOE, "toe = { points = [] }", "one point"),
    "half a point": ("WG112", TOE, "toe = { points = [[0.08]] }", "one point"),
    "axis of no length": ("WG161", "[0.09, 0.06]", "[0.09, 0.0]", "positive"),
    "no depth": ("WG111", "depth = 0.09", "", "depth"),
    "negative depth": ("WG161", "depth = 0.09", "depth = -0.09", "positive"),
    "no flat": ("WG111", FLAT, "", "flat"),
    "crossed flat": ("WG160", FLAT, "flat = [0.12, -0.06]", "rear"),
    "no curve": ("WG111", TOE + "\nheel = { ellipse = [0.05, 0.05], end_deg = 60 }", "", "toe"),
    "empty curve": ("WG111", TOE, "toe = {}", "not given"),
    "two ways": ("WG124", TOE, "toe = { ellipse = [0.09, 0.06], polynomial = [5], end = 0.1 }", "polynomial and ellipse"),
    "x alone": ("WG111", TOE, 'toe = { x = "0.09 - lambda**2", end = 0.1 }', '"y"'),
    "y alone": ("WG111", TOE, 'toe = { y = "0.12 + lambda", end = 0.1 }', '"x"'),
    "no end": ("WG111", TOE, "toe = { polynomial = [5.0] }", '"end"'),
    "end of points": ("WG124", TOE, "toe = { points = [[0.08, 0.16]], end = 0.1 }", "leave end out"),
    "start of a polynomial": ("WG124", TOE, "toe = { polynomial = [5.0], start = 0.01, end = 0.1 }", "leave start out"),
    "end before start": ("WG160", TOE, "toe = { polynomial = [5.0], end = -0.1 }", "beyond"),
    "other names": ("WG141", TOE, 'toe = { x = "0.09 - mu**2", y = "0.12 + lambda", end = 0.1 }', "mu"),
    "lambda elsewhere": ("WG141", "depth = 0.09", 'depth = "0.09 + lambda"', "lambda"),
    "no arithmetic": ("WG114", TOE, 'toe = { x = "__import__(lambda)", y = "0.12 + lambda", end = 0.1 }', "allowed"),
    "no value": (
        "WG164",
        TOE,
        'toe = { x = "0.09 - lambda**2", y = "0.12 + sqrt(0.05 - lambda) - sqrt(0.05) + 2*lambda", end = 0.1 }',
        "mend",
    ),
    "not regular": ("WG231", TOE, 'toe = { x = "0.09 - lambda**6", y = "0.12 + lambda**3", end = 0.1 }', "does not move"),
    "point twice": ("WG231", TOE, "toe = { points = [[0.08, 0.16], [0.08, 0.16]] }", "apart"),
    "point on the edge": ("WG231", TOE, "toe = { points = [[0.09, 0.12]] }", "apart"),
    "away from the edge": ("WG232", TOE, 'toe = { x = "0.09 - lambda**2", y = "0.13 + lambda", end = 0.1 }', "edge"),
    "not tangent": ("WG232", TOE, 'toe = { x = "0.09 - lambda**2 - lambda/10", y = "0.12 + lambda", end = 0.1 }', "5.711 degrees"),
    "backward": ("WG232", TOE, 'toe = { x = "0.09 - lambda**2", y = "0.12 - lambda", end = 0.1 }', "180 degrees"),
    "hollow": ("WG233", TOE, "toe = { polynomial = [1.0, -30.0], end = 0.09 }", "not convex"),
    "upwards": ("WG233", TOE, "toe = { polynomial = [-1.0], end = 0.09 }", "not convex"),
    "straight": ("WG233", TOE, "toe = { polynomial = [0.0], end = 0.09 }", "not convex"),
    "half a turn": ("WG233", TOE, "toe = { ellipse = [0.09, 0.06], end_deg = 185 }", "degrees"),
    "two joints": ("WG230", "[[leg_designs.leg.joints]]\n" + ANKLE, "[[chain_designs.leg.joints]]\n" + ANKLE, "hip, a knee and an ankle"),
    "sliding ankle": ("WG230", ANKLE, ANKLE.replace("revolute", "prismatic"), "hip, a knee and an ankle"),
    "flat sole as well": (
        "WG124",
        "[leg_designs.leg.curved_sole]",
        "[leg_designs.leg.sole]\nlength = 0.2\nwidth = 0.1\n[leg_designs.leg.curved_sole]",
        "one",
    ),
    "flat sole of the leg": ("WG124", "mount =", "sole = { length = 0.2, width = 0.1 }\nmount =", "leave"),
    "degrees for radians": ("WG239", FLAT, FLAT + "\nslope = 15", "80"),
    "runtime points": ("WG235", "[leg_designs.leg]\ndh", PARAMETER, "runtime"),
}


@pytest.mark.parametrize("name", BAD)
def test_refused_with_place_and_cure(tmp_path, name):
    code, old, new, says = BAD[name]
    assert old in LEG
    text = LEG.replace(old, new, 1)
    if code == "WG235":
        text = text.replace(TOE, 'toe = { points = [[0.08, "big"]] }')
    path = written(tmp_path, text)
    with pytest.raises(SpecError) as caught:
        read(path)
    problems = [problem for problem in caught.value.problems if problem.code == code]
    assert problems, caught.value
    assert any(says in f"{problem.message} {problem.cure}" for problem in problems), caught.value
    assert all(problem.place is not None for problem in problems)


@pytest.mark.parametrize(
    "toe",
    [
        "{ polynomial = [nan], end = 0.05 }",
        "{ points = [" + ", ".join(f"[{0.09 - 1e-5 * i**2:g}, {0.12 + 0.01 * i:g}]" for i in range(1, 40)) + "] }",
        '{ x = "0.09 - abs(lambda)", y = "0.12 + lambda", end = 0.1 }',
    ],
    ids=("no number", "too many points", "no function"),
)
def test_a_curve_that_is_given_badly_is_not_missing(tmp_path, toe):
    with pytest.raises(SpecError) as caught:
        read(written(tmp_path, LEG.replace(TOE, f"toe = {toe}")))
    assert "WG111" not in {problem.code for problem in caught.value.problems}


@pytest.mark.parametrize("name", ["not regular", "not tangent", "hollow", "no curve"])
def test_from_the_command_line(tmp_path, name):
    """Exit code 2, the file, the line, the cure; no traceback."""
    code, old, new, says = BAD[name]
    path = written(tmp_path, LEG.replace(old, new, 1))
    for command in ("check", "build", "gait"):
        result = CliRunner().invoke(app, [command, str(path)])
        assert result.exit_code == 2
        assert f"{path.name}:" in result.output
        assert code in result.output
        assert says in result.output
        assert "Traceback" not in result.output


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("a = 0.42\nalpha_deg = 0", "a = 0.42\nalpha_deg = 90", "hip and knee are not parallel"),
        ("foot = { xyz = [0.0, 0.0, 0.0] }", "foot = { rpy_deg = [90, 0, 0] }", "ankle and foot frame are not parallel"),
        ("mount = { rpy_deg = [90, 0, 0] }", "mount = { rpy_deg = [60, 0, 0] }", "not level"),
    ],
)
def test_axes_must_be_parallel(tmp_path, old, new, says):
    assert old in LEG
    with pytest.raises(SpecError, match="WG234") as caught:
        generate(written(tmp_path, LEG.replace(old, new, 1)), BuildOptions(functions=("link_angles",)))
    assert says in str(caught.value)


@pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)
def test_all_ways_are_read(tmp_path, curve):
    sole = read(written(tmp_path, LEG.replace(TOE, curve))).leg_designs["leg"].curved_sole
    assert sole is not None
    assert sole.toe is not None

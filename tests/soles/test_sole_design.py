"""The design of a sole: the theory's example of 8.6, exact slopes, the example's optimum reached, the front, the command's files."""

import base64
import json

import numpy as np
import pytest
from rolling_robots import SPECS
from typer.testing import CliRunner

from walkgen.cli import app
from walkgen.design.multistart import solved
from walkgen.design.sole_problem import SoleProblem
from walkgen.design.sole_report import sole_report
from walkgen.design.sole_roll import QUANTITIES, SoleRoll
from walkgen.design.sole_search import DENSE, SoleDesigned, SolePoint, sole_designed
from walkgen.designing import files, reported
from walkgen.errors import SpecError
from walkgen.spec.read import read

SPEC = SPECS / "anthropomorphic_leg_poly.toml"
TEXT = SPEC.read_text(encoding="utf-8")
PEAKS = ("foot_acceleration", "foot_rate", "hip_moment", "knee_moment", "ankle_moment")
EXAMPLE = {
    "base": ((0.42, 0.42, 0.09, 0.12, 5.0, 0.0), (28.5728, 4.3976, 98.857, 137.812, 81.390), -125.05),
    "sole_only": ((0.42, 0.42, 0.0974467, 0.159562, 0.807719, 13.8747), (21.5216, 3.5730, 61.409, 100.363, 127.849), -116.59),
    "DE": ((0.362612, 0.442345, 0.117562, 0.159729, 0.892033, 9.07687), (18.1559, 3.0625, 60.336, 93.527, 129.552), -112.28),
    "best": ((0.36, 0.439761, 0.119998, 0.16, 0.5, 11.7277), (17.6890, 3.0243, 59.744, 92.673, 130.896), -112.42),
}
"""Theory 8.6 and its clarifications: variables, largest values, the foot's angle at the end."""
GIVEN = 17.7


@pytest.fixture(scope="module")
def roll():
    return SoleRoll(read(SPEC), "toe_off", SPEC.parent)


@pytest.mark.parametrize("design", EXAMPLE)
def test_the_example(roll, design):
    x, peaks, end = EXAMPLE[design]
    course = roll.at(np.array(x), DENSE)
    # the table's parameters have six digits
    assert [course.peak(quantity) for quantity in PEAKS] == pytest.approx(peaks, rel=2e-5)
    assert np.degrees(course.of("foot_angle").values[-1]) == pytest.approx(end, abs=6e-3)


def test_take_off_is_smooth(roll):
    course = roll.at(roll_start(roll), DENSE)
    assert abs(course.of("foot_rate").values[0]) < 1e-12
    assert abs(course.of("foot_acceleration").values[0]) < 1e-9
    assert (np.diff(course.of("contact").values) > 0).all()


def roll_start(roll):
    return SoleProblem(roll).start()


def test_slopes_by_differences(roll):
    random = np.random.default_rng(1)
    low, high = (np.array([getattr(variable, key) for variable in roll.variables]) for key in ("low", "high"))
    for x in (roll_start(roll), np.array(EXAMPLE["DE"][0]), roll_start(roll) + 0.05 * random.uniform(-1, 1, 6) * (high - low)):
        course = roll.at(x)
        for number in range(len(x)):
            step = np.zeros(len(x))
            step[number] = 1e-6 * (high - low)[number]
            slopes = (roll.at(x + step).values - roll.at(x - step).values) / (2 * step[number])
            size = np.abs(slopes).max(axis=1) + 1e-3 / (high - low)[number]
            assert (np.abs(slopes - course.slopes[:, :, number]).max(axis=1) / size).max() < 1e-6
        assert course.slopes.shape == (len(QUANTITIES), roll.table.instants, len(x))


def test_the_example_s_optimum_is_reached_in_its_bounds(roll):
    """From the base design alone: at most 17.7 rad/s^2, judged at 201 instants, and every limit kept."""
    sole = SoleProblem(roll)
    found = solved(sole.problem({"acceleration": 1.0, "moment": 0.0}), starts=0)
    assert found.feasible
    x = found.x[:6]
    course = roll.at(x, DENSE)
    assert course.peak("foot_acceleration") <= GIVEN
    for variable, value in zip(roll.variables, x, strict=True):
        assert variable.low <= value <= variable.high
    assert 0.14 - 1e-6 <= roll.flat_length(x).values[0] <= 0.22 + 1e-6
    assert 0.02 <= course.of("contact").values[-1] < 0.095
    curvature = course.of("curvature").values
    assert 1.0 - 1e-6 <= curvature.min() <= curvature.max() <= 40.0 + 1e-6
    assert course.of("extension").values.max() <= 0.985 + 1e-6
    assert np.degrees(course.of("knee").values.min()) >= 5.0 - 1e-4
    assert course.of("contact_rate").values.min() >= -1e-6


def test_the_whole_curve_must_bulge_and_hold_the_roll(roll, tmp_path):
    """Also what the roll does not use: else the spec that is written would be refused."""
    free = tmp_path / "free.toml"
    free.write_text(TEXT.replace("used = [0.02, 0.095]\n", ""), encoding="utf-8")
    sole = SoleProblem(SoleRoll(read(free), "toe_off", tmp_path))
    limits = {limit.name: limit.margins for limit in sole.problem({"acceleration": 1.0, "moment": 1.0}).constraints}
    bounded = SoleProblem(roll).problem({"acceleration": 1.0, "moment": 1.0}).constraints
    assert {limit.name for limit in bounded} == {*limits, "used"} - {"end"}  # one of them is enough
    hollow, beyond, good = (np.array(x) for x in ((0.42, 0.46, 0.06, 0.08, 20.0, -95.7), EXAMPLE["best"][0], EXAMPLE["DE"][0]))
    for x, broken in ((hollow, "convex"), (beyond, "end"), (good, "")):
        wide = np.concatenate([x, [100.0, 500.0]])
        assert [name for name in ("convex", "end") if limits[name](wide).values.min() < 0.0] == ([broken] if broken else [])
        step = 1e-6 * np.maximum(1.0, np.abs(wide))
        for number in range(len(x)):
            there = np.eye(len(wide))[number] * step[number]
            for name in ("convex", "end"):
                slopes = (limits[name](wide + there).values - limits[name](wide - there).values) / (2 * step[number])
                assert np.abs(slopes - limits[name](wide).slopes[:, number]).max() < 1e-6 * (1.0 + np.abs(slopes).max())
        path = tmp_path / "found.toml"
        point = SolePoint(x, roll.at(x, DENSE))
        path.write_text(dict(files(SPEC, SoleDesigned(roll, point, point, (point,)), path, None, None))[path], encoding="utf-8")
        if broken == "convex":
            with pytest.raises(SpecError, match="WG233"):
                read(path)
        else:
            read(path)


def small(tmp_path, more=""):
    """The spec with a small search."""
    path = tmp_path / "spec.toml"
    path.write_text(TEXT.replace("knee_deg = 5\n", f"knee_deg = 5\ninstants = 21\nstarts = 1\nfront = 3\n{more}"), encoding="utf-8")
    return path


def drawn(page):
    """The lines of a page by name: x and y of each, in order."""
    start = page.index("[", page.index("Plotly.newPlot("))
    traces, _ = json.JSONDecoder().raw_decode(page[start:])
    numbers = [[_numbers(trace[axis]) for axis in "xy"] for trace in traces]
    return [(trace["name"], *both) for trace, both in zip(traces, numbers, strict=True)]


def _numbers(entry):
    return np.array(entry) if isinstance(entry, list) else np.frombuffer(base64.b64decode(entry["bdata"]), entry["dtype"])


def test_plots_show_the_sole_the_acceleration_and_the_moments(roll, tmp_path):
    points = [SolePoint(np.array(EXAMPLE[name][0]), roll.at(np.array(EXAMPLE[name][0]), DENSE)) for name in ("best", "base")]
    found = SoleDesigned(roll, points[1], points[0], tuple(points))
    lines = drawn(next(files(SPEC, found, None, tmp_path / "a.html", None))[1])
    for words, point in (("found", points[0]), ("as in the spec", points[1])):
        (forward, up), (times, turning) = (line[1:] for line in lines if line[0] == words and len(line[1]) > 1)
        assert np.abs(turning - point.course.of("foot_acceleration").values).max() == 0.0
        assert (times[0], times[-1]) == (0.0, 0.25)
        front, depth = point.x[3], point.x[2]
        assert np.abs(up[(forward > -0.0601) & (forward < front + 1e-4)] + depth).max() < 1e-7
        assert forward.max() > front + 0.02
        for joint in ("hip", "knee", "ankle"):
            ((_, moment),) = (line[1:] for line in lines if line[0] == f"{joint}, {words}")
            assert np.abs(moment - point.course.of(f"{joint}_moment").values).max() == 0.0
    ((accelerations, moments),) = (line[1:] for line in lines if line[0] == "front")
    assert accelerations == pytest.approx([17.6890, 28.5728], rel=1e-4)
    assert (np.diff(moments) < 0).all()


def test_the_spec_that_is_written_builds(roll, built, tmp_path):
    """And rolls as the design says: the largest acceleration by the generated code over the course's instants."""
    chosen = SolePoint(np.array(EXAMPLE["DE"][0]), roll.at(np.array(EXAMPLE["DE"][0]), DENSE))
    written = dict(files(SPEC, SoleDesigned(roll, chosen, chosen, (chosen,)), tmp_path / "found.toml", None, None))[tmp_path / "found.toml"]
    wanted = "'flat_motion', 'toe_motion', 'stance_forces_load'"
    leg = built(f"{written}\n[generate]\nfunctions = [{wanted}]\ntargets = ['c', 'numpy']\n").c.legs["leg"]
    times = chosen.course.times
    hip = np.zeros((len(times), 3, 2))
    hip[:, 0], hip[:, 1] = np.stack([0.16 + 0.8 * times, np.full(len(times), 0.80)], -1), [0.8, 0.0]
    thigh = quintic(leg.flat_motion(hip[0], 0.0, 1)[0][:, 0], (np.radians(-80.0), 0.5, 0.0), times)
    contact, angles, point, ankle, _, status = leg.toe_motion(hip, thigh, chosen.x[3])
    assert (status == 0).all()
    assert np.abs(contact[:, 0] - chosen.course.of("contact").values).max() < 1e-9
    assert np.abs(angles[:, 2, 2]).max() == pytest.approx(18.1559, rel=2e-5)
    by_differences = (angles[2:, 1, 2] - angles[:-2, 1, 2]) / (times[2:] - times[:-2])
    assert np.abs(by_differences - angles[1:-1, 2, 2]).max() < 0.01 * 18.16
    torque = leg.stance_forces_load(hip, angles, (0.0, -500.0), point[:, 0] - ankle[:, 0, 0], 0.6)[0]
    assert np.abs(torque).max(axis=0) == pytest.approx(
        [chosen.course.peak(f"{joint}_moment") for joint in ("hip", "knee", "ankle")], rel=1e-9
    )


def quintic(start, end, times):
    """Value, rate and acceleration [n,3] between those of both ends."""
    span = times[-1]
    powers = np.array(
        [
            [np.prod(np.arange(k, k - d, -1)) * t ** max(k - d, 0) if k >= d else 0.0 for k in range(6)]
            for t in (0.0, span)
            for d in range(3)
        ]
    )
    course = np.polynomial.Polynomial(np.linalg.solve(powers, [*start, *end]))
    return np.stack([course(times), course.deriv()(times), course.deriv(2)(times)], -1)


def test_files(roll, tmp_path):
    """Of designs that the theory gives: the page, the picture, the spec that reads back as what was found."""
    points = [SolePoint(np.array(EXAMPLE[name][0]), roll.at(np.array(EXAMPLE[name][0]), DENSE)) for name in ("best", "DE", "base")]
    found = SoleDesigned(roll, points[2], points[0], tuple(points))
    written = dict(files(SPEC, found, tmp_path / "found.toml", None, None))
    (tmp_path / "found.toml").write_text(written[tmp_path / "found.toml"], encoding="utf-8")
    again = SoleRoll(read(tmp_path / "found.toml"), "toe_off", tmp_path)
    assert np.array_equal(roll_start(again), points[0].x)
    assert next(files(SPEC, found, None, tmp_path / "a.png", None))[1].startswith(b"\x89PNG")
    page = next(files(SPEC, found, None, tmp_path / "a.html", None))[1]
    assert "anthropomorphic_leg_poly: sole toe_off" in page
    text = reported(found)
    assert "17.689" in text
    assert text.splitlines()[-1].split()[:2] == ["28.573", "81.39"]
    with pytest.raises(SpecError, match="no cam"):
        next(files(SPEC, found, None, None, tmp_path / "a.csv"))


@pytest.mark.nightly
def test_front_files_and_spec(tmp_path):
    path = small(tmp_path)
    out, png, page = (tmp_path / name for name in ("found.toml", "found.png", "found.html"))
    result = CliRunner().invoke(app, ["design", str(path), "--sole", "toe_off", "-o", str(out), "--plot", str(png), "--starts", "1"])
    assert result.exit_code == 0, result.output
    assert "front:" in result.output
    assert png.read_bytes().startswith(b"\x89PNG")
    roll = SoleRoll(read(out), "toe_off", out.parent)
    before = SoleRoll(read(path), "toe_off", path.parent)
    written = roll.at(roll_start(roll), DENSE).peak("foot_acceleration")
    assert written < 0.65 * before.at(roll_start(before), DENSE).peak("foot_acceleration")
    assert f"{written:.5g}" in result.output
    assert not page.exists()


@pytest.mark.nightly
def test_the_whole_front(tmp_path):
    found = sole_designed(SPEC, "toe_off")
    peaks = np.array([[point.peak(name) for name in ("acceleration", "moment")] for point in found.front])
    assert len(peaks) >= 5
    assert (np.diff(peaks[:, 0]) > 0).all()
    assert (np.diff(peaks[:, 1]) < 0).all()
    assert peaks[0, 0] <= GIVEN
    assert peaks[-1, 1] < 60.0
    path = tmp_path / "found.toml"
    for point in found.front:
        assert point.course.of("contact").values[-1] < 0.095
        one = SoleDesigned(found.roll, found.given, point, (point,))
        path.write_text(dict(files(SPEC, one, path, None, None))[path], encoding="utf-8")
        again = SoleRoll(read(path), "toe_off", tmp_path)
        assert np.array_equal(roll_start(again), point.x)
    from walkgen.design.sole_page import sole_page

    assert sole_report(found).splitlines()[0] == "found:"
    assert "front" in sole_page(found)


BAD = {
    "no leg": ("WG210", 'leg = "leg"', 'leg = "lge"', "leg"),
    "no thigh": ("WG111", "thigh_deg = -80", "", "thigh_deg"),
    "no hip": ("WG111", "hip = [0.16, 0.80]", "", "hip"),
    "crossed": ("WG160", "used = [0.02, 0.095]", "used = [0.095, 0.02]", "least"),
    "no time": ("WG161", "duration = 0.25", "duration = 0.0", "positive"),
    "unknown": ("WG141", "knee_deg = 5", 'knee_deg = 5\nvary = ["c4"]', "c4"),
    "no toe": ("WG236", 'toe = { polynomial = ["c2", "c3"], end = 0.095 }', "", "toe"),
    "negative weight": ("WG161", "knee_deg = 5", "knee_deg = 5\nweights = { moment = -1 }", "negative"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_tables(tmp_path, name):
    code, old, new, says = BAD[name]
    assert old in TEXT
    path = tmp_path / "spec.toml"
    path.write_text(TEXT.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SpecError) as caught:
        read(path)
    problems = [problem for problem in caught.value.problems if problem.code == code]
    assert any(says in f"{problem.message} {problem.cure}" for problem in problems), caught.value


def test_bad_requests():
    run = CliRunner().invoke
    for arguments, code in (
        (["design", str(SPEC), "--sole", "toe_of"], "WG237"),
        (["design", str(SPECS / "anthropomorphic_leg.toml"), "--sole", ""], "WG237"),
        (["design", str(SPEC), "--sole", "", "--balance", "x"], "WG219"),
    ):
        result = run(app, arguments)
        assert result.exit_code == 2
        assert code in result.output


@pytest.mark.nightly
def test_no_sole_within_the_bounds(tmp_path):
    path = tmp_path / "spec.toml"
    narrow = TEXT.replace("used = [0.02, 0.095]", "used = [0.001, 0.002]\nstarts = 1\ninstants = 11")
    path.write_text(narrow, encoding="utf-8")
    with pytest.raises(SpecError, match="used"):
        sole_designed(path, "", starts=1)

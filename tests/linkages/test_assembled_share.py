"""How much of the drives' limits a linkage assembles in: shown, and refused where it is nothing."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from walkgen.cli import app
from walkgen.errors import SpecError
from walkgen.examine import coverage_of
from walkgen.pipeline import BuildOptions, generate, mechanism_of
from walkgen.show import show

SPECS = Path(__file__).parents[2] / "specs"
TEXT = """
walkgen = 1
robot = {{ name = "bars", gravity = [0, -9.81, 0] }}
generate = {{ functions = ["foot_position"] }}
platforms = [{{ name = "body" }}]
legs = [{{ name = "one", design = "leg", platform = "body" }}, {{ name = "two", mirror_of = "one" }}]
[parameters]
rod = {{ value = 0.3, runtime = true }}
[leg_designs.leg]
four_bar = {{ ground = 0.5, crank = 0.2, coupler = 0.1, rocker = "rod", foot = [0, 0], drive = {{ limits_deg = {limits} }} }}
"""

EDGE = math.acos((0.5**2 + 0.2**2 - 0.4**2) / (2 * 0.5 * 0.2))
"""Of the crank: there B is coupler + rocker from D."""


def spec(folder, limits):
    path = folder / "bars.toml"
    path.write_text(TEXT.format(limits=limits), encoding="utf-8")
    return path


def test_share_of_a_four_bar_by_the_law_of_cosines(tmp_path):
    """It closes while B is no more than coupler + rod from D."""
    mechanism = mechanism_of(spec(tmp_path, "[0, 90]"))
    wanted = int((np.linspace(0, math.pi / 2, 441) <= EDGE).sum())
    for leg in mechanism.legs:
        found = coverage_of(mechanism, leg, leg.linkage)
        assert (found.points, found.assembled, found.limited) == (441, wanted, True)
        (failure,) = found.failing
        assert (failure.group, failure.count) == ("c", 441 - wanted)
        assert failure.low == pytest.approx([math.pi / 2 * wanted / 440])
        assert failure.high == pytest.approx([math.pi / 2])


def test_show_says_the_share_and_what_fails(tmp_path):
    assert "assembles in 55 % of the drives' limits; dyad c cannot close in 45 %" in show(spec(tmp_path, "[0, 90]"), "mechanism", "")
    assert "assembles in 0 % of the drives' limits; dyad c cannot close in 100 %" in show(spec(tmp_path, "[150, 210]"), "mechanism", "")
    assert "assembles in 100 % of the drives' limits\n" in show(SPECS / "odex.toml", "mechanism", "")
    assert "assembles" not in show(SPECS / "minitaur.toml", "mechanism", "")  # its motors have no limits


def test_the_share_of_the_hydraulic_leg_is_that_of_its_triangles():
    """Lift: E, I, G; knee: J, L, H: each closes while its cylinder is within sum and difference of two sides."""
    mechanism = mechanism_of(SPECS / "hydraulic_leg.toml")
    leg = mechanism.legs[0]
    found = coverage_of(mechanism, leg, leg.linkage)
    triangles = {
        "lift": (math.hypot(0.27, 0.11), math.hypot(0.0435, 0.1118)),
        "knee": (math.hypot(0.35 - 0.0607, 0.0795), math.hypot(0.04, 0.0993)),
    }
    lengths = np.linspace(0.25, 0.45, 21)
    closes = {name: ((abs(a - b) <= lengths) & (lengths <= a + b)).sum() for name, (a, b) in triangles.items()}
    assert found.assembled == closes["lift"] * closes["knee"]
    assert found.points == 441
    assert {each.group: each.count for each in found.failing}["lift"] == (21 - closes["lift"]) * 21


def test_a_linkage_that_assembles_nowhere_is_refused(tmp_path):
    with pytest.raises(SpecError, match=r"WG189.*0 %.*dyad c cannot close") as error:
        generate(spec(tmp_path, "[150, 210]"), BuildOptions(targets=("c",)))
    (problem,) = error.value.problems
    assert problem.place.source == "[leg_designs.leg]"


def test_a_part_of_the_limits_is_a_notice(tmp_path):
    path, notices = spec(tmp_path, "[0, 90]"), []
    generate(path, BuildOptions(targets=("c",)), notice=notices.append)
    (notice,) = notices
    assert notice.code == "WG192"
    first = next(angle for angle in np.linspace(0, math.pi / 2, 441) if angle > EDGE)
    wanted = f"assembles in 55 % of its drives' limits; dyad c cannot close in 45 % (crank {first:.4g} to 1.571 rad)"
    assert str(notice).count("\n") == 0
    assert wanted in str(notice)
    assert f"{path}:9:" in str(notice)
    notices.clear()
    generate(spec(tmp_path, "[0, 40]"), BuildOptions(targets=("c",)), notice=notices.append)
    assert not notices


def test_the_command_says_it_and_goes_on(tmp_path):
    path = spec(tmp_path, "[0, 90]")
    for form, said in (("text", "1 spec without a problem\n"), ("json", "[]\n")):
        answer = CliRunner().invoke(app, ["check", str(path), "--format", form])
        assert (answer.exit_code, answer.stdout) == (0, said)
        assert answer.stderr.count("WG192  notice: leg_designs.leg: the linkage assembles in 55 %") == 1
    answer = CliRunner().invoke(app, ["build", str(path), "-o", str(tmp_path / "made"), "--targets", "numpy"])
    assert answer.exit_code == 0
    assert answer.stderr.count("WG192") == 1
    refused = CliRunner().invoke(app, ["check", str(spec(tmp_path, "[150, 210]")), "--format", "json"])
    assert refused.exit_code == 2
    assert [problem["code"] for problem in json.loads(refused.stdout)] == ["WG189"]

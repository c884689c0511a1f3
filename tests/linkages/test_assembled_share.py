"""How much of the drives' limits a linkage assembles in: shown, and refused where it is nothing."""

import math
from pathlib import Path

import numpy as np
import pytest

from walkgen.errors import SpecError
from walkgen.pipeline import BuildOptions, coverage_of, generate, mechanism_of
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


def spec(folder, limits):
    path = folder / "bars.toml"
    path.write_text(TEXT.format(limits=limits), encoding="utf-8")
    return path


def test_share_of_a_four_bar_by_the_law_of_cosines(tmp_path):
    """It closes while B is no more than coupler + rod from D."""
    mechanism = mechanism_of(spec(tmp_path, "[0, 90]"))
    edge = math.acos((0.5**2 + 0.2**2 - 0.4**2) / (2 * 0.5 * 0.2))
    wanted = int((np.linspace(0, math.pi / 2, 441) <= edge).sum())
    for leg in mechanism.legs:
        found = coverage_of(mechanism, leg)
        assert (found.points, found.assembled, found.failing) == (441, wanted, (("c", 441 - wanted),))


def test_show_says_the_share_and_what_fails(tmp_path):
    assert "assembles in 55 % of the drives' limits; dyad c cannot close in 45 %" in show(spec(tmp_path, "[0, 90]"), "mechanism", "")
    assert "assembles in 0 % of the drives' limits; dyad c cannot close in 100 %" in show(spec(tmp_path, "[150, 210]"), "mechanism", "")
    assert "assembles in 100 % of the drives' limits\n" in show(SPECS / "odex.toml", "mechanism", "")
    assert "assembles" not in show(SPECS / "minitaur.toml", "mechanism", "")  # its motors have no limits


def test_the_share_of_the_hydraulic_leg_is_that_of_its_triangles():
    """Lift: E, I, G; knee: J, L, H: each closes while its cylinder is within sum and difference of two sides."""
    mechanism = mechanism_of(SPECS / "hydraulic_leg.toml")
    found = coverage_of(mechanism, mechanism.legs[0])
    triangles = {
        "lift": (math.hypot(0.27, 0.11), math.hypot(0.0435, 0.1118)),
        "knee": (math.hypot(0.35 - 0.0607, 0.0795), math.hypot(0.04, 0.0993)),
    }
    lengths = np.linspace(0.25, 0.45, 21)
    closes = {name: ((abs(a - b) <= lengths) & (lengths <= a + b)).sum() for name, (a, b) in triangles.items()}
    assert found.assembled == closes["lift"] * closes["knee"]
    assert found.points == 441
    assert dict(found.failing)["lift"] == (21 - closes["lift"]) * 21


def test_a_linkage_that_assembles_nowhere_is_refused(tmp_path):
    with pytest.raises(SpecError, match=r"WG189.*0 %.*dyad c cannot close") as error:
        generate(spec(tmp_path, "[150, 210]"), BuildOptions(targets=("c",)))
    (problem,) = error.value.problems
    assert problem.place.source == "[leg_designs.leg]"

"""Freedoms by rank beside those by count: equal in general, different for dimensions that make pairs repeat each other."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkages.closure import Closure
from linkages.topologies import TOPOLOGIES, spec
from walkgen.errors import SpecError
from walkgen.examine import coverage_of
from walkgen.model.assemble import assemble
from walkgen.pipeline import BuildOptions, generate, mechanism_of
from walkgen.show import show
from walkgen.spec.assur import order
from walkgen.spec.mobility import free_linkage
from walkgen.spec.read import read

SPECS = Path(__file__).parents[2] / "specs"
HEAD = """
walkgen = 1
robot = { name = "bars", gravity = [0, -9.81, 0] }
generate = { functions = ["foot_position"] }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
[leg_designs.leg]
"""
PARALLELOGRAM = HEAD + "parallelogram = { ground = 0.3, crank = 0.1, foot = [0.1, -0.2], drive = { limits_deg = [20, 160] } }"
THIRD = """
[[leg_designs.leg.pins]]
joins = ["frame.E", "third.E"]
[[leg_designs.leg.pins]]
joins = ["coupler.F", "third.F"]
[leg_designs.leg.links]
frame = { points = { E = [0.15, 0] } }
coupler = { points = { F = [0.15, HEIGHT] } }
third = { points = { E = [0, 0], F = [0.1, 0] } }
"""
TRUSS = """
[[leg_designs.leg.pins]]
joins = ["frame.E", "stay.E"]
[[leg_designs.leg.pins]]
joins = ["frame.F", "prop.F"]
[[leg_designs.leg.pins]]
name = "g"
joins = ["stay.G", "prop.G"]
[leg_designs.leg.links]
frame = { points = { E = [0, -0.2], F = [0.3, -0.2] } }
stay = { points = { E = [0, 0], G = [0.125, 0] } }
prop = { points = { F = [0, 0], G = [LENGTH, 0] } }
"""


def written(folder, text):
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", TOPOLOGIES)
def test_in_general_the_rank_is_the_count(tmp_path, name):
    """The slopes of the pairs' equations are those of the tests' own closure, whose rows of the drives fix what is left."""
    mechanism = assemble(read(written(tmp_path, spec(name, ("foot_position",)))), tmp_path)
    linkage, random = mechanism.legs[0].linkage, np.random.default_rng(3)
    dimensions, drives = TOPOLOGIES[name].draw(random, 1)
    values = dict(zip(TOPOLOGIES[name].parameters, dimensions[0], strict=True))
    loops = free_linkage(linkage.structure, linkage.points, linkage.angles, lambda scalar: number(scalar, values))
    x = random.uniform(-1, 1, loops.unknowns)
    slopes = loops.equations(x)[1]
    steps = 1e-6 * np.eye(loops.unknowns)
    change = np.stack([(loops.equations(x + step)[0] - loops.equations(x - step)[0]) / 2e-6 for step in steps], -1)
    scales = np.where(np.arange(loops.unknowns) % 3 == 2, loops.size, 1.0)
    scales[len(scales) - len(linkage.structure.bars) :] = 1.0
    assert np.abs(change / scales - slopes).max() < 1e-8
    assert loops.mobility(x).freedoms == linkage.structure.mobility == linkage.drive_count
    closure = Closure(spec(name, ()), dimensions, drives)
    assert closure.size + len(linkage.structure.bars) * 3 == loops.unknowns - len(linkage.structure.bars)


def number(scalar, values):
    return float(getattr(scalar, "value", None) if hasattr(scalar, "value") else values[scalar.name])


@pytest.mark.parametrize("name", ["hydraulic_leg", "odex", "bessonov", "garrec", "pantograph", "minitaur"])
def test_shipped_linkages_have_the_freedoms_of_their_count(name):
    mechanism = mechanism_of(SPECS / f"{name}.toml")
    leg = mechanism.legs[0]
    found = coverage_of(mechanism, leg, leg.linkage)
    assert found.mobility.freedoms == leg.linkage.structure.mobility
    assert found.mobility.pairs == ()


def test_show_prints_both():
    words = r"(\d) degrees of freedom in its plane by count.*?(\d) degrees of freedom by the rank"
    text = show(SPECS / "hydraulic_leg.toml", "mechanism", "")
    assert re.search(words, text, re.DOTALL).groups() == ("2", "2")


def test_a_parallelogram_with_a_third_bar_moves_though_the_count_denies_it(tmp_path):
    with pytest.raises(SpecError, match="WG191") as error:
        read(written(tmp_path, PARALLELOGRAM + THIRD.replace("HEIGHT", "0")))
    (problem,) = error.value.problems
    assert "3 (5 - 1) - 2 * 6 = 0 degrees of freedom" in problem.message
    assert "leaves 1: " in problem.message
    assert {"e", "f", "b", "c"} <= set(re.findall(r"\b[a-f]\b", problem.message.partition("leaves 1: ")[2]))


def test_where_the_third_bar_does_not_fit_the_count_is_right(tmp_path):
    with pytest.raises(SpecError, match="WG183"):
        read(written(tmp_path, PARALLELOGRAM + THIRD.replace("HEIGHT", "0.02")))


def test_a_dyad_that_is_always_stretched_is_refused(tmp_path):
    """Two bars as long as the way between their pins on the frame: the pin between them can move across, to first order."""
    path = written(tmp_path, PARALLELOGRAM + TRUSS.replace("LENGTH", "0.175"))
    with pytest.raises(SpecError, match="WG191") as error:
        generate(path, BuildOptions(targets=("c",)))
    (problem,) = error.value.problems
    assert "1 degrees of freedom by count, 2 by the rank" in problem.message
    assert "e, f, g say one thing twice" in problem.message
    text = show(path, "mechanism", "")
    assert "1 degrees of freedom in its plane by count" in text
    assert "2 degrees of freedom by the rank" in text
    assert "e, f, g say one thing twice" in text
    generate(written(tmp_path, PARALLELOGRAM + TRUSS.replace("LENGTH", "0.2")), BuildOptions(targets=("c",)))


def test_pins_that_coincide_leave_no_pose_to_count_at(tmp_path):
    drive = "{ limits_deg = [10, 10] }"
    path = written(tmp_path, f"{HEAD}five_bar = {{ ground = 0, cranks = [0.1, 0.1], couplers = [0.2, 0.2], drives = [{drive}, {drive}] }}")
    mechanism = mechanism_of(path)
    leg = mechanism.legs[0]
    assert coverage_of(mechanism, leg, leg.linkage).mobility is None
    assert "by the rank" not in show(path, "mechanism", "")
    generate(path, BuildOptions(targets=("c",)))


def test_a_pin_called_foot_holds_none():
    """Only what pins the foot to the frame lets a pantograph place two sliders at once."""
    path = SPECS / "pantograph.toml"
    linkage = assemble(read(path), path.parent).legs[0].linkage
    free = tuple(replace(pair, name="foot", driven=False) for pair in linkage.structure.pairs)
    assert "pantograph" in {group.kind for group in linkage.inverse.groups}
    assert "pantograph" not in {group.kind for group in order(replace(linkage.structure, pairs=free)).groups}

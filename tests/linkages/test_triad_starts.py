"""Which group is found where, and which of its assemblies a start takes."""

import numpy as np
import pytest

from linkages.topologies import STEPHENSON_2, TRIADS, spec
from walkgen.examine import examined
from walkgen.model.assemble import assemble
from walkgen.show import show
from walkgen.spec.read import read
from walkgen.symbolic.starts import found_start

FOUND = {
    "stephenson_2": ("coupler", "frame coupler", "rocker near far"),
    "loop_of_four": ("coupler", "coupler rocker", "frame near far"),
    "three_cylinders": ("plate", "frame plate", "one two three"),
    "plate_on_sliders": ("plate", "frame plate", "block shoe sled"),
    "cross_slide": ("plate", "frame plate", "cross rod bar"),
    "cross_slide_loop": ("coupler", "coupler rocker", "frame cross near"),
    "two_cranks": ("plate", "frame plate", "one two tie"),
    "hung_triad": ("hand", "arm hand", "near tie far"),
}
"""Name, ends and struts."""
HEAD = """
walkgen = 1
robot = { name = "walker", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "leg", platform = "body" }]
[leg_designs.leg]
"""


def mechanism_of(folder, text):
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return assemble(read(path), folder)


@pytest.mark.parametrize("name", TRIADS)
def test_the_group_and_its_kind(tmp_path, name):
    linkage = mechanism_of(tmp_path, spec(name, ("foot_position",))).legs[0].linkage
    names, (triad,) = linkage.structure.names, linkage.forward.triads
    wanted, ends, struts = FOUND[name]
    assert triad.name == wanted
    assert {names[body] for body in triad.ends} == set(ends.split())
    assert {names[strut.body] for strut in triad.struts} == set(struts.split())
    assert len(linkage.forward.clusters) == 1


def start(folder, given):
    mechanism = mechanism_of(folder, HEAD + given + STEPHENSON_2)
    return found_start(mechanism, mechanism.legs[0])


def test_hints_choose_the_assembly(tmp_path):
    """By an angle or a point; without hints the one farthest from a dead point is taken."""
    plain = start(tmp_path, "start = { drives_deg = [10] }")
    assert float(plain.drives[0]) == pytest.approx(np.deg2rad(10), abs=1e-15)
    assert len(plain.modes) == 4
    assert [one.sine for one in plain.modes] == sorted((one.sine for one in plain.modes), reverse=True)
    for wanted in plain.modes[1:3]:
        hinted = start(tmp_path, f"start = {{ drives_deg = [10], angles_deg = {{ coupler = {wanted.degrees[0] + 1} }} }}")
        assert hinted.modes[0].unknowns == pytest.approx(wanted.unknowns, abs=1e-9)
        assert [float(unknown) for unknown in hinted.unknowns] == pytest.approx(wanted.unknowns, abs=1e-9)


@pytest.mark.nightly
def test_points_choose_too(tmp_path):
    """The rocker's far end is on a circle about (0.3, 0): hints around it find the assembly nearest to them, and not always the same."""
    chosen = set()
    for angle in (0.0, 2.1, 4.2):
        at = [0.3 + 0.22 * float(np.cos(angle)), 0.22 * float(np.sin(angle))]
        found = start(tmp_path, f"start = {{ drives = [0.2], points = {{ 'rocker.C' = {at} }} }}").modes
        assert [one.misfit for one in found] == sorted(one.misfit for one in found)
        chosen.add(round(found[0].degrees[0], 6))
    assert len(chosen) > 1


def test_show_lists_them(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(HEAD + STEPHENSON_2, encoding="utf-8")
    text = show(path, "mechanism", "")
    assert "triad coupler  RR" in text
    assert "start at crank = 0: 4 assemblies" in text
    assert text.count("sine of the transmission angle") == 4


def test_a_notice_and_show_name_the_triad(tmp_path):
    path = tmp_path / "robot.toml"
    longer = STEPHENSON_2.replace("crank = 0.06", "crank = 0.12")
    path.write_text(HEAD + longer + "drive = { limits_deg = [-180, 180] }\n", encoding="utf-8")
    text = show(path, "mechanism", "")
    assert "1 degrees of freedom by the rank" in text
    assert "; triad coupler cannot close in" in text
    (notice,) = examined(path, read(path), assemble(read(path), tmp_path))
    assert notice.code == "WG192"
    assert "triad coupler cannot close in" in notice.message

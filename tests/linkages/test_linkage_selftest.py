"""What the self-test of a linkage leg expects: loops closed in 50 digits, beside the theory and the code; what it says of wrong code."""

from pathlib import Path

import numpy as np
import pytest

from linkages.placed import code_of
from linkages.theory import BOXES, FEET
from linkages.topologies import TOPOLOGIES, spec
from walkgen import selftest
from walkgen.emit.artifact import RobotCode
from walkgen.emit.c_files import c_sources
from walkgen.emit.reference import EXPECTED, Sample
from walkgen.emit.samples import apart, samples_of
from walkgen.emit.selftest import selftest_artifact
from walkgen.graph.lower import lower
from walkgen.model.assemble import assemble
from walkgen.model.closing import closed
from walkgen.model.walk import CONTEXT, defaults
from walkgen.spec.read import read
from walkgen.symbolic.derive import derive

SPECS = Path(__file__).parents[2] / "specs"
STEP = CONTEXT.mpf(10) ** -15
FEW = ("moving_guide",)
SLIDER_CRANK = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.8] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "one", platform = "body" }]
[leg_designs.one]
foot = "rod.P"
plane = { rpy_deg = [90, 0, 0] }
assembly = { slide = "SIDE" }
links.frame.points = { A = [0, 0] }
links.block.points = { C = [0, 0] }
links.rod.points = { C = [0, 0], B = [0.4, 0], P = [0.6, 0.1] }
links.crank.points = { A = [0, 0], B = [0.1, 0] }
pins = [{ name = "a", joins = ["frame.A", "crank.A"], driven = true }, { name = "b", joins = ["crank.B", "rod.B"] },
        { name = "c", joins = ["rod.C", "block.C"] }]
sliders = [{ name = "slide", link = "block.C", guide = { link = "frame", point = [0, 0.05], angle_deg = 10 } }]
"""


def mechanism(text, folder):
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return assemble(read(path), folder)


@pytest.mark.parametrize("name", FEET)
def test_loops_close_where_the_theory_puts_the_foot(name):
    robot = assemble(read(SPECS / f"{name}.toml"), SPECS)
    linkage = robot.legs[0].linkage
    for drives in np.random.default_rng(5).uniform(*BOXES[name], (3, len(BOXES[name][0]))):
        posture = closed(linkage, defaults(robot), drives)
        foot = posture.place(linkage.foot[0], posture.loops.planar(linkage.foot[1]))[:2]
        assert np.abs(np.array(foot, float) - FEET[name](*drives)).max() <= 1e-14


@pytest.mark.parametrize("name", [name if name in FEW else pytest.param(name, marks=pytest.mark.nightly) for name in TOPOLOGIES])
def test_closed_by_newton_as_placed_by_dyads(name, tmp_path):
    """Random dimensions; a linkage that Newton's method does not close has a dyad that cannot."""
    text = spec(name, ("foot_position", "assembly_status"))
    code, robot, topology = code_of(text, ("foot_position", "assembly_status"), tmp_path), mechanism(text, tmp_path), TOPOLOGIES[name]
    dimensions, drives = topology.draw(np.random.default_rng(2), 6)
    status = code["leg_assembly_status"](drives, dimensions)
    assert 0 in status
    linkage = robot.legs[0].linkage
    for values, row, foot, state in zip(dimensions, drives, code["leg_foot_position"](drives, dimensions), status, strict=True):
        posture = closed(linkage, dict(zip(defaults(robot), map(CONTEXT.mpf, values), strict=True)), row)
        assert (posture is None) == (state == 1)
        if posture:
            own = posture.place(linkage.foot[0], posture.loops.planar(linkage.foot[1]))[:2]
            assert np.abs(np.array(own, float) - foot[:2]).max() <= 1e-11


def sample(robot, time=0):
    """The leg's first sample, moved along qd by `time`."""
    first = samples_of(robot, (robot.legs[0],))[0]
    q = tuple(value + time * rate for value, rate in zip(first.q, first.qd, strict=True))
    return Sample(robot, first.limbs, q, first.qd, first.qdd, first.f)


@pytest.mark.parametrize("name", ["bessonov", pytest.param("odex", marks=pytest.mark.nightly)])
def test_reference_rates_are_slopes(name):
    robot = assemble(read(SPECS / f"{name}.toml"), SPECS)
    here, ahead, behind = (sample(robot, time) for time in (0, STEP, -STEP))

    def change(function):
        return np.array([(a - b) / (2 * STEP) for a, b in zip(EXPECTED[function](ahead)[0], EXPECTED[function](behind)[0], strict=True)])

    def value(function):
        return np.array(EXPECTED[function](here)[0])

    qd = np.array(here.qd)
    assert np.abs(value("foot_velocity") - change("foot_position")).max() < 1e-20
    hessian = value("foot_hessian").reshape(3, 3, 3)
    assert np.abs(np.tensordot(hessian, qd, 1) - change("foot_jacobian").reshape(3, 3)).max() < 1e-20
    assert np.abs(hessian - np.swapaxes(hessian, 1, 2)).max() == 0
    assert np.abs(value("foot_bias_acceleration") - change("foot_spatial_jacobian").reshape(6, 3) @ qd).max() < 1e-20
    spin, turned = value("foot_spatial_jacobian").reshape(6, 3)[3:] @ qd, value("foot_rotation").reshape(3, 3)
    assert np.abs(np.cross(spin, turned.T).T - change("foot_rotation").reshape(3, 3)).max() < 1e-20


@pytest.mark.nightly
def test_a_sample_far_out_does_not_assemble():
    robot = assemble(read(SPECS / "hydraulic_leg.toml"), SPECS)
    out = apart(samples_of(robot, (robot.legs[0],))[0])
    assert out is not None
    assert min(out[1:]) > 1


def report(robot, functions, folder):
    """Lines of the self-test of this robot with the code of these functions."""
    folder.mkdir()
    programs = tuple(lower(function, True) for function in functions)
    code = RobotCode(robot, programs, "0" * 64)
    for artifact in (*c_sources(code), selftest_artifact(code)):
        (folder / artifact.path).write_text(artifact.text, encoding="utf-8")
    (folder / "manifest.json").write_text('{"robot": "bot"}', encoding="utf-8")
    return selftest.run(folder, selftest.STRICT)


def test_code_on_the_other_side_fails(tmp_path, capfd):
    ahead, behind = (mechanism(SLIDER_CRANK.replace("SIDE", side), tmp_path) for side in ("ahead", "behind"))
    names = ("foot_position", "foot_jacobian", "assembly_status", "transmission_angles", "foot_positions")
    assert report(ahead, derive(ahead, names), tmp_path / "right") == 0
    assert "5 passed, 0 failed" in capfd.readouterr().out
    assert report(ahead, derive(behind, names), tmp_path / "wrong") == 1
    assert "1 passed, 4 failed" in capfd.readouterr().out  # it assembles all the same


@pytest.mark.nightly
@pytest.mark.parametrize("name", [*FEET, "hydraulic_leg", "minitaur"])
def test_shipped_robots_pass(name, shipped, capfd):
    assert selftest.run(shipped(name).folder) == 0
    output = capfd.readouterr().out
    assert "_foot_position, " in output
    assert "_foot_jacobian, " in output

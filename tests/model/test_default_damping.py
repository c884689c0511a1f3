"""Damping that no spec gives: a hundredth of how far a unit of the joints' rates moves the foot."""

from decimal import Decimal
from fractions import Fraction

import pytest

from walkgen.model.assemble import assemble
from walkgen.model.walk import number
from walkgen.spec.read import read

TEXT = """walkgen = 1
[robot]
name = "robot"
gravity = [0.0, 0.0, -9.81]
[leg_designs.leg]
dh = "classic"
foot = {{ xyz = [0.0, 0.0, {foot}] }}
joints = [{joints}]
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "leg"
platform = "body"
"""
TURN = '{{ name = "turn{}", type = "revolute", a = {}, alpha = 0, d = 0 }}'
SLIDE = '{{ name = "slide{}", type = "prismatic", a = {}, alpha = 0, d = 0{} }}'
LIMITED = ", limits = [-0.3, 0.7]"
CASES = {
    "turning": ([TURN.format(0, 0.5), TURN.format(1, 1.5)], 0.25, "0.022"),
    "turning, of no size": ([TURN.format(0, 0.0)], 0.0, "0.01"),
    "sliding, however long": ([SLIDE.format(0, 20.0, ""), SLIDE.format(1, 0.001, LIMITED)], 0.0, "0.01"),
    "both, small": ([TURN.format(0, 0.1), SLIDE.format(0, 0.0, LIMITED)], 0.05, "0.0085"),
    "both, large": ([TURN.format(0, 3.0), SLIDE.format(0, 0.0, LIMITED)], 0.0, "0.01"),
    "both, of no size": ([TURN.format(0, 0.0), SLIDE.format(0, 0.0, "")], 0.0, "0.01"),
    "sixteen": ([TURN.format(index, 0.125) for index in range(16)], 0.0, "0.02"),
}


@pytest.mark.parametrize("name", CASES)
def test_default_damping(tmp_path, name):
    joints, foot, expected = CASES[name]
    path = tmp_path / "spec.toml"
    path.write_text(TEXT.format(joints=", ".join(joints), foot=foot), encoding="utf-8")
    mechanism = assemble(read(path))
    epsilon, largest = mechanism.legs[0].damping
    assert epsilon == largest
    assert Fraction(Decimal(str(number(epsilon, mechanism)))) == Fraction(expected)

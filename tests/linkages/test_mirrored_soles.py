"""The sole of a mirrored leg is the mirror image of the leg's, on a link of a linkage as on a joint in series."""

import numpy as np
import pytest

from linkages.placed import code_of

TEXT = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [
    { name = "leg", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } },
    { name = "other", mirror_of = "leg" },
]
[leg_designs.leg]
sole = { length = 0.1, width = 0.06, rpy_deg = [80, 40, 20] }
plane = { rpy_deg = [90, 0, 0] }
foot = "shank.P"
links = { frame = { points = { A = [0, 0] } }, thigh = { points = { A = [-0.3, 0], B = [0, 0] } }, \
shank = { points = { B = [-0.4, 0], P = [0, 0] } } }
pins = [{ name = "hip", joins = ["frame.A", "thigh.A"], driven = true }, { name = "knee", joins = ["thigh.B", "shank.B"], driven = true }]
"""


def test_a_sole_on_a_linkage(tmp_path):
    code, q, mirror = code_of(TEXT, ("sole_normal", "sole_points"), tmp_path), np.array([0.3, -0.8]), np.array([1, -1, 1])
    assert code["other_sole_normal"](q) == pytest.approx(code["leg_sole_normal"](q) * mirror, abs=1e-14)
    found, wanted = (code[f"{leg}_sole_points"](q) for leg in ("other", "leg"))
    assert found == pytest.approx(wanted[::-1] * mirror, abs=1e-14)  # once round the other way, beginning at the same end

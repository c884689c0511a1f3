"""Whether legs reach a gait's feet: strokes that a leg is too short for or its limits forbid, by the amount that geometry says."""

import numpy as np
import pytest

from walkgen.gait.reach import shortfalls
from walkgen.gait.trajectory import Trajectory
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load

THIGH, SHANK, DOWN, OUT = 0.35, 0.40, 0.30, 0.40
LIMITS = 60
TEXT = """walkgen = 1
[robot]
name = "four"
gravity = [0, 0, -9.8]
[generate]
functions = ["foot_position", "inverse_admissible", "foot_targets"]
[leg_designs.l]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = 0, alpha_deg = 90, d = 0, limits_deg = [{low}, {high}] }},
  {{ name = "thigh", type = "revolute", a = 0.35, alpha_deg = 0, d = 0 }},
  {{ name = "shank", type = "revolute", a = 0.40, alpha_deg = 0, d = 0 }},
]
[[platforms]]
name = "body"
[gait]
kind = "crawl"
period = 2.0
stride = {stride}
lift = 0.05
left = ["lf", "lh"]
right = ["rf", "rh"]
[gait.stance]
lf = [0.5, 0.6, -0.3]
rf = [0.5, -0.6, -0.3]
lh = [-0.5, 0.6, -0.3]
rh = [-0.5, -0.6, -0.3]
"""
LEG = """
[[legs]]
name = "{name}"
design = "l"
platform = "body"
mount = {{ xyz = [{x}, {y}, 0], rpy_deg = [0, 0, {turn}] }}
"""
CORNERS = (("lf", 0.5, 0.2, 90), ("rf", 0.5, -0.2, -90), ("lh", -0.5, 0.2, 90), ("rh", -0.5, -0.2, -90))


def robot(folder, stride, limit=180):
    legs = "".join(LEG.format(name=name, x=x, y=y, turn=turn) for name, x, y, turn in CORNERS)
    (folder / "four.toml").write_text(TEXT.format(stride=stride, low=-limit, high=limit) + legs, encoding="utf-8")
    build(folder / "four.toml", folder, BuildOptions(targets=("c",)))
    return load(folder / "four")


def test_a_stroke_within_reach(tmp_path):
    made = robot(tmp_path, 0.4, LIMITS)
    assert shortfalls(made, made.gait) == ()


def from_hips(made):
    """Feet [..., 4, 3] of a cycle from their hips."""
    hips = np.array([[x, y, 0.0] for _, x, y, _ in CORNERS])
    return Trajectory.of(made.gait).platform(np.linspace(0, 2, 4001)).position - hips


def test_a_leg_that_is_too_short(tmp_path):
    """Further from the hip than thigh and shank reach: at the ends of the stroke, 0.6 m from its middle, and further on in transfer."""
    made = robot(tmp_path, 1.6)
    found = shortfalls(made, made.gait, samples=400)
    away = np.linalg.norm(from_hips(made), axis=-1).max(axis=0) - (THIGH + SHANK)
    assert [one.leg for one in found] == ["lf", "rf", "lh", "rh"]
    for one, expected in zip(found, away, strict=True):
        assert one.distance == pytest.approx(expected, abs=2e-5)
        assert one.distance > np.linalg.norm([0.6, OUT, DOWN]) - (THIGH + SHANK) > 0.03
        assert one.phase > 0.75
        assert f"by {one.distance:.4f} m" in str(one)


def test_a_limit_that_is_too_narrow(tmp_path):
    """A yaw of 20 degrees at most: a foot beyond is nearest where the leg's plane at the limit passes it."""
    made = robot(tmp_path, 0.6, 20)
    found = shortfalls(made, made.gait, samples=400)
    feet = np.abs(from_hips(made))
    beyond = np.arctan2(feet[..., 0], feet[..., 1]) - np.radians(20)
    away = (np.hypot(feet[..., 0], feet[..., 1]) * np.sin(beyond)).max(axis=0)
    assert [one.leg for one in found] == ["lf", "rf", "lh", "rh"]
    for one, expected in zip(found, away, strict=True):
        assert one.distance == pytest.approx(expected, abs=2e-5)


def test_turning_on_the_spot_asks_for_more(tmp_path):
    made = robot(tmp_path, 0.4, LIMITS)
    assert shortfalls(made, made.gait, [0.0, 0.0, 0.2]) == ()
    assert {one.leg for one in shortfalls(made, made.gait, [0.0, 0.0, 2.0])} == {"lf", "rf", "lh", "rh"}

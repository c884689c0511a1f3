"""Whether legs reach a gait's feet: strokes that a leg is too short for or its limits forbid, by the amount that geometry says."""

import numpy as np
import pytest

from walkgen.gait.reach import shortfalls
from walkgen.gait.trajectory import Trajectory
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load

THIGH, SHANK, DOWN, OUT = 0.35, 0.40, 0.30, 0.40
TEXT = """walkgen = 1
[robot]
name = "four"
gravity = [0, 0, -9.8]
[generate]
functions = ["foot_position", "foot_positions", "inverse", "inverse_admissible", "foot_targets"]
{designs}
[[platforms]]
name = "body"
[gait.near]
kind = "crawl"
period = 2.0
stride = 0.6
lift = 0.05
left = ["lf", "lh"]
right = ["rf", "rh"]
stance = "far"
[gait.far]
kind = "crawl"
period = 2.0
stride = 1.6
lift = 0.05
left = ["lf", "lh"]
right = ["rf", "rh"]
[gait.far.stance]
lf = [0.5, 0.6, -0.3]
rf = [0.5, -0.6, -0.3]
lh = [-0.5, 0.6, -0.3]
rh = [-0.5, -0.6, -0.3]
"""
DESIGN = """
[leg_designs.turns_{limit}]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = 0, alpha_deg = 90, d = 0, limits_deg = [-{limit}, {limit}] }},
  {{ name = "thigh", type = "revolute", a = 0.35, alpha_deg = 0, d = 0 }},
  {{ name = "shank", type = "revolute", a = 0.40, alpha_deg = 0, d = 0 }},
]
"""
LEG = """
[[legs]]
name = "{name}"
design = "turns_{limit}"
platform = "body"
mount = {{ xyz = [{x}, {y}, 0], rpy_deg = [0, 0, {turn}] }}
"""
CORNERS = (("lf", 0.5, 0.2, 90), ("rf", 0.5, -0.2, -90), ("lh", -0.5, 0.2, 90), ("rh", -0.5, -0.2, -90))
WIDE, NARROW = 75, 20
"""How far legs on the left and on the right turn (degrees)."""


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reach")
    legs = "".join(LEG.format(name=name, x=x, y=y, turn=turn, limit=WIDE if turn > 0 else NARROW) for name, x, y, turn in CORNERS)
    designs = "".join(DESIGN.format(limit=limit) for limit in (WIDE, NARROW))
    (folder / "four.toml").write_text(TEXT.format(designs=designs) + legs, encoding="utf-8")
    build(folder / "four.toml", folder, BuildOptions(targets=("c",)))
    return load(folder / "four")


def from_hips(gait):
    """Feet [..., 4, 3] of a cycle from their hips."""
    hips = np.array([[x, y, 0.0] for _, x, y, _ in CORNERS])
    return Trajectory.of(gait).platform(np.linspace(0, 2, 4001)).position - hips


def test_a_leg_that_is_too_short(robot):
    """Further from the hip than thigh and shank reach: at the ends of the stroke, 0.6 m from its middle, and further on in transfer."""
    gait = robot.gaits["far"]
    found = [one for one in shortfalls(robot, Trajectory.of(gait), samples=400) if one.leg.startswith("l")]
    away = np.linalg.norm(from_hips(gait), axis=-1).max(axis=0) - (THIGH + SHANK)
    assert [one.leg for one in found] == ["lf", "lh"]
    for one, expected in zip(found, away[::2], strict=True):
        assert one.distance == pytest.approx(expected, abs=2e-5)
        assert one.distance > np.linalg.norm([0.6, OUT, DOWN]) - (THIGH + SHANK) > 0.03
        assert one.phase > 0.75
        assert f"in transfer, ({one.point[0]:.4f}, {one.point[1]:.4f}, {one.point[2]:.4f}), is {1000 * one.distance:.4g} mm" in str(one)


def test_a_limit_that_is_too_narrow(robot):
    """A yaw of 20 degrees at most on the right: a foot beyond is nearest where the leg's plane at the limit passes it."""
    gait = robot.gaits["near"]
    found = shortfalls(robot, Trajectory.of(gait), samples=400)
    feet = np.abs(from_hips(gait))
    beyond = np.arctan2(feet[..., 0], feet[..., 1]) - np.radians(NARROW)
    away = (np.hypot(feet[..., 0], feet[..., 1]) * np.sin(beyond)).max(axis=0)
    assert [one.leg for one in found] == ["rf", "rh"]
    for one, expected in zip(found, away[1::2], strict=True):
        assert one.distance == pytest.approx(expected, abs=2e-5)


def test_turning_on_the_spot_asks_for_more(robot):
    gait = robot.gaits["near"]
    assert not {one.leg for one in shortfalls(robot, Trajectory.of(gait), [0.0, 0.0, 0.2])} & {"lf", "lh"}
    assert {one.leg for one in shortfalls(robot, Trajectory.of(gait), [0.0, 0.0, 2.0])} >= {"lf", "lh"}


def test_ends_of_strokes_without_limits(robot):
    """At the ends of its stroke of 1.2 m the foot is sqrt(.6^2 + .4^2 + .3^2) from the hip; a yaw of 20 degrees is no reason."""
    found = shortfalls(robot, Trajectory.of(robot.gaits["far"]), samples=0, limits=False)
    assert [one.leg for one in found] == [name for name, *_ in CORNERS]
    for one in found:
        assert one.distance == pytest.approx(np.linalg.norm([0.6, OUT, DOWN]) - (THIGH + SHANK), abs=1e-9)
        assert one.part in {"the front end of its stroke", "the rear end of its stroke"}
        assert f"{1000 * one.distance:.4g} mm out of reach" in str(one)
    assert shortfalls(robot, Trajectory.of(robot.gaits["near"]), samples=0, limits=False) == ()

"""The shipped robots can walk their gaits: every foot of every gait is within reach, straight ahead."""

from pathlib import Path

import pytest

from walkgen.gait.pattern import Gait
from walkgen.gait.reach import shortfalls
from walkgen.gait.schedule import Schedule
from walkgen.gait.trajectory import Trajectory
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load

SPECS = Path(__file__).parents[2] / "specs"
FUNCTIONS = '[generate]\nfunctions = ["foot_position", "inverse_admissible", "platform_poses", "foot_targets"]\n\n[parameters]'


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["mero", "quadruped"])
def test_every_foot_is_within_reach(name, tmp_path):
    text = (SPECS / f"{name}.toml").read_text(encoding="utf-8").replace("[parameters]", FUNCTIONS, 1)
    (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    build(tmp_path / f"{name}.toml", tmp_path, BuildOptions(targets=("c",)))
    robot = load(tmp_path / name)
    for gait in robot.gaits.values():
        if gait.kind == "events":
            assert Schedule.of(gait).fewest_supporting >= 3
            continue
        assert shortfalls(robot, Trajectory.of(gait)) == ()
        assert Gait.of(gait).is_static

"""Legs that keep to a path of their own: Garrec's straight stroke by the theory, drives without jumps, feet over their footholds."""

from pathlib import Path

import numpy as np
import pytest

from walkgen.gait.drawing import drawing
from walkgen.gait.driven import own_stance, path
from walkgen.gait.ground import Slope
from walkgen.gait.pattern import Gait
from walkgen.gait.simulate import Options, simulate
from walkgen.model.assemble import assemble
from walkgen.pipeline import BuildOptions, build
from walkgen.runtime import load
from walkgen.spec.read import read
from walkgen.walking import linked_of

GARREC = Path(__file__).parents[2] / "specs" / "garrec.toml"
FUNCTIONS = ("foot_position", "foot_jacobian", "foot_positions", "foot_jacobians", "foot_bias_acceleration", "pair_positions")


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("garrec")
    return load(build(GARREC, folder, BuildOptions(targets=("numpy",), functions=FUNCTIONS)).folder)


@pytest.fixture(scope="module")
def trajectory(robot):
    return own_stance(robot, Gait.of(robot.gait))


def test_the_stroke_is_the_straight_part_of_the_path(robot, trajectory):
    """Theory 2.3 (c): within 2 mm of level for a stroke of 0.6726 m, 59.15 % of the turn."""
    leg = robot.legs["middle_left"]
    drive, points = path(leg)
    assert (np.diff(points[:, 0]) < 0).all()
    level = np.ptp(points[points[:, 2] < points[:, 2].min() + 0.002, 0])
    assert level == pytest.approx(0.6726, abs=2e-3)
    assert np.ptp(drive[points[:, 2] < points[:, 2].min() + 0.002]) / (2 * np.pi) == pytest.approx(0.5915, abs=2e-3)
    x, y, z = trajectory.stance[1]
    half = trajectory.gait.stroke[1] / 2
    under = points[np.abs(points[:, 0] - x) <= half]
    assert np.abs(under[:, 2] - z).max() < 1.01e-3
    assert y == pytest.approx(0.35)


@pytest.mark.parametrize("options", [Options(rate=200.0), Options(rate=200.0, from_rest=True)], ids=["steady", "rest"])
def test_feet_stay_over_their_footholds(robot, trajectory, options):
    walk = simulate(robot, trajectory, Slope(), options)
    off = (walk.feet - walk.targets)[walk.stance]
    assert np.abs(off[:, :2]).max() < 1e-9
    assert 5e-4 < walk.slip < 1.01e-3
    assert {"off", "mass"} <= {fault.kind for fault in walk.faults} <= {"off", "mass", "through"}
    yielding = simulate(robot, trajectory, Slope(), Options(rate=200.0, give=1.1e-3))
    assert [fault.kind for fault in yielding.faults] == ["mass"]  # built without com: nobody knows whether it stands
    assert not yielding.feasible
    step = walk.times[1] - walk.times[0]
    assert np.abs(np.gradient(walk.q, walk.times, axis=0) - walk.qd)[1:-1].max() < 2e-3 * np.abs(walk.qd).max()
    assert np.abs(np.diff(walk.qd, axis=0)).max() < 1.1 * np.abs(walk.qdd).max() * step


def test_cranks_turn_once_a_period(robot, trajectory):
    walk = simulate(robot, trajectory, Slope(), Options(cycles=3))
    turned = (walk.q[-1] - walk.q[0])[[leg.slice.stop - 1 for leg in robot.legs.values()]]
    np.testing.assert_allclose(np.abs(turned), 6 * np.pi, atol=1e-9)
    assert not walk.q[:, [leg.slice.start for leg in robot.legs.values()]].any()


def test_a_stroke_longer_than_the_path(robot):
    gait = Gait.of(robot.gait)
    with pytest.raises(ValueError, match=r"goes back for 0\.7\d* m; a stroke of 1.2 m is"):
        own_stance(robot, Gait(gait.legs, (0.6,) * 6, gait.phase, 4.0, 2.0))


def test_legs_are_drawn_by_their_links(robot, trajectory):
    """Theory 2.3 (c): crank of 0.05 m, coupler of 2.5 and 5 cranks, rocker of 2.5, pantograph of 0.45 m and thirds of it."""
    walk = simulate(robot, trajectory, Slope(), Options(rate=20.0))
    rows = np.array([0, 17, 31])
    lines = drawing(robot, walk, Slope(), rows, linked_of(assemble(read(GARREC), GARREC.parent))).legs
    lengths = np.linalg.norm(np.diff(lines, axis=1), axis=-1)
    assert np.ptp(lengths, axis=0)[np.isfinite(lengths[0])].max() < 1e-12
    for length in (0.05, 0.125, 0.25, 0.45 / 3, 0.3, 0.45):
        assert (np.abs(lengths[0] - length) < 1e-12).sum() >= len(robot.legs)
    for foot in range(len(robot.legs)):
        assert np.linalg.norm(lines - walk.feet[rows, foot][:, None], axis=-1)[:, np.isfinite(lines[0, :, 0])].min(axis=1).max() < 1e-12

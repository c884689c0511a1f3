"""Linkages of random dimensions, drawn before it is known whether they assemble, beside loops closed by scipy."""

import sys

import numpy as np
import pytest

from linkages.closure import Closure, apart, assembled
from linkages.placed import as_unknowns, code_of
from linkages.sought import NEAR, Sought
from linkages.topologies import TOPOLOGIES, spec

FUNCTIONS = ("foot_position", "foot_jacobian", "assembly_status", "transmission_angles", "inverse", "inverse_distance")
OK, UNREACHABLE, INFEASIBLE, DUPLICATE = 0, 1, 5, 6
ASSEMBLED = {
    "four_bar": (31, 738),
    "five_bar": (27, 608),
    "slider_crank": (21, 485),
    "moving_guide": (22, 503),
    "inverted_slider_crank": (32, 625),
    "scotch_yoke": (40, 1000),
    "crossed_guides": (40, 1000),
    "watt": (19, 410),
    "pantograph": (19, 476),
    "hydraulic": (23, 574),
    "odex": (11, 299),
    "inner_drives": (29, 633),
    "telescope": (20, 558),
    "pin_of_three": (24, 485),
}
"""How many assemble of forty and of a thousand random sets."""
BACK = 1e-14
TWO_DRIVES = ("five_bar", "hydraulic", "odex", "inner_drives")


@pytest.fixture(scope="module")
def code(tmp_path_factory):
    made = {}

    def of(name):
        if name not in made:
            made[name] = code_of(spec(name, FUNCTIONS), FUNCTIONS, tmp_path_factory.mktemp(name))
        return made[name]

    return of


def compare(code, name, count, starts):
    """Every set by both, scipy from so many random starts; how many assemble, and what scipy did for it."""
    topology, text, random = TOPOLOGIES[name], spec(name, FUNCTIONS), np.random.default_rng(count)
    dimensions, drives = topology.draw(random, count)
    status, poses = code["leg_assembly_status"](drives, dimensions), code["leg_poses"](drives, dimensions)
    assert set(status) <= {OK, UNREACHABLE}
    assert np.array_equal(np.isnan(poses).any((1, 2)), status == UNREACHABLE)
    closes, sought = status == OK, Sought(text, topology.sides, dimensions, drives, random)
    guesses = assembled(text, topology.sides, dimensions, drives, random, np.where(closes, 6, 3))
    found = [sought.pose(row, starts, guess) for row, guess in enumerate(guesses)]
    assert not [row for row, pose in enumerate(found) if pose is None and closes[row]]
    assert not [row for row, pose in enumerate(found) if pose is not None and not closes[row] and sought.polished(row, pose) is not None]
    own, rows = as_unknowns(poses[closes]), np.flatnonzero(closes)
    wanted = np.array([sought.nearer(row, found[row], pose) for row, pose in zip(rows, own, strict=True)], float)
    closure, size = Closure(text, dimensions[closes], drives[closes]), np.maximum(1, np.abs(wanted).max(-1))
    away, condition = apart(own, wanted) / size, np.linalg.cond(closure.equations(own)[1]) / size
    assert np.all(away <= NEAR * np.maximum(1, condition / 1e3))
    assert np.all(closure.as_wanted(own, topology.sides))
    angles = code["leg_transmission_angles"](drives, dimensions)[closes] if topology.sides else np.ones((closes.sum(), 1))
    assert np.isfinite(angles).all()
    told = f"scipy comes to {sought.alone} from random starts alone, {sought.exact} told by 40 digits; at most {away.max():.1e} apart"
    return closes.sum(), told


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", TOPOLOGIES)
def test_forty_sets(code, name):
    assert compare(code(name), name, 40, 4)[0] == ASSEMBLED[name][0]


@pytest.mark.nightly
@pytest.mark.parametrize("name", TOPOLOGIES)
def test_a_thousand_sets(code, capsys, name):
    closes, told = compare(code(name), name, 1000, 12)
    with capsys.disabled():
        sys.stdout.write(f"\n{name}: {closes / 10:.1f} % of a thousand random sets assemble; {told}\n")
    assert closes == ASSEMBLED[name][1]


def misses(leg, rows, dimensions, target):
    """How far the feet of rows are from their targets, in units of what rounding of the drives moves them."""
    dimensions = np.broadcast_to(dimensions[:, None], (*rows.shape[:2], dimensions.shape[-1]))
    error = np.abs(leg["leg_foot_position"](rows, dimensions) - target[:, None]).max(-1)
    slope = np.linalg.norm(leg["leg_foot_jacobian"](rows, dimensions), axis=(-2, -1))
    return error / (1 + slope)


@pytest.mark.parametrize("name", TWO_DRIVES)
def test_foot_and_back(code, name):
    """One of the rows is the drives that the foot came from; all that are said to reach it do, none is NaN."""
    leg, (dimensions, drives) = code(name), TOPOLOGIES[name].draw(np.random.default_rng(8), 1000)
    closes = leg["leg_assembly_status"](drives, dimensions) == OK
    dimensions, drives = dimensions[closes], drives[closes]
    foot = leg["leg_foot_position"](drives, dimensions)
    rows, status = leg["leg_inverse"](foot, dimensions)
    assert np.isfinite(rows).all()
    assert misses(leg, rows, dimensions, foot)[status == OK].max() < BACK
    away = rows - drives[:, None]
    if "*" in TOPOLOGIES[name].pins:
        away = np.angle(np.exp(1j * away))
    nearest = np.where(np.isin(status, (OK, DUPLICATE)), np.abs(away).max(-1), np.inf).min(-1)
    jacobian = leg["leg_foot_jacobian"](drives, dimensions)[:, :2]
    assert np.all(nearest <= BACK * np.linalg.norm(np.linalg.inv(jacobian), axis=(1, 2)) * (1 + np.linalg.norm(jacobian, axis=(1, 2))))


@pytest.mark.parametrize("name", TWO_DRIVES)
def test_any_target_has_a_status(code, name):
    """Targets drawn with the dimensions: rows are finite, and those that are said to be there are."""
    leg, random = code(name), np.random.default_rng(9)
    dimensions, _ = TOPOLOGIES[name].draw(random, 1000)
    target = np.c_[random.uniform(-1.5, 1.5, (1000, 2)), np.zeros(1000)]
    rows, status = leg["leg_inverse"](target, dimensions)
    assert set(np.unique(status)) <= {OK, UNREACHABLE, INFEASIBLE, DUPLICATE}
    assert np.isfinite(rows).all()
    assert (status == OK).any()
    assert (status == UNREACHABLE).any()
    assert np.bincount(status.ravel())[OK] > 100
    off = misses(leg, rows, dimensions, target)
    assert off[status == OK].max() < BACK
    assert not (off[np.isin(status, (UNREACHABLE, INFEASIBLE))] < BACK).any()  # with the spec's sides they lie elsewhere
    distance = leg["leg_inverse_distance"](target, dimensions)
    feet = leg["leg_foot_position"](rows, np.repeat(dimensions[:, None], rows.shape[1], 1))
    assert distance == pytest.approx(np.linalg.norm(feet - target[:, None], axis=-1), abs=1e-14, nan_ok=True)
    out = np.c_[target[:, :2], np.full(1000, 1e-3)]
    assert (leg["leg_inverse"](out, dimensions)[1] == UNREACHABLE).all()


def test_a_foot_behind_a_triad_has_no_inverse(code):
    assert "leg_inverse" not in code("pantograph")

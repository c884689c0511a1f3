"""Legs of every sequence of one to three turning and sliding joints, as users call them, against the walker and a dense multistart."""

import numpy as np
import pytest
from answers import OK, REGULAR, SINGULAR, UNREACHABLE, assert_ordered, assert_reached, least
from sequences import FEW, NAMES, SAMPLE, anatomies, text

from oracles.multistart import multistart

SAMPLED = [name if name in FEW else pytest.param(name, marks=pytest.mark.nightly) for name in SAMPLE]


@pytest.fixture(scope="session")
def leg_of(built):
    """A generated leg by its name and the backend, of the robot with a few of them or of one with all."""

    def find(name, backend="c", *, every=False):
        found = built(text(name[0] if every or name not in FEW else "few"))
        return (found.c if backend == "c" else found.numpy).legs[name]

    return find


def targets(name, count, seed=0):
    """Random poses [count, n] and their feet."""
    path = anatomies()[name]
    q = path.random(np.random.default_rng([NAMES.index(name), seed]), count)
    return path, q, path.foot(q)


def check(name, leg, count, seed=0):
    path, q, p = targets(name, count, seed)
    rows, status = leg.inverse(p)
    assert_reached(path, q, p, rows, status)
    assert_ordered(path, rows, status, leg.inverse_class.startswith("general"))
    assert not redundant(name) or np.all(np.isin(status, (SINGULAR, UNREACHABLE)))


def redundant(name):
    """Whether the joints move the foot in fewer directions than they are, in every pose."""
    path, q, _ = targets(name, 20, 99)
    return bool(np.all(least(path, q) < 1e-12))


@pytest.mark.parametrize("name", SAMPLED)
def test_every_pose_is_found(leg_of, name):
    check(name, leg_of(name), 200)


def compare(name, leg, count, seed):
    """Solutions that only one of the inverse and Newton found, and how many both did; singular ones left out."""
    path, _, p = targets(name, count, seed)
    rows, status = leg.inverse(p)
    found, gap = multistart(path, p)
    sharp = (gap < 1e-11) & (least(path, found) > 1e-4)
    solved = (status == OK) & (least(path, rows) > 1e-4)
    apart = np.where(solved & sharp[..., None], path.apart(rows, found[:, :, None]), np.inf)
    missing = sharp & (apart.min(axis=-1) > 1e-7)
    common = (apart.min(axis=0) <= 1e-7) & solved
    return np.count_nonzero(missing), np.count_nonzero(solved & ~common), np.count_nonzero(common)


def test_redundant_legs_are_among_them():
    assert {"rrr_zz", "pp_z", "ppp_zz", "rpp_pz", "rpp_zz"} <= {name for name in SAMPLE if redundant(name)}


@pytest.mark.parametrize("name", SAMPLED)
def test_no_branch_is_missing(leg_of, name):
    missing, alone, common = compare(name, leg_of(name), 20, 1)
    assert missing == 0
    assert alone <= 0.1 * common  # Newton does not find all, but enough to be a judge


@pytest.mark.parametrize("name", SAMPLED)
def test_numpy_has_the_same_rows(leg_of, name):
    path, q, p = targets(name, 6, 2)
    p = np.concatenate([p, p * 1.5 + 0.1])
    rows, status = leg_of(name, "numpy").inverse(p)
    assert_reached(path, q, p[:6], rows[:6], status[:6])
    compiled, states = leg_of(name).inverse(p)
    regular = np.all(least(path, compiled) > REGULAR, axis=1)
    assert np.array_equal(status[regular], states[regular])
    assert np.all(path.apart(rows, compiled)[(states == OK) & regular[:, None]] <= 1e-10)


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
def test_many_poses(leg_of, name):
    for seed in range(10, 14):
        check(name, leg_of(name, every=True), 5000, seed)


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
def test_no_branch_of_many_is_missing(leg_of, name):
    """20 000 poses of every sequence of joints, shared by its legs."""
    legs = sum(name.split("_")[0] == other.split("_")[0] for other in NAMES)
    for seed in range(20, 20 + 20_000 // legs // 50):
        missing, alone, common = compare(name, leg_of(name, every=True), 50, seed)
        assert missing == 0
        assert alone <= 0.1 * common

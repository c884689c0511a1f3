"""Triads of many random dimensions, drawn before it is known whether they assemble, beside the equations of all links solved by scipy."""

import sys

import numpy as np
import pytest

from linkages.by_scipy import Plane
from linkages.closure import Closure, apart
from linkages.placed import as_unknowns
from linkages.starts import Drawn, moved
from linkages.topologies import TRIADS, spec

FUNCTIONS = ("foot_position", "assembly_status")
OK, UNREACHABLE, SINGULAR, NO_CONVERGENCE = 0, 1, 3, 4
ASSEMBLED = {
    "stephenson_2": 741,
    "loop_of_four": 687,
    "three_cylinders": 939,
    "plate_on_sliders": 878,
    "cross_slide": 529,
    "cross_slide_loop": 298,
    "two_cranks": 593,
    "hung_triad": 530,
}
"""How many of a thousand random sets assemble."""
RESIDUAL, NEAR, FAR = 1e-14, 1e-12, 1e3
STARTS, PARTS, MOST_MOVED = 4, 400, 200
"""Random starts of scipy a set, six times as many where walkgen finds no assembly; parts of a slow way; sets that are moved."""


class Sweep:
    """Random sets of a topology, with all assemblies that walkgen finds."""

    def __init__(self, name, count, folder):
        self.name, self.drawn, self.text = name, Drawn(name, count, 11, folder), spec(name, FUNCTIONS)
        self.code, self.plane, self.random = self.drawn.code(FUNCTIONS), Plane(self.text), np.random.default_rng(12)
        numbers = [(row, which) for row, found in enumerate(self.drawn.assemblies) for which in range(len(found))]
        self.rows, self.which = (np.array(column, int) for column in zip(*numbers, strict=True))

    def poses(self, chosen, drives):
        """Of the generated code, started from some assemblies."""
        rows, which = self.rows[chosen], self.which[chosen]
        self.drawn.started(self.code, rows, which)
        dimensions = self.drawn.dimensions[rows]
        return self.code["leg_assembly_status"](drives, dimensions), as_unknowns(self.code["leg_poses"](drives, dimensions))

    def by_scipy(self, row, drives, start):
        """A pose that closes on the spec's sides, None where scipy finds none."""
        dimensions = self.drawn.dimensions[row]
        found = self.plane.closed(dimensions, drives, start)
        wanted = found is not None and np.abs(found).max() < FAR and self.closure([row], drives[None]).as_wanted(found[None], self.sides)
        return found if wanted else None

    @property
    def sides(self):
        return self.drawn.topology.sides

    def closure(self, rows, drives):
        return Closure(self.text, self.drawn.dimensions[rows], drives)

    def accuracy(self, rows, drives, poses):
        """The size of poses, and how near to them others are that equations met to rounding have."""
        size = np.maximum(1, np.abs(poses).max(-1))
        return size, NEAR * size * np.maximum(1, np.linalg.cond(self.closure(rows, drives).equations(poses)[1]) / 1e3)

    def random_start(self, count):
        x = self.random.uniform(-1.5, 1.5, count)
        x[2::3] = self.random.uniform(-np.pi, np.pi, count // 3)
        return x


def assert_scipy_stays(sets, rows, drives, poses):
    """Loops are closed, and scipy from close by comes back, but where a slider is far out."""
    close_by = np.abs(poses).max(-1) < FAR / 2
    assert np.mean(close_by) > 0.99
    rows, drives, poses = rows[close_by], drives[close_by], poses[close_by]
    size, near = sets.accuracy(rows, drives, poses)
    assert np.all(np.abs(sets.closure(rows, drives).equations(poses)[0]).max(-1) <= RESIDUAL * size**2)
    strays = []
    for row, q, pose, own, close in zip(rows, drives, poses, size, near, strict=True):
        start = pose + min(1e-4, 1e5 * close) * own * sets.random.normal(size=len(pose)) / 3
        found = sets.by_scipy(row, q, start)
        away = np.inf if found is None else apart(found, pose)
        strays += [(row, away, close)] if away > close else []
    assert not strays


def assembled(sets):
    """Whether each set assembles, by both: every assembly is one by scipy, and scipy finds no others from random starts."""
    drawn = sets.drawn
    status, poses = sets.poses(slice(None), drawn.drives[sets.rows])
    assert set(status) <= {OK}
    assert_scipy_stays(sets, sets.rows, drawn.drives[sets.rows], poses)
    near = sets.accuracy(sets.rows, drawn.drives[sets.rows], poses)[1]
    others = []
    for row, drives in enumerate(drawn.drives):
        own = np.flatnonzero(sets.rows == row)
        for _ in range(STARTS if len(own) else 6 * STARTS):
            found = sets.by_scipy(row, drives, sets.random_start(poses.shape[1]))
            if found is not None and not np.any(apart(poses[own], found) <= 10 * near[own]):
                others.append((row, len(own), found))
    assert not others
    return drawn.closes


def assert_moves(sets, count):
    """From the first assembly to other drives, or to none where a slow way ends at a dead point."""
    drawn, first = sets.drawn, np.flatnonzero(sets.which == 0)[:count]
    rows, start = sets.rows[first], sets.poses(first, drawn.drives[sets.rows[first]])[1]
    turning = "R" * drawn.topology.pins.count("*") + "P" * (drawn.topology.sliders + drawn.topology.cylinders).count("*")
    far = np.array([np.pi if kind == "R" else 0.4 for kind in turning])
    end = drawn.drives[rows] + far * sets.random.uniform(-1, 1, (len(rows), len(far)))
    status, poses = sets.poses(first, end)
    _, there = moved(sets.text, drawn.dimensions[rows], start, drawn.drives[rows], end, PARTS)
    for finer in (10, 50):  # where something moves fast in the meantime
        slower = np.flatnonzero((status == OK) != there)
        if len(slower) and not sets.sides:
            ways = drawn.dimensions[rows[slower]], start[slower], drawn.drives[rows[slower]], end[slower]
            there[slower] = moved(sets.text, *ways, finer * PARTS)[1]
    if sets.sides:  # dyads beyond the triads may be open on the way: they are told by their sides at its end
        there |= status == OK
    assert set(status) <= {OK, UNREACHABLE, NO_CONVERGENCE}
    assert np.array_equal(status == OK, there), (rows[(status == OK) != there], status[(status == OK) != there])
    assert_scipy_stays(sets, rows[there], end[there], poses[there])


def test_twenty_sets(tmp_path):
    sets = Sweep("stephenson_2", 20, tmp_path)
    assert assembled(sets).sum() == 13
    assert_moves(sets, 20)


@pytest.mark.nightly
@pytest.mark.parametrize("name", TRIADS)
def test_a_thousand_sets(tmp_path, capsys, name):
    sets = Sweep(name, 1000, tmp_path)
    closes = assembled(sets)
    with capsys.disabled():
        sys.stdout.write(f"\n{name}: {100 * closes.mean():.1f} % of a thousand random sets assemble, in {len(sets.rows)} ways\n")
    assert closes.sum() == ASSEMBLED[name]
    assert_moves(sets, MOST_MOVED)

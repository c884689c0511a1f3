"""Random stances of 3 to 12 feet: whether they carry their load as Clarabel and HiGHS say; at the edge, as 50 digits say."""

import time

import numpy as np
import pytest
from contact_checks import exactly_carried, exactly_refuted, loads
from contact_library import Forces
from contact_peers import CARRIED, REFUTED, UNDECIDED, by_clarabel, by_highs, clarabel_settings

from contact_stances import random_stances

OK, NO_CONVERGENCE, INFEASIBLE = 0, 4, 5
VERDICTS = {CARRIED: OK, REFUTED: INFEASIBLE}
BAND = 1e-6
ROUNDING = 1e-14
"""Of a certificate's entries: near the edge they are large."""


@pytest.fixture(scope="module")
def forces(tmp_path_factory):
    return Forces(tmp_path_factory.getbasetemp())


def least_friction(forces, stances, facets=0):
    """The share of mu below which the load is refuted, by bisection; NaN where no mu up to 16 times as large carries it."""
    low, high = np.zeros(len(stances.mu)), np.full(len(stances.mu), 16.0)
    never = forces(stances.changed(mu=16.0 * stances.mu), facets).status == INFEASIBLE
    for _ in range(40):
        middle = 0.5 * (low + high)
        carried = forces(stances.changed(mu=middle[:, None] * stances.mu), facets).status != INFEASIBLE
        low, high = np.where(carried, low, middle), np.where(carried, middle, high)
    return np.where(never, np.nan, high)


def checked_exactly(stances, found, row):
    """Whether a verdict holds in 50 digits."""
    stance = stances[row : row + 1]
    if found.status[row] == OK:
        lacking, over = exactly_carried(stance, found.f[row])
        return max(lacking, over) <= 1e-9 * loads(stance)[0]
    whole, least, size = exactly_refuted(stance, found.certificate[row])
    return found.status[row] == INFEASIBLE and whole > 0.99 and least >= -ROUNDING * size


def compared(forces, seed, rows, k):
    """Verdicts beside Clarabel's: how many it leaves open; every difference is checked exactly and lies in the band."""
    stances, settings = random_stances(seed, rows, k), clarabel_settings()
    found = forces(stances)
    assert set(found.status) <= {OK, INFEASIBLE}
    answers = [by_clarabel(stances[row : row + 1], settings) for row in range(rows)]
    peer = np.array([VERDICTS.get(verdict, -1) for verdict, _ in answers])
    differ = np.flatnonzero(peer != found.status)
    for row in differ:
        assert checked_exactly(stances, found, row), (seed, row)
    wrong = differ[peer[differ] >= 0]
    if len(wrong):
        edge = least_friction(forces, stances[wrong])
        assert (np.abs(edge - 1.0) <= BAND).all(), (seed, wrong)
    both = np.flatnonzero((peer == OK) & (found.status == OK))
    errors = [np.abs(found.f[row] - answers[row][1]).max() / loads(stances[row : row + 1])[0] for row in both]
    return int((peer < 0).sum()), len(wrong), float(np.quantile(errors, 0.99))


@pytest.mark.parametrize("k", [3, 4, 6, 12])
def test_verdicts_are_clarabels(forces, k):
    undecided, _, error = compared(forces, 100 + k, 120, k)
    assert undecided <= 2
    assert error <= 1e-5  # Clarabel's


@pytest.mark.parametrize("facets", [4, 7])
def test_verdicts_on_pyramids_are_those_of_linear_programming(forces, facets):
    stances = random_stances(200 + facets, 80, 5)
    found = forces(stances, facets)
    for row in range(80):
        verdict = by_highs(stances[row : row + 1], facets)
        assert verdict == UNDECIDED or VERDICTS[verdict] == found.status[row], row


def near_the_edge(forces, seed, rows, k):
    """Clarabel confirms the least friction within the band; inside it every verdict holds in 50 digits. How many stances had an edge."""
    stances, settings = random_stances(seed, rows, k), clarabel_settings()
    edge = least_friction(forces, stances)
    some = np.flatnonzero(np.isfinite(edge) & (edge > 1e-3))
    stances, edge = stances[some], edge[some]
    for gap, verdict in ((BAND, REFUTED), (-BAND, CARRIED)):
        at = stances.changed(mu=(edge * (1.0 + gap))[:, None] * stances.mu)
        peer = [by_clarabel(at[row : row + 1], settings)[0] for row in range(len(some))]
        assert verdict not in peer
    for gap in (-1e-7, -1e-9, -1e-12, 1e-12, 1e-9, 1e-7):
        at = stances.changed(mu=(edge * (1.0 + gap))[:, None] * stances.mu)
        found = forces(at)
        assert set(found.status) <= {OK, INFEASIBLE, NO_CONVERGENCE}
        decided = np.flatnonzero(found.status != NO_CONVERGENCE)
        assert abs(gap) < 1e-8 or len(decided) >= 0.8 * len(some)
        assert all(checked_exactly(at, found, row) for row in decided)
    return len(some)


@pytest.mark.parametrize("k", [3, 5])
def test_edges_of_what_can_be_carried(forces, k):
    assert near_the_edge(forces, 300 + k, 12, k) >= 6


@pytest.mark.nightly
def test_a_hundred_thousand_stances(forces, record_property):
    """Beside Clarabel; a tenth of them on pyramids beside HiGHS, a fiftieth at their edges."""
    undecided = wrong = edges = 0
    start = time.monotonic()
    for seed in range(100):
        k = 3 + seed % 10
        open_ones, differ, _ = compared(forces, 1000 + seed, 1000, k)
        undecided, wrong = undecided + open_ones, wrong + differ
        stances = random_stances(5000 + seed, 100, k)
        found = forces(stances, 4)
        peer = [VERDICTS.get(by_highs(stances[row : row + 1], 4), -1) for row in range(100)]
        assert ((np.array(peer) == found.status) | (np.array(peer) < 0)).all(), seed
        edges += near_the_edge(forces, 9000 + seed, 10, k)
    record_property("sweep", f"{undecided} undecided, {wrong} differ in the band, {edges} edges, {time.monotonic() - start:.0f} s")

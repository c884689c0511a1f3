"""Random stances of 3 to 12 feet: whether they carry their load as Clarabel and HiGHS say; at the edge, as 50 digits say."""

import time

import numpy as np
import pytest
from contact_checks import exactly_carried, exactly_refuted, imbalance, loads, outside
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
    return Forces(tmp_path_factory.mktemp("forces"))


def least_friction(forces, stances, facets=0):
    """The share of mu below which the load is refuted, by bisection; NaN where no mu up to 16 times as large carries it."""
    low, high = np.zeros(len(stances.mu)), np.full(len(stances.mu), 16.0)
    never = forces(stances.changed(mu=16.0 * stances.mu), facets).status == INFEASIBLE
    for _ in range(40):
        middle = 0.5 * (low + high)
        carried = forces(stances.changed(mu=middle[:, None] * stances.mu), facets).status != INFEASIBLE
        low, high = np.where(carried, low, middle), np.where(carried, middle, high)
    return np.where(never, np.nan, high)


def checked_exactly(stances, found, row, facets=0):
    """Whether a verdict holds in 50 digits; of forces above 2e6 loads, to the rounding of their own entries."""
    stance = stances[row : row + 1]
    if found.status[row] == OK:
        lacking, over = exactly_carried(stance, found.f[row], facets)
        rounding = 2.0 * np.finfo(float).eps * np.abs(found.f[row]).max()
        return max(lacking, over) <= max(1e-9 * loads(stance)[0], rounding)
    whole, least, size = exactly_refuted(stance, found.certificate[row], facets)
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


def at_edge(stances, edge, gap):
    return stances.changed(mu=(edge * (1.0 + gap))[:, None] * stances.mu)


def with_edges(forces, seed, rows, k, facets=0):
    """Stances and the share of their friction that they need."""
    stances = random_stances(seed, rows, k)
    edge = least_friction(forces, stances, facets)
    some = np.flatnonzero(np.isfinite(edge) & (edge > 1e-3))
    return stances[some], edge[some]


def near_the_edge(forces, seed, rows, k):
    """The band's ends are decided and right: where Clarabel contradicts, 50 digits say who is. Inside it every verdict holds in 50 digits.

    How many stances had an edge, and how many were left open in the band: only where carrying means pressing by 1e6 loads and more.
    """
    stances, edge = with_edges(forces, seed, rows, k)
    settings, left = clarabel_settings(), 0
    for gap, wrong, status in ((BAND, REFUTED, OK), (-BAND, CARRIED, INFEASIBLE)):
        at = at_edge(stances, edge, gap)
        found = forces(at)
        assert (found.status == status).all(), (seed, gap)
        peer = np.array([by_clarabel(at[row : row + 1], settings)[0] for row in range(len(edge))])
        assert all(checked_exactly(at, found, row) for row in np.flatnonzero(peer == wrong)), (seed, gap)
    for gap in (-1e-7, -1e-9, -1e-12, 1e-12, 1e-9, 1e-7):
        at = at_edge(stances, edge, gap)
        found = forces(at)
        left += left_open(forces, stances, edge, found)
        assert all(checked_exactly(at, found, row) for row in np.flatnonzero(found.status != NO_CONVERGENCE)), (seed, gap)
    return len(edge), left


def left_open(forces, stances, edge, found, facets=0):
    """How many verdicts are missing; all of them where forces at the band's end are large already."""
    assert set(found.status) <= {OK, INFEASIBLE, NO_CONVERGENCE}
    missing = np.flatnonzero(found.status == NO_CONVERGENCE)
    if len(missing):
        some = at_edge(stances[missing], edge[missing], BAND)
        assert (np.abs(forces(some, facets).f).max((-1, -2)) >= 1e3 * loads(some)).all()
    return len(missing)


@pytest.mark.parametrize("k", [3, 5])
def test_edges_of_what_can_be_carried(forces, k):
    assert near_the_edge(forces, 300 + k, 12, k)[0] >= 6


@pytest.mark.parametrize("k", [3, 4, 12])
def test_no_verdict_is_missing_outside_the_band(forces, k):
    """Also where feet carry only by pressing against each other, ever harder towards the edge: 1e5 loads and more at the band's end."""
    stances, edge = with_edges(forces, 700 + k, 250, k)
    for gap in (BAND, 1e-5, 1e-3):
        above, below = at_edge(stances, edge, gap), at_edge(stances, edge, -gap)
        found = forces(above)
        assert (found.status == OK).all()
        assert max(imbalance(above, found.f).max(), outside(above, found.f).max()) <= 2e-9
        assert gap > BAND or k != 3 or (np.abs(found.f).max((-1, -2)) > 1e5 * loads(above)).any()
        assert (forces(below).status == INFEASIBLE).all()
    for gap in (-1e-7, -1e-10, -1e-12, 1e-12, 1e-10, 1e-7):
        found = forces(at_edge(stances, edge, gap))
        sure = gap < -1e-11  # nearer, the edge itself is not known
        assert left_open(forces, stances, edge, found) <= (0 if sure else 0.08 * len(edge))


@pytest.mark.parametrize("k", [4, 6])
def test_forces_near_the_edge_are_the_least(forces, k):
    """Forces times 1 - t and Clarabel's times t carry the load too: none of these has less of the sum."""
    stances, edge = with_edges(forces, 750 + k, 40, k)
    at = at_edge(stances, edge, 1e-4)
    found, settings = forces(at), clarabel_settings()
    peers = [by_clarabel(at[row : row + 1], settings) for row in range(len(edge))]
    solved = [row for row, (verdict, _) in enumerate(peers) if verdict == CARRIED]
    assert len(solved) >= len(edge) // 2
    for row in solved:
        f, other = found.f[row], peers[row][1]
        assert np.sum(f * (other - f)) >= -1e-5 * np.sum(f * f)
        assert np.sum(f * f) <= (1.0 + 1e-6) * np.sum(other * other)


@pytest.mark.parametrize(("facets", "k"), [(4, 3), (4, 9), (7, 4)])
def test_edges_of_pyramids(forces, facets, k):
    """Verdicts at the band's ends; within, few are missing, where the forces are large. All hold in 50 digits."""
    stances, edge = with_edges(forces, 950 + k, 40, k, facets)
    assert len(edge) >= 20
    for gap in (-BAND, -1e-7, -1e-9, -1e-12, 1e-12, 1e-9, 1e-7, BAND):
        at = at_edge(stances, edge, gap)
        found = forces(at, facets)
        given = np.flatnonzero(found.status != NO_CONVERGENCE)
        assert set(found.status[given]) <= {OK, INFEASIBLE}
        if abs(gap) == BAND or gap == -1e-7:
            assert (found.status == (OK if gap > 0.0 else INFEASIBLE)).all(), gap
        elif gap > 1e-10:
            assert left_open(forces, stances, edge, found, facets) <= 0.08 * len(edge)
        else:
            assert len(given) >= 0.92 * len(edge)
        assert all(checked_exactly(at, found, row, facets) for row in given), gap


@pytest.mark.nightly
def test_a_hundred_thousand_stances(forces, record_property):
    """Beside Clarabel; a tenth of them on pyramids beside HiGHS, a fiftieth at their edges."""
    undecided = wrong = edges = left = 0
    start = time.monotonic()
    for seed in range(100):
        k = 3 + seed % 10
        open_ones, differ, _ = compared(forces, 1000 + seed, 1000, k)
        undecided, wrong = undecided + open_ones, wrong + differ
        stances = random_stances(5000 + seed, 100, k)
        found = forces(stances, 4)
        peer = [VERDICTS.get(by_highs(stances[row : row + 1], 4), -1) for row in range(100)]
        assert ((np.array(peer) == found.status) | (np.array(peer) < 0)).all(), seed
        some, missing = near_the_edge(forces, 9000 + seed, 10, k)
        edges, left = edges + some, left + missing
    seen = f"{undecided} undecided, {wrong} differ in the band, {edges} edges, {left} verdicts in the band missing"
    record_property("sweep", f"{seen}, {time.monotonic() - start:.0f} s")

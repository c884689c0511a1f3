"""Targets out of reach: the rows hold the closest configurations, by a search that knows only the leg plane."""

from functools import cache

import numpy as np
import pytest
from legs import LEGS
from workspace import least_distances

OK, UNREACHABLE = 0, 1
SHEETS = (1, 1, -1, -1)
COUNT = 8


def targets(anatomy):
    """Around the leg, inside the hip cylinder, inside the folded leg's circle, near axis 1, and far away: [n, 3]."""
    generator = np.random.default_rng(29)
    a1, thigh, shank, w = anatomy.lengths
    folded, reach = abs(thigh - shank), anatomy.reach
    hip = np.hypot(a1, w)
    regions = [
        (generator.uniform(0, 2, COUNT) * reach, generator.uniform(-2, 2, COUNT) * reach),
        (generator.uniform(0, 1, COUNT) * abs(w), generator.uniform(-1, 1, COUNT) * reach),
        (np.abs(hip + generator.uniform(-0.7, 0.7, COUNT) * folded), generator.uniform(-0.7, 0.7, COUNT) * folded),
        (generator.uniform(0, 1e-6, COUNT) * reach, generator.uniform(-2, 2, COUNT) * reach),
        (generator.uniform(0, 50, COUNT) * reach, generator.uniform(-50, 50, COUNT) * reach),
    ]
    azimuths = generator.uniform(-np.pi, np.pi, (len(regions), COUNT))
    return np.concatenate([anatomy.point(*region, azimuth) for region, azimuth in zip(regions, azimuths, strict=True)])


def solved(leg, p):
    rows, status = leg.generated.inverse(p)
    distances = np.linalg.norm(leg.anatomy.foot(rows) - p[:, None], axis=-1)
    return rows, status, distances


@pytest.fixture(scope="module")
def searched(anatomies):
    """Targets of a leg and their least distances by sheet: searched once for all tests."""

    @cache
    def search(name):
        p = targets(anatomies[name])
        return p, {sheet: least_distances(anatomies[name], p, sheet) for sheet in (-1, 0, 1)}

    return search


@pytest.fixture(params=["c", "numpy"])
def either(request, specimen):
    return lambda name: specimen(name, request.param)


@pytest.mark.sampled(16)
@pytest.mark.parametrize("name", LEGS)
def test_rows_are_closest_on_their_sheets(either, searched, name):
    """Nothing on the sheet is closer, nor anywhere where the sheet is empty. Both rows of a sheet are equally close."""
    leg = either(name)
    p, found = searched(name)
    _, status, distances = solved(leg, p)
    for row, sheet in enumerate(SHEETS):
        least = np.where(np.isfinite(found[sheet]), found[sheet], found[0])
        out = status[:, row] == UNREACHABLE
        assert np.count_nonzero(out) > COUNT
        assert np.all((distances[:, row] <= least * (1 + 1e-14) + 1e-13 * leg.anatomy.reach)[out])
        assert np.mean((distances[:, row] >= least - 1e-6 * leg.anatomy.reach)[out]) > 0.9, "the search is too coarse to judge"
    for first, second in ((0, 1), (2, 3)):
        assert np.array_equal(status[:, first] == UNREACHABLE, status[:, second] == UNREACHABLE)
        assert np.max(np.abs(distances[:, first] - distances[:, second])) <= 1e-13 * np.max(distances)


@pytest.mark.parametrize("name", LEGS)
def test_the_best_row_is_as_far_as_the_workspace(either, searched, name):
    leg = either(name)
    p, found = searched(name)
    _, status, distances = solved(leg, p)
    least = found[0]
    out = np.all(status == UNREACHABLE, axis=1)
    gap = least[out] - np.min(distances[out], axis=1)
    assert np.all(gap >= -1e-9 * leg.anatomy.reach)
    assert np.mean(gap <= 1e-9 * (leg.anatomy.reach + least[out])) > 0.9
    assert np.all(least[out] > 1e-12 * leg.anatomy.reach)
    assert np.all(np.min(distances[~out], axis=1) <= 1e-12 * leg.anatomy.reach)


@pytest.mark.parametrize("name", LEGS)
def test_rows_lie_on_their_sheets(either, name):
    """rho keeps its sign where the sheet exists; all values are ordinary angles."""
    leg = either(name)
    p = targets(leg.anatomy)
    rows, status, _ = solved(leg, p)
    rho, _ = leg.anatomy.sides(rows)
    a1, thigh, shank, _ = leg.anatomy.lengths
    assert np.all((rows > -np.pi) & (rows <= np.pi))
    for row, sheet in enumerate(SHEETS):
        if sheet * a1 + thigh + shank > 0:
            assert np.all((rho[:, row] * sheet >= -1e-9 * leg.anatomy.reach)[status[:, row] == UNREACHABLE])


@pytest.mark.parametrize("name", LEGS)
def test_no_neighbour_is_closer(either, name):
    """Small steps of the joints from the best row never lead closer: a test without the leg plane."""
    leg = either(name)
    p = targets(leg.anatomy)
    rows, status, distances = solved(leg, p)
    out = np.all(status == UNREACHABLE, axis=1)
    best = rows[out, np.argmin(distances[out], axis=1)]
    steps = np.random.default_rng(2).normal(size=(300, 1, 3)) * 10.0 ** np.random.default_rng(3).uniform(-7, 0, (300, 1, 1))
    around = np.linalg.norm(leg.anatomy.foot(best + steps) - p[out], axis=-1)
    assert np.all(around >= np.min(distances[out], axis=1) - 1e-13 * np.max(distances[out], axis=1))

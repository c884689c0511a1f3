"""The contact forces in C and their NumPy reference, which finds them by an interior point: same verdicts, same forces, other proofs."""

import json
from pathlib import Path

import numpy as np
import pytest
from contact_checks import imbalance, loads, outside, refutation
from contact_library import Forces, Stances

from contact_stances import grasp, random_stances
from walkgen.runtime.solves.contact import Contact, contact_least_squares

OK, BAD_INPUT, INFEASIBLE = 0, 2, 5


@pytest.fixture(scope="module")
def forces(tmp_path_factory):
    return Forces(tmp_path_factory.mktemp("forces"))


def raw(*arguments):
    return Contact(*contact_least_squares(*arguments), np.zeros(0))


def reference(stances, facets=0):
    return raw(*vars(stances).values(), facets)


@pytest.mark.parametrize("facets", [0, 4, 7])
@pytest.mark.parametrize("k", [3, 4, 6])
def test_c_equals_its_reference(forces, k, facets):
    generator = np.random.default_rng(k)
    stances = random_stances(20 + k, 60, k)
    stances = stances.changed(weight=generator.uniform(0.3, 3.0, (60, k)), n_max=np.where(generator.random((60, k)) < 0.3, 150.0, np.inf))
    first, second = forces(stances, facets), reference(stances, facets)
    assert np.array_equal(first.status, second.status)
    assert {OK, INFEASIBLE} == set(first.status)
    good = first.status == OK
    assert (np.abs(first.f - second.f)[good].max((-1, -2)) / loads(stances)[good]).max() <= 1e-7
    assert (first.state != second.state)[good].mean() <= 0.01  # a foot near the surface of its cone
    assert refutation(stances, second, facets)[~good].max() < 0.0


def least_friction(forces, stances, facets):
    """Factors on mu [rows] with which the load is just carried, by halving; NaN where that is far."""
    low, high = np.zeros(len(stances.mu)), np.full(len(stances.mu), 8.0)
    for _ in range(50):
        middle = 0.5 * (low + high)
        fine = forces(stances.changed(mu=stances.mu * middle[:, None]), facets).status == OK
        low, high = np.where(fine, low, middle), np.where(fine, middle, high)
    return np.where((high > 1e-3) & (high < 7.9), high, np.nan)


@pytest.mark.parametrize("facets", [0, 4, 7])
def test_the_edge_of_what_can_be_carried(forces, facets):
    """A little more friction carries the load, a little less does not; of round cones few near stances stay open, no verdict is wrong."""
    stances = random_stances(40 + facets, 25, 4)
    edge = least_friction(forces, stances, facets)
    stances, edge = stances[edge > 0.0], edge[edge > 0.0]
    assert len(edge) >= 10
    for gap in (1e-6, 1e-7, 1e-8):
        more, less = (stances.changed(mu=stances.mu * (edge * (1.0 + step))[:, None]) for step in (gap, -gap))
        carried, refused = reference(more, facets), reference(less, facets)
        fine, proven = carried.status == OK, refused.status == INFEASIBLE
        assert min(fine.mean(), proven.mean()) >= (1.0 if facets else 0.8)
        assert not (carried.status == INFEASIBLE).any()
        assert not (refused.status == OK).any()
        assert imbalance(more[fine], carried.f[fine]).max() <= 1e-9
        assert outside(more[fine], carried.f[fine], facets).max() <= 1e-9
        assert refutation(less, refused, facets)[proven].max() < 0.0


@pytest.mark.parametrize("facets", [0, 4])
def test_the_edge_of_bounded_feet_has_no_wrong_verdict(forces, facets):
    stances = random_stances(60 + facets, 25, 4)
    stances = stances.changed(n_max=np.random.default_rng(facets).uniform(60.0, 400.0, stances.mu.shape))
    edge = least_friction(forces, stances, facets)
    stances, edge = stances[edge > 0.0], edge[edge > 0.0]
    assert len(edge) >= 10
    more, less = (reference(stances.changed(mu=stances.mu * (edge * (1.0 + step))[:, None]), facets) for step in (1e-8, -1e-8))
    assert not (more.status == INFEASIBLE).any()
    assert not (less.status == OK).any()
    assert (np.abs(less.certificate).sum(-1) > 0.0)[less.status == INFEASIBLE].all()


def test_published_stances():
    for case in json.loads((Path(__file__).parents[1] / "cases" / "forces_solo12.json").read_text())["stances"]:
        com, force = np.array(case["com"]), np.array(case["load_force"])
        wrench = np.concatenate([force, np.array(case["load_moment_about_com"]) + np.cross(com, force)])
        found = raw(case["feet"], case["normals"], case["mu"], wrench)
        assert found.status == (OK if case["feasible"] else INFEASIBLE)
        if case["feasible"]:
            assert np.abs(found.f - case["f"]).max() <= 1e-7 * np.linalg.norm(force)


@pytest.mark.parametrize("steps", [[0.0], [-1.0, 1.0], [-1.0, 0.2, 0.5, 1.4], [0.0, 0.0, 0.0]])
def test_feet_on_a_line(forces, steps):
    axis = np.array([0.48, -0.6, 0.64])
    points = np.array([0.1, -0.2, 0.05]) + np.array(steps)[:, None] * 0.3 * axis
    force = np.array([2.0, 1.0, -100.0])
    wrench = np.concatenate([force, np.cross([0.1, -0.2, 0.05], force)])
    stances = Stances.of([points, points], np.array([0.0, 0.0, 1.0]), 0.8, [wrench, wrench + np.concatenate([np.zeros(3), 0.5 * axis])])
    first, second = forces(stances), reference(stances)
    assert list(first.status) == list(second.status) == [OK, INFEASIBLE]
    assert np.abs(first.f[0] - second.f[0]).max() <= 1e-9 * 100.0
    for found in (first, second):
        assert np.abs(found.certificate[1] @ grasp(points)).max() <= 1e-11
        assert abs(found.certificate[1] @ stances.wrench[1] - 1.0) <= 1e-12
    assert second.violation[1] == np.inf


def test_reference_broadcasts_and_refuses():
    stances = random_stances(30, 6, 4)
    whole = reference(stances)
    parts = raw(
        stances.points.reshape(2, 3, 4, 3),
        stances.normals.reshape(2, 3, 4, 3),
        stances.mu.reshape(2, 3, 4),
        stances.wrench.reshape(2, 3, 6),
    )
    assert parts.f.shape == (2, 3, 4, 3)
    assert np.allclose(parts.f.reshape(6, 4, 3), whole.f, atol=1e-9 * 300.0, equal_nan=True)
    bad = stances.changed(mu=-stances.mu)
    assert (reference(bad).status == BAD_INPUT).all()
    assert np.isnan(reference(bad).f).all()
    assert (reference(stances, 2).status == BAD_INPUT).all()

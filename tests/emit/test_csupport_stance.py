"""The grasp map and the frictionless tripod in C: their references, balance, what is lost, moved and scaled stances, any input."""

import numpy as np
import pytest

from oracles.stances import O10_LOAD, O10_NORMAL_FORCES, O10_POINTS, moved, random_rotation, random_stance, unit
from walkgen.runtime.solves.contact_vertical import contact_vertical
from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, OK, SINGULAR, grasp

UP = np.tile([0.0, 0.0, 1.0], (3, 1))
COLLINEAR = np.array([[0.1, 0.2, 0.3], [0.2, 0.4, 0.2], [0.4, 0.8, 0.0]])
COINCIDENT = np.tile([0.7, -0.2, 0.1], (3, 1))


def about(points, rows):
    """Load components [n, 6] about the feet's centre instead of the frame's origin, whose moments count as forces times length."""
    centre = points.mean(axis=0)
    return np.concatenate([rows[:, :3] - np.cross(centre, rows[:, 3:]), rows[:, 3:]], axis=1)


@pytest.mark.parametrize("k", range(1, 17))
def test_grasp_is_its_reference(stances, k):
    points = np.array([3.0, -2.0, 1.0]) + np.random.default_rng(k).uniform(-1, 1, (k, 3))
    found, expected = stances.grasp(points), grasp(points)
    f = np.random.default_rng(9).normal(size=(k, 3))
    np.testing.assert_allclose(found[0] @ f.ravel(), [*f.sum(axis=0), *np.cross(points, f).sum(axis=0)], rtol=0, atol=1e-13 * k)
    np.testing.assert_allclose(found[0], expected[0].reshape(6, 3 * k), rtol=0, atol=1e-15)
    np.testing.assert_allclose(found[1], expected[1], rtol=0, atol=1e-13)
    assert found[4] == expected[4] == min(6, {1: 3, 2: 5}.get(k, 6))
    assert found[5] == expected[5] == (OK if k > 2 else SINGULAR)
    assert found[3] == pytest.approx(expected[3], rel=1e-12)


@pytest.mark.parametrize(("points", "rank"), [(COLLINEAR, 5), (COLLINEAR[:2], 5), (COINCIDENT, 3), (COINCIDENT[:1], 3)])
def test_what_is_lost(stances, points, rank):
    """Every force has lost . G f = 0, and the rows are independent: the null space of G' by its dimension."""
    G, singular, lost, condition, found, status = stances.grasp(points)
    reference = grasp(points)
    assert (found, status, condition) == (rank, SINGULAR, np.inf)
    np.testing.assert_array_equal(singular[rank:], 0.0)
    assert np.linalg.matrix_rank(lost) == 6 - rank == np.linalg.matrix_rank(np.vstack([lost, reference[2]]), tol=1e-12)
    np.testing.assert_allclose(lost @ G, 0.0, rtol=0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(about(points, lost)[: 6 - rank], axis=1), 1.0, rtol=1e-14)


def test_singular_values_depend_on_no_frame_and_unit(stances):
    rng = np.random.default_rng(4)
    points = rng.uniform(-1, 1, (4, 3))
    base = stances.grasp(points)[1]
    for scale, shift in ((1.0, 10.0), (1e-3, 0.0), (1e6, 1e6)):
        other = stances.grasp(scale * (points @ random_rotation(rng).T) + shift * rng.uniform(-1, 1, 3))[1]
        np.testing.assert_allclose(other, base, rtol=1e-12)


def test_normal_forces_of_a_tripod_on_a_plane(stances):
    f, status, state, violation = stances.vertical(O10_POINTS, UP, O10_LOAD)
    assert status == OK
    np.testing.assert_allclose(f[:, 2], O10_NORMAL_FORCES, rtol=0, atol=1e-11 * np.linalg.norm(O10_LOAD[:3]))
    np.testing.assert_array_equal(f[:, :2], 0.0)
    np.testing.assert_array_equal(state, 0)
    moments = O10_LOAD[5] - (O10_LOAD[1] * O10_POINTS.mean(axis=0)[0] - O10_LOAD[0] * O10_POINTS.mean(axis=0)[1])
    length = np.sqrt(np.mean(np.sum((O10_POINTS - O10_POINTS.mean(axis=0)) ** 2, axis=1)))
    assert violation == pytest.approx(np.sqrt(O10_LOAD[0] ** 2 + O10_LOAD[1] ** 2 + (moments / length) ** 2), rel=1e-12)


def test_vertical_is_its_reference_and_moves_with_the_stance(stances):
    rng = np.random.default_rng(1)
    states = set()
    for _ in range(100):
        points, normals, wrench = random_stance(rng, 3)
        found, expected = stances.vertical(points, normals, wrench), contact_vertical(points, normals, wrench)
        R, shift, order, factor = random_rotation(rng), rng.uniform(-1, 1, 3), rng.permutation(3), 10.0 ** rng.uniform(-3, 3)
        other_points, other_normals, other_wrench = moved(points, normals, wrench, R, shift)
        other = stances.vertical(other_points[order], other_normals[order], factor * other_wrench)
        states.add(int(found[1]))
        assert found[1] == expected[1] == other[1]
        tolerance = 1e-11 * np.linalg.norm(wrench)
        np.testing.assert_allclose(found[0], expected[0], rtol=0, atol=tolerance)
        np.testing.assert_allclose(other[0] / factor, found[0][order] @ R.T, rtol=0, atol=tolerance)
        np.testing.assert_allclose([found[3], other[3] / factor], expected[3], rtol=0, atol=tolerance)
    assert states == {OK, INFEASIBLE}


def test_a_foot_that_pulls(stances):
    weight = np.array([0.0, 0.0, -100.0])
    at = np.array([0.35, 0.0, 0.2])  # beyond foot 0
    f, status, _, violation = stances.vertical(O10_POINTS, UP, np.concatenate([weight, np.cross(at, weight)]))
    N = np.linalg.solve(np.vstack([np.ones(3), O10_POINTS[:, 0], O10_POINTS[:, 1]]), [100.0, 35.0, 0.0])
    assert status == INFEASIBLE
    assert np.isnan(f).all()
    assert violation == pytest.approx(-N.min(), rel=1e-12)


@pytest.mark.parametrize(
    ("points", "normals", "wrench", "expected"),
    [
        (COLLINEAR, UP, O10_LOAD, SINGULAR),
        (COINCIDENT, UP, O10_LOAD, SINGULAR),
        (O10_POINTS[:2], UP[:2], O10_LOAD, BAD_INPUT),
        (np.vstack([O10_POINTS, [[0.1, 0.1, 0.0]]]), np.tile(UP[:1], (4, 1)), O10_LOAD, BAD_INPUT),
        (O10_POINTS, 0.0 * UP, O10_LOAD, BAD_INPUT),
        (O10_POINTS, 1.001 * UP, O10_LOAD, BAD_INPUT),
        (O10_POINTS, UP, np.where(np.arange(6) == 4, np.nan, O10_LOAD), BAD_INPUT),
        (np.where(O10_POINTS == 0.3, np.inf, O10_POINTS), UP, O10_LOAD, BAD_INPUT),
        (O10_POINTS, unit(np.array([1.0, 0.0, 0.0]) + UP), 0.0 * O10_LOAD, OK),
    ],
)
def test_statuses(stances, points, normals, wrench, expected):
    found, reference = stances.vertical(points, normals, wrench), contact_vertical(points, normals, wrench)
    assert found[1] == reference[1] == expected
    assert np.isnan(found[0]).all() == (expected != OK)


SPECIAL = (0.0, -0.0, 5e-324, 1e-200, 1e-9, 0.3, -0.5, 1.0, 1e9, 1e160, -1e160, 1.7e308, np.inf, -np.inf, np.nan)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_any_input_has_an_answer(stances, dtype):
    """Numbers with status OK, NaN forces else; no load carried that is none."""
    rng = np.random.default_rng(2)
    for _ in range(300):
        inputs = [O10_POINTS.copy(), UP.copy(), O10_LOAD.copy()]
        for _ in range(2):
            chosen = inputs[rng.integers(3)]
            chosen.flat[rng.integers(chosen.size)] = rng.choice(SPECIAL)
        f, status, _, violation = stances.vertical(*inputs, dtype=dtype)
        assert np.isfinite(f).all() == (status == OK)
        assert np.isfinite(violation) or status in (BAD_INPUT, SINGULAR)
        *numbers, _, status = stances.grasp(inputs[0], dtype=dtype)
        assert np.isfinite(numbers[1]).all() == (status != BAD_INPUT)


def test_single_precision(stances):
    rng = np.random.default_rng(3)
    for _ in range(50):
        points, normals, wrench = random_stance(rng, 3)
        exact, single = stances.vertical(points, normals, wrench), stances.vertical(points, normals, wrench, dtype=np.float32)
        if exact[1] == single[1] == OK:
            np.testing.assert_allclose(single[0], exact[0], rtol=0, atol=1e-4 * np.linalg.norm(wrench))

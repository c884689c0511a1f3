"""Regions of centres of mass and disturbances in C beside linear and cone programs, the reference, and stances by hand."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from stability_library import Stability

from oracles.stability import cone_most, hull_margin, push_plane, pyramid_most, random_stand, weight_plane
from oracles.stances import random_rotation, unit
from walkgen.runtime.solves.feasible import disturbance_margin, feasible_region
from walkgen.runtime.solves.friction_margins import friction_share
from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, SINGULAR

UP = np.array([0.0, 0.0, 1.0])
GRAVITY = -9.81 * UP
SQUARE = np.array([[0.3, 0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0], [0.3, -0.2, 0.0]])
CENTRE = np.array([0.0, 0.0, 0.4])


@pytest.fixture(scope="module")
def stability(tmp_path_factory):
    return Stability(tmp_path_factory.mktemp("stability"))


def rough_stand(rng, k, slope):
    """Feet on slopes of their own [k,3], their normals, friction, and a centre of mass."""
    points, com = random_stand(rng, k)
    normals = unit(UP + slope * rng.uniform(-1.0, 1.0, (k, 3)))
    return points, normals, rng.uniform(0.3, 0.9, k), com


def farthest(polygon, u):
    return float((polygon[:, :2] @ u).max())


def is_convex_and_counterclockwise(polygon) -> bool:
    way = np.roll(polygon, -1, axis=0) - polygon
    after = np.roll(way, -1, axis=0)
    turns = way[:, 0] * after[:, 1] - way[:, 1] * after[:, 0]
    return bool((turns > -1e-12).all())


def is_square(polygon, close) -> bool:
    """Whether it has the corners of the feet."""
    apart = np.linalg.norm(polygon[:, None] - SQUARE, axis=-1)
    return len(polygon) == 4 and bool((apart.min(axis=0) <= close).all())


@pytest.mark.parametrize(("seed", "count"), [(1, 6), pytest.param(2, 60, marks=pytest.mark.nightly)])
def test_regions_beside_programs(stability, seed, count):
    """In any direction the polygon is inside what cones allow (Clarabel), no more than its error short of it; pyramids (HiGHS) agree."""
    rng = np.random.default_rng(seed)
    for turn in range(count):
        points, normals, mu, _ = rough_stand(rng, int(rng.integers(3, 7)), 0.5)
        polygon, error, status = stability.region(points, mu, normals)
        if status in (INFEASIBLE, SINGULAR):
            continue
        assert status == (OK if error <= 1e-4 else NO_CONVERGENCE)  # 64 directions may not do
        assert error >= 0.0
        assert is_convex_and_counterclockwise(polygon)
        load, plane = weight_plane()
        for angle in rng.uniform(0.0, 2 * np.pi, 4):
            u = np.array([np.cos(angle), np.sin(angle)])
            most = cone_most(points, normals, mu, load, plane, u)
            assert farthest(polygon, u) <= most + 1e-8
            assert most <= farthest(polygon, u) + error + 1e-8
            if turn < 3:
                inner, outer = (pyramid_most(points, normals, mu, load, plane, u, 64, outer=side) for side in (False, True))
                assert inner - 1e-9 <= farthest(polygon, u) + error
                assert farthest(polygon, u) <= outer + 1e-9


def test_corners_carry_the_weight_and_what_is_outside_does_not(stability):
    points, normals, mu, _ = rough_stand(np.random.default_rng(3), 4, 0.4)
    polygon, error, _ = stability.region(points, mu, normals)
    middle = polygon.mean(axis=0)
    inside, outside = (middle + factor * (polygon[::16] - middle) for factor in (1.0 - 1e-5, 1.02 + 3 * error))
    wrench = [np.concatenate([-UP, np.cross(at, -UP)]) for at in (*inside, *outside)]
    share, _ = friction_share(points, normals, mu, np.array(wrench))
    assert share[: len(inside)].max() <= 1.0 + 1e-6
    assert share[len(inside) :].min() > 1.0


def test_level_ground_has_the_support_polygon_whatever_the_friction(stability):
    for mu in (0.0, 0.01, 0.5, 5.0):
        polygon, error, status = stability.region(SQUARE, mu)
        assert status == OK
        assert error <= 1e-9
        assert is_square(polygon, 1e-9)


def test_a_tilted_plane_carries_up_to_its_friction_angle(stability):
    """A plane tilted by its friction angle carries nothing beyond; below it the region is the polygon seen along gravity."""
    for angle, fine in ((0.45, True), (0.47, False)):
        down = 9.81 * np.array([np.sin(angle), 0.0, -np.cos(angle)])
        polygon, _, status = stability.region(SQUARE, 0.5, UP, down)
        assert (status == OK) == fine  # atan(0.5) is 0.4636
        if fine:
            ahead = np.array([np.cos(angle), 0.0, np.sin(angle)])
            np.testing.assert_allclose(np.ptp(polygon @ ahead), 0.6 * np.cos(angle), rtol=0, atol=1e-7)
        else:
            assert status == INFEASIBLE


def test_the_friction_margin_is_the_distance_from_the_region(stability):
    rng = np.random.default_rng(4)
    signs = []
    for _ in range(25):
        points, normals, mu, com = rough_stand(rng, int(rng.integers(3, 7)), 0.5)
        polygon, _, status = stability.region(points, mu, normals, tolerance=1e-5)
        margins = stability.margins(points, com, [1.0, 0.0, 0.0], mu, normals)
        if status in (OK, NO_CONVERGENCE):
            assert margins.status == OK
            assert margins.friction == pytest.approx(hull_margin(polygon, com), abs=1e-4)
            signs.append(margins.friction > 0)
        else:
            assert (margins.status, np.isnan(margins.friction), np.isnan(margins.static_margin)) == (status, True, False)
    assert 5 < sum(signs) < len(signs)


def test_walls_pressed_apart_leave_it_unbounded(stability):
    """Three walls about the robot, with as much friction as it likes to use; three without any carry nothing."""
    angle = 2.0 * np.pi * np.arange(3) / 3.0
    points = 0.4 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    polygon, error, status = stability.region(points, 0.6, -points / 0.4)
    assert status == NO_CONVERGENCE
    assert np.isinf(error)
    assert len(polygon) > 2
    margins = stability.margins(points, CENTRE, [1.0, 0.0, 0.0], 0.6, -points / 0.4)
    assert (margins.status, np.isinf(margins.friction)) == (OK, True)
    assert stability.region(points, 0.0, -points / 0.4)[2] == INFEASIBLE


def test_feet_without_an_area(stability):
    assert stability.region(SQUARE[:2], 0.6)[2] == SINGULAR
    assert stability.region(SQUARE[:1], 0.6)[2] == SINGULAR
    assert stability.disturbance(SQUARE[:2], CENTRE + np.array([0.0, 0.2, 0.0]), 0.6, CENTRE)[2] == SINGULAR


@pytest.mark.parametrize(("seed", "count"), [(5, 5), pytest.param(6, 60, marks=pytest.mark.nightly)])
def test_disturbances_beside_programs(stability, seed, count):
    rng = np.random.default_rng(seed)
    for turn in range(count):
        points, normals, mu, com = rough_stand(rng, int(rng.integers(3, 7)), 0.2)
        com = np.append(points[:, :2].mean(axis=0), com[2])
        point = com + rng.uniform(-0.1, 0.1, 3)
        force, direction, status = stability.disturbance(points, com, mu, point, normals)
        if status == INFEASIBLE:
            continue
        assert status == OK
        load, plane = push_plane(com, point, 60 * 9.81)
        along = cone_most(points, normals, mu, load / 588.6, plane, direction[:2]) * 588.6
        assert along == pytest.approx(force, rel=1e-6)
        for angle in rng.uniform(0.0, 2 * np.pi, 6):
            u = np.array([np.cos(angle), np.sin(angle)])
            assert cone_most(points, normals, mu, load / 588.6, plane, u) * 588.6 >= force * (1 - 1e-6)
        if turn < 2:
            outer = pyramid_most(points, normals, mu, load / 588.6, plane, direction[:2], 64, outer=True) * 588.6
            assert force * (1 - 1e-8) <= outer


@pytest.mark.parametrize("seed", [24, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (0, 6, 18, 38))])
def test_pushes_by_which_feet_slip_in_any_direction(stability, seed):
    """Nearly as weak all round: the least over all directions by cone programs (Clarabel), minimised between 240 of them."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(3, 7))
    points, com = random_stand(rng, k)
    com = np.append(points[:, :2].mean(axis=0), com[2])
    rng.uniform(-1.0, 1.0, (k, 3))
    mu = np.full(k, 0.2) + (0.02 * rng.uniform(-1.0, 1.0, k) if seed % 3 else 0.0)
    point = com + rng.uniform(-0.02, 0.02, 3)
    normals = np.tile(UP, (k, 1))
    load, plane = push_plane(com, point, 588.6)

    def most(angle):
        return 588.6 * cone_most(points, normals, mu, load / 588.6, plane, np.array([np.cos(angle), np.sin(angle)]))

    step = 2.0 * np.pi / 240
    around = np.array([most(step * place) for place in range(240)])
    assert np.ptp(around) < 0.01 * around.min()
    low = [place for place in range(240) if around[place] <= min(around[place - 1], around[(place + 1) % 240], 1.002 * around.min())]
    options = {"xatol": 1e-9}
    least = min(minimize_scalar(most, bounds=(step * (at - 1), step * (at + 1)), method="bounded", options=options).fun for at in low)
    force, direction, status = stability.disturbance(points, com, mu, point, normals)
    assert status == OK
    assert force == pytest.approx(least, rel=1e-8)
    assert most(np.arctan2(direction[1], direction[0])) == pytest.approx(force, rel=1e-8)
    found, _, same = disturbance_margin(points, com, mu, point, normals, GRAVITY, 60.0, np.zeros(4))
    assert same == OK
    assert float(found) == pytest.approx(force, rel=1e-8)


@pytest.mark.parametrize(
    ("mu", "height", "force", "sideways"),
    [
        (0.2, 0.4, 0.2 * 588.6, None),  # slips before it tips: as well in any direction
        (5.0, 0.4, 588.6 * 0.2 / 0.4, 1),  # tips over a long side
        (5.0, 1.0, 588.6 * 0.2 / 1.0, 1),
    ],
)
def test_pushes_by_hand(stability, mu, height, force, sideways):
    found, direction, status = stability.disturbance(SQUARE, CENTRE, mu, [0.0, 0.0, height])
    assert status == OK
    assert found == pytest.approx(force, rel=1e-9)
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    assert direction[2] == 0.0
    if sideways is not None:
        assert abs(direction[sideways]) == pytest.approx(1.0)


def test_frames_sizes_and_order_of_feet_do_not_matter(stability):
    rng = np.random.default_rng(7)
    for _ in range(6):
        points, normals, mu, com = rough_stand(rng, 5, 0.2)
        com = np.append(points[:, :2].mean(axis=0), com[2])
        R, shift, order = random_rotation(rng), rng.normal(size=3), rng.permutation(5)
        force, direction, status = stability.disturbance(points, com, mu, com, normals)
        moved = (points @ R.T + shift)[order], R @ com + shift, mu[order], R @ com + shift, (normals @ R.T)[order]
        again, weakest, same = stability.disturbance(*moved, gravity=R @ GRAVITY)
        assert (status, same) == (OK, OK)
        assert again == pytest.approx(force, rel=1e-6)
        if np.linalg.norm(weakest - R @ direction) > 1e-4:  # nearly as weak in another direction
            back = R.T @ weakest
            load, plane = push_plane(com, com, 588.6)
            assert cone_most(points, normals, mu, load / 588.6, plane, back[:2]) * 588.6 == pytest.approx(force, rel=1e-6)


def test_the_reference_agrees(stability):
    rng = np.random.default_rng(8)
    for _ in range(2):
        points, normals, mu, com = rough_stand(rng, 4, 0.3)
        com = np.append(points[:, :2].mean(axis=0), com[2])
        polygon, _, status = stability.region(points, mu, normals, tolerance=1e-3)
        other, vertices, error, same = feasible_region(points, mu, normals, GRAVITY, np.zeros(4), 1e-3)
        assert status == same == OK
        assert error <= 1e-3
        for angle in np.linspace(0.0, 6.0, 9):
            u = np.array([np.cos(angle), np.sin(angle)])
            assert farthest(polygon, u) == pytest.approx(farthest(other[:vertices], u), abs=2e-3)
        force, _, status = stability.disturbance(points, com, mu, com, normals)
        found, _, same = disturbance_margin(points, com, mu, com, normals, GRAVITY, 60.0, np.zeros(4))
        assert status == same == OK
        assert force == pytest.approx(float(found), rel=1e-6)


@pytest.mark.parametrize(
    "change",
    [
        {"points": np.nan * SQUARE},
        {"mu": -0.1},
        {"mu": np.inf},
        {"normals": [0.0, 0.0, 0.5]},
        {"gravity": [0.0, 0.0, 0.0]},
        {"tolerance": 0.0},
        {"tolerance": np.nan},
    ],
)
def test_bad_input_has_its_status(stability, change):
    polygon, error, status = stability.region(**({"points": SQUARE, "mu": 0.6} | change))
    assert status == BAD_INPUT
    assert len(polygon) == 0
    assert np.isnan(error)
    if "tolerance" not in change:
        pushed = {"points": SQUARE, "com": CENTRE, "mu": 0.6, "point": CENTRE} | change
        assert stability.disturbance(**pushed)[2] == BAD_INPUT


def test_single_precision(stability):
    polygon, _, status = stability.region(SQUARE, 0.5, tolerance=1e-2, dtype=np.float32)
    assert status == OK
    assert is_square(polygon, 2e-3)
    force, _, status = stability.disturbance(SQUARE, CENTRE, 0.2, CENTRE, dtype=np.float32)
    assert status == OK
    assert force == pytest.approx(0.2 * 588.6, rel=5e-3)

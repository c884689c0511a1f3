"""Nearest points: on the surface, along its normal, no farther than a fine grid's nearest; statuses of points that have none."""

import numpy as np
import pytest

from terrain.grounds import explicit, spec

WAVES = "0.2*sin(2*x)*cos(1.5*y) + 0.1*x*y"
PLANE = 'surface = "plane"\npoint = [0.1, 0.2, 0.3]\nnormal = [1, -2, 3]'
FUNCTIONS = ("height", "normal", "project")
PATCHES = {
    "explicit": explicit(WAVES),
    "implicit": f'surface = "implicit"\nf = "({WAVES} - z)*(2 + sin(x))"',
    "parametric": f'surface = "parametric"\nx = "u"\ny = "v + u/8"\nz = "{WAVES.replace("x", "u").replace("y", "(v + u/8)")}"\n'
    "domain = { u = [-3, 3], v = [-3, 3] }",
    "plane": PLANE,
}


def waves(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return 0.2 * np.sin(2 * x) * np.cos(1.5 * y) + 0.1 * x * y


def points(count: int, seed: int = 9) -> np.ndarray:
    return np.random.default_rng(seed).uniform([-1, -1, -0.4], [1, 1, 0.6], (count, 3))


def grid_distance(p: np.ndarray) -> np.ndarray:
    """Least distance to the waves over a grid of 1 cm around each point."""
    span = np.arange(-1.0, 1.0, 0.01)
    dx, dy = np.meshgrid(span, span)
    return np.array([np.sqrt((dx**2 + dy**2 + (waves(x + dx, y + dy) - z) ** 2).min()) for x, y, z in p])


@pytest.mark.parametrize("kind", PATCHES)
def test_nearest_points_are_on_the_surface_along_its_normal(built, kind: str) -> None:
    robot = built(spec(PATCHES[kind], functions=FUNCTIONS))
    p = points(60)
    found = {backend: getattr(robot, backend).terrain.project(p) for backend in ("c", "numpy")}
    foot, status = found["c"]
    ground = robot.c.terrain
    assert np.all(status == 0)
    np.testing.assert_allclose(found["numpy"][0], foot, atol=1e-9)
    assert np.array_equal(found["numpy"][1], status)
    np.testing.assert_allclose(ground.height(foot), foot[:, 2], atol=1e-9)
    np.testing.assert_allclose(np.cross(p - foot, ground.normal(foot)), 0, atol=1e-9)
    if kind == "plane":
        np.testing.assert_allclose((foot - [0.1, 0.2, 0.3]) @ [1, -2, 3], 0, atol=1e-14)
    else:
        distance = np.linalg.norm(p - foot, axis=-1)
        assert np.all(distance <= np.abs(p[:, 2] - waves(p[:, 0], p[:, 1])) + 1e-12)
        assert np.mean(distance <= grid_distance(p) + 1e-4) > 0.95


def test_far_points_still_find_a_stationary_foot(built) -> None:
    ground = built(spec(PATCHES["explicit"], functions=FUNCTIONS)).c.terrain
    p = np.random.default_rng(1).uniform(-5, 5, (500, 3))
    foot, status = ground.project(p)
    assert np.all(status == 0)
    np.testing.assert_allclose(np.cross(p - foot, ground.normal(foot)), 0, atol=1e-7)


def test_feet_beyond_the_domain_are_unreachable_and_stay_over_the_point(built) -> None:
    patches = (explicit("x", "domain = { x = [0, 1], y = [0, 1] }"), PLANE + "\ndomain = { x = [2, 3], y = [0, 1] }")
    ground = built(spec(*patches, functions=FUNCTIONS)).c.terrain
    p = np.array([[0.2, 0.5, 2.0], [0.8, 0.5, 2.0], [0.5, 0.5, 0.7], [2.05, 0.5, 9.0], [1.5, 0.5, 0], [np.nan, 0, 0], [0.5, 0.5, np.inf]])
    foot, status = ground.project(p)
    assert status.tolist() == [1, 1, 0, 1, 1, 2, 2]
    np.testing.assert_allclose(foot[0], [0.2, 0.5, 0.2])
    np.testing.assert_allclose(foot[1], [0.8, 0.5, 0.8])
    np.testing.assert_allclose(foot[2], [0.6, 0.5, 0.6])
    assert foot[3, 0] == 2.05
    assert np.isnan(foot[4:]).all()
    assert not np.isnan(foot[status == 0]).any()


@pytest.mark.nightly
@pytest.mark.parametrize("kind", PATCHES)
def test_many_points(built, kind: str) -> None:
    ground = built(spec(PATCHES[kind], functions=FUNCTIONS)).c.terrain
    p = points(100_000, 21)
    foot, status = ground.project(p)
    fine = status == 0
    assert fine.mean() > 0.999
    np.testing.assert_allclose(ground.height(foot[fine]), foot[fine][:, 2], atol=1e-8)
    np.testing.assert_allclose(np.cross(p - foot, ground.normal(foot))[fine], 0, atol=1e-8)
    assert set(np.unique(status)) <= {0, 1, 4}

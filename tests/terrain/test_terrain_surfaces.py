"""Implicit and parametric patches in C, NumPy and CasADi: the same surface written in several ways, curvature of spheres and cylinders."""

import numpy as np
import pytest

from terrain.grounds import explicit, spec

BACKENDS = ("c", "numpy")
R = 1.5
SPHERE = f'surface = "implicit"\nf = "x**2 + y**2 + (z - 0.5)**2 - {R}**2"'
CYLINDER = 'surface = "implicit"\nf = "((x - 2*y)**2)/5 + z**2 - 0.25"'
CAP = explicit(f"0.5 + sqrt({R}**2 - x**2 - y**2)")
DOME = (
    f'surface = "parametric"\nx = "{R}*sin(u)*cos(v)"\ny = "{R}*sin(u)*sin(v)"\nz = "0.5 + {R}*cos(u)"\n'
    'domain = { u = [0.05, "pi/2 - 0.05"], v = ["-pi", "pi"] }'
)


def inside(radius: float, count: int = 100, seed: int = 2) -> np.ndarray:
    """Points over a ring, at heights around and above the sphere's upper half."""
    rng = np.random.default_rng(seed)
    distance, angle = radius * np.sqrt(rng.uniform(0.01, 1, count)), rng.uniform(-np.pi, np.pi, count)
    return np.stack([distance * np.cos(angle), distance * np.sin(angle), rng.uniform(0.6, 4, count)], -1)


@pytest.fixture(scope="module")
def spheres(built):
    functions = ("height", "normal", "curvature", "patch", "project")
    return {
        name: built(spec(keys, functions=functions, casadi=name != "explicit"))
        for name, keys in (("implicit", SPHERE), ("explicit", CAP), ("parametric", DOME))
    }


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_sphere_is_the_same_in_three_ways_and_as_round_as_it_is(spheres, backend: str) -> None:
    p = inside(1.4)
    z = 0.5 + np.sqrt(R**2 - (p[:, :2] ** 2).sum(-1))
    for robot in spheres.values():
        ground = getattr(robot, backend).terrain
        assert np.all(ground.patch(p) == 0)
        np.testing.assert_allclose(ground.height(p), z, atol=1e-12)
        n = np.stack([p[:, 0], p[:, 1], z - 0.5], -1) / R
        np.testing.assert_allclose(ground.normal(p), n, atol=1e-12)
        np.testing.assert_allclose(ground.curvature(p), np.broadcast_to(-np.eye(2) / R, (len(p), 2, 2)), atol=1e-11)
        foot, status = ground.project(p)
        assert np.all(status == 0) or robot is spheres["parametric"]
        away = p - [0, 0, 0.5]
        expected = [0, 0, 0.5] + R * away / np.linalg.norm(away, axis=-1, keepdims=True)
        np.testing.assert_allclose(foot[status == 0], expected[status == 0], atol=1e-9)
        assert (status == 0).mean() > 0.8


def test_newton_from_below_finds_the_lower_half_and_far_points_the_nearer_one(spheres) -> None:
    ground = spheres["implicit"].c.terrain
    p = np.array([[0.3, 0.2, -3.0], [0.3, 0.2, 1e3], [0.3, 0.2, 0.5], [1.6, 0, 0], [0, 0, np.nan], [np.nan, 0, 0]])
    half = np.sqrt(R**2 - 0.13)
    np.testing.assert_allclose(ground.height(p), [0.5 - half, 0.5 + half, 0.5 + half, np.nan, np.nan, np.nan], atol=1e-12)
    assert ground.normal(p[0])[2] > 0  # upwards inside the hollow half, too
    np.testing.assert_allclose(ground.curvature(p[0]), np.eye(2) / R, atol=1e-12)
    np.testing.assert_allclose(ground.curvature(p[1]), -np.eye(2) / R, atol=1e-12)
    assert ground.patch(p).tolist() == [0, 0, 0, -1, -1, -1]
    assert ground.project(p)[1].tolist()[3:] == [1, 2, 2]


def test_a_cylinder_bends_in_one_direction(built) -> None:
    axis = np.array([2.0, 1.0, 0.0]) / np.sqrt(5)
    ground = built(spec(CYLINDER, functions=("height", "tangents", "curvature"))).c.terrain
    rng = np.random.default_rng(4)
    across = rng.uniform(-0.45, 0.45, 100)
    p = rng.uniform(-2, 2, (100, 1)) * axis + across[:, None] * np.array([1.0, -2.0, 0]) / np.sqrt(5) + [0, 0, 0.5]
    np.testing.assert_allclose(ground.height(p), np.sqrt(0.25 - across**2), atol=1e-12)
    values, vectors = np.linalg.eigh(ground.curvature(p))
    np.testing.assert_allclose(values, np.broadcast_to([-2.0, 0.0], values.shape), atol=1e-11)
    straight = np.einsum("...i,...ij->...j", vectors[..., 1], ground.tangents(p))
    np.testing.assert_allclose(np.abs(straight @ axis), 1, atol=1e-12)


def test_a_parametric_torus_has_the_textbooks_curvatures_and_its_nearer_side(built) -> None:
    keys = (
        'surface = "parametric"\nx = "(2 + cos(u)/2)*cos(v)"\ny = "(2 + cos(u)/2)*sin(v)"\nz = "sin(u)/2"\n'
        'domain = { u = ["-pi", "pi"], v = ["-pi", "pi"] }'
    )
    robot = built(spec(keys, functions=("height", "curvature", "patch")))
    rng = np.random.default_rng(6)
    u, v = rng.uniform(0.3, np.pi - 0.3, 100), rng.uniform(-np.pi, np.pi, 100)
    u = np.concatenate([u, -u])
    v = np.concatenate([v, v])
    radius = 2 + np.cos(u) / 2
    p = np.stack([radius * np.cos(v), radius * np.sin(v), np.sin(u) / 2 + 0.1 * np.sign(u)], -1)
    for backend in BACKENDS:
        ground = getattr(robot, backend).terrain
        np.testing.assert_allclose(ground.height(p), np.sin(u) / 2, atol=1e-12)
        bending = -np.sign(u)[:, None] * np.sort(np.stack([0 * u + 2, np.cos(u) / radius], -1), -1)
        np.testing.assert_allclose(np.linalg.eigvalsh(ground.curvature(p)), np.sort(bending, -1), atol=1e-10)
    outside = [[0, 0, 0], [2.51, 0, 0], [1.49, 0, 0]]
    assert np.all(robot.c.terrain.patch(outside) == -1)


def test_only_part_of_a_parametric_surface_is_there(built) -> None:
    """(u, v) in D, not in all of the plane (erratum 17)."""
    keys = 'surface = "parametric"\nx = "u + v/4"\ny = "v - u/4"\nz = "u*v"\ndomain = { u = [0, 1], v = [-1, 1] }\nmu = 0.4'
    ground = built(spec(keys, explicit("-9"), functions=("height", "patch"))).c.terrain
    u, v = np.random.default_rng(7).uniform([-0.5, -1.5], [1.5, 1.5], (200, 2)).T
    p = np.stack([u + v / 4, v - u / 4, 0 * u], -1)
    held = (u >= 0) & (u <= 1) & (np.abs(v) <= 1)
    assert np.array_equal(ground.patch(p) == 0, held)
    np.testing.assert_allclose(ground.height(p), np.where(held, u * v, -9), atol=1e-12)


def test_where_a_surface_is_not_regular_there_is_no_normal(built) -> None:
    """(A, B, C) = 0: the tip of a cone."""
    tip = built(spec(explicit("-hypot(x, y)"), functions=("height", "normal", "curvature", "project"))).c.terrain
    assert tip.height([0, 0, 0]) == 0
    assert np.isnan(tip.normal([0, 0, 0])).all()
    assert np.isnan(tip.curvature([0, 0, 0])).all()
    assert tip.project([0, 0, 0])[1] != 0
    below = np.array([[0.3, -0.2, -2.0]])
    foot, status = tip.project(below)
    assert status.tolist() == [0]
    np.testing.assert_allclose(np.cross(below - foot, tip.normal(foot)), 0, atol=1e-12)


@pytest.mark.parametrize("name", ["implicit", "parametric"])
def test_casadi_has_the_searches_too_with_derivatives(spheres, name: str) -> None:
    casadi = pytest.importorskip("casadi")
    robot = spheres[name].c
    p = inside(1.2, 5)
    for function in ("height", "normal"):
        form = robot.casadi(f"terrain_{function}")
        np.testing.assert_allclose(np.array([form(row) for row in p]).squeeze(), getattr(robot.terrain, function)(p), atol=1e-12)
    x = casadi.MX.sym("p", 3)
    slope = casadi.Function("slope", [x], [casadi.jacobian(robot.casadi("terrain_height")(x), x)])
    n = robot.terrain.normal(p)
    np.testing.assert_allclose(np.array([np.array(slope(row))[0, :2] for row in p]), -n[:, :2] / n[:, 2:], atol=1e-9)

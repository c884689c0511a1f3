"""Margins of static stability in C beside scipy's hulls, rotations step by step and the reference; symmetries, gradients, any input."""

import numpy as np
import pytest
from stability_library import Stability

from oracles.stability import (
    O15_COM,
    O15_ENERGY,
    O15_HEIGHTS,
    O15_LONGITUDINAL,
    O15_POINTS,
    O15_STATIC,
    hull_margin,
    random_stand,
    rise,
)
from oracles.stances import random_rotation
from walkgen.runtime.solves.stability import stability_margins, stability_margins_d_com
from walkgen.runtime.solves.stance import BAD_INPUT, OK, SINGULAR

GRAVITY = np.array([0.0, 0.0, -9.81])
AHEAD = np.array([1.0, 0.0, 0.0])
SQUARE = np.array([[0.3, 0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0], [0.3, -0.2, 0.0]])
CENTRE = np.array([0.0, 0.0, 0.4])
EXACT = ("static_margin", "longitudinal", "energy", "height", "friction", "heights")


@pytest.fixture(scope="module")
def stability(tmp_path_factory):
    return Stability(tmp_path_factory.mktemp("stability"))


def reference(points, com, direction, mu=np.inf, normals=0.0, gravity=GRAVITY, mass=60.0):
    k = len(points)
    given = np.broadcast_to(mu, k), np.broadcast_to(normals, (k, 3))
    return stability_margins(points, com, direction, *given, gravity, mass, np.zeros(4))


@pytest.mark.parametrize("kind", ["c", "numpy"])
def test_the_example(stability, kind):
    found = (stability.margins if kind == "c" else reference)(O15_POINTS, O15_COM, AHEAD)
    assert found.status == OK
    assert found.static_margin == pytest.approx(O15_STATIC, abs=1e-12)
    np.testing.assert_allclose(found.longitudinal, O15_LONGITUDINAL, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.heights, O15_HEIGHTS, rtol=0, atol=1e-12)
    assert found.energy == pytest.approx(O15_ENERGY, abs=1e-12)
    assert found.height == pytest.approx(O15_HEIGHTS.min(), abs=1e-12)
    assert (found.polygon.tolist(), found.vertices, found.edge.tolist()) == ([0, 1, 2, 3], 4, [0, 1])
    assert found.friction == found.static_margin


def test_the_example_in_float(stability):
    found = stability.margins(O15_POINTS, O15_COM, AHEAD, 0.6, dtype=np.float32)
    assert found.status == OK
    assert found.static_margin == pytest.approx(O15_STATIC, abs=1e-6)
    np.testing.assert_allclose(found.heights, O15_HEIGHTS, rtol=0, atol=1e-6)
    assert found.friction == pytest.approx(O15_STATIC, abs=1e-3)


def test_lifting_a_foot_of_the_quadruped(stability):
    """O17: without its front left foot the platform is shifted, or turned about the line between that foot's neighbours."""
    feet, com = np.array([[0.35, -0.3, 0.0], [-0.35, 0.3, 0.0], [-0.35, -0.3, 0.0]]), np.array([0.03, 0.0, 0.4])
    before = stability.margins(feet, com, AHEAD).static_margin
    normal = stability.gradients(feet, com, AHEAD).static_margin
    assert before == pytest.approx(-0.019523741203679, abs=1e-12)
    np.testing.assert_allclose((0.05 - before) * normal[:2], [-0.04524545102573959, -0.05278635953002952], rtol=0, atol=1e-12)
    assert stability.margins(feet, com + (0.05 - before) * normal, AHEAD).static_margin == pytest.approx(0.05, abs=1e-12)
    far = np.hypot(before, 0.4)
    swing = np.arccos(before / far) - np.arccos(0.05 / far)
    assert swing == pytest.approx(0.17394867401916714, abs=1e-12)
    turned = com + normal * (far * np.cos(np.arccos(before / far) - swing) - before)
    assert stability.margins(feet, turned, AHEAD).static_margin == pytest.approx(0.05, abs=1e-12)


def test_static_margins_of_many_hulls(stability):
    rng = np.random.default_rng(1)
    inside = 0
    for _ in range(1000):
        points, com = random_stand(rng, int(rng.integers(3, 17)))
        found = stability.margins(points, com, AHEAD)
        assert found.status == OK
        assert found.static_margin == pytest.approx(hull_margin(points, com), abs=1e-13)
        inside += found.static_margin > 0
    assert 300 < inside < 900


def test_edges_are_lines_about_which_it_turns(stability):
    """Height to tip by turning step by step; past an edge minus it; the ways along a crab's direction end on the border."""
    rng = np.random.default_rng(2)
    past = 0
    for _ in range(60):
        points, com = random_stand(rng, int(rng.integers(3, 9)))
        ahead = np.append(rng.normal(size=2), rng.normal())
        found = stability.margins(points, com, ahead)
        ends = [(points[i], points[j]) for i, j in edges(found)]
        heights = np.array([rise(*pair, com) for pair in ends])
        sides = np.array([np.cross(b - a, com - a)[2] for a, b in ends])
        np.testing.assert_allclose(found.heights[: found.vertices], heights * np.sign(sides), rtol=0, atol=1e-10)
        assert found.energy == pytest.approx(60 * 9.81 * found.height, rel=1e-14)
        past += bool((sides < 0).any())
        level = ahead[:2] / np.linalg.norm(ahead[:2])
        if found.static_margin > 0:
            for sign, way in zip((1, -1), found.longitudinal, strict=True):
                border = com + np.append(sign * way * level, 0.0)
                assert hull_margin(points, border) == pytest.approx(0.0, abs=1e-13)
        else:
            assert found.longitudinal.min() < 0 or found.static_margin > -0.5
    assert 5 < past < 50


def edges(found):
    used = found.polygon[: found.vertices]
    return list(zip(used, np.roll(used, -1), strict=True))


def test_past_the_front_is_negative_by_how_far(stability):
    found = stability.margins(SQUARE, CENTRE + np.array([0.35, 0.0, 0.0]), AHEAD)
    np.testing.assert_allclose(found.longitudinal, [-0.05, 0.65], rtol=0, atol=1e-15)
    assert found.static_margin == pytest.approx(-0.05, abs=1e-15)
    assert found.energy < 0


def test_frames_and_order_of_feet_do_not_matter(stability):
    rng = np.random.default_rng(3)
    for _ in range(40):
        points, com = random_stand(rng, int(rng.integers(3, 9)))
        mu, ahead = rng.uniform(0.2, 1.0, len(points)), np.append(rng.normal(size=2), 0.0)
        R, shift, order = random_rotation(rng), rng.normal(size=3), rng.permutation(len(points))
        found = stability.margins(points, com, ahead, mu)
        moved = (points @ R.T + shift)[order], R @ com + shift, R @ ahead
        again = stability.margins(*moved, mu[order], gravity=R @ GRAVITY)
        assert again.status == found.status == OK
        for name in ("static_margin", "longitudinal", "energy", "height"):
            np.testing.assert_allclose(getattr(again, name), getattr(found, name), rtol=0, atol=1e-12 * (600 if name == "energy" else 1))
        assert again.friction == pytest.approx(found.friction, abs=1e-9)
        assert {order[i] for i in again.polygon[: again.vertices]} == set(found.polygon[: found.vertices])
        assert [order[i] for i in again.edge] == found.edge.tolist()


def test_gradients_by_differences(stability):
    """Away from ties: of two edges as near, or two feet."""
    rng = np.random.default_rng(4)
    for _ in range(40):
        points, com = random_stand(rng, int(rng.integers(3, 9)))
        mu, ahead = rng.uniform(0.2, 1.0, len(points)), np.append(rng.normal(size=2), 0.0)
        slopes = stability.gradients(points, com, ahead, mu)
        assert slopes.status == OK
        for name in ("static_margin", "longitudinal", "height", "energy", "friction"):
            step = 1e-6
            ways = [
                np.asarray(getattr(stability.margins(points, com + side * step * axis, ahead, mu), name))
                for axis in np.eye(3)
                for side in (1, -1)
            ]
            differences = np.stack([(ways[2 * i] - ways[2 * i + 1]) / (2 * step) for i in range(3)], axis=-1)
            loose = 1e-3 if name == "friction" else 1e-6
            np.testing.assert_allclose(getattr(slopes, name), differences, rtol=loose, atol=loose)


def test_the_reference_agrees(stability):
    rng = np.random.default_rng(5)
    for turn in range(10):
        points, com = random_stand(rng, int(rng.integers(3, 9)))
        mu, ahead = rng.uniform(0.2, 1.0, len(points)) if turn % 2 else np.full(len(points), np.inf), rng.normal(size=3)
        given = points, com, ahead, mu
        mine, other = stability.margins(*given), reference(*given)
        slopes, others = stability.gradients(*given), stability_margins_d_com(*given, np.zeros_like(points), GRAVITY, 60.0, np.zeros(4))
        assert mine.status == other.status == slopes.status == others.status == OK
        for name in EXACT:
            np.testing.assert_allclose(getattr(mine, name), getattr(other, name), rtol=1e-9, atol=1e-9 if name == "friction" else 1e-12)
        for name in ("polygon", "vertices", "edge"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(other, name))
        for name in ("static_margin", "longitudinal", "energy", "height", "friction"):
            np.testing.assert_allclose(getattr(slopes, name), getattr(others, name), rtol=1e-6, atol=1e-6)


MIDDLES = np.array([[0.0, 0.2, 0.1], [0.3, 0.0, -0.1], [0.1, -0.2, 0.0]])


@pytest.mark.parametrize("kind", ["c", "numpy"])
@pytest.mark.parametrize(
    ("points", "polygon"),
    [
        (np.concatenate([MIDDLES, SQUARE]), [3, 4, 5, 6]),  # feet between others are no corners
        (np.concatenate([SQUARE, SQUARE]), [0, 1, 2, 3]),  # of feet in one place the first
        (np.concatenate([SQUARE + np.array([0, 0, 0.1]), SQUARE]), [4, 5, 6, 7]),  # of feet one above another the lowest
        (np.concatenate([SQUARE, 0.5 * SQUARE, [[0.0, 0.0, 0.3]]]), [0, 1, 2, 3]),
    ],
)
def test_feet_that_are_no_corners(stability, kind, points, polygon):
    margins = stability.margins if kind == "c" else reference
    for angle in np.linspace(0.0, 3.0, 7):
        c, s = np.cos(angle), np.sin(angle)
        R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        found = margins(points @ R.T, CENTRE, R @ AHEAD)
        assert found.status == OK
        assert found.polygon.tolist() == polygon + [-1] * (len(points) - 4)
        assert found.static_margin == pytest.approx(0.2, abs=1e-14)
        np.testing.assert_allclose(found.longitudinal, 0.3, rtol=0, atol=1e-14)
        assert np.isinf(found.heights[4:]).all()


@pytest.mark.parametrize("kind", ["c", "numpy"])
@pytest.mark.parametrize(
    ("points", "static"),
    [
        (SQUARE[:1], -np.hypot(0.3, 0.2)),
        (SQUARE[:2], -0.2),
        (SQUARE[[0, 2]], 0.0),
        (np.array([[0.1, 0.0, 0.0], [0.2, 0.0, 0.5], [0.4, 0.0, 0.1]]), -0.1),
        (np.tile(SQUARE[:1], (5, 1)), -np.hypot(0.3, 0.2)),
    ],
)
def test_feet_on_a_line_have_a_static_margin_only(stability, kind, points, static):
    found = (stability.margins if kind == "c" else reference)(points, CENTRE, AHEAD)
    assert found.status == SINGULAR
    assert found.static_margin == pytest.approx(static, abs=1e-14)
    assert np.isnan([found.energy, found.height, found.friction, *found.longitudinal, *found.heights]).all()
    assert found.edge.tolist() == [-1, -1]


BAD = {
    "points": {"points": SQUARE + np.array([[np.nan], [0], [0], [0]])},
    "infinite point": {"points": SQUARE + np.array([[np.inf], [0], [0], [0]])},
    "com": {"com": [0.0, np.nan, 0.4]},
    "no direction": {"direction": [0.0, 0.0, 0.0]},
    "along gravity": {"direction": [0.0, 0.0, 1.0]},
    "direction": {"direction": [np.nan, 0.0, 0.0]},
    "mu below 0": {"mu": [0.5, 0.5, -0.1, 0.5]},
    "mu": {"mu": [0.5, 0.5, np.nan, 0.5]},
    "some mu infinite": {"mu": [0.5, 0.5, np.inf, 0.5]},
    "normals": {"mu": 0.5, "normals": [0.0, 0.0, 0.9]},
    "gravity": {"gravity": [0.0, np.nan, -9.81]},
    "no gravity": {"gravity": [0.0, 0.0, 0.0]},
    "mass below 0": {"mass": -1.0},
    "mass": {"mass": np.nan},
}


@pytest.mark.parametrize("kind", ["c", "numpy"])
@pytest.mark.parametrize("change", BAD)
def test_bad_input_has_its_status(stability, kind, change):
    given = {"points": SQUARE, "com": CENTRE, "direction": AHEAD} | BAD[change]
    found = (stability.margins if kind == "c" else reference)(**given)
    assert found.status == BAD_INPUT
    assert np.isnan([found.static_margin, found.energy, found.height, found.friction, *found.longitudinal, *found.heights]).all()
    assert (found.polygon.tolist(), found.vertices, found.edge.tolist()) == ([-1] * 4, 0, [-1, -1])
    if kind == "c":
        assert stability.gradients(**given).status == BAD_INPUT

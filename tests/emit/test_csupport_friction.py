"""The least friction and the margins in C: proofs from both sides, linear programs, the reference, moved stances, any input."""

import numpy as np
import pytest
from scipy.optimize import linprog

from oracles.stances import O10_FRICTION, O10_LOAD, O10_POINTS, incline_load, moved, random_rotation, random_stance, unit
from walkgen.runtime.solves.friction_needed import friction_needed
from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, grasp_map

UP = np.tile([0.0, 0.0, 1.0], (3, 1))
SQUARE = np.array([[0.3, 0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0], [0.3, -0.2, 0.0]])


def checks(points, normals, wrench, mu, f, twist) -> np.ndarray:
    """What is missing of the load, of the cones, of the twist's clearance at mu, and of its zero power: forces show that mu suffices, the
    twist that less does not, as w . t + sum f . V = 0 for all forces f.
    """
    N = np.sum(f * normals, axis=1)
    T = np.linalg.norm(f - N[:, None] * normals, axis=1)
    V = twist[:3] + np.cross(twist[3:], points)
    Vn = np.sum(V * normals, axis=1)
    Vt = np.linalg.norm(V - Vn[:, None] * normals, axis=1)
    size = np.linalg.norm(wrench)
    lacking = grasp_map(points) @ f.ravel() + wrench
    return np.array([np.linalg.norm(lacking) / size, np.max(T - mu * N) / size, np.max(mu * Vt - Vn), abs(wrench @ twist) / size])


def carries(points, normals, wrench, mu, facets, *, outer: bool) -> bool:
    """Whether pyramids of `facets` edges within cones, or around them, carry the load: a linear program."""
    angle = 2 * np.pi * np.arange(facets) / facets
    width = mu / np.cos(np.pi / facets) if outer else mu
    edges = []
    for normal in normals:
        first = unit(np.cross(normal, [1.0, 0.0, 0.0]))
        second = np.cross(normal, first)
        edges.append(normal + width * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second))
    G = grasp_map(points)
    columns = np.concatenate([G[:, 3 * i : 3 * i + 3] @ edge.T for i, edge in enumerate(edges)], axis=1)
    return linprog(np.zeros(columns.shape[1]), A_eq=columns, b_eq=-wrench / np.linalg.norm(wrench), method="highs").status == 0


def test_the_example_needs_what_its_slip_has(stances):
    mu, f, twist, status = stances.needed(O10_POINTS, UP, O10_LOAD)
    assert status == OK
    assert mu == pytest.approx(O10_FRICTION, rel=1e-12)
    assert checks(O10_POINTS, UP, O10_LOAD, mu, f, twist).max() <= 1e-13


@pytest.mark.parametrize("angle", [5.0, 18.0, 40.0])
def test_gravity_on_an_incline_needs_its_tangent(stances, angle):
    mu, _, twist, status = stances.needed(O10_POINTS, UP, incline_load(np.deg2rad(angle)))
    assert status in (OK, INFEASIBLE)
    assert (status == OK) == (angle < 30)
    if status == OK:
        assert mu == pytest.approx(np.tan(np.deg2rad(angle)), rel=1e-12)
        np.testing.assert_allclose(twist[3:], 0.0, rtol=0, atol=1e-5)


def random_stances(seed, count):
    rng = np.random.default_rng(seed)
    return [random_stance(rng, int(rng.integers(3, 9)), slope) for slope in rng.choice([0.0, 0.1, 0.3, 0.6], count)]


@pytest.mark.parametrize(("seed", "count"), [(1, 400), pytest.param(2, 4000, marks=pytest.mark.nightly)])
def test_proofs_from_both_sides(stances, seed, count):
    none = unsure = 0
    for points, normals, wrench in random_stances(seed, count):
        mu, f, twist, status = stances.needed(points, normals, wrench)
        assert np.isnan(mu) == (status == NO_CONVERGENCE)
        unsure += status == NO_CONVERGENCE
        if status == NO_CONVERGENCE:
            continue
        if status == INFEASIBLE:
            assert_no_friction_helps(points, normals, wrench, mu, twist)
        else:
            limit = 2e-12 * max(1.0, np.abs(f).max() / np.linalg.norm(wrench))
            found = checks(points, normals, wrench, mu, f, twist)
            assert found[:2].max() <= limit
            if np.abs(f).max() > 1e5 * np.linalg.norm(wrench):  # feet that press against each other: the twist refutes a little less mu
                assert found[2] <= 2e-4
                assert wrench @ twist > 0.0
            else:
                assert limit > 1e-11 or found[2:].max() <= limit
        none += status == INFEASIBLE
    assert none < count // 10
    assert unsure <= count // 800


def assert_no_friction_helps(points, normals, wrench, mu, twist):
    V = twist[:3] + np.cross(twist[3:], points)
    Vn = np.sum(V * normals, axis=1)
    assert mu == np.inf
    assert wrench @ twist == pytest.approx(1.0, rel=1e-12)
    assert Vn.min() >= -1e-11 * np.abs(V).max()
    assert np.abs(V - Vn[:, None] * normals).max() <= 1e-6 * np.abs(V).max()


def test_linear_programs_agree_within_their_facets(stances):
    """Pyramids of 256 edges inside the cones and around them, a hair more and less friction than needed."""
    for points, normals, wrench in random_stances(3, 12):
        mu, _, _, status = stances.needed(points, normals, wrench)
        if status == OK and mu > 1e-3:
            inner = mu / np.cos(np.pi / 256) * (1 + 1e-6)
            assert carries(points, normals, wrench, inner, 256, outer=False)
            assert not carries(points, normals, wrench, mu * np.cos(np.pi / 256) * (1 - 1e-6), 256, outer=True)


def test_the_reference_agrees(stances):
    for points, normals, wrench in random_stances(4, 3):
        mu, _, _, status = stances.needed(points, normals, wrench)
        expected, f, _, state = friction_needed(points, normals, wrench)
        assert status == state
        assert mu == pytest.approx(float(expected), rel=1e-11)
        assert checks(points, normals, wrench, mu, f, np.zeros(6))[:2].max() <= 1e-11


def test_order_frame_and_size_do_not_matter(stances):
    rng = np.random.default_rng(5)
    for points, normals, wrench in random_stances(6, 30):
        order, R, shift, size = rng.permutation(len(points)), random_rotation(rng), rng.uniform(-1, 1, 3), 10.0 ** rng.uniform(-3, 3)
        other = moved(points, normals, wrench, R, shift)
        mu, _, _, status = stances.needed(points, normals, wrench)
        again, _, _, same = stances.needed(other[0][order], other[1][order], size * other[2])
        assert status == same
        assert mu == pytest.approx(again, rel=1e-10, abs=1e-12, nan_ok=True)


@pytest.mark.parametrize(
    ("points", "normals", "wrench", "expected", "mu"),
    [
        (SQUARE, np.tile(UP[:1], (4, 1)), [0, 0, -100, 0, 0, 0], OK, 0.0),
        (SQUARE, np.tile(UP[:1], (4, 1)), [0, 0, 100, 0, 0, 0], INFEASIBLE, np.inf),
        (SQUARE, np.tile(UP[:1], (4, 1)), [10, 0, 0, 0, 0, 0], INFEASIBLE, np.inf),
        (SQUARE, np.tile(UP[:1], (4, 1)), [30, 0, -100, 20, 0, 0], OK, np.hypot(0.3, 0.2)),  # above an edge, aside of the pull
        (SQUARE, np.tile(UP[:1], (4, 1)), [0, 0, -100, 20.1, 0, 0], INFEASIBLE, np.inf),
        (SQUARE[[0, 2]], UP[:2], [30, 40, -100, 0, 0, 0], OK, 0.5),
        (SQUARE[[0, 2]], UP[:2], [0, 0, -100, 1, 0, 0], INFEASIBLE, np.inf),
        (0 * SQUARE[:1], UP[:1], [30, 40, -100, 0, 0, 0], OK, 0.5),
        (0 * SQUARE[:1], UP[:1], [30, 40, -100, 0, 0, 1], INFEASIBLE, np.inf),
        (np.array([[-1.0, 0, 0], [1.0, 0, 0]]), np.array([[1.0, 0, 0], [-1.0, 0, 0]]), [0, 0, -100, 0, 0, 0], OK, 0.0),
        (SQUARE, np.tile(UP[:1], (4, 1)), [0, 0, np.nan, 0, 0, 0], BAD_INPUT, np.nan),
        (SQUARE, 0.9 * np.tile(UP[:1], (4, 1)), [0, 0, -100, 0, 0, 0], BAD_INPUT, np.nan),
        (SQUARE, 0.0 * np.tile(UP[:1], (4, 1)), [0, 0, -100, 0, 0, 0], BAD_INPUT, np.nan),
    ],
)
def test_stances_by_hand(stances, points, normals, wrench, expected, mu):
    """The last but three: two walls pressed apart carry any weight with any friction by forces without bound."""
    found, f, _, status = stances.needed(points, normals, np.array(wrench, float))
    assert status == expected
    np.testing.assert_allclose(found, mu, rtol=1e-10, atol=1e-10)
    assert np.isfinite(f).all() == (status == OK)


def test_margins_of_a_tripod(stances):
    """The load may grow along a direction until it needs all friction; lift by the tripod's own forces on a level plane."""
    mu = np.full(3, 0.5)
    direction = np.array([10.0, 0.0, 0.0, 0.0, 3.0, 0.0])
    reach, lift, status = stances.margin(O10_POINTS, UP, mu, O10_LOAD, direction)
    assert status == OK
    assert stances.needed(O10_POINTS, UP, O10_LOAD + reach * direction)[0] == pytest.approx(0.5, rel=1e-10)
    assert lift > 0.0
    level = incline_load(0.0)
    N = np.linalg.solve(np.vstack([np.ones(3), O10_POINTS[:, 0], O10_POINTS[:, 1]]), [-level[2], 0.02 * -level[2], 0.03 * -level[2]])
    assert stances.margin(O10_POINTS, UP, mu, level, direction)[1] == pytest.approx(N.min(), rel=1e-12)
    assert stances.margin(O10_POINTS, UP, np.full(3, 0.3), O10_LOAD, direction)[2] == INFEASIBLE
    assert stances.margin(O10_POINTS, UP, mu, O10_LOAD, 0 * direction)[2] == BAD_INPUT
    assert stances.margin(O10_POINTS, UP, -mu, O10_LOAD, direction)[2] == BAD_INPUT


def test_reach_against_linear_programs(stances):
    rng = np.random.default_rng(7)
    for points, normals, wrench in random_stances(8, 10):
        needed, _, _, status = stances.needed(points, normals, wrench)
        direction = rng.normal(size=6) * [50, 50, 50, 10, 10, 10]
        if status == OK:
            mu = np.full(len(points), 1.2 * needed + 0.1)
            reach, lift, status = stances.margin(points, normals, mu, wrench, direction)
            assert status == OK
            assert lift > 0.0
            if np.isfinite(reach):
                assert carries(points, normals, wrench + reach * (1 - 1e-2) * direction, mu[0], 256, outer=False)
                assert not carries(points, normals, wrench + reach * (1 + 1e-2) * direction, mu[0], 256, outer=True)


def test_where_a_foot_may_stand(stances):
    points = np.array([0.3, 0.0, 0.0]) + [[x, y, 0.0] for x in np.linspace(-0.3, 0.2, 4) for y in np.linspace(-0.3, 0.3, 4)]
    normals = np.tile(UP[:1], (len(points), 1))
    share, status = stances.admissible(O10_POINTS, UP, np.full(3, 0.4), O10_LOAD, 0, points, normals)
    for point, found, state in zip(points, share, status, strict=True):
        mu, _, _, expected = stances.needed(np.vstack([point, O10_POINTS[1:]]), UP, O10_LOAD)
        assert state == expected
        np.testing.assert_allclose(found, mu / 0.4, rtol=1e-10)
    assert 0 < np.count_nonzero(share <= 1.0) < len(share)
    assert np.isinf(share[status == INFEASIBLE]).all()
    assert (stances.admissible(O10_POINTS, UP, np.full(3, 0.4), O10_LOAD, 3, points, normals)[1] == BAD_INPUT).all()


SPECIAL = (0.0, -0.0, 5e-324, 1e-200, 1e-9, 0.3, -0.5, 1.0, 1e9, 1e160, -1e160, 1.7e308, np.inf, -np.inf, np.nan)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_any_input_has_an_answer(stances, dtype):
    rng = np.random.default_rng(9)
    for _ in range(150):
        inputs = [O10_POINTS.copy(), UP.copy(), O10_LOAD.copy()]
        for _ in range(2):
            chosen = inputs[rng.integers(3)]
            chosen.flat[rng.integers(chosen.size)] = rng.choice(SPECIAL)
        mu, f, twist, status = stances.needed(*inputs, dtype=dtype)
        assert status in (OK, BAD_INPUT, INFEASIBLE, NO_CONVERGENCE)
        assert (np.isfinite(mu) and np.isfinite(f).all()) == (status == OK)
        assert np.isfinite(twist).all() == (status in (OK, INFEASIBLE))


def test_single_precision(stances):
    for points, normals, wrench in random_stances(10, 40):
        exact, single = stances.needed(points, normals, wrench), stances.needed(points, normals, wrench, dtype=np.float32)
        if exact[3] == OK:
            assert single[3] == OK
            np.testing.assert_allclose(single[0], exact[0], rtol=2e-3, atol=2e-3)

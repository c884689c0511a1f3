"""Contact forces of least squares in C: the published stances, optimality, certificates, symmetries, bounds, feet on a line."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from contact_checks import distance_from_cones, imbalance, loads, optimality, outside, refutation
from contact_library import Forces, Stances

from contact_stances import grasp, random_stances
from oracles.walker import rotation
from walkgen.runtime.solves.contact import contact_least_squares

OK, BAD_INPUT, NO_CONVERGENCE, INFEASIBLE = 0, 2, 4, 5
TURN = rotation([0.48, -0.6, 0.64], 1.3)[:3, :3]
CASES = json.loads((Path(__file__).parents[1] / "cases" / "forces_solo12.json").read_text())["stances"]


@pytest.fixture(scope="module")
def forces(tmp_path_factory):
    return Forces(tmp_path_factory.mktemp("forces"))


def of_case(case):
    com, force = np.array(case["com"]), np.array(case["load_force"])
    moment = np.array(case["load_moment_about_com"]) + np.cross(com, force)
    return Stances.of([case["feet"]], case["normals"], case["mu"], [np.concatenate([force, moment])])


@pytest.mark.parametrize("case", CASES, ids=[str(index) for index in range(len(CASES))])
def test_published_stances(forces, case):
    stance = of_case(case)
    found = forces(stance)
    if not case["feasible"]:
        assert found.status[0] == INFEASIBLE
        assert np.isnan(found.f).all()
        assert refutation(stance, found)[0] < 0.0
        return
    assert found.status[0] == OK
    assert np.abs(found.f[0] - case["f"]).max() <= 1e-7 * loads(stance)[0]
    assert [case["stance"][foot] for foot in np.flatnonzero(found.state[0] == 1)] == case["sliding"]
    assert [case["stance"][foot] for foot in np.flatnonzero(found.state[0] == 2)] == case["unloaded"]


@pytest.mark.parametrize("facets", [0, 3, 4, 9])
@pytest.mark.parametrize("k", [3, 4, 6, 12])
def test_forces_balance_in_their_cones_or_cannot(forces, k, facets):
    stances = random_stances(10 * k + facets, 400, k)
    found = forces(stances, facets)
    assert set(found.status) <= {OK, INFEASIBLE}
    good, bad = found.status == OK, found.status == INFEASIBLE
    assert min(good.sum(), bad.sum()) > 40
    assert imbalance(stances[good], found.f[good]).max() <= 1e-12
    assert outside(stances[good], found.f[good], facets).max() <= 1e-14
    assert refutation(stances, found, facets)[bad].max() < 0.0
    assert np.isnan(found.f[bad]).all()
    assert (found.certificate[good] == 0.0).all()


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_the_violation_is_how_far_balanced_forces_are_from_their_cones(forces, scale):
    stances = random_stances(11, 80, 4)
    stances = stances.changed(weight=scale * stances.weight)
    first, second = forces(stances), contact_least_squares(*vars(stances).values())[4]
    rows = np.flatnonzero(first.status == INFEASIBLE)
    truth = np.array([distance_from_cones(stances[row]) for row in rows])
    assert len(rows) > 20
    for found in (first.violation[rows], second[rows]):
        assert (found <= truth * (1.0 + 1e-6)).all()
    assert np.median(first.violation[rows] / truth) >= 1.0 - 1e-6
    assert (first.violation[rows] >= 0.5 * truth).all()
    assert (second[rows] >= 0.3 * truth).all()


@pytest.mark.parametrize("bounded", [False, True])
@pytest.mark.parametrize("k", [3, 4, 6, 12])
def test_forces_are_the_least(forces, k, bounded):
    stances = random_stances(k, 150, k)
    generator = np.random.default_rng(k)
    n_max = generator.uniform(60.0, 400.0, (150, k)) if bounded else stances.n_max
    stances = stances.changed(weight=np.exp(generator.normal(0.0, 1.0, (150, k))), n_max=n_max)
    found = forces(stances)
    good = found.status == OK
    assert set(found.status) <= {OK, INFEASIBLE}
    assert refutation(stances[~good], Rows(found, ~good)).max() < 0.0
    worst = optimality(stances[good], Rows(found, good))
    assert np.isfinite(worst).sum() > 8
    assert np.nanmax(worst) <= 1e-9


class Rows:
    """Some rows of what was found."""

    def __init__(self, found, rows):
        vars(self).update({name: value[rows] for name, value in found._asdict().items()})


def test_permuted_feet(forces):
    stances = random_stances(1, 300, 6)
    order = np.random.default_rng(1).permutation(6)
    moved = stances.changed(**{name: value[:, order] for name, value in vars(stances).items() if name != "wrench"})
    first, second = forces(stances), forces(moved)
    assert np.array_equal(first.status, second.status)
    good = first.status == OK
    assert (np.abs(first.f[:, order] - second.f)[good].max((-1, -2)) / loads(stances)[good]).max() <= 1e-11


def test_turned_world(forces):
    stances = random_stances(2, 300, 5)
    R = TURN
    turned = stances.changed(points=stances.points @ R.T, normals=stances.normals @ R.T)
    turned = turned.changed(wrench=(stances.wrench.reshape(-1, 2, 3) @ R.T).reshape(-1, 6))
    first, second = forces(stances), forces(turned)
    assert np.array_equal(first.status, second.status)
    good = first.status == OK
    assert (np.abs(first.f @ R.T - second.f)[good].max((-1, -2)) / loads(stances)[good]).max() <= 1e-11


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("facets", [0, 4])
def test_scaled_load_is_exact_for_powers_of_two(forces, dtype, facets):
    """The bound on the inside's safe numbers may choose another way at extreme scales: these stay below it."""
    stances = random_stances(3, 300, 4)
    first, second = (forces(stances.changed(wrench=scale * stances.wrench), facets, dtype) for scale in (1.0, 0.25))
    assert np.array_equal(first.status, second.status)
    assert np.array_equal(0.25 * first.f, second.f, equal_nan=True)
    assert np.array_equal(4.0 * first.certificate, second.certificate)
    assert np.array_equal(first.state, second.state)


@pytest.mark.parametrize("scale", [1e-250, 1e-30, 1e30, 1e250])
def test_scales_far_from_one(forces, scale):
    stances = random_stances(4, 100, 4)
    first, loaded = forces(stances), forces(stances.changed(wrench=scale * stances.wrench))
    long = stances.changed(points=scale * stances.points, wrench=stances.wrench * np.repeat([1.0, scale], 3))
    assert np.array_equal(first.status, loaded.status)
    assert np.array_equal(first.status, forces(long).status)
    good = first.status == OK
    assert np.abs(loaded.f[good] / scale - first.f[good]).max() <= 1e-10 * 300.0
    assert np.abs(forces(long).f[good] - first.f[good]).max() <= 1e-10 * 300.0


@pytest.mark.parametrize("facets", [0, 4])
def test_a_warm_start_changes_nothing(forces, facets):
    """A load that moves, and at last leaves what can be carried."""
    base = random_stances(5, 1, 6, rough=0.8)
    path = np.linspace(0.0, 1.0, 400)[:, None]
    wrench = base.wrench + 300.0 * path * np.array([1.0, 0.4, 0.2, 0.05, -0.05, 0.1])
    stances = Stances.of(base.points, base.normals, base.mu, wrench)
    cold, warm = forces(stances, facets), forces(stances, facets, warm=True)
    assert {OK, INFEASIBLE} <= set(cold.status)
    assert np.array_equal(cold.status, warm.status)
    assert np.array_equal(cold.state, warm.state)
    assert np.nanmax(np.abs(cold.f - warm.f)) <= 1e-10 * 300.0
    mixed = random_stances(6, 2000, 4)
    assert np.array_equal(forces(mixed, facets).status, forces(mixed, facets, warm=True).status)


def test_facets_approach_the_circle_from_inside(forces):
    stances = random_stances(7, 300, 4)
    exact = forces(stances)
    errors = []
    for facets in (8, 32, 128, 1024):
        found = forces(stances, facets)
        both = (exact.status == OK) & (found.status == OK)
        assert not ((found.status == OK) & (exact.status == INFEASIBLE)).any()
        assert outside(stances[both], found.f[both]).max() <= 1e-14
        sums = [(part.f[both] ** 2).sum((-1, -2)) for part in (found, exact)]
        assert (sums[0] >= sums[1] * (1.0 - 1e-10)).all()
        errors.append(np.median((sums[0] / sums[1] - 1.0)[sums[0] > sums[1] * (1.0 + 1e-12)]))
    assert all(finer < 0.2 * coarser for coarser, finer in pairwise(errors))


def test_weights_and_bounds(forces):
    """The heavier a foot's weight, the less it bears; a bound holds and what it takes off goes elsewhere."""
    square = np.array([[0.3, 0.2, 0.0], [0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0], [0.0, 0.0, 0.0]])
    stance = Stances.of([square], np.array([0.0, 0.0, 1.0]), 0.5, [[0.0, 0.0, -300.0, 0.0, 0.0, 0.0]])
    assert np.allclose(forces(stance).f[0, :, 2], 60.0, atol=1e-10)
    heavy = forces(stance.changed(weight=np.array([[1.0, 1.0, 1.0, 1.0, 4.0]]))).f[0, :, 2]
    assert np.allclose(heavy, 300.0 / 4.25 * np.array([1.0, 1.0, 1.0, 1.0, 0.25]), atol=1e-10)
    bound = forces(stance.changed(n_max=np.array([[np.inf, np.inf, np.inf, np.inf, 20.0]]))).f[0, :, 2]
    assert np.allclose(bound, [70.0, 70.0, 70.0, 70.0, 20.0], atol=1e-10)
    over = stance.changed(n_max=np.full((1, 5), 59.0))
    found = forces(over)
    assert found.status[0] == INFEASIBLE
    assert refutation(over, found)[0] < 0.0


def test_slip_on_a_plane_needs_the_friction_of_the_limit_surface(forces):
    """Three feet on a plane under gravity on a slope of 18 degrees, a side load and a twist; without these tan 18."""
    feet = np.array([[0.30, 0.0, 0.0], [-0.2, 0.25, 0.0], [-0.15, -0.28, 0.0]])
    tilt, weight = np.radians(18.0), 60.0 * 9.81
    gravity = weight * np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    moment = np.cross([0.02, 0.03, 0.30], gravity)
    for extra, needed in (([0.0, 20.0, 0.0, 0.0, 0.0, 6.0], 0.32809786048976614), (np.zeros(6), np.tan(tilt))):
        stance = Stances.of([feet], np.array([0.0, 0.0, 1.0]), np.zeros(3), [np.concatenate([gravity, moment]) + extra])
        below, above = (forces(stance.changed(mu=np.full((1, 3), needed + gap))) for gap in (-1e-8, 1e-8))
        assert (below.status[0], above.status[0]) == (INFEASIBLE, OK)
        N = above.f[0, :, 2]
        assert (np.hypot(*above.f[0, :, :2].T) >= (1.0 - 1e-6) * needed * N).all()
        if np.any(extra):
            assert np.allclose(N, [348.6499724960401, 143.2329924592835, 67.90890053600377], atol=1e-5)


@pytest.mark.parametrize("name", ["one", "two", "line", "coincident"])
def test_feet_that_cannot_carry_every_moment_say_which(forces, name):
    """The certificate of a load that has such a moment is a multiple of it: no force of any foot has it."""
    axis = TURN[0]
    steps = {"one": [0.0], "two": [-1.0, 1.0], "line": [-1.0, 0.2, 0.5, 1.4], "coincident": [0.0, 0.0, 0.0]}[name]
    centre = np.array([0.1, -0.2, 0.05])
    points = centre + np.array(steps)[:, None] * 0.3 * axis
    force, load = np.array([2.0, 1.0, -100.0]), np.cross(centre, [2.0, 1.0, -100.0])
    carried = Stances.of([points], np.array([0.0, 0.0, 1.0]), 0.8, [np.concatenate([force, load])])
    found = forces(carried)
    assert found.status[0] == OK
    assert np.abs(found.f.sum(1) + force).max() <= 1e-12
    twisted = carried.changed(wrench=carried.wrench + np.concatenate([np.zeros(3), 0.5 * axis]))
    found = forces(twisted)
    assert (found.status[0], found.violation[0]) == (INFEASIBLE, np.inf)
    assert np.abs(found.certificate[0] @ grasp(points)).max() <= 1e-12 * np.abs(found.certificate).max()
    assert abs(found.certificate[0] @ twisted.wrench[0] - 1.0) <= 1e-12
    if name in {"two", "line"}:
        assert np.abs(np.cross(found.certificate[0, 3:], axis)).max() <= 1e-10 * np.abs(found.certificate[0, 3:]).max()


def test_bad_inputs(forces):
    good = random_stances(8, 1, 4).changed(mu=np.full((1, 4), 0.9))
    changes = [
        ("points", np.nan),
        ("points", np.inf),
        ("normals", np.nan),
        ("normals", 0.0),
        ("normals", 1.5),
        ("mu", -0.1),
        ("mu", np.nan),
    ]
    changes += [("mu", np.inf), ("wrench", np.nan), ("wrench", -np.inf), ("weight", 0.0), ("weight", -1.0), ("weight", np.nan)]
    changes += [("n_max", -1.0), ("n_max", np.nan), ("weight", np.inf)]
    for name, value in changes:
        array = np.array(vars(good)[name])
        array.reshape(-1)[1] = value
        for dtype in (np.float64, np.float32):
            found = forces(good.changed(**{name: array}), dtype=dtype)
            assert found.status[0] == BAD_INPUT, (name, value)
            assert all(np.isnan(part).all() for part in (found.f, found.certificate, found.violation))
    upright = Stances.of(good.points * [1.0, 1.0, 0.0], [0.0, 0.0, 1.0], 0.9, [0.0, 0.0, -100.0, 0.0, 0.0, 0.0])
    for facets in (-1, 1, 2, 1025):
        assert forces(good, facets).status[0] == BAD_INPUT
        assert forces(upright, facets).status[0] == BAD_INPUT
    short = good.changed(normals=good.normals * (1.0 + 1e-8))
    assert forces(short).status[0] == BAD_INPUT


def test_no_friction_and_no_load(forces):
    flat = random_stances(9, 50, 4, rough=0.0)
    flat = flat.changed(points=flat.points * [1.0, 1.0, 0.0], normals=np.broadcast_to([0.0, 0.0, 1.0], (50, 4, 3)), mu=np.zeros((50, 4)))
    down = flat.changed(wrench=np.broadcast_to([0.0, 0.0, -9.0, 0.0, 0.0, 0.0], (50, 6)))
    found = forces(down)
    assert (found.status == OK).sum() > 30
    assert (found.f[found.status == OK][..., :2] == 0.0).all()
    assert set(found.state[found.status == OK].ravel()) <= {1, 2}
    none = forces(flat.changed(wrench=np.zeros((50, 6))))
    assert (none.status == OK).all()
    assert (none.f == 0.0).all()
    assert (none.state == 2).all()


@pytest.mark.parametrize("facets", [0, 4])
def test_float(forces, facets):
    stances = random_stances(11, 400, 4)
    exact, found = forces(stances, facets), forces(stances, facets, np.float32)
    same = exact.status == found.status
    assert (~same & (found.status != NO_CONVERGENCE)).mean() <= 0.003  # edges of what can be carried
    assert (found.status == NO_CONVERGENCE).mean() <= 0.01
    good = same & (exact.status == OK)
    assert (np.abs(exact.f - found.f)[good].max((-1, -2)) / loads(stances)[good]).max() <= 1e-3
    assert np.median(np.abs(exact.f - found.f)[good].max((-1, -2)) / loads(stances)[good]) <= 1e-5

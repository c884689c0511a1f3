"""What chooses among the branches of a leg: a seed, an index, the joint limits; and how far each branch misses."""

import itertools

import numpy as np
import pytest
from scipy.optimize import least_squares
from sequences import design, head, leg, row

from oracles.backends import Built
from oracles.measure import difference
from oracles.screws import screws
from oracles.walker import read
from walkgen import pipeline

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, DUPLICATE = 0, 1, 2, 3, 4, 6
REACHES = (OK, SINGULAR, DUPLICATE)
FUNCTIONS = ("inverse", "inverse_branch", "inverse_near", "inverse_admissible", "inverse_distance", "within_limits")


def angles(low, high):
    return f"limits = [{low}, {high}]"


def pitching(name, *limits):
    rows = [row("r", 0.08, "alpha_deg = 90", 0.1, 0.0, limits[0]), row("r", 0.35, "alpha_deg = 0", 0.02, 0.0, limits[1])]
    return design(name, [*rows, row("r", 0.4, "alpha_deg = 0", -0.01, 0.0, limits[2])], "0.01, -0.03, 0.05")


def random_leg(name, *limits):
    return leg(name, *name.split("_"), np.random.default_rng(list(name.encode())), limits)


LEGS = {
    "walking": pitching("walking", angles(-1.0, 1.0), angles(-1.5, 1.5), angles(-2.6, 0.0)),
    "another_turn": pitching("another_turn", angles(0.0, 4.5), angles(-7.0, -3.0), angles(-0.5, 5.0)),
    "half_open": pitching("half_open", "", angles(-1.0, 0.5), ""),
    "rrr_xx": random_leg("rrr_xx", angles(-2.0, 1.0), angles(-1.0, 2.5), angles(2.0, 5.5)),
    "rrp_xp": random_leg("rrp_xp", angles(-1.5, 2.0), "", angles(-0.3, 0.4)),
    "rpp_xx": random_leg("rpp_xx", angles(-1.0, 1.0), angles(0.0, 0.5), angles(-0.2, 0.2)),
    "rr_x": random_leg("rr_x", angles(-1.0, 2.0), angles(-2.0, 2.0)),
    "p_": random_leg("p_", angles(-0.1, 0.2)),
}
SPEC = head("seeded", FUNCTIONS) + "\n".join(LEGS.values())
PATHS = {limb.name: screws(limb) for limb in read(SPEC).legs}


@pytest.fixture(scope="session", params=["c", "numpy"])
def robot(request, built):
    return getattr(built(SPEC), request.param)


@pytest.fixture(params=LEGS)
def limb(request, robot):
    return PATHS[request.param], robot.legs[request.param]


def some(generated, many, few):
    """NumPy's rows are solved one by one."""
    return many if "NumPy" not in repr(generated.inverse) else few


def least(path, q):
    return np.linalg.svd(path.jacobian(q), compute_uv=False)[..., path.n - 1]


# ---- near ------------------------------------------------------------------------------------------------------------------------


def test_near_is_the_nearest_row(limb):
    path, generated = limb
    rng = np.random.default_rng(1)
    count = some(generated, 400, 25)
    p = np.concatenate([path.foot(path.random(rng, count)), rng.normal(size=(count // 5, 3))])
    seed = rng.uniform(-9.0, 9.0, (len(p), path.n))
    rows, states = generated.inverse(p)
    q, status = generated.inverse_near(p, seed)
    gap = rows - seed[:, None]
    gap = np.where(path.turning, np.angle(np.exp(1j * gap)), gap)
    reached = np.isin(states, REACHES)
    apart = np.where(reached | ~reached.any(axis=1, keepdims=True), np.sum(gap**2, axis=-1), np.inf)
    chosen = np.argmin(apart, axis=1)
    assert np.array_equal(q, rows[np.arange(len(p)), chosen])
    state = states[np.arange(len(p)), chosen]
    assert np.array_equal(status, np.where(state == DUPLICATE, OK, state))
    assert np.any(status == UNREACHABLE) or not path.turning.all()
    assert np.any(status != UNREACHABLE)


def test_a_seed_without_numbers_is_bad_input(limb):
    path, generated = limb
    p = path.foot(np.full(path.n, 0.1))
    for value, place in itertools.product((np.nan, np.inf, -np.inf), range(path.n)):
        seed = np.zeros(path.n)
        seed[place] = value
        with np.errstate(all="ignore"):
            q, status = generated.inverse_near(p, seed)
        assert status == BAD_INPUT
        assert np.all(np.isnan(q))
    with np.errstate(all="ignore"):
        q, status = generated.inverse_near(p * np.nan, np.zeros(path.n))
    assert status == BAD_INPUT
    assert np.all(np.isnan(q))


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", ["walking", "rrr_xx", "rrp_xp", "rr_x"])
def test_a_path_is_followed_without_jumps(robot, name):
    """Each target seeded with the joint values before it: the way by which the foot was led comes back."""
    path, generated = PATHS[name], robot.legs[name]
    time = np.linspace(0.0, 1.0, some(generated, 400, 100))[:, None]
    starts, swing = path.random(np.random.default_rng(2), 60, 0.4), 0.4 * np.sin(np.pi * time * np.arange(1, path.n + 1))
    bends = [least(path, start + swing).min() for start in starts]
    way = starts[int(np.argmax(bends))] + swing
    assert max(bends) > 0.02  # clear of singular poses, where branches meet
    seed = way[0]
    for wanted in way:
        seed, status = generated.inverse_near(path.foot(wanted), seed)
        assert status == OK
        assert path.apart(seed, wanted) <= 1e-12


# ---- distance and limits ---------------------------------------------------------------------------------------------------------


def test_distance_is_that_of_every_row(limb):
    path, generated = limb
    rng = np.random.default_rng(3)
    p = np.concatenate([path.foot(path.random(rng, some(generated, 100, 8))), rng.normal(size=(some(generated, 50, 6), 3))])
    rows, status = generated.inverse(p)
    distance = generated.inverse_distance(p)
    assert difference(distance, np.linalg.norm(path.foot(rows) - p[:, None], axis=-1)) <= 1e-14 * 10
    assert np.all(distance[np.isin(status, REACHES)] <= 1e-12 * (1.0 + np.abs(rows).max()))
    with np.errstate(all="ignore"):
        assert np.all(np.isnan(generated.inverse_distance([np.nan, 0.0, 0.0])))


def test_within_limits_is_true_up_to_them(limb):
    path, generated = limb
    low, high = generated.limits.T
    middle = np.array([(a + b) / 2 if np.isfinite(a) else 0.3 for a, b in generated.limits])
    assert generated.within_limits(middle) is np.True_ or generated.within_limits(middle) is True
    for joint, bound in itertools.product(range(path.n), (low, high)):
        q = middle.copy()
        q[joint] = bound[joint] if np.isfinite(bound[joint]) else 1e6
        assert generated.within_limits(q)
        q[joint] = np.nextafter(bound[joint], np.sign(bound[joint] - middle[joint]) * np.inf)
        assert generated.within_limits(q) == (not np.isfinite(bound[joint]) and np.isfinite(q[joint]))
        q[joint] = np.nan
        assert not generated.within_limits(q)
    q = path.random(np.random.default_rng(4), 500, 0.5)
    inside = generated.within_limits(q)
    assert inside.dtype == bool
    assert np.array_equal(inside, np.all((q >= low) & (q <= high), axis=1))


# ---- admissible ------------------------------------------------------------------------------------------------------------------


def all_turns(path, rows, low, high):
    """Rows [m, n] turned fully in every way that could fit."""
    turns = [
        np.arange(-2, 3) * 2 * np.pi if turning and a > -np.inf and b < np.inf else [0.0]
        for turning, a, b in zip(path.turning, low, high, strict=True)
    ]
    return (rows[:, None] + np.array(list(itertools.product(*turns)))).reshape(-1, path.n)


def test_admissible_is_the_row_nearest_the_middle(limb):
    path, generated = limb
    low, high = generated.limits.T
    bounded = np.isfinite(low)
    floor, top = np.where(bounded, low, -np.pi), np.where(bounded, high, np.pi)
    middle, half = (floor + top) / 2, (top - floor) / 2
    rng = np.random.default_rng(5)
    count = some(generated, 200, 12)
    inside = rng.uniform(floor, top, (count, path.n))
    q, status = generated.inverse_admissible(path.foot(inside))
    rows, states = generated.inverse(path.foot(inside))
    assert np.all(np.isin(status, (OK, SINGULAR)))
    assert np.all(generated.within_limits(q))
    assert difference(path.foot(q), path.foot(inside)) <= 1e-12
    for found, branches, state in zip(q, rows, states, strict=True):
        choices = all_turns(path, branches[np.isin(state, REACHES)], low, high)
        slack = 1e-12
        fits = np.all((choices >= low - slack) & (choices <= high + slack), axis=1)
        share = np.where(bounded | path.turning, (np.where(bounded, choices, np.angle(np.exp(1j * choices))) - middle) / half, 0.0)
        best = np.min(np.sum(share**2, axis=1)[fits])
        mine = np.where(bounded | path.turning, (np.where(bounded, found, np.angle(np.exp(1j * found))) - middle) / half, 0.0)
        assert np.sum(mine**2) <= best * (1 + 1e-9) + 1e-12


def least_within(path, p, low, high):
    """The least distance of the foot from a target with joints inside a box, by minimising it from the best of a dense grid."""
    floor, top = np.where(np.isfinite(low), low, -np.pi), np.where(np.isfinite(high), high, np.pi)
    floor, top = (np.where(path.turning | np.isfinite(low), edge, edge / np.pi * 3.0) for edge in (floor, top))
    grid = np.stack(np.meshgrid(*[np.linspace(a, b, 25) for a, b in zip(floor, top, strict=True)], indexing="ij"), axis=-1).reshape(
        -1, path.n
    )
    best = grid[np.argsort(np.linalg.norm(path.foot(grid) - p, axis=1))[:40:5]]
    box = (np.where(np.isfinite(low), low, -np.inf), np.where(np.isfinite(high), high, np.inf))
    starts = (np.clip(start, np.nextafter(box[0], np.inf) + 1e-9, box[1] - 1e-9) for start in best)
    done = [least_squares(lambda q: path.foot(q) - p, q, path.jacobian, bounds=box, xtol=1e-15, ftol=1e-15, gtol=1e-15) for q in starts]
    return min(np.sqrt(2 * one.cost) for one in done)


@pytest.mark.sampled(3)
def test_admissible_comes_closest_where_nothing_fits(limb):
    path, generated = limb
    low, high = generated.limits.T
    rng = np.random.default_rng(6)
    p = rng.uniform(-1.2, 1.2, (some(generated, 60, 20), 3))
    q, status = generated.inverse_admissible(p)
    assert np.all(generated.within_limits(q))
    gap = np.linalg.norm(path.foot(q) - p, axis=1)
    reached = np.isin(status, (OK, SINGULAR))
    assert np.all(gap[reached] <= 1e-12)
    assert np.all(np.isin(status[~reached], (UNREACHABLE, NO_CONVERGENCE)))
    assert np.count_nonzero(status == UNREACHABLE) >= 4
    for target, distance in list(zip(p[~reached], gap[~reached], strict=True))[:4]:
        assert distance <= least_within(path, target, low, high) + 1e-7


def test_admissible_needs_numbers(limb):
    _, generated = limb
    with np.errstate(all="ignore"):
        q, status = generated.inverse_admissible([[np.nan, 0.0, 0.0], [0.0, np.inf, 0.0]])
    assert np.all(status == BAD_INPUT)
    assert np.all(np.isnan(q))


# ---- by index --------------------------------------------------------------------------------------------------------------------


def test_one_branch_is_one_row(limb):
    path, generated = limb
    p = np.concatenate([path.foot(path.random(np.random.default_rng(7), 6)), [[3.0, 1.0, -2.0], [np.nan, 0.0, 0.0]]])
    with np.errstate(all="ignore"):
        rows, status = generated.inverse(p)
        slots = len(generated.branch_names)
        q, states = generated.inverse_branch(p[:, None], np.arange(slots))
        assert difference(np.nan_to_num(q, nan=9.0), np.nan_to_num(rows, nan=9.0)) <= 1e-13
        assert np.array_equal(states, status)
        for branch in (-1, slots, 2**31 - 1, 2**40):
            q, states = generated.inverse_branch(p, branch)
            assert np.all(np.isnan(q))
            assert np.all(states == BAD_INPUT)


# ---- single precision ------------------------------------------------------------------------------------------------------------


def test_single_precision(tmp_path):
    names = ("walking", "rrp_xp")
    spec = tmp_path / "spec.toml"
    spec.write_text(
        head("single", ("inverse", "inverse_near", "inverse_distance"), ("c",)) + "\n".join(LEGS[name] for name in names), encoding="utf-8"
    )
    single = Built(spec, pipeline.build(spec, tmp_path, pipeline.BuildOptions(float32=True)).folder).c
    for name in names:
        path, generated = PATHS[name], single.legs[name]
        q = path.random(np.random.default_rng(8), 200, 0.3)
        p, seed = path.foot(q).astype(np.float32), (q + 0.05).astype(np.float32)
        for rows, status in (generated.inverse(p), generated.inverse_near(p, seed)):
            assert rows.dtype == np.float32
            assert np.all(np.isfinite(rows))
            reached = np.isin(status, REACHES)
            gap = np.linalg.norm(path.foot(rows.astype(float)) - (p[:, None] if rows.ndim == 3 else p), axis=-1)
            assert np.all(gap[reached] <= 2e-6)
        assert np.all(np.isin(generated.inverse(p)[1], REACHES).any(axis=1))
        assert np.all(np.isin(generated.inverse_near(p, seed)[1], REACHES))
        rows = generated.inverse(p)[0].astype(float)
        assert np.all(np.abs(generated.inverse_distance(p) - np.linalg.norm(path.foot(rows) - p[:, None], axis=-1)) <= 2e-6)

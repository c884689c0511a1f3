"""The general inverse, C and NumPy, against dense multistarts, known poses and a yaw-pitch-pitch leg's own closed form."""

import numpy as np
import pytest
from general_library import General

from oracles.multistart import multistart
from oracles.screws import Screws, turn
from walkgen.runtime.solves.inverse_general import inverse_general, kinds_of, slots_of

OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE = 0, 1, 2, 3, 6
THREE = range(8, 16)
TWISTS = {
    "right": lambda rng: rng.choice([0.0, np.pi / 2, -np.pi / 2]),
    "random": lambda rng: rng.uniform(-np.pi, np.pi),
    "published": lambda rng: rng.choice([1.57, -1.57, 1.5708, 3.1416, 2.7e-6]),
}


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    return General(tmp_path_factory.mktemp("general"))


@pytest.fixture(params=["c", "numpy"])
def solve(request, compiled):
    return compiled if request.param == "c" else inverse_general


def random_leg(rng, sequence, twists):
    """Axes and points along a random Denavit-Hartenberg chain, [6 n + 3]."""
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    origin, numbers = rng.normal(size=3), []
    for _ in kinds_of(sequence):
        numbers += [*rotation[:, 2], *origin]
        theta, alpha = rng.uniform(-np.pi, np.pi), TWISTS[twists](rng)
        a, d = rng.choice([0.0, 1.0, 1.0]) * rng.uniform(-0.5, 0.5), rng.choice([0.0, 1.0]) * rng.uniform(-0.3, 0.3)
        z, x = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
        columns = np.array([turn(z, np.array(theta), turn(x, np.array(alpha), unit)) for unit in np.eye(3)]).T
        origin = origin + rotation @ (turn(z, np.array(theta), np.array([a, 0.0, d])))
        rotation = rotation @ columns
    return np.array([*numbers, *(origin + rotation @ rng.normal(size=3) * 0.3)])


def path(leg, sequence):
    kinds = kinds_of(sequence)
    numbers, tip = leg[: 6 * len(kinds)].reshape(-1, 2, 3), np.eye(4)
    tip[:3, 3] = leg[6 * len(kinds) :]
    return Screws(numbers[:, 0], numbers[:, 1], np.array([kind == "R" for kind in kinds]), tip)


def feet(leg, sequence, q):
    """[..., 3]"""
    return path(leg, sequence).foot(q)


def apart(sequence, a, b):
    gap = a - b
    turning = np.array([kind == "R" for kind in kinds_of(sequence)])
    return np.max(np.where(turning, np.abs(np.angle(np.exp(1j * gap))), np.abs(gap)), axis=-1)


def poses(rng, sequence, count):
    turning = np.array([kind == "R" for kind in kinds_of(sequence)])
    return np.where(turning, rng.uniform(-np.pi, np.pi, (count, len(turning))), rng.uniform(-0.6, 0.6, (count, len(turning))))


def jacobian(leg, sequence, q):
    """[..., 3, n]"""
    return path(leg, sequence).jacobian(q)


def few(solve, count):
    """NumPy takes row by row."""
    return count if isinstance(solve, General) else max(count // 8, 4)


def check_reachable(solve, sequence, twists, seed, count):
    """Every row that claims a solution has one; the pose that made the target is among them."""
    rng = np.random.default_rng([sequence, seed])
    leg = random_leg(rng, sequence, twists)
    q = poses(rng, sequence, count)
    p = feet(leg, sequence, q)
    rows, status = solve(leg, p, sequence)
    exact = np.isin(status, (OK, SINGULAR, DUPLICATE))
    assert np.all(np.any(exact, axis=1))
    size = 1.0 + np.max(np.abs(rows), axis=-1)
    gap = np.linalg.norm(feet(leg, sequence, rows) - p[:, None], axis=-1) / size
    assert np.max(gap[exact]) <= 1e-12
    regular = np.linalg.svd(jacobian(leg, sequence, q), compute_uv=False)[:, -1] > 1e-3
    nearest = np.min(np.where(status == OK, apart(sequence, rows, q[:, None]), np.inf), axis=1)
    assert np.all(nearest[regular] <= 1e-10)


def check_branches(compiled, sequence, twists, seed):
    rng = np.random.default_rng([100 + sequence, seed])
    leg = random_leg(rng, sequence, twists)
    p = feet(leg, sequence, poses(rng, sequence, 20))
    rows, status = compiled(leg, p, sequence)
    found, gap = multistart(path(leg, sequence), p)
    least = np.linalg.svd(jacobian(leg, sequence, found), compute_uv=False)[..., -1]
    for start, target in np.argwhere((gap < 1e-11) & (least > 1e-4)):
        assert np.any(apart(sequence, rows[target], found[start, target])[status[target] == OK] <= 1e-7)


@pytest.mark.parametrize("twists", TWISTS)
@pytest.mark.parametrize("sequence", THREE)
def test_reachable_targets_are_reached(solve, sequence, twists):
    for seed in range(few(solve, 4) // 4 + 1):
        check_reachable(solve, sequence, twists, seed, few(solve, 60))


@pytest.mark.parametrize("sequence", THREE)
def test_no_branch_is_missing(compiled, sequence):
    """Printed twists; others are tried on generated legs."""
    check_branches(compiled, sequence, "published", 0)


@pytest.mark.nightly
@pytest.mark.parametrize("twists", TWISTS)
@pytest.mark.parametrize("sequence", THREE)
def test_many_targets_of_many_legs(compiled, sequence, twists):
    for seed in range(100, 300):
        check_reachable(compiled, sequence, twists, seed, 50)
    for seed in range(300, 310):
        check_branches(compiled, sequence, twists, seed)


@pytest.mark.parametrize("sequence", [*range(2, 8), *THREE])
def test_c_and_numpy_agree(compiled, sequence):
    rng = np.random.default_rng(200 + sequence)
    for _ in range(3):
        leg = random_leg(rng, sequence, "random")
        p = np.concatenate([feet(leg, sequence, poses(rng, sequence, 30)), rng.normal(size=(6, 3))])
        rows, status = compiled(leg, p, sequence)
        expected, states = inverse_general(leg, p, sequence)
        assert np.array_equal(status, states)
        solved = status == OK
        assert np.max(apart(sequence, rows, expected)[solved], initial=0.0) <= 1e-9
        distances = [np.linalg.norm(feet(leg, sequence, values) - p[:, None], axis=-1) for values in (rows, expected)]
        assert np.max(np.abs(distances[0] - distances[1])) <= 1e-9


@pytest.mark.parametrize("sequence", range(2, 8))
def test_short_legs(solve, sequence):
    """On their curve or surface exact, every pose found; beside it the closest pose."""
    rng = np.random.default_rng(300 + sequence)
    for _ in range(few(solve, 5)):
        leg = random_leg(rng, sequence, "random")
        q = poses(rng, sequence, few(solve, 40))
        p = feet(leg, sequence, q)
        rows, status = solve(leg, p, sequence)
        nearest = np.min(np.where(status == OK, apart(sequence, rows, q[:, None]), np.inf), axis=1)
        assert np.all(nearest <= 1e-6)
        beside = p + rng.normal(size=p.shape) * 0.05
        rows, status = solve(leg, beside, sequence)
        assert np.all(status == UNREACHABLE)
        assert_closest(rng, leg, sequence, rows, beside)


def assert_closest(rng, leg, sequence, rows, p):
    """No random neighbour is closer, near or far."""
    best = rows[:, 0]
    least = np.min(np.linalg.norm(feet(leg, sequence, rows) - p[:, None], axis=-1), axis=1)
    scale = 10.0 ** rng.uniform(-6, 0, (600, 1, 1))
    around = np.concatenate(
        [best + scale * rng.normal(size=(600, *best.shape)), np.stack([poses(rng, sequence, len(p)) for _ in range(2000)])]
    )
    assert np.all(np.linalg.norm(feet(leg, sequence, around) - p, axis=-1) >= least - 1e-12)


@pytest.mark.parametrize("sequence", [8, 9, 10, 12])
def test_unreachable_targets_give_the_closest_pose(solve, sequence):
    rng = np.random.default_rng(400 + sequence)
    seen = 0
    for twists in ("right", "random"):
        leg = random_leg(rng, sequence, twists)
        p = leg[3:6] + rng.normal(size=(40, 3)) * 1.5
        rows, status = solve(leg, p, sequence)
        out = np.all(status == UNREACHABLE, axis=1)
        seen += np.count_nonzero(out)
        assert_closest(rng, leg, sequence, rows[out], p[out])
    assert seen > 0


Z, Y, X = np.array([0.0, 0, 1]), np.array([0.0, 1, 0]), np.array([1.0, 0, 0])
PITCHING = np.array([*Z, 0, 0, 0, *-Y, 0.08, 0, 0, *-Y, 0.43, 0.02, 0, 0.83, 0.05, 0])
"""A yaw-pitch-pitch leg: a1 = 0.08, a2 = 0.35, l3 = 0.4, w = -0.05."""


def test_a_yaw_pitch_pitch_leg_has_its_own_four_solutions(solve):
    rng = np.random.default_rng(5)
    q = poses(rng, 8, 300)
    p = feet(PITCHING, 8, q)
    rows, status = solve(PITCHING, p, 8)
    for target, row, state in zip(p, rows, status, strict=True):
        expected = pitching(target)
        assert np.count_nonzero(state == OK) == len(expected)
        for solution in expected:
            assert np.min(apart(8, row[state == OK], solution)) <= 1e-8


def pitching(p):
    """(rho, knee) = (+,+), (+,-), (-,+), (-,-), as the chapter derives them."""
    found = []
    for sign in (1, -1):
        rho = sign * np.sqrt(p[0] ** 2 + p[1] ** 2 - 0.05**2)
        across, up = rho - 0.08, p[2]
        cosine = (across**2 + up**2 - 0.35**2 - 0.4**2) / (2 * 0.35 * 0.4)
        for knee in (1, -1) if abs(cosine) <= 1 else ():
            gamma = knee * np.arccos(cosine)
            yaw = np.arctan2(p[1], p[0]) - np.arctan2(0.05, rho)
            found.append([yaw, np.arctan2(up, across) - np.arctan2(0.4 * np.sin(gamma), 0.35 + 0.4 * np.cos(gamma)), gamma])
    return found


def test_the_stretched_leg_is_a_double_root(solve):
    q = np.array([[0.3, 0.4, 0.0], [-1.0, 0.2, 0.0]])
    p = feet(PITCHING, 8, q)
    rows, status = solve(PITCHING, p, 8)
    for row, state, pose in zip(rows, status, q, strict=True):
        place = int(np.argmin(apart(8, row, pose)))
        assert np.array_equal(state[place : place + 2], [OK, DUPLICATE])
        assert np.array_equal(row[place], row[place + 1])
        assert apart(8, row[place], pose) <= 1e-6


def test_a_hair_outside_the_reach_is_ok(solve):
    leg = np.array([*Z, 0, 0, 0, *-Y, 0, 0, 0, *-Y, 0.35, 0, 0, 0.75, 0, 0])
    direction = np.array([0.6, 0.0, 0.8])
    inside, outside = (solve(leg, [direction * 0.75 * (1 + gap)], 8)[1][0] for gap in (2e-13, 1e-10))
    assert OK in inside
    assert np.all(outside == UNREACHABLE)


def test_a_foot_on_the_first_axis_leaves_it_free(solve):
    leg = np.array([*Z, 0, 0, 0, *-Y, 0, 0, 0, *-Y, 0.35, 0, 0, 0.75, 0, 0])
    rows, status = solve(leg, [[0.0, 0.0, 0.5]], 8)
    assert np.count_nonzero(status == SINGULAR) >= 2
    assert np.all(rows[status == SINGULAR][:, 0] == 0.0)
    assert np.allclose(feet(leg, 8, rows[status == SINGULAR]), [0.0, 0.0, 0.5], rtol=0, atol=1e-13)


def test_rows_are_sorted_and_in_range(compiled):
    rng = np.random.default_rng(6)
    for sequence in THREE:
        leg = random_leg(rng, sequence, "random")
        rows, status = compiled(leg, feet(leg, sequence, poses(rng, sequence, 100)), sequence)
        for row, state in zip(rows, status, strict=True):
            first = row[state != UNREACHABLE][:, 0]
            assert np.all(np.diff(first) >= -1e-9)
            assert np.array_equal(state == UNREACHABLE, np.sort(state == UNREACHABLE))
        turning = np.array([kind == "R" for kind in kinds_of(sequence)])
        assert np.all((rows[..., turning] > -np.pi) & (rows[..., turning] <= np.pi))


def test_one_branch_is_one_row(compiled):
    rng = np.random.default_rng(7)
    leg = random_leg(rng, 8, "random")
    p = feet(leg, 8, poses(rng, 8, 20))
    rows, status = compiled(leg, p, 8)
    for branch in range(slots_of("RRR")):
        q, state = compiled.branch(leg, p, 8, branch)
        assert np.array_equal(q, rows[:, branch])
        assert np.array_equal(state, status[:, branch])
    for branch in (-1, 4):
        q, state = compiled.branch(leg, p, 8, branch)
        assert np.all(np.isnan(q))
        assert np.all(state == BAD_INPUT)


SPECIAL = [0.0, -0.0, 5e-324, 1e-160, 0.4, -1.0, 1e20, -1e160, 1.7e308, np.nan, np.inf]


@pytest.mark.parametrize("sequence", [8, 9, 10, 12, 15, 4, 2])
def test_every_target_has_an_answer(solve, sequence):
    leg = random_leg(np.random.default_rng(8), sequence, "random")
    p = np.stack(np.meshgrid(*[SPECIAL[:: 1 if axis == 0 else 2] for axis in range(3)], indexing="ij"), axis=-1).reshape(-1, 3)
    p = p[:: 1 if isinstance(solve, General) else 7]
    with np.errstate(all="ignore"):
        rows, status = solve(leg, p, sequence)
    bad = ~np.all(np.isfinite(p), axis=1)
    assert np.all(status[bad] == BAD_INPUT)
    assert np.all(np.isnan(rows[bad]))
    assert np.all(np.isnan(rows) == (status == BAD_INPUT)[..., None])


@pytest.mark.parametrize("exponent", [-300, 300])
def test_size_does_not_matter(compiled, exponent):
    rng = np.random.default_rng(9)
    leg = random_leg(rng, 8, "random")
    p = feet(leg, 8, poses(rng, 8, 30))
    lengths = np.array([*[False] * 3, *[True] * 3] * 3 + [True] * 3)
    rows, status = compiled(leg, p, 8)
    scaled, states = compiled(np.where(lengths, np.ldexp(leg, exponent), leg), np.ldexp(p, exponent), 8)
    assert np.array_equal(rows, scaled)
    assert np.array_equal(status, states)


@pytest.mark.parametrize("sequence", THREE)
def test_float_reaches_what_it_claims(compiled, sequence):
    rng = np.random.default_rng(10)
    leg = random_leg(rng, sequence, "random").astype(np.float32).astype(float)
    p = feet(leg, sequence, poses(rng, sequence, 100))
    rows, status = compiled(leg, p, sequence, np.float32)
    exact = np.isin(status, (OK, SINGULAR, DUPLICATE))
    assert np.mean(np.any(exact, axis=1)) > 0.98
    gap = np.linalg.norm(feet(leg, sequence, rows.astype(float)) - p[:, None], axis=-1) / (1 + np.max(np.abs(rows), axis=-1))
    assert np.max(gap[exact]) <= 1e-5

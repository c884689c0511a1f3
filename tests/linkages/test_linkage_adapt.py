"""Modular robots whose legs have linkages adapted to the ground: every target of a pose is reached, no neighbour is better, any input."""

import numpy as np
import pytest
from scipy.optimize import minimize

from linkages import modular
from linkages.modular import criterion
from oracles.measure import difference
from walkgen.model.assemble import assemble
from walkgen.spec.read import read
from walkgen.symbolic.adapt import adapt_functions
from walkgen.walking import walked
from walkgen.walking_request import Wanted

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE = range(5)
MIXED = modular.mixed()
ROBOTS = {
    "mixed": MIXED,
    "bessonov": modular.three(modular.bessonov("[0.4, 2.6]"), "bessonov"),
    "ankle": modular.three(modular.with_ankle(), "pantograph"),
    "without rows": modular.three(modular.garrec(), "garrec"),
}
OTHERS = tuple(pytest.param(name, marks=pytest.mark.nightly) for name in ROBOTS if name != "mixed")
EARLY = {"mixed": 0.12, "bessonov": 0.02, "ankle": 0.02, "without rows": 0.12}
"""At most so many descents of poses all over the ranges end in a leg's singular pose."""
BETTER = {"mixed": 0.97, "bessonov": 0.95, "ankle": 0.95, "without rows": 0.9}
"""At least so many stand no worse than the pose that made their targets; others have a leg beside a singular pose there, where the descent
from it ends early, and a stand that another start leads to goes before that."""


def posed(robot, count, seed):
    """Poses all over the limits, a turn where there are none, and the targets that their feet stand on; none is left out."""
    low, high = np.where(np.isfinite(robot.limits), robot.limits, [-1.0, 1.0]).T
    q = np.random.default_rng(seed).uniform(low, high, (count, len(low)))
    return q, robot.foot_positions(q)


@pytest.mark.parametrize("count", [100, pytest.param(400, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("name", ["mixed", *OTHERS])
def test_targets_of_poses_are_reached(built, name, count):
    """From the middle of the limits, and from the pose; cost and feet by the robot's own platforms and feet."""
    robot = built(ROBOTS[name]).c
    made, targets = posed(robot, count if name != "without rows" else count // 20, 1)
    own = np.array([criterion(robot, *row) for row in zip(made, targets, strict=True)])
    for start in (None, made):
        q, status, cost = robot.adapt(targets, start=start)
        assert set(status.tolist()) <= {OK, NO_CONVERGENCE}
        assert np.mean(status == NO_CONVERGENCE) <= EARLY[name]
        assert difference(robot.foot_positions(q), targets) <= 1e-8  # near a dead point the drives' rounding counts
        assert np.median(np.abs(robot.foot_positions(q) - targets).max(axis=(1, 2))) <= 1e-14
        assert difference(cost, [criterion(robot, *row) for row in zip(q, targets, strict=True)]) <= 1e-11
        chains = slice(0, 3)
        assert ((robot.limits[chains, 0] <= q[:, chains]) & (q[:, chains] <= robot.limits[chains, 1])).all()
    counted = np.ones_like(status, bool) if name == "mixed" else status == OK
    assert np.mean((cost <= own + 1e-9)[counted]) >= BETTER[name]


def followed(robot, q, c, targets):
    """Joint values with these chain joints, legs by their own inverse near to those of q; None where a leg does not reach."""
    pose = robot.platform_poses(np.concatenate([c, q[3:]]))
    after = np.concatenate([c, q[3:]])
    for leg, target, home in zip(robot.legs.values(), targets, (0, 1, 1, 1), strict=False):
        local = pose[home, :3, :3].T @ (target - pose[home, :3, 3])
        own, status = leg.inverse_near(local, q[leg.slice])
        if status != OK:
            return None
        turning = [not name.endswith(("lift", "reach", "slide")) for name in robot.joint_names[leg.slice]]
        after[leg.slice] = np.where(turning, own - 2 * np.pi * np.round((own - q[leg.slice]) / (2 * np.pi)), own)
    return after


@pytest.mark.parametrize("name", ["mixed", *OTHERS[:2]])
def test_no_neighbour_of_a_stand_is_better(built, name):
    """By legs that follow their own inverse in NumPy: the slope within the limits is none, and a minimiser finds nothing lower."""
    robot, plain = built(ROBOTS[name]).c, built(ROBOTS[name]).numpy
    _, targets = posed(robot, 3, 2)
    q, status, cost = robot.adapt(targets)
    low, high = robot.limits[:3].T
    for best, least, aims in zip(q[status == OK], cost[status == OK], targets[status == OK], strict=True):

        def phi(c, best=best, aims=aims):
            at = followed(plain, best, np.clip(c, low, high), aims)
            return np.inf if at is None else criterion(plain, at, aims)

        assert abs(phi(best[:3]) - least) <= 1e-11 * max(1.0, least)
        step = 1e-4
        slope = np.array([(phi(best[:3] + way) - phi(best[:3] - way)) / (2 * step) for way in step * np.eye(3)])
        held = (best[:3] <= low) | (best[:3] >= high)
        assert np.all(held | (np.abs(slope) <= 1e-5 * max(1.0, least)))
        found = minimize(phi, np.clip(best[:3] + 0.01, low, high), method="Nelder-Mead", bounds=robot.limits[:3], options={"maxfev": 120})
        assert found.fun >= least - 1e-9


@pytest.mark.parametrize("name", ["mixed", *OTHERS])
def test_c_is_numpy(built, name):
    robot, plain = built(ROBOTS[name]).c, built(ROBOTS[name]).numpy
    made, targets = posed(robot, 3, 3)
    for start in (None, made):
        rows = slice(0, 3) if start is not None else slice(0, 2 if name == "mixed" else 1)
        given = targets[rows], None, None if start is None else start[rows]
        (q, status, cost), (q_plain, status_plain, cost_plain) = robot.adapt(*given), plain.adapt(*given)
        assert np.array_equal(status, status_plain)
        assert difference(q[status == OK], q_plain[status == OK]) <= 1e-8
        assert difference(cost[status == OK], cost_plain[status == OK]) <= 1e-10


def test_out_of_reach_comes_close(built):
    """Against SciPy from the answer and from beside it: chains in their limits, legs free, the sum of squared gaps."""
    robot = built(MIXED).c
    _, targets = posed(robot, 12, 4)
    targets[:, 1:] += 0.4 * np.random.default_rng(4).normal(size=(12, 3, 3))
    q, status, cost = robot.adapt(targets)
    assert np.sum(status == UNREACHABLE) >= 10
    assert difference(robot.foot_positions(q[status == OK]), targets[status == OK]) <= 1e-12
    assert np.isfinite(q).all()
    assert np.isfinite(cost).all()
    bounds, shares = np.where(np.arange(len(q[0]))[:, None] < 3, robot.limits, [-np.inf, np.inf]), []
    for own, aims in zip(q[status == UNREACHABLE], targets[status == UNREACHABLE], strict=True):

        def missed(x, aims=aims):
            feet = robot.foot_positions(x)[1:]
            return np.sum((feet - aims[1:]) ** 2) if np.isfinite(feet).all() else 1e3

        least = min(minimize(missed, own + jump, method="L-BFGS-B", bounds=bounds).fun for jump in (0.0, 0.01))
        shares.append(least / missed(own))
    assert np.median(shares) >= 0.98
    assert min(shares) >= 0.6


def test_runtime_parameters_reach_the_legs(built):
    """Rods of two lengths, row by row."""
    robot, plain = built(MIXED).c, built(MIXED).numpy
    made, _ = posed(robot, 2, 10)
    lengths = np.array([[0.22], [0.19]])
    targets = robot.foot_positions(made, param=lengths)
    q, status, cost = robot.adapt(targets, start=made, param=lengths)
    assert np.all(status == OK)
    assert difference(robot.foot_positions(q, param=lengths), targets) <= 1e-12
    q_plain, status_plain, cost_plain = plain.adapt(targets, start=made, param=lengths)
    assert np.array_equal(status, status_plain)
    assert difference(q, q_plain) <= 1e-8
    assert difference(cost, cost_plain) <= 1e-10
    assert difference(robot.adapt(targets, start=made)[0], q) >= 1e-3


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_fixed_leg_that_misses_says_so(built, backend):
    """The first leg stands on the first platform, where no chain can help."""
    robot = getattr(built(MIXED), backend)
    made, targets = posed(robot, 1, 5)
    targets[0, 0] += [2.0, 0.0, 0.0]
    q, status, cost = robot.adapt(targets[0], start=made[0])
    assert status == UNREACHABLE
    assert np.isfinite(q).all()
    assert np.isfinite(cost)
    assert difference(robot.foot_positions(q)[1:], targets[0, 1:]) <= 1e-8


def test_dead_points_on_the_way(built):
    """The crank's dead point is the middle of its limits, which the criterion seeks: legs stop there with their feet on the targets."""
    robot = built(modular.three(modular.bessonov("[-1.4, 1.4]"), "bessonov")).c
    made, targets = posed(robot, 24, 6)
    made[::3, 7] = 0.0
    targets = robot.foot_positions(made)
    for start in (None, made):
        q, status, cost = robot.adapt(targets, start=start)
        assert set(status.tolist()) == {OK, NO_CONVERGENCE}
        assert difference(robot.foot_positions(q), targets) <= 1e-8
        assert np.isfinite(cost).all()


def test_cranks_in_line_hold_no_foot(built):
    """Both cranks of the five-bar in one place: any foot on a circle closes it, and none is held; no such pose is a stand."""
    robot = built(MIXED).c
    rng = np.random.default_rng(7)
    made, targets = posed(robot, 200, 7)
    made[:, 11] = 2 * np.pi - made[:, 10] + 1e-9 * rng.normal(size=len(made))
    start = np.where(rng.random(made.shape) < 0.5, made, np.nan)
    q, status, _ = robot.adapt(targets, start=start)
    assert set(status.tolist()) <= {OK, NO_CONVERGENCE}
    assert difference(robot.foot_positions(q), targets) <= 1e-8


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_what_is_no_number_is_bad_input(built, backend):
    robot = getattr(built(MIXED), backend)
    made, targets = posed(robot, 1, 8)
    for value in (np.nan, np.inf):
        wrong = targets[0].copy()
        wrong[2, 1] = value
        with np.errstate(all="ignore"):
            answers = [
                robot.adapt(wrong),
                robot.adapt(targets[0], np.full((2, 3), value)),
                robot.adapt(targets[0], weights=[1, value, 1, 1]),
            ]
        for q, status, cost in answers:
            assert status == BAD_INPUT
            assert np.isnan(q).all()
            assert np.isnan(cost)
    start = made[0].copy()
    start[[0, 4, 7, 12]] = np.nan, np.inf, -np.inf, np.nan
    assert robot.adapt(targets[0], start=start)[1] in (OK, NO_CONVERGENCE)


SPECIAL = (0.0, -0.0, 5e-324, 1e-200, 1e-9, 0.3, -0.5, 1.0, 10.0, 1e9, 1e160, -1e160, 1.7e308, np.inf, -np.inf, np.nan)


def test_any_input_has_an_answer(built):
    robot = built(MIXED).c
    rng = np.random.default_rng(9)
    made, targets = posed(robot, 45, 9)
    weights = np.tile(modular.WEIGHTS, (45, 1))
    for row in range(45):
        chosen = (targets, made, weights)[row % 3][row]
        chosen.flat[rng.integers(chosen.size, size=2)] = rng.choice(SPECIAL, 2)
    q, status, cost = robot.adapt(targets, start=made, weights=weights)
    bad = status == BAD_INPUT
    assert np.isnan(q[bad]).all()
    assert np.isnan(cost[bad]).all()
    assert np.isfinite(q[~bad]).all()
    assert np.isfinite(cost[~bad]).all()
    assert set(status.tolist()) <= {OK, UNREACHABLE, BAD_INPUT, NO_CONVERGENCE}
    assert not bad.all()


def test_legs_of_other_counts_have_none(tmp_path):
    """Two q miss targets."""
    design = modular.pantograph().replace(modular.YAW.format(name="pantograph"), "[leg_designs.pantograph.links.frame]")
    spec = tmp_path / "modular.toml"
    spec.write_text(modular.three(design, "pantograph"))
    assert not adapt_functions(assemble(read(spec)))


@pytest.mark.nightly
def test_a_walk_over_waves_adapts_its_chains(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    spec = tmp_path / "walking.toml"
    spec.write_text(modular.walking())
    walk = walked(spec, Wanted(adapt=True, terrain="0.02*sin(3*x)")).walk
    assert all(fault.kind != "chains" for fault in walk.faults)
    assert np.ptp(walk.q[:, :2], axis=0).min() > 1e-3
    assert walk.slip < 1e-12

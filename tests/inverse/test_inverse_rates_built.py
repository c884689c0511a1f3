"""Rates of legs and routes of 1 to 9 joints, turning and sliding, in C, float, NumPy and CasADi, against NumPy's singular values."""

from functools import cache

import casadi
import numpy as np
import pytest
from rates_robot import FEW, LAMBDA, OWNERS, ROUTED, SQUARE, paths, text

from oracles.backends import Built
from walkgen import pipeline

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)


@pytest.fixture(params=[owner if owner in FEW else pytest.param(owner, marks=pytest.mark.nightly) for owner in OWNERS])
def path(request):
    return paths()[request.param]


@pytest.fixture(scope="module")
def robot_of(tmp_path_factory):
    """`few` or `all`, by backend; C with float."""

    @cache
    def build(name):
        folder = tmp_path_factory.mktemp("rates")
        spec = folder / "spec.toml"
        spec.write_text(text(name), encoding="utf-8")
        built = Built(spec, pipeline.build(spec, folder / "generated", pipeline.BuildOptions(float32=True)).folder)
        return {"c": built.c, "numpy": built.numpy}

    return build


@pytest.fixture
def robots(robot_of, path):
    return robot_of("few" if path.owner in FEW else "all")


def call(robot, path, name, *inputs):
    return robot.functions[f"rates_{path.owner}_{name}"](*inputs)


def expected(path, q, v):
    """J^+ v [count, n] with each singular value s counted as s + lambda^2 / s, statuses [count], and the damping lambda [count]."""
    J = path.jacobians(q)
    U, s, Vt = np.linalg.svd(J, full_matrices=False)
    least = s[:, -1]
    damping = np.where(least < path.epsilon, np.sqrt(np.maximum(1 - (least / path.epsilon) ** 2, 0)) * LAMBDA, 0.0)
    gains = s / (s**2 + damping[:, None] ** 2)
    qd = np.einsum("rki,rk,rjk,rj->ri", Vt, gains, U, v)
    missed = np.linalg.norm(np.einsum("rij,rj->ri", J, qd) - v, axis=1) > 1e-9 * np.linalg.norm(v, axis=1)
    return qd, np.where(least < path.epsilon, SINGULAR, np.where(missed, UNREACHABLE, OK)), damping


def relative(path, q, v, found, wanted, damping):
    """Errors over the largest rate that such a pose and velocity can give."""
    least = np.linalg.svd(path.jacobians(q), compute_uv=False)[:, -1]
    return np.linalg.norm(found - wanted, axis=1) * np.maximum(least, damping) / np.linalg.norm(v, axis=1)


def check(path, q, v, found, status):
    wanted, statuses, damping = expected(path, q, v)
    assert np.array_equal(status, statuses)
    assert relative(path, q, v, found, wanted, damping).max() <= 1e-12
    assert np.all(np.linalg.norm(found, axis=1) * 2 * damping <= np.linalg.norm(v, axis=1) * (1 + 1e-12))
    return statuses


@pytest.mark.sampled(10)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_velocities(robots, backend, path):
    q, _, v = path.motions(300, 5)
    statuses = check(path, q, v, *call(robots[backend], path, "inverse_velocity", q, v))
    changing = path.n > 1 and any(joint.revolute for joint in path.limb.joints)
    assert {OK, SINGULAR} <= set(statuses) or not changing or path.owner in ROUTED
    assert UNREACHABLE in statuses or path.n > 2 or set(statuses) == {SINGULAR}


@pytest.mark.sampled(10)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_accelerations(robots, backend, path):
    """a = J qdd + Jdot qd, with Jdot qd from complex steps."""
    q, qd, rest = path.motions(60, 6)
    bias = path.biases(q, qd)
    check(path, q, rest, *call(robots[backend], path, "inverse_acceleration", q, qd, rest + bias))


def check_together(path, q, v, a, qd, qdd, status):
    """qd of v; qdd of what Jdot qd leaves of a, at the qd that was found; the worse of both statuses."""
    wanted, first, damping = expected(path, q, v)
    rest = a - path.biases(q, qd)
    further, second, _ = expected(path, q, rest)
    assert np.array_equal(status, np.where(second == OK, first, second))
    assert relative(path, q, v, qd, wanted, damping).max() <= 1e-12
    assert relative(path, q, rest, qdd, further, damping).max() <= 1e-12
    return status


@pytest.mark.sampled(8)
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_together(robots, backend, path):
    q, _, v = path.motions(120, 11)
    a = path.motions(120, 12)[2]
    statuses = check_together(path, q, v, a, *call(robots[backend], path, "inverse_velocity_acceleration", q, v, a))
    changing = path.n > 1 and any(joint.revolute for joint in path.limb.joints)
    assert {OK, SINGULAR} <= set(statuses) or path.n < 3 or not changing or path.owner in ROUTED


@pytest.mark.sampled(6)
def test_together_in_float(robots, path):
    """As the two one after the other, both to what a float tells of the pose."""
    q, _, v = (array.astype(np.float32) for array in path.motions(200, 13))
    a = path.motions(200, 14)[2].astype(np.float32)
    qd, qdd, status = call(robots["c"], path, "inverse_velocity_acceleration", q, v, a)
    first, one = call(robots["c"], path, "inverse_velocity", q, v)
    second, other = call(robots["c"], path, "inverse_acceleration", q, qd, a)
    assert qd.dtype == qdd.dtype == np.float32
    assert np.array_equal(status, np.where(other == OK, one, other))
    J = path.jacobians(q.astype(float))
    values = np.linalg.svd(J, compute_uv=False)
    fine = 512 * np.finfo(np.float32).eps * (1 + values[:, 0]) / np.maximum(values[:, -1], path.epsilon)
    rest = np.linalg.norm(a, axis=1) + (1 + values[:, 0]) * np.linalg.norm(qd, axis=1) ** 2
    assert np.all(np.linalg.norm(qd - first, axis=1) <= fine * np.linalg.norm(v, axis=1) / np.maximum(values[:, -1], path.epsilon))
    assert np.all(np.linalg.norm(qdd - second, axis=1) <= fine * rest / np.maximum(values[:, -1], path.epsilon))


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_together_what_is_not_finite_is_bad_input(robots, backend, path):
    """All numbers are NaN then; a Jacobian that no joint value changes does not see those."""
    fine = np.linspace(-1.0, 1.3, path.n + 6)
    rows = np.array([np.where(np.arange(len(fine)) == place, value, fine) for place in range(len(fine)) for value in (np.nan, np.inf)])
    with np.errstate(all="ignore"):
        qd, qdd, status = call(robots[backend], path, "inverse_velocity_acceleration", *np.split(rows, [path.n, path.n + 3], axis=1))
    both = np.hstack([qd, qdd])
    assert np.array_equal(np.isnan(both).any(axis=1), status == BAD_INPUT)
    assert np.array_equal(np.isnan(both).all(axis=1), status == BAD_INPUT)
    bad = ~np.isfinite(rows[:, path.n :]).all(axis=1)
    if all(joint.revolute for joint in path.limb.joints):
        bad = ~np.isfinite(rows).all(axis=1)
    assert np.all(status[bad] == BAD_INPUT)


@pytest.mark.sampled(6)
def test_float(robots, path):
    q, _, v = (array.astype(np.float32) for array in path.motions(300, 7))
    found, status = call(robots["c"], path, "inverse_velocity", q, v)
    wide = q.astype(float), v.astype(float)
    wanted, statuses, damping = expected(path, *wide)
    values = np.linalg.svd(path.jacobians(wide[0]), compute_uv=False)
    missed = np.linalg.norm(v - np.einsum("rij,rj->ri", path.jacobians(wide[0]), wanted), axis=1) / np.linalg.norm(v, axis=1)
    clear = (np.abs(values[:, -1] - path.epsilon) > 1e-5) & (np.abs(np.log10((missed + 1e-12) / 1e-4)) > 0.5)
    statuses[(statuses == UNREACHABLE) & (missed < 1e-4)] = OK
    assert found.dtype == np.float32
    assert np.count_nonzero(clear) > 290
    assert np.array_equal(status[clear], statuses[clear])
    error = relative(path, *wide, found, wanted, damping) * np.maximum(values[:, -1], path.epsilon) / (1 + values[:, 0])
    assert error[clear].max() <= 64 * np.finfo(np.float32).eps


def test_casadi(robots, path):
    velocity, acceleration = (robots["c"].casadi(f"rates_{path.owner}_{name}") for name in ("inverse_velocity", "inverse_acceleration"))
    q, qd, v = path.motions(24, 8)
    found = [[np.array(value).ravel() for value in velocity(*row)] for row in zip(q, v, strict=True)]
    check(path, q, v, np.array([row[0] for row in found]), np.array([row[1][0] for row in found]))
    found = [[np.array(value).ravel() for value in acceleration(*row)] for row in zip(q, qd, v + path.biases(q, qd), strict=True)]
    check(path, q, v, np.array([row[0] for row in found]), np.array([row[1][0] for row in found]))
    together, a = robots["c"].casadi(f"rates_{path.owner}_inverse_velocity_acceleration"), path.motions(24, 10)[2]
    found = [[np.array(value).ravel() for value in together(*row)] for row in zip(q, v, a, strict=True)]
    qd, qdd, status = (np.array([row[place] for row in found]) for place in range(3))
    check_together(path, q, v, a, qd, qdd, status[:, 0])


def test_casadi_derivatives(robots, path):
    """By q and v, damped or not, against central differences."""
    function = robots["c"].casadi(f"rates_{path.owner}_inverse_velocity")
    q, v = casadi.SX.sym("q", path.n), casadi.SX.sym("v", 3)
    both = casadi.vertcat(q, v)
    rates = function(q, v)[0]
    slope = casadi.Function("slope", [both], [casadi.jacobian(rates, both)])
    values = casadi.Function("values", [both], [rates])
    step = 1e-6
    for angles, speed in zip(*path.motions(16, 9)[::2], strict=True):
        at = np.concatenate([angles, speed])
        found = np.array(slope(at))
        differences = [(np.array(values(at + side)) - np.array(values(at - side))).ravel() / (2 * step) for side in step * np.eye(len(at))]
        least = np.linalg.svd(path.jacobians(angles[None])[0], compute_uv=False)[-1]
        border = abs(least / path.epsilon - 1) < 1e-3
        size = np.linalg.norm(found) + np.linalg.norm(np.array(differences))
        assert np.all(np.isfinite(found))
        assert border or np.linalg.norm(found - np.array(differences).T) <= 1e-5 * size


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_what_is_not_finite_is_bad_input(robots, backend, path):
    """A Jacobian that no joint value changes does not see them."""
    fine = np.linspace(-1.0, 1.3, 2 * path.n + 3)
    rows = np.array([np.where(np.arange(len(fine)) == place, value, fine) for place in range(len(fine)) for value in (np.nan, np.inf)])
    q, qd, a = rows[:, : path.n], rows[:, path.n : 2 * path.n], rows[:, 2 * path.n :]
    with np.errstate(all="ignore"):
        found, status = call(robots[backend], path, "inverse_acceleration", q, qd, a)
    assert np.array_equal(np.isnan(found).any(axis=1), status == BAD_INPUT)
    assert np.array_equal(np.isnan(found).all(axis=1), status == BAD_INPUT)
    bad = ~np.isfinite(a).all(axis=1)
    if all(joint.revolute for joint in path.limb.joints):
        bad = ~np.isfinite(rows).all(axis=1)
    assert np.all(status[bad] == BAD_INPUT)


def test_legs_at_right_angles_have_equal_singular_values():
    """What `SQUARE` says: the case in which the cubic has a double root at every pose."""
    for name in SQUARE:
        values = np.linalg.svd(paths()[name].jacobians(np.full((1, 3), 0.4))[0], compute_uv=False)
        assert min(np.abs(np.diff(values))) <= 1e-15

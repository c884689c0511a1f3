"""The least contact forces in CasADi: the same forces as in C, with the derivatives of the implicit function."""

import casadi as ca
import numpy as np
import pytest
from quadruped import spec, stands

OK, BAD_INPUT, NO_CONVERGENCE, INFEASIBLE = 0, 2, 4, 5


@pytest.fixture(scope="module")
def robot(built):
    return built(spec("contact_forces"))


def rows(function, points, normals, mu, wrench, n_max=np.inf, facets=0):
    found = [function(p, n, m, w, np.ones(4), np.full(4, n_max), facets) for p, n, m, w in zip(points, normals, mu, wrench, strict=True)]
    return [np.array([np.array(row[place], float) for row in found]) for place in range(5)]


def test_forces_are_those_in_c(robot):
    stance = stands(60, seed=5, lean=0.25)
    f, status, state, certificate, violation = rows(robot.c.casadi("contact_forces"), *stance)
    expected, verdicts, states, *_ = robot.c.contact_forces(*stance)
    carried = verdicts == OK
    assert 20 <= np.count_nonzero(carried) < 60
    assert np.array_equal(status[:, 0, 0] == OK, carried)
    assert np.all(np.isin(status[~carried], (NO_CONVERGENCE, INFEASIBLE)))
    np.testing.assert_allclose(f[carried], expected[carried], atol=1e-8)
    assert np.array_equal(state[carried, :, 0], states[carried])
    assert np.any(states[carried] == 1)
    assert np.any(states[carried] == 2)
    assert np.all(violation[carried] <= 1e-8)
    proven = status[:, 0, 0] == INFEASIBLE
    np.testing.assert_allclose(np.einsum("ni,ni->n", certificate[proven, :, 0], stance[3][proven]), 1.0, atol=1e-9)


def test_limits_of_normal_forces(robot):
    stance = stands(20, seed=6, slope=0.1)
    f, status, *_ = rows(robot.c.casadi("contact_forces"), *stance, n_max=40.0)
    expected, verdicts, *_ = robot.c.contact_forces(*stance, n_max=40.0)
    carried = (verdicts == OK) & (status[:, 0, 0] == OK)
    assert np.count_nonzero(carried) >= 10
    np.testing.assert_allclose(f[carried], expected[carried], atol=1e-8)


def test_derivatives_by_the_load_and_the_feet(robot):
    function = robot.c.casadi("contact_forces")
    points, normals, mu, wrench = stands(40, seed=7)
    verdicts, states = robot.c.contact_forces(points, normals, mu, wrench)[1:3]
    row = next(i for i in range(40) if verdicts[i] == OK and {0, 1} <= set(states[i]))
    load, feet = ca.MX.sym("load", 6), ca.MX.sym("feet", 4, 3)
    f = function(feet, normals[row], mu[row], load, np.ones(4), np.full(4, np.inf), 0)[0]
    slopes = ca.Function("slopes", [load, feet], [ca.jacobian(ca.vec(f.T), load), ca.jacobian(ca.vec(f.T), feet)])
    by_load, by_feet = (np.array(slope) for slope in slopes(wrench[row], points[row]))

    def forces(w, p):
        return robot.c.contact_forces(p, normals[row], mu[row], w)[0].reshape(*np.shape(w)[:-1], 12)

    step = 1e-5
    stepped = [forces(wrench[row] + sign * step * np.eye(6), points[row]) for sign in (1, -1)]
    np.testing.assert_allclose(by_load, (stepped[0] - stepped[1]).T / (2 * step), atol=1e-6)
    shifts = step * np.eye(12).reshape(12, 4, 3)
    stepped = [forces(np.tile(wrench[row], (12, 1)), points[row] + sign * shifts) for sign in (1, -1)]
    by_feet = by_feet.reshape(12, 3, 4).transpose(0, 2, 1).reshape(12, 12)  # CasADi counts down the columns of the feet
    np.testing.assert_allclose(by_feet, (stepped[0] - stepped[1]).T / (2 * step), atol=1e-4)


def test_facets_and_bad_numbers_have_a_status(robot):
    points, normals, mu, wrench = stands(1, seed=8, slope=0.1)
    function = robot.c.casadi("contact_forces")
    assert rows(function, points, normals, mu, wrench, facets=4)[1] == BAD_INPUT
    assert rows(function, points, normals, mu * np.nan, wrench)[1] == BAD_INPUT

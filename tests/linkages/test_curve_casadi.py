"""Rows of coupler curves in CasADi, which has no routine for them: those of C, with the slopes of the implicit function."""

import casadi
import numpy as np
import pytest

from linkages.test_driven_search import CRANK, HEAD, YAW
from linkages.topologies import TOPOLOGIES, spec

FUNCTIONS = ("foot_position", "foot_jacobian", "inverse", "inverse_branch", "inverse_distance")
OK, UNREACHABLE, BAD_INPUT = 0, 1, 2
GENERATE = "[generate]\nfunctions = [{}]\n".format(", ".join(f'"{name}"' for name in FUNCTIONS))
LEG = HEAD[: HEAD.index("[generate]")] + GENERATE + HEAD[HEAD.index("targets") :] + YAW + CRANK


def rows_of(robot, *given):
    rows, status = robot.casadi("leg_inverse")(*given)
    return np.array(rows), np.array(status).ravel()


def apart(one, other):
    return np.abs(np.angle(np.exp(1j * (one - other)))).max()


def test_rows_are_those_of_c(built):
    robot = built(LEG).c
    leg, random = robot.legs["leg"], np.random.default_rng(3)
    reached = leg.foot_position(random.uniform(-np.pi, np.pi, (12, 2)))
    for p in (*reached, *(reached + random.normal(size=reached.shape) * 0.1)):
        own, state = rows_of(robot, p)
        rows, status = leg.inverse(p)
        assert np.array_equal(state, status)
        assert apart(own, rows) < (1e-12 if OK in status else 1e-6)
        distance = np.array(robot.casadi("leg_inverse_distance")(p)).ravel()
        assert distance == pytest.approx(leg.inverse_distance(p), abs=1e-12)
        one, its = robot.casadi("leg_inverse_branch")(p, 1)
        assert np.array_equal(np.array(one).ravel(), own[1])
        assert float(its) == state[1]
    own, state = rows_of(robot, [np.nan, 0, 0])
    assert (state == BAD_INPUT).all()
    assert np.isnan(own).all()


def test_slopes(built):
    """J dq/dp leaves what the foot can do as it is."""
    robot = built(LEG).c
    leg, p = robot.legs["leg"], casadi.MX.sym("p", 3)
    q, _ = robot.casadi("leg_inverse")(p)
    slope = casadi.Function("slope", [p], [casadi.jacobian(q[0, :], p)])
    for own in np.random.default_rng(4).uniform(-np.pi, np.pi, (4, 2)):
        target = leg.foot_position(own)
        J = leg.foot_jacobian(leg.inverse(target)[0][0])
        assert np.array(slope(target)) @ J == pytest.approx(np.eye(2), abs=1e-8)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["four_bar", "slider_crank", "watt", "moving_guide"])
def test_random_dimensions(built, name):
    """As runtime parameters; some assemble for part of a turn alone."""
    robot = built(spec(name, FUNCTIONS).replace('["numpy"]', '["c", "numpy", "casadi"]')).c
    random = np.random.default_rng(2)
    dimensions, drives = TOPOLOGIES[name].draw(random, 150)
    leg = robot.legs["leg"]
    target = np.array([leg.foot_position(q, param=own) for q, own in zip(drives, dimensions, strict=True)])
    target[::3] += random.normal(size=target[::3].shape) * 0.1
    there = np.isfinite(target).all(-1)
    assert there.sum() > 50
    for p, param in zip(target[there], dimensions[there], strict=True):
        own, state = rows_of(robot, p, param)
        rows, status = leg.inverse(p, param=param)
        assert np.array_equal(state, status)
        assert OK not in status or apart(own[status == OK], rows[status == OK]) < 1e-9

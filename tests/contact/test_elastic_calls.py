"""Forces of elastic legs from a spec's sections to the feet, as users call them: the theory's stands, lifting feet, CasADi, mistakes."""

import casadi as ca
import numpy as np
import pytest

from mechanisms.elastic_robots import stand
from oracles.stands import O13_DELTA, O13_F, O13_Q, O13_WRENCH, O14_F, O14_Q, O14_WRENCH

FUNCTIONS = (
    "foot_positions",
    "stance_compliance",
    "contact_forces",
    "contact_forces_stiffness",
    "contact_forces_coupled",
    "contact_forces_vertical",
)
TEXT = stand().replace("[sections]", f"[generate]\nfunctions = {list(FUNCTIONS)}\n[sections]".replace("'", '"'))
UP = [0.0, 0.0, 1.0]
DOWN = [0.0, 0.0, -100.0, 0.0, 0.0, 0.0]
SQUARE = np.array([[0.3, 0.2, 0.0], [0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0]])
OK, NO_CONVERGENCE, INFEASIBLE = 0, 4, 5


@pytest.fixture(params=["c", "numpy"])
def robot(request, built):
    return getattr(built(TEXT), request.param)


def blocks(whole):
    return np.stack([whole[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] for i in range(4)])


@pytest.mark.parametrize(("q", "wrench", "expected", "atol"), [(O13_Q, O13_WRENCH, O13_F, 1e-11), (O14_Q, O14_WRENCH, O14_F, 1e-8)])
def test_the_stands_of_the_theory(robot, q, wrench, expected, atol):
    points, whole = robot.foot_positions(np.ravel(q)), robot.stance_compliance(np.ravel(q))
    for compliance in (whole, blocks(whole)):
        f, status, state, certificate, violation = robot.contact_forces(
            points, UP, np.inf, wrench, method="stiffness", compliance=compliance
        )
        assert status == OK
        np.testing.assert_allclose(f, expected, rtol=0, atol=atol * 588.6)
        assert not np.any(state)
        assert not np.any(certificate)
        assert violation <= 1e-9


def test_the_displacement_of_the_platform(robot):
    q = np.ravel(O13_Q)
    found = robot.contact_forces_stiffness(robot.foot_positions(q), UP, np.inf, O13_WRENCH, blocks(robot.stance_compliance(q)))
    np.testing.assert_allclose(found[3], O13_DELTA, rtol=1e-10)


def test_what_no_cone_carries_has_a_proof(robot):
    q = np.ravel(O13_Q)
    push = np.array([0.0, 500.0, -588.6, 0.0, 0.0, 0.0])
    options = {"method": "stiffness", "compliance": robot.stance_compliance(q)}
    f, status, _, certificate, _ = robot.contact_forces(robot.foot_positions(q), UP, 0.3, push, **options)
    assert status == INFEASIBLE
    assert np.all(np.isnan(f))
    assert certificate @ push == pytest.approx(1.0)


def test_a_batch_has_proofs_where_there_are_none_to_carry(robot):
    q = np.ravel(O13_Q)
    loads = np.array([O13_WRENCH, [0.0, 0.0, 588.6, 0.0, 0.0, 0.0]])
    options = {"method": "stiffness", "compliance": robot.stance_compliance(q)}
    f, status, _, certificate, _ = robot.contact_forces(robot.foot_positions(q), UP, [[0.9], [np.inf]], loads, **options)
    assert list(status) == [OK, INFEASIBLE]
    assert np.isfinite(f[0]).all()
    assert not certificate[0].any()
    assert certificate[1] @ loads[1] == pytest.approx(1.0)


def test_shapes_are_named(robot):
    with pytest.raises(ValueError, match=r"stiffness needs \[4,3,3\] or \[12,12\]"):
        robot.contact_forces(np.zeros((4, 3)), UP, 0.5, O14_WRENCH, method="stiffness", compliance=np.eye(3))
    with pytest.raises(ValueError, match="stiffness needs"):
        robot.contact_forces(np.zeros((4, 3)), UP, 0.5, O14_WRENCH, method="stiffness")


def test_casadi_has_feet_that_stick(built):
    robot, q = built(TEXT).c, np.ravel(O13_Q)
    function = robot.casadi("contact_forces_stiffness")
    points, C = robot.foot_positions(q), blocks(robot.stance_compliance(q)).reshape(4, 9)
    load = ca.MX.sym("load", 6)
    f, status, _, displacement, violation = function(points, np.tile(UP, (4, 1)), np.full(4, 1e6), load, C, np.zeros((4, 3)))
    values = ca.Function("values", [load], [f, status, displacement, violation, ca.jacobian(ca.vec(f.T), load)])(O13_WRENCH)
    found, verdict, moved, left, slopes = (np.array(value) for value in values)
    np.testing.assert_allclose(found, O13_F, rtol=0, atol=1e-11 * 588.6)
    np.testing.assert_allclose(moved[:, 0], O13_DELTA, rtol=1e-10)
    assert (verdict, left <= 1e-9) == (OK, True)
    np.testing.assert_allclose(slopes @ O13_WRENCH, found.ravel(), atol=1e-9)  # without misfit the forces are linear in the load
    assert function(points, np.tile(UP, (4, 1)), np.full(4, 0.1), O13_WRENCH, C, np.zeros((4, 3)))[1] == NO_CONVERGENCE


@pytest.mark.parametrize(("method", "options"), [("stiffness", {"compliance": np.tile(np.eye(3), (3, 1, 1))}), ("vertical", {})])
def test_lost_loads_are_named(robot, method, options):
    """Feet on a line carry no moment about it; statuses tell of single rows."""
    line, triangle = SQUARE[:1] * [[1], [0], [-2]], SQUARE[:3]
    with pytest.raises(ValueError, match=r"3 feet on a line carry no moment about it, along \[0\.83205 +0\.5547 +0\. +\] through"):
        robot.contact_forces(line, UP, 0.5, DOWN, method=method, **options)
    with pytest.raises(ValueError, match="feet at one place"):
        robot.contact_forces(np.zeros((3, 3)), UP, 0.5, DOWN, method=method, **options)
    status = robot.contact_forces(np.stack([line, triangle]), UP, 0.5, DOWN, method=method, **options)[1]
    assert status[0] == 3
    assert status[1] != 3


def test_a_singular_compliance_is_named(robot):
    compliance = np.tile(np.eye(3), (4, 1, 1))
    compliance[2, 1, 1] = 0.0
    with pytest.raises(ValueError, match=r"compliance of foot 2 is .*positive definite"):
        robot.contact_forces(SQUARE, UP, 0.5, DOWN, method="stiffness", compliance=compliance)

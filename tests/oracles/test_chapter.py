"""The oracles before anything is generated: the chapter's algebra, the theory's numbers and the walker agree."""

import numpy as np
import pytest
import sympy

from oracles import chapter, theory
from oracles.measure import difference
from oracles.walker import Walker, WalkerJoint, WalkerLimb, X, Z, rotation, translation

REVOLUTE = ("revolute", "revolute", "revolute")
LEGS = {
    "A": (theory.LEG_A, REVOLUTE, theory.LEG_A_FOOT),
    "B": (theory.LEG_B, REVOLUTE, theory.LEG_B_FOOT),
    "RRP": (theory.RRP, ("revolute", "revolute", "prismatic"), (0.0, 0.0, 0.0)),
    "RPP": (theory.RPP, ("revolute", "prismatic", "prismatic"), (0.02, -0.03, 0.01)),
    "PRP": (theory.LEG_B, ("prismatic", "revolute", "prismatic"), theory.LEG_B_FOOT),
    "PPP": (theory.RPP, ("prismatic", "prismatic", "prismatic"), (0.0, 0.0, 0.0)),
}


def walker_leg(rows, kinds, foot) -> WalkerLimb:
    joints = tuple(
        WalkerJoint(
            kind == "revolute",
            rotation(Z, theta) @ translation((0, 0, s)),
            Z,
            translation((a, 0, 0)) @ rotation(X, alpha),
            1.0,
            0.0,
        )
        for (theta, s, a, alpha), kind in zip(rows, kinds, strict=True)
    )
    return WalkerLimb("leg", "body", np.eye(4), joints, translation(foot), mirrored=False)


def test_one_pair():
    assert difference(chapter.A(*theory.O1_ROW), theory.O1_A) <= 1e-15


def test_operators_differentiate_one_pair():
    """dA/dtheta = Q_theta A, dA/ds = Q_s A, and the products of the Qs, symbolically."""
    theta, s, a, alpha = sympy.symbols("theta s a alpha", real=True)
    c, n, ca, sa = sympy.cos(theta), sympy.sin(theta), sympy.cos(alpha), sympy.sin(alpha)
    A = sympy.Matrix([[1, 0, 0, 0], [a * c, c, -n * ca, n * sa], [a * n, n, c * ca, -c * sa], [s, 0, sa, ca]])
    Q_theta, Q_s = (sympy.Matrix(Q.astype(int)) for Q in (chapter.Q_THETA, chapter.Q_S))
    assert A.diff(theta) == Q_theta * A
    assert A.diff(s) == Q_s * A
    assert Q_theta**3 == -Q_theta
    assert Q_s**2 == Q_theta * Q_s == Q_s * Q_theta == sympy.zeros(4)
    assert np.array_equal(chapter.A(0.3, 0.12, 0.05, 0.7), sympy.lambdify((theta, s, a, alpha), A)(0.3, 0.12, 0.05, 0.7))


@pytest.mark.parametrize("leg", LEGS)
def test_operators_are_the_walkers_derivatives(leg):
    rows, kinds, foot = LEGS[leg]
    walker = walker_leg(rows, kinds, foot)
    for q in np.random.default_rng(3).uniform(-2, 2, (10, 3)):
        products = chapter.chain(rows, kinds, q)
        assert difference(products, [chapter.one_first(T) for T in walker.frames(q)]) <= 1e-14
        assert difference(chapter.jacobian(products, kinds, foot), walker.jacobian(q)) <= 1e-13
        assert difference(chapter.hessian(products, kinds, foot), walker.hessian(q)) <= 1e-13


@pytest.mark.parametrize(
    ("leg", "p", "det", "J", "H"),
    [
        ("A", theory.O2_P, theory.O2_DET, theory.O2_J, theory.O2_H),
        ("B", theory.O3_P, theory.O3_DET, theory.O3_J, theory.O3_H),
    ],
)
def test_leg_numbers(leg, p, det, J, H):
    rows, kinds, foot = LEGS[leg]
    walker = walker_leg(rows, kinds, foot)
    products = chapter.chain(rows, kinds, theory.Q)
    assert difference(walker.position(theory.Q), p) <= 1e-14
    assert difference(np.linalg.det(walker.jacobian(theory.Q)), det) <= 1e-14
    assert difference(chapter.jacobian(products, kinds, foot), J) <= 1e-14
    assert difference(chapter.hessian(products, kinds, foot), H) <= 1e-14


def test_inverse_numbers_return_to_the_foot():
    for branches, leg, p in ((theory.O2_BRANCHES, "A", theory.O2_P), (theory.O3_BRANCHES, "B", theory.O3_P)):
        for q in branches:
            assert difference(walker_leg(*LEGS[leg]).position(q), p) <= 1e-14


@pytest.mark.parametrize("pose", theory.O4)
def test_singular_numbers(pose):
    q, p, sv = theory.O4[pose]
    leg = walker_leg(*LEGS["A"])
    assert difference(leg.position(np.array(q)), p) <= 1e-14
    assert difference(np.linalg.svd(leg.jacobian(np.array(q)), compute_uv=False), sv) <= 1e-14


def test_orthogonal_leg_numbers():
    q, p, det = theory.O5_RRP
    leg = walker_leg(*LEGS["RRP"])
    assert difference(leg.position(np.array(q)), p) <= 1e-14
    assert difference(np.linalg.det(leg.jacobian(np.array(q))), det) <= 1e-14
    q, p = theory.O5_RPP
    assert difference(walker_leg(theory.RPP, LEGS["RPP"][1], (0, 0, 0)).position(np.array(q)), p) <= 1e-14


def test_walker_has_no_platform_but_its_own():
    leg = walker_leg(*LEGS["A"])
    robot = Walker(("body",), {}, (leg,))
    assert difference(robot.foot_positions(theory.Q), [theory.O2_P]) <= 1e-14
    assert robot.route("leg") == (0, 1, 2)

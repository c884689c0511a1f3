"""Generated code against the theory's numbers, typed by hand: positions, Jacobians, second derivatives, inverses, resolution."""

from pathlib import Path

import numpy as np
import pytest
import sympy

from oracles import chapter, theory
from oracles.backends import BACKENDS
from oracles.measure import difference

SPECS = Path(__file__).parents[1] / "specs"
LEG_B = """
walkgen = 1
[robot]
name = "leg_b"
gravity = [0.0, 0.0, -9.80665]
[leg_designs.general]
dh = "classic"
foot = { xyz = [0.01, -0.03, 0.05] }
joints = [
  { name = "yaw", type = "revolute", a = 0.08, alpha_deg = 90, d = 0.12 },
  { name = "thigh", type = "revolute", a = 0.35, alpha_deg = 0, d = 0.02 },
  { name = "shank", type = "revolute", a = 0.40, alpha_deg = 0, d = -0.01 },
]
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "general"
platform = "body"
"""
REVOLUTE = ("revolute", "revolute", "revolute")
Q = theory.Q[None]


@pytest.fixture(scope="module")
def leg_a(shipped):
    return shipped("mero_leg")


@pytest.fixture(scope="module")
def leg_b(built):
    return built(LEG_B)


# ---- O1: one pair ------------------------------------------------------------------------------------------------------------


def test_o1_one_pair(built):
    """A_1 of the theory is joint_frames[1] of a leg whose first row it is."""
    text = LEG_B.replace("a = 0.08, alpha_deg = 90, d = 0.12", "a = 0.05, alpha = 0.7, d = 0.12").replace("leg_b", "one_pair")
    text = text.replace("[robot]", 'generate = { functions = ["joint_frames"] }\n[robot]')
    robot = built(text)
    for backend in BACKENDS:
        frames = robot.call(backend, "leg", "joint_frames", [[theory.O1_ROW[0], 0.4, -0.2]])[0]
        assert difference(chapter.one_first(frames[1]), theory.O1_A) <= 1e-15
        assert difference(frames[0], np.eye(4)) == 0
        second = chapter.A(0.4, 0.02, 0.35, 0.0)
        assert difference(chapter.one_first(frames[2]), theory.O1_A @ second) <= 1e-15


@pytest.mark.parametrize("backend", BACKENDS)
def test_frames_are_products_of_the_rows(leg_a, leg_b, backend):
    q = np.random.default_rng(1).uniform(-3, 3, (5, 3))
    for robot, rows in ((leg_a, theory.LEG_A), (leg_b, theory.LEG_B)):
        expected = [chapter.chain(rows, REVOLUTE, row) for row in q]
        frames = robot.call(backend, "leg", "joint_frames", q)
        assert difference([[chapter.one_first(T) for T in row] for row in frames], expected) <= 1e-14


# ---- O2, O3: the yaw-pitch-pitch leg -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
def test_o2_forward(leg_a, backend):
    assert difference(leg_a.call(backend, "leg", "foot_position", Q)[0], theory.O2_P) <= 1e-14
    J = leg_a.call(backend, "leg", "foot_jacobian", Q)[0]
    assert difference(J, theory.O2_J) <= 1e-14
    assert difference(np.linalg.det(J), theory.O2_DET) <= 1e-14
    assert difference(leg_a.call(backend, "leg", "foot_hessian", Q)[0], theory.O2_H) <= 1e-14
    qd, qdd = theory.O2_QD[None], theory.O2_QDD[None]
    assert difference(leg_a.call(backend, "leg", "foot_velocity", Q, qd)[0], theory.O2_V) <= 1e-14
    assert difference(leg_a.call(backend, "leg", "foot_acceleration", Q, qd, qdd)[0], theory.O2_ACC) <= 1e-14


@pytest.mark.parametrize("backend", BACKENDS)
def test_o3_forward(leg_b, backend):
    assert difference(leg_b.call(backend, "leg", "foot_position", Q)[0], theory.O3_P) <= 1e-14
    J = leg_b.call(backend, "leg", "foot_jacobian", Q)[0]
    assert difference(J, theory.O3_J) <= 1e-14
    assert difference(np.linalg.det(J), theory.O3_DET) <= 1e-14
    assert difference(leg_b.call(backend, "leg", "foot_hessian", Q)[0], theory.O3_H) <= 1e-14


@pytest.mark.parametrize("backend", BACKENDS)
def test_second_derivatives_by_the_operators(shipped, leg_b, backend):
    """H_ij = D_min D_max p with Q_theta and Q_s, for revolute and prismatic pairs."""
    kinds = {"ambler_rrp": ("revolute", "revolute", "prismatic"), "ambler_rpp": ("revolute", "prismatic", "prismatic")}
    legs = [(leg_b, theory.LEG_B, REVOLUTE, theory.LEG_B_FOOT)]
    legs += [(shipped(name), rows, kinds[name], (0, 0, 0)) for name, rows in (("ambler_rrp", theory.RRP), ("ambler_rpp", theory.RPP))]
    q = np.random.default_rng(2).uniform(-2, 2, (5, 3))
    for robot, rows, pairs, foot in legs:
        products = [chapter.chain(rows, pairs, row) for row in q]
        assert difference(robot.call(backend, "leg", "foot_jacobian", q), [chapter.jacobian(W, pairs, foot) for W in products]) <= 1e-13
        assert difference(robot.call(backend, "leg", "foot_hessian", q), [chapter.hessian(W, pairs, foot) for W in products]) <= 1e-13


def fig_7():
    """The theory's closed form of the general yaw-pitch-pitch leg B, for sympy to differentiate."""
    q = sympy.symbols("theta1:4", real=True)
    (_, s1, a1, _), (_, s2, a2, _), (_, s3, a3, _) = theory.LEG_B
    x4, y4, z4 = theory.LEG_B_FOOT
    u, v, w, both = a3 + x4, y4, s2 + s3 + z4, q[1] + q[2]
    rho = a1 + a2 * sympy.cos(q[1]) + u * sympy.cos(both) - v * sympy.sin(both)
    h = a2 * sympy.sin(q[1]) + u * sympy.sin(both) + v * sympy.cos(both)
    p = (rho * sympy.cos(q[0]) + w * sympy.sin(q[0]), rho * sympy.sin(q[0]) - w * sympy.cos(q[0]), s1 + h)
    det = -a2 * rho * (u * sympy.sin(q[2]) + v * sympy.cos(q[2]))
    return q, sympy.Matrix(p), det


@pytest.mark.parametrize("backend", BACKENDS)
def test_closed_form_differentiated_by_sympy(leg_b, backend):
    symbols, p, det = fig_7()
    hessian = [[[p[k].diff(a, b) for b in symbols] for a in symbols] for k in range(3)]
    q = np.random.default_rng(4).uniform(-3, 3, (8, 3))
    position, jacobian, second, determinant = (sympy.lambdify(symbols, part) for part in (p, p.jacobian(symbols), hessian, det))
    J = leg_b.call(backend, "leg", "foot_jacobian", q)
    assert difference(leg_b.call(backend, "leg", "foot_position", q), [position(*row).ravel() for row in q]) <= 1e-14
    assert difference(J, [jacobian(*row) for row in q]) <= 1e-14
    assert difference(leg_b.call(backend, "leg", "foot_hessian", q), [second(*row) for row in q]) <= 1e-14
    assert difference(np.linalg.det(J), [determinant(*row) for row in q]) <= 1e-14


@pytest.mark.parametrize("backend", BACKENDS)
def test_derivatives_are_differences(leg_b, backend):
    """Central differences of the generated functions themselves."""
    q, step = np.random.default_rng(5).uniform(-3, 3, (4, 3)), 1e-5
    for lower, upper in (("foot_position", "foot_jacobian"), ("foot_jacobian", "foot_hessian")):
        sides = [[leg_b.call(backend, "leg", lower, q + sign * row) for row in step * np.eye(3)] for sign in (1, -1)]
        slope = np.stack([(one - other) / (2 * step) for one, other in zip(*sides, strict=True)], axis=-1)
        assert difference(leg_b.call(backend, "leg", upper, q), slope) <= 1e-9


def library(robot, backend):
    return (robot.c if backend == "c" else robot.numpy).legs["leg"]


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_position_with_jacobian_in_one_call(leg_b, backend):
    p, J = library(leg_b, backend).foot_position_jacobian(theory.Q)
    assert difference(p, theory.O3_P) <= 1e-14
    assert difference(J, theory.O3_J) <= 1e-14


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_o2_inverse(leg_a, backend):
    leg = library(leg_a, backend)
    q, status = leg.inverse(theory.O2_P)
    assert list(status) == [0, 0, 0, 0]
    assert difference(q, theory.O2_BRANCHES) <= 1e-13
    qd, status = leg.inverse_velocity(theory.Q, theory.O2_V)
    assert status == 0
    assert difference(qd, theory.O2_QD) <= 1e-13
    qdd, status = leg.inverse_acceleration(theory.Q, theory.O2_QD, theory.O2_ACC)
    assert status == 0
    assert difference(qdd, theory.O2_QDD) <= 1e-13


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_o3_inverse(leg_b, backend):
    leg = library(leg_b, backend)
    q, status = leg.inverse(theory.O3_P)
    assert list(status) == [0, 0, 1, 1]
    assert difference(q[:2], theory.O3_BRANCHES) <= 1e-13
    for target, reachable in theory.O3_TARGETS:
        q, status = leg.inverse(target)
        assert [int(code) == 0 for code in status] == list(reachable), target
        for row, code in zip(q, status, strict=True):
            assert code or difference(leg.foot_position(row), target) <= 1e-13


# ---- O4: singular poses --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("pose", theory.O4)
def test_o4_singular_poses(leg_a, backend, pose):
    q, p, singular_values = theory.O4[pose]
    assert difference(leg_a.call(backend, "leg", "foot_position", [q])[0], p) <= 1e-14
    J = leg_a.call(backend, "leg", "foot_jacobian", [q])[0]
    assert difference(np.linalg.svd(J, compute_uv=False), singular_values) <= 1e-14


# ---- O5: the orthogonal legs -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("backend", BACKENDS)
def test_o5_orthogonal_legs(shipped, backend):
    q, p, det = theory.O5_RRP
    rrp = shipped("ambler_rrp")
    assert difference(rrp.call(backend, "leg", "foot_position", [q])[0], p) <= 1e-14
    assert difference(np.linalg.det(rrp.call(backend, "leg", "foot_jacobian", [q])[0]), det) <= 1e-14
    q, p = theory.O5_RPP
    assert difference(shipped("ambler_rpp").call(backend, "leg", "foot_position", [q])[0], p) <= 1e-14


# ---- O8: the modular robot -------------------------------------------------------------------------------------------------------


def modular_q(robot) -> np.ndarray:
    q = np.zeros(24)
    q[robot.c.chains["middle"].slice] = theory.O8_C
    q[robot.c.legs["middle_left"].slice] = theory.O8_Q3
    q[robot.c.legs["middle_right"].slice] = theory.O8_Q4
    return q


@pytest.fixture(scope="module")
def mero(built):
    """The shipped robot, only with the functions that are asked here."""
    text = (SPECS / "mero.toml").read_text(encoding="utf-8")
    return built(text + '[generate]\nfunctions = ["foot_position", "foot_positions", "foot_jacobians"]\n')


@pytest.mark.parametrize("backend", BACKENDS)
def test_o8_feet(mero, backend):
    q = modular_q(mero)
    feet = mero.call(backend, "", "foot_positions", q[None])[0]
    assert difference(feet[2], theory.O8_FOOT3) <= 1e-14
    assert difference(feet[3], theory.O8_FOOT4) <= 1e-14
    for leg, foot, own in (("middle_left", theory.O8_FOOT3, theory.O8_Q3), ("middle_right", theory.O8_FOOT4, theory.O8_Q4)):
        route = mero.call(backend, f"root_to_{leg}", "foot_position", [[*theory.O8_C, *own]])[0]
        assert difference(route, foot) <= 1e-14


@pytest.mark.parametrize("backend", BACKENDS)
def test_o8_weighted_resolution(mero, backend):
    """Weighted pseudo-inverse: qd = J+ xd + (1 - J+ J) qd0, J from generated code."""
    columns = [limb.slice for limb in (mero.c.chains["middle"], mero.c.legs["middle_left"], mero.c.legs["middle_right"])]
    J_all = mero.call(backend, "", "foot_jacobians", modular_q(mero)[None])[0]
    J = np.hstack([np.vstack([J_all[2], J_all[3]])[:, part] for part in columns])
    W_inverse = np.linalg.inv(theory.O8_W)
    J_plus = W_inverse @ J.T @ np.linalg.inv(J @ W_inverse @ J.T)
    qd = J_plus @ theory.O8_XD + (np.eye(9) - J_plus @ J) @ theory.O8_QD0
    assert difference(qd, theory.O8_QD) <= 1e-12
    outside = np.delete(np.arange(24), np.r_[tuple(columns)])
    assert not np.any(J_all[2:4][:, :, outside])

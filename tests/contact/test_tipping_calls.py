"""Tipping as users call it: the published example, lines of any slope, the robot's own inertia, how it goes with margins."""

import numpy as np
import pytest
from heavy import HEAVY

from oracles.stability import random_stand
from oracles.stances import random_rotation, unit
from walkgen.errors import UnsupportedMechanism

OK, BAD_INPUT, INFEASIBLE = 0, 2, 5
# O16: seen from the first to the second foot the other feet are on the left
AXIS = np.array([[-0.3, -0.25, 0.0], [0.3, 0.25, 0.0]])
COM, INERTIA = np.array([0.05, -0.1, 0.35]), np.diag([1.2, 2.5, 3.0])


@pytest.fixture(params=["c", "numpy", "casadi"])
def acceleration(request, built):
    """Of one line, positional, everything given."""
    if request.param == "casadi":
        function = built(HEAVY).c.casadi("tipping_acceleration")
        return lambda *given: [float(item) for item in function(*given, [0.0, -9.81])]
    return getattr(built(HEAVY), request.param).tipping_acceleration


@pytest.fixture(params=["c", "numpy"])
def robot(request, built):
    return getattr(built(HEAVY), request.param)


def test_the_example(acceleration):
    found, tilt, kappa = acceleration(AXIS, COM, INERTIA, np.array([0.0, 0.0, -9.81]), 60.0)
    assert found == pytest.approx(6.540920681876227, abs=1e-12)
    assert tilt + np.pi / 2 == pytest.approx(1.8722654716670732, abs=1e-12)
    far = 0.366530029185989
    assert kappa == pytest.approx(60 * 9.81 * far / (1.7327868852459019 + 60 * far**2), rel=1e-13)


def test_any_line_any_gravity(acceleration):
    """Torque about the line over the inertia about it; the same seen from another frame; kappa sin(tilt)."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        axis, com, mass = rng.normal(size=(2, 3)), rng.normal(size=3), rng.uniform(1, 50)
        root, gravity = rng.normal(size=(3, 3)), rng.normal(size=3) * 9.0
        inertia = root @ root.T
        e = unit(axis[1] - axis[0])
        arm = com - axis[0]
        about = e @ inertia @ e + mass * (arm @ arm - (arm @ e) ** 2)
        expected = -e @ np.cross(arm, mass * gravity) / about
        found, tilt, kappa = acceleration(axis, com, inertia, gravity, mass)
        side = np.sign(expected) if abs(np.sin(tilt)) > 1e-9 else 0.0
        assert abs(found) == pytest.approx(abs(expected), rel=1e-11)
        assert found == pytest.approx(kappa * np.sin(tilt), rel=1e-11)
        assert side == -np.sign(found)  # about e backwards: to the right of the line is falling
        R, shift = random_rotation(rng), rng.normal(size=3)
        again = acceleration(axis @ R.T + shift, R @ com + shift, R @ inertia @ R.T, R @ gravity, mass)
        np.testing.assert_allclose(again, [found, tilt, kappa], rtol=1e-10, atol=1e-12)


def test_an_inclined_line_has_less_gravity(acceleration):
    """Only the part of gravity across the line counts: g cos(psi)."""
    psi, r = 0.4, 0.5
    axis = np.array([[0.0, 0.0, 0.0], [np.cos(psi), 0.0, np.sin(psi)]])
    up = np.array([-np.sin(psi), 0.0, np.cos(psi)])
    right = np.array([0.0, -1.0, 0.0])
    com = r * (np.cos(0.3) * up + np.sin(0.3) * right)
    found, tilt, kappa = acceleration(axis, com, np.zeros((3, 3)), np.array([0.0, 0.0, -9.81]), 1.0)
    assert tilt == pytest.approx(0.3, abs=1e-14)
    assert kappa == pytest.approx(9.81 * np.cos(psi) / r, rel=1e-13)
    assert found == pytest.approx(kappa * np.sin(0.3), rel=1e-13)


def test_the_robots_own_mass_gravity_and_inertia(robot):
    rng = np.random.default_rng(2)
    pose, q = np.eye(4), rng.uniform(-0.1, 0.1, 4)
    pose[:3, :3], pose[:3, 3] = random_rotation(rng), rng.normal(size=3)
    inertia, com = robot.centroidal_inertia(pose, q), robot.com(pose, q)
    A = robot.centroidal_momentum_matrix(pose, q)
    np.testing.assert_allclose(inertia @ pose[:3, :3], A[3:, 3:6], rtol=0, atol=1e-12)
    axis = rng.normal(size=(2, 3))
    given = robot.tipping_acceleration(axis, com, inertia, [0.0, 0.0, -9.81], 60.0)
    np.testing.assert_allclose(robot.tipping_acceleration(axis, com, inertia), given, rtol=1e-13)
    moon = robot.tipping_acceleration(axis, com, inertia, param=[0.0, -1.62])
    assert moon[2] == pytest.approx(given[2] * 1.62 / 9.81, rel=1e-13)


def test_margins_and_tipping_agree(robot):
    """Over its feet the tilt about the edge that tips is negative, and its height r cos(psi) (1 - cos(tilt))."""
    rng = np.random.default_rng(3)
    for _ in range(10):
        points, com = random_stand(rng, 5)
        margins = robot.stability_margins(points, com, [1.0, 0.0, 0.0])
        axis = points[margins[8]]
        acceleration, tilt, kappa = robot.tipping_acceleration(axis, com, np.zeros((3, 3)))
        assert (tilt < 0) == (margins[4] > 0)
        assert (acceleration < 0) == (tilt < 0)
        height = 9.81 * np.cos(slope(axis)) ** 2 / kappa * (1.0 - np.cos(tilt))
        assert abs(margins[4]) == pytest.approx(height, rel=1e-9)


def slope(axis):
    way = unit(axis[1] - axis[0])
    return float(np.arcsin(way[2]))


def test_time_tilt_and_speed(robot):
    kappa, tilt = 9.81 / 0.5, np.radians(30)
    turn, status, rate = robot.tipping_tilt(kappa, tilt, 0.2)
    assert (turn, status) == (pytest.approx(0.20727999539969844, abs=1e-12), OK)
    assert rate == pytest.approx(np.sqrt(2 * kappa * (np.cos(tilt) - np.cos(tilt + turn))), rel=1e-12)
    time, status = robot.tipping_time(kappa, tilt, turn)
    assert (time, status) == (pytest.approx(0.2, abs=1e-13), OK)
    speed, status = robot.tipping_speed_limit(0.2, kappa, tilt, turn)
    assert (speed, status) == (pytest.approx(1.0, abs=1e-12), OK)
    assert robot.tipping_time(kappa, tilt, turn, rate=-10.0)[1] == INFEASIBLE
    assert robot.tipping_speed_limit(0.2, kappa, tilt, turn, rate=-10.0) == (0.0, OK)
    assert robot.tipping_time([-kappa, kappa], tilt, turn).status.tolist() == [BAD_INPUT, OK]
    with pytest.raises(ValueError, match=r"kappa is .*; tipping_acceleration gives it"):
        robot.tipping_time(-kappa, tilt, turn)


def test_both_backends_agree_on_every_kind_of_motion(built):
    rng = np.random.default_rng(4)
    kappa, tilt, time = 10.0 ** rng.uniform(-1, 2, 400), rng.uniform(-2.0, 2.5, 400), rng.uniform(0.0, 1.0, 400)
    rate = rng.normal(size=400) * np.sqrt(kappa) * rng.choice([0.0, 0.5, 2.0], 400)
    turn = rng.uniform(0.0, 1.5, 400)
    one, other = built(HEAVY).c, built(HEAVY).numpy
    for mine, theirs in (
        (one.tipping_time(kappa, tilt, turn, rate), other.tipping_time(kappa, tilt, turn, rate)),
        (one.tipping_speed_limit(0.3, kappa, tilt, turn, rate), other.tipping_speed_limit(0.3, kappa, tilt, turn, rate)),
        (one.tipping_tilt(kappa, tilt, time, rate), other.tipping_tilt(kappa, tilt, time, rate)),
    ):
        np.testing.assert_array_equal(mine[1], theirs[1])
        for left, right in zip(mine, theirs, strict=True):
            np.testing.assert_allclose(left, right, rtol=1e-9, atol=1e-11)
    assert {OK, BAD_INPUT, INFEASIBLE} == set(one.tipping_time(kappa, tilt, turn, rate)[1])


def test_what_has_no_casadi_form_says_so(built):
    with pytest.raises(UnsupportedMechanism, match="no CasADi form"):
        built(HEAVY).c.casadi("tipping_time")

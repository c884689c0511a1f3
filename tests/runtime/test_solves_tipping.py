"""Tipping about a line beside quadrature, integration in time and the note's numbers; what the chapter's equations (10) to (13) say."""

import mpmath
import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp
from scipy.special import ellipj, ellipk

from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, OK
from walkgen.runtime.solves.tipping import tipping_speed_limit, tipping_tilt, tipping_time

G = 9.81
CHAPTER_STEP, CHAPTER_SPEED, CHAPTER_TILT = 0.2, 3.63, 0.174533
"""Step length (m), speed (m/s) and tilt (rad) of the chapter's section 5; their ratio is the time of a step."""


def falling(kappa, tilt, rate, time):
    """Tilt and rate at times, by a Runge-Kutta method of order 8."""
    times, step = np.linspace(0.0, time, 40), 0.05 / np.sqrt(kappa)  # short, as it interpolates
    found = solve_ivp(
        lambda _, y: [y[1], kappa * np.sin(y[0])], [0.0, time], [tilt, rate], "DOP853", times, rtol=1e-12, atol=1e-13, max_step=step
    )
    return times, found.y[0] - tilt, found.y[1]


@pytest.mark.parametrize(("seed", "count"), [(1, 60), pytest.param(2, 1000, marks=pytest.mark.nightly)])
def test_motions_of_every_kind(seed, count):
    """From rest and not, over its feet and past them, back and over; while it is less than a whole turn from upright."""
    rng = np.random.default_rng(seed)
    kinds = set()
    for _ in range(count):
        kappa, tilt = 10.0 ** rng.uniform(-1.0, 2.5), rng.uniform(-1.4, 2.0)
        rate = rng.choice([0.0, 0.4, 1.0, 2.0]) * rng.normal() * np.sqrt(kappa)
        times, turns, rates = falling(kappa, tilt, rate, rng.uniform(0.1, 2.5) / np.sqrt(kappa))
        near = np.abs(turns + tilt) < 6.0
        found, found_rates, status = tipping_tilt(kappa, tilt, rate, times[near])
        assert np.all(status == OK)
        np.testing.assert_allclose(found, turns[near], rtol=0, atol=1e-11)
        np.testing.assert_allclose(found_rates / np.sqrt(kappa), rates[near] / np.sqrt(kappa), rtol=0, atol=1e-11)
        ahead = (turns > 1e-3) & (turns < np.pi - tilt - 1e-3) & (rates > 0.0) & (turns == np.maximum.accumulate(turns))
        first = int(np.argmax(ahead))
        time, status = tipping_time(kappa, tilt, rate, turns[first] if first else 0.1)
        if first:
            assert status == OK
            pace = max(rates[first] / np.sqrt(kappa), 1e-2)
            assert time * np.sqrt(kappa) == pytest.approx(times[first] * np.sqrt(kappa), abs=1e-9 / pace)
            kinds.add((bool(tilt < 0), int(np.sign(rate))))
    assert kinds >= {(False, 0), (False, 1), (False, -1), (True, 1)}


@pytest.mark.parametrize("tilt", [1e-6, 1e-3, 0.1, np.pi / 6, 1.2])
@pytest.mark.parametrize("turn", [1e-4, 0.05, 1.0])
def test_falls_from_rest_beside_the_energy_integral(tilt, turn):
    """The note's: t = kappa^-1/2 int_0^1 2 d s / sqrt(4 sin(phi0 + d s^2 / 2) sin(d s^2 / 2)) ds; 40 digits."""
    with mpmath.workdps(40):
        a, d = mpmath.mpf(tilt), mpmath.mpf(turn)
        whole = mpmath.quad(
            lambda s: 2 * d * s / mpmath.sqrt(4 * mpmath.sin(a + d * s * s / 2) * mpmath.sin(d * s * s / 2)), [0, 0.001, 0.1, 1]
        )
    time, status = tipping_time(1.0, tilt, 0.0, turn)
    assert status == OK
    assert time == pytest.approx(float(whole), rel=1e-13)
    back, _, _ = tipping_tilt(1.0, tilt, 0.0, time)
    assert back == pytest.approx(turn, rel=1e-9)


def test_falls_from_rest_beside_elliptic_functions():
    """From rest cos(phi / 2) = cos(phi0 / 2) cd(sqrt(kappa) t)."""
    tilt, kappa = 0.4, 17.0
    times = np.linspace(0.0, 0.8, 9)
    _, cn, dn, _ = ellipj(np.sqrt(kappa) * times, np.cos(0.2) ** 2)
    found, _, _ = tipping_tilt(kappa, tilt, 0.0, times)
    np.testing.assert_allclose(np.cos((found + tilt) / 2), np.cos(0.2) * cn / dn, rtol=0, atol=1e-13)
    quarter = ellipk(np.cos(0.2) ** 2) / np.sqrt(kappa)
    np.testing.assert_allclose(tipping_tilt(kappa, tilt, 0.0, quarter)[0], np.pi - tilt, rtol=0, atol=1e-12)


def test_the_notes_tilt():
    """O16: L = 0.5 m, from 30 degrees at rest, after 0.2 s."""
    found, _, status = tipping_tilt(G / 0.5, np.radians(30), 0.0, 0.2)
    assert status == OK
    assert found == pytest.approx(0.20727999539969844, abs=1e-12)


@pytest.mark.parametrize(
    ("degrees", "kappa", "length"), [(10, 575.4, 0.0170), (30, 219.5, 0.0447), (45, 158.3, 0.0620), (60, 130.7, 0.0750)]
)
def test_what_the_chapters_speed_would_take(degrees, kappa, length):
    """Erratum 26: 3.63 m/s for 0.174533 rad in a step of 0.2 m asks for kappa, and L = g / kappa, of no robot of usual size."""
    assert tipping_speed_limit(CHAPTER_STEP, kappa, np.radians(degrees), 0.0, CHAPTER_TILT)[0] == pytest.approx(CHAPTER_SPEED, rel=3e-4)
    assert G / kappa == pytest.approx(length, abs=6e-5)
    for usual in (0.2, 0.5, 0.8):
        speed, status = tipping_speed_limit(CHAPTER_STEP, G / usual, np.radians(degrees), 0.0, CHAPTER_TILT)
        assert status == OK
        assert speed < 0.65 * CHAPTER_SPEED


def test_no_robot_of_usual_size_reaches_the_chapters_tilt():
    """Erratum 26: sin <= 1, so kappa >= 2 tilt / t^2; with L = 0.5 m and 30 degrees the speed is 1.085 m/s, with factor 2 1.535."""
    time = CHAPTER_STEP / CHAPTER_SPEED
    assert 2 * CHAPTER_TILT / time**2 == pytest.approx(115, abs=0.05)
    assert pytest.approx(np.pi / 18, abs=1e-6) == CHAPTER_TILT
    for factor, least, most, steepest in ((1, 0.0032, 0.053, 0.0649), (2, 0.0065, 0.107, 0.1305)):
        tilts = [[tipping_tilt(factor * G / L, np.radians(phi), 0.0, time)[0] for L in (0.8, 0.2)] for phi in (10, 30, 45, 60)]
        assert np.min(tilts) == pytest.approx(least, abs=6e-5)
        assert np.max(tilts[:3]) == pytest.approx(most, abs=6e-4)  # the note's range ends at 45 degrees; from 60 it is more
        assert tilts[3][1] == pytest.approx(steepest, abs=1e-4)
        assert tilts[3][1] < CHAPTER_TILT
    for factor, speed in ((1, 1.085), (2, 1.535)):
        assert tipping_speed_limit(0.2, factor * G / 0.5, np.radians(30), 0.0, CHAPTER_TILT)[0] == pytest.approx(speed, abs=6e-4)


def test_lagranges_equation_of_the_fall():
    """Errata 23 to 25: the potential's sign, gravity counted once, factor 1; as printed nothing accelerates, or twice as much."""
    m, g, AG, inertia = sympy.symbols("m g AG I", positive=True)
    time = sympy.Symbol("t")
    alpha = sympy.Function("alpha")(time)
    T = (inertia + m * AG**2) * alpha.diff(time) ** 2 / 2

    def acceleration(P, Q):
        equation = (T - P).diff(alpha.diff(time)).diff(time) - (T - P).diff(alpha) - Q
        return sympy.simplify(sympy.solve(equation, alpha.diff(time, 2))[0])

    true = -m * g * AG * sympy.cos(alpha) / (inertia + m * AG**2)
    weight = -m * g * AG * sympy.cos(alpha)
    assert sympy.simplify(acceleration(m * g * AG * sympy.sin(alpha), 0) - true) == 0
    assert acceleration(m * g * AG * (1 - sympy.sin(alpha)), weight) == 0  # (11) and (12) as printed
    assert sympy.simplify(acceleration(m * g * AG * sympy.sin(alpha), weight) - 2 * true) == 0  # (13) as printed


@pytest.mark.parametrize(
    ("tilt", "rate", "turn"),
    [
        (0.0, 0.0, 0.1),  # stands upright for ever
        (-0.2, 0.0, 0.1),  # falls on its feet
        (-0.2, -1.0, 0.1),
        (0.2, -3.0, 0.1),  # pushed back over its feet
        (-0.5, 1.0, 1.0),  # does not get over
        (0.0, -0.1, 0.1),
    ],
)
def test_what_never_tips(tilt, rate, turn):
    time, status = tipping_time(9.81, tilt, rate, turn)
    assert (status, time) == (INFEASIBLE, np.inf)
    assert tipping_speed_limit(0.2, 9.81, tilt, rate, turn) == (0.0, OK)


def test_bad_input_and_broadcasting():
    for bad in (
        (0.0, 0.1, 0.0, 0.1),
        (-1.0, 0.1, 0.0, 0.1),
        (9.0, np.nan, 0.0, 0.1),
        (9.0, 0.1, np.inf, 0.1),
        (9.0, 0.1, 0.0, -0.1),
        (9.0, 3.0, 0.0, 1.0),
    ):
        assert tipping_time(*bad)[1] == BAD_INPUT
        assert np.isnan(tipping_time(*bad)[0])
    assert tipping_tilt(9.0, 0.1, 0.0, -1.0)[2] == BAD_INPUT
    assert tipping_speed_limit(0.2, 9.0, 0.1, 0.0, 0.0)[1] == BAD_INPUT
    turn, rate, status = tipping_tilt(np.full((3, 1), 9.0), 0.1, 0.0, np.zeros(2))
    assert (turn.shape, rate.shape, status.shape) == ((3, 2), (3, 2), (3, 2))
    assert np.all(turn == 0.0)


def test_near_the_border_between_over_and_back():
    """At rest in the end upright, to rounding: no time is wrong, it is only long."""
    for energy in (1e-14, -1e-14, 1e-8, -1e-8, 0.0):
        rate = 2.0 * np.sin(0.2) * np.sqrt(9.0) * (1.0 + energy)
        times, turns, _ = falling(9.0, -0.4, rate, 1.5)
        found, _, _ = tipping_tilt(9.0, -0.4, rate, times)
        np.testing.assert_allclose(found, turns, rtol=0, atol=1e-9)
    assert quad(lambda x: 1.0 / np.sqrt(1e-6 + np.sin(x) ** 2), -0.2, 0.2, limit=200)[0] / 3.0 == pytest.approx(
        float(tipping_time(9.0, -0.4, 2.0 * 3.0 * np.sqrt(1e-6 + np.sin(0.2) ** 2), 0.8)[0]), rel=1e-8
    )

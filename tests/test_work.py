"""Work over a cycle beside closed forms."""

import numpy as np
import pytest

from walkgen.runtime import cycle_work, load

SLIDE = """
walkgen = 1
robot = { name = "slide", gravity = [0, 0, -9.81] }
generate = { functions = ["inverse_dynamics"], targets = ["numpy"] }
platforms = [{ name = "body" }]
legs = [{ name = "one", design = "leg", platform = "body" }]
[parameters]
rub = { value = 0.0, runtime = true }
[leg_designs.leg]
foot = { xyz = [0, 0, 0] }
[[leg_designs.leg.joints]]
name = "slide"
type = "prismatic"
xyz = [0, 0, 0]
axis = [1, 0, 0]
link = { mass = 2.0, com = [0, 0, 0], inertia = [0.1, 0.1, 0.1, 0, 0, 0] }
friction = { coulomb = "rub" }
"""
MASS, WAY, PERIOD = 2.0, 0.3, 1.7
TURN = 2 * np.pi / PERIOD


@pytest.fixture(scope="module")
def leg(built):
    return load(built(SLIDE).folder).legs["one"]


def swing(count):
    """A mass that swings as a sine: q, qd, qdd [samples, 1]."""
    angle = 2 * np.pi * np.arange(count)[:, None] / count
    return WAY * np.sin(angle), WAY * TURN * np.cos(angle), -WAY * TURN**2 * np.sin(angle)


def test_a_mass_is_brought_to_speed_twice_a_cycle(leg):
    """Its kinetic energy is put in twice; taken back, nothing is left."""
    wanted = MASS * (WAY * TURN) ** 2
    errors = []
    for count in (100, 200, 400):
        found = leg.work(*swing(count), period=PERIOD)
        assert found.total == pytest.approx(0, abs=1e-14)
        assert found.positive == found.joints_positive[0]
        errors.append(abs(found.positive - wanted) / wanted)
    assert errors[-1] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.05)


def test_coulomb_friction_and_a_force_on_the_foot(leg):
    """Friction takes 4 A c a cycle; while it slows the mass down it is pushed only until sin = c / (m A w^2)."""
    rub, thrust = 3.0, MASS * WAY * TURN**2
    found = leg.work(*swing(4001), period=PERIOD, param=[rub])
    assert found.total == pytest.approx(4 * WAY * rub, rel=1e-6)
    assert found.positive == pytest.approx(2 * WAY * (rub * (rub / thrust) / 2 + thrust / 2 + rub), rel=1e-5)
    assert leg.work(*swing(50), [5.0, 0, 0], period=PERIOD).total == pytest.approx(0, abs=1e-13)


def test_many_motions_at_once(leg):
    q, qd, qdd = swing(60)
    size = np.array([1.0, 2.0])[:, None, None]
    found = leg.work(size * q, size * qd, size * qdd, period=PERIOD)
    assert found.joints.shape == (2, 1)
    assert found.positive[1] == pytest.approx(4 * found.positive[0])


def test_power_that_runs_straight_and_jumps_is_met_exactly():
    times = [0.0, 1.0, 1.0, 3.0, 3.5]
    power = np.array([[-1.0, 2.0], [3.0, 2.0], [-4.0, -2.0], [4.0, -2.0], [0.0, -2.0]])
    found = cycle_work(power, 4.0, times)
    assert found.joints == pytest.approx([1.0 + 0.0 + 1.0 - 0.25, 2.0 - 4.0 - 1.0])
    assert found.joints_positive == pytest.approx([9 / 8 + 2.0 + 1.0, 2.0 + 0.25])
    assert found.total == pytest.approx(found.joints.sum())
    assert found.positive == pytest.approx(found.joints_positive.sum())


@pytest.mark.parametrize(
    ("count", "period", "times", "said"),
    [
        (2, 1.0, None, "3 samples or more"),
        (4, 0.0, None, "period above 0"),
        (4, 1.0, [0, 0.5, 0.2, 0.8], "do not fall"),
        (4, 1.0, [0, 0.5, 0.8, 1.2], "no more than the period"),
        (4, 1.0, [0, 0.5, 0.8], "those of the 4 samples"),
        (4, float("nan"), None, "period above 0"),
        (4, 1.0, [0, 0.5, float("nan"), 0.8], "do not fall"),
    ],
)
def test_samples_that_are_no_cycle(count, period, times, said):
    with pytest.raises(ValueError, match=said):
        cycle_work(np.ones((count, 1)), period, times)


def test_a_leg_without_efforts_says_why(built):
    other = load(built(SLIDE.replace("inverse_dynamics", "foot_position")).folder).legs["one"]
    with pytest.raises(AttributeError, match="inverse_dynamics"):
        other.work(*swing(10), period=1.0)

"""Friction in the pins of a short form: in every target, of the leg and of the whole robot, with parameters of a run."""

import numpy as np
import pytest

from walkgen.spec.read import read

SPEC = """
walkgen = 1
robot = { name = "bars", gravity = [0, 0, -9.81] }
generate = { functions = ["inverse_dynamics", "floating_inverse_dynamics"] }
platforms = [{ name = "body", mass = 5, inertia = [0.1, 0.1, 0.1, 0, 0, 0] }]
legs = [
    { name = "one", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0], rpy_deg = [0, 0, 0] } },
    { name = "two", mirror_of = "one" },
]
[parameters]
rub = { value = 0.3, runtime = true, bounds = [0, 1] }
[leg_designs.leg]
plane = { rpy_deg = [90, 0, 0] }
joints = [{ name = "yaw", type = "revolute", xyz = [0, 0, 0], axis = [0, 0, 1], friction = { coulomb = 0.2 } }]
[leg_designs.leg.four_bar]
ground = 0.2
crank = 0.05
coupler = 0.25
rocker = 0.22
foot = [0.125, -0.1]
friction = { coulomb = 0.02, mu = "rub", radius = 0.01 }
drive = { friction = { viscous = 0.1, mu = 0.2, radius = 0.02 } }
[leg_designs.leg.links]
coupler = { mass = 0.4, com = [0.12, 0.0], inertia = 0.003 }
rocker = { mass = 0.3, com = [0.1, 0.0], inertia = 0.002 }
"""


@pytest.fixture(scope="module")
def robot(built):
    return built(SPEC)


def states(count=5):
    random = np.random.default_rng(4)
    return (
        random.normal(size=(count, 2)),
        random.normal(size=(count, 2)),
        random.normal(size=(count, 2)),
        random.normal(size=(count, 3)) * 50,
    )


def test_every_target(robot):
    q, qd, qdd, f = states()
    rub = np.array([[0.7]] * len(q))
    wanted = robot.numpy.legs["one"].inverse_dynamics(q, qd, qdd, f, param=rub)
    assert robot.c.legs["one"].inverse_dynamics(q, qd, qdd, f, param=rub) == pytest.approx(wanted, rel=1e-12)
    for backend in ("casadi", "interpreter"):
        assert robot.call(backend, "one", "inverse_dynamics", q, qd, qdd, f, rub) == pytest.approx(wanted, rel=1e-12)
    assert np.abs(wanted - robot.numpy.legs["one"].inverse_dynamics(q, qd, qdd, f)).max() > 1e-3


def test_the_whole_robot_is_rubbed_as_its_legs(robot):
    """On a base that stands still every leg's efforts are those on a held platform, mirrored or not."""
    q, qd, qdd, f = states()
    both, count = robot.c.legs.values(), len(q)
    still, base = np.zeros((count, 6)), np.eye(4)
    v, a = np.c_[still, qd, qd], np.c_[still, qdd, qdd]
    found = robot.c.floating_inverse_dynamics(base, np.c_[q, q], v, a, np.stack([f, 2 * f], 1))
    for leg, place, force in zip(both, (6, 8), (f, 2 * f), strict=True):
        assert found[:, place : place + 2] == pytest.approx(leg.inverse_dynamics(q, qd, qdd, force), rel=1e-11, abs=1e-11)


def test_a_moving_base_rubs_with_what_its_pins_carry(robot):
    """The base's own wrench knows no friction; that of the joints takes power, the more the harder the ground pushes."""
    q, qd, qdd, f = states()
    random = np.random.default_rng(5)
    v, a = np.c_[random.normal(size=(5, 6)), qd, qd], np.c_[random.normal(size=(5, 6)), qdd, qdd]
    forces = np.stack([f, f], 1)
    slow, more, none = (robot.c.floating_inverse_dynamics(np.eye(4), np.c_[q, q], v, a, forces, param=[rub]) for rub in (0.3, 0.6, 0.0))
    assert np.array_equal(slow[:, :6], none[:, :6])
    heat = np.einsum("ni,ni->n", (slow - none)[:, 6:], v[:, 6:])
    assert heat.min() > 0
    assert np.einsum("ni,ni->n", (more - none)[:, 6:], v[:, 6:]) == pytest.approx(2 * heat, rel=1e-9)


def test_all_pins_of_a_short_form_have_its_friction(robot):
    pins = read(robot.spec).leg_designs["leg"].pins
    assert [pin.friction is not None and pin.friction.coulomb is not None for pin in pins] == [False, True, True, True]

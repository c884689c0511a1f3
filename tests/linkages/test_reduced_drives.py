"""Rates and accelerations of drives that move the foot little: damping begins where that is little for them, whatever the leg's size."""

from decimal import Decimal

import numpy as np
import pytest

from walkgen.pipeline import mechanism_of
from walkgen.symbolic.rate_damping import rate_damping

FUNCTIONS = ("foot_position", "foot_jacobian", "inverse_velocity", "inverse_acceleration")
CRANK = 0.002
SPEC = """
walkgen = 1
robot = {{ name = "bot", gravity = [0, 0, -9.81] }}
platforms = [{{ name = "body" }}]
legs = [{{ name = "leg", design = "leg", platform = "body", mount = {{ xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] }} }}]
generate = {{ functions = {functions}, targets = ["c", "numpy"] }}
[leg_designs.leg]
plane = {{ rpy_deg = [90, 0, 0] }}
five_bar = {{ ground = 0.3, cranks = [{crank}, {crank}], couplers = [0.25, 0.25] }}
dh = "classic"
joints = [{{ name = "yaw", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 0 }}]
{own}"""
OK, SINGULAR = 0, 3


def spec(own=""):
    return SPEC.format(functions=list(FUNCTIONS), crank=CRANK, own=own)


@pytest.fixture(scope="module")
def legs(built):
    robot = built(spec())
    return robot.c.legs["leg"], robot.numpy.legs["leg"]


def moved(leg, q, qd, qdd, time):
    return leg.foot_position(q + time * qd + time**2 / 2 * qdd)


def test_the_foot_moves_as_wanted(legs):
    random = np.random.default_rng(4)
    q = random.uniform(-3, 3, (300, 3))
    for leg in legs:
        qd, status = leg.inverse_velocity(q, v := random.normal(size=(300, 3)) * CRANK)
        assert np.mean(status == OK) > 0.9
        assert set(status) <= {OK, SINGULAR}
        qdd, told = leg.inverse_acceleration(q, qd, a := random.normal(size=(300, 3)) * CRANK)
        assert np.array_equal(told, status)
        calm, step = (status == OK) & (np.abs(qd).max(-1) < 10) & (np.abs(qdd).max(-1) < 100), 1e-4
        assert calm.mean() > 0.6
        back, here, on = (moved(leg, q[calm], qd[calm], qdd[calm], time) for time in (-step, 0, step))
        assert (on - back) / (2 * step) == pytest.approx(v[calm], abs=1e-7)
        assert (on - 2 * here + back) / step**2 == pytest.approx(a[calm], abs=1e-6)


def test_damped_close_to_a_dead_pose(legs, built):
    """Cranks that push the same way: rates keep their bound."""
    (epsilon, largest) = rate_damping(mechanism_of(built(spec()).spec), mechanism_of(built(spec()).spec).legs[0])
    assert 0.004 * CRANK < epsilon == largest < 0.02 * CRANK
    q = np.random.default_rng(5).uniform(-np.pi, np.pi, (3000, 3))
    least = np.linalg.svd(legs[0].foot_jacobian(q), compute_uv=False)[:, -1]
    qd, status = legs[0].inverse_velocity(q, [CRANK, 0, 0])
    assert np.array_equal(status == SINGULAR, least < float(epsilon))
    assert 3 < (status == SINGULAR).sum() < 300
    damped = status == SINGULAR
    bound = CRANK / (2 * float(epsilon) * np.sqrt(1 - (least[damped] / float(epsilon)) ** 2))
    assert np.all(np.linalg.norm(qd[damped], axis=-1) <= bound * (1 + 1e-9))


def test_the_specs_own_damping(tmp_path):
    path = tmp_path / "bot.toml"
    path.write_text(spec("damping = { epsilon = 0.25, lambda_max = 0.5 }"), encoding="utf-8")
    mechanism = mechanism_of(path)
    assert rate_damping(mechanism, mechanism.legs[0]) == (Decimal("0.25"), Decimal("0.5"))

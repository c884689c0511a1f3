"""From the foot back to the drives of legs whose linkage holds a triad: every place that the foot has been is found again."""

import numpy as np
import pytest

STEPHENSON = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } }]
[generate]
functions = ["foot_position", "assembly_status", "inverse", "inverse_branch", "inverse_near", "inverse_distance"]
targets = ["c", "numpy"]
[leg_designs.leg]
dh = "classic"
joints = [{ name = "yaw", type = "revolute", a = 0.0, d = 0.0, alpha_deg = 0 }]
plane = { xyz = [0.02, 0.01, 0.0], rpy_deg = [90, 0, 0] }
start = { drives_deg = [10] }
[leg_designs.leg.stephenson]
inversion = "II"
ground = 0.3
crank = 0.06
coupler = 0.25
rocker = 0.22
on_crank = [0.02, 0.04]
on_coupler = [0.05, 0.08]
second_coupler = 0.2
second_rocker = 0.22
foot = [0.35, -0.1]
"""
OK, UNREACHABLE = 0, 1


def angle(turn):
    return np.angle(np.exp(1j * turn))


@pytest.fixture(scope="module")
def stephenson(built):
    return built(STEPHENSON)


@pytest.mark.parametrize(("backend", "count"), [("c", 100), ("numpy", 2)])
def test_one_drive(stephenson, backend, count):
    leg = getattr(stephenson, backend).legs["leg"]
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (count, 2))
    assert (leg.assembly_status(q) == OK).mean() > 0.3
    q = q[leg.assembly_status(q) == OK]
    target = leg.foot_position(q)
    rows, status = leg.inverse(target)
    good = status == OK
    assert good[:, 0].all()
    assert (leg.assembly_status(rows)[good] == OK).all()
    assert np.abs(leg.foot_position(rows) - target[:, None])[good].max() < 1e-11
    away = np.where(good, np.abs(angle(rows - q[:, None])).max(-1), np.inf).min(-1)
    assert away.max() < 1e-8
    near, one = leg.inverse_near(target, q + 0.01)
    assert (one == OK).all()
    assert np.abs(angle(near - q)).max() < 1e-8
    assert leg.inverse_distance(target)[good].max() < 1e-11

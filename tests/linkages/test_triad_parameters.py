"""What identification needs of legs with triads: the fewest parameters, and slopes by the runtime parameters."""

import numpy as np
import pytest

from linkages.placed import code_of
from linkages.starts import Drawn
from linkages.topologies import spec

TEXT = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "leg", platform = "body" }]
[generate]
functions = ["foot_position", "foot_jacobian", "transmission_angles", "mass_matrix"]
targets = ["c", "numpy", "casadi"]
derivatives = true
[parameters]
rod = { value = 0.25, unit = "m", runtime = true }
weight = { value = 2.0, unit = "kg", runtime = true }
arm = { value = 0.2, unit = "m", runtime = true }
[leg_designs.leg]
dh = "classic"
joints = [{ name = "yaw", type = "revolute", a = 0.1, d = 0.0, alpha_deg = 0 }]
plane = { rpy_deg = [90, 0, 0] }
start = { drives_deg = [10] }
[leg_designs.leg.stephenson]
inversion = "II"
ground = 0.3
crank = 0.06
coupler = "rod"
rocker = 0.22
on_crank = [0.02, 0.04]
on_coupler = [0.05, 0.08]
second_coupler = "arm"
second_rocker = 0.22
foot = [0.35, -0.1]
[leg_designs.leg.links.coupler]
mass = "weight"
com = [0.1, 0.02]
inertia = 0.01
"""
VALUES = np.array([0.25, 2.0, 0.2])
NAMES = ("foot_position", "inverse_dynamics", "regressor", "base_parameters")


def rank(matrix):
    """Of the columns scaled alike; rounding does not count as a column."""
    scales = np.linalg.norm(matrix, axis=0)
    felt = scales > 1e-10 * np.max(scales)
    sizes = np.linalg.svd(matrix[:, felt] / scales[felt], compute_uv=False)
    return int(np.sum(sizes > 1e-8 * sizes[0]))


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["stephenson_2", "two_cranks", "cross_slide"])
def test_the_fewest_parameters(tmp_path, name):
    """They give the same efforts, and the rank of all columns says that none could be left out."""
    drawn, random = Drawn(name, 6, 5, tmp_path), np.random.default_rng(6)
    first = np.flatnonzero(drawn.closes)[0]
    text = spec(name, NAMES, values=drawn.dimensions[first], start=drawn.drives[first]).replace("runtime = true", "runtime = false")
    code = code_of(text, NAMES, tmp_path)
    drives = drawn.drives[first] + random.uniform(-0.3, 0.3, (400, drawn.drives.shape[1]))
    state = (drives, *random.uniform(-2, 2, (2, *drives.shape)))
    tau = code["leg_inverse_dynamics"](*state, np.zeros(3))
    there = np.isfinite(tau).all(-1) & (np.abs(tau).max(-1) < 1e4)
    assert there.sum() > 150
    whole, (fewest, p) = code["leg_regressor"](*state), code["leg_base_parameters"](*state)
    assert np.einsum("nij,nj->ni", fewest, p)[there] == pytest.approx(tau[there], rel=1e-9, abs=1e-9)
    assert rank(np.concatenate(whole[there])) == fewest.shape[-1] == rank(np.concatenate(fewest[there]))


@pytest.fixture(scope="module")
def bot(built):
    return built(TEXT)


@pytest.mark.parametrize("name", ["foot_position", "foot_jacobian", "transmission_angles", "mass_matrix"])
def test_slopes_by_parameters(bot, name):
    """Beside central differences over lengths that the triad rests on and a mass that it does not."""
    leg, step = bot.c.legs["leg"], 1e-5
    q = np.random.default_rng(3).uniform([-2, -0.5], [2, 0.9], (20, 2))
    found = getattr(leg, f"{name}_d_param")(q, param=VALUES)
    for place, unit in enumerate(np.eye(3)):
        ahead, behind = (getattr(leg, name)(q, param=VALUES + side * step * unit) for side in (1, -1))
        assert found[..., place] == pytest.approx((ahead - behind) / (2 * step), rel=1e-6, abs=1e-7)
    assert getattr(bot.numpy.legs["leg"], f"{name}_d_param")(q, param=VALUES) == pytest.approx(found, rel=1e-9, abs=1e-11)
    assert np.isfinite(found).all()


def test_slopes_in_casadi(bot):
    """As in C."""
    q = np.array([0.3, 0.4])
    found = np.array(bot.c.casadi("leg_foot_position_d_param")(q, VALUES)).reshape(3, 3)
    assert found == pytest.approx(bot.c.legs["leg"].foot_position_d_param(q, param=VALUES), rel=1e-9, abs=1e-11)

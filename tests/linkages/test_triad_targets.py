"""A Stephenson II leg and its mirror image in C, NumPy and CasADi; in float at night."""

import casadi
import numpy as np
import pytest

from linkages.topologies import STEPHENSON_2
from oracles.backends import Built
from walkgen import selftest
from walkgen.examine import coverage_of
from walkgen.pipeline import BuildOptions, build, mechanism_of
from walkgen.runtime import load

FUNCTIONS = ("foot_position", "foot_jacobian", "inverse_velocity", "assembly_status", "mass_matrix", "foot_positions")
TEXT = f"""
walkgen = 1
robot = {{ name = "walker", gravity = [0, 0, -9.81] }}
platforms = [{{ name = "body" }}]
legs = [
    {{ name = "right", design = "leg", platform = "body", mount = {{ xyz = [0.1, -0.2, 0.0] }} }},
    {{ name = "left", mirror_of = "right" }},
]
generate = {{ functions = {list(FUNCTIONS)!r} }}
[leg_designs.leg]
plane = {{ rpy_deg = [90, 0, 0] }}
start = {{ drives_deg = [20], angles_deg = {{ coupler = 40 }} }}
[leg_designs.leg.links]
coupler = {{ mass = 0.5, com = [0.1, 0.02], inertia = 0.003 }}
rocker = {{ mass = 0.3, com = [0.1, 0.0], inertia = 0.002 }}
{STEPHENSON_2.replace("crank = 0.06", "crank = 0.12")}"""
OK, UNREACHABLE, BAD_INPUT = 0, 1, 2


@pytest.fixture(scope="module")
def walker(tmp_path_factory):
    folder = tmp_path_factory.mktemp("walker")
    path = folder / "walker.toml"
    path.write_text(TEXT, encoding="utf-8")
    return Built(path, build(path, folder / "generated").folder)


@pytest.fixture(scope="module")
def turn(walker):
    """A turn of the crank, and where it assembles."""
    q = np.linspace(-np.pi, np.pi, 73)[:, None]
    status = walker.c.legs["right"].assembly_status(q)
    assert set(status) == {OK, UNREACHABLE}
    assert 15 < (status == OK).sum() < 60
    return q, status


def test_numpy(walker, turn):
    (q, status), c, numpy = turn, walker.c.legs, walker.numpy.legs
    for name in ("right", "left"):
        assert np.array_equal(c[name].assembly_status(q), status)
        assert np.array_equal(numpy[name].assembly_status(q), status)
        for function in ("foot_position", "foot_jacobian", "mass_matrix"):
            double = getattr(c[name], function)(q)
            assert np.array_equal(np.isnan(double).any(tuple(range(1, double.ndim))), status != OK)
            assert getattr(numpy[name], function)(q) == pytest.approx(double, rel=1e-10, abs=1e-13, nan_ok=True)


@pytest.mark.nightly
def test_float(walker, turn, tmp_path):
    q, status = turn
    leg = load(build(walker.spec, tmp_path, BuildOptions(float32=True)).folder).legs["right"]
    near = leg.foot_position(q.astype(np.float32))
    assert near.dtype == np.float32
    calm = (status == OK) & (np.abs(leg.foot_jacobian(q)).max((1, 2)) < 1)  # next to a dead point rounding counts
    assert calm.mean() > 0.2
    assert near[calm] == pytest.approx(leg.foot_position(q)[calm], abs=3e-5)


def test_the_robot_and_its_mirror(walker, turn):
    q, status = turn
    closes = q[status == OK][:, 0]
    both = walker.c.foot_positions(np.stack([closes, closes], -1))
    assert both[:, 0] == pytest.approx(walker.c.legs["right"].foot_position(closes[:, None]), abs=1e-15)
    assert both[:, 1] == pytest.approx(both[:, 0] * [1, -1, 1], abs=1e-14)


def test_casadi(walker, turn):
    """The same pose, status and slopes, by its own derivatives too."""
    (q, status), robot = turn, walker.c
    position, told = robot.casadi("right_foot_position"), robot.casadi("right_assembly_status")
    symbol = casadi.MX.sym("q")
    slope = casadi.Function("slope", [symbol], [casadi.jacobian(position(symbol), symbol)])
    leg = robot.legs["right"]
    p, J = leg.foot_position(q), leg.foot_jacobian(q)
    for row in range(0, len(q), 3):
        assert int(told(q[row])) == status[row]
        assert np.array(position(q[row])).ravel() == pytest.approx(p[row], abs=1e-13, nan_ok=True)
        if status[row] == OK:
            assert np.array(slope(q[row])).ravel() == pytest.approx(J[row, :, 0], rel=1e-9, abs=1e-12)


def test_rates_and_bad_input(walker, turn):
    (q, status), leg = turn, walker.c.legs["right"]
    closes = q[status == OK]
    v = leg.foot_jacobian(closes)[..., 0] * 0.3
    qd, found = leg.inverse_velocity(closes, v)
    fine = found == OK
    assert fine.mean() > 0.8
    assert qd[fine, 0] == pytest.approx(0.3, abs=1e-9)
    for bad in (np.nan, np.inf):
        assert leg.assembly_status([bad]) == BAD_INPUT
        assert np.isnan(leg.foot_position([bad])[[0, 2]]).all()


def test_the_share_is_that_of_the_code(walker):
    """Whole turns are taken off about the start as there; the rank of the pairs' equations confirms the count."""
    mechanism = mechanism_of(walker.spec)
    for leg in mechanism.legs:
        found = coverage_of(mechanism, leg, leg.linkage)
        q = np.linspace(-np.pi, np.pi, found.points)[:, None]
        assert found.assembled == (walker.c.legs[leg.name].assembly_status(q) == OK).sum()
        assert [(each.group, each.count) for each in found.failing] == [("coupler", found.points - found.assembled)]
        assert (found.mobility.freedoms, found.mobility.pairs) == (1, ())


def test_the_self_test_follows_them(walker, capfd):
    """Another program, from the start in small steps on all loops, comes to the same assembly."""
    assert selftest.run(walker.folder) == 0
    told = capfd.readouterr().out
    assert all(name in told for name in ("right_foot_position", "right_foot_jacobian", "right_assembly_status"))

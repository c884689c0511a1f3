"""From the foot back to the drives of legs with a triad, under the drives or once the foot is held."""

import numpy as np
import pytest

from linkages.by_scipy import Plane
from linkages.placed import code_of
from linkages.topologies import HELD, STEPHENSON_2, TRIADS, spec
from walkgen.model.assemble import assemble
from walkgen.spec.read import read
from walkgen.symbolic.starts import Starts

HEAD = """
walkgen = 1
robot = { name = "bot", gravity = [0, 0, -9.81] }
platforms = [{ name = "body" }]
legs = [{ name = "leg", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } }]
[generate]
functions = ["foot_position", "assembly_status", "inverse", "inverse_branch", "inverse_near"]
targets = ["c", "numpy"]
[leg_designs.leg]
dh = "classic"
joints = [{ name = "yaw", type = "revolute", a = 0.0, d = 0.0, alpha_deg = 0 }]
plane = { xyz = [0.02, 0.01, 0.0], rpy_deg = [90, 0, 0] }
"""
STEPHENSON = f"""
start = {{ drives_deg = [10] }}
{STEPHENSON_2}"""
KNEE = """
foot = "shank.P"
four_bar = { ground = 0.13, crank = 0.3, coupler = 0.12, rocker = 0.31, drive = { limits_deg = [-110, -60] } }
[leg_designs.leg.links.coupler]
points = { K = [0.06, -0.03] }
[leg_designs.leg.links.shank]
points = { K = [0, 0], P = [0.4, 0.02] }
[[leg_designs.leg.pins]]
joins = ["coupler.K", "shank.K"]
name = "knee"
driven = true
limits_deg = [-40, 20]
"""
FUNCTIONS = ("foot_position", "assembly_status", "inverse", "inverse_near", "inverse_distance")
TWO_DRIVES = ("two_cranks", *(pytest.param(name, marks=pytest.mark.nightly) for name in ("coupler_knee", "hung_triad")))
OK, UNREACHABLE, BAD_INPUT, INFEASIBLE = 0, 1, 2, 5


def angle(turn):
    return np.angle(np.exp(1j * turn))


@pytest.mark.parametrize(("backend", "count"), [("c", 30), ("numpy", 1)])
def test_one_drive(built, backend, count):
    """A coupler curve of a linkage that Newton's method closes."""
    text = (HEAD + STEPHENSON).replace('"inverse_near"]', '"inverse_near", "inverse_distance"]')
    leg = getattr(built(text), backend).legs["leg"]
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (count, 2))
    q = q[leg.assembly_status(q) == OK]
    assert len(q) >= count / 2
    target = leg.foot_position(q)
    rows, status = leg.inverse(target)
    good = status == OK
    assert good[:, 0].all()
    assert (leg.assembly_status(rows)[good] == OK).all()
    assert np.abs(leg.foot_position(rows) - target[:, None])[good].max() < 1e-11
    assert np.where(good, np.abs(angle(rows - q[:, None])).max(-1), np.inf).min(-1).max() < 1e-8
    near, one = leg.inverse_near(target, q + 0.01)
    assert (one == OK).all()
    assert np.abs(angle(near - q)).max() < 1e-8
    assert leg.inverse_distance(target)[good].max() < 1e-11


@pytest.fixture(scope="module")
def knee(built):
    """In C, NumPy and CasADi."""
    wanted = '"foot_jacobian", "inverse_near", "inverse_distance"]'
    return built(HEAD.replace('"inverse_near"]', wanted).replace('"numpy"]', '"numpy", "casadi"]') + KNEE)


@pytest.mark.nightly
def test_casadi_comes_from_a_seed(knee):
    """To the row near it, with the slopes of the inverse: those of the foot, inverted."""
    leg, near = knee.c.legs["leg"], knee.c.casadi("leg_inverse_near")
    slopes = near.jacobian()
    for q in np.random.default_rng(5).uniform([-0.5, -1.8, -0.6], [0.5, -1.1, 0.3], (6, 3)):
        p = leg.foot_position(q)
        found, status = near(p, q + 0.03)
        assert status == OK
        assert np.abs(np.array(found).ravel() - q).max() < 1e-9
        by_p = np.array(slopes(p, q + 0.03, found, status)[0])[:, :3]
        assert np.abs(by_p @ leg.foot_jacobian(q) - np.eye(3)).max() < 1e-6


def test_casadi_has_the_rows_of_c(knee):
    """Status for status, in reach and out of it; where a way ends at a dead point, about there."""
    leg, random = knee.c.legs["leg"], np.random.default_rng(4)
    inverse, distance = knee.c.casadi("leg_inverse"), knee.c.casadi("leg_inverse_distance")
    p = leg.foot_position(random.uniform(np.radians([-90, -110, -40]), np.radians([90, -60, 20]), (12, 3)))
    p[6:] += 0.15 * random.normal(size=(6, 3))
    ends = []
    for target in p:
        rows, status = leg.inverse(target)
        own, state = (np.array(each) for each in inverse(target))
        assert np.array_equal(state.ravel(), status)
        away = np.abs(angle(own - rows)).max(-1)
        assert away[np.isin(status, (OK, INFEASIBLE))].max(initial=0) < 1e-9
        ends += [*away[status == UNREACHABLE]]
        missed = np.array(distance(target)).ravel()
        assert missed[status == OK] == pytest.approx(0, abs=1e-9)
    assert np.mean(np.array(ends) < 1e-2) > 0.9
    assert (np.array(inverse([np.nan, 0, 0])[1]) == BAD_INPUT).all()


def test_slopes_of_casadi_rows(knee):
    """Those of the foot, inverted, and differences of the rows of C; sensitivities to the branch are none."""
    leg, branch = knee.c.legs["leg"], knee.c.casadi("leg_inverse_branch")
    slopes, step = branch.jacobian(), 1e-5
    for q in np.random.default_rng(6).uniform(np.radians([-90, -100, -30]), np.radians([90, -70, 10]), (3, 3)):
        p = leg.foot_position(q)
        for number in np.flatnonzero(leg.inverse(p)[1] == OK):
            found = branch(p, number)
            row = np.array(found[0]).ravel()
            by_p = np.array(slopes(p, number, *found)[0])[:, :3]
            assert np.abs(by_p @ leg.foot_jacobian(row) - np.eye(3)).max() < 1e-9
            ahead, behind = (leg.inverse_branch(p + side * step * np.eye(3), number)[0] for side in (1, -1))
            differences = (ahead - behind) / (2 * step)
            assert by_p.T.ravel() == pytest.approx(differences.ravel(), rel=1e-4, abs=1e-4)


@pytest.mark.parametrize(("backend", "count"), [("c", 1000), ("numpy", 4)])
def test_near_a_seed_whatever_the_way(knee, backend, count):
    """Far beyond the limits rows come to dead points on their straight ways; from near the solution it is found all the same."""
    leg = getattr(knee, backend).legs["leg"]
    q = np.random.default_rng(6).uniform([-1, -np.pi, -3], [1, np.pi, 3], (count, 3))
    q = q[leg.assembly_status(q) == OK]
    p = leg.foot_position(q)
    near, status = leg.inverse_near(p, q + 0.01)
    assert (status == OK).all()
    assert np.abs(leg.foot_position(near) - p).max() < 1e-11
    assert (np.abs(angle(near - q)).max(-1) < 0.05).mean() > 0.99
    if backend == "c":
        assert ((leg.inverse(p)[1] != OK).all(-1)).mean() > 0.05
    q[:, 0] = np.nan
    assert (leg.inverse_near(p, q)[1] == BAD_INPUT).all()


def test_a_knee_on_a_coupler(knee):
    """Within the limits every pose is found again; rows are finite, those that are OK reach, others of them do not."""
    leg, random = knee.c.legs["leg"], np.random.default_rng(2)
    assert leg.branch_names[:2] == ("yaw_plus_coupler_1", "yaw_plus_coupler_2")
    low, high = np.radians([-90, -110, -40]), np.radians([90, -60, 20])
    q = random.uniform(low, high, (1000, 3))
    assert (leg.assembly_status(q) == OK).all()
    target = leg.foot_position(q)
    rows, status = leg.inverse(target)
    assert np.isfinite(rows).all()
    good = status == OK
    feet = np.linalg.norm(leg.foot_position(rows) - target[:, None], axis=-1)
    assert feet[good].max() < 1e-12
    copies = (rows == rows[:, :1]).all(-1)  # rows that no assembly is left for
    assert not (feet[((status == UNREACHABLE) & ~copies) | (status == INFEASIBLE)] < 1e-9).any()
    away = np.where(good, np.abs(angle(rows - q[:, None])).max(-1), np.inf).min(-1)
    assert np.mean(away < 1e-9) > 0.99
    near, one = leg.inverse_near(target, q)
    found = away < 1e-9
    assert (one[found] == OK).all()
    assert np.abs(angle(near - q))[found].max() < 1e-9
    for branch in (0, 7):
        row, state = leg.inverse_branch(target, branch)
        assert np.array_equal(row, rows[:, branch])
        assert np.array_equal(state, status[:, branch])


def test_backends_agree_and_bad_input_is_told(knee):
    leg, random = knee.c.legs["leg"], np.random.default_rng(3)
    target = leg.foot_position(random.uniform([-2, -2, -2], [2, 0, 0], (60, 3)))
    target = target[np.isfinite(target).all(-1)]
    (rows, status), (other, states) = leg.inverse(target), knee.numpy.legs["leg"].inverse(target)
    assert np.array_equal(status, states)
    assert np.abs(angle(rows - other))[status == OK].max() < 1e-10
    rows, status = leg.inverse([np.nan, 0, 0])
    assert np.isnan(rows).all()
    assert (status == BAD_INPUT).all()
    rows, status = leg.inverse([9.0, 0, 0])
    assert np.isfinite(rows).all()
    assert (status == UNREACHABLE).all()


def drawn(name, folder):
    """Code of a random set that assembles, with drives around it at which it does."""
    topology, random = (HELD | TRIADS)[name], np.random.default_rng(3)
    while True:
        (values,), (drives,) = topology.draw(random, 1)
        path = folder / "drawn.toml"
        path.write_text(spec(name, FUNCTIONS, values=values, start=drives if name in TRIADS else None), encoding="utf-8")
        mechanism = assemble(read(path), folder)
        starts = Starts(mechanism, mechanism.legs[0])
        if starts.modes.at([*drives, *map(float, starts.parameters)]):
            break
    code, q = code_of(path.read_text(encoding="utf-8"), FUNCTIONS, folder), drives + random.uniform(-0.6, 0.6, (30, len(drives)))
    q = q[code["leg_assembly_status"](q, np.tile(values, (30, 1))) == OK]
    return path.read_text(encoding="utf-8"), code, values, q, random


@pytest.mark.parametrize("name", TWO_DRIVES)
def test_two_drives(tmp_path, name):
    """The drives that the foot came from are found, on most straight ways; scipy closes the linkage of every row with its foot there."""
    text, code, values, q, random = drawn(name, tmp_path)
    many = np.tile(values, (len(q), 1))
    target = code["leg_foot_position"](q, many)
    rows, status = code["leg_inverse"](target, many)
    assert np.isfinite(rows).all()
    good, reaching = status == OK, (status == OK) | (status == INFEASIBLE)
    feet = code["leg_foot_position"](rows, np.tile(many[:, None], (1, rows.shape[1], 1)))
    misses = np.linalg.norm(feet - target[:, None], axis=-1)
    assert code["leg_inverse_distance"](target, many) == pytest.approx(misses, abs=1e-14, nan_ok=True)
    assert misses[good].max() < 1e-12
    assert not (misses[status == INFEASIBLE] < 1e-6).any()
    away = np.where(good, np.abs(angle(rows - q[:, None])).max(-1), np.inf).min(-1)
    assert np.mean(away < 1e-9) > 0.6
    plane, foot = Plane(text), (HELD | TRIADS)[name].foot
    for place, row in random.permutation(np.argwhere(reaching))[:8]:
        assert plane.reaches(values, rows[place, row], foot, target[place, :2], random, 400)

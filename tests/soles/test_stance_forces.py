"""Forces of every mode beside Lagrange's equations and the power that goes in; 1e5 random states, good and bad, in a row."""

import numpy as np
import pytest
from lagrange import energy, energy_rate, input_power, residual
from rolling_robots import CURVES, direction, leg_text, random_states

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE = range(6)
MU = 0.6
BACKENDS = ["c", "numpy"]
TWO = ["ellipse", pytest.param("spline", marks=pytest.mark.nightly)]
HIP = np.array([0.34, 0.80])


@pytest.fixture
def leg(built):
    return built(leg_text()).c.legs["leg"]


def flat_states(leg, rows, seed):
    random = np.random.default_rng(seed)
    hip = random.uniform(-2, 2, (rows, 3, 2))
    hip[:, 0] = random.uniform([0.1, 0.6], [0.5, 0.84], (rows, 2))
    angles, status = leg.flat_motion(hip, 0.18, 1)
    good = status == OK
    assert good.mean() > 0.8
    return hip[good], angles[good]


def rolling_states(made, rows, seed, which="toe"):
    """Hips, angles, where the contact is ahead of the ankle; thighs and edges."""
    span = (0.0, np.radians(75 if which == "toe" else 60))
    hip, thigh, edge, _, _ = random_states(made, span, rows, seed, which)
    _, angles, point, ankle, _, status = getattr(made.c.legs["leg"], f"{which}_motion")(hip, thigh, edge)
    good = status == OK
    assert good.mean() > (0.95 if which == "toe" else 0.6)  # beyond others the shank has passed the contact, see test_rolling.py
    return tuple(part[good] for part in (hip, angles, point[:, 0] - ankle[:, 0, 0], thigh, edge))


def flat_modes(leg, hip, angles, random):
    rows = len(hip)
    centre, load = random.uniform(-0.06, 0.12, rows), random.uniform(-800, 100, (rows, 2))
    yield "passive", leg.stance_forces_passive(hip, angles, MU)
    yield "pressure", leg.stance_forces_pressure(hip, angles, centre, MU)
    yield "load", leg.stance_forces_load(hip, angles, load, centre, MU)
    yield "ankle", leg.stance_forces_ankle(hip, angles, load, MU)
    yield "forward", leg.stance_forces_sliding(hip, angles, MU, 1)
    yield "backward", leg.stance_forces_sliding(hip, angles, MU, -1)
    yield "rows", leg.stance_forces(hip, angles, random.normal(size=(rows, 3, 13)), MU)


def checked(name, hip, angles, found, least, contact=None):
    """Equations of motion and power of all states that have forces; with a contact, off which the pressure is, of a rolling foot."""
    known = np.isin(found[-1], (OK, INFEASIBLE)) & np.isfinite(found[5])
    assert known.mean() > least, name
    for row in np.flatnonzero(known):
        own = [part[row] for part in found]
        size = 1 + max(np.abs(np.concatenate(own[:5])).max(), np.abs(angles[row]).max())
        worst, scale = residual(hip[row], angles[row], own)
        assert worst < 1e-10 * max(scale, size), name
        power = input_power(hip[row], angles[row], own)
        if contact is not None:
            power += own[4][1] * (own[5] - contact[row]) * angles[row, 1, 2]
        assert power == pytest.approx(energy_rate(hip[row], angles[row]), abs=1e-9 * size * (1 + np.abs(angles[row, 1]).max())), name


def test_flat_modes_obey_lagrange_and_take_the_power_that_goes_in(leg):
    hip, angles = flat_states(leg, 60, 1)
    for name, found in flat_modes(leg, hip, angles, np.random.default_rng(2)):
        checked(name, hip, angles, found, 0.95)


@pytest.mark.parametrize("which", ["toe", "heel"])
def test_rolling_modes_obey_lagrange_and_take_the_power_that_goes_in(built, leg, which):
    """The contact does no work: what goes in is the rate of the energy, for every way to close with the pressure at the contact."""
    random = np.random.default_rng(4)
    hip, angles, centre, _, _ = rolling_states(built(leg_text()), 40, 3, which)
    load = random.uniform(-800, 100, (len(hip), 2))
    checked("rolling", hip, angles, leg.stance_forces_rolling(hip, angles, centre, MU), 0.95)
    found = leg.stance_forces_load(hip, angles, load, centre, MU)
    checked("load", hip, angles, found, 0.95)
    assert np.abs(found[1] - load).max() < 1e-9
    assert np.abs(found[5] - centre).max() < 1e-9
    rows = random.normal(size=(len(hip), 3, 13))
    rows[:, 0] = 0.0
    rows[:, 0, 8], rows[:, 0, 6] = 1.0, -centre
    checked("rows", hip, angles, leg.stance_forces(hip, angles, rows, MU), 0.95)
    slip = rows.copy()
    slip[:, 1:] = 0.0
    slip[:, 1, 7], slip[:, 1, 6], slip[:, 2, 11] = 1.0, -MU, 1.0
    checked("slip", hip, angles, leg.stance_forces(hip, angles, slip, MU), 0.95)


def test_modes_of_a_flat_foot_on_a_rolling_one(built, leg):
    """Their pressure is off the contact, and its moment turns the foot."""
    hip, angles, centre, _, _ = rolling_states(built(leg_text()), 40, 5)
    for name, found in flat_modes(leg, hip, angles, np.random.default_rng(6)):
        checked(name, hip, angles, found, 0.95, centre)


def moved(motion, time):
    """A little later, at constant accelerations."""
    value, rate, acceleration = motion
    return np.array([value + time * rate + time**2 / 2 * acceleration, rate + time * acceleration, acceleration])


@pytest.mark.parametrize("phase", ["flat", "toe", "heel"])
def test_energy_by_differences(built, leg, phase):
    """The rate of energy beside which the power stands, by differences of T + V along motions of the leg (theory 8.5)."""
    if phase == "flat":
        hips, _ = flat_states(leg, 8, 6)
        motions = [lambda time, hip=hip: (moved(hip, time), leg.flat_motion(moved(hip, time), 0.18, 1)[0]) for hip in hips]
    else:
        hips, _, _, thighs, edges = rolling_states(built(leg_text()), 8, 7, phase)
        roll = getattr(leg, f"{phase}_motion")
        motions = [
            lambda time, hip=hip, thigh=thigh, edge=edge: (moved(hip, time), roll(moved(hip, time), moved(thigh, time), edge)[1])
            for hip, thigh, edge in zip(hips, thighs, edges, strict=True)
        ]
    for motion in motions:
        step, rate = 2e-5, energy_rate(*motion(0.0))
        near, far = (energy(*motion(times * step)) - energy(*motion(-times * step)) for times in (1, 2))
        assert (8 * near - far) / (12 * step) == pytest.approx(rate, rel=1e-6, abs=1e-4)


def test_modes_close_as_they_say(leg):
    hip, angles = flat_states(leg, 100, 7)
    found = dict(flat_modes(leg, hip, angles, np.random.default_rng(8)))
    for name, zero in (("passive", (0, 1, 2)), ("pressure", (1, 2)), ("forward", (1, 2)), ("backward", (1, 2)), ("ankle", (2,))):
        torque = np.abs(found[name][0])
        size = 1 + np.abs(found[name][4]).max(axis=1)
        assert (torque[:, zero].max(axis=1) / size).max() < 1e-11, name
    for side, name in ((1, "forward"), (-1, "backward")):
        tangential, normal = found[name][4].T
        assert np.abs(tangential - side * MU * normal).max() < 1e-9 * np.abs(normal).max()


def test_verdicts(leg):
    """Tipping where the centre of pressure leaves the flat part; slipping where friction is exceeded; a ground that would have to pull."""
    hip, angles = flat_states(leg, 1, 9)
    at = {d: leg.stance_forces_load(hip[0], angles[0], (-30.0, -500.0), d, MU) for d in (-0.07, 0.0, 0.12, 0.13)}
    assert [float(found[6][2]) for found in at.values()] == pytest.approx([-0.01, 0.06, 0.0, -0.01], abs=1e-12)
    assert all(found[7] == OK for found in at.values())
    assert leg.stance_forces_load(hip[0], angles[0], (-3000.0, -500.0), 0.0, MU)[6][1] < 0.0
    assert leg.stance_forces_load(hip[0], angles[0], (0.0, 5000.0), 0.0, MU)[7] == INFEASIBLE
    assert leg.stance_forces_ankle(hip[0], angles[0], (0.0, 5000.0), MU)[7] == INFEASIBLE


def test_a_straight_knee_is_named(leg):
    hip = np.zeros((3, 2))
    for bent, wanted in ((0.0, SINGULAR), (1e-3, OK)):
        angles = np.array([[-1.2, -1.2 - bent, -np.pi / 2], [0.1, 0.2, 0.0], [0.0, 0.0, 0.0]])
        hip[0] = [0.18, 0.09] - 0.42 * (direction(-1.2) + direction(-1.2 - bent))
        found = leg.stance_forces_passive(hip, angles, MU)
        assert found[7] in (wanted, INFEASIBLE) if wanted == OK else found[7] == wanted
        assert np.isnan(found[0]).all() == (wanted == SINGULAR)
        assert leg.flat_motion(hip, 0.18, 1)[1] == wanted
    twice = np.zeros((3, 13))
    twice[:, 9] = 1.0
    assert leg.stance_forces(hip, angles, twice, MU)[7] == SINGULAR


def wild(random, shape):
    """Numbers of all sizes, ordinary ones mostly, some that are none."""
    values = random.normal(size=shape) * 10.0 ** random.integers(-3, 3, shape)
    odd = random.uniform(size=shape)
    values = np.where(odd < 0.02, random.choice([np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300, 0.0, 1e16], shape), values)
    return np.where((odd > 0.3), random.uniform(-1, 1, shape), values)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("curve", TWO)
def test_random_states_give_a_status_and_never_nan_with_ok(built, backend, curve):
    made = built(leg_text(CURVES[curve]))
    leg, rows = (made.c if backend == "c" else made.numpy).legs["leg"], 100_000 if backend == "c" else 3_000
    random = np.random.default_rng(11)
    hip, thigh, edge = wild(random, (rows, 3, 2)), wild(random, (rows, 3)), wild(random, rows)
    hip[::2, 0] = [0.42, 0.8] + 0.1 * random.normal(size=(len(hip[::2]), 2))
    thigh[::2, 0], edge[::2] = -1.15 + 0.1 * random.normal(size=len(hip[::2])), 0.3
    angles = wild(random, (rows, 3, 3))
    knee = random.integers(-1, 2, rows).astype(np.int32)
    calls = {
        "flat_ankle": (hip[:, 0], thigh[:, 0], knee),
        "flat_position": (hip[:, 0], edge - 0.12, knee),
        "flat_motion": (hip, edge - 0.12, knee),
        "toe_motion": (hip, thigh, edge),
        "heel_motion": (hip, thigh, edge - 0.18),
        "stance_position": (hip[:, 0], thigh[:, 0], edge - 0.12),
        "hip_position": (angles[:, 0], edge),
        "stance_forces_passive": (hip, angles, MU),
        "stance_forces_pressure": (hip, angles, edge, MU),
        "stance_forces_load": (hip, angles, thigh[:, :2], edge, MU),
        "stance_forces_ankle": (hip, angles, thigh[:, :2], MU),
        "stance_forces_rolling": (hip, angles, edge, MU),
        "stance_forces_sliding": (hip, angles, MU, knee),
        "stance_forces": (hip, angles, wild(random, (rows, 3, 13)), MU),
    }
    for name, given in calls.items():
        *values, status = getattr(leg, name)(*given)
        assert np.isin(status, (OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE)).all(), name
        assert (status == OK).any(), name
        assert not (status == NO_CONVERGENCE).any(), name
        for value in values:
            assert np.isfinite(value[status == OK]).all(), name
        taken = np.logical_and.reduce([np.isfinite(np.reshape(part, (rows, -1))).all(axis=1) for part in given if np.ndim(part)])
        assert (status[~taken] == BAD_INPUT).all(), name


@pytest.mark.parametrize("curve", TWO)
def test_backends_agree_on_random_states(built, curve):
    made = built(leg_text(CURVES[curve]))
    random = np.random.default_rng(12)
    rows = 2000
    hip, thigh = np.array([0.42, 0.8]) + 0.1 * random.normal(size=(rows, 2)), -1.15 + 0.2 * random.normal(size=rows)
    mine, theirs = (robot.legs["leg"].stance_position(hip, thigh, 0.18) for robot in (made.c, made.numpy))
    assert (mine[-1] == theirs[-1]).mean() > 0.999
    both = (mine[-1] == OK) & (theirs[-1] == OK)
    assert both.sum() > 300
    assert {-1, 1} <= set(mine[0][both].tolist())
    for one, other in zip(mine, theirs, strict=True):
        assert np.abs(np.asarray(one, float)[both] - np.asarray(other, float)[both]).max() < 1e-9

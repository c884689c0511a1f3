"""Rolling without slipping, on toes given in every way: arc lengths by adaptive quadrature, centres of rotation, differences, hand-over."""

import numpy as np
import pytest
from rolling_robots import (
    CURVES,
    DEPTH,
    EVERY,
    FRONT,
    SHANK,
    THIGH,
    called,
    direction,
    end_of,
    foot_forward,
    leg_text,
    random_states,
)
from scipy.integrate import quad

ENDS = {name: 0.103 if name == "spline" else end_of(curve) for name, curve in CURVES.items()}
STARTS = {"late": 2.0}
ROWS, FEW = 200, 60


@pytest.fixture(params=EVERY)
def toe(request, built):
    """A robot, the bounds of its contact parameter, its curve by formulas of this file."""
    name = request.param
    return built(leg_text(CURVES[name])), STARTS.get(name, 0.0), ENDS[name], name


def contacts(start, end, rows=ROWS, seed=5):
    return start + np.random.default_rng(seed).uniform(0.0, 1.0, rows) * (end - start)


def slope_of(name, at):
    """|r'| by the formulas of the specs."""
    if name in ("ellipse", "expressions"):
        return np.hypot(0.06 * np.sin(at), 0.09 * np.cos(at))
    if name == "circle":
        return 0.07
    if name == "polynomial":
        return np.hypot(-10 * at + 36 * at**2, 1.0)
    u = at - 2.0
    return np.hypot(u / (1 + at) - 0.5 * u**2 / (1 + at) ** 2, 0.125)


def test_what_is_rolled_is_what_the_ground_is_advanced(toe):
    made, start, end, name = toe
    at = contacts(start, end)
    _, arc, point, _ = foot_forward(made, at, 0.3)
    assert np.abs(point[:, 0] - 0.3 - arc[:, 0]).max() < 1e-15
    if name == "spline":
        return  # test_spline_passes_its_points measures it
    wanted = [quad(lambda x: slope_of(name, x), start, each, epsabs=1e-14, epsrel=1e-13)[0] for each in at[:40]]
    assert np.abs(arc[:40, 0] - wanted).max() < 1e-12


def test_derivatives_by_the_parameter(toe):
    made, start, end, _ = toe
    at, step = contacts(start, end), 1e-5 * (end - start)
    at = np.clip(at, start + 2 * step, end - 2 * step)
    now, before, after = (foot_forward(made, at + shift, 0.3) for shift in (0.0, -step, step))
    for index in (0, 1, 3):
        for order in (0, 1):
            slope = (after[index][:, order] - before[index][:, order]) / (2 * step)
            size = np.abs(now[index][:, order + 1]).max() + 1e-3
            assert np.abs(slope - now[index][:, order + 1]).max() < 1e-6 * size


def test_the_instantaneous_centre_is_the_contact_point(toe):
    made, start, end, _ = toe
    angle, _, point, ankle = foot_forward(made, contacts(start, end), 0.3)
    lever = ankle[:, 0] - point
    turned = angle[:, 1, None] * np.stack([-lever[:, 1], lever[:, 0]], -1)
    assert np.abs(ankle[:, 1] - turned).max() < 1e-12 * np.abs(turned).max()


def test_no_slip_of_the_material_point(toe):
    """A point fixed in the foot that is at the contact rests, by differences of its path."""
    made, start, end, _ = toe
    at, step = contacts(start, end), 1e-5 * (end - start)
    at = np.clip(at, start + step, end - step)
    angle, _, point, ankle = foot_forward(made, at, 0.3)
    fixed = rotated(-angle[:, 0], point - ankle[:, 0])
    before, after = (foot_forward(made, at + shift, 0.3) for shift in (-step, step))
    places = [found[3][:, 0] + rotated(found[0][:, 0], fixed) for found in (before, after)]
    assert np.abs(places[1] - places[0]).max() / (2 * step) < 1e-6 * np.abs(foot_forward(made, at, 0.3)[3][:, 1]).max()


def rotated(angle, vector):
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * vector[:, 0] - s * vector[:, 1], s * vector[:, 0] + c * vector[:, 1]], -1)


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_motions_that_forward_kinematics_makes(toe, backend):
    """The contact parameter is found again, the loop closes, rates and accelerations are those of differences along a motion."""
    made, start, end, name = toe
    hip, thigh, edge, contact, shank = random_states(made, (start, end), ROWS, 17)
    leg = next(iter((made.numpy if backend == "numpy" else made.c).legs.values()))
    found, angles, point, ankle, margins, status = leg.toe_motion(hip, thigh, edge)
    assert (status == 0).mean() > 0.98, name
    good = (status == 0) & (np.abs(found[:, 0] - contact) < 1e-9)
    assert good.mean() > 0.9, "another place of the foot may be met before"
    assert np.abs(np.cos(angles[good, 0, 1] - shank[good]) - 1).max() < 1e-14
    knee = hip[:, 0] + THIGH * direction(thigh[:, 0])
    assert np.abs(np.linalg.norm(ankle[:, 0] - knee, axis=1) - SHANK)[status == 0].max() < 1e-13
    assert np.abs(point[:, 0] - edge - foot_forward(made, found[:, 0], edge)[1][:, 0])[status == 0].max() < 1e-12
    assert (np.minimum(*margins[status == 0].T) >= 0).all()
    step = 1e-6
    moved = [leg.toe_motion(*along(hip, thigh, shift), edge) for shift in (-step, step)]
    both = (status == 0) & (moved[0][5] == 0) & (moved[1][5] == 0)
    near = both & (np.abs(found[:, 1]) < 50) & (np.abs(found[:, 2]) < 5e3)
    assert near.mean() > 0.7
    for value, before, after in zip((found, angles, ankle), *((m[0], m[1], m[3]) for m in moved), strict=True):
        for order in (0, 1):
            slope = (after[near, order] - before[near, order]) / (2 * step)
            size = 1 + np.abs(value[near]).max()
            assert np.abs(slope - value[near, order + 1]).max() < 2e-5 * size


@pytest.mark.parametrize("which", ["toe", "heel"])
def test_the_posture_is_the_one_that_the_flat_foot_is_led_to(built, which):
    """By a dense look along the curve: the first root, before the shank passes the contact point; else there is none."""
    made = built(leg_text())
    end = np.radians(75 if which == "toe" else 60)
    hip, thigh, edge, contact, _ = random_states(made, (0.0, end), FEW, 23, which)
    found, *_, status = getattr(made.c.legs["leg"], f"{which}_motion")(hip, thigh, edge)
    at = np.linspace(0.0, end, 2001)
    knee = hip[:, 0] + THIGH * direction(thigh[:, 0])
    for row in range(FEW):
        away = np.linalg.norm(foot_forward(made, at, edge[row], which)[3][:, 0] - knee[row], axis=1) - SHANK
        towards = np.sign(away[0]) * np.diff(away) < 0
        turn = len(at) - 1 if towards.all() else int(np.argmin(towards))
        crossed = np.sign(away[0]) * away[: turn + 1] < 0
        assert (status[row] == 0) == crossed.any()
        if status[row] == 0:
            assert abs(found[row, 0] - at[int(np.argmax(crossed))]) < 2 * at[1]
        else:
            assert status[row] in (1, 3)
            assert contact[row] > at[turn]
    assert (status == 0).mean() > (0.98 if which == "toe" else 0.6)


def along(hip, thigh, time):
    """Both a little later, at constant accelerations."""
    moved, turned = hip.copy(), thigh.copy()
    moved[:, 0] += time * hip[:, 1] + time**2 / 2 * hip[:, 2]
    moved[:, 1] += time * hip[:, 2]
    turned[:, 0] += time * thigh[:, 1] + time**2 / 2 * thigh[:, 2]
    turned[:, 1] += time * thigh[:, 2]
    return moved, turned


@pytest.mark.parametrize("which", ["toe", "heel"])
def test_hand_over_from_flat_to_rolling_is_smooth(built, which):
    """At the edge positions are the same; where the thigh moves as over a flat foot, rates and accelerations are too."""
    made = built(leg_text())
    leg = made.c.legs["leg"]
    random = np.random.default_rng(3)
    hip = np.concatenate([random.uniform([0.3, 0.75], [0.4, 0.82], (50, 2)), random.uniform(-1, 1, (50, 4))], 1).reshape(50, 3, 2)
    flat, status = leg.flat_motion(hip, 0.18, 1)
    assert (status == 0).all()
    edge = 0.18 + (FRONT if which == "toe" else -0.06)
    found, angles, point, ankle, margins, status = getattr(leg, f"{which}_motion")(hip, np.ascontiguousarray(flat[:, :, 0]), edge)
    assert (status == 0).all()
    assert np.abs(found).max() < 1e-9
    assert np.abs(angles - flat).max() < 1e-9
    assert np.abs(point - [edge, 0.0]).max() < 1e-12
    assert np.abs(ankle[:, 0] - [0.18, DEPTH]).max() < 1e-12
    assert np.abs(margins[:, 0]).max() < 1e-12


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_when_phases_change(built, backend):
    """A hip that goes on over a held thigh: margins come to 0 where it begins to roll and where its curve ends, not before."""
    leg = next(iter(getattr(built(leg_text()), backend).legs.values()))
    start, ankle = np.array([0.34, 0.80]), 0.18
    thigh = leg.flat_position(start, ankle, 1)[0][0]
    times = np.linspace(-0.01, 1.2, 4841)
    hip = np.zeros((len(times), 3, 2))
    hip[:, 0], hip[:, 1] = start + times[:, None] * [0.4, 0.0], [0.4, 0.0]
    swing = np.tile([thigh, 0.0, 0.0], (len(times), 1))
    contact, angles, _, _, margins, status = leg.toe_motion(hip, swing, ankle + FRONT)
    rolls = status == 0
    first, last = np.flatnonzero(rolls)[[0, -1]]
    assert rolls[first : last + 1].all()
    assert times[first] == pytest.approx(0.0, abs=1.1 * (times[1] - times[0]))
    assert (status[~rolls] == 1).all()
    phase, *_, stood = leg.stance_position(hip[:, 0], swing[:, 0], ankle)
    assert (phase[first + 1 : last + 1] == 1).all()
    assert (stood[last + 1 :] != 0).all()
    # margins say when: the line through the last two leads to 0 within a step
    step = times[1] - times[0]
    for side, (one, two) in ((0, (first + 1, first)), (1, (last - 1, last))):
        slope = (margins[two, side] - margins[one, side]) / abs(two - one)
        assert 0.0 <= margins[two, side] < 1.01 * abs(slope)
    assert (np.diff(contact[rolls, 0]) > 0).all()
    slopes = (contact[first + 2 : last + 1, 0] - contact[first : last - 1, 0]) / (2 * step)
    assert np.abs(slopes - contact[first + 1 : last, 1])[5:].max() < 1e-3 * np.abs(contact[rolls, 1]).max()
    assert (angles[rolls, 0, 2] <= -np.pi / 2).all()


@pytest.mark.parametrize("backend", ["c", "numpy", "casadi"])
def test_phases(built, backend):
    """Over a flat foot; then the thigh held while the hip goes on or back: the foot rolls over toe or heel, farther, beyond its curves."""
    made = built(leg_text())
    hip, ankle = np.array([0.34, 0.80]), 0.18
    thigh = made.c.legs["leg"].flat_position(hip, ankle, 1)[0][0]
    states = [
        called(made, backend, "stance_position", hip + np.array([ahead, 0.0]), thigh, ankle) for ahead in (0.0, 0.02, 0.05, -0.02, 0.5)
    ]
    assert [int(state[5]) for state in states] == [0, 0, 0, 0, 1]
    assert [int(state[0]) for state in states[:4]] == [0, 1, 1, -1]
    assert states[0][1] == 0.0 < states[1][1] < states[2][1]
    assert states[3][2][2] > -np.pi / 2 > states[1][2][2] > states[2][2][2]
    assert np.isnan(states[4][2]).all()
    for state, ahead in zip(states[:4], (0.0, 0.02, 0.05, -0.02), strict=True):
        back = called(made, backend, "hip_position", state[2], ankle)
        assert back[0] == pytest.approx(hip + np.array([ahead, 0.0]), abs=1e-12)
        assert (int(back[1]), int(back[5])) == (int(state[0]), 0)


def test_spline_passes_its_points(built):
    """By the sum of chords; smooth in the third derivative, so that accelerations are continuous."""
    made = built(leg_text(CURVES["spline"], ("toe_rolling",), "splined"))
    points = np.array([(0.09, 0.12), (0.085, 0.15), (0.07, 0.18), (0.04, 0.205)])
    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    angle, arc, point, ankle = foot_forward(made, knots, 0.0)
    seen = rotated(-angle[:, 0], point - ankle[:, 0])
    assert np.abs(seen - points).max() < 1e-14
    for knot in knots[1:-1]:
        before, after = (foot_forward(made, knot + shift, 0.0) for shift in (-1e-9, 1e-9))
        for index in (0, 1, 3):
            assert np.abs(after[index] - before[index]).max() < 1e-4
    steps = np.linspace(0.0, knots[-1], 4001)
    path = rotated(-foot_forward(made, steps, 0.0)[0][:, 0], -foot_forward(made, steps, 0.0)[3][:, 0] + foot_forward(made, steps, 0.0)[2])
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert foot_forward(made, knots[-1], 0.0)[1][0] == pytest.approx(lengths, rel=1e-7)
    whole = quad(lambda at: foot_forward(made, at, 0.0)[1][1], 0.0, knots[-1], points=knots[1:-1], epsabs=1e-15)[0]
    assert arc[-1, 0] == pytest.approx(whole, abs=1e-13)

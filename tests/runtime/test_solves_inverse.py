"""The closest point of a yaw-pitch-pitch leg against dense search, dense grids of joint angles and hand-made cases."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from walkgen.runtime.solves.inverse import any_unreachable, closest_yaw_pitch_pitch, closest_yaw_pitch_pitch_branch

UNREACHABLE = 1
PLAIN = [1.0, 0.0, 1.0, 0.0, 1.0, 0.0]
SIGMA = np.array([1.0, 1.0, -1.0, -1.0])
KNEE = np.array([1.0, -1.0, 1.0, -1.0])


def solved(geometry, target):
    q, status = closest_yaw_pitch_pitch(geometry, target, np.zeros((4, 3)), np.full(4, UNREACHABLE))
    assert np.array_equal(status, np.full(4, UNREACHABLE))
    return q


def angles_of(geometry, q):
    return geometry[4::2] * q + geometry[5::2]


def plane_point(geometry, phi, gamma):
    a1, a2, l3 = geometry[:3]
    return a1 + a2 * np.cos(phi) + l3 * np.cos(phi + gamma), a2 * np.sin(phi) + l3 * np.sin(phi + gamma)


def foot_of(geometry, q):
    t, phi, gamma = angles_of(np.asarray(geometry), q)
    rho, h = plane_point(geometry, phi, gamma)
    return np.array([rho * np.cos(t) + geometry[3] * np.sin(t), rho * np.sin(t) - geometry[3] * np.cos(t), h]), rho


def distances(geometry, target, q):
    return np.array([np.linalg.norm(foot_of(geometry, row)[0] - target) for row in q])


def effective_sigma(geometry, sigma):
    a1, a2, l3 = geometry[:3]
    return -sigma if sigma * a1 + (a2 + l3) < 0 else sigma


def plane_distance(geometry, target, rho, h):
    return np.hypot(np.hypot(rho, geometry[3]) - np.hypot(target[0], target[1]), h - target[2])


def on_circle(geometry, target, centre, r):
    """Least distance to a circle of the mirrored leg plane, rho >= 0: every local minimum of 2001 samples polished."""
    if centre < -r:
        return np.inf
    end = np.pi if centre >= r else np.arccos(-centre / r)

    def distance(angle):
        return plane_distance(geometry, target, np.maximum(centre + r * np.cos(angle), 0.0), r * np.sin(angle))

    angles = np.linspace(-end, end, 2001)
    sampled = distance(angles)
    padded = np.concatenate([[np.inf], sampled, [np.inf]])
    minima = np.flatnonzero((sampled <= padded[:-2]) & (sampled <= padded[2:]))
    best = sampled.min()
    for i in minima[np.argsort(sampled[minima])][:4]:
        near = angles[i]  # offsets from it keep the search's relative step small
        bracket = angles[max(i - 1, 0)] - near, angles[min(i + 1, 2000)] - near
        found = minimize_scalar(lambda step, near=near: distance(near + step), bounds=bracket, method="bounded", options={"xatol": 1e-13})
        best = min(best, found.fun)
    return best


def least_distance(geometry, target, sigma):
    """The sheet's distance, by searching each of its edges and the one interior point that can be least."""
    a1, a2, l3, w = geometry[:4]
    centre = effective_sigma(geometry, sigma) * a1
    rho = np.sqrt(max(target[0] ** 2 + target[1] ** 2 - w**2, 0.0))
    inside = abs(a2 - l3) <= np.hypot(rho - centre, target[2]) <= a2 + l3
    interior = plane_distance(geometry, target, rho, target[2]) if inside else np.inf
    return min(interior, on_circle(geometry, target, centre, a2 + l3), on_circle(geometry, target, centre, abs(a2 - l3)))


length = st.floats(0.05, 2.0)
offset = st.one_of(st.just(0.0), st.floats(-2.0, 2.0), st.sampled_from([1e-9, -1e-5, 1e-200]))
coordinate = st.one_of(st.just(0.0), st.floats(-3.0, 3.0), st.floats(-0.05, 0.05), st.floats(-100.0, 100.0))


@st.composite
def legs(draw):
    a2 = draw(length)
    l3 = draw(st.one_of(st.just(a2), length, st.just(a2 * (1 + 1e-9))))
    maps = [draw(item) for item in (st.sampled_from([1.0, -1.0]), st.floats(-7, 7)) * 3]
    return np.array([draw(st.one_of(offset, st.just(a2 + l3), st.just(-a2 - l3))), a2, l3, draw(offset), *maps])


@given(legs(), st.tuples(coordinate, coordinate, coordinate))
@settings(max_examples=250, deadline=None)
def test_the_distance_is_the_least_of_the_sheet(geometry, target):
    q = solved(geometry, target)
    scale = np.abs(geometry[:4]).max() + np.abs(target).max()
    found = distances(geometry, target, q)
    for row in range(4):
        assert abs(found[row] - least_distance(geometry, target, SIGMA[row])) <= 1e-12 * scale


@given(st.floats(0.5, 2.0), st.floats(0.3, 1.5), st.floats(0.3, 2.0), st.floats(-0.4, 0.4), st.floats(1e-6, 0.3))
@settings(max_examples=150, deadline=None)
def test_inside_the_folded_circle_two_minima_compete(hip, folded, w, beside, height):
    geometry = np.array([hip, folded + 0.2, 0.2, w, *PLAIN])
    target = (np.hypot(hip + beside, w), 0.0, height)
    found = distances(geometry, target, solved(geometry, target))
    assert abs(found[0] - least_distance(geometry, target, 1.0)) <= 1e-12
    assert abs(found[2] - least_distance(geometry, target, -1.0)) <= 1e-12


@given(legs(), st.tuples(coordinate, coordinate, coordinate))
@settings(max_examples=150, deadline=None)
def test_the_row_lies_on_its_branch(geometry, target):
    q = solved(geometry, target)
    assert np.all((q > -np.pi) & (q <= np.pi + 1e-15))
    for row in range(4):
        gamma = angles_of(geometry, q[row])[2]
        assert foot_of(geometry, q[row])[1] * effective_sigma(geometry, SIGMA[row]) >= -1e-13 * (abs(geometry[0]) + 1)
        assert KNEE[row] * np.sin(gamma) >= -1e-13


@given(legs(), st.tuples(coordinate, coordinate, coordinate))
@settings(max_examples=60, deadline=None)
def test_no_pose_on_a_grid_is_closer(geometry, target):
    phi, gamma = np.meshgrid(np.linspace(-np.pi, np.pi, 181), np.linspace(-np.pi, np.pi, 181))
    rho, h = plane_point(geometry, phi, gamma)
    every = plane_distance(geometry, target, rho, h)
    found = distances(geometry, target, solved(geometry, target))
    for row in range(4):
        on_sheet = every[effective_sigma(geometry, SIGMA[row]) * rho >= 0]
        assert on_sheet.size == 0 or found[row] <= on_sheet.min() + 1e-12 * (1 + every.max())


@given(legs(), st.tuples(coordinate, coordinate, coordinate), st.integers(-900, 900))
@settings(max_examples=60, deadline=None)
def test_size_does_not_matter(geometry, target, exponent):
    assume(min(abs(x) for x in (*geometry[:4], *target) if x) > 1e-30)
    scaled = np.concatenate([np.ldexp(geometry[:4], exponent), geometry[4:]])
    assert np.array_equal(solved(geometry, target), solved(scaled, np.ldexp(target, exponent)))


@pytest.mark.parametrize("far", [1e20, 1e154, 1.7e308])
def test_a_very_far_target_is_a_direction(far):
    geometry = np.array([0.08, 0.35, 0.4, 0.06, *PLAIN])
    direction = np.array([0.6, 0.5, -0.4])
    near = solved(geometry, direction * 1e12)
    assert np.allclose(solved(geometry, direction * far), near, rtol=0, atol=1e-11)
    feet = np.array([foot_of(geometry, row)[0] @ direction for row in near])
    assert feet[0] == pytest.approx(feet.max(), abs=1e-12)


@pytest.mark.parametrize("tiny", [0.0, 5e-324, 1e-300, -1e-160])
def test_a_target_at_the_shoulder(tiny):
    geometry = np.array([0.0, 0.35, 0.4, 0.1, *PLAIN])
    assert np.allclose(
        distances(geometry, [tiny, tiny, tiny], solved(geometry, [tiny, tiny, tiny])), np.hypot(0.1, 0.05), rtol=0, atol=1e-15
    )


def test_stretched_leg_points_at_a_far_target():
    geometry = np.array([0.0, 0.35, 0.4, 0.0, *PLAIN])
    q = solved(geometry, [0.0, 2.0, 2.0])
    assert q[0] == pytest.approx([np.pi / 2, np.pi / 4, 0.0], abs=1e-15)
    assert q[2] == pytest.approx([-np.pi / 2, 3 * np.pi / 4, 0.0], abs=1e-15)


def test_inside_the_hip_cylinder_the_foot_stays_on_it():
    """The chapter's leg with a1 = 0.08, foot (0.41, -0.03): (0.02, 0, 0.1) is 0.04 from the cylinder of radius 0.06."""
    geometry = np.array([0.08, 0.35, np.hypot(0.41, -0.03), 0.06, *PLAIN[:4], 1.0, np.arctan2(-0.03, 0.41)])
    target = np.array([0.02, 0.0, -0.02])
    q = solved(geometry, target)
    assert distances(geometry, target, q) == pytest.approx(np.full(4, 0.04), abs=1e-15)
    assert foot_of(geometry, q[0])[0] == pytest.approx([0.06, 0.0, -0.02], abs=1e-15)


def test_beyond_the_reach_of_the_same_leg():
    shank = np.hypot(0.41, -0.03)
    geometry = np.array([0.08, 0.35, shank, 0.06, *PLAIN])
    target = np.array([0.9, 0.0, -0.02])
    found = distances(geometry, target, solved(geometry, target))
    assert found[0] == pytest.approx(least_distance(geometry, target, 1.0), abs=1e-15)
    assert found[0] == found[1]
    assert found[2] == found[3]
    assert found[0] < found[2]


def test_a_folded_leg_of_equal_links_rests_at_the_hip():
    geometry = np.array([1.0, 0.3, 0.3, 0.0, 1.0, 0.0, 1.0, 0.7, 1.0, 0.0])
    q = solved(geometry, [1.0, 0.0, 0.0])
    assert q[0] == pytest.approx([0.0, 0.0, np.pi], abs=1e-15)


def test_a_free_yaw_is_zero():
    geometry = np.array([0.0, 0.35, 0.4, 0.05, -1.0, 0.3, *PLAIN[2:]])
    assert np.all(solved(geometry, [0.0, 0.0, 2.0])[:, 0] == 0.0)


def test_an_empty_sheet_takes_the_other_one():
    geometry = np.array([2.0, 0.35, 0.4, 0.1, *PLAIN])
    for target in ([0.3, 0.2, 0.1], [2.0, 0.5, 0.3]):
        q = solved(geometry, target)
        assert np.array_equal(q[2:], q[:2])
    assert np.allclose(distances(geometry, target, q), 0.0, atol=1e-15)


def test_only_unreachable_rows_change():
    rng = np.random.default_rng(5)
    geometry, target = np.array([0.1, 0.35, 0.4, 0.05, *PLAIN]), [0.9, 0.3, 0.2]
    before = rng.normal(size=(7, 4, 3))
    status = np.array([0, 1, 2, 1], np.int32)
    before[:, 2] = np.nan
    kept = before.copy()
    q, states = closest_yaw_pitch_pitch(geometry, target, before, status)
    assert np.array_equal(before, kept, equal_nan=True)
    assert states.shape == (7, 4)
    assert np.array_equal(q[:, [0, 2]], before[:, [0, 2]], equal_nan=True)
    assert np.array_equal(q[:, [1, 3]], np.broadcast_to(solved(geometry, target)[[1, 3]], (7, 2, 3)))


@given(legs(), st.tuples(coordinate, coordinate, coordinate))
@settings(max_examples=50, deadline=None)
def test_a_branch_is_a_row(geometry, target):
    q, status = closest_yaw_pitch_pitch_branch(geometry, target, np.arange(4), np.zeros(3), np.full(4, UNREACHABLE))
    assert np.array_equal(q, solved(geometry, target))
    assert np.array_equal(status, np.full(4, UNREACHABLE))


def test_branches_that_do_not_exist_are_left_alone():
    geometry = np.array([0.1, 0.35, 0.4, 0.05, *PLAIN])
    q, status = closest_yaw_pitch_pitch_branch(geometry, [9.0, 0.0, 0.0], np.array([-1, 4, 0]), np.full((3, 3), 5.0), np.array([1, 1, 0]))
    assert np.array_equal(q, np.full((3, 3), 5.0))
    assert np.array_equal(status, [1, 1, 0])


def test_no_rows_at_all():
    q, status = closest_yaw_pitch_pitch(np.ones(10), np.zeros((0, 3)), np.zeros((0, 4, 3)), np.zeros((0, 4), np.int32))
    assert q.shape == (0, 4, 3)
    assert status.shape == (0, 4)


def test_any_unreachable():
    assert np.array_equal(any_unreachable([[0, 0, 3, 2], [0, 1, 0, 0]]), [False, True])

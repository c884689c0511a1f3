"""Incipient slip in C: the worked example, inclines, equilibrium and cones, the least friction on a plane, the reference, any input."""

import numpy as np
import pytest

from oracles.stances import (
    O10_AXIS,
    O10_FRICTION,
    O10_LOAD,
    O10_NORMAL_FORCES,
    O10_POINTS,
    incline_load,
    moved,
    random_rotation,
    random_stance,
)
from walkgen.runtime.solves.slip import slip
from walkgen.runtime.solves.stance import BAD_INPUT, INFEASIBLE, NO_CONVERGENCE, OK, SINGULAR, grasp_map

UP = np.tile([0.0, 0.0, 1.0], (3, 1))


def assert_slips(points, normals, wrench, mu, N, f, twist):
    """Balance; feet move along the ground; friction mu N against their velocity, or less where a foot stays; the load drives the twist."""
    V = twist[:3] + np.cross(twist[3:], points)
    T = f - N[:, None] * normals
    size = np.linalg.norm(wrench)
    speeds = np.linalg.norm(V, axis=1)
    np.testing.assert_allclose(grasp_map(points) @ f.ravel(), -wrench, rtol=0, atol=1e-11 * size)
    np.testing.assert_allclose(np.sum(V * normals, axis=1), 0.0, rtol=0, atol=1e-13)
    np.testing.assert_allclose(np.sum(T * normals, axis=1), 0.0, rtol=0, atol=1e-11 * size)
    assert N.min() >= -1e-8 * size
    assert wrench @ twist > 0.0
    for velocity, speed, push, force in zip(V, speeds, N, T, strict=True):
        if speed > 1e-7 * speeds.max():
            np.testing.assert_allclose(force, -mu * push * velocity / speed, rtol=0, atol=1e-9 * size)
        else:
            assert np.linalg.norm(force) <= mu * push * (1 + 1e-8) + 1e-8 * size


def test_the_example(stances):
    mu, N, f, twist, axis, pitch, status = stances.slip(O10_POINTS, UP, O10_LOAD)
    assert status == OK
    assert mu == pytest.approx(O10_FRICTION, rel=1e-11)
    np.testing.assert_allclose(N, O10_NORMAL_FORCES, rtol=0, atol=1e-11 * np.linalg.norm(O10_LOAD))
    np.testing.assert_allclose(axis, [*O10_AXIS, 0.0, 0.0, 0.0, 1.0], rtol=0, atol=1e-11)
    assert abs(pitch) <= 1e-14
    assert np.linalg.norm(twist) == pytest.approx(1.0, rel=1e-14)
    assert_slips(O10_POINTS, UP, O10_LOAD, mu, N, f, twist)


@pytest.mark.parametrize("angle", [1e-4, 5.0, 18.0, 25.0])
def test_gravity_on_an_incline_slips_straight_down_at_its_tangent(stances, angle):
    mu, N, f, twist, axis, pitch, status = stances.slip(O10_POINTS, UP, incline_load(np.deg2rad(angle)))
    assert status == SINGULAR  # a translation has no axis
    assert mu == pytest.approx(np.tan(np.deg2rad(angle)), rel=1e-11)
    np.testing.assert_allclose(twist, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], rtol=0, atol=1e-9)
    assert np.isnan(axis).all()
    assert pitch == np.inf
    np.testing.assert_allclose(f, N[:, None] * [-mu, 0.0, 1.0], rtol=0, atol=1e-9)


def test_friction_opposes_sliding_and_is_not_across_it(stances):
    """The axis' trace on the plane z = 0 is no point where the axis is level, though the twist is one all the same."""
    _, N, f, twist, *_ = stances.slip(O10_POINTS, UP, O10_LOAD)
    V = twist[:3] + np.cross(twist[3:], O10_POINTS)
    T = f - N[:, None] * UP
    assert np.all(np.sum(V * T, axis=1) < -0.99 * np.linalg.norm(V, axis=1) * np.linalg.norm(T, axis=1))
    angle = np.pi / 2 * np.arange(3) + 0.3
    points = np.stack([np.zeros(3), 0.3 * np.cos(angle), 0.3 * np.sin(angle)], axis=1)
    wall = np.tile([1.0, 0.0, 0.0], (3, 1))
    load = np.array([-100.0, 10.0, 20.0, 2.0, -4.0, 3.0])
    mu, N, f, twist, axis, _, status = stances.slip(points, wall, load)
    assert status == OK
    np.testing.assert_allclose(axis[3:], [np.sign(axis[3]), 0.0, 0.0], rtol=0, atol=1e-12)
    assert_slips(points, wall, load, mu, N, f, twist)


@pytest.mark.parametrize(("seed", "count"), [(1, 300), pytest.param(2, 4000, marks=pytest.mark.nightly)])
def test_random_tripods(stances, seed, count):
    """On a plane the slip's friction is the least; on curved ground it is not less."""
    rng = np.random.default_rng(seed)
    states, gap = [], 0.0
    for i in range(count):
        points, normals, wrench = random_stance(rng, 3, 0.2 * (i % 2))
        if i % 2 == 0:
            points[:, 2], normals = 0.0, UP
        mu, N, f, twist, _, _, status = stances.slip(points, normals, wrench)
        needed, _, _, feasible = stances.needed(points, normals, wrench)
        states.append(int(status))
        if status == OK:
            assert_slips(points, normals, wrench, mu, N, f, twist)
            assert feasible == OK
            assert mu == pytest.approx(needed, rel=1e-10) if i % 2 == 0 else mu >= needed * (1 - 1e-11)
            gap = max(gap, mu - needed)
        elif i % 2 == 0:
            assert status == INFEASIBLE == feasible
    assert gap > 1e-3
    assert states.count(NO_CONVERGENCE) <= count // 50
    assert states.count(OK) > count // 2


def test_a_foot_that_stays(stances):
    """A heavy foot about which the others slide: less friction there than there could be."""
    weight = np.array([20.0, 0.0, -500.0])
    wrench = np.concatenate([weight, np.cross([0.25, 0.02, 0.0], weight) + np.array([0.0, 0.0, 8.0])])
    mu, N, f, twist, axis, _, status = stances.slip(O10_POINTS, UP, wrench)
    assert status == OK
    np.testing.assert_allclose(axis[:3], O10_POINTS[0], rtol=0, atol=1e-12)
    assert np.linalg.norm(f[0, :2]) < mu * N[0]
    assert_slips(O10_POINTS, UP, wrench, mu, N, f, twist)
    assert mu == pytest.approx(stances.needed(O10_POINTS, UP, wrench)[0], rel=1e-11)


def test_the_reference_agrees(stances):
    rng = np.random.default_rng(3)
    for i in range(5):
        points, normals, wrench = random_stance(rng, 3, 0.1 * (i % 2))
        found, expected = stances.slip(points, normals, wrench), slip(points, normals, wrench)
        if found[-1] == OK:
            assert expected[-1] == OK
            assert found[0] == pytest.approx(float(expected.mu), rel=1e-9)
            np.testing.assert_allclose(found[3], expected.twist, rtol=0, atol=1e-7)
            np.testing.assert_allclose(found[2], expected.f, rtol=0, atol=1e-8 * np.linalg.norm(wrench))
            np.testing.assert_allclose(found[4], expected.axis, rtol=0, atol=1e-6)
            assert found[5] == pytest.approx(float(expected.pitch), abs=1e-6)


def test_order_frame_and_size_do_not_matter(stances):
    rng = np.random.default_rng(5)
    for _ in range(40):
        points, normals, wrench = random_stance(rng, 3, 0.1)
        order, R, shift, size = rng.permutation(3), random_rotation(rng), rng.uniform(-1, 1, 3), 10.0 ** rng.uniform(-3, 3)
        other = moved(points, normals, wrench, R, shift)
        found, again = stances.slip(points, normals, wrench), stances.slip(other[0][order], other[1][order], size * other[2])
        if found[-1] == OK:
            assert again[-1] == OK
            assert again[0] == pytest.approx(found[0], rel=1e-9)
            np.testing.assert_allclose(again[2] / size, found[2][order] @ R.T, rtol=0, atol=1e-7 * np.linalg.norm(wrench))


@pytest.mark.parametrize(
    ("points", "normals", "wrench", "expected"),
    [
        (O10_POINTS, UP, incline_load(0.0), SINGULAR),
        (O10_POINTS, UP, -incline_load(0.1), INFEASIBLE),
        (O10_POINTS * [1.0, 0.0, 1.0], UP, O10_LOAD, SINGULAR),
        (O10_POINTS[:2], UP[:2], O10_LOAD, BAD_INPUT),
        (O10_POINTS, 1.1 * UP, O10_LOAD, BAD_INPUT),
        (O10_POINTS, UP, np.full(6, np.nan), BAD_INPUT),
    ],
)
def test_statuses(stances, points, normals, wrench, expected):
    found, reference = stances.slip(points, normals, wrench), slip(points, normals, wrench)
    assert found[-1] == reference[-1] == expected
    assert np.isnan(found[3]).all()


SPECIAL = (0.0, -0.0, 5e-324, 1e-200, 1e-9, 0.3, -0.5, 1.0, 1e9, 1e160, -1e160, 1.7e308, np.inf, -np.inf, np.nan)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_any_input_has_an_answer(stances, dtype):
    rng = np.random.default_rng(9)
    for _ in range(200):
        inputs = [O10_POINTS.copy(), UP.copy(), O10_LOAD.copy()]
        for _ in range(2):
            chosen = inputs[rng.integers(3)]
            chosen.flat[rng.integers(chosen.size)] = rng.choice(SPECIAL)
        *numbers, status = stances.slip(*inputs, dtype=dtype)
        assert status in (OK, BAD_INPUT, SINGULAR, INFEASIBLE, NO_CONVERGENCE)
        assert status != OK or all(np.isfinite(item).all() for item in numbers)


def test_single_precision(stances):
    mu, N, *_, status = stances.slip(O10_POINTS, UP, O10_LOAD, dtype=np.float32)
    assert status == OK
    assert mu == pytest.approx(O10_FRICTION, rel=1e-4)
    np.testing.assert_allclose(N, O10_NORMAL_FORCES, rtol=0, atol=0.05)

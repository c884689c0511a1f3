"""The NumPy inverse of chains: leading dimensions, the arm it iterates on, and its derivatives against matrix exponentials."""

import numpy as np
import pytest
from scipy.linalg import expm

from walkgen.runtime.solves.reach import inverse_pose, inverse_reach
from walkgen.runtime.solves.resting import curvature
from walkgen.runtime.solves.serial import read_arm, read_pose, rotation_vector, stance_at
from walkgen.runtime.solves.within import closest_within

OK, UNREACHABLE, BAD_INPUT = 0, 1, 2
RRPRR = 36
FREE = np.tile([-np.inf, np.inf], (5, 1))


def hat(axis):
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def arm(seed):
    """Geometry [42] of turn, turn, slide, turn, turn with axes and points anywhere."""
    rng = np.random.default_rng(seed)
    axes, points = rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
    axes /= np.linalg.norm(axes, axis=-1)[:, None]
    return np.concatenate([np.hstack([axes, points]).ravel(), rng.normal(size=3), expm(hat(rng.normal(size=3))).ravel()])


def pose(geometry, q):
    """A product of matrix exponentials."""
    T = np.eye(4)
    for joint, value in enumerate(q):
        axis, point = geometry[6 * joint : 6 * joint + 3], geometry[6 * joint + 3 : 6 * joint + 6]
        twist = np.zeros((4, 4))
        if joint == 2:
            twist[:3, 3] = axis
        else:
            twist[:3, :3], twist[:3, 3] = hat(axis), -np.cross(axis, point)
        T = T @ expm(value * twist)
    home = np.eye(4)
    home[:3, 3], home[:3, :3] = geometry[30:33], geometry[33:].reshape(3, 3)
    return T @ home


def error(geometry, q, T):
    """Position, then rotation vector, of the pose at q as seen from T, by the logarithm's series in expm's inverse: eigenvectors."""
    gap = pose(geometry, q)
    turn = gap[:3, :3] @ T[:3, :3].T
    angle = np.arccos(np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0))
    sine = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2.0
    return np.concatenate([gap[:3, 3] - T[:3, 3], sine * angle / np.sin(angle)])


def test_leading_dimensions_broadcast():
    arms = np.array([arm(1), arm(2)])[:, None]
    made = np.random.default_rng(0).uniform(-0.5, 0.5, (3, 5))
    T = np.array([[pose(one[0], q) for q in made] for one in arms])
    q, status = inverse_pose(arms, T, made + 0.1, FREE, RRPRR)
    assert q.shape == (2, 3, 5)
    assert status.shape == (2, 3)
    assert status.dtype == np.int32
    assert (status == OK).all()
    np.testing.assert_allclose(q, np.broadcast_to(made, q.shape), atol=1e-9)
    single, state = inverse_pose(arms[1, 0], T[1, 2], made[2] + 0.1, FREE, RRPRR)
    assert state.shape == ()
    np.testing.assert_allclose(single, q[1, 2], atol=1e-12)
    q, status = inverse_reach(arms[..., :33], T[..., :3, 3], made, FREE, RRPRR)
    assert q.shape == (2, 3, 5)
    assert (status == OK).all()


def test_no_rows():
    q, status = inverse_reach(arm(1)[:33], np.zeros((0, 3)), np.zeros(5), FREE, RRPRR)
    assert q.shape == (0, 5)
    assert status.shape == (0,)
    q, status = inverse_pose(arm(1), np.zeros((0, 2, 4, 4)), np.zeros(5), FREE, RRPRR)
    assert q.shape == (0, 2, 5)
    q, status = closest_within(arm(1)[:33], np.zeros((0, 3)), FREE, RRPRR, np.zeros(5), np.zeros(0))
    assert q.shape == (0, 5)
    assert status.shape == (0,)


def test_one_bad_row_does_not_touch_the_others():
    geometry, made = arm(3), np.random.default_rng(1).uniform(-0.5, 0.5, (4, 5))
    T = np.array([pose(geometry, q) for q in made])
    T[1, 0, 3], T[2, 0, 0] = np.nan, 7.0
    q, status = inverse_pose(geometry, T, made + 0.05, FREE, RRPRR)
    np.testing.assert_array_equal(status, [OK, BAD_INPUT, BAD_INPUT, OK])
    np.testing.assert_allclose(q[[0, 3]], made[[0, 3]], atol=1e-9)
    assert np.isnan(q[1:3]).all()


def test_within_broadcasts_and_keeps_what_it_is_given():
    geometry, limits = arm(4)[:33], np.tile([-0.5, 0.5], (5, 1))
    given, states = np.full((2, 3, 5), 0.1), np.array([OK, UNREACHABLE, 3])
    p = np.array([pose(arm(4), [0.3, -0.2, 0.1, 0.4, 0.2])[:3, 3], [9.0, 9.0, 9.0]])[:, None]
    q, status = closest_within(geometry, p, limits, RRPRR, given, states)
    np.testing.assert_array_equal(status, [[OK, OK, 3], [OK, UNREACHABLE, 3]])
    np.testing.assert_array_equal(q[:, [0, 2]], given[:, [0, 2]])
    np.testing.assert_allclose(pose(arm(4), q[0, 1])[:3, 3], p[0, 0], atol=1e-11)
    assert (np.abs(q[1, 1]) <= 0.5).all()
    assert (given == 0.1).all()


@pytest.mark.parametrize("sequence", [-3, 0, 1, 1 << 17])
def test_impossible_sequences(sequence):
    q, status = inverse_reach(arm(1)[:33], np.ones(3), np.zeros(5), FREE, sequence)
    assert status == BAD_INPUT
    assert np.isnan(q).all()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_foot_jacobian_and_curvature_against_differences(seed):
    geometry, rng = arm(10 + seed), np.random.default_rng(seed)
    q, T = rng.uniform(-1.0, 1.0, 5), pose(geometry, rng.uniform(-1.0, 1.0, 5))
    chain, fine = read_pose(geometry[None], T[None], RRPRR)
    assert fine.all()
    scale = 2.0 ** float(chain.size[0])
    units = np.repeat([scale, 1.0 / chain.length[0]], 3)
    values = np.array([1.0, 1.0, 1.0 / scale, 1.0, 1.0])
    at = stance_at(chain, (q * values)[None])
    np.testing.assert_allclose(at.error[0] * units, error(geometry, q, T), atol=1e-10)

    def cost(point):
        return 0.5 * np.sum((error(geometry, point, T) / units) ** 2)

    h, eye = 1e-3, np.eye(5)
    rows = [(error(geometry, q + 1e-5 * step, T) - error(geometry, q - 1e-5 * step, T)) / 2e-5 for step in eye]
    slope = np.array(rows) / units @ at.error[0]
    np.testing.assert_allclose(at.jacobian[0, :3].T * scale * values[:, None], np.array(rows)[:, :3], atol=1e-8)
    np.testing.assert_allclose((at.jacobian[0].T @ at.error[0]) * values, slope, atol=1e-8)
    second = [[(cost(q + a + b) - cost(q + a - b) - cost(q - a + b) + cost(q - a - b)) / (4 * h * h) for a in h * eye] for b in h * eye]
    np.testing.assert_allclose(curvature(chain, at)[0] * np.outer(values, values), second, atol=2e-5)


@pytest.mark.parametrize("angle", [0.0, 1e-160, 1e-9, 0.3, 2.0, 2.7, 3.1, np.pi - 1e-9, np.pi])
def test_rotation_vectors(angle):
    for axis in (np.array([1.0, 0.0, 0.0]), np.array([0.6, -0.8, 0.0]), np.array([2.0, -1.0, 2.0]) / 3.0):
        found = rotation_vector(expm(angle * hat(axis))[None])[0]
        same = np.abs(found - angle * axis).max()
        opposite = np.abs(found + angle * axis).max() if angle == np.pi else np.inf
        assert min(same, opposite) <= 1e-14 + 1e-7 * (3.1 < angle < np.pi) * 1e-6


def test_points_slide_along_their_axes_and_far_targets_come_nearer():
    geometry = np.array([0, 0, 1, 5, 6, 700, 0, 0, 1, 6, 6, -900, 7, 6, 1], float)
    chain, fine = read_arm(geometry[None], np.array([[1e9, 0.0, 0.0]]), 4)
    assert fine.all()
    np.testing.assert_allclose(np.linalg.norm(np.ldexp(chain.levers[0], chain.size[0]), axis=-1), [1.0, 1.0], atol=1e-12)
    assert np.linalg.norm(chain.target) < 2.1e6
    q, status = inverse_reach(geometry, [1e9, 6.0, 1.0], [0.5, -0.3], FREE[:2], 4)
    assert status == UNREACHABLE
    np.testing.assert_allclose(q, 0.0, atol=1e-8)

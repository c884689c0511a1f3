"""The NumPy solves of stances: batches, and what the equations of a tripod about to slip determine."""

import numpy as np
import pytest
from scipy.linalg import expm

from oracles.bowl import LIMITS, bowl, stance, tilted
from oracles.stances import O10_AXIS, O10_FRICTION, O10_LOAD, O10_NORMAL_FORCES, O10_POINTS, random_rotation
from walkgen.runtime.solves.contact_vertical import contact_vertical
from walkgen.runtime.solves.friction_needed import friction_needed
from walkgen.runtime.solves.slip import slip
from walkgen.runtime.solves.stance import BAD_INPUT, OK, SINGULAR, cross_matrix, grasp, grasp_map

UP = np.tile([0.0, 0.0, 1.0], (3, 1))


def test_the_worked_example():
    N, _, twist, mu, *_, status = slip(O10_POINTS, UP, O10_LOAD)
    assert status == OK
    assert mu == pytest.approx(O10_FRICTION, rel=1e-11)
    np.testing.assert_allclose(N, O10_NORMAL_FORCES, rtol=0, atol=1e-8)
    np.testing.assert_allclose(np.cross(twist[3:], twist[:3])[:2] / (twist[3:] @ twist[3:]), O10_AXIS, rtol=0, atol=1e-10)
    assert friction_needed(O10_POINTS, UP, O10_LOAD)[0] == pytest.approx(O10_FRICTION, rel=1e-12)


def test_batches_broadcast():
    loads = np.stack([O10_LOAD, np.full(6, np.nan)])
    points = np.stack([O10_POINTS, O10_POINTS[::-1], 0.0 * O10_POINTS])[:, None]
    f, status, state, violation = contact_vertical(points, UP, loads)
    assert (f.shape, status.shape, state.shape, violation.shape) == ((3, 2, 3, 3), (3, 2), (3, 2, 3), (3, 2))
    np.testing.assert_array_equal(status, [[OK, BAD_INPUT], [OK, BAD_INPUT], [SINGULAR, BAD_INPUT]])
    G, singular, lost, condition, rank, states = grasp(points)
    assert (G.shape, singular.shape, lost.shape, condition.shape) == ((3, 1, 6, 3, 3), (3, 1, 6), (3, 1, 3, 6), (3, 1))
    np.testing.assert_array_equal(rank[:, 0], [6, 6, 3])
    np.testing.assert_array_equal(states[:, 0], [OK, OK, SINGULAR])
    mu, forces, _, states = friction_needed(points[:2], UP, loads)
    assert (mu.shape, forces.shape, states.shape) == ((2, 2), (2, 2, 3, 3), (2, 2))
    assert mu[0, 0] == pytest.approx(mu[1, 0], rel=1e-12)
    N, forces, twist, mu, *_, states = slip(points[:2], UP, loads)
    assert (mu.shape, N.shape, forces.shape, twist.shape, states.shape) == ((2, 2), (2, 2, 3), (2, 2, 3, 3), (2, 2, 6), (2, 2))


def test_the_grasp_map_is_the_sum_of_forces_and_moments():
    rng = np.random.default_rng(1)
    p, f = rng.normal(size=(2, 5, 4, 3))
    wrench = np.einsum("bij,bj->bi", grasp_map(p), f.reshape(5, 12))
    np.testing.assert_allclose(wrench, np.concatenate([f.sum(axis=1), np.cross(p, f).sum(axis=1)], axis=1), rtol=0, atol=1e-14)
    np.testing.assert_allclose(np.einsum("bij,bj->bi", cross_matrix(p[:, 0]), f[:, 0]), np.cross(p[:, 0], f[:, 0]), rtol=0, atol=1e-15)


def test_three_feet_that_stick_are_three_times_hyperstatic():
    assert 9 - np.linalg.matrix_rank(grasp_map(O10_POINTS)) == 3
    assert np.linalg.matrix_rank(grasp_map(O10_POINTS)[:, 2::3]) == 3  # normal forces alone are determined


class Posed:
    """All unknowns of a tripod about to slip in a bowl: pose 6, surface points 6, N 3, T 3, directions of friction 9, the axis' trace
    on z = 0 and direction 5, pitch 1; and its 31 equations.
    """

    def __init__(self) -> None:
        robot = bowl(0.3)
        pose = tilted(0.2)
        turn = expm(cross_matrix(np.array([0.05, 0.1, 0.4])))
        self._feet, self._centre, self._weight = robot.feet, robot.centre_of_mass, robot.weight
        self._extra = np.array([0.0, 0.0, 0.0, 5.0, 3.0, 6.0])
        self._R, self._p = turn @ pose[:3, :3], turn @ pose[:3, 3]
        points = self._feet @ self._R.T + self._p
        at = self._R @ self._centre + self._p
        load = np.concatenate([self._weight, np.cross(at, self._weight)]) + self._extra
        N, _, twist, mu, *_, status = slip(points, -points, load)
        assert status == OK
        self._mu = float(mu)
        turning = np.linalg.norm(twist[3:])
        axis, c = twist[3:] / turning, np.cross(twist[3:], twist[:3]) / turning**2
        trace, pitch = c - c[2] / axis[2] * axis, twist[:3] @ twist[3:] / turning**2
        V = twist[:3] + np.cross(twist[3:], points)
        assert np.abs(axis[2]) > 0.1
        assert np.linalg.norm(V, axis=1).min() > 1e-3
        along = -V / np.linalg.norm(V, axis=1)[:, None]
        self.solution = np.concatenate([np.zeros(6), points[:, :2].ravel(), N, mu * N, along.ravel(), trace[:2], axis, [pitch]])

    def lacking(self, x):
        R, p = expm(cross_matrix(x[3:6])) @ self._R, self._p + x[:3]
        (u, v), N, T = x[6:12].reshape(3, 2).T, x[12:15], x[15:18]
        along, trace, axis, pitch = x[18:27].reshape(3, 3), np.array([x[27], x[28], 0.0]), x[29:32], x[32]
        surface = np.stack([u, v, -np.sqrt(1 - u**2 - v**2)], axis=1)
        feet, normals = self._feet @ R.T + p, -surface
        f = N[:, None] * normals + T[:, None] * along
        load = np.concatenate([self._weight, np.cross(R @ self._centre + p, self._weight)]) + self._extra
        V = pitch * axis + np.cross(axis, feet - trace)
        parts = [
            (feet - surface).ravel(),
            (grasp_map(feet) @ f.ravel() + load) / 100.0,
            (T - self._mu * N) / 100.0,
            np.sum(normals * along, axis=1),
            np.sum(along**2, axis=1) - 1.0,
            np.sum(normals * V, axis=1),
            np.sum(np.cross(V, along) * normals, axis=1),
            [axis @ axis - 1.0],
        ]
        return np.concatenate(parts)


def test_the_equations_of_slip_leave_two_parameters_of_the_pose_open():
    """33 unknowns, 31 equations, rank 31: they bound the poses that stand and determine none."""
    posed = Posed()
    x = posed.solution
    assert x.shape == (33,)
    assert posed.lacking(x).shape == (31,)
    assert np.abs(posed.lacking(x)).max() <= 1e-9
    size = np.where((np.arange(33) >= 12) & (np.arange(33) < 18), 100.0, 1.0)
    J = np.stack([(posed.lacking(x + 1e-6 * size * e) - posed.lacking(x - 1e-6 * size * e)) / 2e-6 for e in np.eye(33)], axis=1)
    singular = np.linalg.svd(J, compute_uv=False)
    assert singular[30] > 1e-4 * singular[0]
    null = np.linalg.svd(J)[2][31:]
    assert np.linalg.matrix_rank(null[:, :6], tol=1e-6) == 2  # both of them move the pose


def test_friction_across_the_velocity_is_no_friction():
    """Directions with n . V = 0 say that velocities lie in the tangent plane; friction is against them, not across."""
    points, normals, load = stance(LIMITS[0.2])
    N, f, twist, *_ = slip(points, normals, load)
    V = twist[:3] + np.cross(twist[3:], points)
    T = f - N[:, None] * normals
    np.testing.assert_allclose(np.cross(V, T), 0.0, rtol=0, atol=1e-8)
    assert np.all(np.sum(V * T, axis=1) < 0.0)


def test_a_level_axis_has_no_trace_on_the_ground():
    """The bowl's limit turns about a level axis: its direction has no upward part, the twist is there all the same."""
    points, normals, load = stance(LIMITS[0.2])
    _, _, twist, mu, *_, status = slip(points, normals, load)
    assert status == OK
    assert mu == pytest.approx(0.2, rel=1e-9)
    np.testing.assert_allclose(twist / np.linalg.norm(twist), [0.0, 0.0, 0.0, 0.0, np.sign(twist[4]), 0.0], rtol=0, atol=1e-9)
    R = random_rotation(np.random.default_rng(2))
    turned = slip(points @ R.T, normals @ R.T, np.concatenate([R @ load[:3], R @ load[3:]]))
    np.testing.assert_allclose(turned.twist[3:], R @ twist[3:], rtol=0, atol=1e-8)

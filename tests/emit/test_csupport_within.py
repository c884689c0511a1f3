"""The closest foot within limits, C and NumPy, against grids polished by scipy, and what it leaves alone."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from serial_library import Reaching, grid, poses, random_arm, random_limits, sequence_of

from walkgen.runtime.solves.within import closest_within

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE, DUPLICATE = range(7)
ALONG = {1: 300, 2: 40, 3: 16, 4: 8}


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    return Reaching(tmp_path_factory.mktemp("within"))


@pytest.fixture(params=["c", "numpy"])
def closest(request, compiled):
    return compiled.closest_within if request.param == "c" else closest_within


def feet(geometry, kinds, q):
    return poses(geometry, kinds, q)[..., :3, 3]


def dense_minimum(geometry, kinds, p, limits):
    """The least distance from p over a box, by a grid whose four best points, apart from each other, scipy leads on."""
    points = grid(limits, ALONG[len(kinds)])
    gaps = np.linalg.norm(feet(geometry, kinds, points) - p, axis=-1)
    starts, best = [], np.inf
    for point in points[np.argsort(gaps)[:60]]:
        if len(starts) < 4 and all(np.max(np.abs(point - other)) > 0.3 for other in starts):
            starts.append(point)
    for start in starts:
        inside = np.clip(start, limits[:, 0] + 1e-9, limits[:, 1] - 1e-9)
        found = least_squares(
            lambda q: feet(geometry, kinds, q) - p, inside, bounds=limits.T, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=200
        )
        best = min(best, np.sqrt(2.0 * found.cost))
    return best


def random_case(rng, n, count, special=False):
    """An arm of n joints, boxes, and targets near the feet in their middles."""
    kinds, geometry = random_arm(rng, n, slides=0.3, special=special)
    limits = random_limits(rng, kinds, count)
    p = feet(geometry, kinds, limits.mean(axis=-1)) + rng.normal(size=(count, 3)) * 0.5
    return kinds, geometry, limits, p


def check_minimum(closest, rng, n, count, special):
    kinds, geometry, limits, p = random_case(rng, n, count, special)
    q, status = closest(geometry[:-9], p, limits, sequence_of(kinds), limits.mean(axis=-1), np.full(count, UNREACHABLE))
    assert ((q >= limits[..., 0]) & (q <= limits[..., 1])).all()
    gaps = np.linalg.norm(feet(geometry, kinds, q) - p, axis=-1)
    np.testing.assert_array_equal(status, np.where(gaps <= 1e-11, OK, UNREACHABLE))
    for row in range(count):
        assert gaps[row] <= dense_minimum(geometry, kinds, p[row], limits[row]) + 1e-7, (kinds, row)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("special", [True, False], ids=["right", "random"])
@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_nothing_in_the_box_is_closer(closest, n, special):
    check_minimum(closest, np.random.default_rng(n), n, 3, special)


@pytest.mark.nightly
@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_nothing_in_many_boxes_is_closer(compiled, n):
    rng = np.random.default_rng(100 + n)
    for special in (False, True) * 10:
        check_minimum(compiled.closest_within, rng, n, 20, special)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_c_and_numpy_agree(compiled, n):
    rng = np.random.default_rng(200 + n)
    kinds, geometry, limits, p = random_case(rng, n, 6)
    inputs = geometry[:-9], p, limits, sequence_of(kinds), limits.mean(axis=-1), np.full(6, UNREACHABLE)
    (q, status), (reference, states) = compiled.closest_within(*inputs), closest_within(*inputs)
    np.testing.assert_array_equal(status, states)
    gaps = [np.linalg.norm(feet(geometry, kinds, values) - p, axis=-1) for values in (q, reference)]
    np.testing.assert_allclose(*gaps, atol=1e-9)


def test_targets_inside_are_reached(closest):
    rng = np.random.default_rng(300)
    for n in (3, 4, 5):
        kinds, geometry, limits, _ = random_case(rng, n, 10)
        p = feet(geometry, kinds, limits[..., 0] + rng.random((10, n)) * (limits[..., 1] - limits[..., 0]))
        q, status = closest(geometry[:-9], p, limits, sequence_of(kinds), limits.mean(axis=-1), np.full(10, UNREACHABLE))
        assert (status == OK).all()
        np.testing.assert_allclose(feet(geometry, kinds, q), p, atol=1e-11)
        assert ((q >= limits[..., 0]) & (q <= limits[..., 1])).all()


def test_other_statuses_leave_everything_alone(closest):
    kinds, geometry, limits, p = random_case(np.random.default_rng(400), 3, 7)
    given = np.linspace(-9.0, 9.0, 21).reshape(7, 3)
    states = np.array([OK, BAD_INPUT, SINGULAR, NO_CONVERGENCE, INFEASIBLE, DUPLICATE, -1])
    q, status = closest(geometry[:-9], p, limits, sequence_of(kinds), given, states)
    np.testing.assert_array_equal(status, states)
    np.testing.assert_array_equal(q, given)


def test_joints_that_limits_hold_fast(closest):
    kinds, geometry, limits, p = random_case(np.random.default_rng(500), 3, 4)
    limits[..., 1, :] = limits[..., 1, :1]
    limits[3, :, 1] = limits[3, :, 0]
    q, status = closest(geometry[:-9], p, limits, sequence_of(kinds), limits.mean(axis=-1), np.full(4, UNREACHABLE))
    assert (status == UNREACHABLE).all()
    np.testing.assert_array_equal(q[:, 1], limits[:, 1, 0])
    np.testing.assert_array_equal(q[3], limits[3, :, 0])


def test_a_guess_is_brought_inside_and_angles_turn_to_their_limits(closest):
    """An arm of one joint, 1 long, in the plane: limits a full turn further on, and a target beside them."""
    geometry, turn = np.array([0, 0, 1, 0, 0, 0, 1, 0, 0], float), 2 * np.pi
    q, status = closest(geometry, [2.0 * np.cos(1.2), 2.0 * np.sin(1.2), 0.0], [[turn + 0.5, turn + 1.0]], 2, [-50.0], UNREACHABLE)
    assert status == UNREACHABLE
    assert q[0] == turn + 1.0
    q, status = closest(geometry, [np.cos(0.7), np.sin(0.7), 0.0], [[turn + 0.5, turn + 1.0]], 2, [-50.0], UNREACHABLE)
    assert status == OK
    np.testing.assert_allclose(q, turn + 0.7, atol=1e-12)
    q, status = closest(geometry, [-3.0, 0.0, 0.0], [[-np.inf, np.inf]], 2, [0.0], UNREACHABLE)
    assert status == UNREACHABLE
    np.testing.assert_allclose(np.abs(q), np.pi, atol=1e-9)

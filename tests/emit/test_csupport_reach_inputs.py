"""What the inverse of chains calls a bad input, and lengths of any size, in C and NumPy."""

import numpy as np
import pytest
from serial_library import FREE, Reaching, denavit_hartenberg, poses

from walkgen.runtime.solves.reach import inverse_pose, inverse_reach
from walkgen.runtime.solves.within import closest_within

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
HALF = np.pi / 2
PUMA = denavit_hartenberg(
    [(0, HALF, 0, 0), (0.4318, 0, 0, 0), (0.0203, -HALF, 0.15005, 0), (0, HALF, 0.4318, 0), (0, -HALF, 0, 0), (0, 0, 0.1, 0)]
)


class NumPy:
    """The references under the names of the C library's methods."""

    inverse_reach, inverse_pose, closest_within = staticmethod(inverse_reach), staticmethod(inverse_pose), staticmethod(closest_within)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    return Reaching(tmp_path_factory.mktemp("reach"))


@pytest.fixture(params=["c", "numpy"])
def solver(request, compiled):
    return compiled if request.param == "c" else NumPy


BAD_POSES = {
    "nan": ((0, 0), np.nan),
    "infinite position": ((1, 3), np.inf),
    "sheared": ((0, 1), 0.1),
    "scaled": ((2, 2), 1.00001),
    "last row": ((3, 0), 1e-5),
    "last entry": ((3, 3), 0.0),
}


@pytest.mark.parametrize("case", BAD_POSES)
def test_transforms_that_are_not_rigid(solver, case):
    T, (place, value) = np.eye(4), BAD_POSES[case]
    T[place] = value
    q, status = solver.inverse_pose(PUMA, T, np.zeros(6), FREE * np.ones((6, 1)), 64)
    assert status == BAD_INPUT
    assert np.isnan(q).all()


def test_mirrored_transforms_and_barely_rigid_ones(solver):
    T = poses(PUMA, "RRRRRR", [0.3, 0.4, 0.5, 0.6, 0.7, 0.8])
    mirrored, rounded = T.copy(), T.copy()
    mirrored[:3, 0] *= -1.0
    rounded[0, 0] += 1e-7
    limits, seed = FREE * np.ones((6, 1)), np.full(6, 0.5)
    assert solver.inverse_pose(PUMA, mirrored, seed, limits, 64)[1] == BAD_INPUT
    q, status = solver.inverse_pose(PUMA, rounded, seed, limits, 64)
    assert status == OK
    np.testing.assert_allclose(poses(PUMA, "RRRRRR", q), T, atol=1e-6)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_inputs_that_are_no_numbers(solver, bad):
    good = [PUMA[:-9], np.array([0.3, 0.2, 0.1]), np.zeros(6), np.tile([-3.0, 3.0], (6, 1))]
    for index, place in ((0, 7), (0, 38), (1, 2), (2, 5)):
        inputs = [item.copy() for item in good]
        inputs[index][place] = bad
        q, status = solver.inverse_reach(*inputs, 64)
        assert status == BAD_INPUT
        assert np.isnan(q).all()
        q, status = solver.closest_within(inputs[0], inputs[1], inputs[3], 64, inputs[2], UNREACHABLE)
        assert status == BAD_INPUT
        assert np.isnan(q).all()
    for limits in ([np.nan, 1.0], [1.0, np.nan], [2.0, 1.0], [np.inf, np.inf], [-np.inf, -np.inf]):
        box = good[3].copy()
        box[2] = limits
        assert solver.inverse_reach(*good[:3], box, 64)[1] == BAD_INPUT
        assert solver.closest_within(good[0], good[1], box, 64, good[2], UNREACHABLE)[1] == BAD_INPUT


def test_lengths_of_any_size(solver):
    made = np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8])
    for size in (5e-324, 1e-300, 1e-9, 1e9, 1e300):
        scaled, T = PUMA.copy(), poses(PUMA, "RRRRRR", made)
        scaled[:36].reshape(6, 6)[:, 3:] *= size
        scaled[36:39] *= size
        T[:3, 3] *= size
        q, status = solver.inverse_pose(scaled, T, made + 0.1, FREE * np.ones((6, 1)), 64)
        assert status in ((OK,) if size > 1e-300 else (OK, SINGULAR, UNREACHABLE))
        assert np.isfinite(q).all()
        if size > 1e-290:
            np.testing.assert_allclose(q, made, atol=1e-9)

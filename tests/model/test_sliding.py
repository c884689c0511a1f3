"""What stands for a slider's way: near 0 the way itself, one for one anywhere, and a way that runs off is gone in few steps."""

import numpy as np
import pytest

from walkgen.model.sliding import slid, unslid
from walkgen.runtime.solves.triads import close_triads

OK, UNREACHABLE, NO_CONVERGENCE = 0, 1, 4


def test_there_and_back():
    ways = np.concatenate([[0.0], np.logspace(-12, 9, 200), -np.logspace(-12, 9, 200)])
    assert slid(unslid(ways)) == pytest.approx(ways, rel=1e-14)
    assert np.all(np.diff(unslid(np.sort(ways))) > 0)
    assert unslid(1e-3) == pytest.approx(1e-3, rel=1e-6)
    assert unslid(1e3) < 26


def running_off(points):
    """A slider's way w with w (1 - z) = 1, and y = w / 4: w is infinite at z = 1."""
    z, u, y = np.moveaxis(points, -1, 0)
    rate = 1 + 3 * u**2 / 16
    none = np.zeros_like(u)
    return np.stack([slid(u) * (1 - z) - 1, y - u / 4, rate * (1 - z), none, none - 0.25, none + 1], -1)


def test_far_out_and_back():
    """As far as ten thousand sizes, in 400 steps, and from there; never beyond infinity."""
    z = 1 - np.logspace(0, -4, 50)
    start = np.array([0.0, unslid(1.0), unslid(1.0) / 4])
    u, status = close_triads(2, z[:, None], start, (running_off,))
    assert (status == OK).all()
    assert slid(u[:, 0]) * (1 - z) == pytest.approx(1, rel=1e-9)
    back, status = close_triads(2, np.zeros((50, 1)), np.concatenate([z[:, None], u], -1), (running_off,))
    assert (status == OK).all()
    assert slid(back[:, 0]) == pytest.approx(1, rel=1e-9)
    assert set(close_triads(2, [[1.0], [1.1], [2.0]], start, (running_off,))[1]) <= {UNREACHABLE, NO_CONVERGENCE}


def coming_back(least):
    """A slider's way w with w ((1 - z)^2 + least^2) = 1: far out at z = 1, but not infinite."""

    def closure(points):
        z, u, y = np.moveaxis(points, -1, 0)
        rate, none, inverse = 1 + 3 * u**2 / 16, np.zeros_like(u), (1 - z) ** 2 + least**2
        return np.stack([slid(u) * inverse - 1, y - u / 4, rate * inverse, none, none - 0.25, none + 1], -1)

    return closure


def test_beyond_infinity_ends_early():
    """In less than half of the 400 steps; what comes back from far out is still followed."""
    parts = []

    def counted(points):
        parts.append(len(points))
        return running_off(points)

    start = np.array([0.0, unslid(1.0), unslid(1.0) / 4])
    status = close_triads(2, [[2.0]], start, (counted,))[1]
    assert status == NO_CONVERGENCE
    assert sum(parts) < 1000  # 2059 in all 400 steps
    for least in (0.1, 0.05, 0.02):
        far = unslid(1 / (1 + least**2))
        u, status = close_triads(2, [[2.0]], [0.0, far, far / 4], (coming_back(least),))
        assert status == OK
        assert slid(u[0, 0]) == pytest.approx(1 / (1 + least**2), rel=1e-9)

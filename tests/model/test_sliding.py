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

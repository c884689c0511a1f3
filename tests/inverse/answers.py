"""What every answer of an inverse must hold, for targets that forward kinematics made."""

import numpy as np

OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE = 0, 1, 2, 3, 6
REACHES = (OK, SINGULAR, DUPLICATE)
REGULAR = 1e-3
"""Least singular value, m, of poses that are compared."""


def least(path, q):
    """The least singular value that n columns have, [...]."""
    return np.linalg.svd(path.jacobian(q), compute_uv=False)[..., path.n - 1]


def assert_reached(path, q, p, rows, status):
    """Every target that forward kinematics made is reached, by the pose that made it too, and rows are where they say."""
    assert np.all(np.isfinite(rows))
    assert np.all(np.isin(status, (*REACHES, UNREACHABLE)))
    reached = np.isin(status, REACHES)
    assert np.all(reached.any(axis=1))
    scale = path.reach + np.max(np.where(path.turning, 0.0, np.abs(rows)), axis=-1)
    assert np.all((np.linalg.norm(path.foot(rows) - p[:, None], axis=-1) <= 1e-12 * scale)[reached])
    nearest = np.min(np.where(reached, path.apart(rows, q[:, None]), np.inf), axis=1)
    weakest = least(path, q)
    regular = weakest > REGULAR
    assert np.all(nearest[regular] <= 1e-13 + 1e-14 / weakest[regular])


def assert_ordered(path, rows, status, general):
    """Angles in (-pi, pi]; solutions sorted by their first joints, a repeated one after its first, unused slots last and of one pose."""
    turning = rows[..., path.turning]
    assert np.all((turning > -np.pi) & (turning <= np.pi))
    if not general:
        return
    unused = status == UNREACHABLE
    assert np.array_equal(unused, np.sort(unused, axis=1))
    rising = np.diff(rows[..., 0], axis=1)
    assert np.all((rising >= -1e-9) | unused[:, 1:])
    twice = np.argwhere(status == DUPLICATE)
    assert all(slot > 0 and np.array_equal(rows[row, slot], rows[row, slot - 1]) for row, slot in twice)

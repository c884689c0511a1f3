"""Whether `inverse_branch`, which computes one row alone, gives what that row of `inverse` is."""

import numpy as np
import pytest


def check_branches(robot):
    """At targets in reach and out of it, at a double root, on the axis: joint values and statuses, on both backends."""
    targets = np.random.default_rng(6).uniform(-0.8, 0.8, (100, 3))
    targets[:5] = [[np.nan, 0, 0], [3, 0, 0], [0.4, 0, -0.6], [0, 0, 0], [0.21, 0.06, -0.3]]
    for backend in (robot.c, robot.numpy):
        leg = next(iter(backend.legs.values()))
        rows, states = leg.inverse(targets)
        for branch in range(len(leg.branch_names)):
            q, status = leg.inverse_branch(targets, branch)
            assert (status == states[:, branch]).all()
            assert q == pytest.approx(rows[:, branch], abs=1e-12, nan_ok=True)
        for branch in (-1, len(leg.branch_names)):
            q, status = leg.inverse_branch(targets[2], branch)
            assert status == 2
            assert np.isnan(q).all()

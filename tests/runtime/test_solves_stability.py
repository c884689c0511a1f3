"""What static stability depends on: the stroke of a gait (theory 3.1, erratum 27)."""

import numpy as np
import pytest

from walkgen.runtime.solves.stability import stability_margins
from walkgen.runtime.solves.stance import OK

PITCH = 1.0
GRAVITY = np.array([0.0, 0.0, -9.81])


def least_longitudinal(duty, stroke, rows):
    """The least longitudinal margin over a cycle of the wave gait of 2 `rows` legs, feet one pitch apart on either side."""
    placing = np.array([[m * duty, m * duty + 0.5] for m in range(rows)]).ravel() % 1.0
    centres = np.array([[(rows - 1) / 2 - m] * 2 for m in range(rows)]).ravel() * PITCH
    side = np.tile([0.5, -0.5], rows)
    moments = np.sort(np.concatenate([(placing + part) % 1.0 + nudge for part in (0.0, duty) for nudge in (-1e-9, 1e-9)]))
    least = np.inf
    for moment in moments:
        u = (moment - placing) % 1.0
        down = u < duty
        points = np.stack([centres + stroke / 2 - stroke * u / duty, side, 0.0 * side], axis=1)[down]
        k = len(points)
        found = stability_margins(points, np.zeros(3), [1.0, 0, 0], np.full(k, np.inf), np.zeros((k, 3)), GRAVITY, 1.0, np.zeros(4))
        if found.status == OK:
            least = min(least, float(found.longitudinal.min()))
    return least


@pytest.mark.parametrize(
    ("duty", "stroke", "margin"),
    [(0.5, 0.2, 0.4), (0.5, 0.5, 0.25), (2 / 3, 0.8, 0.4), (5 / 6, 1.3, 0.63), (0.75, 0.2, 0.5), (0.75, 0.6, 0.5)],
)
def test_the_length_of_the_step_does_influence_stability(duty, stroke, margin):
    """Erratum 27: (n/2 - 1) P + (1 - 3 / (4 beta)) R, whose slope over the stroke R is 0 at a duty factor of 3/4 only; O7."""
    assert least_longitudinal(duty, stroke, 3) == pytest.approx(margin, abs=1e-7)


def test_the_walk_of_four_legs():
    """O7: (beta - 3/4) of the stride."""
    assert least_longitudinal(0.8, 0.5, 2) == pytest.approx(0.03125, abs=1e-7)

"""The longitudinal margin: oracle O7, the formula against a dense sweep of the cycle, and the wave gait as the best of a quadruped."""

from itertools import product

import numpy as np
import pytest

from walkgen.gait.margin import cycle_margin, formula_holds, normalised, wave_margin
from walkgen.gait.pattern import Gait
from walkgen.gait.standard import crawl, tripod, wave

O7 = (
    (3, 0.5, 0.2, 0.4),
    (3, 0.5, 1.0, 0.0),
    (3, 7 / 12, 0.5, 0.357142857142857),
    (3, 2 / 3, 0.8, 0.4),
    (3, 5 / 6, 1.3, 0.63),
    (3, 11 / 12, 1.3, 0.704545454545455),
    (2, 0.8, 0.5, 0.03125),
    (2, 0.9, 1.3, 0.211111111111111),
)


@pytest.mark.parametrize(("pairs", "duty", "stroke", "margin"), O7)
def test_oracle_7(pairs, duty, stroke, margin):
    assert wave_margin(pairs, duty, 1.0, stroke) == pytest.approx(margin, abs=1e-12)
    assert formula_holds(pairs, duty, 1.0, stroke)
    assert _cycle(pairs, duty, stroke) == pytest.approx(margin, abs=1e-12)


def _cycle(pairs, duty, stroke):
    gait, centres = _walk(pairs, duty, stroke)
    return cycle_margin(gait, centres)


def _walk(pairs, duty, stroke):
    names = [f"{n}" for n in range(2 * pairs)]
    gait = wave(names[:pairs], names[pairs:], duty, stride=stroke / duty)
    return gait, [((pairs - 1) / 2 - m, y) for y in (1.0, -1.0) for m in range(pairs)]


def _swept(pairs, duty, stroke):
    """The definition at instants just before and just after every event, feet and polygon written down from theory 3.1."""
    phases = [m * duty % 1 for m in range(pairs)] + [(m * duty + 0.5) % 1 for m in range(pairs)]
    instants = np.array([*phases, *((phase + duty) % 1 for phase in phases)])
    worst = np.inf
    for time in np.concatenate([instants - 1e-10, instants + 1e-10]):
        ends = []
        for side in (0, 1):
            u = np.array([(time - phase) % 1 for phase in phases[side * pairs : (side + 1) * pairs]])
            x = (pairs - 1) / 2 - np.arange(pairs) + stroke / 2 - stroke * u / duty
            ends.append((x[u < duty].max(), x[u < duty].min()) if (u < duty).any() else (-np.inf, np.inf))
        front, rear = (ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2
        worst = min(worst, front, -rear)
    return worst


def test_formula_in_its_range_and_the_cycle_everywhere():
    inside = outside = 0
    for pairs, share, stroke in product((2, 3, 4, 5), np.linspace(0.02, 0.97, 9), (0.1, 0.4, 0.8, 1.2, 1.6, 2.6)):
        least = 3 / (2 * pairs)
        duty = least + share * (1 - least)
        expected = _swept(pairs, duty, stroke)
        assert wave_margin(pairs, duty, 1.0, stroke) == pytest.approx(expected, abs=1e-8)
        assert _cycle(pairs, duty, stroke) == pytest.approx(expected, abs=1e-8)
        held = formula_holds(pairs, duty, 1.0, stroke)
        inside, outside = inside + held, outside + (not held)
    assert inside + outside == 216
    assert inside > 120
    assert outside > 40


def test_quadrupeds_wave_gait_is_the_best():
    """McGhee and Frank: S = (beta - 3/4) lambda at beta = 0.8, and no phases of a 0.1 grid do better."""
    centres = [(0.5, 1.0), (-0.5, 1.0), (0.5, -1.0), (-0.5, -1.0)]
    best, stride = -np.inf, 0.5 / 0.8
    for phase in product(np.arange(10) / 10, repeat=3):
        best = max(best, cycle_margin(Gait(("lf", "lh", "rf", "rh"), (0.8,) * 4, (0.0, *phase), stride=stride), centres))
    gait = crawl(("lf", "lh"), ("rf", "rh"), 0.8, stride=stride)
    assert cycle_margin(gait, centres) == pytest.approx(0.03125, abs=1e-12)
    assert best == pytest.approx(0.03125, abs=1e-12)
    assert normalised(0.03125, gait) == pytest.approx(0.05, abs=1e-12)


def test_the_step_length_does_influence_stability():
    """The chapter says it does not: a tripod with P = 1 loses from 0.4 to 0.25 (erratum 27)."""
    assert wave_margin(3, 0.5, 1.0, 0.2) == pytest.approx(0.4, abs=1e-12)
    assert wave_margin(3, 0.5, 1.0, 0.5) == pytest.approx(0.25, abs=1e-12)
    assert wave_margin(3, 0.75, 1.0, 0.2) == pytest.approx(wave_margin(3, 0.75, 1.0, 0.5), abs=1e-12)


def test_margin_of_feet_of_any_width():
    """Against the convex hull of the feet on a fine grid of times."""
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(4)
    gait = tripod(("a", "b", "c"), ("d", "e", "f"), 0.7, stride=0.3)
    centres = [(x + rng.uniform(-0.1, 0.1), y * rng.uniform(0.5, 1)) for y in (1, -1) for x in (0.5, 0, -0.5)]
    worst = np.inf
    for time in np.concatenate([[event.at + side for side in (-1e-9, 1e-9)] for event in gait.events]):
        u = gait.leg_phase(time)
        feet = np.array([[x + 0.3 * (0.35 - now), y] for (x, y), now in zip(centres, u, strict=True) if now < 0.7])
        a, _, c = ConvexHull(feet).equations.T
        worst = min([worst, *(-c / a)[a > 1e-9], *(c / a)[a < -1e-9]])
    assert cycle_margin(gait, centres) == pytest.approx(worst, abs=1e-8)


def test_a_gait_without_three_legs_has_no_margin():
    gait = Gait(("a", "b"), (0.5, 0.5), (0.0, 0.5), stride=0.1)
    assert cycle_margin(gait, [(0.0, 1.0), (0.0, -1.0)]) == -np.inf

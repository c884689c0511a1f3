"""Work of the hydraulic leg over the gait of theory 6.7: the note's own figures for its design drawn by hand."""

import math

import numpy as np
import pytest

from linkages.hydraulic import SPEC
from walkgen.runtime import load

SAMPLES, SLOW = 81, 1e4
"""Samples of support and of transfer; so slowly that what moves has no inertia worth counting."""


def spec():
    """HI .35, HP .45, LP .36, IG = IJ = .12, gamma 60, alpha 30, beta 80 deg; m6 = 10 HI, m7 = 7 HP, half way along."""
    polar = {"G": (0.12, 80), "J": (0.12, 60), "L": (0.36, 30)}
    points = {name: [radius * math.cos(math.radians(a)), radius * math.sin(math.radians(a))] for name, (radius, a) in polar.items()}
    generate = 'generate = { functions = ["inverse_branch", "inverse_dynamics", "inverse_velocity"], targets = ["numpy"] }'
    text = SPEC.format(knee="right", lift="left", c6=0.0, c7=0.0, generate=generate, **points)
    changed = {
        "E = [-0.25, 0.10], I = [0.02, -0.01]": "E = [-0.20, 0.25], I = [0, 0]",
        "mass = 5.0, com = [0.16, 0.0]": "mass = 3.5, com = [0.175, 0.0]",
        "mass = 4.0, com = [0.25, 0.0]": "mass = 3.15, com = [0.225, 0.0]",
        "at_second = 1.2": "at_second = 1.0",
        "at_first = 1.8": "at_first = 1.5",
    }
    for old, new in changed.items():
        assert old in text
        text = text.replace(old, new)
    return text


def gait():
    """Foot, its velocity, the ground's force and the times: 1 s of support, 0.6 s of transfer."""
    t = np.linspace(0, 1, SAMPLES)
    quintic, slope = 10 * t**3 - 15 * t**4 + 6 * t**5, 30 * t**2 - 60 * t**3 + 30 * t**4
    zero = np.zeros(SAMPLES)
    support = np.c_[0.2 - 0.4 * t, zero - 0.6, zero], np.c_[zero - 0.4, zero, zero], np.c_[zero, zero + 800, zero]
    lift, rise = 0.12 * np.sin(np.pi * t) ** 2, 0.12 * np.pi * np.sin(2 * np.pi * t)
    transfer = np.c_[0.4 * quintic - 0.2, lift - 0.6, zero], np.c_[0.4 * slope, rise, zero] / 0.6, np.zeros((SAMPLES, 3))
    return *(np.concatenate(pair) for pair in zip(support, transfer, strict=True)), np.concatenate([t, 1 + 0.6 * t])


@pytest.fixture(scope="module")
def leg(built):
    return load(built(spec()).folder).legs["leg"]


def test_positive_work_of_the_design_drawn_by_hand(leg):
    foot, velocity, force, times = gait()
    q, status = leg.inverse_branch(foot, leg.branch_names.index("h_left"))
    assert (status == 0).all()
    qd, status = leg.inverse_velocity(q, velocity / SLOW)
    assert (status == 0).all()
    forces = leg.inverse_dynamics(q, qd, 0 * q, force)
    assert np.abs(forces).max() == pytest.approx(1785.2, abs=0.05)
    positive = np.maximum(forces * qd, 0).sum(-1) * SLOW
    assert positive.max() == pytest.approx(142.25, abs=5e-3)
    trapezoids = np.sum(np.diff(times) * (positive[1:] + positive[:-1]) / 2)
    assert trapezoids == pytest.approx(58.395, abs=5e-4)
    found = leg.work(q, qd, 0 * q, force, period=1.6 * SLOW, times=times * SLOW)
    assert found.positive == pytest.approx(58.395, abs=5e-3)  # changes of sign are met between the samples
    assert found.positive < trapezoids
    assert found.total == pytest.approx(0, abs=2e-3)  # masses that go round and a force that pushes along a level way

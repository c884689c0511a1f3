"""Reactions of every pair beside a dense solution of all links' equations of motion."""

import numpy as np
import pytest

from linkages.closure import assembled
from linkages.newton_euler import Bodies, Motion
from linkages.placed import code_of
from linkages.topologies import TOPOLOGIES, spec

FUNCTIONS = ("assembly_status", "transmission_angles", "joint_reactions")
GRAVITY, SETS = (0.7, -9.8), 6
QUICK = ("slider_crank", "moving_guide", "inverted_slider_crank", "scotch_yoke", "crossed_guides", "hydraulic", "telescope", "pin_of_three")
MARKED = [pytest.param(name, marks=() if name in QUICK else pytest.mark.nightly) for name in TOPOLOGIES]
"""Every kind of dyad and of drive; what is dearer, and has no other kinds, runs at night."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Code of a topology, and some sets of dimensions and drives with their poses, away from dead points."""
    done = {}

    def of(name):
        if name not in done:
            code = code_of(spec(name, FUNCTIONS), FUNCTIONS, tmp_path_factory.mktemp(name))
            done[name] = code["leg_joint_reactions"], sets(code, name)
        return done[name]

    return of


def sets(code, name):
    topology, random = TOPOLOGIES[name], np.random.default_rng(21)
    dimensions, drives = topology.draw(random, 60)
    sines = np.sin(code["leg_transmission_angles"](drives, dimensions)) if topology.sides else np.ones((len(drives), 1))
    closes = np.flatnonzero((code["leg_assembly_status"](drives, dimensions) == 0) & (np.abs(sines) > 0.2).all(-1))[:SETS]
    poses = assembled(spec(name, FUNCTIONS), topology.sides, dimensions[closes], drives[closes], random, np.full(len(closes), 6))
    assert len(closes) == SETS
    assert np.isfinite(poses).all()
    return list(zip(dimensions[closes], drives[closes], poses, strict=True))


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", MARKED)
def test_at_rest(made, name):
    (reactions, chosen), text = made(name), spec(name, FUNCTIONS)
    still, load = np.zeros(TOPOLOGIES[name].drive_count), np.array([40, 600, -30])
    for dimensions, drives, x in chosen:
        bodies = Bodies(Motion(text, dimensions, drives, x), GRAVITY, load[:2])
        found = reactions(drives, still, still, load, dimensions)
        scale = np.abs(bodies.unknowns).max()
        assert bodies.rank == len(bodies.unknowns) == 3 * len(bodies.closure.links) - 3
        assert np.abs(found - bodies.reactions).max() < 1e-10 * scale
        assert np.abs(bodies.sums(found)).max() < 1e-10 * scale


@pytest.mark.parametrize("name", MARKED)
def test_in_motion(made, name):
    (reactions, chosen), text, random = made(name), spec(name, FUNCTIONS), np.random.default_rng(22)
    for dimensions, drives, x in chosen:
        rates, seconds, load = random.normal(size=drives.shape) / 5, random.normal(size=drives.shape), random.normal(size=3) * 100
        bodies = Bodies(Motion(text, dimensions, drives, x, rates, seconds), GRAVITY, load[:2])
        found = reactions(drives, rates, seconds, load, dimensions)
        scale = np.abs(bodies.unknowns).max()
        assert np.abs(found - bodies.reactions).max() < 1e-6 * scale
        assert np.abs(bodies.sums(found)).max() < 1e-6 * scale

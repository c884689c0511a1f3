"""A thousand flat poses of soled legs by day; by night a million poses of every shipped leg, and many more random legs."""

from pathlib import Path

import numpy as np
import pytest
from anatomy import Anatomy, turned
from answers import DUPLICATE, OK, assert_ordered, assert_reached
from flat import flat_foot
from legs import random_legs, spec

from oracles.screws import screws
from oracles.walker import read

SHIPPED = sorted(path.stem for path in Path(__file__).parents[2].glob("specs/*.toml") if "pins" not in path.read_text(encoding="utf-8"))
FLAT = ("anthropomorphic_biped", "anthropomorphic_leg", "anthropomorphic_leg_poly")
CHUNK = 100_000


def assert_found(anatomy, leg, q):
    p = anatomy.foot(q)
    rows, status = leg.inverse(p)
    assert np.all(np.isfinite(rows))
    error = np.where(np.isin(status, (OK, DUPLICATE)), np.max(turned(rows, q[:, None]), axis=-1), np.inf)
    least = np.linalg.svd(anatomy.jacobian(q), compute_uv=False)[:, -1]
    assert np.all(np.min(error, axis=1) <= 1e-13 + 1e-14 * anatomy.reach / least)
    reached = status == OK
    assert np.all(np.linalg.norm(anatomy.foot(rows) - p[:, None], axis=-1)[reached] <= 1e-12 * anatomy.reach)
    rho, bend = anatomy.sides(rows)
    assert np.all((rho * [1, 1, -1, -1] > -1e-9)[reached])
    assert np.all((bend * [1, -1, 1, -1] > -1e-9)[reached])


def assert_flat_found(flat, leg, q):
    """Legs with curved soles put them flat: both knees do, and one of them is the pose that made the target."""
    p = flat.foot(q)
    rows, status = leg.inverse(p)
    assert leg.branch_names == ("knee_plus", "knee_minus")
    assert np.all(np.isin(status, (OK, DUPLICATE)))
    error = np.min(np.max(turned(rows, q[:, None]), axis=-1), axis=1)
    assert np.all(error <= 1e-13 + 1e-14 * flat.reach / flat.least(q))
    assert np.all(np.linalg.norm(flat.foot(rows) - p[:, None], axis=-1) <= 1e-12 * flat.reach)
    assert np.all(flat.tilt(rows) <= 1e-14)
    assert np.all(flat.ahead(rows) * [1, -1] > -1e-9)


@pytest.mark.parametrize("name", FLAT)
def test_feet_that_are_put_flat(shipped, name):
    robot = shipped(name, ("inverse",))
    text = robot.spec.read_text(encoding="utf-8")
    for limb in read(text).legs:
        flat = flat_foot(text, limb)
        assert_flat_found(flat, robot.c.legs[limb.name], flat.random(np.random.default_rng(72), 1000))


@pytest.mark.nightly
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_legs(shipped, name):
    robot = shipped(name, ("inverse",))
    generator = np.random.default_rng(73)
    text = robot.spec.read_text(encoding="utf-8")
    for limb in read(text).legs:
        leg = robot.c.legs[limb.name]
        for _ in range(1_000_000 // CHUNK):
            if leg.inverse_class == "yaw-pitch-pitch":
                assert_found(Anatomy(limb), leg, generator.uniform(-np.pi, np.pi, (CHUNK, 3)))
            elif name in FLAT:
                flat = flat_foot(text, limb)
                assert_flat_found(flat, leg, flat.random(generator, CHUNK))
            else:
                assert_general_found(screws(limb), leg, generator)


def assert_general_found(path, leg, generator):
    q = path.random(generator, CHUNK)
    rows, status = leg.inverse(path.foot(q))
    assert_reached(path, q, path.foot(q), rows, status)
    assert_ordered(path, rows, status, general=True)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(6))
def test_random_legs(built, seed):
    text = spec(f"night{seed}", random_legs(24, seed))
    robot = built(text)
    generator = np.random.default_rng(seed)
    for limb in read(text).legs:
        assert_found(Anatomy(limb), robot.c.legs[limb.name], generator.uniform(-np.pi, np.pi, (CHUNK, 3)))

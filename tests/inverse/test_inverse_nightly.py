"""By night: a million poses of every shipped leg, and many more random legs."""

from pathlib import Path

import numpy as np
import pytest
from anatomy import Anatomy, turned
from answers import DUPLICATE, OK, assert_ordered, assert_reached
from legs import random_legs, spec

from oracles.screws import screws
from oracles.walker import read

SHIPPED = sorted(path.stem for path in Path(__file__).parents[2].glob("specs/*.toml") if "pins" not in path.read_text(encoding="utf-8"))
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


@pytest.mark.nightly
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_legs(shipped, name):
    robot = shipped(name)
    generator = np.random.default_rng(73)
    for limb in read(robot.spec.read_text(encoding="utf-8")).legs:
        leg = robot.c.legs[limb.name]
        for _ in range(1_000_000 // CHUNK):
            if leg.inverse_class == "yaw-pitch-pitch":
                assert_found(Anatomy(limb), leg, generator.uniform(-np.pi, np.pi, (CHUNK, 3)))
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

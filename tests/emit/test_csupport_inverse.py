"""The closest-point routine in C against its NumPy reference, in double and float, on random and special legs."""

import numpy as np
import pytest
from csupport_library import SOURCE, STRICT, Library, compile_c

from walkgen.runtime.solves.inverse import closest_yaw_pitch_pitch, closest_yaw_pitch_pitch_branch

UNREACHABLE = 1
SPECIAL = [0.0, -0.0, 1e-300, 5e-324, 1e-9, 0.35, 1.0, -1.0, 1e9, 1e154, -1e200, 1.7e308]


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return Library(compile_c(tmp_path_factory.mktemp("csupport"), SOURCE, "csupport.so", "-std=c99", "-O2", "-shared", "-fPIC", *STRICT))


def random_legs(rng, rows):
    geometry = np.zeros((rows, 10))
    geometry[:, 1] = rng.uniform(0.05, 1.0, rows)
    geometry[:, 2] = np.where(rng.random(rows) < 0.3, geometry[:, 1], rng.uniform(0.05, 1.0, rows))
    geometry[:, 0] = rng.normal(size=rows) * rng.choice([0.0, 0.1, 1.0, 2.0], rows)
    geometry[:, 3] = rng.normal(size=rows) * rng.choice([0.0, 1e-8, 0.01, 0.3, 1.0], rows)
    geometry[:, 4::2] = rng.choice([-1.0, 1.0], (rows, 3))
    geometry[:, 5::2] = rng.uniform(-7.0, 7.0, (rows, 3))
    return geometry


def random_targets(rng, rows):
    target = rng.normal(size=(rows, 3)) * rng.choice([1e-9, 0.01, 0.1, 0.5, 1.0, 2.0, 10.0], (rows, 1))
    target[rng.random(rows) < 0.1, :2] = 0.0
    target[rng.random(rows) < 0.1, 2] = 0.0
    return target


def special_targets():
    return np.stack(np.meshgrid(SPECIAL, SPECIAL, SPECIAL, indexing="ij"), axis=-1).reshape(-1, 3)


def feet(geometry, q):
    t, phi, gamma = np.moveaxis(geometry[:, None, 4::2] * q + geometry[:, None, 5::2], -1, 0)
    a1, a2, l3, w = (geometry[:, i, None] for i in range(4))
    rho, h = a1 + a2 * np.cos(phi) + l3 * np.cos(phi + gamma), a2 * np.sin(phi) + l3 * np.sin(phi + gamma)
    return np.stack([rho * np.cos(t) + w * np.sin(t), rho * np.sin(t) - w * np.cos(t), h], axis=-1)


def asked(rows):
    return np.zeros((rows, 4, 3)), np.full((rows, 4), UNREACHABLE, np.int32)


def turned(angles):
    """How far angles are from whole turns."""
    return np.abs(np.angle(np.exp(1j * angles)))


def test_c_and_numpy_agree_on_random_legs(library):
    rng = np.random.default_rng(11)
    geometry, target = random_legs(rng, 20000), random_targets(rng, 20000)
    q, status = library.closest(geometry, target, *asked(20000))
    expected, _ = closest_yaw_pitch_pitch(geometry, target, *asked(20000))
    assert np.all(status == UNREACHABLE)
    distances = [np.linalg.norm(feet(geometry, rows) - target[:, None], axis=-1) for rows in (q, expected)]
    assert np.abs(distances[0] - distances[1]).max() <= 1e-13
    assert np.quantile(turned(q - expected), 0.999) <= 1e-12


@pytest.mark.parametrize(
    "leg", [(0.0, 0.35, 0.4, 0.0), (0.08, 0.35, 0.4, 0.06), (0.0, 0.4, 0.4, 0.0), (-2.0, 0.3, 0.4, -0.1), (0.7, 0.3, 0.4, 0.0)]
)
def test_c_and_numpy_agree_on_special_targets(library, leg):
    """Subnormal numbers have few bits: of points that are equally near for these, any may be the answer."""
    target = special_targets()
    geometry = np.broadcast_to([*leg, 1.0, 0.1, -1.0, 0.2, 1.0, -0.3], (len(target), 10))
    q, _ = library.closest(geometry, target, *asked(len(target)))
    expected, _ = closest_yaw_pitch_pitch(geometry, target, *asked(len(target)))
    assert np.isfinite(q).all()
    whole = ((target == 0) | (np.abs(target) >= np.finfo(float).tiny)).all(axis=1)
    assert turned(q - expected)[whole].max() <= 1e-12
    near = np.abs(target).max(axis=1) <= 1.0
    distances = [np.linalg.norm(feet(geometry[near], rows[near]) - target[near, None], axis=-1) for rows in (q, expected)]
    assert np.abs(distances[0] - distances[1]).max() <= 1e-13


@pytest.mark.parametrize("exponent", [-900, 900])
def test_sizes_at_the_ends_of_the_range(library, exponent):
    rng = np.random.default_rng(3)
    geometry, target = random_legs(rng, 500), random_targets(rng, 500)
    q, _ = library.closest(geometry, target, *asked(500))
    geometry[:, :4] = np.ldexp(geometry[:, :4], exponent)
    scaled, _ = library.closest(geometry, np.ldexp(target, exponent), *asked(500))
    assert np.array_equal(q, scaled)


def test_float_reaches_as_near(library):
    rng = np.random.default_rng(12)
    geometry, target = (array.astype(np.float32).astype(float) for array in (random_legs(rng, 20000), random_targets(rng, 20000)))
    q, _ = library.closest(geometry, target, *asked(20000), dtype=np.float32)
    expected, _ = closest_yaw_pitch_pitch(geometry, target, *asked(20000))
    distances = [np.linalg.norm(feet(geometry, rows) - target[:, None], axis=-1) for rows in (q.astype(float), expected)]
    size = np.abs(geometry[:, :4]).sum(axis=-1) + np.linalg.norm(target, axis=-1)
    assert (np.abs(distances[0] - distances[1]).max(axis=-1) / size).max() <= 3e-6


def test_float_is_total(library):
    target = np.minimum(np.abs(special_targets()), 3e38)
    geometry = np.broadcast_to([0.08, 0.35, 0.4, 0.06, 1.0, 0.1, -1.0, 0.2, 1.0, -0.3], (len(target), 10))
    q, _ = library.closest(geometry, target, *asked(len(target)), dtype=np.float32)
    assert np.isfinite(q).all()


def test_other_rows_stay_as_they_are(library):
    rng = np.random.default_rng(4)
    geometry, target = random_legs(rng, 200), random_targets(rng, 200)
    status = rng.integers(0, 7, (200, 4)).astype(np.int32)
    before = rng.normal(size=(200, 4, 3))
    before[status == 2] = np.nan
    q, states = library.closest(geometry, target, before, status)
    expected, _ = closest_yaw_pitch_pitch(geometry, target, before, status)
    assert np.array_equal(states, status)
    assert np.array_equal(q[status != UNREACHABLE], before[status != UNREACHABLE], equal_nan=True)
    assert np.allclose(q, expected, rtol=0, atol=1e-11, equal_nan=True)


def test_one_branch_is_one_row(library):
    rng = np.random.default_rng(6)
    geometry, target = random_legs(rng, 600), random_targets(rng, 600)
    rows, _ = library.closest(geometry, target, *asked(600))
    branch = rng.integers(-1, 5, 600).astype(np.int32)
    status = rng.integers(0, 2, 600).astype(np.int32)
    before = rng.normal(size=(600, 3))
    q, states = library.branch(geometry, target, branch, before, status)
    expected, same = closest_yaw_pitch_pitch_branch(geometry, target, branch, before, status)
    chosen = (status == UNREACHABLE) & (branch >= 0) & (branch <= 3)
    assert np.array_equal(states, status)
    assert np.array_equal(same, status)
    assert np.array_equal(q[chosen], rows[np.flatnonzero(chosen), branch[chosen]])
    assert np.array_equal(q[~chosen], before[~chosen])
    assert np.allclose(q, expected, rtol=0, atol=1e-11)


def test_counting_statuses(library):
    assert library.count_ok([0, 1, 0, 3]) == 2
    assert library.count_ok([]) == 0
    assert library.any_unreachable([0, 3, 2, 0]) == 0
    assert library.any_unreachable([0, 3, 2, 1]) == 1

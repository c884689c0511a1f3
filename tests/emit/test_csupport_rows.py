"""Choices among rows, C and NumPy, against a plain search written out joint by joint."""

import itertools
import math

import numpy as np
import pytest
from serial_library import Serial

from walkgen.runtime.solves.rows import admissible_row, nearest_row, sliding_of

OK, UNREACHABLE, BAD_INPUT, SINGULAR, NO_CONVERGENCE, DUPLICATE = 0, 1, 2, 3, 4, 6
REACHES = (OK, SINGULAR, DUPLICATE)
SEQUENCES = (2, 3, 4, 5, 8, 9, 10, 13, 15, 21)
SLOTS = 4


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return Serial(tmp_path_factory.mktemp("rows"))


@pytest.fixture(params=["c", "numpy"])
def choose(request, library):
    return (library.nearest_row, library.admissible_row) if request.param == "c" else (nearest_row, admissible_row)


def random_rows(rng, sequence, count=300):
    """Rows [count, slots, n] in (-pi, pi], some repeated, and statuses of every kind."""
    n = len(sliding_of(sequence))
    rows = rng.uniform(-np.pi, np.pi, (count, SLOTS, n))
    rows[::5, 1] = rows[::5, 0]
    states = rng.choice([OK, OK, OK, UNREACHABLE, BAD_INPUT, SINGULAR, DUPLICATE], (count, SLOTS))
    states[::7] = rng.choice([UNREACHABLE, BAD_INPUT], (len(states[::7]), SLOTS))
    rows[states == BAD_INPUT] = np.nan
    return rows, states


def random_limits(rng, n):
    limits = np.sort(rng.uniform(-2.0, 2.0, (n, 2)) + rng.choice([-np.pi, 0.0, np.pi], (n, 1)), axis=-1)
    limits[rng.random(n) < 0.3, 0] = -np.inf
    limits[rng.random(n) < 0.3, 1] = np.inf
    return limits


def plain_nearest(rows, states, seed, sliding):
    for wanted in (REACHES, (UNREACHABLE,)):
        found = [i for i in range(len(rows)) if states[i] in wanted]
        if found:
            gaps = [
                sum((g if p else math.remainder(g, 2 * math.pi)) ** 2 for g, p in zip(rows[i] - seed, sliding, strict=True)) for i in found
            ]
            best = found[int(np.argmin(gaps))]
            return rows[best], OK if states[best] == DUPLICATE else states[best]
    return np.full(len(seed), np.nan), BAD_INPUT


def plain_admissible(rows, states, limits, sliding):
    """The least distance over all rows and up to two full turns a joint; None if none fits."""
    best = (math.inf, None, None)
    (low, high), bounded = limits.T, np.isfinite(limits).all(axis=1)
    middle = np.array([sum(pair) / 2 if both else 0.0 for pair, both in zip(limits, bounded, strict=True)])
    half = np.where(bounded, (high - low) / 2, np.where(sliding, np.inf, np.pi))
    for row, state in zip(rows, states, strict=True):
        for turns in itertools.product(*[(0,) if p else (-2, -1, 0, 1, 2) for p in sliding]) if state in REACHES else ():
            q = row + 2 * np.pi * np.array(turns)
            if np.all((q >= low) & (q <= high)):
                distance = np.sum(((q - middle) / half) ** 2)
                best = min(best, (distance, tuple(q), OK if state == DUPLICATE else state), key=lambda item: item[0])
    return best


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_nearest(choose, sequence):
    rng, sliding = np.random.default_rng(sequence), sliding_of(sequence)
    rows, states = random_rows(rng, sequence)
    seed = rng.uniform(-20.0, 20.0, (len(rows), len(sliding)))
    q, status = choose[0](rows, states, seed, sequence, SLOTS)
    for i in range(len(rows)):
        expected, state = plain_nearest(rows[i], states[i], seed[i], sliding)
        assert np.array_equal(q[i], expected, equal_nan=True)
        assert status[i] == state


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_admissible(choose, sequence):
    rng, sliding = np.random.default_rng(sequence), sliding_of(sequence)
    rows, states = random_rows(rng, sequence, 100)
    limits = np.array([random_limits(rng, len(sliding)) for _ in rows])
    q, status = choose[1](rows, states, limits, sequence, SLOTS)
    for i in range(len(rows)):
        _, expected, state = plain_admissible(rows[i], states[i], limits[i], sliding)
        if np.all(states[i] == BAD_INPUT):
            assert status[i] == BAD_INPUT
            assert np.isnan(q[i]).all()
            continue
        assert np.all((q[i] >= limits[i, :, 0]) & (q[i] <= limits[i, :, 1]))
        assert status[i] == (UNREACHABLE if expected is None else state)
        if expected is not None:
            free = ~np.isfinite(limits[i]).all(axis=1) & ~sliding
            gap = q[i] - expected
            assert np.allclose(np.where(free, np.angle(np.exp(1j * gap)), gap), 0.0, rtol=0, atol=1e-13)


def test_both_sides_of_a_seam_are_near(choose):
    rows = np.array([[[3.1, 0.0], [-3.1, 0.1]]])
    q, status = choose[0](rows, [[OK, OK]], [[-3.15, 0.1]], 4, 2)
    assert np.array_equal(q, rows[:, 1])
    q, status = choose[0](rows, [[OK, DUPLICATE]], [[-3.15 + 6 * np.pi, 0.1]], 4, 2)
    assert np.array_equal(q, rows[:, 1])
    assert status == [OK]


def test_limits_ask_for_another_turn(choose):
    q, status = choose[1]([[[-1.0]]], [[SINGULAR]], [[[3.5, 6.0]]], 2, 1)
    assert q[0, 0] == pytest.approx(2 * np.pi - 1.0, abs=1e-15)
    assert status == [SINGULAR]


def test_a_rounding_outside_fits(choose):
    q, status = choose[1]([[[-1e-17, 0.5 + 1e-15]]], [[OK]], [[[0.0, 1.0], [-0.5, 0.5]]], 4, 1)
    assert np.array_equal(q, [[0.0, 0.5]])
    assert status[0] == OK


def test_clamped_where_nothing_fits(choose):
    q, status = choose[1]([[[1.0, 0.2], [0.6, 0.0]]], [[OK, OK]], [[[-0.5, 0.5], [-1.0, 1.0]]], 4, 2)
    assert np.array_equal(q, [[0.5, 0.0]])
    assert status == [UNREACHABLE]


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_bad_seeds_and_limits(choose, bad):
    rows, states = [[[0.1, 0.2]]], [[OK]]
    q, status = choose[0](rows, states, [[0.0, bad]], 4, 1)
    assert np.isnan(q).all()
    assert status == [BAD_INPUT]
    for limits in ([[-1.0, 1.0], [bad, bad]], [[1.0, -1.0], [0.0, 1.0]]):
        q, status = choose[1](rows, states, [limits], 4, 1)
        assert np.isnan(q).all()
        assert status == [BAD_INPUT]


@pytest.mark.parametrize("value", [5e-324, -0.0, 1e20, 1.7e308, -1.7e308])
def test_every_number_has_an_answer(choose, value):
    q, status = choose[0]([[[value, 0.5], [0.0, 0.5]]], [[OK, OK]], [[-value, value]], 5, 2)
    assert status == [OK]
    assert np.isfinite(q).all()
    q, status = choose[1]([[[0.3, value]]], [[OK]], [[[-1.0, 1.0], [-2.0, np.inf]]], 5, 1)
    assert status[0] == (OK if value >= -2.0 else UNREACHABLE)
    assert np.isfinite(q).all()


def test_a_row_without_numbers_is_none(choose):
    q, status = choose[0]([[[np.nan, 0.0], [1.0, 1.0]]], [[OK, NO_CONVERGENCE]], [[0.0, 0.0]], 4, 2)
    assert np.array_equal(q, [[1.0, 1.0]])
    assert status == [NO_CONVERGENCE]


@pytest.mark.parametrize("sequence", [8, 10])
def test_float(library, sequence):
    rng = np.random.default_rng(5)
    rows, states = random_rows(rng, sequence)
    rows, seed = rows.astype(np.float32), rng.uniform(-3.0, 3.0, (len(rows), 3)).astype(np.float32)
    limits = np.float32([[-1.0, 2.0], [-np.inf, np.inf], [0.0, 3.0]])
    for found, expected in (
        (library.nearest_row(rows, states, seed, sequence, SLOTS, np.float32), nearest_row(rows, states, seed, sequence, SLOTS)),
        (library.admissible_row(rows, states, limits, sequence, SLOTS, np.float32), admissible_row(rows, states, limits, sequence, SLOTS)),
    ):
        assert np.array_equal(found[1], expected[1])
        assert np.nanmax(np.abs(found[0] - expected[0])) < 2e-6


def test_rows_broadcast():
    rng = np.random.default_rng(6)
    rows, states = random_rows(rng, 8, 6)
    q, status = nearest_row(rows.reshape(3, 2, SLOTS, 3), states.reshape(3, 2, SLOTS), rng.normal(size=(5, 1, 1, 3)), 8, SLOTS)
    assert q.shape == (5, 3, 2, 3)
    assert status.shape == (5, 3, 2)
    q, status = admissible_row(rows, states, random_limits(rng, 3), 8, SLOTS)
    assert q.shape == (6, 3)
    assert status.dtype == np.int32

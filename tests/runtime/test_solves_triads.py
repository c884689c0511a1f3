"""What closes triads, on closures whose dead points are known: never on from a dead point to another assembly."""

import numpy as np
import pytest

from walkgen.runtime.solves.triads import close_triads

OK, UNREACHABLE = 0, 1


def wavy(points):
    """x + size sin(number x) / number = z and y = x / 2: from x = 0 up to the first place where its slope is 0, if there is one."""
    z, size, number, x, y = np.moveaxis(points, -1, 0)
    none = np.zeros_like(x)
    slope = 1 + size * np.cos(number * x)
    return np.stack([x + size / number * np.sin(number * x) - z, y - x / 2, slope, none, none - 0.5, none + 1], -1)


def gone(size, number, z):
    """Ways from x = 0 to every z [n, m] of the waves [n]."""
    given = np.stack(np.broadcast_arrays(z, size[:, None], number[:, None]), -1)
    return close_triads(2, given, np.concatenate([0 * given[..., :1], given[..., 1:], np.zeros((*z.shape, 2))], -1), (wavy,))


def test_no_way_leads_beyond_a_dead_point():
    random = np.random.default_rng(1)
    size, number = random.uniform(1.05, 6, 300), 10 ** random.uniform(0, 2, 300)
    turn = np.arccos(-1 / size)
    last = (turn + size * np.sin(turn)) / number
    z = last[:, None] * random.uniform(0, 20 / size[:, None], (300, 40))
    u, status = gone(size, number, z)
    before = z < last[:, None] * (1 - 1e-5)
    assert (status[before] == OK).all()
    assert (u[..., 0] < (turn / number)[:, None])[before].all()
    assert (status[z > last[:, None] * (1 + 1e-3)] == UNREACHABLE).all()
    assert 1000 < before.sum() < 11000


def test_ways_without_dead_points_are_gone():
    random = np.random.default_rng(2)
    size, number = random.uniform(0, 0.95, 100), 10 ** random.uniform(0, 1.5, 100)
    z = random.uniform(-3, 3, (100, 20))
    u, status = gone(size, number, z)
    assert (status == OK).all()
    size, number = size[:, None], number[:, None]
    assert np.abs(u[..., 0] + size / number * np.sin(number * u[..., 0]) - z).max() < 1e-12


def dipping(points):
    """x^2 = 1 - depth sin^2(pi z) and y = x / 2: there is no x around z = 1 / 2 where depth is more than 1, and x = 1 again at z = 1."""
    z, depth, x, y = np.moveaxis(points, -1, 0)
    none = np.zeros_like(x)
    return np.stack([(x**2 - 1 + depth * np.sin(np.pi * z) ** 2) / 2, y - x / 2, x, none, none - 0.5, none + 1], -1)


def test_no_way_leads_over_a_gap_to_the_same_assembly():
    """What is at both ends of a way tells nothing of a dead point between them."""
    random = np.random.default_rng(3)
    depth, z = random.uniform(0.5, 3, 2000), np.concatenate([random.uniform(0.6, 1.4, 1600), np.ones(400)])
    start = np.stack([np.zeros(2000), depth, np.ones(2000), np.full(2000, 0.5)], -1)
    u, status = close_triads(2, np.stack([z, depth], -1), start, (dipping,))
    there = depth < 1
    assert np.array_equal(status == OK, there)
    assert u[there, 0] ** 2 == pytest.approx(1 - depth[there] * np.sin(np.pi * z[there]) ** 2, abs=1e-9)

"""What closes triads, on closures whose dead points are known: never on from a dead point to another assembly."""

import numpy as np

from walkgen.runtime.solves.triads import close_triads

OK, UNREACHABLE = 0, 1


def wavy(size, number):
    """x + size sin(number x) / number = z and y = x / 2: from x = 0 up to the first place where its slope is 0, if there is one."""

    def closure(points):
        z, x, y = np.moveaxis(points, -1, 0)
        none = np.zeros_like(x)
        slope = 1 + size * np.cos(number * x)
        return np.stack([x + size / number * np.sin(number * x) - z, y - x / 2, slope, none, none - 0.5, none + 1], -1)

    return closure


def test_no_way_leads_beyond_a_dead_point():
    random, reached = np.random.default_rng(1), 0
    for size, number in zip(random.uniform(1.05, 6, 300), 10 ** random.uniform(0, 2, 300), strict=True):
        turn = np.arccos(-1 / size)
        last = (turn + size * np.sin(turn)) / number
        z = last * random.uniform(0, 20 / size, 40)
        u, status = close_triads(2, z[:, None], np.zeros(3), (wavy(size, number),))
        before = z < last * (1 - 1e-5)
        assert (status[before] == OK).all()
        assert (u[before, 0] < turn / number).all()
        assert (status[z > last * (1 + 1e-3)] == UNREACHABLE).all()
        reached += before.sum()
    assert 1000 < reached < 11000


def test_ways_without_dead_points_are_gone():
    random = np.random.default_rng(2)
    for size, number in zip(random.uniform(0, 0.95, 100), 10 ** random.uniform(0, 1.5, 100), strict=True):
        z = random.uniform(-3, 3, 20)
        u, status = close_triads(2, z[:, None], np.zeros(3), (wavy(size, number),))
        assert (status == OK).all()
        assert np.abs(u[:, 0] + size / number * np.sin(number * u[:, 0]) - z).max() < 1e-12

"""Surfaces that are nowhere over the ground, nowhere regular or nowhere defined: code all the same, NaN and -1 where there is nothing."""

import numpy as np

from terrain.grounds import explicit, spec

STRIP = "domain = {{ x = [{0}, {0}.5] }}"
PATCHES = (
    f'surface = "implicit"\nf = "x - 1"\n{STRIP.format(0)}',
    f'surface = "implicit"\nf = "z - z + 3"\n{STRIP.format(1)}',
    f'surface = "implicit"\nf = "z**3"\n{STRIP.format(2)}',
    explicit("x/sin(pi)", STRIP.format(3)),
    explicit("sqrt(x - 4.25)", STRIP.format(4)),
    'surface = "parametric"\nx = "5 + u"\ny = "u"\nz = "v"\ndomain = { u = [0, 1], v = [0, 1] }',
    'surface = "parametric"\nx = "7"\ny = "8"\nz = "9"\ndomain = { u = [0, 1], v = [0, 1] }',
)


def test_degenerate_surfaces(built) -> None:
    robot = built(spec(*PATCHES))
    p = np.array([[0.2, 0, 0], [1.2, 0, 0], [2.2, 0, 0.1], [3.2, 0, 0], [4.1, 0, 0], [4.4, 0, 0], [7, 9, 0], [np.nan, 0, 0]])
    for backend in ("c", "numpy"):
        ground = getattr(robot, backend).terrain
        assert ground.patch(p)[:2].tolist() == [-1, -1]
        assert ground.patch(p)[3:].tolist() == [3, 4, 4, -1, -1]
        height = ground.height(p)
        assert np.isnan(height[[0, 1, 4, 6, 7]]).all()
        assert abs(height[5] - np.sqrt(0.15)) < 1e-12
        foot, status = ground.project(p)
        assert np.isfinite(foot[status == 0]).all()
        assert status[[0, 1, 6, 7]].tolist() == [1, 1, 1, 2]

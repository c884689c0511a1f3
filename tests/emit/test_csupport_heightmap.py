"""walkgen_heightmap.h alone: NumPy's reference on random maps in double and float, strict flags as C and C++, sanitizers on any input."""

import ctypes
import subprocess

import numpy as np
import pytest
from csupport_library import STRICT, compile_c

from walkgen.runtime.solves.heightmap import heightmap, heightmap_project

_INCLUDES = """
#include "walkgen_real_f64.h"
#include "walkgen_heightmap.h"
#include "walkgen_real_f32.h"
#include "walkgen_heightmap.h"
#include "walkgen_heightmap.h"
"""
_LOOPS = """
void jets@(int n, const REAL *heights, int rows, int columns, int bicubic, const REAL *grid, const REAL *p, REAL *jet);
void jets@(int n, const REAL *heights, int rows, int columns, int bicubic, const REAL *grid, const REAL *p, REAL *jet) {
    for (int i = 0; i < n; ++i) wg_heightmap@(heights, rows, columns, bicubic, grid, p + 3 * i, jet + 6 * i);
}
void feet@(int n, const REAL *heights, int rows, int columns, int bicubic, const REAL *grid, const REAL *p, REAL *foot, int32_t *status);
void feet@(int n, const REAL *heights, int rows, int columns, int bicubic, const REAL *grid, const REAL *p, REAL *foot, int32_t *status) {
    for (int i = 0; i < n; ++i) wg_heightmap_project@(heights, rows, columns, bicubic, grid, p + 3 * i, foot + 3 * i, status + i);
}
"""
SOURCE = _INCLUDES + _LOOPS.replace("@", "").replace("REAL", "double") + _LOOPS.replace("@", "_f32").replace("REAL", "float")
_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.0, -0.0, 5e-324, 1e-160, 0.35, -0.4, 1.0, 2.9, 3.0, -1.0, 1e20, -1e160, 1.7e308, NAN, INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
int main(void) {
    uint32_t seed = 1u;
    int bad = 0;
    for (int run = 0; run < 40000; ++run) {
        double number[18], jet[6], foot[3];
        float single[18], jet_single[6], foot_single[3];
        int32_t status;
        const int rows = 2 + run % 3, columns = 2 + run / 3 % 3;
        for (int i = 0; i < 18; ++i) {
            seed = seed * 1664525u + 1013904223u;
            number[i] = VALUES[(seed >> 16) % (run % 2 ? COUNT - 5 : COUNT)];
            single[i] = number[i] > 3e38 || number[i] < -3e38 ? INFINITY : (float)number[i];
        }
        jets(1, number, rows > 3 && columns > 3 ? 3 : rows, columns, run % 2, number + 12, number + 15, jet);
        feet(1, number, rows > 3 && columns > 3 ? 3 : rows, columns, run % 2, number + 12, number + 15, foot, &status);
        bad += status == WALKGEN_OK && !(isfinite(foot[0]) && isfinite(foot[1]) && isfinite(foot[2]));
        jets_f32(1, single, 2, columns, run % 2, single + 12, single + 15, jet_single);
        feet_f32(1, single, 2, columns, run % 2, single + 12, single + 15, foot_single, &status);
        bad += status == WALKGEN_OK && !(isfinite(foot_single[0]) && isfinite(foot_single[1]) && isfinite(foot_single[2]));
    }
    printf("%d", bad);
    return 0;
}
"""
SHAPES = ((2, 2), (2, 3), (3, 2), (5, 7), (9, 4))


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return ctypes.CDLL(
        str(compile_c(tmp_path_factory.mktemp("heightmap"), SOURCE, "map.so", "-std=c99", "-O2", "-shared", "-fPIC", *STRICT))
    )


def called(library, name, heights, shape, bicubic, grid, p, width, dtype=np.float64):
    inputs = [np.array(values, dtype, order="C") for values in (heights, grid, p)]
    out, status = np.empty((len(p), width), dtype), np.empty(len(p), np.int32)
    h, g, points, result, states = (array.ctypes.data_as(ctypes.c_void_p) for array in (*inputs, out, status))
    last = (states,) if name == "feet" else ()
    getattr(library, name + ("_f32" if dtype == np.float32 else ""))(len(p), h, *shape, bicubic, g, points, result, *last)
    return (out, status) if last else out


def case(shape, seed=0):
    rng = np.random.default_rng(seed)
    grid = np.array([0.1, -0.3, 0.25])
    reach = 0.25 * (np.array(shape[::-1]) - 1)
    p = np.concatenate([grid[:2], [0]]) + rng.uniform(0, 1, (60, 3)) * [*reach, 1]
    return rng.normal(size=shape[0] * shape[1]) / 10, grid, p


@pytest.mark.parametrize("bicubic", [0, 1])
@pytest.mark.parametrize("shape", SHAPES)
def test_heights_and_derivatives_are_the_references(library, shape, bicubic):
    heights, grid, p = case(shape)
    p[:2, 0] = np.nan, np.inf
    p[2, :2] = grid[:2] + 0.25 * (np.array(shape[::-1]) - 1)
    p[3:10, :2] += 0.2  # a little beyond the edge, too
    expected = heightmap(heights, *shape, bicubic, grid, p)
    assert np.isnan(expected[:2]).all()
    np.testing.assert_allclose(called(library, "jets", heights, shape, bicubic, grid, p, 6), expected, rtol=1e-11, atol=1e-11)
    single = called(library, "jets", heights, shape, bicubic, grid, p, 6, np.float32)
    np.testing.assert_allclose(single, expected, rtol=1e-3, atol=2e-3)


@pytest.mark.parametrize("bicubic", [0, 1])
@pytest.mark.parametrize("shape", SHAPES[2:4])
def test_nearest_points_are_the_references(library, shape, bicubic):
    heights, grid, p = case(shape, 1)
    p[0, 2] = np.inf
    feet, states = heightmap_project(heights, *shape, bicubic, grid, p)
    found, status = called(library, "feet", heights, shape, bicubic, grid, p, 3)
    assert status[0] == states[0] == 2
    assert np.array_equal(status, states)
    np.testing.assert_allclose(found, feet, atol=1e-7)
    assert np.all(status[1:] == 0) if bicubic else set(status[1:].tolist()) <= {0, 4}


@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, standard, compiler):
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, "-O3", "-c", *STRICT, compiler=compiler).exists()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, SOURCE + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"

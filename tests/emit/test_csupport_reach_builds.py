"""The headers of the inverse of chains under the strict flags, as C++, with sanitizers on any input, and in float."""

import subprocess

import numpy as np
import pytest
from csupport_library import STRICT, compile_c
from serial_library import FREE, REACH_SOURCE, Reaching, poses, random_arm, random_limits, random_values, sequence_of

OK, UNREACHABLE, BAD_INPUT, SINGULAR = range(4)
_FLOAT_ONLY = """
#include "walkgen_real_f32.h"
#include "walkgen_reach.h"
#include "walkgen_within.h"
void all(const float *geometry, const float *T, const float *limits, float *q, int32_t *status);
void all(const float *geometry, const float *T, const float *limits, float *q, int32_t *status) {
    wg_inverse_pose_f32(geometry, T, q + 6, limits, 64, q, status);
    wg_inverse_reach_f32(geometry, T, q + 6, limits, 64, q, status);
    wg_closest_within_f32(geometry, T, limits, 64, q, status);
}
"""
_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.0, -0.0, 1.0, -1.0, 0.35, 0.6, -0.8, /* and rarer ones: */
                                5e-324, 1e-160, 1e-9, -0.4, 3.0, 1e20, -1e160, 1.7e308, NAN, INFINITY, -INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0], MOST = 16 };
static uint32_t seed = 1u;
static void draw(int count, int kinds, double *values, float *singles) {
    for (int i = 0; i < count; ++i) {
        seed = seed * 1664525u + 1013904223u;
        values[i] = VALUES[(seed >> 16) % (uint32_t)kinds];
        singles[i] = values[i] > 3e38 ? INFINITY : values[i] < -3e38 ? -INFINITY : (float)values[i];
    }
}
static int bad_row(int n, const double *q, int32_t status) {
    int bad = status < WALKGEN_OK || status > WALKGEN_NO_CONVERGENCE;
    for (int j = 0; j < n; ++j) bad |= status == WALKGEN_BAD_INPUT ? !isnan(q[j]) : !isfinite(q[j]);
    return bad;
}
static int bad_row_f32(int n, const float *q, int32_t status) {
    double wide[MOST];
    for (int j = 0; j < n; ++j) wide[j] = q[j];
    return bad_row(n, wide, status);
}
int main(void) {
    static const double turns[][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 1, 0, -1, 0, 1, 0, 0}};
    int bad = 0;
    for (int run = 0; run < 200; ++run) {
        const int n = run % 40 == 0 ? MOST : 1 + run % 7, sequence = (1 << n) + (int)(seed >> 8) % (1 << n);
        const int rare = run % 3 == 0 ? COUNT : 7;
        double geometry[6 * MOST + 12], T[16], start[MOST], limits[2 * MOST], q[MOST];
        float geometry_f[6 * MOST + 12], T_f[16], start_f[MOST], limits_f[2 * MOST], q_f[MOST];
        int32_t status;
        draw(6 * n + 12, rare, geometry, geometry_f);
        draw(16, rare, T, T_f);
        draw(n, rare, start, start_f);
        draw(2 * n, COUNT, limits, limits_f);
        for (int i = 0; i < 9 && run % 2; ++i) {
            geometry[6 * n + 3 + i] = turns[run % 3][i];
            T[i + i / 3] = turns[run / 2 % 3][i];
            T[12 + i % 4] = i % 4 == 3;
        }
        for (int i = 0; i < 9 && run % 2; ++i) {
            geometry_f[6 * n + 3 + i] = (float)geometry[6 * n + 3 + i];
            T_f[i + i / 3] = (float)T[i + i / 3];
            T_f[12 + i % 4] = (float)T[12 + i % 4];
        }
        for (int i = 0; i < 2 * n && run % 5; ++i) limits[i] = i % 2 ? 0.9 : -0.8, limits_f[i] = (float)limits[i];
        pose_rows(1, n, sequence, geometry, T, start, limits, q, &status);
        bad += bad_row(n, q, status);
        pose_rows_f32(1, n, sequence, geometry_f, T_f, start_f, limits_f, q_f, &status);
        bad += bad_row_f32(n, q_f, status);
        reach_rows(1, n, sequence, geometry, T, start, limits, q, &status);
        bad += bad_row(n, q, status);
        reach_rows_f32(1, n, sequence, geometry_f, T_f, start_f, limits_f, q_f, &status);
        bad += bad_row_f32(n, q_f, status);
        for (int j = 0; j < n; ++j) q[j] = start[j], q_f[j] = start_f[j];
        status = WALKGEN_UNREACHABLE;
        within_rows(1, n, sequence, geometry, T, limits, q, &status);
        bad += bad_row(n, q, status);
        status = WALKGEN_UNREACHABLE;
        within_rows_f32(1, n, sequence, geometry_f, T_f, limits_f, q_f, &status);
        bad += bad_row_f32(n, q_f, status);
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.mark.parametrize(
    ("standard", "compiler", "level"),
    [("-std=c99", "gcc", "-O0"), pytest.param("-std=c++11", "g++", "-O1", marks=pytest.mark.nightly)],
)
def test_strict_flags(tmp_path, standard, compiler, level):
    assert compile_c(tmp_path, REACH_SOURCE, "strict.o", standard, level, "-c", *STRICT, compiler=compiler).exists()


def test_float_needs_no_double_helper(tmp_path):
    library = compile_c(tmp_path, _FLOAT_ONLY, "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert {"ldexpf", "frexpf", "remainderf"} <= functions
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, REACH_SOURCE + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"


def test_in_float(tmp_path):
    solver, rng = Reaching(tmp_path), np.random.default_rng(1)
    for n in (3, 4, 6, 7):
        kinds, geometry = random_arm(rng, n)
        made = random_values(rng, kinds, 50)
        T, seed = poses(geometry, kinds, made), made + rng.uniform(-0.3, 0.3, made.shape)
        q, status = solver.inverse_pose(geometry, T, seed, FREE * np.ones((n, 1)), sequence_of(kinds), np.float32)
        assert np.isin(status, (OK, SINGULAR)).all()
        np.testing.assert_allclose(poses(geometry, kinds, q.astype(float)), T, atol=1e-5)
        q, status = solver.inverse_reach(geometry[:-9], T[:, :3, 3], seed, FREE * np.ones((n, 1)), sequence_of(kinds), np.float32)
        assert np.isin(status, (OK, SINGULAR)).all()
        np.testing.assert_allclose(poses(geometry, kinds, q.astype(float))[:, :3, 3], T[:, :3, 3], atol=1e-5)
        limits = random_limits(rng, kinds, 50).astype(np.float32)
        q, status = solver.closest_within(
            geometry[:-9], T[:, :3, 3], limits, sequence_of(kinds), limits.mean(axis=-1), UNREACHABLE, np.float32
        )
        assert np.isin(status, (OK, UNREACHABLE)).all()
        assert ((q >= limits[..., 0]) & (q <= limits[..., 1])).all()

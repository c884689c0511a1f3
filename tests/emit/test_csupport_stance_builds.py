"""The headers of stances under the strict flags, as C++, alone, with sanitizers on any input, without double helpers in float."""

import subprocess

import pytest
from csupport_library import STRICT, compile_c
from stance_library import HEADERS, stance_source

_DRIVER = """
#include <stdio.h>
#include <string.h>
static const double VALUES[] = {0.3, -0.5, 1.0, -1.0, 0.0, 3.0, /* and rarer ones: */
                                -0.0, 5e-324, 1e-160, 1e-9, 1e20, -1e160, 1.7e308, NAN, INFINITY, -INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0], POINTS = 0, NORMALS = 48, LOAD = 96, MU = 102, SIZE = 118 };
static uint32_t seed = 1u;
static uint32_t drawn(uint32_t below) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 16) % below;
}
static void bowl(const double *point, double *surface, const void *data) {
    const double away = sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2]);
    surface[0] = 1.0 - away;
    surface[1] = -point[0] / away;
    surface[2] = -point[1] / away;
    surface[3] = -point[2] / away;
    surface[4] = *(const double *)data;
}
static int told(const double *values, int count, int32_t status) {
    int fine = 1;
    for (int i = 0; i < count; ++i)
        fine = fine && isfinite(values[i]);
    return status != WALKGEN_OK || fine;
}
static int told_f32(const float *values, int count, int32_t status) {
    int fine = 1;
    for (int i = 0; i < count; ++i)
        fine = fine && isfinite(values[i]);
    return status != WALKGEN_OK || fine;
}
#define CALLS(S, REAL)                                                                                                         \\
    static int calls##S(int k, const REAL *x) {                                                                                \\
        REAL G[6 * 48], out[6 * 48], twist[6], single[4];                                                                      \\
        int32_t status, state[16], rank;                                                                                       \\
        int fine = 1;                                                                                                          \\
        wg_grasp##S(k, x + POINTS, G, out, out + 6, single, &rank, &status);                                                   \\
        fine = fine && told##S(out, 6, status);                                                                                \\
        wg_contact_vertical##S(k, x + POINTS, x + NORMALS, x + LOAD, out, &status, state, single);                             \\
        fine = fine && told##S(out, k == 3 ? 9 : 0, status);                                                                   \\
        wg_friction_needed##S(k, x + POINTS, x + NORMALS, x + LOAD, single, out, twist, &status);                              \\
        fine = fine && told##S(single, 1, status) && told##S(twist, 6, status);                                                \\
        wg_load_margin##S(k, x + POINTS, x + NORMALS, x + MU, x + LOAD, x + LOAD, single, single + 1, &status);                \\
        fine = fine && (status != WALKGEN_OK || !(isnan(single[0]) || isnan(single[1]))); /* infinite where told so */         \\
        wg_foot_admissible##S(k, x + POINTS, x + NORMALS, x + MU, x + LOAD, k - 1, x, x + NORMALS, single, &status);           \\
        fine = fine && told##S(single, 1, status);                                                                             \\
        wg_slip##S(k, x + POINTS, x + NORMALS, x + LOAD, out, out + 9, twist, single, out + 18, single + 1, &status);          \\
        return fine && told##S(out, k == 3 ? 24 : 0, status) && told##S(twist, 6, status);                                     \\
    }
CALLS(, double)
CALLS(_f32, float)
int main(void) {
    int bad = 0;
    for (int run = 0; run < 50; ++run) {
        double x[SIZE], start[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -0.95, 0, 0, 0, 1}, pose[16], N[3], path[16 * 11], mu = 0.05;
        float single[SIZE];
        int32_t steps, status;
        const int k = run % 7 == 0 ? (int)drawn(19) - 1 : run % 2 ? 3 : 3 + (int)drawn(4);
        for (int i = 0; i < SIZE; ++i)
            x[i] = i < NORMALS ? (double)drawn(1000) / 1000.0 - 0.5 : i < LOAD ? (double)(i % 3 == 2) : i < MU ? -(double)drawn(100) : 0.4;
        for (int i = 0; i < run % 4; ++i)
            x[drawn(SIZE)] = VALUES[drawn(run % 3 ? 6 : COUNT)];
        for (int i = 0; i < SIZE; ++i)
            single[i] = x[i] > 3e38 ? INFINITY : x[i] < -3e38 ? -INFINITY : (float)x[i];
        bad += !calls(k, x) + !calls_f32(k, single);
        for (int i = 0; i < run % 3; ++i)
            start[drawn(12)] = VALUES[drawn(COUNT)];
        if (run % 10 == 0) {
            const int32_t feet[3] = {(int32_t)drawn(5) - 1, 1, 2};
            const int32_t room = (int32_t)drawn(11);
            wg_settle(4, x, feet, x + LOAD, x + LOAD, x + LOAD, start, bowl, &mu, 0.05, 10, room, pose, N, path, &steps, &status);
            bad += !told(pose, 16, status) || !told(N, 3, status);
        }
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.mark.nightly
def test_strict_flags_as_cpp(tmp_path):
    """As C99 the library of the other tests is built with them."""
    assert compile_c(tmp_path, stance_source(), "strict.o", "-std=c++11", "-O1", "-c", *STRICT, compiler="g++").exists()


@pytest.mark.parametrize("header", HEADERS)
def test_a_header_stands_alone(tmp_path, header):
    for bits in ("f64", "f32"):
        text = f'#include "walkgen_real_{bits}.h"\n#include "{header}"\nint nothing(void);\nint nothing(void) {{ return 0; }}\n'
        assert compile_c(tmp_path, text, "alone.o", "-std=c99", "-O0", "-c", *STRICT, "-Wno-unused-function").exists()


def test_float_needs_no_double_helper(tmp_path):
    text = stance_source()
    single = text[text.index('#include "walkgen_real_f32.h"') :]
    single = single[: single.index("\nvoid grasp(")] + single[single.index("\nvoid grasp_f32(") :]
    library = compile_c(tmp_path, single, "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert "sqrtf" in functions
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, stance_source() + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"

"""The headers of static stability and tipping under the strict flags, as C++, alone, with sanitizers on any input, in float alone."""

import re
import subprocess

import pytest
from csupport_library import CSUPPORT, STRICT, compile_c
from stability_library import HEADERS, stability_source

ALL = (*HEADERS, "walkgen_tipping.h")
_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.3, -0.5, 1.0, -1.0, 0.0, 3.0, /* and rarer ones: */
                                -0.0, 5e-324, 1e-160, 1e-9, 1e20, -1e160, 1.7e308, NAN, INFINITY, -INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
enum { POINTS = 0, NORMALS = 48, MU = 96, COM = 112, AHEAD = 115, GRAVITY = 118, OWN = 121, SIZE = 125 };
static uint32_t seed = 1u;
static uint32_t drawn(uint32_t below) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 16) % below;
}
#define CALLS(S, REAL)                                                                                                         \\
    static int finite##S(const REAL *values, int count, int32_t status) {                                                      \\
        int i, fine = 1;                                                                                                       \\
        for (i = 0; i < count; ++i)                                                                                            \\
            fine = fine && values[i] - values[i] == values[i] - values[i];                                                     \\
        return status != WALKGEN_OK || fine;                                                                                   \\
    }                                                                                                                          \\
    static int calls##S(int k, const REAL *x) {                                                                                \\
        REAL out[200], heights[16], single[5], pair[6];                                                                        \\
        int32_t polygon[16], vertices, edge[2], status;                                                                        \\
        int fine = 1, kind;                                                                                                    \\
        for (kind = 0; kind < 2; ++kind) {                                                                                     \\
            REAL mu[16];                                                                                                       \\
            int i;                                                                                                             \\
            for (i = 0; i < 16; ++i)                                                                                           \\
                mu[i] = kind ? (REAL)INFINITY : x[MU + i];                                                                     \\
            wg_stability_margins##S(k, x, x + COM, x + AHEAD, mu, x + NORMALS, x + GRAVITY, x[OWN + 3], x + OWN, single, pair, \\
                                    single + 1, single + 2, single + 3, polygon, &vertices, edge, heights, &status);           \\
            fine = fine && finite##S(single, 3, status) && finite##S(pair, 2, status);                                         \\
            fine = fine && (status != WALKGEN_OK || single[3] == single[3]); /* infinite where no way out is closed */         \\
            wg_stability_margins_d_com##S(k, x, x + COM, x + AHEAD, mu, x + NORMALS, x + GRAVITY, x[OWN + 3], x + OWN, out,    \\
                                          out + 3, out + 9, out + 12, out + 15, &status);                                      \\
            fine = fine && finite##S(out, 18, status);                                                                         \\
        }                                                                                                                      \\
        wg_feasible_region##S(k, x, x + MU, x + NORMALS, x + GRAVITY, x + OWN, x[AHEAD] * x[AHEAD], out, &vertices, single, &status); \\
        fine = fine && finite##S(out, 192, status) && finite##S(single, 1, status);                                            \\
        wg_disturbance_margin##S(k, x, x + COM, x + MU, x + AHEAD, x + NORMALS, x + GRAVITY, x[OWN + 3], x + OWN, single, out, &status); \\
        fine = fine && finite##S(out, 3, status) && (status != WALKGEN_OK || single[0] == single[0]);                          \\
        wg_tipping_time##S(x[0] * x[0], x[1], x[2], x[3] * x[3], single, &status);                                             \\
        fine = fine && finite##S(single, 1, status);                                                                           \\
        wg_tipping_tilt##S(x[0] * x[0], x[1], x[2], x[3] * x[3], single, single + 1, &status);                                 \\
        fine = fine && finite##S(single, 2, status);                                                                           \\
        wg_tipping_speed_limit##S(x[4], x[0] * x[0], x[1], x[2], x[3] * x[3], single, &status);                                \\
        return fine && finite##S(single, 1, status);                                                                           \\
    }
CALLS(, double)
CALLS(_f32, float)
int main(void) {
    int bad = 0;
    for (int run = 0; run < 40; ++run) {
        double x[SIZE];
        float single[SIZE];
        const int k = run % 7 == 0 ? (int)drawn(19) - 1 : 2 + (int)drawn(5);
        for (int i = 0; i < SIZE; ++i)
            x[i] = i < NORMALS || i >= COM ? (double)drawn(1000) / 1000.0 - 0.5 : i < MU ? (double)(i % 3 == 2) : 0.4;
        x[GRAVITY + 2] = -9.0;
        x[OWN + 3] = 3.0;
        for (int i = 0; i < run % 4; ++i)
            x[drawn(SIZE)] = VALUES[drawn(run % 3 ? 6 : COUNT)];
        for (int i = 0; i < SIZE; ++i)
            single[i] = x[i] > 3e38 ? INFINITY : x[i] < -3e38 ? -INFINITY : (float)x[i];
        if (!calls(k, x)) { ++bad; printf("double %d\\n", run); }
        if (!calls_f32(k, single)) { ++bad; printf("float %d\\n", run); }
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.mark.nightly
def test_strict_flags_as_cpp(tmp_path):
    """As C99 the library of the other tests is built with them."""
    text = stability_source().replace('#include "walkgen_stability.h"', '#include "walkgen_stability.h"\n#include "walkgen_tipping.h"')
    assert compile_c(tmp_path, text, "strict.o", "-std=c++11", "-O0", "-c", *STRICT, "-Wno-unused-function", compiler="g++").exists()


def test_a_header_stands_alone(tmp_path):
    for header in ALL:
        for bits in ("f64", "f32"):
            text = f'#include "walkgen_real_{bits}.h"\n#include "{header}"\nint nothing(void);\nint nothing(void) {{ return 0; }}\n'
            assert compile_c(tmp_path, text, "alone.o", "-std=c99", "-O0", "-c", *STRICT, "-Wno-unused-function").exists()


def test_float_needs_no_double_helper(tmp_path):
    calls = "".join(f'#include "{header}"\n' for header in ALL) + "void *all(int i);\nvoid *all(int i) {\n"
    margins = ("wg_stability_margins", "wg_stability_margins_d_com", "wg_feasible_region", "wg_disturbance_margin")
    routines = (*margins, "wg_tipping_tilt", "wg_tipping_speed_limit")
    calls += "".join(f"    if (i == {i}) return (void *)(size_t){name}_f32;\n" for i, name in enumerate(routines))
    text = f'#include "walkgen_real_f32.h"\n{calls}    return 0;\n}}\n'
    library = compile_c(tmp_path, text, "single.o", "-std=c99", "-O1", "-c", "-Wdouble-promotion", "-Werror")
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert "sqrtf" in functions
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    headers = "".join(f'#include "walkgen_real_{tag}.h"\n' + "".join(f'#include "{name}"\n' for name in ALL) for tag in ("f64", "f32"))
    flags = ("-std=c99", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, headers + _DRIVER, "driver", *flags, "-Wno-unused-function")
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["stability_margins", "stability_margins_d_com", "feasible_region", "disturbance_margin"])
@pytest.mark.parametrize(("bits", "suffix", "place"), [("f64", "", 0), ("f32", "_f32", 1)])
def test_stack_is_what_the_header_says(tmp_path, name, bits, suffix, place):
    """Not more than the frames of all functions together, as none calls itself."""
    stated = re.search(r"t most (\d+) kB of stack in double, (\d+) kB in float", (CSUPPORT / "walkgen_stability.h").read_text()).groups()
    headers = f'#include "walkgen_real_{bits}.h"\n#include "walkgen_stability.h"\n'
    text = f"{headers}void *one(void);\nvoid *one(void) {{ return (void *)(size_t)wg_{name}{suffix}; }}\n"
    compile_c(tmp_path, text, "stack.o", "-std=c99", "-O2", "-c", "-fstack-usage", *STRICT, "-Wno-unused-function", "-Wno-pedantic")
    frames = [int(line.split("\t")[1]) for line in (tmp_path / "stack.su").read_text().splitlines()]
    assert 0.8 * 1000 * int(stated[place]) <= sum(frames) <= 1000 * int(stated[place])

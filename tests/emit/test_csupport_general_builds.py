"""The general inverse's headers under the strict flags, as C++, with sanitizers, and without double helpers in float."""

import subprocess

import pytest
from csupport_library import STRICT, compile_c
from general_library import GENERAL, QUARTIC, source

_SOURCE = source(GENERAL + QUARTIC, "walkgen_inverse_general.h")
_FLOAT_ONLY = """
#include "walkgen_real_f32.h"
#include "walkgen_inverse_general.h"
void all(const float *geometry, const float *p, float *q, int32_t *status);
void all(const float *geometry, const float *p, float *q, int32_t *status) { wg_inverse_general_f32(geometry, p, 8, q, status); }
"""
_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.0, -0.0, 1.0, -1.0, 0.35, 0.6, /* and rarer ones: */
                                5e-324, 1e-160, 1e-9, -0.4, 0.8, 3.0, 1e20, -1e160, 1.7e308, NAN, INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
int main(void) {
    uint32_t seed = 1u;
    int bad = 0;
    for (int run = 0; run < 3000; ++run) {
        const int sequence = 2 + run % 14, joints = sequence > 7 ? 3 : sequence > 3 ? 2 : 1;
        double number[24], q[12];
        float single[24], q_single[12];
        int32_t status[4];
        for (int i = 0; i < 24; ++i) {
            seed = seed * 1664525u + 1013904223u;
            number[i] = VALUES[(seed >> 16) % (run % 3 ? 6 : COUNT)];
            single[i] = number[i] > 3e38 || number[i] < -3e38 ? INFINITY : (float)number[i];
        }
        general_rows(1, sequence, 6 * joints + 3, number, number + 21, q, status);
        for (int i = 0; i < wg_slots_of(sequence); ++i)
            bad += status[i] == WALKGEN_OK && !isfinite(q[joints * i]);
        general_rows_f32(1, sequence, 6 * joints + 3, single, single + 21, q_single, status);
        for (int i = 0; i < wg_slots_of_f32(sequence); ++i)
            bad += status[i] == WALKGEN_OK && !isfinite(q_single[joints * i]);
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.mark.parametrize("level", ["-O0", pytest.param("-O3", marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, level, standard, compiler):
    assert compile_c(tmp_path, _SOURCE, "strict.o", standard, level, "-c", *STRICT, compiler=compiler).exists()


def test_float_needs_no_double_helper(tmp_path):
    library = compile_c(tmp_path, _FLOAT_ONLY, "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert {"ldexpf", "frexpf"} <= functions
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, _SOURCE + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"

"""The support routines under the strict flags, as C++, with sanitizers, and without double helpers in float."""

import subprocess

import pytest
from csupport_library import SOURCE, STRICT, compile_c

_FLOAT_ONLY = """
#include "walkgen_real_f32.h"
#include "walkgen_inverse.h"
#include "walkgen_damped.h"
void closest(const float *geometry, const float *target, float *q, int32_t *status);
void closest(const float *geometry, const float *target, float *q, int32_t *status) {
    wg_closest_yaw_pitch_pitch_f32(geometry, target, q, status);
}
void damped(const float *J, const float *v, float *qd, int32_t *status);
void damped(const float *J, const float *v, float *qd, int32_t *status) { wg_damped_inverse_3_f32(J, v, 0.1f, 0.1f, qd, status); }
"""
_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.0, -0.0, 5e-324, 1e-160, 1e-9, 0.35, -0.4, 1.0, -1.0, 3.0, 1e20, -1e160, 1.7e308, NAN, INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
int main(void) {
    uint32_t seed = 1u;
    int bad = 0;
    for (int run = 0; run < 60000; ++run) {
        double number[14], q[12] = {0}, qd[3];
        float single[14], q_single[12] = {0}, qd_single[3];
        int32_t status[4] = {1, 1, 1, 1}, state;
        for (int i = 0; i < 14; ++i) {
            seed = seed * 1664525u + 1013904223u;
            number[i] = VALUES[(seed >> 16) % (i < 10 && run % 2 ? COUNT - 6 : COUNT)];
            single[i] = number[i] > 3e38 || number[i] < -3e38 ? INFINITY : (float)number[i];
        }
        closest_rows(1, number, number + 10, q, status);
        closest_rows_f32(1, single, single + 10, q_single, status);
        damped_rows(1, number, number + 9, number + 12, qd, &state);
        bad += state == WALKGEN_OK && !(isfinite(qd[0]) && isfinite(qd[1]) && isfinite(qd[2]));
        damped_rows_f32(1, single, single + 9, single + 12, qd_single, &state);
        bad += state == WALKGEN_OK && !(isfinite(qd_single[0]) && isfinite(qd_single[1]) && isfinite(qd_single[2]));
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.mark.parametrize("level", ["-O0", pytest.param("-O3", marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, level, standard, compiler):
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, level, "-c", *STRICT, compiler=compiler).exists()


def test_float_needs_no_double_helper(tmp_path):
    library = compile_c(tmp_path, _FLOAT_ONLY, "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name not in {"U", "_GLOBAL_OFFSET_TABLE_"}}
    assert {"atan2f", "cbrtf", "hypotf"} <= functions
    assert {name for name in functions if not name.endswith("f")} == set()


def test_no_symbol_of_its_own(tmp_path):
    headers = '#include "walkgen_real_f64.h"\n#include "walkgen_inverse.h"\n#include "walkgen_damped.h"\nint nothing;\n'
    library = compile_c(tmp_path, headers, "headers.o", "-std=c99", "-O2", "-c", *STRICT)
    listed = subprocess.run(["nm", str(library)], capture_output=True, text=True, check=True).stdout
    assert [line.split()[-1] for line in listed.splitlines()] == ["nothing"]


_CALLERS = """
#include "walkgen_real_f64.h"
#include "walkgen_inverse.h"
#include "walkgen_damped_general.h"
void legs(const double *J, const double *v, double *qd, int32_t *status) { wg_damped_inverse(J, v, 3, 0.1, 0.1, qd, status); }
void routes(const double *J, const double *v, double *qd, int32_t *status) { wg_damped_inverse(J, v, 6, 0.1, 0.1, qd, status); }
void left(const double *geometry, const double *p, double *q, int32_t *status) { wg_closest_yaw_pitch_pitch(geometry, p, q, status); }
void one(const double *geometry, const double *p, double *q, int32_t *status) {
    wg_closest_yaw_pitch_pitch_branch(geometry, p, 1, q, status);
}
"""


def test_long_routines_are_compiled_once_for_all_callers(tmp_path):
    library = compile_c(tmp_path, _CALLERS, "callers.o", "-std=c99", "-O1", "-c")
    listed = subprocess.run(["nm", str(library)], capture_output=True, text=True, check=True).stdout.split()
    assert {"wg_damped_inverse", "wg_closest_yaw_pitch_pitch"} <= {name.split(".")[0] for name in listed}


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, SOURCE + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"

"""walkgen_gait.h alone: NumPy's reference on random gaits in double and float, strict flags as C and C++, sanitizers on any input."""

import ctypes
import subprocess

import numpy as np
import pytest
from csupport_library import STRICT, compile_c

from walkgen.runtime.solves.gait import gait_next_event, gait_phase, gait_states, gait_targets, gait_transfers

_INCLUDES = """
#include "walkgen_real_f64.h"
#include "walkgen_gait.h"
#include "walkgen_real_f32.h"
#include "walkgen_gait.h"
#include "walkgen_gait.h"
"""
_LOOPS = """
#define TIMING const REAL *duty, const REAL *phase, int k, REAL period
void timing@(int n, TIMING, const REAL *t, REAL *u, int32_t *state, REAL *next, int32_t *change);
void timing@(int n, TIMING, const REAL *t, REAL *u, int32_t *state, REAL *next, int32_t *change) {
    for (int i = 0; i < n; ++i) {
        wg_gait_phase@(duty, phase, k, period, t[i], u + i * k);
        wg_gait_states@(duty, phase, k, period, t[i], state + i * k);
        wg_gait_next_event@(duty, phase, k, period, t[i], next + i, change + i * k);
    }
}
void feet@(int n, TIMING, REAL lift, const REAL *stance, const REAL *t, const REAL *twist, REAL *p, REAL *v, REAL *a);
void feet@(int n, TIMING, REAL lift, const REAL *stance, const REAL *t, const REAL *twist, REAL *p, REAL *v, REAL *a) {
    for (int i = 0; i < n; ++i)
        wg_gait_targets@(duty, phase, k, period, lift, stance, t[i], twist + 3 * i, p + 3 * k * i, v + 3 * k * i, a + 3 * k * i);
}
void steps@(int n, TIMING, REAL lift, const REAL *end, const REAL *t, const REAL *start, REAL *p, REAL *v, REAL *a);
void steps@(int n, TIMING, REAL lift, const REAL *end, const REAL *t, const REAL *start, REAL *p, REAL *v, REAL *a) {
    for (int i = 0; i < n; ++i)
        wg_gait_transfers@(duty, phase, k, period, lift, t[i], start, end, p + 3 * k * i, v + 3 * k * i, a + 3 * k * i);
}
#undef TIMING
"""
SOURCE = _INCLUDES + _LOOPS.replace("@", "").replace("REAL", "double") + _LOOPS.replace("@", "_f32").replace("REAL", "float")
_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.0, -0.0, 5e-324, 1e-160, 0.35, -0.4, 0.5, 1.0, 1e16, -1e160, 1.7e308, -1.7e308, NAN, INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
int main(void) {
    static const double duty[2] = {0.6, 0.25}, phase[2] = {0.0, 0.75}, stance[6] = {0.3, 0.2, -0.3, 0.3, -0.2, -0.3};
    static const float duty_single[2] = {0.6f, 0.25f}, phase_single[2] = {0.0f, 0.75f};
    static const float stance_single[6] = {0.3f, 0.2f, -0.3f, 0.3f, -0.2f, -0.3f};
    uint32_t seed = 1u;
    int bad = 0;
    for (int run = 0; run < 40000; ++run) {
        double number[4], u[2], next, p[6], v[6], a[6];
        float single[4], u_single[2], next_single, p_single[6], v_single[6], a_single[6];
        int32_t state[2], change[2];
        for (int i = 0; i < 4; ++i) {
            seed = seed * 1664525u + 1013904223u;
            number[i] = VALUES[(seed >> 16) % COUNT];
            single[i] = number[i] > 3e38 ? INFINITY : number[i] < -3e38 ? -INFINITY : (float)number[i];
        }
        timing(1, duty, phase, 2, 1.3, number, u, state, &next, change);
        bad += isfinite(number[0] / 1.3) ? !(u[0] >= 0.0 && u[0] < 1.0 && state[0] >= 0) : !(isnan(u[0]) && state[0] == -1 && isnan(next));
        feet(1, duty, phase, 2, 1.3, 0.1, stance, number, number + 1, p, v, a);
        timing_f32(1, duty_single, phase_single, 2, 1.3f, single, u_single, state, &next_single, change);
        bad += isfinite(single[0]) && !(u_single[0] >= 0.0f && u_single[0] < 1.0f && state[0] >= 0);
        feet_f32(1, duty_single, phase_single, 2, 1.3f, 0.1f, stance_single, single, single + 1, p_single, v_single, a_single);
        steps(1, duty, phase, 2, 1.3, number[1], stance, number, stance, p, v, a);
    }
    printf("%d", bad);
    return 0;
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    flags = ("-std=c99", "-O2", "-shared", "-fPIC", *STRICT)
    return ctypes.CDLL(str(compile_c(tmp_path_factory.mktemp("gait"), SOURCE, "gait.so", *flags)))


def gait(seed):
    rng = np.random.default_rng(seed)
    k = int(rng.integers(1, 9))
    numbers = rng.uniform(0.05, 0.95, k), rng.uniform(0, 1, k), k, rng.uniform(0.2, 4)
    return rng, numbers, rng.uniform(-30, 300, 60)


def called(library, name, numbers, given, outputs, dtype):
    duty, phase, k, period = numbers
    real = ctypes.c_float if dtype == np.float32 else ctypes.c_double
    arrays = [np.array(values, dtype, order="C") if np.ndim(values) else real(values) for values in (duty, phase, *given)]
    made = [np.empty(shape, kind) for shape, kind in outputs]
    pointers = [entry if isinstance(entry, real) else entry.ctypes.data_as(ctypes.c_void_p) for entry in (*arrays, *made)]
    function = getattr(library, name + ("_f32" if dtype == np.float32 else ""))
    function(ctypes.c_int(outputs[0][0][0]), *pointers[:2], ctypes.c_int(k), real(period), *pointers[2:])
    return made


@pytest.mark.parametrize("seed", range(20))
def test_timing_is_the_references_bit_for_bit(library, seed):
    _, numbers, times = gait(seed)
    k = numbers[2]
    shapes = [((60, k), np.float64), ((60, k), np.int32), ((60,), np.float64), ((60, k), np.int32)]
    u, state, after, change = called(library, "timing", numbers, [times], shapes, np.float64)
    np.testing.assert_array_equal(u, gait_phase(*numbers, times))
    np.testing.assert_array_equal(state, gait_states(*numbers, times))
    for mine, theirs in zip((after, change), gait_next_event(*numbers, times), strict=True):
        np.testing.assert_array_equal(mine, theirs)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_feet_are_the_references(library, seed, dtype):
    rng, numbers, times = gait(seed)
    duty, phase, k, period = numbers
    numbers = (dtype(duty).astype(float), dtype(phase).astype(float), k, float(dtype(period)))
    times = np.asarray(times if dtype == np.float64 else times / 100, dtype).astype(float)
    shapes = [((60, k, 3), dtype)] * 3
    stance, start, end = (np.asarray(rng.uniform(-1, 1, (k, 3)), dtype).astype(float) for _ in range(3))
    twist = np.asarray(rng.uniform(-1, 1, (60, 3)) * (seed % 3 > 0), dtype).astype(float)
    slack = 1e-12 if dtype == np.float64 else 4e-4
    air = (1 - numbers[0].max()) * numbers[3]
    mine = called(library, "feet", numbers, [0.1, stance, times, twist], shapes, dtype)
    theirs = gait_targets(*numbers, float(dtype(0.1)), stance, times, twist)
    along = called(library, "steps", numbers, [0.1, end, times, start], shapes, dtype)
    across = gait_transfers(*numbers, float(dtype(0.1)), times, start, end)
    for ours, other in ((mine, theirs), (along, across)):
        for order in range(3):
            size = (1 + np.abs(other[order]).max()) * (1 + 1 / air)
            np.testing.assert_allclose(ours[order], other[order], rtol=0, atol=slack * size)


@pytest.mark.nightly
def test_compiles_as_cpp_and_with_the_c_library(tmp_path):
    compile_c(tmp_path, SOURCE, "gait_cpp.so", "-std=c++11", "-O2", "-shared", "-fPIC", *STRICT, compiler="g++")
    compile_c(tmp_path, SOURCE, "gait_libm.so", "-std=c99", "-O2", "-shared", "-fPIC", "-DWALKGEN_LIBM", *STRICT)


@pytest.mark.nightly
def test_any_input_is_defined(tmp_path):
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", *STRICT)
    program = compile_c(tmp_path, SOURCE + _DRIVER, "any", *flags)
    assert subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout == "0"

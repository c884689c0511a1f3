"""walkgen_schedule.h alone: NumPy's reference on random lists of events in double and float, strict flags, sanitizers on any input."""

import ctypes
import subprocess

import numpy as np
import pytest
from csupport_library import STRICT, compile_c

from walkgen.runtime.solves.schedule import schedule_next_event, schedule_phase, schedule_states, schedule_transfers

_INCLUDES = """
#include "walkgen_real_f64.h"
#include "walkgen_schedule.h"
#include "walkgen_real_f32.h"
#include "walkgen_schedule.h"
#include "walkgen_schedule.h"
"""
_LOOPS = """
#define LISTS const REAL *times, const REAL *first, const REAL *lifted, int k
void timing@(int n, LISTS, const REAL *t, REAL *u, int32_t *state, REAL *next, int32_t *change);
void timing@(int n, LISTS, const REAL *t, REAL *u, int32_t *state, REAL *next, int32_t *change) {
    for (int i = 0; i < n; ++i) {
        wg_schedule_phase@(times, first, k, t[i], u + i * k);
        wg_schedule_states@(times, first, lifted, k, t[i], state + i * k);
        wg_schedule_next_event@(times, first, lifted, k, t[i], next + i, change + i * k);
    }
}
void feet@(int n, LISTS, REAL lift, const REAL *t, const REAL *start, const REAL *end, REAL *p, REAL *v, REAL *a);
void feet@(int n, LISTS, REAL lift, const REAL *t, const REAL *start, const REAL *end, REAL *p, REAL *v, REAL *a) {
    for (int i = 0; i < n; ++i)
        wg_schedule_transfers@(times, first, lifted, k, lift, t[i], start, end, p + 3 * k * i, v + 3 * k * i, a + 3 * k * i);
}
#undef LISTS
"""
SOURCE = _INCLUDES + _LOOPS.replace("@", "").replace("REAL", "double") + _LOOPS.replace("@", "_f32").replace("REAL", "float")
_DRIVER = """
#include <stdio.h>
int main(void) {
    static const double VALUES[] = {0.0, -0.0, 5e-324, 0.35, 0.5, 1.0, 1.5, 2.0, -1e160, 1.7e308, -1.7e308, NAN, INFINITY, -INFINITY};
    static const double times[5] = {0.5, 1.0, 1.5, 0.35, 2.0}, first[4] = {0.0, 3.0, 3.0, 5.0}, lifted[3] = {0.0, 1.0, 1.0};
    int bad = 0;
    for (unsigned i = 0; i < sizeof VALUES / sizeof VALUES[0]; ++i)
        for (unsigned j = 0; j < sizeof VALUES / sizeof VALUES[0]; ++j) {
            double u[3], next, p[9], v[9], a[9], start[9], end[9];
            int32_t state[3], change[3];
            for (int m = 0; m < 9; ++m) {
                start[m] = m;
                end[m] = VALUES[j];
            }
            timing(1, times, first, lifted, 3, VALUES + i, u, state, &next, change);
            feet(1, times, first, lifted, 3, 0.1, VALUES + i, start, end, p, v, a);
            bad += isfinite(VALUES[i]) ? state[0] < 0 || (next <= VALUES[i]) : state[0] != -1 || !isnan(next) || !isnan(p[0]) || change[0];
            bad += state[0] == 0 && p[2] < 2.0;
        }
    printf("%d", bad);
    return 0;
}
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    flags = ("-std=c99", "-O2", "-shared", "-fPIC", *STRICT)
    return ctypes.CDLL(str(compile_c(tmp_path_factory.mktemp("schedule"), SOURCE, "schedule.so", *flags)))


def lists(seed, dtype):
    """Times that single precision holds, some legs without any; instants, a third of which are events' own."""
    rng = np.random.default_rng(seed)
    k = int(rng.integers(1, 8))
    counts = rng.integers(0, 7, k)
    counts[0] = max(counts[0], 1)
    own = [np.sort(rng.choice(400, count, replace=False)) / 32 for count in counts]
    times = np.concatenate(own).astype(dtype)
    t = np.where(rng.random(90) < 1 / 3, rng.choice(times, 90), rng.uniform(-2, 15, 90)).astype(dtype)
    return rng, (times, np.cumsum([0, *counts]).astype(dtype), rng.integers(0, 2, k).astype(dtype), k), t


def called(library, name, given, outputs, dtype):
    real = ctypes.c_float if dtype == np.float32 else ctypes.c_double
    arrays = [np.array(values, dtype, order="C") if np.ndim(values) else values for values in given]
    made = [np.empty(shape, kind) for shape, kind in outputs]
    passed = [entry.ctypes.data_as(ctypes.c_void_p) if isinstance(entry, np.ndarray) else real(entry) for entry in (*arrays, *made)]
    passed[3] = ctypes.c_int(given[3])
    getattr(library, name + ("_f32" if dtype == np.float32 else ""))(ctypes.c_int(outputs[0][0][0]), *passed)
    return made


@pytest.mark.parametrize("seed", range(15))
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_timing_is_the_references(library, seed, dtype):
    _, numbers, t = lists(seed, dtype)
    times, first, lifted, k = numbers
    shapes = [((90, k), dtype), ((90, k), np.int32), ((90,), dtype), ((90, k), np.int32)]
    u, state, after, change = called(library, "timing", [*numbers, t], shapes, dtype)
    np.testing.assert_allclose(u, schedule_phase(times, first, k, t), rtol=1e-6 if dtype == np.float32 else 0, atol=1e-15)
    np.testing.assert_array_equal(state, schedule_states(*numbers, t))
    for mine, theirs in zip((after, change), schedule_next_event(*numbers, t), strict=True):
        np.testing.assert_array_equal(mine, theirs)
    own = np.split(times, first[1:-1].astype(int))
    passed = np.stack([(row[:, None] <= t).sum(axis=0) for row in own], axis=-1)
    np.testing.assert_array_equal(state, (lifted + passed) % 2)


@pytest.mark.parametrize("seed", range(15))
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_feet_are_the_references(library, seed, dtype):
    rng, numbers, t = lists(seed, dtype)
    k = numbers[3]
    start, end = (rng.uniform(-1, 1, (k, 3)).astype(dtype) for _ in range(2))
    mine = called(library, "feet", [*numbers, 0.125, t, start, end], [((90, k, 3), dtype)] * 3, dtype)
    theirs = schedule_transfers(*numbers, 0.125, t, start, end)
    for ours, other in zip(mine, theirs, strict=True):
        size = 1 + np.nanmax(np.abs(other), initial=0.0)
        np.testing.assert_allclose(ours, other, rtol=0, atol=(1e-13 if dtype == np.float64 else 1e-4) * size)


@pytest.mark.nightly
def test_compiles_as_cpp_and_any_input_is_defined(tmp_path):
    compile_c(tmp_path, SOURCE, "schedule_cpp.so", "-std=c++11", "-O2", "-shared", "-fPIC", *STRICT, compiler="g++")
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", *STRICT)
    program = compile_c(tmp_path, SOURCE + _DRIVER, "any", *flags)
    assert subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout == "0"

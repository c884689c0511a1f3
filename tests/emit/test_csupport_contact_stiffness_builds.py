"""The spreading of loads under the strict flags, as C++, with sanitizers, without double helpers in float, within its stated stack."""

import re
import subprocess

import pytest
from csupport_library import CSUPPORT, STRICT, compile_c
from stiffness_library import HEADERS, ONE, SOURCE

_DRIVER = """
#include <stdio.h>
static const double VALUES[] = {0.3, -0.5, 1.0, 0.0, 5e-324, 1e-160, 1e-9, 1e20, -1e160, 1.7e308, NAN, INFINITY, -INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0], FEET = 5, N = 3 * FEET, SIZE = 3 * N + FEET + 6 + N * N };
static uint32_t seed = 1u;
static double drawn(void) {
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / 16777216.0;
}
static void fill(double *x) {
    for (int i = 0; i < FEET; ++i) {
        const double slant = 0.3 * drawn();
        x[3 * i] = cos(1.3 * i), x[3 * i + 1] = sin(1.3 * i), x[3 * i + 2] = 0.2 * drawn();
        x[N + 3 * i] = sin(slant), x[N + 3 * i + 1] = 0.0, x[N + 3 * i + 2] = cos(slant);
        x[2 * N + i] = 0.5 + drawn();
    }
    for (int i = 0; i < 6; ++i) x[2 * N + FEET + i] = i == 2 ? -600.0 : 100.0 * drawn() - 50.0;
    for (int i = 0; i < N; ++i) x[2 * N + FEET + 6 + i] = 1e-3 * drawn();
    for (int i = 0; i < N * N; ++i) x[3 * N + FEET + 6 + i] = i % (N + 1) ? 1e-7 : 1e-5 * (1.0 + drawn());
}
int main(void) {
    int bad = 0, fine = 0;
    for (int run = 0; run < 160; ++run) {
        double x[SIZE], f[N], displacement[6], violation;
        float y[SIZE], g[N], displacement_f[6], violation_f;
        int32_t status, status_f, state[FEET];
        fill(x);
        if (run % 2) x[(int)(drawn() * SIZE)] = VALUES[(int)(drawn() * COUNT)];
        for (int i = 0; i < SIZE; ++i) y[i] = x[i] > 3e38 ? INFINITY : x[i] < -3e38 ? -INFINITY : (float)x[i];
        const int whole = run % 4 < 2;
        spread_rows(1, FEET, whole, x, x + N, x + 2 * N, x + 2 * N + FEET, x + 3 * N + FEET + 6, x + 2 * N + FEET + 6, f, &status, state,
                    displacement, &violation);
        spread_rows_f32(1, FEET, whole, y, y + N, y + 2 * N, y + 2 * N + FEET, y + 3 * N + FEET + 6, y + 2 * N + FEET + 6, g, &status_f,
                        state, displacement_f, &violation_f);
        fine += status == WALKGEN_OK;
        for (int i = 0; i < N; ++i) bad += (status == WALKGEN_OK) != isfinite(f[i]) || (status_f == WALKGEN_OK) != isfinite(g[i]);
    }
    for (int k = -1; k < 40; k += 20) {
        double x[SIZE], f[3] = {0}, displacement[6], violation;
        int32_t status = 0, state[1];
        fill(x);
        spread_rows(1, k, 1, x, x, x, x, x, x, f, &status, state, displacement, &violation);
        bad += status != WALKGEN_BAD_INPUT;
    }
    printf("%d %d", bad, fine);
    return 0;
}
"""


@pytest.mark.parametrize("level", ["-O0", pytest.param("-O2", marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, level, standard, compiler):
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, level, "-c", *STRICT, compiler=compiler).exists()


def test_float_needs_no_double_helper(tmp_path):
    text = "".join(f'#include "walkgen_real_f32.h"\n#include "{header}"\n' for header in HEADERS) + "".join(ONE.values())
    library = compile_c(tmp_path, text.replace("@", "_f32").replace("REAL", "float"), "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert "sqrtf" in functions
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-Wno-missing-braces")
    program = compile_c(tmp_path, SOURCE + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    bad, fine = map(int, done.stdout.split())
    assert bad == 0
    assert fine >= 40


@pytest.mark.nightly
@pytest.mark.parametrize(("bits", "place"), [("f64", 0), ("f32", 1)])
def test_stack_is_what_the_header_says(tmp_path, bits, place):
    """Not more than the frames of all functions together, as none calls itself."""
    (header,) = HEADERS
    stated = re.search(r"t most (\d+) kB of stack in double, (\d+) kB in float", (CSUPPORT / header).read_text()).groups()
    text = ONE[header].replace("@", "" if bits == "f64" else "_f32").replace("REAL", "double" if bits == "f64" else "float")
    text = f'#include "walkgen_real_{bits}.h"\n#include "{header}"\n{text}'
    compile_c(tmp_path, text, "stack.o", "-std=c99", "-O2", "-c", "-fstack-usage", *STRICT)
    frames = [int(line.split("\t")[1]) for line in (tmp_path / "stack.su").read_text().splitlines() if "spread" in line or "wg_" in line]
    assert 0.7 * 1000 * int(stated[place]) <= sum(frames) <= 1000 * int(stated[place])

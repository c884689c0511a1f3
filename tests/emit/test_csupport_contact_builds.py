"""The contact forces' headers under the strict flags, as C++, with sanitizers on any input, in float alone, within their stated stack."""

import re
import subprocess

import pytest
from contact_library import HEADERS, SOURCE
from csupport_library import CSUPPORT, STRICT, compile_c

_ONE = {
    "walkgen_contact.h": """
void one@(const REAL *x, walkgen_contact_work@ *work, REAL *f, int32_t *status);
void one@(const REAL *x, walkgen_contact_work@ *work, REAL *f, int32_t *status) {
    wg_contact_least_squares@(4, x, x, x, x, x, x, 0, work, f, status, status + 1, f, f);
}
""",
}
_DRIVER = """
#include <stdio.h>
#include <string.h>
enum { FEET = 4, INPUTS = 9 * FEET + 6 };
static const double VALUES[] = {0.3, -0.5, 1.0, -1.0, 0.0, 3.0, /* and rarer ones: */
                                -0.0, 5e-324, 1e-160, 1e-9, 1e20, -1e160, 1e308, NAN, INFINITY, -INFINITY};
static const int32_t FACETS[] = {0, 4, 0, 7, 4, 3, 2, 1024};
enum { COUNT = sizeof VALUES / sizeof VALUES[0] };
static uint32_t seed = 1u;
static uint32_t drawn(uint32_t below) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 16) % below;
}
static double number(double from, double to) { return from + (to - from) * drawn(10000) / 10000.0; }
#define CHECKED(tag, REAL)                                                                                                   \\
    static int bad##tag(const REAL *x, int k, int32_t facets, walkgen_contact_work##tag *work) {                             \\
        REAL f[3 * FEET], certificate[6], violation;                                                                         \\
        int32_t status = -1, state[FEET];                                                                                    \\
        int bad = 0;                                                                                                         \\
        wg_contact_least_squares##tag(k, x, x + 3 * FEET, x + 6 * FEET, x + 9 * FEET, x + 7 * FEET, x + 8 * FEET, facets, work, f, \\
                                      &status, state, certificate, &violation);                                              \\
        for (int i = 0; i < 3 * k; ++i)                                                                                      \\
            bad += (status == WALKGEN_OK) != !!isfinite(f[i]);                                                               \\
        for (int i = 0; i < k; ++i)                                                                                          \\
            bad += state[i] < 0 || state[i] > 2;                                                                             \\
        for (int i = 0; i < 6; ++i)                                                                                          \\
            bad += status != WALKGEN_BAD_INPUT && isnan(certificate[i]);                                                     \\
        bad += status == WALKGEN_INFEASIBLE && !(violation > 0);                                                             \\
        return bad + (status < 0) + (status == WALKGEN_OK && !isfinite(violation)) + (work->feet < 0 || work->feet > FEET);  \\
    }
CHECKED(, double)
CHECKED(_f32, float)
int main(void) {
    walkgen_contact_work work = {0, {0}};
    walkgen_contact_work_f32 work_f32 = {0, {0}};
    int bad = 0;
    for (int run = 0; run < 6000; ++run) {
        double x[INPUTS];
        float single[INPUTS];
        for (int i = 0; i < FEET; ++i) {
            for (int j = 0; j < 3; ++j) {
                x[3 * i + j] = number(-0.5, 0.5);
                x[3 * FEET + 3 * i + j] = j == 2 ? 1.0 : 0.0;
            }
            x[6 * FEET + i] = number(0.1, 1.0);
            x[7 * FEET + i] = 1.0;
            x[8 * FEET + i] = run % 7 ? (double)INFINITY : number(20.0, 90.0);
        }
        for (int j = 0; j < 6; ++j)
            x[9 * FEET + j] = number(-40.0, 40.0) - (j == 2 ? 100.0 : 0.0);
        for (int i = 0; i < run % 4; ++i)
            x[drawn(INPUTS)] = VALUES[drawn(run % 3 ? 6 : COUNT)];
        for (int i = 0; i < INPUTS; ++i)
            single[i] = x[i] > 3e38 ? INFINITY : x[i] < -3e38 ? -INFINITY : (float)x[i];
        bad += bad_(x, 1 + run % FEET, FACETS[run % 8], &work) + bad__f32(single, 1 + run % FEET, FACETS[run % 8], &work_f32);
    }
    printf("%d", bad);
    return 0;
}
""".replace("bad##tag", "bad_##tag")


@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, standard, compiler):
    """Without optimisation; the other tests' library is built with."""
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, "-O0", "-c", *STRICT, compiler=compiler).exists()


def test_the_workspace_needs_no_other_header(tmp_path):
    text = '#include "walkgen_contact_work.h"\n#include "walkgen_contact_work.h"\n'
    text += "struct pair { walkgen_contact_work wide; walkgen_contact_work_f32 narrow; int feet[WALKGEN_MAX_FEET]; };\n"
    for standard, compiler in (("-std=c99", "gcc"), ("-std=c++11", "g++")):
        assert compile_c(tmp_path, text, "work.o", standard, "-c", *STRICT, compiler=compiler).exists()


def test_float_needs_no_double_helper(tmp_path):
    text = "".join(f'#include "walkgen_real_f32.h"\n#include "{header}"\n' for header in HEADERS) + "".join(_ONE.values())
    library = compile_c(tmp_path, text.replace("@", "_f32").replace("REAL", "float"), "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert {"ldexpf", "atan2f"} <= functions
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
def test_sanitizers_find_nothing_on_any_input(tmp_path):
    flags = ("-std=c99", "-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, SOURCE + _DRIVER, "driver", *flags, *STRICT)
    done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "0"


@pytest.mark.nightly
@pytest.mark.parametrize("header", HEADERS)
@pytest.mark.parametrize(("bits", "place"), [("f64", 0), ("f32", 1)])
def test_stack_is_what_the_header_says(tmp_path, header, bits, place):
    """Not more than the frames of all functions together, as none calls itself."""
    stated = re.search(r"t most (\d+) kB of stack in double, (\d+) kB in float", (CSUPPORT / header).read_text()).groups()
    text = _ONE[header].replace("@", "" if bits == "f64" else "_f32").replace("REAL", "double" if bits == "f64" else "float")
    text = f'#include "walkgen_real_{bits}.h"\n#include "{header}"\n{text}'
    compile_c(tmp_path, text, "stack.o", "-std=c99", "-O2", "-c", "-fstack-usage", *STRICT)
    frames = [int(line.split("\t")[1]) for line in (tmp_path / "stack.su").read_text().splitlines()]
    assert 0.8 * 1000 * int(stated[place]) <= sum(frames) <= 1000 * int(stated[place]), sum(frames)

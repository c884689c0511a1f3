"""Adaption's headers under the strict flags, as C++, with sanitizers, without double helpers in float, within their stated stack."""

import re
import subprocess

import numpy as np
import pytest
from adapt_library import HEADERS, SOURCE
from csupport_library import CSUPPORT, STRICT, compile_c

from oracles.trees import Robot, chapter_module, random_ground

_ONE = {
    "walkgen_adapt.h": """
void one@(const REAL *g, const int32_t *t, const REAL *x, REAL *q, int32_t *status);
void one@(const REAL *g, const int32_t *t, const REAL *x, REAL *q, int32_t *status) {
    wg_adapt@(g, t, x, x, x, x, x, 9, 2, 2, NULL, NULL, q, status, q + 9);
}
""",
    "walkgen_adapt_velocity.h": """
void two@(const REAL *g, const int32_t *t, const REAL *x, REAL *q, int32_t *status);
void two@(const REAL *g, const int32_t *t, const REAL *x, REAL *q, int32_t *status) {
    wg_adapt_velocity@(g, t, x, x, x, x, x[0], x[1], 9, 2, 2, q, status);
}
""",
}
_DRIVER = """
#include <stdio.h>
#include <string.h>
static const double VALUES[] = {0.3, -0.5, 1.0, -1.0, 0.0, 3.0, /* and rarer ones: */
                                -0.0, 5e-324, 1e-160, 1e-9, 1e20, -1e160, 1.7e308, NAN, INFINITY, -INFINITY};
enum { COUNT = sizeof VALUES / sizeof VALUES[0], SIZE = sizeof NUMBERS / sizeof NUMBERS[0], LINKS = sizeof TOPOLOGY / sizeof TOPOLOGY[0] };
static uint32_t seed = 1u;
static uint32_t drawn(uint32_t below) {
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 16) % below;
}
int main(void) {
    int bad = 0;
    for (int run = 0; run < RUNS; ++run) {
        double number[SIZE], q[NQ + 1];
        float single[SIZE], q_single[NQ + 1];
        int32_t topology[LINKS], status = -1, status_single = -1;
        memcpy(number, NUMBERS, sizeof number);
        memcpy(topology, TOPOLOGY, sizeof topology);
        for (int i = 0; i < run % 4; ++i)
            number[drawn(SIZE)] = VALUES[drawn(run % 3 ? 6 : COUNT)];
        if (run % 5 == 0)
            topology[drawn(LINKS)] = (int32_t)drawn(NQ + 4) - 2;
        for (int i = 0; i < SIZE; ++i)
            single[i] = number[i] > 3e38 ? INFINITY : number[i] < -3e38 ? -INFINITY : (float)number[i];
        adapt_rows(1, NQ, FEET, PLATFORMS, number, topology, number + LIMITS, number + TARGETS, number + NORMALS, number + START,
                   number + WEIGHTS, q, &status, q + NQ);
        adapt_rows_f32(1, NQ, FEET, PLATFORMS, single, topology, single + LIMITS, single + TARGETS, single + NORMALS, single + START,
                       single + WEIGHTS, q_single, &status_single, q_single + NQ);
        for (int i = 0; i <= NQ; ++i)
            bad += (status == WALKGEN_BAD_INPUT) == isfinite(q[i]) || (status_single == WALKGEN_BAD_INPUT) == isfinite(q_single[i]);
        velocity_rows(1, NQ, FEET, PLATFORMS, number, topology, number + LIMITS, number + START, number + TARGETS, number + START,
                      number + WEIGHTS, q, &status);
        velocity_rows_f32(1, NQ, FEET, PLATFORMS, single, topology, single + LIMITS, single + START, single + TARGETS, single + START,
                          single + WEIGHTS, q_single, &status_single);
        for (int i = 0; i < NQ; ++i)
            bad += (status == WALKGEN_BAD_INPUT) == isfinite(q[i]) || (status_single == WALKGEN_BAD_INPUT) == isfinite(q_single[i]);
    }
    printf("%d", bad);
    return 0;
}
"""


def constants(robot: Robot, targets, start) -> str:
    """A robot and its task as the driver takes them: geometry, limits, targets, normals, start, weights one after the other."""
    parts = [robot.geometry, robot.limits, targets, np.zeros((robot.counts[2], 3)), start, [1.0, 4.0, 20.0, 0.3]]
    places = np.cumsum([0, *(np.size(part) for part in parts)])
    numbers = ", ".join(repr(float(value)) for part in parts for value in np.ravel(part))
    named = dict(zip(("LIMITS", "TARGETS", "NORMALS", "START", "WEIGHTS"), places[1:], strict=False))
    named |= dict(zip(("NQ", "FEET", "PLATFORMS"), robot.counts, strict=True))
    enum = ", ".join(f"{name} = {value}" for name, value in named.items())
    links = ", ".join(str(link) for link in robot.topology)
    return f"enum {{ {enum} }};\nstatic const double NUMBERS[] = {{{numbers}}};\nstatic const int32_t TOPOLOGY[] = {{{links}}};\n"


@pytest.mark.parametrize("level", ["-O0", pytest.param("-O2", marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("standard", "compiler"), [("-std=c99", "gcc"), pytest.param("-std=c++11", "g++", marks=pytest.mark.nightly)])
def test_strict_flags(tmp_path, level, standard, compiler):
    assert compile_c(tmp_path, SOURCE, "strict.o", standard, level, "-c", *STRICT, compiler=compiler).exists()


def test_float_needs_no_double_helper(tmp_path):
    text = "".join(f'#include "walkgen_real_f32.h"\n#include "{header}"\n' for header in HEADERS) + "".join(_ONE.values())
    text = text.replace("@", "_f32").replace("REAL", "float")
    library = compile_c(tmp_path, text, "single.o", "-std=c99", "-O1", "-c", *STRICT)
    needed = subprocess.run(["nm", "-u", str(library)], capture_output=True, text=True, check=True).stdout.split()
    functions = {name for name in needed if name != "U" and not name.startswith("_")}
    assert {"atan2f", "sqrtf"} <= functions  # rint and floor are single instructions to many compilers
    assert {name for name in functions if not name.endswith("f") and not name.startswith("mem")} == set()


@pytest.mark.nightly
@pytest.mark.parametrize("robot", ["chapter", "random"])
def test_sanitizers_find_nothing_on_any_input(tmp_path, robot):
    module = chapter_module()
    ground, start = random_ground(2, serial=False)
    chosen = (module, module.foot_positions(module.middle), module.middle) if robot == "chapter" else (ground.robot, ground.targets, start)
    flags = ("-std=c99", "-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    program = compile_c(tmp_path, SOURCE + constants(*chosen) + _DRIVER.replace("RUNS", "60"), "driver", *flags, *STRICT)
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
    assert 0.8 * 1000 * int(stated[place]) <= sum(frames) <= 1000 * int(stated[place])

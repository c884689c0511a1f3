"""Batches in lanes have the bits of single rows on aarch64 too, whose vectors hold two doubles; run under an emulator."""

import shutil
import subprocess
from pathlib import Path

import pytest
from test_equal_bits_elsewhere import TARGETS

from walkgen import pipeline
from walkgen.emit.c_files import c_sources

SPEC = Path(__file__).parents[2] / "specs" / "mero_leg.toml"

PROGRAM = """
#include "mero_leg.h"
#include "mero_leg_f32.h"
#include <stdio.h>
#include <string.h>

#define MOST 70
/* NaN have signs that mean nothing. */
static int differ(size_t count, size_t size, const void *a, const void *b) {
    int found = 0;
    for (size_t at = 0; at < count; ++at) {
        const double x = size == 8 ? ((const double *)a)[at] : ((const float *)a)[at];
        const double y = size == 8 ? ((const double *)b)[at] : ((const float *)b)[at];
        found += memcmp(&x, &y, sizeof x) != 0 && !(x != x && y != y);
    }
    return found;
}
#define COMPARE(real, leg) \\
    static int leg##_differs(size_t rows) { \\
        static real q[MOST * 3], p[MOST * 3], J[MOST * 9], angles[MOST * 12], one_p[MOST * 3], one_J[MOST * 9], one_angles[MOST * 12]; \\
        static int32_t status[MOST * 4], one_status[MOST * 4]; \\
        size_t bad = 0; \\
        for (size_t at = 0; at < rows * 3; ++at) q[at] = (real)((double)((at * 7919 + rows) % 1999) / 1000 - 1); \\
        q[rows / 2 * 3] = (real)3e5; /* beyond the range of the own sine */ \\
        for (size_t row = 0; row < rows; ++row) { \\
            leg##_foot_position(q + 3 * row, one_p + 3 * row), leg##_foot_jacobian(q + 3 * row, one_J + 9 * row); \\
            one_p[3 * row] += row % 11 == 10; /* some targets out of reach */ \\
            bad += leg##_inverse(one_p + 3 * row, one_angles + 12 * row, one_status + 4 * row) == 0; \\
        } \\
        leg##_foot_position_batch(rows, q, p), leg##_foot_jacobian_batch(rows, q, J); \\
        for (size_t row = 10; row < rows; row += 11) p[3 * row] += 1; \\
        memset(status, 77, sizeof status); \\
        return leg##_inverse_batch(rows, p, angles, status) != bad || memcmp(p, one_p, rows * sizeof p[0] * 3) || \\
               memcmp(J, one_J, rows * sizeof J[0] * 9) || \\
               memcmp(angles, one_angles, rows * sizeof angles[0] * 12) || memcmp(status, one_status, rows * sizeof status[0] * 4); \\
    }
COMPARE(double, mero_leg_leg)
COMPARE(float, mero_leg_f32_leg)

int main(void) {
    int differ = 0;
    for (size_t rows = 1; rows <= MOST; ++rows) {
        differ += mero_leg_leg_differs(rows) + mero_leg_f32_leg_differs(rows);
    }
    printf("%d of %d differ\\n", differ, 2 * MOST);
    return differ;
}
"""


@pytest.mark.parametrize("name", ["aarch64", "aarch64, no fma"])
def test_batches_have_the_bits_of_single_rows(tmp_path, name):
    target = TARGETS[name]
    missing = [tool for tool in (target.compiler, target.emulator[0]) if shutil.which(tool) is None]
    if missing:
        pytest.skip(f"{' and '.join(missing)} missing; in Debian gcc-aarch64-linux-gnu and qemu-user")
    (tmp_path / "batches.c").write_text(PROGRAM)
    for artifact in c_sources(pipeline.generate(SPEC, pipeline.BuildOptions(float32=True))):
        (tmp_path / artifact.path).write_text(artifact.text, encoding="utf-8")
    options = ("-std=gnu99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")
    sources = ("batches.c", "mero_leg.c", "mero_leg_f32.c")
    command = (target.compiler, *options, *target.flags, *sources, "-o", "batches", "-lm")
    compiled = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert compiled.returncode == 0, compiled.stderr
    said = subprocess.run((*target.emulator, str(tmp_path / "batches")), capture_output=True, text=True, timeout=120, check=False)
    assert said.stdout == "0 of 140 differ\n"

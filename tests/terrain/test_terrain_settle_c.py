"""Settling in C: strict compilers, sanitizers, both precisions, room for a part of the path or none, symbols; ground with height maps."""

import subprocess

import numpy as np
import pytest

from oracles.bowl import LIMITS
from terrain.tripods import BOWL, tripod
from walkgen import pipeline
from walkgen.emit.emit import emit

OK, NO_CONVERGENCE = 0, 4
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Wcast-qual", "-Werror")
SANITIZE = ("-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
SLOPE = """
[[terrain]]
name = "slope"
surface = "heightmap"
file = "slope.txt"
spacing = 1.0
interpolation = "bilinear"
domain = { x = [5, 7], y = [-1, 1] }
mu = "rough"
"""
HEIGHTS = "0.0 0.1 0.2\n" * 3
_SETTLED = """
static int settled@(REAL cosine, REAL sine) {
    const REAL start[16] = {cosine, 0, -sine, SINK * sine, 0, 1, 0, 0, sine, 0, cosine, -SINK * cosine, 0, 0, 0, 1};
    const REAL q[3] = {0, 0, 0}, wrench[6] = {0, 0, 0, 0, 0, 0}, param[1] = {(REAL)0.2};
    const int32_t feet[3] = {0, 1, 2};
    REAL pose[16], again[16], N[3], path[3 * 16];
    int32_t steps, whole, same = 1, status = tripod@_settle(0, start, q, feet, wrench, (REAL)0.01, 200, param, pose, N, NULL, &whole);
    same = same && tripod@_settle(3, start, q, feet, wrench, (REAL)0.01, 200, param, again, N, path, &steps) == status && steps == whole;
    for (int i = 0; i < 16; ++i)
        same = same && pose[i] == again[i];
    printf("%d %d %d %.17g %.17g\\n", (int)status, (int)same, (int)whole, atan2((double)pose[8], (double)pose[0]),
           atan2((double)path[2 * 16 + 8], (double)path[2 * 16]));
    return 0;
}
"""
_MAIN = (
    '#include <math.h>\n#include <stdio.h>\n#include "tripod.h"\n#include "tripod_f32.h"\n#define SINK (REAL)0.95393920141694566\n'
    f"#define REAL double\n{_SETTLED.replace('@', '')}#undef REAL\n#define REAL float\n{_SETTLED.replace('@', '_f32')}"
    "int main(void) { return settled(cos(0.38), sin(0.38)) + settled_f32((float)cos(0.38), (float)sin(0.38)); }\n"
)


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """The tripod's files in both precisions, with a main program."""
    folder = tmp_path_factory.mktemp("tripod")
    (folder / "slope.txt").write_text(HEIGHTS)
    (folder / "spec.toml").write_text(tripod(BOWL + SLOPE, targets='["c"]'))
    for artifact in emit(pipeline.generate(folder / "spec.toml", pipeline.BuildOptions(float32=True))):
        (folder / artifact.path).write_text(artifact.text)
    (folder / "main.c").write_text(_MAIN)
    return folder


def run(folder, *command):
    answer = subprocess.run(command, cwd=folder, check=False, capture_output=True, encoding="utf-8")
    assert answer.returncode == 0, answer.stdout[-2000:] + answer.stderr[-4000:]
    return answer.stdout


def test_both_precisions_end_at_the_limit(sources):
    """Under sanitizers; what is kept of the path changes nothing."""
    run(sources, "gcc", "-std=c99", *STRICT, *SANITIZE, "main.c", "tripod.c", "tripod_f32.c", "-o", "main", "-lm")
    for line, tolerance in zip(run(sources, "./main").splitlines(), (2e-6, 5e-3), strict=True):
        status, same, steps, tilt, second = line.split()
        assert (int(status), int(same)) == (OK, 1)
        assert int(steps) > 2
        assert abs(float(tilt) - LIMITS[0.2]) <= tolerance
        assert float(tilt) < float(second) < 0.38


def test_strict_flags_as_cpp(sources):
    run(sources, "g++", "-x", "c++", "-std=c++11", *STRICT, "-O0", "-c", "tripod.c", "tripod_f32.c")


def test_no_symbol_but_the_robots(sources):
    for stem in ("tripod", "tripod_f32"):
        run(sources, "gcc", "-std=c99", "-O0", "-c", f"{stem}.c", "-o", f"{stem}_symbols.o")
        names = [line.split()[0] for line in run(sources, "nm", "-g", "--defined-only", "--format=posix", f"{stem}_symbols.o").splitlines()]
        assert f"{stem}_settle" in names
        assert [name for name in names if not name.startswith(f"{stem}_")] == []


def test_a_height_map_holds_and_lets_go(mapped):
    """A plane of slope 0.1 as a map: more friction holds, less slides on."""
    built = mapped(tripod(BOWL + SLOPE, targets='["c", "numpy"]'), {"slope.txt": HEIGHTS})
    c, s = np.array([1.0, 0.1]) / np.hypot(1.0, 0.1)
    start = np.array([[c, 0.0, -s, 6.5], [0.0, 1.0, 0.0, 0.0], [s, 0.0, c, 0.15], [0.0, 0.0, 0.0, 1.0]])
    for robot in (built.c, built.numpy):
        pose, status, N, path, _ = robot.settle(start, np.zeros(3), step=0.02, most_steps=5, param=[[0.11], [0.09]])
        assert status.tolist() == [OK, NO_CONVERGENCE]
        np.testing.assert_allclose(pose[0], start, rtol=0, atol=1e-12)
        np.testing.assert_allclose(pose[1, :3, 3], start[:3, 3] - 0.1 * np.array([c, 0.0, s]), rtol=0, atol=1e-9)
        np.testing.assert_allclose(N.sum(axis=-1), 60 * 9.81 * c, rtol=1e-9)
        assert path.shape == (2, 6, 4, 4)

"""The support routines behind loops over rows, compiled in double and float, for the tests that call C from NumPy."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np

CSUPPORT = Path(__file__).parents[2] / "generator" / "walkgen" / "emit" / "csupport"
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Werror", "-ffp-contract=off")

_INCLUDES = """
#include "walkgen_real_f64.h"
#include "walkgen_inverse.h"
#include "walkgen_damped.h"
#include "walkgen_real_f32.h"
#include "walkgen_inverse.h"
#include "walkgen_damped.h"
#include "walkgen_inverse.h"
#include "walkgen_damped.h"
"""
_LOOPS = """
void closest_rows@(int rows, const REAL *geometry, const REAL *target, REAL *q, int32_t *status);
void closest_rows@(int rows, const REAL *geometry, const REAL *target, REAL *q, int32_t *status) {
    for (int i = 0; i < rows; ++i) wg_closest_yaw_pitch_pitch@(geometry + 10 * i, target + 3 * i, q + 12 * i, status + 4 * i);
}
void branch_rows@(int rows, const REAL *geometry, const REAL *target, const int32_t *branch, REAL *q, int32_t *status);
void branch_rows@(int rows, const REAL *geometry, const REAL *target, const int32_t *branch, REAL *q, int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_closest_yaw_pitch_pitch_branch@(geometry + 10 * i, target + 3 * i, branch[i], q + 3 * i, status + i);
}
void damped_rows@(int rows, const REAL *J, const REAL *v, const REAL *bounds, REAL *qd, int32_t *status);
void damped_rows@(int rows, const REAL *J, const REAL *v, const REAL *bounds, REAL *qd, int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_damped_inverse_3@(J + 9 * i, v + 3 * i, bounds[2 * i], bounds[2 * i + 1], qd + 3 * i, status + i);
}
int32_t count_ok@(const int32_t *status, int32_t count);
int32_t count_ok@(const int32_t *status, int32_t count) { return wg_count_ok@(status, count); }
int32_t any_unreachable@(const int32_t *status, int32_t count);
int32_t any_unreachable@(const int32_t *status, int32_t count) { return wg_any_unreachable@(status, count); }
"""
SOURCE = _INCLUDES + _LOOPS.replace("@", "").replace("REAL", "double") + _LOOPS.replace("@", "_f32").replace("REAL", "float")


def compile_c(folder: Path, source: str, output: str, *flags: str, compiler: str = "gcc") -> Path:
    """Compile `source` in `folder`; the compiler's complaint is the assertion's text."""
    suffix = ".cpp" if compiler == "g++" else ".c"
    (folder / f"{output}{suffix}").write_text(source)
    command = [*compiler.split(" "), f"{output}{suffix}", "-o", output, f"-I{CSUPPORT}", *flags, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / output


class Library:
    """The compiled routines, called on NumPy arrays of rows."""

    def __init__(self, path: Path) -> None:
        self._library = ctypes.CDLL(str(path))

    def closest(self, geometry, target, q, status, dtype=np.float64):
        values, states = _own(q, dtype), _own(status, np.int32)
        self._call("closest_rows", dtype, len(values), _own(geometry, dtype), _own(target, dtype), values, states)
        return values, states

    def branch(self, geometry, target, branch, q, status, dtype=np.float64):
        values, states = _own(q, dtype), _own(status, np.int32)
        self._call("branch_rows", dtype, len(values), _own(geometry, dtype), _own(target, dtype), _own(branch, np.int32), values, states)
        return values, states

    def damped(self, J, v, bounds, dtype=np.float64):
        qd, states = np.full((len(J), 3), 7.0, dtype), np.full(len(J), -1, np.int32)
        self._call("damped_rows", dtype, len(J), _own(J, dtype), _own(v, dtype), _own(bounds, dtype), qd, states)
        return qd, states

    def count_ok(self, status) -> int:
        return int(self._library.count_ok(_own(status, np.int32).ctypes.data_as(ctypes.c_void_p), len(status)))

    def any_unreachable(self, status) -> int:
        return int(self._library.any_unreachable(_own(status, np.int32).ctypes.data_as(ctypes.c_void_p), len(status)))

    def _call(self, name, dtype, rows, *arrays) -> None:
        function = getattr(self._library, name + ("_f32" if dtype == np.float32 else ""))
        function.restype = None
        function(ctypes.c_int(rows), *(array.ctypes.data_as(ctypes.c_void_p) for array in arrays))


def _own(values, dtype):
    return np.array(values, dtype=dtype, order="C")

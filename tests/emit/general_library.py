"""The routines of the general inverse, compiled in double and float, called on NumPy arrays of rows."""

import ctypes
import hashlib
import re

import numpy as np
from csupport_library import STRICT, compile_c

from walkgen.runtime.solves.inverse_general import kinds_of, slots_of

QUARTIC = """
void quartic_rows@(int rows, const REAL *c, REAL *roots, int32_t *count);
void quartic_rows@(int rows, const REAL *c, REAL *roots, int32_t *count) {
    for (int i = 0; i < rows; ++i) count[i] = wg_quartic_roots@(c + 5 * i, roots + 4 * i);
}
"""
GENERAL = """
void general_rows@(int rows, int sequence, int values, const REAL *geometry, const REAL *p, REAL *q, int32_t *status);
void general_rows@(int rows, int sequence, int values, const REAL *geometry, const REAL *p, REAL *q, int32_t *status) {
    const int slots = wg_slots_of@(sequence);
    for (int i = 0; i < rows; ++i)
        wg_inverse_general@(geometry + values * i, p + 3 * i, sequence, q + (values / 6) * slots * i, status + slots * i);
}
void general_branch_rows@(int rows, int sequence, int values, const REAL *geometry, const REAL *p, const int32_t *branch, REAL *q,
                          int32_t *status);
void general_branch_rows@(int rows, int sequence, int values, const REAL *geometry, const REAL *p, const int32_t *branch, REAL *q,
                          int32_t *status) {
    for (int i = 0; i < rows; ++i)
        wg_inverse_general_branch@(geometry + values * i, p + 3 * i, sequence, branch[i], q + (values / 6) * i, status + i);
}
"""


def source(loops: str, *headers: str) -> str:
    """The loops in both precisions; every header is included twice, as a robot with two routines does."""
    includes = "".join(f'#include "{header}"\n' for header in (*headers, *headers))
    both = [f'#include "walkgen_real_{tag}.h"\n{includes}' for tag in ("f64", "f32")]
    return "".join(both) + loops.replace("@", "").replace("REAL", "double") + loops.replace("@", "_f32").replace("REAL", "float")


def build(folder, text, *flags):
    """The library; whoever wants the same one in this run of the tests, in any of its processes, shares it."""
    run = next((place for place in folder.parents if re.fullmatch(r"pytest-\d+", place.name)), folder)
    shared = run / f"csupport-{hashlib.sha256(repr((text, flags)).encode()).hexdigest()[:16]}.so"
    if not shared.exists():
        compile_c(folder, text, "general.so", "-std=c99", "-O2", "-shared", "-fPIC", *STRICT, *flags).replace(shared)
    return ctypes.CDLL(str(shared))


def call(library, name, dtype, *arguments):
    """Integers go by value, arrays as pointers."""
    function = getattr(library, name + ("_f32" if dtype == np.float32 else ""))
    function.restype = None
    function(*(ctypes.c_int(item) if isinstance(item, int) else item.ctypes.data_as(ctypes.c_void_p) for item in arguments))


class General:
    """The general inverse in C: rows of targets, one leg or one a row."""

    def __init__(self, folder) -> None:
        self._library = build(folder, source(GENERAL, "walkgen_inverse_general.h"))

    def __call__(self, geometry, p, sequence, dtype=np.float64):
        numbers, targets, joints, slots = self._rows(geometry, p, sequence, dtype)
        q, status = np.full((len(targets), slots, joints), 7.0, dtype), np.full((len(targets), slots), -1, np.int32)
        call(self._library, "general_rows", dtype, len(targets), sequence, numbers.shape[1], numbers, targets, q, status)
        return q, status

    def branch(self, geometry, p, sequence, branch, dtype=np.float64):
        numbers, targets, joints, _ = self._rows(geometry, p, sequence, dtype)
        chosen = np.array(np.broadcast_to(branch, len(targets)), np.int32)
        q, status = np.full((len(targets), joints), 7.0, dtype), np.full(len(targets), -1, np.int32)
        call(self._library, "general_branch_rows", dtype, len(targets), sequence, numbers.shape[1], numbers, targets, chosen, q, status)
        return q, status

    def _rows(self, geometry, p, sequence, dtype):
        targets = np.array(p, dtype, order="C")
        numbers = np.array(np.broadcast_to(geometry, (len(targets), np.shape(geometry)[-1])), dtype, order="C")
        kinds = kinds_of(sequence)
        return numbers, targets, len(kinds), slots_of(kinds)

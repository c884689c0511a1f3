"""The routines of the general inverse, compiled in double and float, called on NumPy arrays of rows."""

import ctypes

import numpy as np
from csupport_library import STRICT, compile_c

QUARTIC = """
void quartic_rows@(int rows, const REAL *c, REAL *roots, int32_t *count);
void quartic_rows@(int rows, const REAL *c, REAL *roots, int32_t *count) {
    for (int i = 0; i < rows; ++i) count[i] = wg_quartic_roots@(c + 5 * i, roots + 4 * i);
}
"""


def source(loops: str, *headers: str) -> str:
    """The loops in both precisions; every header is included twice, as a robot with two routines does."""
    includes = "".join(f'#include "{header}"\n' for header in (*headers, *headers))
    both = [f'#include "walkgen_real_{tag}.h"\n{includes}' for tag in ("f64", "f32")]
    return "".join(both) + loops.replace("@", "").replace("REAL", "double") + loops.replace("@", "_f32").replace("REAL", "float")


def build(folder, text, *flags):
    return ctypes.CDLL(str(compile_c(folder, text, "general.so", "-std=c99", "-O2", "-shared", "-fPIC", *STRICT, *flags)))


def call(library, name, dtype, *arguments):
    """Integers go by value, arrays as pointers."""
    function = getattr(library, name + ("_f32" if dtype == np.float32 else ""))
    function.restype = None
    function(*(ctypes.c_int(item) if isinstance(item, int) else item.ctypes.data_as(ctypes.c_void_p) for item in arguments))

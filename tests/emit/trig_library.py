"""The own sine, cosine and arctangent behind loops over rows, and exact values to measure them with."""

import ctypes
import sys
from pathlib import Path

import mpmath
import numpy as np
from csupport_library import STRICT, compile_c

SOURCE = """
#if defined(__cplusplus)
#define ENTRY extern "C"
#else
#define ENTRY
#endif
#define ONE(name, real, call) \\
    ENTRY void name(int rows, const real *x, real *found); \\
    void name(int rows, const real *x, real *found) { for (int i = 0; i < rows; ++i) found[i] = call(x[i]); }
#define TWO(name, real, call) \\
    ENTRY void name(int rows, const real *y, const real *x, real *found); \\
    void name(int rows, const real *y, const real *x, real *found) { for (int i = 0; i < rows; ++i) found[i] = call(y[i], x[i]); }
#include "walkgen_real_f64.h"
ONE(sin_rows, double, WG_SIN)
ONE(cos_rows, double, WG_COS)
TWO(atan2_rows, double, WG_ATAN2)
#include "walkgen_real_f32.h"
#include "walkgen_real_f32.h"
ONE(sin_rows_f32, float, WG_SIN)
ONE(cos_rows_f32, float, WG_COS)
TWO(atan2_rows_f32, float, WG_ATAN2)
"""
FARTHEST = {np.float64: 1e5, np.float32: 1e4}
"""Up to where sine and cosine do not ask the C library."""
ZIG = f"{sys.executable} -m ziglang cc"


class Trig:
    """One compiled set of the six functions, called on arrays; the arrays' type chooses the precision."""

    def __init__(self, path: Path, flags: tuple[str, ...]) -> None:
        self._library = ctypes.CDLL(str(path))
        self.flags = flags

    def __call__(self, name: str, *columns):
        values = [np.ascontiguousarray(column) for column in np.broadcast_arrays(*columns)]
        found = np.empty_like(values[0])
        function = self._library[f"{name}_rows{'_f32' if found.dtype == np.float32 else ''}"]
        function.restype = None
        function(ctypes.c_int(found.size), *(array.ctypes.data_as(ctypes.c_void_p) for array in (*values, found)))
        return found


def build(folder: Path, *flags: str, compiler: str = "gcc", standard: str = "-std=c99", source: str = SOURCE) -> Trig:
    """Compiled with these flags beside the strict ones."""
    name = f"trig{len(list(folder.iterdir()))}.so"
    return Trig(compile_c(folder, source, name, standard, "-shared", "-fPIC", *STRICT, *flags, compiler=compiler), flags)


def fma_flags() -> tuple[str, ...]:
    """What makes fused multiply-add an instruction here: nothing more, a flag, or none where the processor lacks it."""
    cpu = Path("/proc/cpuinfo")
    return ("-mfma",) if cpu.exists() and " fma " in cpu.read_text() else ()


def errors(name: str, found, *columns):
    """|found - exact| in units in the last place of the exact value, which has 40 digits."""
    with mpmath.workdps(40):
        exact = [getattr(mpmath, name)(*map(float, row)) for row in zip(*columns, strict=True)]
        near = np.array([float(value) for value in exact])
        rest = np.array([float(value - mpmath.mpf(rounded)) for value, rounded in zip(exact, near.tolist(), strict=True)])
    unit = np.spacing(np.abs(near).astype(found.dtype)).astype(np.float64)
    return np.abs((found.astype(np.float64) - near) - rest) / unit


def beside_quarters(real: type, numbers):
    """The five numbers of the type next to n pi/2, for each n."""
    with mpmath.workdps(40):
        middle = np.array([float(int(n) * mpmath.pi / 2) for n in numbers]).astype(real)
    below, above = np.nextafter(middle, real(0)), np.nextafter(middle, real(np.inf))
    near = np.concatenate([np.nextafter(below, real(0)), below, middle, above, np.nextafter(above, real(np.inf))])
    return near[near <= real(FARTHEST[real])]


def angles(real: type, rows: int, seed: int):
    """Of all sizes: within the quarter turn, within some turns, up to the end of the range, and spread over its decades."""
    rng = np.random.default_rng(seed)
    decades = np.exp(rng.uniform(-80.0, np.log(FARTHEST[real]), rows))
    spread = [rng.uniform(-reach, reach, rows) for reach in (0.8, 10.0, FARTHEST[real])]
    return np.concatenate([*spread, decades, -decades]).astype(real)


def points(real: type, rows: int, seed: int):
    """y and x in all quadrants and of very different sizes, many of them where the directions of the arctangent change."""
    rng = np.random.default_rng(seed)
    x = rng.choice([-1.0, 1.0], 3 * rows) * np.exp(rng.uniform(-20.0, 20.0, 3 * rows))
    ratio = np.concatenate([np.exp(rng.uniform(-30.0, 30.0, rows)), rng.uniform(0.3, 0.7, rows), rng.uniform(1.5, 2.5, rows)])
    return (x * ratio * rng.choice([-1.0, 1.0], 3 * rows)).astype(real), x.astype(real)


def extreme_points(real: type, rows: int, seed: int):
    """y and x of every size that numbers have, subnormal and greatest ones among them, half of them of like size."""
    rng, limits = np.random.default_rng(seed), np.finfo(real)
    ends = np.log2(limits.smallest_subnormal.astype(np.longdouble)), np.log2(limits.max.astype(np.longdouble))
    x, other = (np.exp2(rng.uniform(*map(float, ends), rows).astype(np.longdouble)) for _ in range(2))
    like = x * np.exp2(rng.uniform(-3.0, 3.0, rows)).astype(np.longdouble)
    y = np.where(np.arange(rows) % 2 == 0, like, other)
    sizes = (np.clip(each, limits.smallest_subnormal, limits.max).astype(real) for each in (y, x))
    return tuple(rng.choice([-1.0, 1.0], rows).astype(real) * size for size in sizes)

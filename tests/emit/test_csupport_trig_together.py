"""Several angles at once: in vectors, without them and by the C library, the bits of each angle alone."""

import ctypes
import importlib.util
import math
import platform
import re
from pathlib import Path

import numpy as np
import pytest
from csupport_library import STRICT, compile_c
from trig_library import ZIG, angles, build, points

COUNTS = (2, 3, 4)


def _arguments(count: int, pattern: str) -> str:
    return ", ".join(pattern.format(*(at + k * count for k in range(3))) for at in range(count))


def _loop(count: int, kind: str, real: str, suffix: str) -> str:
    pattern = "x[{0}], x[{1}], found[{0}]" if kind == "ATAN2" else "x[{0}], found[{0}], found[{1}]"
    name, text = f"{kind.lower()}_{count}{suffix}", _arguments(count, pattern)
    head = f"ENTRY void {name}(int rows, const {real} *x, {real} *found)"
    body = f"for (int row = 0; row < rows; ++row, x += {2 * count}, found += {2 * count}) {{ WG_{kind}_{count}({text}); }}"
    return f"{head};\n{head} {{ {body} }}\n"


def _sum(real: str, suffix: str) -> str:
    """Sine and cosine of x + y, found together with those of x: columns of x, y and of what is found."""
    head = f"ENTRY void sum{suffix}(int rows, const {real} *x, {real} *found)"
    call = "WG_SINCOS_2(x[0], sine, cosine, WG_PART(x[0] + x[1], x[1]), found[0], found[1]); WG_TURN(found[0], found[1], sine, cosine);"
    body = f"{real} sine, cosine; for (int row = 0; row < rows; ++row, x += 2, found += 2) {{ {call} (void)sine; (void)cosine; }}"
    return f"{head};\n{head} {{ {body} }}\n"


def _both(real: str, header: str, suffix: str) -> str:
    loops = "".join(_loop(count, kind, real, suffix) for count in COUNTS for kind in ("SINCOS", "MANY_SINCOS", "ATAN2"))
    single = f"ENTRY void sin_1{suffix}(int rows, const {real} *x, {real} *found)"
    single += " { for (int i = 0; i < rows; ++i) found[i] = WG_SIN(x[i]); }\n"
    single += single.replace("sin_1", "cos_1").replace("WG_SIN", "WG_COS")
    two = f"ENTRY void atan2_1{suffix}(int rows, const {real} *y, const {real} *x, {real} *found)"
    two += " { for (int i = 0; i < rows; ++i) found[i] = WG_ATAN2(y[i], x[i]); }\n"
    declared = "".join(f"{line.split(' {')[0]};\n" for line in (single + two).splitlines())
    return f'#include "{header}"\n{loops}{_sum(real, suffix)}{declared}{single}{two}'


SOURCE = '#if defined(__cplusplus)\n#define ENTRY extern "C"\n#else\n#define ENTRY\n#endif\n'
SOURCE += _both("double", "walkgen_real_f64.h", "") + _both("float", "walkgen_real_f32.h", "_f32")


def has(flag: str) -> bool:
    """Whether this processor has an extension."""
    cpu = Path("/proc/cpuinfo")
    return cpu.exists() and f" {flag} " in cpu.read_text()


needs_avx2 = pytest.mark.skipif(not (has("avx2") and has("fma")), reason="this processor has no AVX2 with fused multiply-add")
needs_zig = pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
BUILDS = {
    "vectors": ("-mavx2", "-mfma"),
    "vectors without fused multiply-add": ("-mavx2", "-mfma", "-DWALKGEN_NO_FMA"),
    "plain": ("-mavx2", "-mfma", "-DWALKGEN_PLAIN"),
    "size": ("-mavx2", "-mfma", "-Os"),
    "pairs": (),
    "pairs of AVX": ("-mavx",),
    "C library": ("-mavx2", "-mfma", "-DWALKGEN_LIBM"),
}
REALS = pytest.mark.parametrize("real", [np.float64, np.float32])


def called(library, name, rows, *columns):
    """What a loop makes of rows; as many numbers as its first column has."""
    columns = [np.ascontiguousarray(column) for column in columns]
    found = np.empty_like(columns[0])
    function = library._library[name + ("_f32" if found.dtype == np.float32 else "")]
    function(ctypes.c_int(rows), *(array.ctypes.data_as(ctypes.c_void_p) for array in (*columns, found)))
    return found


def special(real):
    """Angles in and beyond the range, infinite, not a number; among them ordinary ones."""
    values = [0.0, -0.0, 1e-320, 1e-30, 0.5, -2.0, 1e3, 9.9e3, 1.1e4, -1e5, 1.1e5, 1e22, 3e38, math.inf, -math.inf, math.nan]
    with np.errstate(over="ignore"):
        return np.random.default_rng(5).permutation(np.tile(values, 300)).astype(real)


def apart(library, kind, count, x):
    """The same by the functions of one angle."""
    if kind != "atan2":
        angle = x.reshape(-1, 2, count)[:, 0]
        return [called(library, f"{name}_1", angle.size, angle.ravel()).reshape(angle.shape) for name in ("sin", "cos")]
    across, along = x.reshape(-1, 2, count).swapaxes(0, 1)
    return [called(library, "atan2_1", across.size, across.ravel(), along.ravel()).reshape(across.shape)]


def compared(library, real):
    """Bits of all together and of each alone."""
    turns = np.concatenate([angles(real, 2400, 1), special(real)])
    given = {
        "sincos": turns,
        "many_sincos": turns,
        "atan2": np.concatenate([*points(real, 2400, 2), special(real)]),
    }
    for kind, values in given.items():
        for count in COUNTS:
            x = np.random.default_rng(count).permutation(values)[: values.size // (2 * count) * 2 * count]
            found = called(library, f"{kind}_{count}", x.size // (2 * count), x).reshape(-1, 2, count)
            for column, alone in enumerate(apart(library, kind, count, x)):
                yield np.ascontiguousarray(found[:, column]), alone


@needs_avx2
@REALS
@pytest.mark.parametrize("flags", BUILDS.values(), ids=BUILDS)
def test_together_gives_the_bits_of_each_alone(tmp_path, flags, real):
    library = build(tmp_path, "-O2", *flags, source=SOURCE)
    for together, alone in compared(library, real):
        assert together.tobytes() == alone.tobytes()


@needs_avx2
@REALS
@pytest.mark.parametrize("flags", [flags for name, flags in BUILDS.items() if name != "C library"])
def test_an_angle_of_two_parts_has_the_bits_of_their_sum(tmp_path, flags, real):
    library = build(tmp_path, "-O2", *flags, source=SOURCE)
    parts = angles(real, 2400, 3).reshape(-1, 2)
    found, total = called(library, "sum", len(parts), parts), parts.sum(axis=1)
    for column, name in enumerate(("sin_1", "cos_1")):
        assert found[:, column].tobytes() == called(library, name, total.size, total).tobytes()


@REALS
@pytest.mark.parametrize("level", ["-O2", "-Os"])
def test_by_the_c_library_an_angle_of_two_parts_is_turned_by_both(tmp_path, real, level):
    library = build(tmp_path, level, "-DWALKGEN_LIBM", source=SOURCE)
    parts = np.random.default_rng(8).uniform(-4, 4, (2000, 2)).astype(real)
    total = parts.astype(np.longdouble).sum(axis=1)
    error = called(library, "sum", len(parts), parts) - np.stack([np.sin(total), np.cos(total)], axis=1)
    assert np.abs(error).max() < (2 if level == "-O2" else 5) * np.finfo(real).eps
    beyond = np.full((1, 2), np.finfo(real).max)  # whose sum is infinite
    assert np.isfinite(called(library, "sum", 1, beyond)).all() == (level == "-O2")


@needs_avx2
def test_vectors_and_plain_code_give_equal_bits(tmp_path):
    vectors, plain = (build(tmp_path, "-O2", *BUILDS[name], source=SOURCE) for name in ("vectors", "plain"))
    for real in (np.float64, np.float32):
        for (one, _), (other, _) in zip(compared(vectors, real), compared(plain, real), strict=True):
            assert one.tobytes() == other.tobytes()


@needs_avx2
@pytest.mark.parametrize(
    "compiler",
    [
        "g++",
        pytest.param(
            ZIG, marks=pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
        ),
    ],
)
def test_other_compilers_give_equal_bits(tmp_path, compiler):
    expected = build(tmp_path, "-O2", *BUILDS["vectors"], source=SOURCE)
    standard = "-std=c++11" if compiler == "g++" else "-std=c99"
    other = build(tmp_path, "-O2", *BUILDS["vectors"], source=SOURCE, compiler=compiler, standard=standard)
    for (one, _), (two, _) in zip(compared(expected, np.float64), compared(other, np.float64), strict=True):
        assert one.tobytes() == two.tobytes()


@pytest.mark.skipif(platform.machine() not in {"x86_64", "AMD64"}, reason="reads x86 assembly")
@pytest.mark.parametrize(("flags", "wide"), [(("-mavx2", "-mfma"), True), (("-mavx2", "-mfma", "-DWALKGEN_PLAIN"), False), ((), False)])
def test_vectors_are_used_where_they_gain(tmp_path, flags, wide):
    path = compile_c(tmp_path, SOURCE, "together.s", "-std=c99", "-O2", "-fno-math-errno", "-fno-trapping-math", "-S", *STRICT, *flags)
    text = path.read_text()
    body = text[text.index("\nsincos_3:") : text.index(".size\tsincos_3,")]
    assert bool(re.search(r"vfmadd\w+pd\s.*%ymm", body)) == wide
    assert "call" not in re.sub(r"call\s+\w*(?:sin|cos)\w*(?:@PLT)?", "", body)


def test_a_function_of_many_angles_calls_where_each_comes_alone(tmp_path):
    path = compile_c(tmp_path, SOURCE, "together.s", "-std=c99", "-O2", "-fno-math-errno", "-fno-trapping-math", "-S", *STRICT)
    text = path.read_text()
    body = text[text.index("\nmany_sincos_4:") : text.index(".size\tmany_sincos_4,")]
    assert len(re.findall(r"(?:call|bl)\s+wg_sincos_called", body)) == 4

"""The own sine, cosine and arctangent: errors against 40 digits, special values, equal bits, shared work, and the C library's instead."""

import importlib.util
import math
import platform
import re
import subprocess

import numpy as np
import pytest
from csupport_library import CSUPPORT, STRICT, compile_c
from trig_library import FARTHEST, SOURCE, ZIG, angles, beside_quarters, build, errors, extreme_points, fma_flags, points

from oracles import minimax

FUSED, TWICE, FAR, ARCTANGENT = 1.75, 2.0, 2.5, 1.6
"""Units in the last place that walkgen_trig.h admits: sine and cosine with sums of products rounded once, or twice, there in float beyond
|x| = NEAR; atan2."""
NEAR = 100.0
REALS = pytest.mark.parametrize("real", [np.float64, np.float32])
needs_zig = pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the ziglang wheel is not installed")
needs_fma = pytest.mark.skipif(not fma_flags(), reason="this processor has no fused multiply-add that a flag chooses")
needs_x86 = pytest.mark.skipif(platform.machine() not in {"x86_64", "AMD64"}, reason="reads x86 assembly")


@pytest.fixture(scope="module", params=["-DWALKGEN_NO_FMA", pytest.param("-mfma", marks=needs_fma)])
def trig(request, tmp_path_factory):
    """The functions with two roundings a multiply-add, and with one."""
    return build(tmp_path_factory.mktemp("trig"), "-O2", request.param)


def admitted(trig, x):
    """The bound on sine and cosine of each angle."""
    far = (x.dtype == np.float32) & (np.abs(x) > NEAR)
    return np.full(x.shape, FUSED) if "-mfma" in trig.flags else np.where(far, FAR, TWICE)


def bound(trig, name, columns):
    """That of any of the three."""
    return ARCTANGENT if name == "atan2" else admitted(trig, columns[0])


def hard(real, numbers, rows, seed):
    """Random angles, those next to multiples of pi/2, the ends of the range, numbers without full precision."""
    tiny = np.array([0.0, np.finfo(real).smallest_subnormal, np.finfo(real).tiny, 1e-20, 1e-9, 1e-4], real)
    end = np.nextafter(real(FARTHEST[real]), real([0, np.inf]))
    return np.concatenate([angles(real, rows, seed), beside_quarters(real, numbers), beside_quarters(real, numbers + 0.5), tiny, end])


@REALS
@pytest.mark.parametrize("name", ["sin", "cos"])
def test_error_of_sine_and_cosine(trig, real, name):
    numbers = np.unique(np.geomspace(1, FARTHEST[real] / 1.5709, 300).astype(int))
    x = hard(real, numbers, 1500, 1)
    assert (errors(name, trig(name, x), x) <= admitted(trig, x)).all()


@REALS
def test_error_of_the_arctangent(trig, real):
    for y, x in (points(real, 2000, 2), extreme_points(real, 3000, 3)):
        assert errors("atan2", trig("atan2", y, x), y, x).max() <= ARCTANGENT


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["sin", "cos"])
def test_error_next_to_every_multiple_of_a_quarter_turn(trig, name):
    x = beside_quarters(np.float64, np.arange(1, 63662))
    assert errors(name, trig(name, x), x).max() <= 0.51


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["sin", "cos", "atan2"])
def test_error_on_a_million_points(trig, name):
    for seed in range(10):
        columns = points(np.float64, 33_334, seed) if name == "atan2" else (angles(np.float64, 20_000, seed),)
        assert (errors(name, trig(name, *columns), *columns) <= bound(trig, name, columns)).all()


def long_errors(trig, name, *columns):
    """Against long double, whose own error is a thousandth of a double's unit."""
    exact = getattr(np, {"atan2": "arctan2"}.get(name, name))(*(column.astype(np.longdouble) for column in columns))
    return np.abs(trig(name, *columns) - exact) / np.spacing(np.abs(exact).astype(np.float64))


@pytest.mark.nightly
@pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="long double is no wider than double here")
@pytest.mark.parametrize("name", ["sin", "cos", "atan2"])
def test_error_on_ten_million_points(trig, name):
    """The ten largest of every hundred thousand are measured again with 40 digits."""
    for seed in range(100, 200):
        columns = points(np.float64, 33_334, seed) if name == "atan2" else (angles(np.float64, 20_000, seed),)
        found = long_errors(trig, name, *columns)
        assert (found <= bound(trig, name, columns)).all()
        worst = [column[np.argsort(found)[-10:]] for column in columns]
        assert (errors(name, trig(name, *worst), *worst) <= bound(trig, name, worst)).all()


def float_errors(trig, name, x):
    """Against double, whose error is nothing in float's units."""
    exact = getattr(np, name)(x.astype(np.float64))
    return np.abs(trig(name, x) - exact) / np.spacing(np.abs(exact).astype(np.float32)).astype(np.float64)


@pytest.mark.parametrize("name", ["sin", "cos"])
def test_float_on_a_sample_of_all_angles(trig, name):
    last = int(np.float32(1e4).view(np.int32))
    x = np.arange(0, last, 997, dtype=np.int32).view(np.float32)
    assert (float_errors(trig, name, x) <= admitted(trig, x)).all()


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["sin", "cos"])
def test_float_on_every_angle(trig, name):
    last, step = int(np.float32(1e4).view(np.int32)), 1 << 22
    for first in range(0, last, step):
        x = np.arange(first, min(first + step, last + 1), dtype=np.int32).view(np.float32)
        assert (float_errors(trig, name, x) <= admitted(trig, x)).all()


@REALS
def test_odd_even_and_mirrored(trig, real):
    x, (across, along) = angles(real, 20_000, 3), points(real, 20_000, 4)
    assert np.array_equal(trig("sin", -x), -trig("sin", x))
    assert np.array_equal(trig("cos", -x), trig("cos", x))
    assert np.array_equal(trig("atan2", -across, along), -trig("atan2", across, along))


SPECIAL = [0.0, 5e-324, 1e-310, 1e-300, 1e-45, 1e-39, 1e-30, 1.0, 2.0, 1e30, 1e38, 1e300, 1.7e308, math.inf]


def same(found, expected):
    """Equal numbers with equal signs, or no numbers both."""
    return (found == expected) & (np.signbit(found) == np.signbit(expected)) | np.isnan(found) & np.isnan(expected)


@REALS
def test_special_values_of_sine_and_cosine(trig, real):
    with np.errstate(over="ignore", invalid="ignore"):
        x = np.array([*SPECIAL, -0.0, -math.inf, math.nan, 1e5 + 1e-3, -3e6, 1e22]).astype(real)
        expected = {name: getattr(np, name)(x.astype(np.longdouble)).astype(real) for name in ("sin", "cos")}
    finite = np.isfinite(x) & (np.abs(x) <= 1e22)
    for name, values in expected.items():
        found = trig(name, x)
        assert same(found, values)[~np.isfinite(x) | (x == 0)].all()
        assert np.abs(found - values)[finite].max() <= np.finfo(real).eps
        assert np.isnan(found[~np.isfinite(x)]).all()


@REALS
def test_special_values_of_the_arctangent(trig, real):
    with np.errstate(over="ignore"):
        numbers = np.array([*SPECIAL, *(-value for value in SPECIAL), math.nan]).astype(real)
    y, x = (grid.ravel() for grid in np.meshgrid(numbers, numbers))
    found = trig("atan2", y, x)
    expected = np.array([math.atan2(*pair) for pair in zip(y.tolist(), x.tolist(), strict=True)]).astype(real)
    exact = np.isin(np.abs(y), [0, np.inf]) | np.isin(np.abs(x), [0, np.inf]) | np.isnan(y) | np.isnan(x)
    assert same(found, expected)[exact].all()
    assert (np.abs(found - expected) <= 2 * np.spacing(np.abs(expected)))[~exact].all()
    assert np.array_equal(np.signbit(found)[~np.isnan(expected)], np.signbit(y)[~np.isnan(expected)])


LANE = re.sub(r"WG_(SIN|COS|ATAN2)\b", lambda found: f"WG_NAME(wg_{found[1].lower()}_lane)", SOURCE)


@REALS
@pytest.mark.parametrize("flag", ["-DWALKGEN_NO_FMA", pytest.param("-mfma", marks=needs_fma)])
def test_lanes_give_no_number_beyond_the_range_and_the_same_ones_within(tmp_path, real, flag):
    alone, lane = build(tmp_path, "-O2", flag), build(tmp_path, "-O2", flag, source=LANE)
    ends = np.array([FARTHEST[real], -FARTHEST[real], 0.0, -0.0], real)
    within = np.concatenate([angles(real, 2000, 9), ends])
    beyond = np.concatenate([np.nextafter(ends[:2], real(np.inf) * ends[:2]), np.array([1e6, -1e30, np.inf, -np.inf, np.nan], real)])
    for name in ("sin", "cos"):
        assert lane(name, within).tobytes() == alone(name, within).tobytes()
        assert np.isnan(lane(name, beyond)).all()
    y, x = np.concatenate([extreme_points(real, 5000, 7), points(real, 500, 8)], axis=1)
    with np.errstate(over="ignore"):
        finite = np.isfinite(np.maximum(np.abs(x), np.abs(y)) * real(2))
    assert 0 < finite.mean() < 1
    assert lane("atan2", y[finite], x[finite]).tobytes() == alone("atan2", y[finite], x[finite]).tobytes()
    none = np.array([0.0, -0.0, np.inf, -np.inf, np.nan], real)
    assert np.isnan(lane("atan2", np.repeat(none, 5), np.tile(none, 5))).all()
    greatest = np.finfo(real).max
    assert np.isnan(lane("atan2", np.array([greatest], real), np.array([-greatest], real))).all()


def bits(library):
    """Everything that the functions make of some thousand arguments."""
    reals = (np.float64, np.float32)
    near = [library(name, angles(real, 20_000, 5)) for real in reals for name in ("sin", "cos")]
    return [values.tobytes() for values in (*near, *(library("atan2", *points(real, 20_000, 6)) for real in reals))]


@needs_zig
@pytest.mark.parametrize("extra", [("-DWALKGEN_NO_FMA",), pytest.param(("-mfma",), marks=needs_fma)])
def test_equal_bits_from_every_compiler_and_level(tmp_path, extra):
    expected = bits(build(tmp_path, "-O2", *extra))
    for level in ("-O0", "-O3", "-Os"):
        assert bits(build(tmp_path, level, *extra)) == expected
    assert bits(build(tmp_path, "-O2", *extra, compiler="g++", standard="-std=c++11")) == expected
    assert bits(build(tmp_path, "-O2", *extra, compiler=ZIG)) == expected


_ANGLES = """
#include "walkgen_real_f64.h"
void one(double x, double *found);
void one(double x, double *found) { found[0] = WG_SIN(x); }
void both(double x, double *found);
void both(double x, double *found) { found[0] = WG_SIN(x); found[1] = WG_COS(x); }
void arctangent(double y, double x, double *found);
void arctangent(double y, double x, double *found) { found[0] = WG_ATAN2(y, x); }
"""


def instructions(folder, name, pattern, *flags):
    """How many instructions of a function's assembly match."""
    text = compile_c(
        folder, _ANGLES, "angles.s", "-std=c99", "-fno-math-errno", "-fno-tree-slp-vectorize", "-S", *STRICT, *flags
    ).read_text()
    body = text[text.index(f"\n{name}:") : text.index(f".size\t{name},")]
    return len(re.findall(rf"^\t(?:{pattern})\s", body, re.MULTILINE))


@needs_x86
@pytest.mark.parametrize("flags", [("-O2",), ("-O3",), pytest.param(("-O2", "-mfma"), marks=needs_fma)])
def test_sine_and_cosine_share_their_work_and_do_not_jump(tmp_path, flags):
    arithmetic, jump = r"v?f?n?m?(?:mul|add|sub)\d*sd", r"j(?!mp)\w+"
    one, both = (instructions(tmp_path, name, arithmetic, *flags) for name in ("one", "both"))
    assert 15 < one <= both <= one + 4
    assert [instructions(tmp_path, name, jump, *flags) for name in ("one", "both")] == [1, 1]
    assert instructions(tmp_path, "arctangent", jump, *flags) == 2
    assert instructions(tmp_path, "arctangent", r"v?divsd", *flags) == 1


def needed(folder, *flags, source=SOURCE):
    """Undefined symbols of the loops."""
    path = compile_c(folder, source, "loops.o", "-std=c99", "-O1", "-c", *STRICT, *flags)
    listed = subprocess.run(["nm", "-u", str(path)], capture_output=True, text=True, check=True).stdout.split()
    return set(listed) - {"U", "_GLOBAL_OFFSET_TABLE_"}


def test_float_needs_no_double(tmp_path):
    start, end = SOURCE.index('#include "walkgen_real_f64.h"'), SOURCE.index('#include "walkgen_real_f32.h"')
    assert needed(tmp_path, source=SOURCE[:start] + SOURCE[end:]) == {"sinf", "cosf", "atan2f"}


# The macro alone: linking with -ffast-math would turn subnormal numbers off for the whole test process.
FAST_MATH = ("-D__FAST_MATH__", "-DWALKGEN_ALLOW_FAST_MATH")


@pytest.mark.parametrize("flags", [("-DWALKGEN_LIBM",), FAST_MATH, pytest.param(("-mfpmath=387",), marks=needs_x86)])
def test_the_c_librarys_functions_instead(tmp_path, flags):
    plain = build(tmp_path, "-O2", *flags)
    x, (across, along) = angles(np.float64, 500, 7), points(np.float64, 500, 8)
    for name in ("sin", "cos"):
        assert trig_of_python(name, x) == plain(name, x).tolist()
    assert trig_of_python("atan2", across, along) == plain("atan2", across, along).tolist()


def trig_of_python(name, *columns):
    """Python asks the same C library."""
    return [getattr(math, name)(*row) for row in zip(*(column.tolist() for column in columns), strict=True)]


@pytest.mark.nightly
def test_the_header_holds_the_numbers_of_the_exchange():
    text = (CSUPPORT / "walkgen_trig_kernel.h").read_text() + (CSUPPORT / "walkgen_trig.h").read_text()
    numbers = set(re.findall(r"\d+\.\d+(?:e-?\d+)?", text))
    for table in minimax.tables():
        assert set(table.texts) <= numbers, table.name


def test_rounded_fits_come_close_to_the_arctangents_least_error():
    """Sixteen bits and three coefficients: the exchange's error equioscillates, rounding at most doubles it."""
    family = minimax.families(0.7854, 0.5)[2]
    free = minimax.minimax(family, [], 3)
    peaks = [abs(minimax.error(family, free, r)) for r in minimax.extrema(family, free, 4)]
    assert max(peaks) < 1.001 * min(peaks)
    assert minimax.worst(family, minimax.fit(family, 3, 16)) < 2 * max(peaks)

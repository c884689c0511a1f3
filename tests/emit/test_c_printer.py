"""Every operation in C, in double and in float, against Python's own arithmetic."""

import ctypes
import math
import struct
from decimal import Decimal
from pathlib import Path

import pytest
from c_bench import CPLUSPLUS, STRICT, Builder, code, compile_object, execute, needs_gcc, needs_gplusplus, undefined, write

from walkgen.emit.c_printer import DOUBLE, FLOAT, CPrinter
from walkgen.graph.program import Code, Program
from walkgen.signature import Port

POINTS = [(0.3, -1.7, 2.25), (1.5, 1.5, -0.5), (-0.0, 0.0, 4.0), (math.nan, 1.0, 2.0), (1.0, math.nan, 2.0), (math.inf, -2.0, 0.5)]


def ieee(function):
    """Python raises where C gives NaN."""

    def total(*arguments):
        try:
            return function(*arguments)
        except (ValueError, ZeroDivisionError):
            return math.nan

    return total


def divided(a, b):
    if b:
        return a / b
    return math.copysign(math.inf, a) * math.copysign(1, b) if a and not math.isnan(a) else math.nan


REAL = {
    Code.NEG: lambda a: -a,
    Code.ADD: lambda a, b: a + b,
    Code.SUB: lambda a, b: a - b,
    Code.MUL: lambda a, b: a * b,
    Code.DIV: divided,
    Code.FMA: lambda a, b, c: a * b + c,
    Code.FMS: lambda a, b, c: a * b - c,
    Code.FNMA: lambda a, b, c: c - a * b,
    Code.SQRT: ieee(math.sqrt),
    Code.SIN: ieee(math.sin),
    Code.COS: ieee(math.cos),
    Code.TAN: ieee(math.tan),
    Code.ATAN2: math.atan2,
    Code.ABS: abs,
    Code.MIN: lambda a, b: a if a < b else b,
    Code.MAX: lambda a, b: a if a > b else b,
}
TRUTH = {
    Code.LESS: lambda a, b: a < b,
    Code.LESS_EQUAL: lambda a, b: a <= b,
    Code.EQUAL: lambda a, b: a == b,
    Code.FINITE: math.isfinite,
    Code.AND: lambda a, b: a < b < a + 2,
    Code.OR: lambda a, b: a < b or b < a,
    Code.NOT: lambda a, b: not a < b,
}
ALL = REAL | TRUTH
ORDER = [*REAL, *list(TRUTH)[::2], *list(TRUTH)[1::2]]
"""The outputs of `everything`: numbers, truths through SELECT, truths through INDICATOR."""
ARITY = dict.fromkeys((Code.FMA, Code.FMS, Code.FNMA), 3)
ARITY |= dict.fromkeys((Code.NEG, Code.SQRT, Code.SIN, Code.COS, Code.TAN, Code.ABS, Code.FINITE), 1)


def everything() -> Program:
    """Every operation once, one output each; truth values as 1 or 0."""
    b = Builder(Port("x", (3,)))
    values = [b.add(opcode, *range(ARITY.get(opcode, 2))) for opcode in REAL]
    one, zero, two = b.constant("1"), b.constant("0"), b.constant("2")
    less = b.add(Code.LESS, 0, 1)
    arguments = {
        Code.AND: (less, b.add(Code.LESS, 1, b.add(Code.ADD, 0, two))),
        Code.OR: (less, b.add(Code.LESS, 1, 0)),
        Code.NOT: (less,),
    }
    truths = [b.add(opcode, *arguments.get(opcode, range(ARITY.get(opcode, 2)))) for opcode in TRUTH]
    values += [b.add(Code.SELECT, truth, one, zero) for truth in truths[::2]] + [b.add(Code.INDICATOR, truth) for truth in truths[1::2]]
    return b.program("everything", [Port("y", (len(values),))], values)


def single(value: float) -> float:
    return ctypes.c_float(value).value


def main_of(real: str, prefix: str, header: str) -> str:
    rows = ", ".join("{" + ", ".join(f"({real})({literal(value)})" for value in point) + "}" for point in POINTS)
    count = len(REAL) + len(TRUTH)
    return f"""
#include <math.h>
#include <stdio.h>
#include "{header}"
int main(void) {{
    static const {real} x[{len(POINTS)}][3] = {{{rows}}};
    for (int i = 0; i < {len(POINTS)}; ++i) {{
        {real} y[{count}];
        {prefix}_leg_everything(x[i], y);
        for (int j = 0; j < {count}; ++j) {{
            printf("%.17g\\n", (double)y[j]);
        }}
    }}
    return 0;
}}
"""


def literal(value: float) -> str:
    return "NAN" if math.isnan(value) else "INFINITY" if math.isinf(value) else repr(value)


def expected(round_to=float) -> list[float]:
    rows = [tuple(round_to(value) for value in point) for point in POINTS]
    return [float(ALL[opcode](*row[: ARITY.get(opcode, 2)])) for row in rows for opcode in ORDER]


def assert_close(got: list[str], wanted: list[float], relative: float) -> None:
    assert len(got) == len(wanted)
    names = [opcode.value for opcode in ORDER]
    for place, (text, value) in enumerate(zip(got, wanted, strict=True)):
        where = f"{names[place % len(names)]} at {POINTS[place // len(names)]}"
        if math.isnan(value):
            assert math.isnan(float(text)), where
        else:
            assert float(text) == pytest.approx(value, rel=relative, abs=relative), where


def test_every_operation_is_covered():
    assert {*REAL, *TRUTH, Code.SELECT, Code.INDICATOR, Code.EPSILON, Code.INPUT, Code.CONSTANT} == set(Code)


@needs_gcc
@pytest.mark.parametrize("fma", [True, False])
@pytest.mark.parametrize("extra", [(), ("-mfma",)])
def test_double_agrees_with_python(tmp_path, fma, extra):
    write(tmp_path, code(everything(), fma=fma))
    flags = (*STRICT, *extra) if extra_runs_here(extra) else STRICT
    assert_close(execute(tmp_path, main_of("double", "bot", "bot.h"), ["bot.c"], *flags), expected(), 1e-15)


def extra_runs_here(extra: tuple[str, ...]) -> bool:
    """Whether this processor has what the flags ask for."""
    cpu = Path("/proc/cpuinfo")
    return not extra or (cpu.exists() and " fma " in cpu.read_text())


@needs_gcc
def test_float_agrees_with_python(tmp_path):
    write(tmp_path, code(everything()))
    got = execute(tmp_path, main_of("float", "bot_f32", "bot_f32.h"), ["bot_f32.c"], *STRICT)
    assert_close(got, expected(single), 4e-7)


@needs_gcc
@pytest.mark.parametrize(("real", "prefix", "epsilon"), [("double", "bot", 2.0**-52), ("float", "bot_f32", 2.0**-23)])
def test_epsilon_is_that_of_the_precision(tmp_path, real, prefix, epsilon):
    b = Builder(Port("x", (1,)))
    write(tmp_path, code(b.program("epsilon", [Port("y", (1,))], [b.add(Code.EPSILON)])))
    call = f"{real} x[1] = {{0}}, y[1]; {prefix}_leg_epsilon(x, y);"
    main = f'#include <stdio.h>\n#include "{prefix}.h"\nint main(void) {{ {call} printf("%.17g\\n", (double)y[0]); return 0; }}\n'
    assert [float(text) for text in execute(tmp_path, main, [f"{prefix}.c"], *STRICT)] == [epsilon]


@needs_gcc
def test_float_object_calls_no_double_function(tmp_path):
    write(tmp_path, code(everything()))
    helpers = undefined(compile_object(tmp_path / "bot_f32.c", *STRICT, "-fno-builtin"))
    assert {"sinf", "cosf", "atan2f", "sqrtf", "tanf"} <= helpers
    assert not [name for name in helpers if name in {"sin", "cos", "tan", "atan2", "sqrt", "fabs", "fmin", "fmax", "fma"}]
    text = (tmp_path / "bot_f32.c").read_text()
    assert "double " not in text.split("#include")[-1]


@needs_gplusplus
def test_compiles_as_cplusplus(tmp_path):
    write(tmp_path, code(everything()))
    for source in ("bot.c", "bot_f32.c"):
        compile_object(tmp_path / source, *CPLUSPLUS, compiler="g++")


@needs_gcc
def test_fast_math_is_refused_unless_allowed(tmp_path):
    write(tmp_path, code(everything()))
    with pytest.raises(AssertionError, match="WALKGEN_ALLOW_FAST_MATH"):
        compile_object(tmp_path / "bot.c", "-std=c99", "-ffast-math")
    compile_object(tmp_path / "bot.c", "-std=c99", "-ffast-math", "-DWALKGEN_ALLOW_FAST_MATH")


@pytest.mark.parametrize("text", ["0.1", "-3.14159265358979323846264338327950288419717", "1e300", "123456789.123456789", "5e-324", "1"])
def test_double_literal_is_the_nearest_double(text):
    assert float(DOUBLE.literal(Decimal(text))) == float(Decimal(text))
    assert any(mark in DOUBLE.literal(Decimal(text)) for mark in ".e")


@pytest.mark.parametrize(
    "text", ["0.1", "-3.14159265358979323846264338327950288419717", "1e30", "16777217", "0.3333333333333333333", "1.4e-45"]
)
def test_float_literal_has_nine_digits_and_a_suffix(text):
    written = FLOAT.literal(Decimal(text))
    assert written.endswith("f")
    assert single(float(written[:-1])) == struct.unpack("f", struct.pack("f", float(text)))[0]


def test_float_literal_never_underflows_or_overflows_silently():
    assert FLOAT.literal(Decimal("1e-60")) == "0.0f"
    with pytest.raises(AssertionError, match="does not fit float"):
        FLOAT.literal(Decimal("1e39"))


def test_not_a_number_and_infinity_have_names():
    assert DOUBLE.literal(Decimal("NaN")) == "WG_NAN"
    assert DOUBLE.literal(Decimal("-Infinity")) == "-WG_INFINITY"


def test_a_function_of_more_angles_than_one_vector_holds_may_call_their_sines():
    printer = CPrinter(DOUBLE, fma=True)
    assert (printer.together(4)[Code.SIN], printer.together(5)[Code.SIN]) == ("WG_SINCOS_{0}", "WG_MANY_SINCOS_{0}")

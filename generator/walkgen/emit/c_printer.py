"""How operations are written in C, in double or in true float."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Context, Decimal
from functools import cached_property
from typing import Literal

from walkgen.emit.walker import Form, Level, Text
from walkgen.graph.passes import TOGETHER
from walkgen.graph.program import Code
from walkgen.signature import Port

_FLOAT_LARGEST = Decimal("3.40282346e38")
_FLOAT_LEAST = Decimal("7.1e-46")
_NINE_DIGITS = Context(prec=9)


@dataclass(frozen=True)
class Precision:
    """A C floating type: `suffix` of libm's functions, `tag` in names, `header` that sets support routines to it."""

    real: str
    suffix: str
    tag: str
    header: str
    size: int

    def literal(self, value: Decimal) -> str:
        """The number as a C constant: the nearest double, or nine digits and `f`."""
        if not value.is_finite():
            return f"{'-' if value.is_signed() else ''}{'WG_NAN' if value.is_nan() else 'WG_INFINITY'}"
        text = repr(float(value)) if self.real == "double" else _float_digits(value)
        if text in {"inf", "-inf"}:
            raise AssertionError(f"a constant does not fit {self.real}: {value}")
        return text + self.suffix


DOUBLE = Precision("double", "", "", "walkgen_real_f64.h", 8)
FLOAT = Precision("float", "f", "f32", "walkgen_real_f32.h", 4)


def _float_digits(value: Decimal) -> str:
    if abs(value) > _FLOAT_LARGEST:
        raise AssertionError(f"a constant does not fit float: {value}")
    if abs(value) < _FLOAT_LEAST:
        return "0.0"
    text = repr(float(_NINE_DIGITS.create_decimal(value)))
    return text if re.search(r"[.e]", text) else f"{text}.0"


_OPERATORS: dict[Code, Form] = {
    Code.NEG: Form("-{0}", Level.UNARY, (Level.ATOM,)),
    Code.ADD: Form("{0} + {1}", Level.SUM, (Level.SUM, Level.PRODUCT)),
    Code.SUB: Form("{0} - {1}", Level.SUM, (Level.SUM, Level.PRODUCT)),
    Code.MUL: Form("{0}*{1}", Level.PRODUCT, (Level.PRODUCT, Level.UNARY)),
    Code.DIV: Form("{0}/{1}", Level.PRODUCT, (Level.PRODUCT, Level.UNARY)),
    Code.SIN: Form("WG_SIN({0})"),
    Code.COS: Form("WG_COS({0})"),
    Code.ATAN2: Form("WG_ATAN2({0}, {1})"),
    Code.MIN: Form("WG_MIN({0}, {1})"),
    Code.MAX: Form("WG_MAX({0}, {1})"),
    Code.INDICATOR: Form("WG_INDICATOR({0})"),
    Code.LESS: Form("{0} < {1}", Level.COMPARE, (Level.SUM, Level.SUM)),
    Code.LESS_EQUAL: Form("{0} <= {1}", Level.COMPARE, (Level.SUM, Level.SUM)),
    Code.EQUAL: Form("{0} == {1}", Level.COMPARE, (Level.SUM, Level.SUM)),
    Code.FINITE: Form("isfinite({0})"),
    Code.AND: Form("{0} && {1}", Level.AND, (Level.COMPARE, Level.COMPARE)),
    Code.OR: Form("{0} || {1}", Level.OR, (Level.COMPARE, Level.COMPARE)),
    Code.NOT: Form("!{0}", Level.UNARY, (Level.ATOM,)),
    Code.EPSILON: Form("WG_EPSILON"),
    Code.SELECT: Form("WG_SELECT({0}, {1}, {2})"),
}
_FUSED: dict[Code, Form] = {
    Code.FMA: Form("WG_FMA({0}, {1}, {2})"),
    Code.FMS: Form("WG_FMA({0}, {1}, -{2})", needs=(Level.ANY, Level.ANY, Level.ATOM)),
    Code.FNMA: Form("WG_FMA(-{0}, {1}, {2})", needs=(Level.ATOM, Level.ANY, Level.ANY)),
}
_APART: dict[Code, Form] = {
    Code.FMA: Form("{0}*{1} + {2}", Level.SUM, (Level.PRODUCT, Level.UNARY, Level.PRODUCT)),
    Code.FMS: Form("{0}*{1} - {2}", Level.SUM, (Level.PRODUCT, Level.UNARY, Level.PRODUCT)),
    Code.FNMA: Form("{2} - {0}*{1}", Level.SUM, (Level.PRODUCT, Level.UNARY, Level.SUM)),
}
_LIBM = {Code.SQRT: "sqrt", Code.TAN: "tan", Code.ABS: "fabs"}

_WORDS = """
alignas alignof and and_eq asm atomic auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl concept const
consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast else enum
explicit export extern false far float for friend goto i386 if inline int int8_t int16_t int32_t int64_t linux long main mutable
namespace near new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires restrict
return short signed size_t sizeof small static static_assert static_cast struct switch template this thread_local throw true try
typedef typeid typename typeof uint8_t uint16_t uint32_t uint64_t union unix unsigned using virtual void volatile wchar_t while xor
xor_eq acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh div drem erf erfc exp exp2 expm1 fabs fdim finite floor fma
fmax fmin fmod frexp gamma hypot ilogb isfinite isgreater isinf isless isnan isnormal j0 j1 jn ldexp lgamma llrint llround log log10
log1p log2 logb lrint lround modf nan nearbyint nextafter nexttoward pow pow10 remainder remquo rint round scalb scalbln scalbn
signbit significand signgam sin sincos sinh sqrt tan tanh tgamma trunc y0 y1 yn abs errno index I NAN NULL INFINITY HUGE_VAL row rows
ok bad
"""
RESERVED = frozenset(_WORDS.split())
"""Keywords of C99 and C++20, libm's names, macros of common systems, and what the generated frames use themselves."""


@dataclass(frozen=True)
class CPrinter:
    """Writes operations in one precision; `fma` fuses multiply-add where the target has it.

    A function for `usual` inputs gives up beyond the range of sines and arctangents; one for the `rest` calls them.
    """

    precision: Precision
    fma: bool
    inputs: Literal["all", "usual", "rest"] = "all"

    @cached_property
    def forms(self) -> Mapping[Code, Form]:
        """One entry for each operation."""
        suffix = self.precision.suffix
        calls = {code: Form(f"{name}{suffix}({{0}})") for code, name in _LIBM.items()}
        return _OPERATORS | calls | (_FUSED if self.fma else _APART)

    def together(self, angles: int) -> Mapping[Code, str]:
        """Macros of walkgen_together.h."""
        start = {"all": "WG", "usual": "WG_NEAR", "rest": "WG_REST"}[self.inputs]
        return {Code.SIN: f"{start}_SINCOS_{{0}}" if angles <= TOGETHER else "WG_MANY_SINCOS_{0}", Code.ATAN2: f"{start}_ATAN2_{{0}}"}

    @property
    def sums(self) -> tuple[str, str]:
        """Macros of walkgen_together.h: the C library's sines are quicker by parts."""
        return "WG_PART({0}, {1})", "WG_TURN({0}, {1}, {2}, {3})"

    @property
    def reserved(self) -> frozenset[str]:
        """Names that a local must not take."""
        return RESERVED

    def constant(self, value: Decimal) -> Text:
        """A literal, rounded to the precision."""
        text = self.precision.literal(value)
        return Text(text, Level.UNARY if text.startswith("-") else Level.ATOM)

    def element(self, port: Port, index: int) -> Text:
        """`q[1]`, or `x` for a scalar, which comes by value; integers are converted."""
        text = f"{port.name}[{index}]" if port.shape else port.name
        return Text(text) if port.kind == "real" else Text(f"({self.precision.real}){text}", Level.UNARY)

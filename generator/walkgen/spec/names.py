"""Which names a spec may give: they become C, C++ and Python names, so every keyword and mathematical function is taken."""

import keyword
import re
from typing import Final

PATTERN: Final = re.compile(r"[a-z][a-z0-9_]{0,30}")

_C99 = (
    "auto break case char const continue default do double else enum extern float for goto if inline int long register restrict return "
    "short signed sizeof static struct switch typedef union unsigned void volatile while asm"
)
_CPP20 = (
    "alignas alignof and and_eq bitand bitor bool catch char8_t char16_t char32_t class compl concept consteval constexpr constinit "
    "const_cast co_await co_return co_yield decltype delete dynamic_cast explicit export false friend mutable namespace new noexcept not "
    "not_eq nullptr operator or or_eq private protected public reinterpret_cast requires static_assert static_cast template this "
    "thread_local throw true try typeid typename using virtual wchar_t xor xor_eq"
)
_LIBM = (
    "acos asin atan atan2 cos sin tan acosh asinh atanh cosh sinh tanh exp exp2 expm1 frexp ilogb ldexp log log10 log1p log2 logb modf "
    "scalbn scalbln cbrt fabs hypot pow sqrt erf erfc lgamma tgamma ceil floor nearbyint rint lrint llrint round lround llround trunc "
    "fmod remainder remquo copysign nan nextafter nexttoward fdim fmax fmin fma fpclassify isfinite isinf isnan isnormal signbit "
    "isgreater isgreaterequal isless islessequal islessgreater isunordered"
)
_EXPRESSIONS = ("pi",)
_OWN_PREFIXES = ("walkgen", "wg")


def _reasons() -> dict[str, str]:
    libm = _LIBM.split()
    libm += [name + suffix for name in libm for suffix in "fl"]
    reasons = dict.fromkeys(_EXPRESSIONS, "a constant of the spec language") | dict.fromkeys(libm, "a function of the C library")
    reasons |= dict.fromkeys(keyword.kwlist, "a keyword of Python") | dict.fromkeys(_CPP20.split(), "a keyword of C++")
    return reasons | dict.fromkeys(_C99.split(), "a keyword of C")


RESERVED: Final = _reasons()
"""Every name that is taken, with what takes it."""


def suggestion(text: str) -> str:
    """An allowed name like the text, empty if none suggests itself."""
    name = re.sub(r"[^a-z0-9]+", "_", text[:200].lower()).strip("_")[:31]
    name = name if not name or name[0].isalpha() else f"n{name}"[:31]
    return f"{name[:29]}_1" if name in RESERVED else name


def is_own_prefix(robot: str) -> bool:
    """Whether the robot's generated names could meet those of the support code."""
    return robot.split("_", maxsplit=1)[0] in _OWN_PREFIXES

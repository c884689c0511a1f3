"""Expressions of a spec: whitelisted arithmetic, exact where it is rational, and never code."""

from contextlib import suppress
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp

from walkgen.spec.scalar import Apply, Exact, ExpressionError, Name, Pi, degrees, evaluate, exact, names, parse, substitute

RATIONAL = {
    "1/3*3": 1,
    "-(2)**2": -4,
    "2**-3": Fraction(1, 8),
    "0x10": 16,
    "1_000*2": 2000,
    "0.1 + 0.2": Fraction(3, 10),
    "--1.5": Fraction(3, 2),
}
REFUSED = [
    "",
    "1 +",
    "(1",
    "1;2",
    "x := 2",
    "1 if 2 else 3",
    "[1]",
    "a.b",
    "a[0]",
    "lambda: 1",
    "f'{1}'",
    "'a'",
    "True",
    "1j",
    "1 < 2",
    "not 1",
    "__import__('os').system('true')",
    "sin()",
    "sin(1, 2)",
    "sin(x=1)",
    "sin(*a)",
    "max(1, 2)",
    "eval('1')",
    "1//2",
    "1 % 2",
    "1 @ 2",
    "~1",
    "1/0",
    "1/(2-2)",
    "0**-1",
    "2**0.5",
    "2**x",
    "2**65",
    "((9**64)**64)**64",
    "1e400",
    "9" * 1001,
    "(" * 900,
    "-" * 900 + "1",
    "\x00",
]


@pytest.mark.parametrize("text", RATIONAL)
def test_rational_arithmetic_is_exact(text: str) -> None:
    assert parse(text) == Exact(Fraction(RATIONAL[text]))


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: text[:12] or "empty")
def test_everything_else_is_refused(text: str) -> None:
    with pytest.raises(ExpressionError) as error:
        parse(text)
    assert str(error.value)


@given(st.text(max_size=60))
def test_any_text_is_arithmetic_or_refused(text: str) -> None:
    with suppress(ExpressionError):
        assert isinstance(parse(text), Exact | Pi | Name | Apply)


def test_names_are_found_and_replaced() -> None:
    scalar = parse("2*thigh - sin(shank)/pi")
    assert names(scalar) == {"thigh", "shank"}
    assert names(substitute(scalar, {"shank": exact(0)})) == {"thigh"}
    assert substitute(parse("2*thigh - 0.05"), {"thigh": exact(Fraction(1, 2))}) == exact(Fraction(95, 100))


@given(st.fractions(-720, 720, max_denominator=1000))
def test_degrees_are_radians(angle: Fraction) -> None:
    expected = mp.radians(mp.mpf(angle.numerator) / angle.denominator)
    assert abs(evaluate(degrees(exact(angle)), mp, {}) - expected) < mp.mpf(10) ** -13


def test_values_follow_the_tree() -> None:
    value = evaluate(parse("hypot(3, 4) + atan2(1, x)**2 - sqrt(-x + 3) / cos(0)"), mp, {"x": mp.mpf(1)})
    assert abs(value - (5 + (mp.pi / 4) ** 2 - mp.sqrt(2))) < mp.mpf(10) ** -13

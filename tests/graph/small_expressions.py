"""Random small sympy expressions and Functions around them, for hypothesis."""

from collections.abc import Callable, Sequence
from typing import Any

import sympy
from hypothesis import strategies as st
from mpmath.ctx_mp import MPContext

from walkgen.graph.interpret import interpret
from walkgen.graph.program import Program
from walkgen.signature import Port, Signature
from walkgen.symbolic.function import Function

DIGITS = 60
CONTEXT = MPContext()
CONTEXT.dps = DIGITS
SYMBOLS = sympy.symbols("x y z")
SMOOTH: tuple[Callable[..., Any], ...] = (
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (2 + b**2),
    lambda a, b: sympy.sin(a) * b,
    lambda a, b: sympy.cos(a) - b,
    lambda a, _: sympy.tan(sympy.sin(a)),
    lambda a, b: sympy.sqrt(1 + a**2 + b**2),
    lambda a, b: (3 + sympy.cos(a)) ** sympy.Rational(-3, 2) * b,
    lambda a, _: a**3,
    lambda a, _: -a,
    lambda a, b: sympy.atan2(a, 2 + b**2),
)
ORDERLY = (*SMOOTH[:1], *SMOOTH[2:5], *SMOOTH[7:10])
"""Those that sympy rewrites alike whatever the symbols' names; differences inside sin may change sign."""

LEAVES = (*SYMBOLS, *SYMBOLS, sympy.Rational(1, 3), sympy.Integer(-2), sympy.pi, sympy.sqrt(2), sympy.Rational(-7, 5))
POINTS = st.tuples(*[st.integers(-3000, 3000).map(lambda n: sympy.Rational(n, 1009))] * 3)


@st.composite
def expressions(draw: Callable[[Any], Any], operations: Sequence[Callable[..., Any]] = SMOOTH, leaves: Sequence[Any] = LEAVES) -> Any:
    """An expression in x, y, z of up to six operations; earlier ones may be used again."""
    values = list(leaves)
    for _ in range(draw(st.integers(1, 6))):
        recent = st.sampled_from(values[-4:] + list(SYMBOLS))
        values.append(draw(st.sampled_from(operations))(draw(recent), draw(st.sampled_from(values))))
    return values[-1]


def function_of(*outputs: Any, symbols: Sequence[Any] = SYMBOLS, tape: Sequence[tuple[Any, Any]] = ()) -> Function:
    """A Function of x [n] with the outputs as y [count]."""
    ports = (Port("x", (len(symbols),)),)
    words = Signature("toy", "leg", "small", ports, (Port("y", (len(outputs),)),))
    return Function(words, tuple(symbols), tuple(tape), tuple(sympy.sympify(output) for output in outputs))


def values_of(program: Program, point: Sequence[Any], port: str = "y") -> list[Any]:
    """The Program at a point of rationals, to 60 digits."""
    numbers = [CONTEXT.mpf(int(sympy.numer(x))) / int(sympy.denom(x)) for x in point]
    return interpret(program, {"x": numbers}, CONTEXT)[port]


def evaluated(expression: Any, point: Sequence[Any], symbols: Sequence[Any] = SYMBOLS) -> Any:
    """sympy's own value, to 60 digits."""
    return CONTEXT.mpf(str(sympy.sympify(expression).subs(dict(zip(symbols, point, strict=True))).evalf(DIGITS)))


def close(found: Any, expected: Any, digits: int = 35) -> bool:
    """Equal to so many digits, relative to values above 1."""
    return bool(abs(found - expected) <= CONTEXT.mpf(10) ** -digits * max(1, abs(expected)))

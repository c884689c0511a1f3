"""Lowering against sympy's own evaluation, and that the names of symbols do not change the Program."""

import math
from decimal import Decimal
from itertools import pairwise

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from small_expressions import ORDERLY, POINTS, SYMBOLS, close, evaluated, expressions, function_of, values_of

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Code
from walkgen.symbolic import function as symbolic

QUICK = settings(derandomize=True, deadline=None, max_examples=120)
x, y, z = SYMBOLS
NAN, INF = math.nan, math.inf
TRIPLES = ((1.0, 2.0, 3.0), (2.0, 1.0, -3.0), (2.0, 2.0, 0.0), (NAN, 1.0, 5.0), (1.0, NAN, 5.0), (INF, INF, 7.0), (-0.0, 0.0, NAN))


@QUICK
@given(expressions(), expressions(), POINTS, st.booleans())
def test_values_are_sympys(first, second, point, fma):
    program = lower(function_of(first, second, first * second), fma)
    expected = [evaluated(expression, point) for expression in (first, second, first * second)]
    assert all(close(found, value) for found, value in zip(values_of(program, point), expected, strict=True))


@pytest.mark.parametrize(
    "expression",
    [
        -(1 - sympy.sqrt(2) - sympy.sqrt(3)) * x,
        sympy.Mul(sympy.Integer(-1), x, y - z, evaluate=False),
        -x - y - z,
        x / (y * z) ** 2,
        sympy.Rational(-3, 7) / x,
        x ** sympy.Rational(5, 2),
        1 / sympy.sqrt(x),
        sympy.pi / x - sympy.sqrt(2) * y / sympy.pi,
        sympy.Float("0.1234567890123456789012345678901234567890", 40) * x,
        sympy.Integer(4),
        x,
    ],
    ids=str,
)
def test_signs_and_powers(expression):
    point = (sympy.Rational(7, 3), sympy.Rational(11, 5), sympy.Rational(-13, 17))
    assert close(values_of(lower(function_of(expression)), point)[0], evaluated(expression, point))


def test_intermediates_are_used_in_any_order_and_depth():
    """A tape of 5000 steps: no recursion limit, and only what the output needs."""
    steps = sympy.symbols("step:5000")
    tape = [(steps[0], x + y)]
    tape += [(after, before / 2 + z) for before, after in pairwise(steps)]
    program = lower(function_of(steps[-1], tape=tape), fma=False)
    assert program.operation_count == 1 + 2 * 4999
    assert interpret(program, {"x": [1, 2, 0.5]})["y"][0] == pytest.approx(1.0)
    assert lower(function_of(steps[0], tape=tape)).operation_count == 1


def test_names_of_intermediates_are_kept():
    """The reader finds the derivation's names again."""
    total, product = sympy.symbols("total product")
    program = lower(function_of(product, tape=[(total, x + y), (product, total * z)]))
    assert {op.name: op.code for op in program.ops if op.name} == {"total": Code.ADD, "product": Code.MUL}


@QUICK
@given(expressions(ORDERLY, (*SYMBOLS, sympy.Rational(3, 2))), st.permutations(["thigh", "a", "q[0]"]))
def test_names_of_symbols_do_not_order_operands(expression, names):
    symbols = tuple(map(sympy.Symbol, names))
    renamed = expression.xreplace(dict(zip(SYMBOLS, symbols, strict=True)))
    assert unnamed(lower(function_of(expression))) == unnamed(lower(function_of(renamed, symbols=symbols)))


def test_names_of_intermediates_do_not_order_them():
    def program(first, second):
        a, b = sympy.symbols(f"{first} {second}")
        tape = [(a, x * sympy.sin(y)), (b, y * sympy.sin(x))]
        return unnamed(lower(function_of(a / (1 + b**2) + a * b, b - a, tape=tape)))

    assert program("left", "right") == program("right", "left") == program("z2", "z10")


def unnamed(program):
    return tuple(op._replace(name="") for op in program.ops), program.outputs


TRUTHS = {
    "less": (symbolic.Less(x, y), lambda a, b: a < b),
    "less or equal": (symbolic.LessEqual(x, y), lambda a, b: a <= b),
    "same": (symbolic.Same(x, y), lambda a, b: a == b),
    "finite": (symbolic.Finite(x), lambda a, _: math.isfinite(a)),
    "both": (symbolic.Both(symbolic.Less(0, x), symbolic.Less(0, y)), lambda a, b: a > 0 and b > 0),
    "either": (symbolic.Either(symbolic.Less(0, x), symbolic.Less(0, y)), lambda a, b: a > 0 or b > 0),
    "opposite": (symbolic.Opposite(symbolic.Less(x, y)), lambda a, b: not a < b),
}


@pytest.mark.parametrize("name", TRUTHS)
def test_conditions(name):
    truth, expected = TRUTHS[name]
    program = lower(function_of(symbolic.Select(truth, 1, -1)))
    for row in TRIPLES:
        assert interpret(program, {"x": row})["y"] == [1 if expected(*row[:2]) else -1], row


def test_indicator_and_epsilon():
    program = lower(function_of(symbolic.Indicator(symbolic.Less(x, y)) * z + symbolic.Epsilon()))
    assert interpret(program, {"x": [1, 2, 4]})["y"] == [4 + 2.0**-52]
    assert interpret(program, {"x": [2, 1, 4]})["y"] == [2.0**-52]


def test_known_conditions_vanish():
    assert symbolic.Select(symbolic.Both(sympy.false, symbolic.Less(x, y)), x, y) == y
    assert symbolic.Either(symbolic.Less(x, y), sympy.false) == symbolic.Less(x, y)
    assert symbolic.Select(symbolic.Less(x, y), z, z) == z


@pytest.mark.parametrize("row", TRIPLES)
def test_residue_is_zero_or_nan(row):
    found = interpret(lower(function_of(symbolic.Residue(x) + symbolic.Residue(z))), {"x": row})["y"][0]
    assert found == 0 if math.isfinite(row[0]) and math.isfinite(row[2]) else math.isnan(found)


@pytest.mark.parametrize("row", [(0.0, -1.0, 0), (-0.0, -1.0, 0), (1.0, 0.0, 0), (-1.0, -1.0, 0), (0.0, 0.0, 0)])
def test_angle_is_the_c_librarys(row):
    assert interpret(lower(function_of(symbolic.Angle(x, y))), {"x": row})["y"] == [math.atan2(*row[:2])]


def test_infinite_constants_keep_their_signs():
    program = lower(function_of(-sympy.oo, sympy.oo))
    assert [op.value for op in program.ops if op.code is Code.CONSTANT] == [Decimal("-Infinity"), Decimal("Infinity")]

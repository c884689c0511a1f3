"""Value numbering: what shares a number, what folds, where signs go, and that the value stays the same."""

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_expressions import CONTEXT

from walkgen.graph.interpret import interpret
from walkgen.graph.number import Numbering
from walkgen.graph.program import Code, Program
from walkgen.signature import Port, Signature

WORDS = Signature("toy", "", "numbered", (Port("x", (3,)),), (Port("y"),))
A, B, C = range(3)


@pytest.fixture
def numbering():
    return Numbering(WORDS)


def test_inputs_stand_first_and_in_order(numbering):
    assert [(op.code, op.element) for op in numbering.ops] == [(Code.INPUT, (0, index)) for index in range(3)]


@pytest.mark.parametrize("code", [Code.ADD, Code.MUL])
def test_order_of_commuting_operands_does_not_matter(numbering, code):
    assert numbering.op(code, A, B) == numbering.op(code, B, A)


@pytest.mark.parametrize("code", [Code.SUB, Code.DIV, Code.ATAN2, Code.LESS, Code.MIN, Code.MAX])
def test_order_of_other_operands_matters(numbering, code):
    assert numbering.op(code, A, B) != numbering.op(code, B, A)
    assert numbering.op(code, A, B) == numbering.op(code, A, B)


def test_constants_share_by_value(numbering):
    assert numbering.constant(Decimal("0.50")) == numbering.constant(Decimal("0.5"))
    assert numbering.constant(Decimal("-0")) == numbering.constant(Decimal(0))
    assert numbering.constant(Decimal("0.5")) != numbering.constant(Decimal("-0.5"))


FOLDED = [
    (Code.ADD, "0.1", "0.2", Fraction(3, 10)),
    (Code.SUB, "1", "1e-30", 1 - Fraction(1, 10**30)),
    (Code.MUL, "1.1", "-3", Fraction(-33, 10)),
    (Code.DIV, "1", "3", Fraction(1, 3)),
]


@pytest.mark.parametrize(("code", "left", "right", "expected"), FOLDED)
def test_constants_fold_to_fifty_digits(numbering, code, left, right, expected):
    number = numbering.op(code, *(numbering.constant(Decimal(text)) for text in (left, right)))
    op = numbering.ops[number]
    assert op.code is Code.CONSTANT
    assert abs(Fraction(op.value) - expected) <= Fraction(1, 10**49)


def test_nothing_is_left_of_zeros_and_ones(numbering):
    zero, one, op = numbering.constant(Decimal(0)), numbering.constant(Decimal(1)), numbering.op
    assert op(Code.ADD, A, zero) == op(Code.ADD, zero, A) == op(Code.SUB, A, zero) == A
    assert op(Code.MUL, A, one) == op(Code.MUL, one, A) == op(Code.DIV, A, one) == A
    assert op(Code.MUL, A, zero) == op(Code.MUL, zero, A) == zero
    assert op(Code.SUB, zero, A) == op(Code.NEG, A)
    assert op(Code.DIV, zero, A) != zero  # 0/0 is not 0


def test_signs_move_out_of_products_and_into_sums(numbering):
    op = numbering.op
    minus_a, minus_b = op(Code.NEG, A), op(Code.NEG, B)
    assert op(Code.NEG, minus_a) == A
    for code in (Code.MUL, Code.DIV):
        assert op(code, minus_a, minus_b) == op(code, A, B)
        assert op(code, minus_a, B) == op(code, A, minus_b) == op(Code.NEG, op(code, A, B))
    assert op(Code.ADD, A, minus_b) == op(Code.ADD, minus_b, A) == op(Code.SUB, A, B)
    assert op(Code.SUB, A, minus_b) == op(Code.ADD, A, B)
    assert op(Code.ADD, minus_a, minus_b) == op(Code.SUB, minus_a, B) == op(Code.NEG, op(Code.ADD, A, B))
    assert op(Code.NEG, op(Code.SUB, A, B)) == op(Code.SUB, B, A)
    assert op(Code.COS, minus_a) == op(Code.COS, A)
    assert op(Code.SIN, minus_a) == op(Code.NEG, op(Code.SIN, A))


def test_the_first_name_stays_and_inputs_have_none(numbering):
    total = numbering.op(Code.ADD, A, B)
    for number, name in ((total, "first"), (total, "second"), (A, "input")):
        assert numbering.named(number, name) == number
    assert [op.name for op in numbering.ops] == ["", "", "", "first"]


ARITHMETIC = {
    Code.NEG: lambda a: -a,
    Code.ADD: lambda a, b: a + b,
    Code.SUB: lambda a, b: a - b,
    Code.MUL: lambda a, b: a * b,
    Code.DIV: lambda a, b: a / b,
    Code.SIN: CONTEXT.sin,
    Code.COS: CONTEXT.cos,
    Code.ABS: abs,
}
UNARY = {Code.NEG, Code.SIN, Code.COS, Code.ABS}
STEPS = st.lists(st.tuples(st.sampled_from(list(ARITHMETIC)), st.integers(0, 10**6), st.integers(0, 10**6)), min_size=1, max_size=15)


@settings(derandomize=True, deadline=None, max_examples=300)
@given(STEPS, st.lists(st.integers(-5, 5), min_size=3, max_size=3))
def test_values_are_those_of_the_operations_asked_for(steps, point):
    """Python's own arithmetic beside the numbering, step by step; small integers and zeros meet every simplification."""
    numbering = Numbering(WORDS)
    numbers = [A, B, C, *(numbering.constant(Decimal(value)) for value in (0, 1, -1, 2))]
    values = [*(CONTEXT.mpf(x) for x in point), *map(CONTEXT.mpf, (0, 1, -1, 2))]
    asked = 0
    for code, *picks in steps:
        places = [pick % len(values) for pick in picks[: 1 if code in UNARY else 2]]
        arguments = [values[place] for place in places]
        if code is Code.DIV and arguments[1] == 0:
            continue
        asked += 1
        numbers.append(numbering.op(code, *(numbers[place] for place in places)))
        values.append(ARITHMETIC[code](*arguments))
    for number, value in zip(numbers, values, strict=True):
        found = interpret(Program(WORDS, numbering.ops, (number,)), {"x": point}, CONTEXT)["y"][0]
        assert abs(found - value) <= CONTEXT.mpf(10) ** -40 * max(1, abs(value))
    assert Program(WORDS, numbering.ops, (0,)).operation_count <= 2 * asked  # sin(-x) may leave a sine and a sign

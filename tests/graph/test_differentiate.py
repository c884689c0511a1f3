"""Derivatives of Programs against sympy and against 60-digit central differences, for every operation."""

import math
from decimal import Decimal

import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from small_expressions import CONTEXT, POINTS, SYMBOLS, close, evaluated, expressions, function_of, values_of

from mechanisms.hand_programs import constant, inputs, made, shapes
from walkgen.graph.differentiate import derivative
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.passes import fused
from walkgen.graph.program import TRUTH_CODES, Code, Op
from walkgen.signature import Port

NUMBERS = {
    **dict.fromkeys((Code.NEG, Code.SQRT, Code.SIN, Code.COS, Code.TAN, Code.ABS), 1),
    **dict.fromkeys((Code.ADD, Code.SUB, Code.MUL, Code.DIV, Code.ATAN2, Code.MIN, Code.MAX), 2),
    Code.SELECT: 3,
}
STILL = {Code.INPUT, Code.CONSTANT, Code.EPSILON, Code.INDICATOR, *TRUTH_CODES}
FUSED = {Code.FMA, Code.FMS, Code.FNMA}
STEPS = st.lists(st.tuples(st.sampled_from(list(NUMBERS)), *[st.integers(0, 10**6)] * 3), min_size=1, max_size=8)
SHIFT = CONTEXT.mpf(10) ** -20


def test_every_operation_is_covered():
    assert set(Code) == {*NUMBERS, *STILL, *FUSED}


@settings(derandomize=True, deadline=None, max_examples=80)
@given(expressions(), expressions(), POINTS)
def test_sympy(first, second, point):
    program = derivative(lower(function_of(first, second), fma=False), "x")
    expected = [evaluated(sympy.diff(expression, symbol), point) for expression in (first, second) for symbol in SYMBOLS]
    assert all(close(found, value, 30) for found, value in zip(values_of(program, point, "y_d_x"), expected, strict=True))


def random_program(steps):
    """Any operations on three inputs and two constants; a choice compares its first two arguments."""
    ops = [*inputs(3), constant(Decimal("0.75")), constant(-2)]
    values = list(range(5))
    for code, *picks in steps:
        places = tuple(values[pick % len(values)] for pick in picks[: NUMBERS[code]])
        if code is Code.SELECT:
            ops.append(Op(Code.LESS, places[:2]))
            places = (len(ops) - 1, *places[1:])
        ops.append(Op(code, places))
        values.append(len(ops) - 1)
    return made("random", (Port("x", (3,)),), (Port("y"),), tuple(ops), (values[-1],))


def differences(program, point, element, step):
    shifted = [[x + sign * step * (index == element) for index, x in enumerate(point)] for sign in (1, -1)]
    high, low = (interpret(program, {"x": row}, CONTEXT)["y"][0] for row in shifted)
    return (high - low) / (2 * step)


@settings(derandomize=True, deadline=None, max_examples=400)
@given(STEPS, st.tuples(*[st.integers(-2000, 2000)] * 3))
def test_central_differences(steps, integers):
    program = random_program(steps)
    point = [(CONTEXT.mpf(n) + CONTEXT.mpf(k) / 7) / 1009 for n, k in zip(integers, (1, 2, 3), strict=True)]
    found = interpret(derivative(program, "x"), {"x": point}, CONTEXT)["y_d_x"]
    for element in range(3):
        near, far = (differences(program, point, element, factor * SHIFT) for factor in (1, 2))
        assume(math.isfinite(near) and abs(near) < 10**6 and close(far, near, 25))  # not at a pole, a kink or outside the domain
        assert close(found[element], near, 24)


@pytest.mark.parametrize("code", NUMBERS, ids=lambda code: code.value)
@pytest.mark.parametrize("point", [(0.3, 0.8, -0.4), (0.9, 0.2, 0.7)])
def test_each_operation(code, point):
    """One by one, on both sides of the choices, in doubles."""
    program = random_program([(code, 0, 1, 2)])
    found = interpret(derivative(program, "x"), {"x": point})["y_d_x"]
    expected = [differences(program, [CONTEXT.mpf(x) for x in point], element, SHIFT) for element in range(3)]
    assert [float(value) for value in found] == pytest.approx([float(value) for value in expected], rel=1e-14, abs=1e-14)
    assert any(found), "the operation moves with something"


@pytest.mark.parametrize("code", [Code.SQRT, Code.DIV, Code.ATAN2], ids=lambda code: code.value)
def test_what_does_not_move_has_no_derivative(code):
    """Of an input that the operation does not use: 0 even where the rule would divide by 0."""
    program = random_program([(code, 0, 0, 0)])
    assert interpret(derivative(program, "x"), {"x": [0.0, 1.0, 1.0]})["y_d_x"][1:] == [0, 0]


def test_steps_do_not_move():
    """x [x < y] + epsilon: an indicator and the target's rounding are constants."""
    ops = (*inputs(3), Op(Code.LESS, (0, 1)), Op(Code.INDICATOR, (3,)), Op(Code.MUL, (0, 4)), Op(Code.EPSILON), Op(Code.ADD, (5, 6)))
    program = derivative(made("steps", (Port("x", (3,)),), (Port("y"),), ops, (7,)), "x")
    assert interpret(program, {"x": [1, 2, 0]})["y_d_x"] == [1, 0, 0]
    assert interpret(program, {"x": [2, 1, 0]})["y_d_x"] == [0, 0, 0]


def test_shapes_and_words():
    """Each output gains the input's shape at its end; elements are told apart by their values."""
    found = derivative(shapes(), "T")
    assert found.signature.name == "shapes_d_T"
    assert [port.name for port in found.signature.outputs] == [f"{name}_d_T" for name in ("p", "M", "H", "status", "e")]
    assert [port.shape for port in found.signature.outputs] == [(2, 2, 3), (2, 2, 2, 3), (2, 2, 2, 2, 3), (2, 2, 3), (2, 3)]
    assert found.signature.inputs == shapes().signature.inputs
    outputs = interpret(found, {"q": [1, 2], "T": [0] * 6, "s": [3]})
    moving = set(enumerate((0, 2, 3, 5)))  # M holds these elements of T
    assert outputs["M_d_T"] == [1 if (index // 6, index % 6) in moving else 0 for index in range(24)]


def test_by_a_scalar_port():
    assert interpret(derivative(shapes(), "s"), {"q": [1, 2], "T": [0] * 6, "s": [3]})["H_d_s"] == list(range(8))


def test_fused_programs_are_refused():
    x, y, z = SYMBOLS
    with pytest.raises(KeyError):
        derivative(fused(lower(function_of(x * y + z), fma=False)), "x")

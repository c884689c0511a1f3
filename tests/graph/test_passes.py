"""Passes keep values and never add work: pruning and fusing on random Programs."""

from collections import Counter

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from small_expressions import CONTEXT, SYMBOLS, close, expressions, function_of, values_of

from mechanisms.hand_programs import constant, inputs, made
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.passes import fused, groups, pruned, scheduled
from walkgen.graph.program import Code, Op
from walkgen.signature import Port

QUICK = settings(derandomize=True, deadline=None, max_examples=100)
ROWS = st.lists(st.floats(-3, 3), min_size=3, max_size=3)


def toy(ops, outputs):
    return made("toy", (Port("x", (3,)),), (Port("y", (len(outputs),)),), (*inputs(3), *ops), outputs)


def test_pruning_keeps_inputs_and_what_outputs_need():
    program = pruned(toy([Op(Code.SIN, (0,)), Op(Code.ADD, (0, 1)), constant(3), Op(Code.MUL, (4, 1))], (6, 4)))
    assert [op.code for op in program.ops] == [Code.INPUT] * 3 + [Code.ADD, Code.MUL]
    assert interpret(program, {"x": [2, 5, 0]})["y"] == [35, 7]


@QUICK
@given(expressions(), expressions(), ROWS)
def test_pruning_keeps_values(kept, dropped, row):
    both = lower(function_of(dropped, kept), fma=False)
    one = made("toy", both.signature.inputs, (Port("y", (1,)),), both.ops, both.outputs[1:])
    assert interpret(pruned(one), {"x": row})["y"] == interpret(both, {"x": row})["y"][1:]
    assert {number for op in pruned(one).ops for number in op.arguments} | set(pruned(one).outputs) >= set(range(3, len(pruned(one).ops)))


@QUICK
@given(expressions(), expressions(), ROWS)
def test_fusing_keeps_values_and_never_adds_operations(first, second, row):
    plain = lower(function_of(first, second), fma=False)
    quick = fused(plain)
    assert interpret(quick, {"x": row}) == interpret(plain, {"x": row})  # the interpreter rounds a fused operation twice
    saved = sum(op.code in (Code.FMA, Code.FMS, Code.FNMA) for op in quick.ops)
    turned = Counter(op.code for op in plain.ops)[Code.NEG] - Counter(op.code for op in quick.ops)[Code.NEG]
    assert quick.operation_count == plain.operation_count - saved - turned
    assert turned >= 0


@pytest.mark.parametrize("code", [Code.FMA, Code.FMS, Code.FNMA])
def test_a_negated_sum_of_products_is_negated_before_it_is_rounded(code):
    """The compiler finds nothing to negate: whether it does is up to it, and the sign of a zero shows it."""
    first, second = (Code.ADD, (3, 2)), (Code.SUB, (3, 2) if code is Code.FMS else (2, 3))
    plain = toy([Op(Code.MUL, (0, 1)), Op(*(first if code is Code.FMA else second)), Op(Code.NEG, (4,))], (5,))
    quick = fused(plain)
    assert quick.ops[quick.outputs[0]].code is not Code.NEG
    assert interpret(quick, {"x": [2, 3, 10]}) == interpret(plain, {"x": [2, 3, 10]})


def test_each_form_is_fused():
    product = Op(Code.MUL, (0, 1))
    for code, arguments, expected in (
        (Code.ADD, (2, 3), Code.FMA),
        (Code.ADD, (3, 2), Code.FMA),
        (Code.SUB, (3, 2), Code.FMS),
        (Code.SUB, (2, 3), Code.FNMA),
    ):
        plain = toy([product, Op(code, arguments)], (4,))
        quick = fused(plain)
        assert Counter(op.code for op in quick.ops)[expected] == 1
        assert quick.operation_count == 1
        assert interpret(quick, {"x": [2, 3, 10]}) == interpret(plain, {"x": [2, 3, 10]})


def test_a_product_used_twice_is_not_computed_twice():
    for ops, outputs in (
        ([Op(Code.MUL, (0, 1)), Op(Code.ADD, (3, 2)), Op(Code.SIN, (3,))], (4, 5)),
        ([Op(Code.MUL, (0, 1)), Op(Code.ADD, (3, 3))], (4,)),
        ([Op(Code.MUL, (0, 1)), Op(Code.ADD, (3, 2))], (3, 4)),
    ):
        plain = toy(ops, outputs)
        assert fused(plain) == plain


def test_arctangents_stand_side_by_side():
    """What waits for one comes after all that do not; the order is otherwise kept, and so is what is computed."""
    x, y, z = SYMBOLS
    turned = sympy.Symbol("turned")
    found = lower(function_of(turned, sympy.atan2(y, z) + z * x, tape=[(turned, 2 * sympy.atan2(x, y) + 1)]), fma=False)
    codes = [op.code for op in found.ops]
    assert codes.count(Code.ATAN2) == 2
    assert codes.index(Code.ADD) > len(codes) - 1 - codes[::-1].index(Code.ATAN2)
    assert close(values_of(found, (2, 3, 5))[0], 2 * CONTEXT.atan2(2, 3) + 1)


def test_angles_come_together_four_at_most_and_each_only_once():
    """Five angles of inputs in two parts, then one that waits for them."""
    sums = [Op(Code.ADD, (0, 1)), Op(Code.ADD, (1, 2))]
    angles = [Op(code, (number,)) for number in (0, 1, 2, 3, 4) for code in (Code.SIN, Code.COS)]
    program = toy([*sums, *angles, Op(Code.MUL, (5, 6)), Op(Code.SIN, (15,)), Op(Code.SIN, (16,))], (17,))
    found = groups(program)
    assert [len(group) for group in found] == [2, 3, 1, 1]
    members = [member for group in found for same in group for member in same]
    assert sorted(members) == [n for n, op in enumerate(program.ops) if op.code in (Code.SIN, Code.COS)]


def test_a_group_stands_where_its_first_angle_stood():
    """The second angle's sum moves up with it; the product does not."""
    program = toy([Op(Code.SIN, (0,)), Op(Code.MUL, (3, 3)), Op(Code.ADD, (1, 2)), Op(Code.COS, (5,)), Op(Code.ADD, (4, 6))], (7,))
    assert [op.code for op in scheduled(program).ops[3:]] == [Code.ADD, Code.SIN, Code.COS, Code.MUL, Code.ADD]


@QUICK
@given(expressions(), expressions(), ROWS)
def test_scheduling_keeps_values_and_is_done_once(first, second, row):
    plain = pruned(lower(function_of(first, second, first * second), fma=False))
    found = scheduled(plain)
    assert interpret(found, {"x": row}) == interpret(plain, {"x": row})
    assert sorted(op.code.value for op in found.ops) == sorted(op.code.value for op in plain.ops)
    assert scheduled(found) == found
    for group in groups(found):
        members = [member for same in group for member in same]
        assert max(a for member in members for a in found.ops[member].arguments) < min(members)


def test_programs_of_one_angle_keep_their_order():
    x, y, z = SYMBOLS
    program = lower(function_of(sympy.sin(x) * y + z, x * z), fma=True)
    assert scheduled(program) == program

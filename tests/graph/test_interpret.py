"""The interpreter against Python's own arithmetic, operation by operation, in doubles and in 40 digits."""

import ast
import math
from pathlib import Path

import pytest
from mpmath import mp

from mechanisms.hand_programs import LOGIC, NAN_ROWS, NUMBERS, ROWS, TRUTHS, chosen, guarded_inverse, logic, long_chain, shapes, single
from walkgen.graph import interpret as interpreter
from walkgen.graph.interpret import interpret
from walkgen.graph.program import Code


def same(left, right):
    return left == right or (math.isnan(left) and math.isnan(right))


@pytest.mark.parametrize("code", NUMBERS, ids=lambda code: code.value)
def test_numbers(code):
    count, expected = NUMBERS[code]
    for row in ROWS + NAN_ROWS:
        assert same(interpret(single(code), {"x": row})["y"][0], expected(*row[:count])), row


@pytest.mark.parametrize("code", TRUTHS, ids=lambda code: code.value)
def test_truths(code):
    count, expected = TRUTHS[code]
    for row in ROWS + NAN_ROWS:
        assert interpret(chosen(code), {"x": row})["y"] == [1.0 if expected(*row[:count]) else -1.0], row


@pytest.mark.parametrize("code", LOGIC, ids=lambda code: code.value)
def test_logic(code):
    for row in ROWS + NAN_ROWS:
        assert interpret(logic(code), {"x": row})["y"] == [float(LOGIC[code](row[0] < row[1], row[1] < row[2]))], row


def test_every_operation_is_tested():
    assert set(Code) == {*NUMBERS, *TRUTHS, *LOGIC, Code.INPUT, Code.CONSTANT, Code.SELECT, Code.INDICATOR}


@pytest.mark.parametrize("code", [code for code in NUMBERS if code is not Code.DIV], ids=lambda code: code.value)
def test_forty_digits(code):
    """In an mpmath context the value agrees with the doubles, and keeps more digits than they have."""
    with mp.workdps(40):
        for row in ROWS:
            precise = interpret(single(code), {"x": row}, mp)["y"][0]
            double = interpret(single(code), {"x": row})["y"][0]
            assert same(float(precise), double) or abs(float(precise) - double) < 1e-15
        assert abs(interpret(single(Code.DIV), {"x": (1, 3, 0)}, mp)["y"][0] * 3 - 1) < mp.mpf(10) ** -39


def test_shapes_and_kinds():
    found = interpret(shapes(), {"q": [10, 20], "T": [1, 2, 3, 4, 5, 6], "s": [2]})
    assert found == {"p": [10, 20], "M": [1, 3, 4, 6], "H": [0, 2, 4, 6, 8, 10, 12, 14], "status": [2, 0], "e": [2]}
    assert all(isinstance(status, int) for status in found["status"])


def test_total():
    assert interpret(guarded_inverse(), {"x": [4.0], "branch": [1]}) == {"y": [0.25], "status": [0]}
    for inputs in ({"x": [0.0], "branch": [1]}, {"x": [4.0], "branch": [0]}):
        found = interpret(guarded_inverse(), inputs)
        assert math.isnan(found["y"][0])
        assert found["status"] == [2]


def test_wrong_size_is_refused():
    with pytest.raises(ValueError, match="T has 5 elements, not 6"):
        interpret(shapes(), {"q": [1, 2], "T": [0] * 5, "s": [1]})


def test_long_program():
    assert len(interpret(long_chain(10_000, 250), {"x": [0.3, -0.2]})["y"]) == 250


def test_shares_no_table_with_the_printers():
    tree = ast.parse(Path(interpreter.__file__).read_text(encoding="utf-8"))
    imported = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert {name for name in imported if name and name.startswith("walkgen")} == {"walkgen.graph.program"}

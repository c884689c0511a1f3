"""The NumPy printer on hand-made Programs, against Python's arithmetic and the interpreter."""

import inspect
import warnings
from dataclasses import replace
from decimal import Decimal

import numpy as np
import pytest

from mechanisms.hand_programs import (
    LOGIC,
    NAN_ROWS,
    NUMBERS,
    ROWS,
    TRUTHS,
    chosen,
    constant,
    guarded_inverse,
    inputs,
    logic,
    long_chain,
    made,
    run,
    shapes,
    single,
    toy,
)
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.graph.interpret import interpret
from walkgen.graph.program import Call, Code, Composite, Op
from walkgen.signature import Port, Signature


@pytest.fixture
def function(tmp_path):
    def build(program):
        return run(numpy_artifact(toy(program)), tmp_path)[f"leg_{program.signature.name}"]

    return build


def agree(found, expected):
    np.testing.assert_allclose(found, expected, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("code", NUMBERS, ids=lambda code: code.value)
def test_numbers(function, code):
    count, expected = NUMBERS[code]
    rows = ROWS + NAN_ROWS
    agree(function(single(code))(rows), [expected(*row[:count]) for row in rows])
    agree(function(single(code))(rows[7]), expected(*rows[7][:count]))


@pytest.mark.parametrize("code", TRUTHS, ids=lambda code: code.value)
def test_truths(function, code):
    count, expected = TRUTHS[code]
    rows = ROWS + NAN_ROWS
    agree(function(chosen(code))(rows), [1 if expected(*row[:count]) else -1 for row in rows])


@pytest.mark.parametrize("code", LOGIC, ids=lambda code: code.value)
def test_logic(function, code):
    rows = ROWS + NAN_ROWS
    agree(function(logic(code))(rows), [LOGIC[code](row[0] < row[1], row[1] < row[2]) for row in rows])


def test_constant_conditions(function):
    """A condition on constants is one for every row."""
    ops = (*inputs(1), constant(0), Op(Code.LESS_EQUAL, (1, 1)), Op(Code.NOT, (2,)), Op(Code.SELECT, (3, 1, 0)))
    agree(function(made("constant", (Port("x", (1,)),), (Port("y"),), ops, (4,)))([[1.0], [2.0]]), [1, 2])


def test_shapes_types_and_batches(function):
    shaped = function(shapes())
    random = np.random.default_rng(1)
    q, T, s = random.normal(size=(4, 1, 2)), random.normal(size=(3, 2, 3)), random.normal(size=(4, 3))
    p, M, H, status, e = shaped(q, T, s)
    assert [port.shape for port in (p, M, H, status, e)] == [(4, 3, 2), (4, 3, 2, 2), (4, 3, 2, 2, 2), (4, 3, 2), (4, 3)]
    assert [port.dtype for port in (p, M, H, status, e)] == [np.float64] * 3 + [np.int32, np.float64]
    one = interpret(shapes(), {"q": q[2, 0], "T": T[1].ravel(), "s": s[2, 1:2]})
    for array, name in zip((p, M, H, status, e), one, strict=True):
        agree(array[2, 1].ravel(), one[name])


def test_no_rows_and_no_batch(function):
    shaped = function(shapes())
    assert [port.shape for port in shaped(np.empty((0, 2)), np.zeros((2, 3)), 1)] == [(0, 2), (0, 2, 2), (0, 2, 2, 2), (0, 2), (0,)]
    assert [np.shape(port) for port in shaped([1, 2], np.zeros((2, 3)), 1)] == [(2,), (2, 2), (2, 2, 2), (2,), ()]


def test_wrong_shape_is_refused(function):
    with pytest.raises(ValueError, match=r"T has shape \(3, 2\); its last dimensions must be \(2, 3\)"):
        function(shapes())([1, 2], np.zeros((3, 2)), 1)


def test_no_warning_leaks_and_statuses_stand_for_nan(function):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        y, status = function(guarded_inverse())([0.0, 4.0, np.nan, np.inf], [[1], [3]])
    agree(y, [[np.nan, 0.25, np.nan, 0.0], [np.nan] * 4])
    assert status.tolist() == [[2, 0, 0, 0], [2, 2, 2, 2]]
    assert status.dtype == np.int32


def test_a_branch_is_an_integer(function):
    guarded = function(guarded_inverse())
    assert guarded(2.0, np.int64(1))[1] == 0
    with pytest.raises(TypeError):
        guarded(2.0, 1.5)


def test_arguments_are_ports(function):
    assert list(inspect.signature(function(guarded_inverse())).parameters) == ["x", "branch"]


def test_long_program(function):
    program = long_chain(10_000, 250)
    agree(function(program)([[0.3, -0.2]])[0], interpret(program, {"x": [0.3, -0.2]})["y"])


def test_composite(tmp_path):
    """Kernels and routines in order, literals among their arguments; what a routine writes comes back."""
    ports = (Port("J", (3, 3)), Port("v", (3,)))
    outputs = (Port("qd", (3,)), Port("status", kind="integer"))
    double = made("doubled", (Port("x", (3,)),), (Port("w", (3,)),), (*inputs(3), *(Op(Code.ADD, (i, i)) for i in range(3))), (3, 4, 5))
    calls = (Call(double, ("v", "twice")), Call("wg_damped_inverse_3", ("J", "twice", Decimal("1e-3"), Decimal("0.1"), "qd", "status")))
    solve = Composite(Signature("toy", "leg", "velocity", ports, outputs), (Port("twice", (3,)),), calls, ("walkgen_damped.h",))
    velocity = run(numpy_artifact(toy(solve)), tmp_path)["leg_velocity"]
    J, v = np.diag([1.0, 2.0, 4.0]), np.random.default_rng(2).normal(size=(5, 3))
    qd, status = velocity(J, v)
    agree(qd, 2 * v / [1, 2, 4])
    assert status.dtype == np.int32
    assert status.tolist() == [0] * 5
    assert velocity(np.broadcast_to(J, (4, 1, 3, 3)), v)[0].shape == (4, 5, 3)


def test_free_text_is_inert(tmp_path):
    words = 'a "quote" \'and\' """three""" \\ \n \u202e {{ 1 }} é \\'
    program = replace(guarded_inverse(), signature=replace(guarded_inverse().signature, doc=words, source=words))
    names = run(numpy_artifact(toy(program, description=words)), tmp_path)
    assert words in names["__doc__"]
    assert names["leg_guarded"].__doc__.split()[: len(words.split())] == words.split()


def test_same_bytes():
    code = toy(shapes(), guarded_inverse())
    assert numpy_artifact(code) == numpy_artifact(toy(shapes(), guarded_inverse()))

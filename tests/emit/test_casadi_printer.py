"""The CasADi printer on hand-made Programs, against Python's arithmetic and the interpreter; its serialised files."""

import subprocess
import sys
from dataclasses import replace

import casadi as ca
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
from walkgen.emit.casadi_files import built_functions, serialise
from walkgen.emit.casadi_printer import casadi_artifact
from walkgen.graph.interpret import interpret
from walkgen.graph.program import Call, Code, Composite, Op
from walkgen.signature import Port, Signature


@pytest.fixture
def function(tmp_path):
    def build(program):
        return run(casadi_artifact(toy(program)), tmp_path)["function"](program.signature.full_name)

    return build


def agree(found, expected):
    np.testing.assert_allclose(np.array(found), expected, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("code", NUMBERS, ids=lambda code: code.value)
def test_numbers(function, code):
    count, expected = NUMBERS[code]
    built = function(single(code))
    for row in ROWS + NAN_ROWS:
        agree(built(row), [[expected(*row[:count])]])


@pytest.mark.parametrize("code", TRUTHS, ids=lambda code: code.value)
def test_truths(function, code):
    count, expected = TRUTHS[code]
    built = function(chosen(code))
    for row in ROWS + NAN_ROWS:
        agree(built(row), [[1 if expected(*row[:count]) else -1]])


@pytest.mark.parametrize("code", LOGIC, ids=lambda code: code.value)
def test_logic(function, code):
    built = function(logic(code))
    for row in ROWS + NAN_ROWS:
        agree(built(row), [[LOGIC[code](row[0] < row[1], row[1] < row[2])]])


def test_constant_conditions(function):
    ops = (*inputs(1), constant(0), Op(Code.LESS_EQUAL, (1, 1)), Op(Code.LESS, (0, 1)), Op(Code.AND, (2, 3)), Op(Code.SELECT, (4, 1, 0)))
    built = function(made("constant", (Port("x", (1,)),), (Port("y"),), ops, (5,)))
    assert [float(built(value)) for value in (1.5, -1.5)] == [1.5, 0.0]


def test_residue_keeps_nan_and_has_a_derivative(function):
    """The difference x - x is 0 for a finite x and NaN otherwise: SX would cancel it."""
    program = made("residue", (Port("x", (1,)),), (Port("y"),), (*inputs(1), Op(Code.SUB, (0, 0)), Op(Code.ADD, (0, 1))), (2,))
    built = function(program)
    agree([float(built(value)) for value in (2.0, np.nan, np.inf)], [2.0, np.nan, np.nan])
    x = ca.SX.sym("x")
    assert float(ca.Function("d", [x], [ca.jacobian(built(x), x)])(2.0)) == 1.0


def test_shapes(function):
    built = function(shapes())
    given = {"q": [10.0, 20.0], "T": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "s": [2.0]}
    found = built(given["q"], np.reshape(given["T"], (2, 3)), given["s"])
    expected = interpret(shapes(), given)
    assert [port.shape for port in found] == [(2, 1), (2, 2), (2, 4), (2, 1), (1, 1)]
    assert all(port.is_dense() for port in found)
    for port, name in zip(found, expected, strict=True):
        agree(np.array(port).ravel(), expected[name])
    assert (built.name(), built.name_in(), built.name_out()) == ("toy_leg_shapes", ["q", "T", "s"], ["p", "M", "H", "status", "e"])


def test_unselected_sides_do_not_leak(function):
    y, status = function(guarded_inverse())(0.0, 1)
    assert np.isnan(float(y))
    assert float(status) == 2
    agree(function(guarded_inverse())(4.0, 1), [[[0.25]], [[0.0]]])


def test_long_program(function):
    program = long_chain(10_000, 250)
    agree(np.array(function(program)([0.3, -0.2])).ravel(), interpret(program, {"x": [0.3, -0.2]})["y"])


@pytest.fixture
def routine():
    ports, outputs = (Port("J", (3, 3)), Port("v", (3,))), (Port("qd", (3,)), Port("status", kind="integer"))
    call = Call("wg_damped_inverse_3", ("J", "v", 1, 1, "qd", "status"))
    return Composite(Signature("toy", "leg", "velocity", ports, outputs), (), (call,), ("walkgen_damped.h",))


def test_a_routine_without_closed_form_says_so(tmp_path, routine):
    names = run(casadi_artifact(toy(routine, shapes())), tmp_path)
    assert names["FUNCTIONS"] == ("leg_shapes",)
    with pytest.raises(NotImplementedError, match="leg_velocity has no CasADi form: it needs the iterative wg_damped_inverse_3"):
        names["function"]("toy_leg_velocity")
    with pytest.raises(KeyError, match="toy has no function leg_missing"):
        names["function"]("leg_missing")


def test_a_closed_form_stands_in(tmp_path, routine):
    closed = guarded_inverse()
    solve = replace(routine, signature=replace(closed.signature, name="solve"), closed_form=closed)
    built = run(casadi_artifact(toy(solve)), tmp_path)["function"]("leg_solve")
    assert built.name() == "toy_leg_solve"
    agree(built(4.0, 1), [[[0.25]], [[0.0]]])


def test_built_once(tmp_path):
    names = run(casadi_artifact(toy(shapes())), tmp_path)
    assert names["function"]("toy_leg_shapes") is names["function"]("leg_shapes")


def test_free_text_is_inert(tmp_path):
    words = 'a "quote" \'and\' """three""" \\ \n \u202e {{ 1 }} é \\'
    program = replace(guarded_inverse(), signature=replace(guarded_inverse().signature, doc=words, source=words))
    names = run(casadi_artifact(toy(program, description=words)), tmp_path)
    assert words in names["__doc__"]
    assert names["leg_guarded"].__doc__.split()[: len(words.split())] == words.split()


def test_needs_casadi_alone(tmp_path):
    artifact = casadi_artifact(toy(shapes()))
    (tmp_path / artifact.path).write_text(artifact.text, encoding="utf-8")
    check = "import sys; sys.modules['walkgen'] = None; import toy_casadi; toy_casadi.function('leg_shapes')"
    subprocess.run([sys.executable, "-c", check], cwd=tmp_path, check=True)


def test_serialised(tmp_path, routine):
    artifact = casadi_artifact(toy(shapes(), routine, guarded_inverse()))
    (tmp_path / artifact.path).write_text(artifact.text, encoding="utf-8")
    files = serialise(built_functions(tmp_path), tmp_path / "deep" / "out")
    assert [file.name for file in files] == ["toy_leg_shapes.casadi", "toy_leg_guarded.casadi"]
    agree(ca.Function.load(str(files[1]))(4.0, 1), [[[0.25]], [[0.0]]])
    again = serialise(built_functions(tmp_path), tmp_path / "again")
    assert [file.read_bytes() for file in files] == [file.read_bytes() for file in again]
    assert not (tmp_path / "__pycache__").exists()


def test_serialise_wants_one_robot(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"holds 0 files \*_casadi.py"):
        built_functions(tmp_path)

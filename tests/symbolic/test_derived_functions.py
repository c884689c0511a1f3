"""What derivations promise whatever the robot: few operations for the plain leg, small intermediates, complete signatures."""

import re
from functools import cache
from pathlib import Path

import pytest
import sympy

from walkgen import pipeline
from walkgen.graph.lower import lower
from walkgen.graph.program import Code
from walkgen.signature import STATUSES
from walkgen.symbolic.function import Solve

SPECS = Path(__file__).parents[2] / "specs"
SMALL = 30  # sympy operations of one line; a sum over three joints has 5, the longest chain of statuses 23


@cache
def derivations_of(name):
    return pipeline.functions_of(SPECS / f"{name}.toml")


def functions_of(name):
    """Every Function of a spec, those inside solves and their closed forms too."""
    for derivation in derivations_of(name):
        yield from inside(derivation)


def inside(derivation):
    if not isinstance(derivation, Solve):
        yield derivation
        return
    for step in derivation.steps:
        if not isinstance(step.callee, str):
            yield from inside(step.callee)
    if derivation.closed_form is not None:
        yield from inside(derivation.closed_form)


@pytest.mark.parametrize("fma", [True, False])
@pytest.mark.parametrize(("name", "most"), [("foot_position", 27), ("foot_position_jacobian", 45)])
def test_plain_leg_costs_little(name, most, fma):
    """Inputs, outputs, sines and cosines count one each; the leg is that of mero_leg.toml, not mounted."""
    found = next(function for function in functions_of("mero_leg") if function.signature.name == name)
    program = lower(found, fma)
    inputs = sum(op.code is Code.INPUT for op in program.ops)
    assert inputs == 3
    assert program.operation_count + inputs + len(program.outputs) <= most


def needed(function):
    """The lines that the outputs use; functions of one path share a tape, so there are others."""
    used, kept = {symbol for output in function.outputs for symbol in output.free_symbols}, []
    for symbol, definition in reversed(function.intermediates):
        if symbol in used:
            used |= definition.free_symbols
            kept.append((symbol, definition))
    return reversed(kept)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", ["mero_leg_param", "solo12", "ambler_rrp", "mero_star", "phantomx_leg"])
def test_every_line_is_small(name):
    """And uses only inputs and earlier lines."""
    for function in functions_of(name):
        known = set(function.inputs)
        for symbol, definition in needed(function):
            assert sympy.count_ops(definition) <= SMALL, (function.signature.full_name, symbol)
            assert definition.free_symbols <= known, (function.signature.full_name, symbol)
            assert symbol not in known
            known.add(symbol)
        for output in function.outputs:
            assert sympy.count_ops(output) <= SMALL, function.signature.full_name
            assert output.free_symbols <= known, function.signature.full_name


@pytest.mark.parametrize("name", ["mero_leg_param", "mero_star", "ambler_rpp"])
def test_every_argument_stays(name):
    """Inputs that a function does not need are still its inputs, and every output element is there."""
    for function in functions_of(name):
        signature = function.signature
        assert len(function.inputs) == sum(port.size for port in signature.inputs)
        assert len(function.outputs) == sum(port.size for port in signature.outputs)
        program = lower(function)
        elements = [(index, element) for index, port in enumerate(signature.inputs) for element in range(port.size)]
        assert [op.element for op in program.ops if op.code is Code.INPUT] == elements
        assert [op.code for op in program.ops[: len(elements)]] == [Code.INPUT] * len(elements)


def test_parameters_come_last():
    for derivation in derivations_of("mero_leg_param"):
        assert derivation.signature.inputs[-1].name == "param"
        assert derivation.signature.inputs[-1].shape == (2,)


def test_only_what_is_asked_for(tmp_path):
    """A name of [generate] functions serves every leg, chain or route that has it."""
    text = (SPECS / "mero_star.toml").read_text(encoding="utf-8")
    asked = re.sub(r"(?m)^functions = \[[^\]]*\]", 'functions = ["pose", "foot_jacobian", "inverse_branch"]', text)
    path = tmp_path / "asked.toml"
    path.write_text(asked, encoding="utf-8")
    found = [(derivation.signature.owner, derivation.signature.name) for derivation in pipeline.functions_of(path)]
    robot = pipeline.mechanism_of(path)
    legs = [leg.name for leg in robot.legs]
    routes = [f"root_to_{leg.name}" for leg in robot.legs if robot.ancestors(leg.platform)]
    expected = {(owner, "foot_jacobian") for owner in (*legs, *routes)}
    expected |= {(leg, "inverse_branch") for leg in legs} | {(chain.name, "pose") for chain in robot.chains}
    assert set(found) == expected
    assert len(found) == len(expected)


def test_statuses_are_the_enums():
    assert STATUSES[:4] == ("OK", "UNREACHABLE", "BAD_INPUT", "SINGULAR")

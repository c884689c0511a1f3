"""NumPy, CasADi and the interpreter on every function of shipped robots: the same numbers, and NaN in the same places."""

from pathlib import Path

import numpy as np
import pytest

from mechanisms.hand_programs import run
from walkgen.emit.artifact import RobotCode
from walkgen.emit.casadi_printer import casadi_artifact, closed_form
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Composite, Program
from walkgen.model.assemble import assemble
from walkgen.signature import STATUSES
from walkgen.spec.read import read
from walkgen.symbolic.derive import derive

SPECS = Path(__file__).parents[2] / "specs"
BAD_INPUT = STATUSES.index("BAD_INPUT")
ROBOTS = ("mero_leg", "mero_leg_param", "ambler_rrp", "mero_style")


class Targets:
    """One robot: its functions, and its modules in NumPy and CasADi."""

    def __init__(self, name: str, folder: Path) -> None:
        mechanism = assemble(read(SPECS / f"{name}.toml"))
        code = RobotCode(mechanism, tuple(lower(derivation, fma=True) for derivation in derive(mechanism, ())), "0" * 64)
        self.bodies = code.functions
        self.numpy = run(numpy_artifact(code), folder)
        self.casadi = run(casadi_artifact(code), folder)

    def vectorised(self, body):
        return self.numpy[body.signature.full_name.removeprefix(f"{body.signature.robot}_")]


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request, tmp_path_factory):
    return Targets(request.param, tmp_path_factory.mktemp(request.param))


def drawn(signature, random, rows=4):
    """Inputs by port; a branch is an index, or just outside the indices; runtime parameters are lengths."""
    inputs = {}
    for port in signature.inputs:
        if port.kind == "integer":
            inputs[port.name] = random.integers(-1, 5, size=(rows, *port.shape))
        else:
            low = 0.2 if port.name == "param" else -1
            inputs[port.name] = random.uniform(low, 1, size=(rows, *port.shape))
    return inputs


def listed(results):
    return results if isinstance(results, tuple) else (results,)


def near(found, expected, name):
    scale = np.maximum(1, np.abs(np.nan_to_num(expected)))
    np.testing.assert_allclose(np.asarray(found) / scale, np.asarray(expected) / scale, rtol=0, atol=1e-13, err_msg=name)


def interpreted(program, inputs, row):
    found = interpret(program, {name: values[row].ravel() for name, values in inputs.items()})
    return [np.array(found[port.name]) for port in program.signature.outputs]


def with_casadi(robot, body, inputs, row):
    function = robot.casadi["function"](body.signature.full_name)
    return [np.array(port).ravel() for port in function.call([values[row] for values in inputs.values()])]


def test_programs(robot):
    random = np.random.default_rng(7)
    for body in robot.bodies:
        if isinstance(body, Program):
            inputs = drawn(body.signature, random)
            found = listed(robot.vectorised(body)(*inputs.values()))
            for row in range(4):
                expected = interpreted(body, inputs, row)
                for port, value, symbolic, array in zip(
                    body.signature.outputs, expected, with_casadi(robot, body, inputs, row), found, strict=True
                ):
                    near(array[row].ravel(), value, f"{body.signature.full_name} {port.name} in NumPy")
                    near(symbolic, value, f"{body.signature.full_name} {port.name} in CasADi")


def test_closed_forms_of_composites(robot):
    """Where the routine has nothing to mend (status OK), the closed form and the steps give the same."""
    random = np.random.default_rng(8)
    compared = 0
    for body in robot.bodies:
        program = closed_form(body) if isinstance(body, Composite) else None
        if program is not None:
            inputs = drawn(body.signature, random, rows=40)
            *values, status = listed(robot.vectorised(body)(*inputs.values()))
            for row in range(40):
                *expected, expected_status = interpreted(program, inputs, row)
                *symbolic, symbolic_status = with_casadi(robot, body, inputs, row)
                np.testing.assert_array_equal(status[row].ravel(), expected_status)
                np.testing.assert_array_equal(symbolic_status, expected_status)
                bad = np.atleast_1d(status[row]) == BAD_INPUT
                good = np.atleast_1d(status[row]) == 0
                compared += good.sum()
                for value, other, third in zip(values, expected, symbolic, strict=True):
                    near(value[row].reshape(len(good), -1)[good], other.reshape(len(good), -1)[good], body.signature.full_name)
                    near(third, other, body.signature.full_name)
                    assert np.isnan(value[row].reshape(len(bad), -1)[bad]).all()
    assert compared > 0 or not any(isinstance(body, Composite) for body in robot.bodies)


def test_no_nan_goes_with_ok(robot):
    """NaN in a target, joint value or rate gives BAD_INPUT: in NumPy with its routines, and in CasADi."""
    random = np.random.default_rng(10)
    for body in robot.bodies:
        if isinstance(body, Composite):
            for poisoned in (port.name for port in body.signature.inputs if port.kind == "real"):
                inputs = drawn(body.signature, random)
                inputs[poisoned][..., -1] = np.nan
                *_, status = listed(robot.vectorised(body)(*inputs.values()))
                assert (status == BAD_INPUT).all(), f"{body.signature.full_name} with NaN in {poisoned}"
                if closed_form(body) is not None:
                    np.testing.assert_array_equal(with_casadi(robot, body, inputs, 0)[-1], np.full(status[0].size, BAD_INPUT))


def test_nan_passes_through_alike(robot):
    random = np.random.default_rng(9)
    for body in robot.bodies:
        if isinstance(body, Program):
            for poisoned in (port.name for port in body.signature.inputs if port.kind == "real"):
                inputs = drawn(body.signature, random)
                inputs[poisoned][..., 0] = np.nan
                found = listed(robot.vectorised(body)(*inputs.values()))
                expected, symbolic = interpreted(body, inputs, 0), with_casadi(robot, body, inputs, 0)
                for array, value, other in zip(found, expected, symbolic, strict=True):
                    np.testing.assert_array_equal(np.isnan(array[0].ravel()), np.isnan(value), err_msg=body.signature.full_name)
                    np.testing.assert_array_equal(np.isnan(other), np.isnan(value), err_msg=body.signature.full_name)

"""NumPy, CasADi and the interpreter on every function of shipped robots: the same numbers, and NaN in the same places."""

from decimal import Decimal
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
ROBOTS = ("mero_leg", "mero_leg_param", "ambler_rrp", pytest.param("mero_style", marks=pytest.mark.nightly))


class Targets:
    """One robot: its functions, and its modules in NumPy and CasADi."""

    def __init__(self, name: str, folder: Path) -> None:
        mechanism = assemble(read(SPECS / f"{name}.toml"))
        code = RobotCode(mechanism, tuple(lower(derivation, fma=True) for derivation in derive(mechanism, ())), "0" * 64)
        self.bodies, self.feet = code.functions, len(mechanism.legs)
        self.numpy = run(numpy_artifact(code), folder)
        self.casadi = run(casadi_artifact(code), folder)

    def vectorised(self, body):
        return self.numpy[body.signature.full_name.removeprefix(f"{body.signature.robot}_")]


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request, tmp_path_factory):
    return Targets(request.param, tmp_path_factory.mktemp(request.param))


def drawn(signature, random, rows=4, feet=4):
    """Inputs by port; a branch is an index, or just outside the indices; runtime parameters are lengths; limits of torques are two."""
    inputs = {}
    for port in (port.sized({"k": feet, "r": 2}) for port in signature.inputs):
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


def near_as_a_whole(found, expected, name):
    """To 1e-13 of the longest component: solves that take another order round a short one beside it as they do the long one."""
    scale = max(1, np.abs(np.nan_to_num(expected)).max(initial=0))
    near(np.asarray(found) / scale, np.asarray(expected) / scale, name)


def interpreted(body, inputs, row):
    """The outputs of a Program, or of a Composite of Programs, each step interpreted."""
    values = {name: array[row].ravel() for name, array in inputs.items()}
    if isinstance(body, Program):
        found = interpret(body, values)
        return [np.array(found[port.name]) for port in body.signature.outputs]
    for call in body.calls:
        signature = call.callee.signature
        names = [port.name for port in (*signature.inputs, *signature.outputs)]
        given = dict(zip(names, call.arguments, strict=True))
        read = {port.name: given[port.name] for port in signature.inputs}
        found = interpret(call.callee, {name: [float(each)] if isinstance(each, Decimal) else values[each] for name, each in read.items()})
        values |= {given[name]: np.array(result) for name, result in found.items()}
    return [values[port.name] for port in body.signature.outputs]


def is_direct(body):
    """Whether the closed form is no iteration: that takes a seed near the answer, and is tested with the inverse."""
    form = closed_form(body)
    return form is not None and (isinstance(form, Program) or all(call.repeat == 1 for call in form.calls))


def with_casadi(robot, body, inputs, row):
    function = robot.casadi["function"](body.signature.full_name)
    flat = [value.reshape(len(value), -1) if value.ndim > 2 else value for value in (values[row] for values in inputs.values())]
    return [np.array(port).ravel() for port in function.call(flat)]


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
        if isinstance(body, Composite) and body.signature.status and is_direct(body) and not body.signature.counts:
            inputs = drawn(body.signature, random, rows=40)
            *values, status = listed(robot.vectorised(body)(*inputs.values()))
            for row in range(40):
                *expected, expected_status = interpreted(closed_form(body), inputs, row)
                *symbolic, symbolic_status = with_casadi(robot, body, inputs, row)
                np.testing.assert_array_equal(status[row].ravel(), expected_status)
                np.testing.assert_array_equal(symbolic_status, expected_status)
                bad = np.atleast_1d(status[row]) == BAD_INPUT
                good = np.atleast_1d(status[row]) == 0
                compared += good.sum()
                for value, other, third in zip(values, expected, symbolic, strict=True):
                    near_as_a_whole(value[row].reshape(len(good), -1)[good], other.reshape(len(good), -1)[good], body.signature.full_name)
                    near_as_a_whole(third, other, body.signature.full_name)
                    assert np.isnan(value[row].reshape(len(bad), -1)[bad]).all()
    assert compared > 0 or not any(isinstance(body, Composite) for body in robot.bodies)


def test_no_nan_goes_with_ok(robot):
    """NaN in a target, joint value or rate gives BAD_INPUT: in NumPy with its routines, and in CasADi; NaN may ask for a default."""
    random = np.random.default_rng(10)
    for body in robot.bodies:
        signature = body.signature
        if not isinstance(body, Composite) or signature.status is None:
            continue
        place = signature.outputs.index(signature.status)
        for poisoned in (port.name for port in signature.inputs if port.kind == "real" and not np.isnan(port.default).any()):
            inputs = drawn(signature, random, feet=robot.feet)
            clean = listed(robot.vectorised(body)(*inputs.values()))
            inputs[poisoned].reshape(len(inputs[poisoned]), -1)[:, -1] = np.nan  # in every row, of scalars too
            found = listed(robot.vectorised(body)(*inputs.values()))
            if all(np.array_equal(mine, other) for mine, other in zip(found, clean, strict=True)):
                continue  # the last element does not matter: the Jacobian of a leg that ends in a slide does not know how far that is out
            status = found[place]
            assert (status == BAD_INPUT).all(), f"{signature.full_name} with NaN in {poisoned}"
            if closed_form(body) is not None:
                np.testing.assert_array_equal(with_casadi(robot, body, inputs, 0)[place], np.full(status[0].size, BAD_INPUT))


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
                    spread = np.isnan(other) & ~np.isnan(value)  # SX cancels equal terms, so it may hold fewer NaN, never others
                    assert not spread.any(), body.signature.full_name

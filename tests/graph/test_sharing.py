"""A kernel gives way to a public function of the same code, whatever either is called, and to nothing else."""

from dataclasses import replace

import sympy

from walkgen.graph.lower import lower
from walkgen.graph.program import Call, Composite
from walkgen.graph.sharing import shared
from walkgen.signature import Port, Signature
from walkgen.symbolic.function import Function

STATUS = Port("status", kind="integer")


def program(owner, name, power=2, output=None, given="x"):
    port, output = Port(given, (1,)), output or Port("y", (1,))
    symbol = sympy.Symbol(f"{given}[0]")
    step = sympy.Symbol(f"{name}_step")
    return lower(Function(Signature("bot", owner, name, (port,), (output,)), (symbol,), ((step, sympy.sin(symbol)),), (step**power,)))


def calling(*kernels):
    signature = Signature("bot", "leg", "solve", (Port("x", (1,)),), (Port("y", (1,)),))
    return Composite(signature, (), tuple(Call(kernel, ("x", "y")) for kernel in kernels), ())


def test_the_public_function_is_called_instead():
    public, kernel = program("leg", "square"), program("leg", "square_inside", given="u")
    assert public != kernel
    assert shared((calling(kernel), public)) == (calling(public), public)


def test_other_code_is_kept():
    public, kernel = program("leg", "square"), program("leg", "cube", power=3)
    assert shared((calling(kernel), public)) == (calling(kernel), public)


def test_a_returned_status_is_no_output_of_a_kernel():
    public, kernel = program("leg", "verdict", output=STATUS), program("leg", "inside", output=STATUS)
    assert shared((calling(kernel), public)) == (calling(kernel), public)


def test_closed_forms_too():
    public, kernel = program("leg", "square"), program("leg", "square_inside", given="u")
    closed = replace(calling("wg_routine"), closed_form=calling(kernel, kernel))
    found = shared((closed, public))[0]
    assert found == replace(closed, closed_form=calling(public, public))

"""A kernel gives way to a public function of the same code, whatever either is called, and to nothing else."""

from dataclasses import replace

import sympy

from walkgen.graph.lower import lower
from walkgen.graph.program import Call, Composite
from walkgen.graph.sharing import repeated, shared
from walkgen.signature import Port, Signature
from walkgen.symbolic.function import Function

STATUS, X = Port("status", kind="integer"), Port("x", (1,))


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


def long(owner, name):
    """Enough operations to be worth a call."""
    port, output = Port("x", (1,)), Port("y", (1,))
    symbol = sympy.Symbol("x[0]")
    steps = [sympy.Symbol(f"s{number}") for number in range(30)]
    values = [sympy.sin(before + number) for number, before in enumerate([symbol, *steps[:-1]])]
    signature = Signature("bot", owner, name, (port,), (output,))
    return lower(Function(signature, (symbol,), tuple(zip(steps, values, strict=True)), (steps[-1],)))


def test_an_equal_leg_calls_the_first():
    first, second = long("left", "climb"), long("right", "climb")
    kept, called = shared((first, second))
    assert kept == first
    assert called == Composite(second.signature, (), (Call(first, ("x", "y")),), ())


def test_what_only_calls_a_public_function_repeats_it():
    first, second = long("left", "climb"), long("right", "climb")
    called = shared((first, second))[1]
    assert repeated((first, called)) == {called: first}
    assert repeated((called,)) == {}
    assert repeated((first, calling(first, first))) == {}


def owned(owner, composite):
    return replace(composite, signature=replace(composite.signature, owner=owner, doc=f"Of the {owner} leg."))


def test_equal_legs_repeat_what_takes_several_steps():
    steps = calling(long("left", "climb"), long("left", "climb"))
    left, right = owned("left", steps), owned("right", steps)
    assert repeated((left, right)) == {right: left}
    assert repeated((left, replace(right, calls=right.calls[:1]))) == {}
    other = replace(right, signature=replace(right.signature, inputs=(Port("u", (1,)),)))
    assert repeated((left, other)) == {}


def test_a_function_that_names_its_own_callbacks_repeats_none():
    steps = replace(calling(long("left", "climb"), long("left", "climb")), callbacks=(calling(long("left", "climb")),))
    assert repeated((owned("left", steps), owned("right", steps))) == {}


def test_a_returned_status_is_left_to_the_first_too():
    first, second = (
        replace(long(owner, "climb"), signature=Signature("bot", owner, "verdict", (X,), (STATUS,))) for owner in ("left", "right")
    )
    assert shared((first, second)) == (first, second)
    assert repeated((first, second)) == {second: first}


def sums(owner):
    x = sympy.Symbol("x[0]")
    return lower(Function(Signature("bot", owner, "sum", (X,), (Port("y", (1,)),)), (x,), (), (x**2 + x,)))


def test_short_functions_keep_their_text():
    first, second = sums("left"), sums("right")
    assert shared((first, second)) == (first, second)
    assert repeated((first, second)) == {}


def test_functions_with_a_sine_are_never_short():
    first, second = program("left", "square"), program("right", "square")
    assert shared((first, second)) == (first, Composite(second.signature, (), (Call(first, ("x", "y")),), ()))


def test_equal_kernels_are_one():
    first, second = calling(long("left", "climb")), calling(long("right", "climb"))
    assert shared((first, second)) == (first, first)

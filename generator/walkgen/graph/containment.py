"""Which Programs another one computes among other things: where size counts they take all from it."""

from collections.abc import Iterable

from walkgen.graph.program import Code, Program
from walkgen.signature import Port, Signature

Values = dict[tuple[object, ...], int]
"""Numbers of values: equal operations on equal values have one, whatever Program they stand in."""


def contained(program: Program, others: Iterable[Program]) -> Program | None:
    """The one with the fewest outputs of those with the same inputs that have all outputs of the Program, by the same names, and others."""
    own = program.signature
    fitting = [other for other in others if other.signature.inputs == own.inputs and _has_ports(other.signature, own)]
    values: Values = {}
    wanted = _outputs(values, program)
    found = (other for other in fitting if other is not program and _outputs(values, other).items() >= wanted.items())
    return min(found, key=lambda other: len(other.outputs), default=None)


def _has_ports(signature: Signature, other: Signature) -> bool:
    """More outputs than the other, the other's among them."""
    return set(other.outputs) < set(signature.outputs)


def _outputs(values: Values, program: Program) -> dict[tuple[Port, int], int]:
    """The number of every element of an output."""
    inputs = program.signature.inputs
    numbers: list[int] = []
    for op in program.ops:
        own = (inputs[op.element[0]], op.element[1]) if op.code is Code.INPUT else op.value
        numbers.append(values.setdefault((op.code, tuple([numbers[argument] for argument in op.arguments]), own), len(values)))
    elements = ((port, element) for port in program.signature.outputs for element in range(port.size))
    return {element: numbers[output] for element, output in zip(elements, program.outputs, strict=True)}

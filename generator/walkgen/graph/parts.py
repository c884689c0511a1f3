"""Programs that are parts of others: whoever has the whole may take its answer for the part's, to the bit."""

from collections import defaultdict
from collections.abc import Hashable, Iterable

from walkgen.graph.program import Program

Values = dict[str, tuple[int, ...]]
"""Of output ports by name: the number of each element's value."""


def parts(programs: Iterable[Program], wholes: Iterable[Program]) -> dict[Program, Program]:
    """The programs all of whose outputs another one of the same inputs computes too, each with that one of the fewest operations.

    Args:
        programs: what may be a part.
        wholes: what may answer for it; those with a status are left aside.
    """
    by_inputs = defaultdict(list)
    for whole in sorted(wholes, key=lambda each: each.operation_count):
        if whole.signature.returned is None:
            by_inputs[whole.signature.owner, whole.signature.inputs].append(whole)
    found = ((part, _whole_of(part, by_inputs[part.signature.owner, part.signature.inputs])) for part in programs)
    return {part: whole for part, whole in found if whole is not None}


def _whole_of(part: Program, others: Iterable[Program]) -> Program | None:
    """The first that has it; ports tell of most in a moment that they have not."""
    outputs = set(part.signature.outputs)
    larger = (whole for whole in others if outputs < set(whole.signature.outputs))
    return next((whole for whole in larger if _contains(whole, part)), None)


def _contains(whole: Program, part: Program) -> bool:
    numbers: dict[Hashable, int] = {}
    held = _values(whole, numbers)
    return all(held[name] == wanted for name, wanted in _values(part, numbers).items())


def _values(program: Program, numbers: dict[Hashable, int]) -> Values:
    """Equal numbers are equal values: the same operation on the same values."""
    values: list[int] = []
    for op in program.ops:
        key = (op.code, tuple(values[index] for index in op.arguments), op.element, op.value)
        values.append(numbers.setdefault(key, len(numbers)))
    outputs = iter(program.outputs)
    return {port.name: tuple(values[next(outputs)] for _ in range(port.size)) for port in program.signature.outputs}

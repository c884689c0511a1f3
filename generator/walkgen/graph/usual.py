"""Of a Program that tells by one truth which inputs are usual: what it computes of those, without what it would choose for others.

A derivation may decide by a few comparisons that nothing can go wrong (status OK), and choose by many others what is right everywhere.
Where the first hold many of those are settled, and what they would choose need not be computed; elsewhere the first are of no use.
"""

from collections.abc import Mapping, Sequence
from decimal import Decimal

from walkgen.graph.passes import ANGULAR, needs, pruned, reordered
from walkgen.graph.program import Code, Op, Program
from walkgen.signature import STATUSES

_OK, _UNREACHABLE = (STATUSES.index(name) for name in ("OK", "UNREACHABLE"))
_BOTH = {Code.AND: False, Code.OR: True}
"""What one operand is enough for."""


def usual_truth(program: Program) -> int | None:
    """The operation whose truth is enough for every status to be OK, if all of them are chosen by it and it waits for no angle."""
    ops = program.ops
    told = _told(program)
    truths = {op.arguments[0] for op in told if op.code is Code.SELECT}
    if len(truths) != 1 or not all(op.code is Code.SELECT and _is_ok(ops[op.arguments[1]]) for op in told):
        return None
    return None if any(ops[number].code in ANGULAR for number in needs(ops, truths)) else truths.pop()


def _told(program: Program) -> list[Op]:
    """What tells its statuses."""
    return [program.ops[number] for number, name in zip(program.outputs, _names(program), strict=True) if name == "status"]


def _is_ok(op: Op) -> bool:
    return op.code is Code.CONSTANT and op.value == _OK


def _may_be_ok(ops: Sequence[Op], number: int) -> bool:
    """Whether a status can be OK, as far as its choices tell."""
    op = ops[number]
    if op.code is Code.SELECT:
        return any(_may_be_ok(ops, choice) for choice in op.arguments[1:])
    return op.code is not Code.CONSTANT or _is_ok(op)


def usual(program: Program) -> Program:
    """The Program for usual inputs: for others its statuses are UNREACHABLE and nothing else holds. Itself if it tells of none.

    What decides comes first. Each part of the truth may take for granted those that it rests on: of all that do not hold one rests on no
    other such, so it is computed rightly, and it is enough.
    """
    truth = usual_truth(program)
    if truth is None:
        return program
    ops, place = _chosen(program, dict(_parts(program.ops, truth, holds=True)))
    ops[place[truth]] = ops[place[truth]]._replace(name="usual")
    ops += [Op(Code.CONSTANT, value=Decimal(status)) for status in (_OK, _UNREACHABLE)]
    ops.append(Op(Code.SELECT, (place[truth], len(ops) - 2, len(ops) - 1), name="state"))
    outputs = [len(ops) - 1 if name == "status" else place[number] for name, number in zip(_names(program), program.outputs, strict=True)]
    deciding = needs(ops, [len(ops) - 1])
    order = sorted(range(len(ops)), key=lambda number: (ops[number].code is not Code.INPUT, number not in deciding, number))
    return pruned(reordered(Program(program.signature, tuple(ops), tuple(outputs)), order))


def _chosen(program: Program, known: Mapping[int, bool]) -> tuple[list[Op], list[int]]:
    """The operations, equal ones once, without the choices that are settled; where each of the Program's stands among them."""
    ops: list[Op] = []
    place: list[int] = []
    met: dict[Op, int] = {}
    for op in program.ops:
        settled = _settled(program.ops, op.arguments[0], known) if op.code is Code.SELECT else None
        if settled is not None:
            place.append(place[op.arguments[1 if settled else 2]])
            continue
        own = op._replace(arguments=tuple(place[number] for number in op.arguments))
        place.append(met.setdefault(own._replace(name=""), len(ops)))
        ops += [own] if place[-1] == len(ops) else []
    return ops, place


def for_all(program: Program) -> Program:
    """The Program without what serves usual inputs alone: what may find others OK too finds them all. Itself if nothing does."""
    truth = usual_truth(program)
    if truth is None or not all(_may_be_ok(program.ops, op.arguments[2]) for op in _told(program)):
        return program
    ops, place = _chosen(program, {truth: False})
    return pruned(Program(program.signature, tuple(ops), tuple(place[number] for number in program.outputs)))


def _names(program: Program) -> list[str]:
    """Of the ports, one for each output."""
    return [port.name for port in program.signature.outputs for _ in range(port.size)]


def _parts(ops: Sequence[Op], number: int, *, holds: bool) -> list[tuple[int, bool]]:
    """Which truths follow from this one."""
    op = ops[number]
    if op.code is Code.NOT:
        return [(number, holds), *_parts(ops, op.arguments[0], holds=not holds)]
    if _BOTH.get(op.code) is (not holds):
        return [(number, holds), *(part for operand in op.arguments for part in _parts(ops, operand, holds=holds))]
    return [(number, holds)]


def _settled(ops: Sequence[Op], number: int, known: Mapping[int, bool]) -> bool | None:
    """What the truth is, where that is known."""
    op = ops[number]
    if number in known:
        return known[number]
    if op.code is Code.NOT:
        inner = _settled(ops, op.arguments[0], known)
        return None if inner is None else not inner
    if op.code in _BOTH:
        enough, given = _BOTH[op.code], [_settled(ops, operand, known) for operand in op.arguments]
        return enough if enough in given else None if None in given else not enough
    return None

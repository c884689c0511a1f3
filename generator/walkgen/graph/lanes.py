"""Which Programs can run many rows at once, one a lane of a vector, with angles that give NaN beyond their range.

A lane has no branch to ask the C library what the own sine, cosine and arctangent do not know (angles beyond 1e5, points next to the
origin): there its angle is NaN, and a row with a NaN among its results is computed once more, alone. So every result must be either
what it would have been or NaN. Sums and products are. A comparison with NaN is false, and what is chosen by it may be wrong: that
is allowed only where the choice then falls on something that is NaN for the same reason, as in `t <= -pi ? pi : t`.
"""

from collections.abc import Iterable, Sequence
from functools import reduce
from operator import or_
from typing import NamedTuple

from walkgen.graph.program import Code, Op, Program

_ANGULAR = frozenset({Code.SIN, Code.COS, Code.ATAN2})
_COMPARISONS = frozenset({Code.LESS, Code.LESS_EQUAL, Code.EQUAL})
_STRICT = frozenset({Code.NEG, Code.ADD, Code.SUB, Code.MUL, Code.DIV, Code.FMA, Code.FMS, Code.FNMA, Code.SQRT, Code.ABS}) | _ANGULAR
_KNOWN = _STRICT | _COMPARISONS | {
    Code.INPUT, Code.CONSTANT, Code.EPSILON, Code.MIN, Code.MAX, Code.FINITE, Code.AND, Code.OR, Code.NOT, Code.INDICATOR, Code.SELECT,
}  # fmt: skip


class _Fate(NamedTuple):
    """Of one value: the angles whose being NaN is sure to make it NaN, and those that may make it wrong. Both are sets of bits."""

    lost: int = 0
    wrong: int = 0


def runs_in_lanes(program: Program) -> bool:
    """Whether every real output is right or NaN where an angle is NaN, and every integer one right."""
    if any(op.code not in _KNOWN for op in program.ops):
        return False
    fates: list[_Fate] = []
    for number, op in enumerate(program.ops):
        fates.append(_fate(op, program.ops, fates, 1 << number))
    kinds = (port.kind for port in program.signature.outputs for _ in range(port.size))
    return all(_is_right(fates[number], kind) for number, kind in zip(program.outputs, kinds, strict=True))


def _is_right(fate: _Fate, kind: str) -> bool:
    return not fate.wrong if kind == "real" else not (fate.wrong | fate.lost)


def _fate(op: Op, ops: Sequence[Op], fates: Sequence[_Fate], own: int) -> _Fate:
    given = [fates[number] for number in op.arguments]
    lost, wrong = _union(fate.lost for fate in given), _union(fate.wrong for fate in given)
    if op.code in _STRICT:
        return _Fate(lost | (own if op.code in _ANGULAR else 0), wrong & ~lost)
    if op.code is not Code.SELECT:
        return _Fate(0, wrong | lost)
    asked, (_, then, otherwise) = ops[op.arguments[0]], given
    refused = _union(fates[number].lost for number in asked.arguments) if asked.code in _COMPARISONS else 0
    lost = otherwise.lost & (then.lost | refused)
    return _Fate(lost, wrong & ~lost)


def _union(sets: Iterable[int]) -> int:
    return reduce(or_, sets, 0)

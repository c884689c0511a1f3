"""Which Programs can run many rows at once, one a lane of a vector, with angles that give NaN beyond their range.

A lane has no branch to ask the C library what the own sine, cosine and arctangent do not know (angles beyond 1e5, the
origin): there its angle is NaN, and a row where that is found out is computed once more, alone. It is found out by a few results. Sums and
products are NaN if what they are made of is. A comparison with NaN is false, and what is chosen by it may be wrong, unless the choice then
falls on something that is NaN for the same reason, as in `t <= -pi ? pi : t`; what is chosen by something else is NaN or right.
"""

from collections.abc import Iterable, Sequence
from functools import reduce
from operator import or_
from typing import NamedTuple

from walkgen.graph.passes import ANGULAR
from walkgen.graph.program import Code, Op, Program

_COMPARISONS = frozenset({Code.LESS, Code.LESS_EQUAL, Code.EQUAL})
_STRICT = frozenset({Code.NEG, Code.ADD, Code.SUB, Code.MUL, Code.DIV, Code.FMA, Code.FMS, Code.FNMA, Code.SQRT, Code.ABS}) | ANGULAR
_KNOWN = _STRICT | _COMPARISONS | {
    Code.INPUT, Code.CONSTANT, Code.EPSILON, Code.MIN, Code.MAX, Code.FINITE, Code.AND, Code.OR, Code.NOT, Code.INDICATOR, Code.SELECT,
}  # fmt: skip


class _Fate(NamedTuple):
    """Of one value, as sets of bits: angles it hears of; those sure to make it NaN where they are; those that may make it wrong."""

    heard: int = 0
    lost: int = 0
    wrong: int = 0


def telling(program: Program) -> tuple[int, ...] | None:
    """Few of the outputs, counted element by element, of which one is NaN wherever an output would not be right.

    Returns:
        Their places; None where angles could go wrong unnoticed, or an operation is not known to lanes.
    """
    if any(op.code not in _KNOWN for op in program.ops):
        return None
    fates: list[_Fate] = []
    for number, op in enumerate(program.ops):
        fates.append(_fate(op, program.ops, fates, _angle(op, number)))
    kinds = (port.kind for port in program.signature.outputs for _ in range(port.size))
    found = [_told(fates[number], kind) for number, kind in zip(program.outputs, kinds, strict=True)]
    covered = _union(fate.lost for fate in found)
    if any(fate.wrong & ~covered for fate in found):
        return None
    first = {number: place for place, number in reversed(list(enumerate(program.outputs)))}
    own = sorted({first[number] for number, fate in zip(program.outputs, found, strict=True) if fate.heard & ~covered})
    seen = _union(found[place].lost for place in own)
    return (*own, *_covering([fate.lost for fate in found], _union(fate.heard for fate in found) & covered & ~seen))


def _told(fate: _Fate, kind: str) -> _Fate:
    """Of an output: an integer is never NaN."""
    return fate if kind == "real" else _Fate(fate.heard, 0, fate.heard)


def _covering(sets: Sequence[int], wanted: int) -> tuple[int, ...]:
    """Places of sets that hold all that is wanted, at each step one that adds most."""
    chosen: list[int] = []
    while wanted:
        place = max(range(len(sets)), key=lambda place: (sets[place] & wanted).bit_count())
        wanted &= ~sets[place]
        chosen.append(place)
    return tuple(chosen)


def _angle(op: Op, number: int) -> int:
    """The bit of what it may lose, if anything: an arctangent itself, a sine or cosine its angle."""
    if op.code not in ANGULAR:
        return 0
    return 1 << (2 * number if op.code is Code.ATAN2 else 2 * op.arguments[0] + 1)


def _fate(op: Op, ops: Sequence[Op], fates: Sequence[_Fate], own: int) -> _Fate:
    given = [fates[number] for number in op.arguments]
    heard, lost, wrong = (_union(each) for each in zip(*given, strict=True)) if given else (0, 0, 0)
    if op.code in _STRICT:
        return _Fate(heard | own, lost | own, wrong & ~lost)
    if op.code is not Code.SELECT:
        return _Fate(heard, 0, heard)
    asked, (_, then, otherwise) = ops[op.arguments[0]], given
    refused = _union(fates[number].lost for number in asked.arguments) if asked.code in _COMPARISONS else 0
    lost = otherwise.lost & (then.lost | refused)
    return _Fate(heard, lost, wrong & ~lost)


def _union(sets: Iterable[int]) -> int:
    return reduce(or_, sets, 0)

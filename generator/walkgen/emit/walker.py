"""Turns a Program into statements and output expressions; every target's printer stands on this one walk."""

import re
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from enum import IntEnum
from functools import cache
from itertools import count
from typing import Protocol

from walkgen.graph.passes import Group, groups, turns
from walkgen.graph.program import TRUTH_CODES, Code, Op, Program
from walkgen.signature import Port

_WIDEST = 84
_DEEPEST = 5
_LONGEST_NAME = 40
_PAIRED = {Code.SIN: Code.COS, Code.COS: Code.SIN}
_LEAVES = frozenset({Code.INPUT, Code.CONSTANT})


class Level(IntEnum):
    """How tightly a text binds; an operand that binds less than its place asks for is bracketed."""

    ANY = 0
    OR = 1
    AND = 2
    COMPARE = 3
    SUM = 4
    PRODUCT = 5
    UNARY = 6
    ATOM = 7


@dataclass(frozen=True)
class Form:
    """How one operation is written: `{0}`, `{1}`, `{2}` are its operands, `needs` the level each place asks for.

    A call such as `sin({0})` is an ATOM whose operands may be ANY.
    """

    template: str
    level: Level = Level.ATOM
    needs: tuple[Level, ...] = (Level.ANY, Level.ANY, Level.ANY)


@dataclass(frozen=True)
class Text:
    """An expression; `depth` counts nested operations, `after` the statements it has to follow."""

    text: str
    level: Level = Level.ATOM
    depth: int = 0
    after: int = 0


@dataclass(frozen=True)
class Statement:
    """One named local value; `truth` tells comparisons and their combinations from numbers.

    With `names` the text is a whole statement that sets them all, and `then` are statements that complete them; what nothing reads of
    them stands in `idle`.
    """

    name: str
    text: str
    truth: bool = False
    names: tuple[str, ...] = ()
    idle: tuple[str, ...] = ()
    then: tuple[str, ...] = ()


@dataclass(frozen=True)
class Body:
    """A Program as text: `outputs` has one expression for each of the Program's outputs, in its order, `written` those of all operations.

    Writing every statement and then every output is right; an output may also be written once `after` statements are.
    """

    statements: tuple[Statement, ...]
    outputs: tuple[Text, ...]
    written: Mapping[int, Text]


class Printer(Protocol):
    """What a target has to supply."""

    @property
    def forms(self) -> Mapping[Code, Form]:
        """One entry for each operation; INPUT and CONSTANT have none."""

    @property
    def reserved(self) -> frozenset[str]:
        """Names that a local value must not take; the ports' names are added by the walk."""

    def together(self, angles: int) -> Mapping[Code, str]:
        """What sets several sines and cosines (`SIN`), or arctangents, in one statement; `{0}` is their number. Empty: nothing does.

        Args:
            angles: of how many the whole Program has sine or cosine.
        """

    @property
    def sums(self) -> tuple[str, str]:
        """For angles that are sums of another angle of the same statement and a part, which a target may do without the sum.

        How such an angle `{0}` is given with its part `{1}`; and the statement that then turns its sine `{0}` and cosine `{1}` by the other
        angle's `{2}` and `{3}`.
        """

    def constant(self, value: Decimal) -> Text:
        """A literal of the target's precision; UNARY where it carries a sign."""

    def element(self, port: Port, index: int) -> Text:
        """The row-major element of an input port, as a number of the target's precision."""


def walk(program: Program, printer: Printer) -> Body:
    """Write the Program: values used more than once or carrying a name become statements, the others are inlined.

    Operations that no output uses are dropped; sin and cos of one argument stand side by side.
    """
    walked = _Walk(program, printer)
    for index in live(program):
        walked.visit(index)
    return Body(tuple(walked.statements), tuple(walked.written[index] for index in program.outputs), walked.written)


def live(program: Program) -> tuple[int, ...]:
    """Indices of the ops that some output needs, ascending."""
    needed = set(program.outputs)  # arguments come before their users, so one backward pass finds all
    for index in range(len(program.ops) - 1, -1, -1):
        if index in needed:
            needed.update(program.ops[index].arguments)
    return tuple(sorted(needed))


@cache
def identifier(name: str) -> str:
    """The name with everything but ASCII letters, digits and single inner underscores removed."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:_LONGEST_NAME].rstrip("_")
    return f"v{words}" if words[:1].isdigit() else words


def bracket(text: Text, level: Level) -> str:
    """The text, bracketed where it binds less than `level`."""
    return text.text if text.level >= level else f"({text.text})"


def _family(code: Code) -> Code:
    return Code.SIN if code is Code.COS else code


def _first(group: Group) -> int:
    return min(member for members in group for member in members)


def _is_ready(group: Group, program: Program, needed: Collection[int]) -> bool:
    """Whether all that the group waits for comes before its first operation, and all of it is needed."""
    members = [member for same in group for member in same]
    waits = max(argument for member in members for argument in program.ops[member].arguments)
    return waits < min(members) and all(member in needed for member in members)


class _Walk:
    """The walk's growing state: what is written so far and the names taken."""

    def __init__(self, program: Program, printer: Printer) -> None:
        needed = live(program)
        self.program = program
        self.printer = printer
        self.statements: list[Statement] = []
        self.written: dict[int, Text] = {}
        self.uses = Counter(program.outputs)
        for index in needed:
            self.uses.update(program.ops[index].arguments)
        self.pairs = {(op.code, op.arguments): index for index in needed if (op := program.ops[index]).code in _PAIRED}
        ports = program.signature.inputs + program.signature.outputs
        found = groups(program)
        self.groups = {_first(group): group for group in found if len(group) > 1 and _is_ready(group, program, set(needed))}
        self.together = printer.together(sum(len(group) for group in found if _family(program.ops[_first(group)].code) is Code.SIN))
        self.taken = set(printer.reserved) | {port.name for port in ports}
        self.numbers: defaultdict[str, Iterator[int]] = defaultdict(lambda: count(1))

    def visit(self, index: int) -> None:
        """Write one op, and right after it the cosine of the same sine."""
        if index in self.written:
            return
        op = self.program.ops[index]
        if index in self.groups and _family(op.code) in self.together:
            self.bind_together(self.groups[index])
            return
        self.written[index] = self.expression(op)
        if self.stands_alone(index, op):
            self.bind(index)
        partner = self.pairs.get((_PAIRED[op.code], op.arguments)) if op.code in _PAIRED else None
        if partner is not None:
            self.visit(partner)

    def stands_alone(self, index: int, op: Op) -> bool:
        """Whether the op becomes a statement of its own."""
        return op.code not in _LEAVES and (self.uses[index] > 1 or bool(identifier(op.name)) or op.code in _PAIRED)

    def expression(self, op: Op) -> Text:
        """The op over its operands, the bulkiest of which become statements until it is short and shallow enough."""
        if op.code is Code.INPUT:
            return self.printer.element(self.program.signature.inputs[op.element[0]], op.element[1])
        if op.code is Code.CONSTANT:
            return self.printer.constant(op.value)
        composed = self.compose(op)
        while len(composed.text) > _WIDEST or composed.depth > _DEEPEST:
            bulky = max(op.arguments, key=lambda argument: (self.written[argument].depth > 0, len(self.written[argument].text)))
            if self.written[bulky].depth == 0:
                break
            self.bind(bulky)
            composed = self.compose(op)
        return composed

    def compose(self, op: Op) -> Text:
        form = self.printer.forms[op.code]
        texts, depth, after = [], 0, 0
        for argument, level in zip(op.arguments, form.needs, strict=False):
            operand = self.written[argument]
            texts.append(bracket(operand, level))
            depth, after = max(depth, operand.depth), max(after, operand.after)
        return Text(form.template.format(*texts), form.level, depth + 1, after)

    def bind(self, index: int) -> None:
        """Make what is written of the op a statement; from now on it is known by its name."""
        op = self.program.ops[index]
        name = self.name(op)
        self.statements.append(Statement(name, self.written[index].text, op.code in TRUTH_CODES))
        self.written[index] = Text(name, after=len(self.statements))

    def bind_together(self, group: Group) -> None:
        """One statement for all angles or points of a group."""
        family = _family(self.program.ops[group[0][0]].code)
        given = {members[0]: [self.written[argument].text for argument in self.program.ops[members[0]].arguments] for members in group}
        names = {members[0]: self.names_of(members, family) for members in group}
        whole, turned = self.printer.sums
        then = []
        for turn in turns(group, self.program):
            part = bracket(self.written[turn.part], Level.UNARY)
            given[turn.angle] = [whole.format(*given[turn.angle], f"-{part}" if turn.back else self.written[turn.part].text)]
            then.append(turned.format(*names[turn.angle], *names[turn.other]))
        texts = ", ".join(text for first, named in names.items() for text in (*given[first], *named))
        every = {name: read for named in names.values() for name, read in named.items()}
        idle = tuple(name for name, read in every.items() if not read)
        text = f"{self.together[family].format(len(group))}({texts})"
        self.statements.append(Statement(next(iter(every)), text, names=tuple(every), idle=idle, then=tuple(then)))

    def names_of(self, members: tuple[int, ...], family: Code) -> dict[str, bool]:
        """What a group sets of one angle or point, and whether anything reads it."""
        ops = self.program.ops
        codes = {ops[member].code: member for member in members}
        names: dict[str, bool] = {}
        for code in (Code.SIN, Code.COS) if family is Code.SIN else (Code.ATAN2,):
            member = codes.get(code)
            name = self.name(ops[members[0]]._replace(code=code, name="") if member is None else ops[member])
            names[name] = member is not None
            if member is not None:
                self.written[member] = Text(name, after=len(self.statements) + 1)
        return names

    def name(self, op: Op) -> str:
        wanted = identifier(op.name) or self.angle_name(op)
        numbers = self.numbers[wanted]
        candidates = (f"{wanted}_{number}" if wanted and number > 1 else wanted or f"t{number}" for number in numbers)
        name = next(name for name in candidates if name not in self.taken)
        self.taken.add(name)
        return name

    def angle_name(self, op: Op) -> str:
        """`sin_q0` for the sine of an input; empty for all else."""
        if op.code not in _PAIRED or self.program.ops[op.arguments[0]].code is not Code.INPUT:
            return ""
        port, index = self.program.ops[op.arguments[0]].element
        return f"{op.code.value}_{self.program.signature.inputs[port].name}{index}"

"""A Program: flat, value-numbered, branch-free straight-line code, the meeting point of derivations and printers."""

from collections import Counter
from dataclasses import dataclass
from decimal import Decimal
from enum import Enum
from functools import cached_property
from typing import NamedTuple

from walkgen.signature import Argument, Port, Signature, Table


class Code(Enum):
    """The operations of a Program; truth values exist only as arguments of `SELECT`, `INDICATOR`, `AND`, `OR`, `NOT`.

    `FMA` is a*b + c, `FMS` a*b - c, `FNMA` c - a*b, each rounded once where the target has the instruction;
    `SELECT` is (truth, then, otherwise) and evaluates both; `INDICATOR` is 1 where its truth holds, else 0, for choices
    that must not become jumps; `ATAN2` is (y, x); `EPSILON` is the distance from 1 to the target's next number.
    """

    __hash__ = object.__hash__  # Enum's hashes names, in Python, where programs are compared a million times

    INPUT = "input"
    CONSTANT = "constant"
    NEG = "neg"
    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    FMA = "fma"
    FMS = "fms"
    FNMA = "fnma"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"
    TAN = "tan"
    ATAN2 = "atan2"
    ABS = "abs"
    MIN = "min"
    MAX = "max"
    LESS = "less"
    LESS_EQUAL = "less_equal"
    EQUAL = "equal"
    FINITE = "finite"
    AND = "and"
    OR = "or"
    NOT = "not"
    SELECT = "select"
    INDICATOR = "indicator"
    EPSILON = "epsilon"

    __hash__ = object.__hash__  # Enum hashes its name on every look-up, and programs are looked up by all their operations


TRUTH_CODES = frozenset({Code.LESS, Code.LESS_EQUAL, Code.EQUAL, Code.FINITE, Code.AND, Code.OR, Code.NOT})


class Op(NamedTuple):
    """One value: `arguments` are indices of earlier ops.

    `INPUT` carries (port index, row-major element index) in `element`; `CONSTANT` carries its 40-digit `value`.
    `name` is the derivation's name of the value, for readable code; empty when it has none.
    """

    code: Code
    arguments: tuple[int, ...] = ()
    element: tuple[int, int] = (0, 0)
    value: Decimal = Decimal(0)
    name: str = ""


@dataclass(frozen=True)
class Program:
    """`outputs` are op indices, one for each element of every output port, port after port, row-major.

    Every element of every input port has its `INPUT` op, first and in order, even where nothing uses it.
    """

    signature: Signature
    ops: tuple[Op, ...]
    outputs: tuple[int, ...]

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.signature, self.ops, self.outputs))

    def counts(self) -> Counter[str]:
        """How often each operation occurs, by its name."""
        return Counter(op.code.value for op in self.ops)

    @cached_property
    def operation_count(self) -> int:
        """Arithmetic operations: every op but inputs and constants."""
        return sum(op.code not in (Code.INPUT, Code.CONSTANT) for op in self.ops)


Guard = tuple[str, tuple[Argument, ...]]
"""A support routine that tells a truth in C, and its arguments."""


@dataclass(frozen=True)
class Call:
    """One step of a Composite: a Program (emitted as a static kernel) or a support routine by its name.

    `arguments` name the Composite's inputs, locals, outputs, tables or callbacks, in the callee's order, inputs first; a Decimal is a
    literal, Records list callbacks.
    With `guard` the step runs only where it holds.
    A Program may read what it writes, and `repeat` runs it that often.
    """

    callee: Program | str
    arguments: tuple[Argument, ...]
    guard: Guard | None = None
    repeat: int = 1


@dataclass(frozen=True)
class Composite:
    """A function of several calls in order, joined by `locals`; some may be support routines.

    `headers` are the csupport files the routines live in; `closed_form` stands in where routines do not exist (CasADi):
    a Program, or a Composite that calls Programs alone. `tables` are constants that routines read, `callbacks` what they call.
    `slopes` tell how inputs of the last call that earlier ones compute move with the runtime parameters; they are not run by this function.
    """

    signature: Signature
    locals: tuple[Port, ...]
    calls: tuple[Call, ...]
    headers: tuple[str, ...]
    closed_form: "Program | Composite | None" = None
    tables: tuple[Table, ...] = ()
    callbacks: tuple["Composite", ...] = ()
    slopes: tuple[Call, ...] = ()

    @property
    def calls_routines(self) -> bool:
        """Whether a step is a support routine, whose operations nobody counts and CasADi does not have."""
        return any(isinstance(call.callee, str) for call in self.calls)

    @property
    def all_calls(self) -> tuple[Call, ...]:
        """Its own and those of its callbacks."""
        return (*self.calls, *(call for callback in self.callbacks for call in callback.all_calls))

    @property
    def all_callbacks(self) -> tuple["Composite", ...]:
        """Its own, each after those that its routines call themselves."""
        return tuple(each for callback in self.callbacks for each in (*callback.all_callbacks, callback))

    @property
    def all_tables(self) -> tuple[Table, ...]:
        """Its own and those of its callbacks."""
        return (*self.tables, *(table for callback in self.callbacks for table in callback.all_tables))

"""How functions are declared in C: names, types, parameters in lines."""

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from walkgen.emit.c_printer import Precision
from walkgen.signature import Port, Signature

INDENT = "    "
COLUMNS = 116


@dataclass(frozen=True)
class CFunction:
    """One function, ready to be laid out: `head` is its declaration without `;`, `lines` its body, indented, `small` that of small builds.

    `locals_size` bounds the bytes of its named locals: temporaries live in registers or share their slots. `usual` does the same for usual
    inputs, and gives up with the status UNREACHABLE where others come.
    """

    name: str
    head: str
    lines: tuple[str, ...]
    doc: tuple[str, ...] = ()
    locals_size: int = 0
    usual: "CFunction | None" = None
    small: tuple[str, ...] = ()


def function_name(signature: Signature, precision: Precision) -> str:
    """`mero_front_left_foot_position`, or `mero_f32_front_left_foot_position`."""
    return "_".join(part for part in (signature.robot, precision.tag, signature.owner, signature.name) if part)


def callback_name(signature: Signature, precision: Precision) -> str:
    """Set apart from public functions."""
    return f"{function_name(signature, precision)}_callback"


def port_type(port: Port, precision: Precision) -> str:
    """Of an element."""
    return precision.real if port.kind == "real" else "int32_t"


def port_size(port: Port, precision: Precision) -> int:
    """In bytes."""
    return port.size * (precision.size if port.kind == "real" else 4)


def count_parameters(signature: Signature) -> list[str]:
    """Before all inputs."""
    return [f"int32_t {count}" for count in signature.counts]


def workspace_parameter(signature: Signature, precision: Precision) -> list[str]:
    """The caller's struct, as a parameter; shared by all rows of a batch."""
    name = "_".join(part for part in (signature.workspace, precision.tag) if part)
    return [f"struct {name} *WG_RESTRICT work"] if signature.workspace else []


def parameters(inputs: tuple[Port, ...], outputs: tuple[Port, ...], precision: Precision) -> list[str]:
    """Inputs, then pointers to outputs."""
    written = [f"{port_type(port, precision)} *WG_RESTRICT {port.name}" for port in outputs]
    return [*(_input_parameter(port, precision) for port in inputs), *written]


def declared(start: str, parameters: Sequence[str]) -> str:
    """A declaration, its parameters filled into lines where one is not enough."""
    lines = [f"{start}("]
    for place, text in enumerate(parameters or ["void"]):
        piece = text + (", " if place + 1 < len(parameters) else ")")
        if len(lines[-1]) + len(piece) > COLUMNS:
            lines.append(INDENT)
        lines[-1] += piece
    return "\n".join(line.rstrip() for line in lines)


def wrapped(text: str) -> list[str]:
    """A statement in as many lines as it needs."""
    return textwrap.wrap(text, COLUMNS, initial_indent=INDENT, subsequent_indent=INDENT * 2, break_long_words=False)


def call_lines(name: str, signature: Signature, first: Iterable[str], outputs: Iterable[Port], *, returns: bool) -> tuple[str, ...]:
    """The body of a function that leaves all to another one with the same parameters, of which `first` come before the signature's."""
    work = ("work",) if signature.workspace else ()
    names = [*first, *signature.counts, *(port.name for port in signature.inputs), *work, *(port.name for port in outputs)]
    return tuple(f"{INDENT}{'return ' if returns else ''}{declared(name, names)};".split("\n"))


def _input_parameter(port: Port, precision: Precision) -> str:
    return f"const {port_type(port, precision)} *WG_RESTRICT {port.name}" if port.shape else f"{port_type(port, precision)} {port.name}"

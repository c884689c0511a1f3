"""Prints `<robot>_python.c`: for each function the inner loop that NumPy calls, which makes a generalised ufunc of a C function."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_lanes import laned
from walkgen.emit.c_printer import DOUBLE, FLOAT, Precision
from walkgen.emit.c_text import banner
from walkgen.emit.layout import lay_out
from walkgen.emit.python_wide import WideLoop, wide, wide_loops, wide_sources
from walkgen.signature import COUNTS, Port, Signature

_WORD = 8
"""Bytes that a core buffer's entries are aligned to; also the size of NumPy's integers here (int64 in, int32 out)."""

_HEADER = "walkgen_loops.h"
_WIDEST = 110
_MOST_PORTS, _HIGHEST_RANK = 32, 6


@dataclass(frozen=True)
class Loop:
    """One loop, ready to be laid out: entries of its port table, what makes the table of a call where shapes vary, the lines that run
    one row. `wide` says how wider vectors serve it, `same` names an earlier function with the same code, whose loop serves.
    """

    name: str
    real: str
    buffer: int
    ports: tuple[str, ...]
    before: str
    lines: tuple[str, ...]
    wide: WideLoop | None
    same: str


def python_loops(code: RobotCode) -> Artifact:
    """`<robot>_python.c` with `<full_name>_loop` for every function that NumPy can call, in double and, where asked for, in float.

    A loop takes integers as int64 and gives int32, reals in its own precision; scalars go by value, a scalar `status` is
    what the C function returns.
    """
    robot = code.mechanism.name
    precisions, lanes = _precisions(code), laned(code)
    looped = [(body.signature, code.repeated.get(body)) for body in code.functions if has_loop(body.signature)]
    return lay_out(
        "python.c.jinja",
        f"{robot}_python.c",
        banner=banner(code, "The loops through which NumPy calls the functions: part of the Python library only."),
        headers=[f"{'_'.join(part for part in (robot, precision.tag) if part)}.h" for precision in precisions],
        wide=[wide(code, lanes, precision) for precision in precisions] if lanes else [],
        loops=[
            _loop(signature, precision, wider.get(signature.full_name), function_name(same.signature, precision) if same else "")
            for precision in precisions
            for wider in [wide_loops(code, lanes, precision)]
            for signature, same in looped
        ],
    )


def _precisions(code: RobotCode) -> tuple[Precision, ...]:
    return (DOUBLE, FLOAT) if code.float32 else (DOUBLE,)


def python_sources(code: RobotCode) -> tuple[Artifact, ...]:
    """What the Python library is compiled from besides the robot's own C sources: the loops, wide vectors, the headers they stand on."""
    header = (Path(__file__).parent / "csupport" / _HEADER).read_text(encoding="utf-8")
    return (python_loops(code), Artifact(PurePosixPath(_HEADER), header), *wide_sources(code, _precisions(code)))


def has_loop(signature: Signature) -> bool:
    """Whether a ufunc can carry the function: it has an input, no array of size 0, no more ports or dimensions than
    walkgen_loops.h has room for; NumPy code serves the others.
    """
    ports = signature.inputs + signature.outputs
    return (
        bool(signature.inputs)
        and len(ports) <= _MOST_PORTS
        and all(0 not in port.shape and len(port.shape) <= _HIGHEST_RANK for port in ports)
    )


def _loop(signature: Signature, precision: Precision, wider: WideLoop | None, same: str) -> Loop:
    name = function_name(signature, precision)
    ports = tuple(_entries(signature, precision))
    size = sum(_bytes(port, precision) for port in signature.inputs + signature.outputs) // precision.size
    before = _sizing(signature, name, len(ports)) if signature.counts else ""
    return Loop(name, precision.real, size, ports, before, tuple(_lines(signature, name, precision)), wider, same)


def _entries(signature: Signature, precision: Precision) -> Iterator[str]:
    offset = 0
    for index, port in enumerate(signature.inputs + signature.outputs):
        output = index >= len(signature.inputs)
        shape = ", ".join(str(-_dimension(signature, size) if isinstance(size, str) else size) for size in port.shape) or "1"
        yield f"{{{_item(port, output, precision)}, {int(output)}, {offset}, {len(port.shape)}, {{{shape}}}}}"
        offset += _bytes(port, precision)


def _dimension(signature: Signature, size: int | str) -> int:
    """Where NumPy keeps a core dimension: after the rows, each once, as they first occur."""
    sizes = dict.fromkeys(size for port in signature.inputs + signature.outputs for size in port.shape)
    return 1 + list(sizes).index(size)


def _sizing(signature: Signature, name: str, ports: int) -> str:
    """The port table of this call; the caller has seen to it that no count exceeds its buffer."""
    exceeded = " || ".join(f"dimensions[{_dimension(signature, count)}] > {COUNTS[count]}" for count in signature.counts)
    return f"walkgen_port sized[{ports}]; if ({exceeded}) {{ return; }} walkgen_sized({name}_ports, {ports}, dimensions, sized);"


def _item(port: Port, output: bool, precision: Precision) -> int:
    return precision.size if port.kind == "real" else 4 if output else _WORD


def _bytes(port: Port, precision: Precision) -> int:
    """Room for the port in the buffer, rounded up so that every port starts aligned."""
    return -(-port.sized(COUNTS).size * (precision.size if port.kind == "real" else _WORD) // _WORD) * _WORD


def _lines(signature: Signature, name: str, precision: Precision) -> Iterator[str]:
    """The statements of one row: integers narrowed first, then the call, with a workspace that knows of no other row."""
    arguments = [f"(int32_t)dimensions[{_dimension(signature, count)}]" for count in signature.counts]
    if signature.workspace:
        yield f"struct {'_'.join(part for part in (signature.workspace, precision.tag) if part)} work = {{0}};"
    for index, port in enumerate(signature.inputs):
        place = f"WALKGEN_PLACE({index})"
        if port.kind == "integer" and port.shape:
            yield f"int32_t {port.name}_{index}[{port.size}];"
            yield f"walkgen_integers({port.size}, {place}, {port.name}_{index});"
        arguments.append(_input(port, index, precision))
    arguments += ["&work"] if signature.workspace else []
    returned = ""
    for index, port in enumerate(signature.outputs, len(signature.inputs)):
        place = f"WALKGEN_PORT({precision.real if port.kind == 'real' else 'int32_t'}, {index})"
        if port == signature.returned:
            returned = f"*{place} = "
        else:
            arguments.append(place)
    yield from _call(f"{returned or _discard(signature)}{name}(", arguments)


def _discard(signature: Signature) -> str:
    return "(void)" if signature.status else ""


def _call(opening: str, arguments: list[str]) -> Iterator[str]:
    """The call on one line if it is short, else one argument a line."""
    line = f"{opening}{', '.join(arguments)});"
    if len(line) <= _WIDEST:
        yield line
        return
    yield opening
    yield from (f"    {argument}{',' if place < len(arguments) else ');'}" for place, argument in enumerate(arguments, 1))


def _input(port: Port, index: int, precision: Precision) -> str:
    if port.kind == "integer":
        return f"{port.name}_{index}" if port.shape else f"walkgen_integer(WALKGEN_PLACE({index}))"
    pointer = f"WALKGEN_PORT({precision.real}, {index})"
    return pointer if port.shape else f"*{pointer}"

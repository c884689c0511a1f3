"""Functions over many rows whose like elements lie together, element after element: `_planar` beside `_batch`."""

from collections.abc import Iterator

from walkgen.emit.artifact import Body
from walkgen.emit.c_declaration import INDENT, CFunction, call_lines, declared, function_name, port_type
from walkgen.emit.c_lanes import Laned, blocks_lines
from walkgen.emit.c_printer import Precision
from walkgen.signature import Port, Signature

HEADER = "walkgen_planar.h"


def planar_functions(body: Body, lanes: Laned | None, precision: Precision, earlier: Body | None = None) -> tuple[CFunction, ...]:
    """The function over component-major arrays; none of functions whose sizes only the caller knows.

    Where there are lanes rows run side by side, in the same blocks as those of a batch; where `earlier` has the same code, it serves.
    """
    signature = body.signature
    if signature.counts or signature.workspace:
        return ()
    name = f"{function_name(signature, precision)}_planar"
    ports = [_parameter(port, "const ", precision) for port in signature.inputs]
    ports += [_parameter(port, "", precision) for port in signature.outputs]
    head = declared(f"{'size_t' if signature.status else 'void'} {name}", ["size_t rows", "size_t stride", *ports])
    if earlier:
        serving = f"{function_name(earlier.signature, precision)}_planar"
        lines = call_lines(serving, signature, ("rows", "stride"), signature.outputs, returns=bool(signature.status))
        return (CFunction(name, head, lines),)
    lines = tuple(_row_by_row(signature, precision))
    return (CFunction(name, head, (*blocks_lines(lanes, precision, "PLANAR"), *lines, "#endif") if lanes else lines),)


def _parameter(port: Port, constant: str, precision: Precision) -> str:
    return f"{constant}{port_type(port, precision)} *WG_RESTRICT {port.name}"


def _row_by_row(signature: Signature, precision: Precision) -> Iterator[str]:
    """A row is read, computed and written; numbers of one element lie in a row themselves."""
    given = [port for port in signature.inputs if port.shape and port.name != "param"]
    found = [port for port in signature.outputs if port is not signature.returned]
    arguments = [
        "param" if port.name == "param" else f"{port.name}_row" if port.shape else f"{port.name}[row]" for port in signature.inputs
    ]
    call = declared(function_name(signature, precision), [*arguments, *(f"{port.name}_row" for port in found)]).replace(
        "\n", f"\n{INDENT * 2}"
    )
    yield from ([f"{INDENT}size_t bad = 0;"] if signature.status else [])
    yield f"{INDENT}for (size_t row = 0; row < rows; ++row) {{"
    yield from (f"{INDENT * 2}{port_type(port, precision)} {port.name}_row[{port.size}];" for port in (*given, *found))
    yield from (f"{INDENT * 2}WG_PLANAR_TAKE({port.name}, {port.size})" for port in given)
    yield f"{INDENT * 2}{_answer(signature, call)};"
    yield from (f"{INDENT * 2}WG_PLANAR_KEEP({port.name}, {port.size})" for port in found)
    yield from ([f"{INDENT * 2}bad += status[row] != WALKGEN_OK;"] if signature.returned and signature.status else [])
    yield f"{INDENT}}}"
    yield from ([f"{INDENT}return bad;"] if signature.status else [])


def _answer(signature: Signature, call: str) -> str:
    """What becomes of the value that the function of one row returns."""
    if signature.returned:
        return f"{signature.returned.name}[row] = {call}"
    return f"bad += {call} == 0" if signature.status else call

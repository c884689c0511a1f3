"""Programs and Composites as C functions: declaration, body, batch variant and the comment above them."""

import textwrap
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import accumulate
from math import prod

from walkgen.emit.c_composite import composite_lines, count_lines, stack_of
from walkgen.emit.c_declaration import (
    COLUMNS,
    INDENT,
    CFunction,
    call_lines,
    callback_name,
    count_parameters,
    declared,
    function_name,
    parameters,
    port_type,
    workspace_parameter,
    wrapped,
)
from walkgen.emit.c_each import each_lines
from walkgen.emit.c_lanes import Laned, blocks_lines, has_closest
from walkgen.emit.c_printer import CPrinter, Precision
from walkgen.emit.c_text import comment
from walkgen.emit.manifest import operations
from walkgen.emit.walker import Body, Statement, Text, live, walk
from walkgen.graph.program import Code, Composite, Program
from walkgen.graph.usual import usual, usual_truth
from walkgen.signature import Port, Signature, Table

_KEPT = "\0"


def kernel(program: Program, name: str, printer: CPrinter, storage: str = "static") -> CFunction:
    """A Program as a static function that writes every output through a pointer; one for usual inputs leaves the others."""
    signature = program.signature
    head = declared(f"{storage} void {name}", parameters(signature.inputs, signature.outputs, printer.precision))
    body, truth = walk(program, printer), usual_truth(program) if printer.inputs == "usual" else None
    lines = tuple(_program_lines(program, body, printer, None, None if truth is None else body.written[truth]))
    return CFunction(name, head, lines, locals_size=_locals_size(body, printer.precision))


def usual_kernel(program: Program, name: str, printer: CPrinter) -> CFunction:
    """The same for usual inputs, which a function begins with."""
    return kernel(usual(program), name, replace(printer, inputs="usual"), "WG_INLINE")


def program_function(program: Program, printer: CPrinter) -> CFunction:
    """A Program as a public function; its status is returned as the naming contract says."""
    signature = program.signature
    body = walk(program, printer)
    lines = (*_program_lines(program, body, printer, signature.returned), *count_lines(signature))
    return _public(program, printer.precision, lines, _locals_size(body, printer.precision))


def composite_function(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> CFunction:
    """A Composite as a public function: local arrays, the calls in order, the status."""
    return _public(composite, printer.precision, tuple(composite_lines(composite, kernels, printer)), stack_of(composite, kernels, printer))


def callback_function(callback: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> CFunction:
    """A Composite of one point as a static function that routines call: they pass on the runtime parameters without their type."""
    point, *param = callback.signature.inputs
    name, real = callback_name(callback.signature, printer.precision), printer.precision.real
    written = parameters((point,), callback.signature.outputs, printer.precision)
    opening = f"const {real} *const param = (const {real} *)data;" if param else "(void)data;"
    lines = (f"{INDENT}{opening}", *composite_lines(callback, kernels, printer))
    return CFunction(name, declared(f"static void {name}", [*written, "const void *data"]), lines)


def repeating_function(function: CFunction, signature: Signature, earlier: Signature, precision: Precision) -> CFunction:
    """The public function, which leaves all to an earlier one with the same code."""
    outputs = (port for port in signature.outputs if port is not signature.returned)
    returns = bool(signature.returned or signature.status)
    return replace(function, lines=call_lines(function_name(earlier, precision), signature, (), outputs, returns=returns))


def batch_function(
    body: Program | Composite, lanes: Laned | None, precision: Precision, earlier: Program | Composite | None = None
) -> CFunction:
    """The function over contiguous rows; it returns the number of rows without an OK if the function can fail.

    Where there are lanes rows run side by side; `earlier` has the same code, and its batch serves.
    """
    signature = body.signature
    single = function_name(signature, precision)
    returned = signature.returned
    inputs = [_batch_parameter(port, "const ", precision) for port in signature.inputs]
    outputs = [_batch_parameter(port, "", precision) for port in signature.outputs]
    chosen, work = count_parameters(signature), workspace_parameter(signature, precision)
    head = declared(f"{'size_t' if signature.status else 'void'} {single}_batch", ["size_t rows", *chosen, *inputs, *work, *outputs])
    table = earlier.signature if earlier else lanes.table if lanes and not lanes.owns_table and not has_closest(body) else None
    if table:
        name = f"{function_name(table, precision)}_batch"
        lines = call_lines(name, signature, ("rows",), signature.outputs, returns=bool(signature.status))
        return CFunction(f"{single}_batch", head, lines)
    if lanes is None and (together := each_lines(body, precision)):
        return CFunction(f"{single}_batch", head, together)
    arguments = [*signature.counts, *(_row(port, by_value=not port.shape) for port in signature.inputs), *(["work"] if work else [])]
    arguments += [_row(port, by_value=False) for port in signature.outputs if port is not returned]
    step = declared(single, arguments).replace("\n", f"\n{INDENT * 2}")
    lines = tuple(_batch_lines(signature, step))
    return CFunction(f"{single}_batch", head, (*blocks_lines(lanes, precision, "DENSE"), *lines, "#endif") if lanes else lines)


def _batch_lines(signature: Signature, step: str) -> Iterator[str]:
    loop = f"{INDENT}for (size_t row = 0; row < rows; ++row) {{"
    if signature.status is None:
        written = f"{signature.returned.name}[row] = {step}" if signature.returned else step
        yield from (loop, f"{INDENT * 2}{written};", f"{INDENT}}}")
        return
    yield from (f"{INDENT}size_t bad = 0;", loop)
    if signature.returned:
        yield f"{INDENT * 2}status[row] = {step};"
        yield f"{INDENT * 2}bad += status[row] != WALKGEN_OK;"
    else:
        yield f"{INDENT * 2}bad += {step} == 0;"
    yield from (f"{INDENT}}}", f"{INDENT}return bad;")


def _row(port: Port, *, by_value: bool) -> str:
    if port.name == "param":
        return "param"
    if by_value:
        return f"{port.name}[row]"
    counts = [f"(size_t){size}" for size in port.shape if isinstance(size, str)]
    size = prod(size for size in port.shape if isinstance(size, int))
    return " * ".join([f"{port.name} + row", *([] if size == 1 else [str(size)]), *counts])


def _batch_parameter(port: Port, constant: str, precision: Precision) -> str:
    return f"{constant}{port_type(port, precision)} *WG_RESTRICT {port.name}"


def _public(body: Program | Composite, precision: Precision, lines: tuple[str, ...], stack: int) -> CFunction:
    signature = body.signature
    name = function_name(signature, precision)
    returned = signature.returned
    inputs = [*count_parameters(signature), *parameters(signature.inputs, (), precision), *workspace_parameter(signature, precision)]
    outputs = parameters((), tuple(port for port in signature.outputs if port is not returned), precision)
    head = declared(f"{'int32_t' if returned or signature.status else 'void'} {name}", [*inputs, *outputs])
    return CFunction(name, head, lines, _doc(body, stack), stack)


def _doc(body: Program | Composite, stack: int) -> tuple[str, ...]:
    signature = body.signature
    ports = f"{', '.join(map(_described, signature.inputs))} -> {', '.join(map(_described, signature.outputs))}"
    routines = "support routines not counted; " if isinstance(body, Composite) and body.calls_routines else ""
    cost = f"{operations(body)} operations ({routines}at most {stack} bytes of locals)."
    status = f"Returns {signature.returned.name}: 1 or 0." if signature.returned else ""
    if signature.status:
        status = "Returns the number of entries with status OK." if signature.status.shape else "Returns the status."
    return comment(signature.doc or signature.name, ports, f"{status} {cost}", f"Source: {signature.source}" if signature.source else "")


def _described(port: Port) -> str:
    shape = f" [{', '.join(map(str, port.shape))}]" if port.shape else ""
    return f"{port.name}{shape}{'' if port.unit == '1' else ' ' + port.unit}"


def _program_lines(program: Program, body: Body, printer: CPrinter, returned: Port | None, decided: Text | None = None) -> Iterator[str]:
    used = {program.ops[index].element[0] for index in live(program) if program.ops[index].code is Code.INPUT}
    for number, port in enumerate(program.signature.inputs):
        if number not in used:
            yield f"{INDENT}(void){port.name};"
    yield from _interleaved(program.signature, body, printer.precision, returned, decided)


def _interleaved(signature: Signature, body: Body, precision: Precision, returned: Port | None, decided: Text | None) -> Iterator[str]:
    """Statements, each output as soon as it can be written: fewer values stay alive, so fewer are spilled to the stack.

    What is unusual is left as soon as that is `decided`.
    """
    due: dict[int, list[str]] = defaultdict(list)
    if decided:
        due[decided.after].append(f"{INDENT}WG_LEAVE_BEYOND({decided.text})")
    for after, line in _output_lines(signature, body, returned):
        due[after].append(line)
    for place, statement in enumerate(body.statements):
        yield from due[place]
        yield from _statement_lines(statement, precision)
    yield from due[len(body.statements)]


def _statement_lines(statement: Statement, precision: Precision) -> Iterator[str]:
    if not statement.names:
        yield f"{INDENT}const {'int' if statement.truth else precision.real} {statement.name} = {statement.text};"
        return
    for text in (f"{precision.real} {', '.join(statement.names)};", f"{statement.text};", *(f"{text};" for text in statement.then)):
        yield from (line.replace(_KEPT, " ") for line in wrapped(_kept_together(text)))
    yield from (f"{INDENT}(void){name};" for name in statement.idle)


def _kept_together(text: str) -> str:
    """With another blank wherever a line must not be broken: everywhere but between arguments."""
    depths = accumulate((character == "(") - (character == ")") for character in text)
    ends = (before == "," and depth <= 1 for before, depth in zip(" " + text, depths, strict=False))
    return "".join(_KEPT if character == " " and not end else character for character, end in zip(text, ends, strict=True))


def _output_lines(signature: Signature, body: Body, returned: Port | None) -> Iterator[tuple[int, str]]:
    """Every output's assignment and how many statements it follows; the returned status last."""
    texts = iter(body.outputs)
    written = [(port, element, next(texts)) for port in signature.outputs for element in range(port.size)]
    for port, element, output in sorted(written, key=lambda one: one[0] is returned):
        text = output.text if port.kind == "real" else f"(int32_t)({output.text})"
        if port is returned:
            yield len(body.statements), f"{INDENT}return {text};"
        else:
            yield output.after, f"{INDENT}{f'{port.name}[{element}]' if port.shape else f'*{port.name}'} = {text};"


def _locals_size(body: Body, precision: Precision) -> int:
    return sum(4 if statement.truth else precision.size * max(1, len(statement.names)) for statement in body.statements)


def table_lines(table: Table, printer: CPrinter) -> tuple[str, ...]:
    """A table as a constant array of the file."""
    items = [f"{printer.constant(value).text}," for value in table.values]
    rows = (" ".join(items[start : start + table.columns]) for start in range(0, len(items), table.columns))
    laid_out = (line for row in rows for line in textwrap.wrap(row, COLUMNS, break_long_words=False))
    return (f"static const {printer.precision.real} {table.name}[{len(items)}] = {{", *(f"{INDENT}{line}" for line in laid_out), "};")

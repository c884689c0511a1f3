"""Programs and Composites as C functions: declaration, body, batch variant and the comment above them."""

import textwrap
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import prod

from walkgen.emit.c_printer import CPrinter, Precision
from walkgen.emit.c_text import comment
from walkgen.emit.manifest import operations
from walkgen.emit.walker import Body, live, walk
from walkgen.graph.program import Call, Code, Composite, Program
from walkgen.graph.routines import ROUTINES
from walkgen.signature import Port, Signature, Table

_INDENT = "    "
_COLUMNS = 116


@dataclass(frozen=True)
class CFunction:
    """One function, ready to be laid out: `head` is its declaration without `;`, `lines` its body, indented.

    `locals_size` bounds the bytes of its named locals: temporaries live in registers or share their slots.
    """

    name: str
    head: str
    lines: tuple[str, ...]
    doc: tuple[str, ...] = ()
    locals_size: int = 0


def function_name(signature: Signature, precision: Precision) -> str:
    """`mero_front_left_foot_position`, or `mero_f32_front_left_foot_position`."""
    return "_".join(part for part in (signature.robot, precision.tag, signature.owner, signature.name) if part)


def kernel(program: Program, name: str, printer: CPrinter) -> CFunction:
    """A Program as a static function that writes every output through a pointer."""
    signature = program.signature
    head = _declared(f"static void {name}", _parameters(signature.inputs, signature.outputs, printer.precision))
    body = walk(program, printer)
    return CFunction(name, head, tuple(_program_lines(program, body, printer, None)), locals_size=_locals_size(body, printer.precision))


def program_function(program: Program, printer: CPrinter) -> CFunction:
    """A Program as a public function; its status is returned as the naming contract says."""
    signature = program.signature
    body = walk(program, printer)
    lines = (*_program_lines(program, body, printer, signature.returned), *_count_lines(signature))
    return _public(program, printer.precision, lines, _locals_size(body, printer.precision))


def composite_function(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> CFunction:
    """A Composite as a public function: local arrays, the calls in order, the status."""
    lines = (*_composite_lines(composite, kernels, printer), *_count_lines(composite.signature))
    return _public(composite, printer.precision, lines, _stack(composite, kernels, printer))


def callback_function(callback: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> CFunction:
    """A Composite of one point as a static function that routines call: they pass on the runtime parameters without their type."""
    point, *param = callback.signature.inputs
    name, real = callback_name(callback.signature, printer.precision), printer.precision.real
    parameters = _parameters((point,), callback.signature.outputs, printer.precision)
    opening = f"const {real} *const param = (const {real} *)data;" if param else "(void)data;"
    lines = (f"{_INDENT}{opening}", *_composite_lines(callback, kernels, printer))
    return CFunction(name, _declared(f"static void {name}", [*parameters, "const void *data"]), lines)


def callback_name(signature: Signature, precision: Precision) -> str:
    """Set apart from public functions."""
    return f"{function_name(signature, precision)}_callback"


def _composite_lines(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> list[str]:
    signature = composite.signature
    returned = signature.returned
    lines = [_local(port, composite, printer.precision) for port in composite.locals]
    lines += [f"{_INDENT}int32_t {returned.name} = WALKGEN_OK;"] if returned else []
    used = {argument for call in composite.calls for argument in (*call.arguments, *(call.guard[1] if call.guard else ()))}
    lines += [f"{_INDENT}(void){port.name};" for port in signature.inputs if port.name not in used]
    lines += [line for call in composite.calls for line in _call_lines(call, composite, kernels, printer)]
    lines += [f"{_INDENT}return {returned.name};"] if returned else []
    return lines


def _stack(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> int:
    """Bytes of locals of the function and what it calls at once."""
    called = [kernels[call.callee].locals_size for call in composite.calls if isinstance(call.callee, Program)]
    deepest = max([*called, *(_stack(callback, kernels, printer) for callback in composite.callbacks)], default=0)
    own = sum(_size(port, printer.precision) for port in composite.locals)
    copied = max((sum(_size(port, printer.precision) for port in _copied(call, composite)) for call in composite.calls), default=0)
    return own + copied + deepest


def batch_function(signature: Signature, precision: Precision) -> CFunction:
    """The function over contiguous rows; it returns the number of rows without an OK if the function can fail."""
    single = function_name(signature, precision)
    returned = signature.returned
    inputs = [_batch_parameter(port, "const ", precision) for port in signature.inputs]
    outputs = [_batch_parameter(port, "", precision) for port in signature.outputs]
    chosen, work = _count_parameters(signature), _workspace(signature, precision)
    head = _declared(f"{'size_t' if signature.status else 'void'} {single}_batch", ["size_t rows", *chosen, *inputs, *work, *outputs])
    arguments = [*signature.counts, *(_row(port, by_value=not port.shape) for port in signature.inputs), *(["work"] if work else [])]
    arguments += [_row(port, by_value=False) for port in signature.outputs if port is not returned]
    step = _declared(single, arguments).replace("\n", f"\n{_INDENT * 2}")
    return CFunction(f"{single}_batch", head, tuple(_batch_lines(signature, step)))


def _batch_lines(signature: Signature, step: str) -> Iterator[str]:
    loop = f"{_INDENT}for (size_t row = 0; row < rows; ++row) {{"
    if signature.status is None:
        written = f"{signature.returned.name}[row] = {step}" if signature.returned else step
        yield from (loop, f"{_INDENT * 2}{written};", f"{_INDENT}}}")
        return
    yield from (f"{_INDENT}size_t bad = 0;", loop)
    if signature.returned:
        yield f"{_INDENT * 2}status[row] = {step};"
        yield f"{_INDENT * 2}bad += status[row] != WALKGEN_OK;"
    else:
        yield f"{_INDENT * 2}bad += {step} == 0;"
    yield from (f"{_INDENT}}}", f"{_INDENT}return bad;")


def _row(port: Port, *, by_value: bool) -> str:
    if port.name == "param":
        return "param"
    if by_value:
        return f"{port.name}[row]"
    counts = [f"(size_t){size}" for size in port.shape if isinstance(size, str)]
    size = prod(size for size in port.shape if isinstance(size, int))
    return " * ".join([f"{port.name} + row", *([] if size == 1 else [str(size)]), *counts])


def _batch_parameter(port: Port, constant: str, precision: Precision) -> str:
    return f"{constant}{_type(port, precision)} *WG_RESTRICT {port.name}"


def _type(port: Port, precision: Precision) -> str:
    return precision.real if port.kind == "real" else "int32_t"


def _size(port: Port, precision: Precision) -> int:
    return port.size * (precision.size if port.kind == "real" else 4)


def _count_parameters(signature: Signature) -> list[str]:
    return [f"int32_t {count}" for count in signature.counts]


def _workspace(signature: Signature, precision: Precision) -> list[str]:
    """The caller's struct, as a parameter; shared by all rows of a batch."""
    name = "_".join(part for part in (signature.workspace, precision.tag) if part)
    return [f"struct {name} *WG_RESTRICT work"] if signature.workspace else []


def _parameters(inputs: tuple[Port, ...], outputs: tuple[Port, ...], precision: Precision) -> list[str]:
    written = [f"{_type(port, precision)} *WG_RESTRICT {port.name}" for port in outputs]
    return [*(_input_parameter(port, precision) for port in inputs), *written]


def _declared(start: str, parameters: Sequence[str]) -> str:
    """A declaration, its parameters filled into lines where one is not enough."""
    lines = [f"{start}("]
    for place, text in enumerate(parameters or ["void"]):
        piece = text + (", " if place + 1 < len(parameters) else ")")
        if len(lines[-1]) + len(piece) > _COLUMNS:
            lines.append(_INDENT)
        lines[-1] += piece
    return "\n".join(line.rstrip() for line in lines)


def _input_parameter(port: Port, precision: Precision) -> str:
    return f"const {_type(port, precision)} *WG_RESTRICT {port.name}" if port.shape else f"{_type(port, precision)} {port.name}"


def _public(body: Program | Composite, precision: Precision, lines: tuple[str, ...], stack: int) -> CFunction:
    signature = body.signature
    name = function_name(signature, precision)
    returned = signature.returned
    inputs = [*_count_parameters(signature), *_parameters(signature.inputs, (), precision), *_workspace(signature, precision)]
    outputs = _parameters((), tuple(port for port in signature.outputs if port is not returned), precision)
    head = _declared(f"{'int32_t' if returned or signature.status else 'void'} {name}", [*inputs, *outputs])
    return CFunction(name, head, lines, _doc(body, stack), stack)


def _doc(body: Program | Composite, stack: int) -> tuple[str, ...]:
    signature = body.signature
    ports = f"{', '.join(map(_described, signature.inputs))} -> {', '.join(map(_described, signature.outputs))}"
    routines = "support routines not counted; " if isinstance(body, Composite) else ""
    cost = f"{operations(body)} operations ({routines}at most {stack} bytes of locals)."
    status = f"Returns {signature.returned.name}: 1 or 0." if signature.returned else ""
    if signature.status:
        status = "Returns the number of entries with status OK." if signature.status.shape else "Returns the status."
    return comment(signature.doc or signature.name, ports, f"{status} {cost}", f"Source: {signature.source}" if signature.source else "")


def _described(port: Port) -> str:
    shape = f" [{', '.join(map(str, port.shape))}]" if port.shape else ""
    return f"{port.name}{shape}{'' if port.unit == '1' else ' ' + port.unit}"


def _program_lines(program: Program, body: Body, printer: CPrinter, returned: Port | None) -> Iterator[str]:
    used = {program.ops[index].element[0] for index in live(program) if program.ops[index].code is Code.INPUT}
    for number, port in enumerate(program.signature.inputs):
        if number not in used:
            yield f"{_INDENT}(void){port.name};"
    yield from _interleaved(program.signature, body, printer.precision, returned)


def _interleaved(signature: Signature, body: Body, precision: Precision, returned: Port | None) -> Iterator[str]:
    """Statements, each output as soon as it can be written: fewer values stay alive, so fewer are spilled to the stack."""
    due: dict[int, list[str]] = defaultdict(list)
    for after, line in _output_lines(signature, body, returned):
        due[after].append(line)
    for place, statement in enumerate(body.statements):
        yield from due[place]
        kind = "int" if statement.truth else precision.real
        yield f"{_INDENT}const {kind} {statement.name} = {statement.text};"
    yield from due[len(body.statements)]


def _output_lines(signature: Signature, body: Body, returned: Port | None) -> Iterator[tuple[int, str]]:
    """Every output's assignment and how many statements it follows; the returned status last."""
    texts = iter(body.outputs)
    written = [(port, element, next(texts)) for port in signature.outputs for element in range(port.size)]
    for port, element, output in sorted(written, key=lambda one: one[0] is returned):
        text = output.text if port.kind == "real" else f"(int32_t)({output.text})"
        if port is returned:
            yield len(body.statements), f"{_INDENT}return {text};"
        else:
            yield output.after, f"{_INDENT}{f'{port.name}[{element}]' if port.shape else f'*{port.name}'} = {text};"


def _locals_size(body: Body, precision: Precision) -> int:
    return sum(4 if statement.truth else precision.size for statement in body.statements)


def _count_lines(signature: Signature) -> tuple[str, ...]:
    status = signature.status
    if status is None or not status.shape:
        return ()
    return (
        f"{_INDENT}int32_t ok = 0;",
        f"{_INDENT}for (int index = 0; index < {status.size}; ++index) {{",
        f"{_INDENT * 2}ok += {status.name}[index] == WALKGEN_OK;",
        f"{_INDENT}}}",
        f"{_INDENT}return ok;",
    )


def _local(port: Port, composite: Composite, precision: Precision) -> str:
    """A local's definition, set to zero where a guard may skip what writes it."""
    first = next((call for call in composite.calls if port.name in call.arguments), None)
    start = " = {0}" if first is None or first.guard else ""
    shape = f"[{port.size}]" if port.shape else ""
    return f"{_INDENT}{_type(port, precision)} {port.name}{shape}{start if shape else start.replace('{0}', '0')};"


def _call_lines(call: Call, composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> Iterator[str]:
    if isinstance(call.callee, Program):
        name, inputs = kernels[call.callee].name, len(call.callee.signature.inputs)
    else:
        name, inputs = _routine_name(call.callee, printer.precision), ROUTINES[call.callee].inputs
    arguments = [_argument(argument, composite, printer, by_address=place >= inputs) for place, argument in enumerate(call.arguments)]
    step = f"{name}({', '.join(arguments)});"
    if call.repeat > 1 or _copied(call, composite):
        yield from _repeated_lines(call, composite, name, printer)
        return
    if call.guard is None:
        yield f"{_INDENT}{step}"
        return
    asked = [_argument(argument, composite, printer, by_address=True) for argument in call.guard[1]]
    guard = f"{_routine_name(call.guard[0], printer.precision)}({', '.join(asked)})"
    yield from (f"{_INDENT}if ({guard}) {{", f"{_INDENT * 2}{step}", f"{_INDENT}}}")


def _repeated_lines(call: Call, composite: Composite, name: str, printer: CPrinter) -> Iterator[str]:
    """A kernel run several times; arguments never overlap, so what it also writes it reads from a copy."""
    assert isinstance(call.callee, Program)
    inputs = len(call.callee.signature.inputs)
    both = _copied(call, composite)
    copies = {port.name: f"before_{port.name}" for port in both}
    arguments = [
        copies.get(str(argument), "") if place < inputs and argument in copies else _argument(argument, composite, printer, by_address=True)
        for place, argument in enumerate(call.arguments)
    ]
    yield f"{_INDENT}for (int wg_turn = 0; wg_turn < {call.repeat}; ++wg_turn) {{"
    for port in both:
        yield f"{_INDENT * 2}{_type(port, printer.precision)} {copies[port.name]}[{port.size}];"
        yield f"{_INDENT * 2}for (int wg_at = 0; wg_at < {port.size}; ++wg_at) {{"
        yield f"{_INDENT * 3}{copies[port.name]}[wg_at] = {port.name}[wg_at];"
        yield f"{_INDENT * 2}}}"
    yield f"{_INDENT * 2}{name}({', '.join(arguments)});"
    yield f"{_INDENT}}}"


def _copied(call: Call, composite: Composite) -> tuple[Port, ...]:
    """The locals that a kernel reads and writes."""
    inputs = len(call.callee.signature.inputs) if isinstance(call.callee, Program) else len(call.arguments)
    read, written = call.arguments[:inputs], call.arguments[inputs:]
    return tuple(port for port in composite.locals if port.name in read and port.name in written)


def table_lines(table: Table, printer: CPrinter) -> tuple[str, ...]:
    """A table as a constant array of the file."""
    items = [f"{printer.constant(value).text}," for value in table.values]
    rows = (" ".join(items[start : start + table.columns]) for start in range(0, len(items), table.columns))
    wrapped = (line for row in rows for line in textwrap.wrap(row, _COLUMNS, break_long_words=False))
    return (f"static const {printer.precision.real} {table.name}[{len(items)}] = {{", *(f"{_INDENT}{line}" for line in wrapped), "};")


def _routine_name(name: str, precision: Precision) -> str:
    return f"{name}_{precision.tag}" if precision.tag else name


def _argument(argument: str | Decimal | int, composite: Composite, printer: CPrinter, *, by_address: bool) -> str:
    """How a call names the value: arrays by their name, scalars by value where read, by address where written or guarded on."""
    if isinstance(argument, Decimal):
        return printer.constant(argument).text
    if isinstance(argument, int):
        return str(argument)
    signature = composite.signature
    for callback in composite.callbacks:
        if argument == callback.signature.full_name:
            data = "param" if any(port.name == "param" for port in callback.signature.inputs) else "NULL"
            return f"{callback_name(callback.signature, printer.precision)}, {data}"
    returned = signature.returned
    pointers = {port.name for port in signature.outputs if not port.shape and port is not returned}
    values = {port.name for port in composite.locals if not port.shape} | ({returned.name} if returned else set())
    if argument in pointers:
        return argument if by_address else f"*{argument}"
    return f"&{argument}" if by_address and argument in values else argument

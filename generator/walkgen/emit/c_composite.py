"""The body of a Composite in C: its local arrays and its calls in order."""

from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal

from walkgen.emit.c_declaration import INDENT, CFunction, callback_name, port_size, port_type
from walkgen.emit.c_printer import CPrinter, Precision
from walkgen.emit.c_rest import Rest, in_order, may_leave, own_locals
from walkgen.graph.program import Call, Composite, Guard, Program
from walkgen.graph.routines import ROUTINES
from walkgen.signature import Argument, Port, Records, Signature


def composite_lines(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> list[str]:
    """Local arrays, the calls, the status returned."""
    signature = composite.signature
    returned = signature.returned
    leaves = _leaves(composite, kernels)
    lines = [_local(port, composite, printer.precision) for port in own_locals(composite, leaves=leaves)]
    lines += [f"{INDENT}int32_t {returned.name} = WALKGEN_OK;"] if returned else []
    used = {argument for call in composite.calls for argument in (*call.arguments, *(call.guard[1] if call.guard else ()))}
    lines += [f"{INDENT}(void){port.name};" for port in signature.inputs if port.name not in used]
    listed = (argument for call in composite.calls for argument in call.arguments if isinstance(argument, Records))
    lines += [line for records in listed for line in _record_lines(records, composite, printer)]
    steps = in_order(composite, leaves=leaves)
    if leaves:
        lines += _leaving_lines(steps, composite, kernels, printer)
    else:
        lines += [line for step in steps for line in _step_lines(step, composite, kernels, printer)]
        lines += [f"{INDENT}return {returned.name};"] if returned else count_lines(signature)
    return lines


def count_lines(signature: Signature) -> tuple[str, ...]:
    """Of several statuses how many are OK, which C returns."""
    status = signature.status
    if status is None or not status.shape:
        return ()
    return (
        f"{INDENT}int32_t ok = 0;",
        f"{INDENT}for (int index = 0; index < {status.size}; ++index) {{",
        f"{INDENT * 2}ok += {status.name}[index] == WALKGEN_OK;",
        f"{INDENT}}}",
        f"{INDENT}return ok;",
    )


def _leaving_lines(
    steps: tuple[Call | Rest, ...], composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter
) -> Iterator[str]:
    """The first step for usual inputs, and the rest, which does all, for others; where size counts it is all there is."""
    first, rest = steps
    assert isinstance(first, Call)
    assert isinstance(rest, Rest)
    status, anew = composite.signature.status, f"{INDENT * 2}return {rest.called(printer.precision)};"
    assert status is not None
    yield from (f"{INDENT}if (WG_SIZE_COUNTS) {{", anew, f"{INDENT}}}")
    yield from _call_lines(first, composite, kernels, printer, usual=True)
    yield f"{INDENT}if ({status.name}{'[0]' if status.shape else ''} == WALKGEN_UNREACHABLE) {{"
    yield from (anew, f"{INDENT}}}", f"{INDENT}return {status.size if status.shape else status.name};")


def rest_functions(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> Iterator[CFunction]:
    """What only some rows need, as static functions."""
    for rest in in_order(composite, leaves=_leaves(composite, kernels)):
        if isinstance(rest, Rest):
            inner = _inner(rest)
            lines = [_local(port, rest.body, printer.precision) for port in rest.body.locals if port not in inner]
            lines += _anew_lines(rest, kernels, printer) if rest.anew else _rest_lines(rest, rest.body.calls, kernels, printer)
            lines += [f"{INDENT}return {port.name};" for port in rest.returned]
            lines += count_lines(rest.body.signature) if rest.counts else []
            yield CFunction(rest.name(printer.precision), rest.head(printer.precision), tuple(lines))


def _leaves(composite: Composite, kernels: Mapping[Program, CFunction]) -> bool:
    """Whether it begins with what serves usual inputs alone."""
    first = may_leave(composite)
    return first is not None and kernels[first].usual is not None


def _rest_lines(rest: Rest, calls: Iterable[Call], kernels: Mapping[Program, CFunction], printer: CPrinter) -> Iterator[str]:
    for call in calls:
        yield from _call_lines(call, rest.body, kernels, printer)


def _anew_lines(rest: Rest, kernels: Mapping[Program, CFunction], printer: CPrinter) -> Iterator[str]:
    """The first call as far as it goes, then the others under their guard."""
    first, *others = rest.body.calls
    yield from (f"{INDENT}int32_t {status.name} = WALKGEN_OK;" for status in rest.returned)
    yield from _call_lines(first, rest.body, kernels, printer)
    yield _opened(rest.guard, rest.body, printer)
    lines = [_local(port, rest.body, printer.precision) for port in _inner(rest)] + list(_rest_lines(rest, others, kernels, printer))
    yield from _damped_lines(rest, [INDENT + line for line in lines], printer) if _damps(rest) else (INDENT + line for line in lines)
    yield f"{INDENT}}}"


def _damps(rest: Rest) -> bool:
    return rest.anew and any(call.callee == "wg_damped_inverse" for call in rest.body.calls)


def _inner(rest: Rest) -> tuple[Port, ...]:
    """Locals that only damping needs."""
    return tuple(port for port in rest.body.locals if port.name not in rest.body.calls[0].arguments) if _damps(rest) else ()


def _damped_lines(rest: Rest, lines: list[str], printer: CPrinter) -> Iterator[str]:
    """Damping, or what stands for it where it is left out."""
    (status,) = rest.returned
    undamped = _routine_name("wg_undamped", printer.precision)
    yield "#if defined(WALKGEN_NO_DAMPING)"
    for port in rest.body.signature.outputs:
        if port is not status:
            yield f"{INDENT * 2}{status.name} = {undamped}({port.name}, {port.size});"
    yield from ("#else", *lines, "#endif")


def stack_of(composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> int:
    """Bytes of locals of the function and what it calls at once."""
    called = [kernels[call.callee].locals_size for call in composite.calls if isinstance(call.callee, Program)]
    deepest = max([*called, *(stack_of(callback, kernels, printer) for callback in composite.callbacks)], default=0)
    own = sum(port_size(port, printer.precision) for port in composite.locals)
    copied = max((sum(port_size(port, printer.precision) for port in _copied(call, composite)) for call in composite.calls), default=0)
    return own + copied + deepest


def _local(port: Port, composite: Composite, precision: Precision) -> str:
    """A local's definition, set to zero where a guard may skip what writes it."""
    first = next((call for call in composite.calls if port.name in call.arguments), None)
    start = " = {0}" if first is None or first.guard else ""
    shape = f"[{port.size}]" if port.shape else ""
    return f"{INDENT}{port_type(port, precision)} {port.name}{shape}{start if shape else start.replace('{0}', '0')};"


def _record_lines(records: Records, composite: Composite, printer: CPrinter) -> Iterator[str]:
    """The table, where it names anything."""
    if any(records.rows):
        known = {callback.signature.full_name: callback_name(callback.signature, printer.precision) for callback in composite.callbacks}
        yield f"{INDENT}static const struct {_routine_name(records.struct, printer.precision)} {records.struct}s[] = {{"
        for row in records.rows:
            yield f"{INDENT * 2}{{{', '.join(known.get(str(entry)) or str(entry) for entry in row) or '0'}}},"
        yield f"{INDENT}}};"


def _step_lines(step: Call | Rest, composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter) -> Iterator[str]:
    if isinstance(step, Call):
        yield from _call_lines(step, composite, kernels, printer)
    else:
        yield from _guarded(step.guard, step.call(printer.precision), composite, printer)


def _guarded(guard: Guard, step: str, composite: Composite, printer: CPrinter) -> Iterator[str]:
    yield from (_opened(guard, composite, printer), f"{INDENT * 2}{step}", f"{INDENT}}}")


def _opened(guard: Guard, composite: Composite, printer: CPrinter) -> str:
    """Of a status that is returned the question is asked in place: nothing takes its address."""
    returned = composite.signature.returned
    if returned and guard == ("wg_any_unreachable", (returned.name, 1)):
        return f"{INDENT}if ({returned.name} == WALKGEN_UNREACHABLE) {{"
    asked = [_argument(argument, composite, printer, by_address=True) for argument in guard[1]]
    return f"{INDENT}if ({_routine_name(guard[0], printer.precision)}({', '.join(asked)})) {{"


def _call_lines(
    call: Call, composite: Composite, kernels: Mapping[Program, CFunction], printer: CPrinter, *, usual: bool = False
) -> Iterator[str]:
    """The call; of what serves usual inputs alone where only they are meant."""
    if isinstance(call.callee, Program):
        whole = kernels[call.callee]
        name, inputs = (whole.usual if usual and whole.usual else whole).name, len(call.callee.signature.inputs)
    else:
        name, inputs = _routine_name(call.callee, printer.precision), ROUTINES[call.callee].inputs
    arguments = [_argument(argument, composite, printer, by_address=place >= inputs) for place, argument in enumerate(call.arguments)]
    step = f"{name}({', '.join(arguments)});"
    if call.repeat > 1 or _copied(call, composite):
        yield from _repeated_lines(call, composite, name, printer)
        return
    if call.guard is None:
        yield f"{INDENT}{step}"
        return
    yield from _guarded(call.guard, step, composite, printer)


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
    yield f"{INDENT}for (int wg_turn = 0; wg_turn < {call.repeat}; ++wg_turn) {{"
    for port in both:
        yield f"{INDENT * 2}{port_type(port, printer.precision)} {copies[port.name]}[{port.size}];"
        yield f"{INDENT * 2}for (int wg_at = 0; wg_at < {port.size}; ++wg_at) {{"
        yield f"{INDENT * 3}{copies[port.name]}[wg_at] = {port.name}[wg_at];"
        yield f"{INDENT * 2}}}"
    yield f"{INDENT * 2}{name}({', '.join(arguments)});"
    yield f"{INDENT}}}"


def _copied(call: Call, composite: Composite) -> tuple[Port, ...]:
    """The locals that a kernel reads and writes."""
    inputs = len(call.callee.signature.inputs) if isinstance(call.callee, Program) else len(call.arguments)
    read, written = call.arguments[:inputs], call.arguments[inputs:]
    return tuple(port for port in composite.locals if port.name in read and port.name in written)


def _routine_name(name: str, precision: Precision) -> str:
    return f"{name}_{precision.tag}" if precision.tag else name


def _argument(argument: Argument, composite: Composite, printer: CPrinter, *, by_address: bool) -> str:
    """How a call names the value: arrays by their name, scalars by value where read, by address where written or guarded on."""
    if isinstance(argument, Decimal):
        return printer.constant(argument).text
    if isinstance(argument, int):
        return str(argument)
    if isinstance(argument, Records):
        return f"{argument.struct}s, {_data(composite.callbacks[0])}" if any(argument.rows) else "NULL, NULL"
    signature = composite.signature
    for callback in composite.callbacks:
        if argument == callback.signature.full_name:
            return f"{callback_name(callback.signature, printer.precision)}, {_data(callback)}"
    returned = signature.returned
    pointers = {port.name for port in signature.outputs if not port.shape and port is not returned}
    values = {port.name for port in composite.locals if not port.shape} | ({returned.name} if returned else set())
    if argument in pointers:
        return argument if by_address else f"*{argument}"
    return f"&{argument}" if by_address and argument in values else argument


def _data(callback: Composite) -> str:
    """What it takes after its point."""
    return "param" if any(port.name == "param" for port in callback.signature.inputs) else "NULL"

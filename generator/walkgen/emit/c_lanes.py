"""Functions that run many rows side by side, one a lane: which they are, and their blocks in C (walkgen_lanes.h)."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate

from walkgen.emit.artifact import Body, RobotCode
from walkgen.emit.c_declaration import INDENT, CFunction, function_name, wrapped
from walkgen.emit.c_printer import Precision
from walkgen.emit.c_rest import may_leave
from walkgen.graph.lanes import telling
from walkgen.graph.program import Code, Composite, Program
from walkgen.graph.sharing import nameless
from walkgen.graph.usual import usual
from walkgen.signature import Port, Signature

_MOST_OPERATIONS, _MOST_FOUND = 120, 32
"""What compilers turn into vectors in little time; a longer function gains less."""
_WIDEST_PORT, _MOST_GIVEN, _MOST_STATUSES, _MOST_INTEGERS = 32, 48, 8, 4
"""What walkgen_lanes.h and walkgen_batch.h have room for."""


_GUARD = "wg_any_unreachable"
_READ = {"static ": "WG_STATIC_ROW", "WG_INLINE ": "WG_INLINE_ROW", "": "WG_ROW"}
"""What stands for a function's storage; the last one, for a public function, begins every head."""


@dataclass(frozen=True)
class Laned:
    """A function with lanes: `program` computes its outputs from `arguments`, names of the body's ports or of its locals.

    Rows with another status than OK are computed once more, one by one, of a Composite by all its steps. `table` is the function whose
    block serves: its own, or that of an earlier one with the same code, as of an equal leg. `telling` are the elements of the program's
    outputs that tell of lost angles.
    """

    body: Body
    program: Program
    arguments: tuple[str, ...]
    table: Signature
    telling: tuple[int, ...] = ()

    @property
    def signature(self) -> Signature:
        """Of the function."""
        return self.body.signature

    @property
    def owns_table(self) -> bool:
        """Whether the block is written for this function."""
        return self.table is self.body.signature

    @cached_property
    def leaves(self) -> bool:
        """Whether lanes serve usual inputs alone, and all steps the others."""
        return isinstance(self.body, Composite) and may_leave(self.body) == self.program

    @cached_property
    def computed(self) -> Program:
        """What lanes do."""
        return usual(self.program) if self.leaves else self.program

    @property
    def opening(self) -> str:
        """What stands before code of lanes: a program that chooses needs masks as wide as its numbers."""
        chooses = any(op.code in (Code.SELECT, Code.INDICATOR) for op in self.computed.ops)
        return f"#if defined(WALKGEN_BLOCKS){' && WG_MASKS' if chooses else ''}"


def laned(code: RobotCode) -> tuple[Laned, ...]:
    """The robot's functions with lanes, in order."""
    owners = {owner.name for owner in (*code.mechanism.legs, *code.mechanism.chains)}
    bodies = [body for body in code.functions if body.signature.owner in owners and _fits(body.signature)]
    found = [each for each in filter(None, map(_laned, bodies)) if each.computed.operation_count <= _MOST_OPERATIONS]
    first: dict[Hashable, Signature] = {}
    sure = (replace(each, telling=places) for each in found if (places := telling(each.computed)) is not None)
    return tuple(replace(each, table=first.setdefault(_code(each), each.signature)) for each in sure)


def _code(each: Laned) -> Hashable:
    """What a block is made of: the code, and which of its ports are the function's own."""
    ports = [port.name for port in (*each.signature.inputs, *each.signature.outputs)]
    places = tuple(ports.index(name) if name in ports else -1 for name in each.arguments)
    return nameless(each.computed), places, has_closest(each.body)


def _fits(signature: Signature) -> bool:
    ports = (*signature.inputs, *signature.outputs)
    whole = [port for port in signature.outputs if port.kind != "real"]
    return (
        not signature.counts
        and not signature.workspace
        and bool(signature.inputs)
        and all(0 < port.size <= _WIDEST_PORT for port in ports)
        and all(port.kind == "real" or (port.kind == "integer" and not port.shape) for port in signature.inputs)
        and sum(port.size for port in signature.inputs) <= _MOST_GIVEN
        and sum(port.kind == "integer" for port in signature.inputs) <= _MOST_INTEGERS
        and sum(port.size for port in signature.outputs) <= _MOST_FOUND
        and (not whole or (whole == [signature.outputs[-1]] and whole[0].size <= _MOST_STATUSES))
    )


def _laned(body: Body) -> Laned | None:
    if isinstance(body, Program):
        names = tuple(port.name for port in (*body.signature.inputs, *body.signature.outputs))
        return Laned(body, body, names, body.signature)
    first, *others = body.calls
    names = tuple(map(str, first.arguments))
    if not isinstance(first.callee, Program) or first.guard or first.repeat > 1 or names != first.arguments:
        return None
    if others and not (body.signature.status and all(call.guard and call.guard[0] == _GUARD for call in others)):
        return None
    computed = names[len(first.callee.signature.inputs) :]
    return Laned(body, first.callee, names, body.signature) if _known(body, computed) else None


def _known(body: Composite, computed: tuple[str, ...]) -> bool:
    """Whether the first step gives every output."""
    return all(port.name in computed for port in body.signature.outputs)


def lane_lines(each: Laned, kernel: CFunction, precision: Precision) -> Iterator[str]:
    """The block, the row alone and the table of both."""
    name = function_name(each.signature, precision)
    yield from ("", each.opening, f"WG_BLOCK({name}) {{")
    yield from (f"{INDENT}{line}" for line in _places(each))
    yield f"{INDENT}WG_EACH_LANE {{"
    yield from (f"{INDENT * 2}{line}" for line in _block(each, kernel, precision))
    yield from (f"{INDENT}}}", "}", "", f"WG_ALONE({name}) {{")
    yield from (f"{INDENT}{line}" for line in _alone(each, kernel, precision))
    inputs, outputs, status = len(each.signature.inputs), len(each.signature.outputs), each.signature.status
    yield from ("}", f"WG_LANED({name}, {inputs}, {outputs}, {status.size if status else 0});", "#endif")


def has_closest(body: Body) -> bool:
    """Whether rows with an UNREACHABLE target need the whole function."""
    return isinstance(body, Composite) and len(body.calls) > 1


def closest_lines(each: Laned, precision: Precision) -> Iterator[str]:
    """Of a Composite with further steps, the whole function of one row."""
    if has_closest(each.body):
        name = function_name(each.signature, precision)
        yield f"static void {name}_closest(const {precision.real} *given, {precision.real} *found) {{"
        yield from (f"{INDENT}{line}" for line in _whole(each.signature, name, precision))
        yield "}"


def read_twice(function: CFunction) -> CFunction:
    """With a head that walkgen_batch.h and walkgen_lanes.h make of what they need, and integers of the type that lanes have."""
    storage = next(each for each in _READ if function.head.startswith(each))
    head, rest = _with_states(function.head.removeprefix(storage)).split("(", 1)
    lines = tuple(map(_with_states, function.lines))
    return replace(function, head=f"{_READ[storage]}({head})({rest}", lines=lines)


def _with_states(text: str) -> str:
    """Integers of functions with lanes are numbers there."""
    return text.replace("int32_t", "WG_STATE")


def blocks_lines(lanes: Laned, precision: Precision, layout: str) -> Iterator[str]:
    """The body of a function of many rows where there are lanes; `layout` is that of its arrays: DENSE, row by row, or PLANAR."""
    signature = lanes.signature
    closest = f"{function_name(signature, precision)}_closest" if has_closest(lanes.body) else "NULL"
    arrays = ", ".join(_array(port, layout) for port in (*signature.inputs, *signature.outputs))
    yield lanes.opening
    yield from wrapped(f"const struct wg_array arrays[] = {{{arrays}}};")
    result = "return " if signature.status else "(void)"
    yield f"{INDENT}{result}WG_NAME(wg_batch)(&{function_name(lanes.table, precision)}_laned, rows, arrays, {closest});"
    yield "#else"


def _array(port: Port, layout: str) -> str:
    if port.name == "param":
        return f"WG_SHARED(param, {port.size})"
    return f"WG_{layout}{'' if port.kind == 'real' else '_STATUS'}({port.name}, {port.size})"


def _starts(ports: Iterable[Port]) -> dict[str, int]:
    """Where each begins in a row."""
    ports = tuple(ports)
    return dict(zip((port.name for port in ports), accumulate((port.size for port in ports), initial=0), strict=False))


def _places(each: Laned) -> Iterator[str]:
    """Where the numbers of a block lie."""
    inputs = each.signature.inputs
    for place, port in enumerate((*inputs, *each.signature.outputs)):
        if port.name in each.arguments and port is not each.signature.status:
            way = ("FROM" if port.kind == "real" else "FROM_INTEGER") if place < len(inputs) else "INTO"
            yield f"WG_{way}({port.name}, {place})"


def _block(each: Laned, kernel: CFunction, precision: Precision) -> Iterator[str]:
    signature, own = each.signature, each.program.signature
    sizes = dict(zip(each.arguments, (*own.inputs, *own.outputs), strict=True))
    reals, whole = ([f"{name}[{port.size}]" for name, port in sizes.items() if (port.kind == "real") == real] for real in (True, False))
    yield f"{precision.real} {', '.join(reals)};"
    yield from [f"WG_STATE {', '.join(whole)};"] if whole else []
    given = [port for port in signature.inputs if port.name in sizes]
    yield from (f"WG_TAKE_{port.size if port.kind == 'real' else 'INTEGER'}({port.name})" for port in given)
    texts = {name: f"{name}[0]" for name, port in zip(each.arguments, own.inputs, strict=False) if not port.shape}
    yield _call(each, kernel, texts, lane=True)
    yield from (f"WG_KEEP_{port.size}({port.name})" for port in signature.outputs if port is not signature.status)
    status = signature.status
    yield f"WG_DONE_IF({_telling(each)}, {_left(each, status.name)})" if status else f"WG_DONE({_telling(each)})"


def _telling(each: Laned) -> str:
    """A sum that is NaN where an angle is."""
    elements = _elements(each)
    return " + ".join(elements[place] for place in each.telling) or "0"


def _left(each: Laned, status: str) -> str:
    """A sum that is 0 where all statuses are OK; of those that are one operation one is enough."""
    found = zip(each.computed.outputs, _elements(each), strict=True)
    return " + ".join({number: element for number, element in found if element.startswith(f"{status}[")}.values())


def _elements(each: Laned) -> list[str]:
    """Of the program's outputs, by the arguments' names."""
    own = each.program.signature
    names = zip(each.arguments[len(own.inputs) :], own.outputs, strict=True)
    return [f"{name}[{element}]" for name, port in names for element in range(port.size)]


def _alone(each: Laned, kernel: CFunction, precision: Precision) -> Iterator[str]:
    """One row by the first step alone."""
    signature, own = each.signature, each.program.signature
    ports = dict(zip(each.arguments, (*own.inputs, *own.outputs), strict=True))
    kept = {port.name for port in (*signature.inputs, *signature.outputs)}
    scratch = [f"{name}[{port.size}]" for name, port in ports.items() if name not in kept]
    yield from [f"{precision.real} {', '.join(scratch)};"] if scratch else []
    yield from _row(signature, precision, lambda texts: [_call(each, kernel, texts)])


def _whole(signature: Signature, name: str, precision: Precision) -> Iterator[str]:
    """One row by the function."""
    names = tuple(port.name for port in (*signature.inputs, *signature.outputs))
    texts = dict(zip(names, names, strict=True))
    yield from _row(signature, precision, lambda found: [_call_text(signature, name, names, texts | found, returns=True)])


def _row(signature: Signature, precision: Precision, called: Callable[[dict[str, str]], Iterable[str]]) -> Iterator[str]:
    """A call on numbers that lie side by side; statuses take a detour through integers."""
    given, found = _starts(signature.inputs), _starts(signature.outputs)
    texts = {port.name: _number(port, f"given[{given[port.name]}]") for port in signature.inputs}
    texts |= {port.name: _number(port, f"found[{found[port.name]}]", written=True) for port in signature.outputs}
    whole = [port for port in signature.outputs if port.kind != "real"]
    yield from (f"int32_t {port.name}[{port.size}] = {{0}};" for port in whole)
    yield from called(texts)
    for port in whole:
        start = found[port.name]
        yield f"for (int at = 0; at < {port.size}; ++at) {{ found[{start} + at] = ({precision.real}){port.name}[at]; }}"


def _number(port: Port, place: str, *, written: bool = False) -> str:
    if port.kind != "real":
        return port.name if written else f"(int32_t){place}"
    return f"&{place}" if port.shape or written else place


def _call(each: Laned, kernel: CFunction, texts: Mapping[str, str], *, lane: bool = False) -> str:
    """Of the program; what leaves an unusual row goes on to the end in lanes."""
    name = f"{kernel.name}_lane" if lane else kernel.name
    names = {name: name for name in each.arguments} | dict(texts)
    return _call_text(each.program.signature, name, each.arguments, names, isinstance(each.body, Program))


def _call_text(signature: Signature, called: str, names: tuple[str, ...], texts: Mapping[str, str], returns: bool) -> str:
    """With `returns` the status that C returns goes into its place, else it is written like every other output."""
    ports = (*signature.inputs, *signature.outputs)
    written = [(port, texts[name]) for name, port in zip(names, ports, strict=True)]
    returned = next((text for port, text in written if returns and port is signature.returned), "")
    given = ", ".join(text for port, text in written if not (returns and port is signature.returned))
    return f"{f'{returned}[0] = ' if returned else ''}{called}({given});"

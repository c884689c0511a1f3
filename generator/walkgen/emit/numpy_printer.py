"""Prints a robot's functions as vectorised NumPy: the fall-back without a compiler, and code a person can read."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from itertools import product
from keyword import kwlist

from walkgen.emit.artifact import Artifact, Body, RobotCode
from walkgen.emit.layout import lay_out
from walkgen.emit.python_text import OPERATORS, banner, listing, literal, shape_text, short_name, summary, title, unpacked
from walkgen.emit.walker import Form, Text, walk
from walkgen.graph.program import Call, Code, Composite, Program
from walkgen.graph.routines import ROUTINES, Routine
from walkgen.graph.usual import for_all
from walkgen.signature import Argument, Port, Records, Signature, Table

_FORMS: Mapping[Code, Form] = {
    **OPERATORS,
    Code.SQRT: Form("np.sqrt({0})"),
    Code.SIN: Form("np.sin({0})"),
    Code.COS: Form("np.cos({0})"),
    Code.TAN: Form("np.tan({0})"),
    Code.ATAN2: Form("np.arctan2({0}, {1})"),
    Code.ABS: Form("np.abs({0})"),
    Code.MIN: Form("_least({0}, {1})"),
    Code.MAX: Form("_greatest({0}, {1})"),
    Code.FINITE: Form("np.isfinite({0})"),
    Code.AND: Form("np.logical_and({0}, {1})"),
    Code.OR: Form("np.logical_or({0}, {1})"),
    Code.NOT: Form("np.logical_not({0})"),
    Code.SELECT: Form("np.where({0}, {1}, {2})"),
    Code.INDICATOR: Form("np.where({0}, 1.0, 0.0)"),
    Code.EPSILON: Form("2.220446049250313e-16"),
}
_DTYPES: Mapping[str, str] = {"real": "np.float64", "integer": "np.int32", "truth": "np.bool_"}
_HELPERS = frozenset(
    {"float", "np", "lead", "_least", "_greatest", "_elements", "_arrays", "_array", "_spread", "_real", "_integer", "_count"}
)


@dataclass(frozen=True)
class PythonFunction:
    """One function, ready to be laid out; `lines` are its body, indented."""

    name: str
    parameters: str
    doc: tuple[str, ...]
    lines: tuple[str, ...]


@dataclass(frozen=True)
class NumpyPrinter:
    """How NumPy writes a Program's operations; every input element is a name of its own."""

    program: Program

    @property
    def forms(self) -> Mapping[Code, Form]:
        """How each operation is written."""
        return _FORMS

    def together(self, angles: int) -> Mapping[Code, str]:
        """Nothing."""
        del angles
        return {}

    @property
    def sums(self) -> tuple[str, str]:
        """As they are: no angles come together."""
        return "{0}", ""

    @property
    def reserved(self) -> frozenset[str]:
        """What a local must not be called."""
        return _HELPERS.union(kwlist, *(_element_names(port) for port in self.program.signature.inputs))

    def constant(self, value: Decimal) -> Text:
        """The nearest double."""
        return literal(value)

    def element(self, port: Port, index: int) -> Text:
        """The element's own name."""
        return Text(_element_names(port)[index])


def numpy_artifact(code: RobotCode) -> Artifact:
    """`<robot>_numpy.py`: every function, with numpy (and walkgen's solves where a function needs one) as its only imports."""
    robot = code.mechanism.name
    public = [_program(body) if isinstance(body, Program) else _composite(body, code.public) for body in code.functions]
    return lay_out(
        "numpy.py.jinja",
        f"{robot}_numpy.py",
        banner=banner(code),
        title=title(code, "NumPy"),
        imports=_imports(code),
        tables=[_table(table) for table in code.tables],
        kernels=[*(_program(kernel, "_") for kernel in _kernels(code)), *_callbacks(code)],
        functions=public,
        names=[short_name(body.signature) for body in code.functions],
    )


def _kernels(code: RobotCode) -> tuple[Program, ...]:
    """The Programs that are only inside Composites, each once, in order of first use."""
    bodies = [body for body in code.functions if isinstance(body, Composite)]
    found: dict[str, Program] = {}
    for program in (call.callee for body in bodies for call in body.all_calls if isinstance(call.callee, Program)):
        name = program.signature.full_name
        if found.setdefault(name, program) != program:
            raise AssertionError(f"two kernels are called {name}")
    public = code.public
    return tuple(program for program in found.values() if program not in public)


def _callbacks(code: RobotCode) -> Iterator[PythonFunction]:
    called_back = dict.fromkeys(callback for body in code.functions if isinstance(body, Composite) for callback in body.all_callbacks)
    yield from (_composite(callback, code.public, "_") for callback in called_back)


def _imports(code: RobotCode) -> tuple[str, ...]:
    bodies = [body for body in code.functions if isinstance(body, Composite)]
    routines = {ROUTINES[call.callee] for body in bodies for call in body.all_calls if isinstance(call.callee, str)}
    modules = sorted({routine.module for routine in routines})
    return tuple(_import(module, routines) for module in modules)


def _import(module: str, routines: set[Routine]) -> str:
    """Under their C names, which no function of a robot can have."""
    names = sorted(f"{routine.function} as {routine.name}" for routine in routines if routine.module == module)
    return f"from walkgen.runtime.solves.{module} import {', '.join(names)}"


def _program(program: Program, prefix: str = "") -> PythonFunction:
    signature, computed = program.signature, for_all(program)
    body = walk(computed, NumpyPrinter(computed))
    names = [name for port in signature.inputs for name in _element_names(port)]
    opening = listing(f"lead, {unpacked(names)} = _elements(", map(_given, signature.inputs), ")") if names else ("    lead = ()",)
    statements = tuple(f"    {statement.name} = {statement.text}" for statement in body.statements)
    outputs = iter(text.text for text in body.outputs)
    closing = tuple(line for port in signature.outputs for line in _output(port, [next(outputs) for _ in range(port.size)]))
    lines = (*opening, *statements, *closing, f"    return {', '.join(port.name for port in signature.outputs)}")
    return PythonFunction(prefix + short_name(signature), _parameters(program), summary(program), lines)


def _composite(composite: Composite, public: Collection[Program], prefix: str = "") -> PythonFunction:
    signature = composite.signature
    arrays = listing(f"lead, {unpacked(port.name for port in signature.inputs)} = _arrays(", map(_given, signature.inputs), ")")
    told = [count for count in signature.counts if count not in signature.capacities]
    counts = tuple(f"    {count} = {_counted(signature, count)}" for count in told)
    known = {*told, *(["work"] if signature.workspace else [])}
    callbacks = {callback.signature.full_name: _passed(callback) for callback in composite.callbacks}
    steps = tuple(line for call in composite.calls for line in _step(call, public, known, callbacks))
    spread = ", ".join(f"_spread(lead, {shape_text(port.shape)}, {_dtype(port)}, {port.name})" for port in signature.outputs)
    lines = (*counts, *arrays, *steps, f"    return {spread}")
    return PythonFunction(prefix + short_name(signature), _parameters(composite), summary(composite), lines)


def _passed(callback: Composite) -> str:
    """A callback with what it takes after the point."""
    return f"({', '.join([f'_{short_name(callback.signature)}', *(port.name for port in callback.signature.inputs[1:])])},)"


def _counted(signature: Signature, count: str) -> str:
    """A count, read off the first input that has it."""
    port = next(port for port in signature.inputs if count in port.shape)
    return f'_count("{port.name}", {port.name}, {len(port.shape)}, {port.shape.index(count)})'


def _step(call: Call, public: Collection[Program], known: Collection[str], callbacks: Mapping[str, str]) -> tuple[str, ...]:
    """One call; a guard only saves C the work, a routine leaves alone the rows that do not need it, and reads counts off its arrays."""
    if isinstance(call.callee, Program):
        prefix = "" if call.callee in public else "_"
        name, taken = f"{prefix}{short_name(call.callee.signature)}", len(call.callee.signature.inputs)
        written = taken
    else:
        routine = ROUTINES[call.callee]
        name, taken, written = routine.name, routine.taken, routine.inputs
    counted = isinstance(call.callee, str) and isinstance(call.arguments[0], int)
    given, results = (
        [_argument(argument, callbacks) for argument in arguments if argument not in known]
        for arguments in (call.arguments[counted:taken], call.arguments[written:])
    )
    step = f"    {', '.join(results)} = {name}({', '.join(given)})"
    return (f"    for _ in range({call.repeat}):", f"    {step}") if call.repeat > 1 else (step,)


def _argument(argument: Argument, callbacks: Mapping[str, str]) -> str:
    if isinstance(argument, Decimal):
        return literal(argument).text
    if isinstance(argument, Records):
        return f"[{', '.join(_record(row, callbacks) for row in argument.rows if any(argument.rows))}]"
    return callbacks.get(str(argument)) or str(argument)


def _record(row: tuple[str | int, ...], callbacks: Mapping[str, str]) -> str:
    return f"({', '.join(callbacks.get(str(entry)) or str(entry) for entry in row)})"


def _table(table: Table) -> tuple[str, ...]:
    rows = (literal(value).text for value in table.values)
    return listing(f"{table.name} = np.array((", rows, "))", indent="")


def _parameters(body: Body) -> str:
    return ", ".join([*(port.name for port in body.signature.inputs), *body.signature.capacities])


def _given(port: Port) -> str:
    return f'_{port.kind}("{port.name}", {port.name}, {shape_text(port.shape)})'


def _dtype(port: Port) -> str:
    return _DTYPES[port.kind]


def _output(port: Port, elements: list[str]) -> tuple[str, ...]:
    return listing(f"{port.name} = _array(lead, {shape_text(port.shape)}, {_dtype(port)}, [", elements, "])")


def _element_names(port: Port) -> tuple[str, ...]:
    """`q_0`, `T_0_1`; a scalar is known by its port's name."""
    return tuple("_".join((port.name, *map(str, place))) for place in product(*map(range, port.sizes)))
